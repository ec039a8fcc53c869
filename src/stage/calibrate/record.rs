//! The artifact `solution`.

use super::effort::LEVELS;
use super::outlook::{self, Met};
use super::params::{FactorParam, Params, TargetParam};
use super::solve::{Line, Solved};
use crate::artifact::{Artifact, ArtifactKind, Group, Node, Table};
use crate::stage::invalid::Invalid;
use crate::stage::notes::short;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The tables of a calibration; `learned` are the sentences on the runs that it learned from.
pub(super) fn artifact(params: &Params, solved: &[Solved], learned: &[String]) -> Artifact {
    let root = Group::new()
        .with("solution", Node::Table(solution(params, solved)))
        .with("parameters", Node::Table(outlook::parameters(params, solved)))
        .with("prediction", Node::Table(outlook::prediction(params, solved)))
        .with("history", Node::Table(history(params, solved)))
        .with("effort", Node::Table(effort(params, solved)))
        .with("solution_set", Node::Table(solution_set(params, solved)))
        .with("notes", Node::Table(outlook::notes(params, solved, learned)));
    Artifact::of(ArtifactKind::SOLUTION, root)
}

pub(super) fn named(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
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
fn columns(mut table: Table, params: &Params, rows: &[(usize, &[f64], &[f64])]) -> Table {
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
            let place = params.sets[*set].targets.iter().position(|target| target.response == *response);
            place.and_then(|k| values.get(k).copied()).unwrap_or(f64::NAN)
        };
        table = table.reals_column(response, unit, "", rows.iter().map(value).collect());
    }
    table
}

pub(super) fn numbered(sets: impl Iterator<Item = usize>) -> Vec<i64> {
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
    let mut table = columns(seeded(table, params, (0..solved.len()).collect()), params, &rows)
        .reals_column("misfit", "", "of the predicted responses", solved.iter().map(|s| s.misfit).collect())
        .ints_column("evaluations", "of the model", solved.iter().map(|s| s.evaluations as i64).collect());
    if params.full.is_some() {
        let coarse = solved.iter().map(|s| s.coarse as i64).collect();
        table = table.ints_column("coarse", "evaluations on the coarse twins", coarse);
    }
    let met = (0..solved.len()).map(|i| outlook::met(params, solved, i).word().to_owned()).collect();
    table
        .ints_column("failed", "evaluations without responses", solved.iter().map(|s| s.failed as i64).collect())
        .texts_column("stop", "why the search ended", solved.iter().map(|s| s.stop.to_string()).collect())
        .texts_column("met", "whether all targets are expected to be met", met)
        .reals_column("free", "", "directions that change no response", solved.iter().map(free).collect())
}

/// A column of the optimiser's seeds, where sets differ by them.
fn seeded(table: Table, params: &Params, sets: Vec<usize>) -> Table {
    let seeds: Option<Vec<i64>> = sets.into_iter().map(|set| params.sets[set].seed.map(|seed| seed as i64)).collect();
    match seeds {
        Some(seeds) => table.ints_column("seed", "of the optimiser", seeds),
        None => table,
    }
}

/// The message of `flow run` on targets that are not met; `None` when all are.
pub(super) fn unmet(solution: &Artifact) -> Option<String> {
    let table = solution.table("prediction")?;
    let texts = |name: &str| table.texts(name).ok();
    let (responses, met, reach, units) = (texts("response")?, texts("met")?, texts("reach")?, texts("unit")?);
    let (sets, expected) = (table.ints("set").ok()?, table.numbers("expected", "").ok()?);
    let several = sets.iter().any(|set| *set != 1);
    let mut missed = Vec::new();
    for i in (0..met.len()).filter(|&i| met[i] != Met::Yes.word()) {
        let whose = if several { format!("set {}: ", sets[i]) } else { String::new() };
        let unit = if units[i].is_empty() { String::new() } else { format!(" {}", units[i]) };
        let why = if reach[i].starts_with("out of reach") { format!(", {}", reach[i]) } else { String::new() };
        missed.push(format!("{whose}{} is expected to be {}{unit}{why}", responses[i], short(expected[i])));
    }
    (!missed.is_empty()).then(|| missed.join("; "))
}

fn effort(params: &Params, solved: &[Solved]) -> Table {
    let count = |pick: fn(&Solved) -> Option<usize>| {
        solved.iter().map(|s| pick(s).map_or(f64::NAN, |count| count as f64)).collect::<Vec<_>>()
    };
    let table = named("evaluations until all responses lay near their targets; none where they never did").ints_column(
        "set",
        "target set, from 1",
        numbered(0..solved.len()),
    );
    let mut table = seeded(table, params, (0..solved.len()).collect())
        .texts_column("method", "", solved.iter().map(|_| method(params)).collect())
        .ints_column("evaluations", "in all", solved.iter().map(|s| s.evaluations as i64).collect())
        .ints_column("coarse", "before them, on coarse twins", solved.iter().map(|s| s.coarse as i64).collect());
    let seen: [fn(&Solved) -> Option<usize>; 3] = [|s| s.effort.seen[0], |s| s.effort.seen[1], |s| s.effort.seen[2]];
    let settled: [fn(&Solved) -> Option<usize>; 3] =
        [|s| s.effort.settled[0], |s| s.effort.settled[1], |s| s.effort.settled[2]];
    for (what, about, picks) in
        [("to", "until a run showed it", seen), ("expected", "until the recommended point was expected to", settled)]
    {
        for (level, pick) in LEVELS.iter().zip(picks) {
            table = table.reals_column(&format!("{what}_{}_percent", 100.0 * level), "", about, count(pick));
        }
    }
    table
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

fn history(params: &Params, solved: &[Solved]) -> Table {
    let all: Vec<(usize, &Line)> =
        solved.iter().enumerate().flat_map(|(set, s)| s.history.iter().map(move |line| (set, line))).collect();
    let rows: Vec<_> = all.iter().map(|(set, line)| (*set, &line.point[..], &line.responses[..])).collect();
    let count = all.iter().map(|(_, line)| line.evaluation as i64).collect();
    let table = named("evaluations: all simulations, or those that improved on a surface")
        .ints_column("set", "target set, from 1", numbered(all.iter().map(|(set, _)| *set)))
        .ints_column("evaluation", "counted from 1", count);
    let simulated = !params.history.is_empty();
    let mut table = seeded(table, params, all.iter().map(|(set, _)| *set).collect());
    if params.full.is_some() {
        let level = |line: &Line| if line.coarse { "coarse" } else { "full" }.to_owned();
        table = table.texts_column("level", "which simulators", all.iter().map(|(_, line)| level(line)).collect());
    }
    if simulated {
        table = table.ints_column("row", "of the stage, which shows the simulation", shown(params, &all));
    }
    let mut table = columns(table, params, &rows)
        .reals_column("misfit", "", "of this evaluation", all.iter().map(|(_, line)| line.misfit).collect())
        .reals_column("best", "", "best misfit so far", all.iter().map(|(_, line)| line.best).collect())
        .reals_column(
            "recommended",
            "",
            "misfit expected at the point that was recommended then",
            all.iter().map(|(_, line)| line.recommended).collect(),
        )
        .texts_column("failure", "empty when it went well", all.iter().map(|(_, line)| line.failure.clone()).collect());
    if simulated && params.invalid == Invalid::Keep {
        let why = all.iter().map(|(_, line)| line.validity.clone()).collect();
        table = table.texts_column("validity", "checks that a run does not meet; empty when all are valid", why);
    }
    table
}

/// The row of each evaluation's simulation among the stage's tasks, counted from 1. Sets whose first points are equal share
/// their simulations, which have the rows of the first of these sets.
fn shown(params: &Params, all: &[(usize, &Line)]) -> Vec<i64> {
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
        rows.push(((index(set, line) * sets + owner) * simulators) as i64 + 1);
        seen.push((set, line));
    }
    rows
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
