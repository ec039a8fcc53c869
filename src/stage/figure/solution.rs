//! Figures of a calibration: convergence, parameter sets, verification.

use super::super::StageError;
use super::source::{Source, Sources, pick};
use super::{Label, Params};
use crate::figure::convergence::{Convergence, Descent};
use crate::figure::solutions::{SolutionSet, Solutions};
use crate::figure::verification::{Check, Verification};

/// Rows of each target, in the order in which targets appear; one nameless group when there is no such column.
fn by_target(targets: &[String]) -> Vec<(String, Vec<usize>)> {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, target) in targets.iter().enumerate() {
        match groups.iter_mut().find(|(name, _)| name == target) {
            Some((_, rows)) => rows.push(i),
            None => groups.push((target.clone(), vec![i])),
        }
    }
    groups
}

/// "1" becomes "target 1"; a name stays as it is.
fn target_name(target: &str) -> String {
    if target.parse::<f64>().is_ok() { format!("target {target}") } else { target.to_owned() }
}

/// Prefix of a series when several stages are drawn together.
fn prefixed(params: &Params, input: usize, name: &str) -> String {
    match params.series.get(input) {
        Some(series) if name.is_empty() => series.clone(),
        Some(series) => format!("{series}, {name}"),
        None => name.to_owned(),
    }
}

pub(super) fn convergence(params: &Params, sources: &Sources) -> Result<Convergence, StageError> {
    let mut runs = Vec::new();
    let mut effort_word = "Evaluations";
    for (k, source) in sources.from.iter().enumerate() {
        let rows = source.rows(&["history"])?;
        let counter = ["simulations", "evaluations", "generation"].into_iter().find(|c| rows.has(c));
        let effort = rows.reals(counter.unwrap_or("evaluations"))?;
        effort_word = match counter {
            Some("simulations") => "Simulations",
            Some("generation") => "Generation",
            Some(_) | None => "Evaluations",
        };
        let best = rows.reals("best")?;
        let median = if rows.has("median") { rows.reals("median")? } else { Vec::new() };
        let targets = if rows.has("target") { rows.texts("target")? } else { vec![String::new(); rows.len()] };
        for (target, group) in by_target(&targets) {
            let name = prefixed(params, k, &target_name(&target));
            let [effort, best, median] = [&effort, &best, &median].map(|v| pick(v, &group));
            runs.push(Descent { name, effort, best, median });
        }
    }
    Ok(Convergence { effort: effort_word.into(), misfit: "Misfit $f$ / –".into(), runs })
}

pub(super) fn solutions(params: &Params, sources: &Sources) -> Result<Solutions, StageError> {
    let mut sets: Vec<SolutionSet> = Vec::new();
    let first = sources.first()?.rows(&["solution_set", "solution"])?;
    let labels: Vec<&Label> = params.factors.iter().filter(|f| first.has(&f.key)).collect();
    if labels.is_empty() {
        return Err(StageError::new("the solutions hold no factor of the workflow"));
    }
    let mut bounds: Vec<Option<[f64; 2]>> = labels.iter().map(|l| l.range).collect();
    for (k, source) in sources.from.iter().enumerate() {
        let rows = source.rows(&["solution_set", "solution"])?;
        let columns = labels.iter().map(|l| rows.reals(&l.key)).collect::<Result<Vec<_>, _>>()?;
        for (bound, column) in bounds.iter_mut().zip(&columns).filter(|(b, _)| b.is_none()) {
            let (low, high) = crate::figure::axis::extent(column.iter().copied());
            *bound = Some(if high > low { [low, high] } else { [low - 1.0, low + 1.0] });
        }
        let misfit = rows.reals("misfit")?;
        let targets = if rows.has("target") { rows.texts("target")? } else { vec![String::new(); rows.len()] };
        for (target, mut group) in by_target(&targets) {
            group.sort_by(|&a, &b| misfit[a].total_cmp(&misfit[b]));
            let values = group.iter().map(|&i| columns.iter().map(|c| c[i]).collect()).collect();
            let name = prefixed(params, k, &target_name(&target));
            sets.push(SolutionSet { name, rows: values, misfit: pick(&misfit, &group) });
        }
    }
    let factors = labels.iter().map(|l| l.quantity()).collect();
    Ok(Solutions { factors, bounds: bounds.into_iter().map(|b| b.unwrap_or([0.0, 1.0])).collect(), sets })
}

/// Values of the runs in long form, and the target of each set and response.
pub(super) fn verification(params: &Params, sources: &Sources) -> Result<Verification, StageError> {
    let source: Source = sources.first()?;
    let (runs, targets) = (source.rows(&["runs"])?, source.rows(&["targets"])?);
    let sets = targets.texts("target")?;
    let of_run = runs.texts("target")?;
    let mut checks = Vec::new();
    for response in params.responses.iter().filter(|r| runs.has(&r.key) && targets.has(&r.key)) {
        let values = runs.reals(&response.key)?;
        let of = |set: &String| {
            let hits = (0..values.len()).filter(|&i| of_run[i] == *set && values[i].is_finite());
            hits.map(|i| values[i]).collect::<Vec<f64>>()
        };
        checks.push(Check {
            response: response.quantity(),
            target: targets.reals(&response.key)?,
            runs: sets.iter().map(of).collect(),
        });
    }
    if checks.is_empty() {
        return Err(StageError::new("no response is in both tables `runs` and `targets`"));
    }
    Ok(Verification { sets, checks })
}
