//! Figures of a calibration: convergence, parameter sets, verification.

use super::super::StageError;
use super::source::{Rows, Source, Sources, pick};
use super::{Label, Params};
use figure::convergence::{Convergence, Descent};
use figure::solutions::{SolutionSet, Solutions};
use figure::verification::{Check, Verification};

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

/// The set that each row belongs to.
fn sets_of(rows: Rows<'_>) -> Result<Vec<String>, StageError> {
    if rows.has("set") { rows.texts("set") } else { Ok(vec![String::new(); rows.len()]) }
}

pub(super) fn convergence(params: &Params, sources: &Sources) -> Result<Convergence, StageError> {
    let mut runs = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let rows = source.rows(&["history"])?;
        let (effort, best) = (rows.reals("evaluation", "")?, rows.reals("best", "")?);
        for (target, group) in by_target(&sets_of(rows)?) {
            let name = prefixed(params, k, &target_name(&target));
            let [effort, best] = [&effort, &best].map(|v| pick(v, &group));
            runs.push(Descent { name, effort, best, median: Vec::new() });
        }
    }
    Ok(Convergence { effort: "Evaluations of the model".into(), misfit: "Misfit $f$ / –".into(), runs })
}

pub(super) fn solutions(params: &Params, sources: &Sources) -> Result<Solutions, StageError> {
    let first = sources.first()?.rows(&["solution"])?;
    let labels: Vec<&Label> = params.factors.iter().filter(|f| first.has(&f.key)).collect();
    if labels.is_empty() {
        return Err(StageError::new("the solutions hold no factor of the workflow"));
    }
    let mut sets: Vec<SolutionSet> = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let best = source.rows(&["solution"])?;
        let further = source.rows(&["solution_set"]).ok();
        let others = further.map(sets_of).transpose()?.unwrap_or_default();
        let point = |rows: Rows<'_>, i: usize| -> Result<Vec<f64>, StageError> {
            labels.iter().map(|l| Ok(rows.reals(&l.key, &l.unit)?[i])).collect()
        };
        for (i, target) in sets_of(best)?.into_iter().enumerate() {
            let mut rows = vec![point(best, i)?];
            for j in (0..others.len()).filter(|&j| others[j] == target) {
                rows.extend(further.map(|f| point(f, j)).transpose()?);
            }
            sets.push(SolutionSet { name: prefixed(params, k, &target_name(&target)), rows, misfit: Vec::new() });
        }
    }
    let bound = |(k, label): (usize, &&Label)| {
        let (low, high) = figure::axis::extent(sets.iter().flat_map(|s| s.rows.iter().map(|r| r[k])));
        label.range.unwrap_or(if high > low { [low, high] } else { [low - 1.0, low + 1.0] })
    };
    let bounds = labels.iter().enumerate().map(bound).collect();
    Ok(Solutions { factors: labels.iter().map(|l| l.quantity()).collect(), bounds, sets })
}

/// Values of the runs, and the target of each set and response.
pub(super) fn verification(params: &Params, sources: &Sources) -> Result<Verification, StageError> {
    let source: Source = sources.first()?;
    let (runs, summary) = (source.rows(&["runs"])?, source.rows(&["summary"])?);
    let (of_run, of_line) = (sets_of(runs)?, sets_of(summary)?);
    let (responses, targets) = (summary.texts("response")?, summary.reals("target", "")?);
    let sets: Vec<String> = by_target(&of_line).into_iter().map(|(set, _)| set).collect();
    let mut checks = Vec::new();
    for response in params.responses.iter().filter(|r| runs.has(&r.key) && responses.contains(&r.key)) {
        let values = runs.reals(&response.key, &response.unit)?;
        let of = |set: &String| -> Vec<f64> {
            let hits = (0..values.len()).filter(|&i| of_run[i] == *set && values[i].is_finite());
            hits.map(|i| values[i]).collect()
        };
        let target = |set: &String| {
            let line = (0..responses.len()).find(|&i| of_line[i] == *set && responses[i] == response.key);
            line.map_or(f64::NAN, |i| targets[i])
        };
        checks.push(Check {
            response: response.quantity(),
            target: sets.iter().map(target).collect(),
            runs: sets.iter().map(of).collect(),
        });
    }
    if checks.is_empty() {
        return Err(StageError::new("no response is in both tables `runs` and `summary`"));
    }
    Ok(Verification { sets, checks })
}
