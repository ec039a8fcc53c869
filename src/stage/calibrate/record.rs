//! The artifact `solution`.

use super::params::{FactorParam, Params, TargetParam};
use super::solve::{Line, Solved};
use crate::artifact::calibration::{Alternatives, Evaluations, Prediction, Solution, Solved as Stored};
use crate::artifact::{Artifact, Table};
use optim::Interval;

/// The tables of a calibration.
pub(super) fn artifact(params: &Params, solved: &[Solved]) -> Artifact {
    let artifact = Solution {
        solution: solution(params, solved),
        prediction: prediction(params, solved),
        history: history(params, solved),
        solution_set: solution_set(params, solved),
    };
    artifact.to_artifact()
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
fn columns(params: &Params, rows: &[(usize, &[f64], &[f64])]) -> Table {
    let mut table = Table::default();
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
    let stored = Stored {
        set: numbered(0..solved.len()),
        misfit: solved.iter().map(|s| s.misfit).collect(),
        evaluations: solved.iter().map(|s| s.evaluations as i64).collect(),
        failed: solved.iter().map(|s| s.failed as i64).collect(),
        stop: solved.iter().map(|s| s.stop.to_string()).collect(),
        free: solved.iter().map(free).collect(),
    };
    stored.to_table().with_after("set", columns(params, &rows))
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

fn prediction(params: &Params, solved: &[Solved]) -> Prediction {
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
    Prediction {
        set: numbered(rows.iter().map(|row| row.set)),
        response: rows.iter().map(|row| row.target.response.clone()).collect(),
        unit: rows.iter().map(|row| row.target.unit.clone()).collect(),
        target: reals(|row| row.target.value),
        expected: reals(|row| row.expected.mean),
        low: reals(|row| row.expected.low),
        high: reals(|row| row.expected.high),
        deviation_percent: reals(|row| row.deviation),
        reach_low: reals(|row| row.reach[0]),
        reach_high: reals(|row| row.reach[1]),
        reach: rows.iter().map(verdict).collect(),
    }
}

fn history(params: &Params, solved: &[Solved]) -> Table {
    let all: Vec<(usize, &Line)> =
        solved.iter().enumerate().flat_map(|(set, s)| s.history.iter().map(move |line| (set, line))).collect();
    let rows: Vec<_> = all.iter().map(|(set, line)| (*set, &line.point[..], &line.responses[..])).collect();
    let stored = Evaluations {
        set: numbered(all.iter().map(|(set, _)| *set)),
        evaluation: all.iter().map(|(_, line)| line.evaluation as i64).collect(),
        misfit: all.iter().map(|(_, line)| line.misfit).collect(),
        best: all.iter().map(|(_, line)| line.best).collect(),
        recommended: all.iter().map(|(_, line)| line.recommended).collect(),
        failure: all.iter().map(|(_, line)| line.failure.clone()).collect(),
    };
    stored.to_table().with_after("evaluation", columns(params, &rows))
}

fn solution_set(params: &Params, solved: &[Solved]) -> Table {
    let mut points: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, s) in solved.iter().enumerate() {
        let sample = s.set.iter().flat_map(|set| &set.sample);
        points.extend(sample.map(|unit| (i, s.problem.domain.natural(unit))));
    }
    let mut table = Alternatives { set: numbered(points.iter().map(|(set, _)| *set)) }.to_table();
    for (i, FactorParam { name, unit, .. }) in params.factors.iter().enumerate() {
        table = table.reals_column(name, unit, "", points.iter().map(|(_, point)| point[i]).collect());
    }
    table
}
