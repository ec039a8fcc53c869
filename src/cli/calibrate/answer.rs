//! The result of a calibration, for people and for programs.

use super::Asked;
use crate::artifact::calibration::{Prediction, Solved};
use crate::artifact::{Artifact, Column, Table, Values};
use crate::cli::show::{rows_json, text as shown};
use crate::export::csv_text;
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::Arc;

/// The parameters, the predicted responses, and how reliable both are.
pub(super) fn text(asked: &Asked, solution: &Artifact) -> String {
    let mut text = format!("{}\n\n", shown(&parameters(solution)));
    if let Some(prediction) = solution.table("prediction") {
        let columns = ["response", "unit", "target", "expected", "low", "high", "deviation_percent"];
        let mut columns: Vec<Column> = columns.iter().filter_map(|name| prediction.column(name).cloned()).collect();
        if let Some(Values::Reals(values)) = columns.last_mut().map(|column| &mut column.values) {
            values.iter_mut().filter(|value| value.abs() < NOTHING).for_each(|value| *value = 0.0);
        }
        let _ = writeln!(text, "{}\n", shown(&Table { about: String::new(), columns }));
        text.push_str(&Prediction::from_table(prediction).map_or_else(|_| String::new(), |found| warnings(&found)));
    }
    text.push_str(&notes(asked, solution));
    text
}

/// A deviation below this, in percent, is rounding and shown as none.
const NOTHING: f64 = 1e-6;

/// One row per parameter: its value, its range over equally good solutions, and whether the targets determine it.
fn parameters(solution: &Artifact) -> Table {
    let known = table(solution, "parameters");
    let columns = ["factor", "value", "unit", "low", "high", "known"];
    let columns = columns.iter().filter_map(|name| known.column(name).cloned()).collect();
    Table { about: String::new(), columns }
}

/// A result without the table is shown as one with nothing in it.
fn table<'a>(artifact: &'a Artifact, name: &str) -> std::borrow::Cow<'a, Table> {
    let empty = || std::borrow::Cow::Owned(Table { about: String::new(), columns: Vec::new() });
    artifact.table(name).map_or_else(empty, std::borrow::Cow::Borrowed)
}

/// Targets out of reach, one by one or together.
fn warnings(prediction: &Prediction) -> String {
    let mut text = String::new();
    let rows = prediction.response.iter().zip(&prediction.reach);
    for (name, reach) in rows.filter(|(_, reach)| reach.starts_with("out of reach")) {
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
fn notes(asked: &Asked, solution: &Artifact) -> String {
    let stored = table(solution, "solution");
    let Ok(Solved { misfit, evaluations, stop, free, .. }) = Solved::from_table(&stored) else { return String::new() };
    let first = |values: &[f64]| values.first().copied().unwrap_or(f64::NAN);
    let stop = stop.first().map_or("", String::as_str);
    let (misfit, evaluations) = (first(&misfit), evaluations.first().copied().unwrap_or_default());
    let mut text = format!("misfit {misfit:.1e} after {evaluations} evaluations: {stop}\n");
    let free = first(&free);
    if free > 0.0 {
        let preferred = asked.workflow.position(&asked.stage).is_some_and(|index| {
            let settings = asked.workflow.stages[index].stage.settings();
            settings["preference"].as_object().is_some_and(|own| !own.is_empty())
        });
        let near = if preferred { "the preferred point" } else { "the middle of the ranges" };
        let directions = if free > 1.0 { "directions" } else { "direction" };
        let others = table(solution, "solution_set").rows();
        let _ = writeln!(
            text,
            "not unique: the targets leave {free} {directions} free; this is the solution nearest {near}, \
             and {others} others are in the table `solution_set` (--json)"
        );
    }
    text
}

/// The results on fresh specimens.
pub(super) fn verified(verification: &Artifact) -> String {
    format!("\n{}\n", shown(&table(verification, "summary")))
}

/// One table as CSV.
pub(super) fn csv(artifact: &Artifact, name: &str) -> String {
    csv_text(&table(artifact, name))
}

/// All of it as one document: tables as lists of rows, with the units of their columns beside them.
pub(super) fn document(asked: &Asked, solution: &Artifact, verified: &[Arc<Artifact>]) -> Value {
    let best = table(solution, "solution");
    let units: serde_json::Map<String, Value> = best
        .columns
        .iter()
        .filter(|column| !column.unit.is_empty())
        .map(|column| (column.name.clone(), json!(column.unit)))
        .collect();
    let rows = |name: &str| rows_json(&table(solution, name));
    json!({
        "workflow": asked.workflow.name,
        "stage": asked.stage,
        "units": units,
        "solution": rows("solution").get(0),
        "parameters": rows("parameters"),
        "prediction": rows("prediction"),
        "solution_set": rows("solution_set"),
        "verification": verified.iter().map(|found| rows_json(&table(found, "summary"))).collect::<Vec<_>>(),
    })
}
