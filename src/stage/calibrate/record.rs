//! The artifact `solution`.

use super::outlook;
use super::params::{FactorParam, Params, TargetParam};
use super::solved::{Line, Solved, numbered};
use crate::artifact::calibration::{self, Alternatives, Answer, Evaluations, Level, Percents, Solution};
use crate::artifact::{Artifact, Table};
use crate::stage::invalid::Invalid;
use crate::stage::notes::short;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The artifact of a calibration; `learned` are the sentences on the runs that it learned from.
pub(super) fn artifact(params: &Params, solved: &[Solved], learned: &[String]) -> Artifact {
    Solution {
        solution: solution(params, solved),
        parameters: outlook::parameters(params, solved),
        prediction: outlook::prediction(params, solved),
        history: history(params, solved),
        effort: effort(params, solved),
        solution_set: solution_set(params, solved),
        notes: outlook::notes(params, solved, learned),
    }
    .to_artifact()
}

/// Every response that some set has a target for, in the order of first mention.
fn responses(params: &Params) -> Vec<&TargetParam> {
    let mut found: Vec<&TargetParam> = Vec::new();
    for target in params.sets.iter().flat_map(|set| &set.targets) {
        if !found.iter().any(|other| other.response == target.response) {
            found.push(target);
        }
    }
    found
}

/// Every factor that some set holds, in order.
fn held(params: &Params) -> BTreeSet<&String> {
    params.sets.iter().flat_map(|set| set.held.keys()).collect()
}

/// Columns of the factors, calibrated and held, and of the responses; `rows` gives set, point and the responses of that
/// set's targets.
fn columns(params: &Params, rows: &[(usize, &[f64], &[f64])]) -> Table {
    let mut table = Table::default();
    for (i, FactorParam { name, unit, .. }) in params.factors.iter().enumerate() {
        table = table.reals_column(name, unit, "", rows.iter().map(|(_, point, _)| point[i]).collect());
    }
    for name in held(params) {
        let value = |set: usize| params.sets[set].held.get(name).copied().unwrap_or(f64::NAN);
        let unit = params.held_units.get(name).map_or("", String::as_str);
        table = table.reals_column(name, unit, "held", rows.iter().map(|(set, ..)| value(*set)).collect());
    }
    for TargetParam { response, unit, .. } in responses(params) {
        let value = |(set, _, values): &(usize, &[f64], &[f64])| {
            let index = params.sets[*set].targets.iter().position(|target| target.response == *response);
            index.and_then(|k| values.get(k).copied()).unwrap_or(f64::NAN)
        };
        table = table.reals_column(response, unit, "", rows.iter().map(value).collect());
    }
    table
}

fn solution(params: &Params, solved: &[Solved]) -> calibration::Solved {
    let means: Vec<Vec<f64>> = solved.iter().map(|s| s.expected.iter().map(|y| y.mean).collect()).collect();
    let rows: Vec<_> = solved.iter().zip(&means).enumerate().map(|(i, (s, y))| (i, &s.point[..], &y[..])).collect();
    let free = |s: &Solved| s.set.as_ref().map_or(f64::NAN, |set| set.free as f64);
    calibration::Solved {
        set: numbered(0..solved.len()),
        seed: seeds(params, 0..solved.len()),
        point: columns(params, &rows),
        misfit: solved.iter().map(|s| s.misfit).collect(),
        evaluations: solved.iter().map(|s| s.evaluations).collect(),
        coarse: params.full.is_some().then(|| solved.iter().map(|s| s.coarse).collect()),
        failed: solved.iter().map(|s| s.failed).collect(),
        stop: solved.iter().map(|s| s.stop.to_string()).collect(),
        met: (0..solved.len()).map(|set| outlook::met(params, solved, set)).collect(),
        free: solved.iter().map(free).collect(),
    }
}

/// The optimiser's seeds, if the sets have seeds of their own.
fn seeds(params: &Params, sets: impl IntoIterator<Item = usize>) -> Option<Vec<i64>> {
    sets.into_iter().map(|set| params.sets[set].seed.map(|seed| seed as i64)).collect()
}

/// The message of `flow run` on targets that are not met; `None` when all are.
pub(super) fn unmet(solution: &Artifact) -> Option<String> {
    let found = Solution::from_artifact(solution).ok()?.prediction;
    let several = found.set.iter().any(|set| *set != 1);
    let mut missed = Vec::new();
    for i in (0..found.met.len()).filter(|&i| found.met[i] != Answer::Yes) {
        let whose = if several { format!("set {}: ", found.set[i]) } else { String::new() };
        let unit = if found.unit[i].is_empty() { String::new() } else { format!(" {}", found.unit[i]) };
        let why = if found.out_of_reach(i) { format!(", {}", found.reach[i]) } else { String::new() };
        let expected = short(found.expected[i]);
        missed.push(format!("{whose}{} is expected to be {expected}{unit}{why}", found.response[i]));
    }
    (!missed.is_empty()).then(|| missed.join("; "))
}

fn effort(params: &Params, solved: &[Solved]) -> calibration::Effort {
    let percents = |pick: fn(&Solved) -> &[Option<usize>; 3]| {
        let count = |s: &Solved, level: usize| pick(s)[level].map_or(f64::NAN, |count| count as f64);
        Percents([0, 1, 2].map(|level| solved.iter().map(|s| count(s, level)).collect()))
    };
    calibration::Effort {
        set: numbered(0..solved.len()),
        seed: seeds(params, 0..solved.len()),
        method: vec![method(params); solved.len()],
        evaluations: solved.iter().map(|s| s.evaluations).collect(),
        coarse: solved.iter().map(|s| s.coarse).collect(),
        to: percents(|s| &s.effort.seen),
        expected: percents(|s| &s.effort.settled),
    }
}

/// The method as a workflow writes it.
fn method(params: &Params) -> String {
    match serde_json::to_value(&params.method) {
        Ok(value) => match (&value["method"], &value["preset"]) {
            (Value::String(name), Value::String(preset)) => format!("{name}, {preset}"),
            (Value::String(name), _) => name.clone(),
            (other, _) => panic!("BUG: a method's name is a text, not {other:?}"),
        },
        Err(error) => panic!("BUG: settings of a method are plain values: {error}"),
    }
}

fn history(params: &Params, solved: &[Solved]) -> Evaluations {
    let all: Vec<(usize, &Line)> =
        solved.iter().enumerate().flat_map(|(set, s)| s.history.iter().map(move |line| (set, line))).collect();
    let rows: Vec<_> = all.iter().map(|(set, line)| (*set, &line.point[..], &line.responses[..])).collect();
    let reals = |pick: fn(&Line) -> f64| all.iter().map(|(_, line)| pick(line)).collect();
    let texts = |pick: fn(&Line) -> &String| all.iter().map(|(_, line)| pick(line).clone()).collect();
    let level = |line: &Line| if line.coarse { Level::Coarse } else { Level::Full };
    let simulated = !params.history.is_empty();
    Evaluations {
        set: numbered(all.iter().map(|(set, _)| *set)),
        evaluation: all.iter().map(|(_, line)| line.evaluation).collect(),
        seed: seeds(params, all.iter().map(|(set, _)| *set)),
        level: params.full.is_some().then(|| all.iter().map(|(_, line)| level(line)).collect()),
        row: simulated.then(|| shown(params, &all)),
        point: columns(params, &rows),
        misfit: reals(|line| line.misfit),
        best: reals(|line| line.best),
        recommended: reals(|line| line.recommended),
        failure: texts(|line| &line.failure),
        validity: (simulated && params.invalid == Invalid::Keep).then(|| texts(|line| &line.validity)),
    }
}

/// The row of each evaluation's simulation among the stage's tasks, counted from 1. Sets whose first points are equal share
/// their simulations, which have the rows of the first of these sets.
fn shown(params: &Params, all: &[(usize, &Line)]) -> Vec<usize> {
    let (sets, simulators) = (params.sets.len(), params.simulators);
    let coarse = |set: usize| params.history[set].coarse.len();
    let index = |set: usize, line: &Line| line.evaluation - 1 + if line.coarse { 0 } else { coarse(set) };
    let same = |a: &Line, b: &Line| (a.evaluation, a.coarse) == (b.evaluation, b.coarse) && a.point == b.point;
    let mut by_index: BTreeMap<(bool, usize), Vec<(usize, &Line)>> = BTreeMap::new();
    let mut rows = Vec::with_capacity(all.len());
    for &(set, line) in all {
        let seen = by_index.entry((line.coarse, line.evaluation)).or_default();
        let alike = |(other, like): &&(usize, &Line)| {
            same(like, line)
                && params.sets[*other].held == params.sets[set].held
                && index(*other, like) == index(set, line)
        };
        let owner = seen.iter().find(alike).map_or(set, |(other, _)| *other);
        rows.push((index(set, line) * sets + owner) * simulators + 1);
        seen.push((set, line));
    }
    rows
}

fn solution_set(params: &Params, solved: &[Solved]) -> Alternatives {
    let (mut sets, mut points) = (Vec::new(), Vec::new());
    for (i, s) in solved.iter().enumerate() {
        for unit in s.set.iter().flat_map(|set| &set.sample) {
            sets.push(i);
            points.push(s.problem.domain.natural(unit));
        }
    }
    let mut point = Table::default();
    for (i, FactorParam { name, unit, .. }) in params.factors.iter().enumerate() {
        point = point.reals_column(name, unit, "", points.iter().map(|point: &Vec<f64>| point[i]).collect());
    }
    Alternatives { set: numbered(sets.into_iter()), point }
}
