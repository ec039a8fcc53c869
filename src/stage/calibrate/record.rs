//! The artifact `solution`.

use super::params::{FactorParam, Params, TargetParam};
use super::solve::{Line, Solved};
use crate::artifact::{Artifact, ArtifactKind, Group, Node, Table};
use optim::Interval;

/// The tables of a calibration.
pub(super) fn artifact(params: &Params, solved: &[Solved]) -> Artifact {
    let root = Group::new()
        .with("solution", Node::Table(solution(params, solved)))
        .with("prediction", Node::Table(prediction(params, solved)))
        .with("history", Node::Table(history(params, solved)))
        .with("solution_set", Node::Table(solution_set(params, solved)));
    Artifact::of(ArtifactKind::SOLUTION, root)
}

fn named(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
}

/// Every response that some set has a target for, in the order of first mention.
fn responses(params: &Params) -> Vec<&TargetParam> {
    let mut found: Vec<&TargetParam> = Vec::new();
    for target in params.sets.iter().flatten() {
        if !found.iter().any(|other| other.response == target.response) {
            found.push(target);
        }
    }
    found
}

/// Columns of the factors and of the responses; `rows` gives set, point and the responses of that set's targets.
fn columns(mut table: Table, params: &Params, rows: &[(usize, &[f64], &[f64])]) -> Table {
    for (i, FactorParam { name, unit, .. }) in params.factors.iter().enumerate() {
        table = table.reals_column(name, unit, "", rows.iter().map(|(_, point, _)| point[i]).collect());
    }
    for TargetParam { response, unit, .. } in responses(params) {
        let value = |(set, _, values): &(usize, &[f64], &[f64])| {
            let place = params.sets[*set].iter().position(|target| target.response == *response);
            place.and_then(|k| values.get(k).copied()).unwrap_or(f64::NAN)
        };
        table = table.reals_column(response, unit, "", rows.iter().map(value).collect());
    }
    table
}

fn numbered(sets: impl Iterator<Item = usize>) -> Vec<i64> {
    sets.map(|set| set as i64 + 1).collect()
}

fn solution(params: &Params, solved: &[Solved]) -> Table {
    let means: Vec<Vec<f64>> = solved.iter().map(|s| s.expected.iter().map(|y| y.mean).collect()).collect();
    let rows: Vec<_> = solved.iter().zip(&means).enumerate().map(|(i, (s, y))| (i, &s.point[..], &y[..])).collect();
    let free = |s: &Solved| s.set.as_ref().map_or(f64::NAN, |set| set.free as f64);
    let table = named("calibrated parameters and the responses they are predicted to give").ints_column(
        "set",
        "target set, from 1",
        numbered(0..solved.len()),
    );
    columns(table, params, &rows)
        .reals_column("misfit", "", "of the predicted responses", solved.iter().map(|s| s.misfit).collect())
        .ints_column("evaluations", "of the model", solved.iter().map(|s| s.evaluations as i64).collect())
        .ints_column("failed", "evaluations without responses", solved.iter().map(|s| s.failed as i64).collect())
        .texts_column("stop", "why the search ended", solved.iter().map(|s| s.stop.to_string()).collect())
        .reals_column("free", "", "directions that change no response", solved.iter().map(free).collect())
}

/// One row per set and target.
struct Predicted<'a> {
    set: usize,
    target: &'a TargetParam,
    expected: Interval,
    deviation: f64,
    reach: [f64; 2],
}

fn predicted<'a>(params: &'a Params, solved: &[Solved]) -> Vec<Predicted<'a>> {
    let mut rows = Vec::new();
    for (set, s) in solved.iter().enumerate() {
        let means: Vec<f64> = s.expected.iter().map(|y| y.mean).collect();
        let deviations = s.problem.misfit.deviations(&means);
        for (k, target) in params.sets[set].iter().enumerate() {
            let reach = s.set.as_ref().map(|set| &set.reach[k]);
            rows.push(Predicted {
                set,
                target,
                expected: s.expected[k],
                deviation: 100.0 * deviations[k],
                reach: reach.map_or([f64::NAN; 2], |r| [r.low, r.high]),
            });
        }
    }
    rows
}

fn prediction(params: &Params, solved: &[Solved]) -> Table {
    let rows = predicted(params, solved);
    let reals = |pick: fn(&Predicted) -> f64| rows.iter().map(pick).collect::<Vec<_>>();
    let verdict = |row: &Predicted| {
        let [low, high] = row.reach;
        match row.target.value {
            value if value < low => format!("out of reach, at least {low:.4}"),
            value if value > high => format!("out of reach, at most {high:.4}"),
            _ if low.is_nan() => "unknown".to_owned(),
            _ => "within reach".to_owned(),
        }
    };
    named("targets, what is expected, and what can be had over the ranges")
        .ints_column("set", "target set, from 1", numbered(rows.iter().map(|row| row.set)))
        .texts_column("response", "", rows.iter().map(|row| row.target.response.clone()).collect())
        .texts_column("unit", "of the numbers beside it", rows.iter().map(|row| row.target.unit.clone()).collect())
        .reals_column("target", "", "wanted", reals(|row| row.target.value))
        .reals_column("expected", "", "at the solution", reals(|row| row.expected.mean))
        .reals_column("low", "", "lower end of the 95 % interval of the mean", reals(|row| row.expected.low))
        .reals_column("high", "", "upper end", reals(|row| row.expected.high))
        .reals_column("deviation_percent", "", "as in the misfit", reals(|row| row.deviation))
        .reals_column("reach_low", "", "least over the ranges", reals(|row| row.reach[0]))
        .reals_column("reach_high", "", "greatest over the ranges", reals(|row| row.reach[1]))
        .texts_column("reach", "whether the target can be had by itself", rows.iter().map(verdict).collect())
}

fn history(params: &Params, solved: &[Solved]) -> Table {
    let all: Vec<(usize, &Line)> =
        solved.iter().enumerate().flat_map(|(set, s)| s.history.iter().map(move |line| (set, line))).collect();
    let rows: Vec<_> = all.iter().map(|(set, line)| (*set, &line.point[..], &line.responses[..])).collect();
    let count = all.iter().map(|(_, line)| line.evaluation as i64).collect();
    let table = named("evaluations: all simulations, or those that improved on a surface")
        .ints_column("set", "target set, from 1", numbered(all.iter().map(|(set, _)| *set)))
        .ints_column("evaluation", "counted from 1", count);
    columns(table, params, &rows)
        .reals_column("misfit", "", "of this evaluation", all.iter().map(|(_, line)| line.misfit).collect())
        .reals_column("best", "", "best misfit so far", all.iter().map(|(_, line)| line.best).collect())
        .reals_column(
            "recommended",
            "",
            "misfit expected at the point that was recommended then",
            all.iter().map(|(_, line)| line.recommended).collect(),
        )
        .texts_column("failure", "empty when it went well", all.iter().map(|(_, line)| line.failure.clone()).collect())
}

fn solution_set(params: &Params, solved: &[Solved]) -> Table {
    let mut points: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, s) in solved.iter().enumerate() {
        let sample = s.set.iter().flat_map(|set| &set.sample);
        points.extend(sample.map(|unit| (i, s.problem.domain.natural(unit))));
    }
    let mut table = named("further parameters that give the responses of the solution").ints_column(
        "set",
        "target set, from 1",
        numbered(points.iter().map(|(set, _)| *set)),
    );
    for (i, FactorParam { name, unit, .. }) in params.factors.iter().enumerate() {
        table = table.reals_column(name, unit, "", points.iter().map(|(_, point)| point[i]).collect());
    }
    table
}
