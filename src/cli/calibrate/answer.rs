//! The result of a calibration, for people and for programs.

use super::Asked;
use crate::artifact::Table;
use crate::artifact::calibration::{Determination, Parameters, Prediction, Solution, Verification};
use crate::cli::sheet::text as shown;
use crate::cli::show::rows_json;
use serde_json::{Value, json};
use std::fmt::Write;

crate::table! {
    /// the columns of [`Parameters`] that are printed
    struct PrintedParameters {
        /// the parameter
        factor: Vec<String>, "";
        /// of the solution
        value: Vec<f64>, "";
        /// of the numbers in this row
        unit: Vec<String>, "";
        /// least over all equally good solutions
        low: Vec<f64>, "";
        /// greatest
        high: Vec<f64>, "";
        /// how far the targets determine it
        known: Vec<Determination>, "";
    }
}

crate::table! {
    /// the columns of [`Prediction`] that are printed
    struct PrintedPrediction {
        /// the response
        response: Vec<String>, "";
        /// of the numbers in this row
        unit: Vec<String>, "";
        /// the target
        target: Vec<f64>, "";
        /// at the solution
        expected: Vec<f64>, "";
        /// lower end of the 95 % interval of the mean
        low: Vec<f64>, "";
        /// upper end
        high: Vec<f64>, "";
        /// as in the misfit
        deviation_percent: Vec<f64>, "";
    }
}

/// The parameters, the predicted responses, and how reliable both are.
pub(super) fn text(asked: &Asked, solution: &Solution) -> String {
    let parameters = printed_parameters(&solution.parameters).to_table();
    let prediction = printed_prediction(&solution.prediction).to_table();
    let tables = [parameters, prediction].map(|table| shown(&Table { about: String::new(), ..table }));
    let [parameters, prediction] = tables;
    format!("{parameters}\n\n{prediction}\n\n{}{}", warnings(&solution.prediction), notes(asked, solution))
}

/// A deviation below this, in percent, is rounding and shown as none.
const NOTHING: f64 = 1e-6;

fn printed_parameters(all: &Parameters) -> PrintedParameters {
    let Parameters { factor, value, unit, low, high, known, .. } = all.clone();
    PrintedParameters { factor, value, unit, low, high, known }
}

fn printed_prediction(all: &Prediction) -> PrintedPrediction {
    let Prediction { response, unit, target, expected, low, high, mut deviation_percent, .. } = all.clone();
    deviation_percent.iter_mut().filter(|value| value.abs() < NOTHING).for_each(|value| *value = 0.0);
    PrintedPrediction { response, unit, target, expected, low, high, deviation_percent }
}

/// Targets out of reach, one by one or together.
fn warnings(prediction: &Prediction) -> String {
    let mut text = String::new();
    for row in (0..prediction.set.len()).filter(|&row| prediction.out_of_reach(row)) {
        let (name, reach) = (&prediction.response[row], &prediction.reach[row]);
        let _ = writeln!(text, "the target of `{name}` is {reach} over these ranges: the nearest is given");
    }
    let missed = prediction.deviation_percent.iter().any(|deviation| deviation.abs() > MET);
    if text.is_empty() && missed {
        text.push_str("each target can be met by itself, all together cannot: the nearest is given\n");
    }
    text
}

/// A deviation up to this, in percent, is no conflict between targets.
const MET: f64 = 0.1;

/// How good the solution is, and whether it is unique.
fn notes(asked: &Asked, found: &Solution) -> String {
    let solved = &found.solution;
    let first = |values: &[f64]| values.first().copied().unwrap_or(f64::NAN);
    let stop = solved.stop.first().map_or("", String::as_str);
    let (misfit, evaluations) = (first(&solved.misfit), solved.evaluations.first().copied().unwrap_or_default());
    let mut text = format!("misfit {misfit:.1e} after {evaluations} evaluations: {stop}\n");
    let free = first(&solved.free);
    if free > 0.0 {
        let preferred = asked.workflow.position(&asked.stage).is_some_and(|index| {
            let settings = asked.workflow.stages[index].stage.settings();
            settings["preference"].as_object().is_some_and(|own| !own.is_empty())
        });
        let near = if preferred { "the preferred point" } else { "the middle of the ranges" };
        let directions = if free > 1.0 { "directions" } else { "direction" };
        let others = found.solution_set.set.len();
        let _ = writeln!(
            text,
            "not unique: the targets leave {free} {directions} free; this is the solution nearest {near}, \
             and {others} others are in the table `solution_set` (--json)"
        );
    }
    text
}

/// The results on new specimens.
pub(super) fn verified(summary: &Table) -> String {
    format!("\n{}\n", shown(summary))
}

/// All of it as one document: tables as lists of rows, and the units of the columns of the solution.
pub(super) fn document(asked: &Asked, found: &Solution, verified: &[Verification]) -> Value {
    let best = found.solution.to_table();
    let units: serde_json::Map<String, Value> = best
        .columns
        .iter()
        .filter(|column| !column.unit.is_empty())
        .map(|column| (column.name.clone(), json!(column.unit)))
        .collect();
    json!({
        "workflow": asked.workflow.name,
        "stage": asked.stage,
        "units": units,
        "solution": rows_json(&best).get(0),
        "parameters": rows_json(&found.parameters.to_table()),
        "prediction": rows_json(&found.prediction.to_table()),
        "solution_set": rows_json(&found.solution_set.to_table()),
        "verification": verified.iter().map(|found| rows_json(&found.summary.to_table())).collect::<Vec<_>>(),
    })
}
