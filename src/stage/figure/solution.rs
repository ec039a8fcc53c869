//! Figures of a calibration: convergence, parameter sets, verification.

use super::super::StageError;
use super::source::{Sources, pick};
use super::{Label, Params};
use crate::artifact::Table;
use crate::artifact::calibration::{Solution, Verification as Stored};
use crate::unit::Conversion;
use figure::convergence::{Convergence, Descent};
use figure::solutions::{SolutionSet, Solutions};
use figure::verification::{Check, Verification};

/// The target sets in the order of their first rows.
fn distinct(sets: &[i64]) -> Vec<i64> {
    let mut found: Vec<i64> = Vec::new();
    for set in sets {
        if !found.contains(set) {
            found.push(*set);
        }
    }
    found
}

/// The rows of a target set.
fn rows_of(sets: &[i64], set: i64) -> Vec<usize> {
    (0..sets.len()).filter(|&row| sets[row] == set).collect()
}

/// Prefix of the name of a series when several stages are drawn together.
fn prefixed(params: &Params, input: usize, name: &str) -> String {
    match params.series.get(input) {
        Some(series) => format!("{series}, {name}"),
        None => name.to_owned(),
    }
}

pub(super) fn convergence(params: &Params, sources: &Sources) -> Result<Convergence, StageError> {
    let mut runs = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let history = Solution::from_artifact(source.0)?.history;
        for set in distinct(&history.set) {
            let rows = rows_of(&history.set, set);
            let effort = rows.iter().map(|&row| history.evaluation[row] as f64).collect();
            let name = prefixed(params, k, &format!("target {set}"));
            runs.push(Descent { name, effort, best: pick(&history.best, &rows), median: Vec::new() });
        }
    }
    Ok(Convergence { effort: "Evaluations of the model".into(), misfit: "Misfit $f$ / –".into(), runs })
}

pub(super) fn solutions(params: &Params, sources: &Sources) -> Result<Solutions, StageError> {
    let first = Solution::from_artifact(sources.first()?.0)?.solution.point;
    let labels: Vec<&Label> = params.factors.iter().filter(|f| first.column(&f.key).is_some()).collect();
    if labels.is_empty() {
        return Err(StageError::new("the solutions hold no factor of the workflow"));
    }
    let points = |table: &Table| -> Result<Vec<Vec<f64>>, StageError> {
        let columns = labels.iter().map(|label| table.numbers(&label.key, &label.unit));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        Ok((0..table.rows()).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
    };
    let mut sets: Vec<SolutionSet> = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let stored = Solution::from_artifact(source.0)?;
        let (best, further) = (points(&stored.solution.point)?, points(&stored.solution_set.point)?);
        for (set, point) in stored.solution.set.into_iter().zip(best) {
            let rows = std::iter::once(point).chain(pick(&further, &rows_of(&stored.solution_set.set, set))).collect();
            sets.push(SolutionSet { name: prefixed(params, k, &format!("target {set}")), rows, misfit: Vec::new() });
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
    let Stored { summary, runs, not_valid } = Stored::from_artifact(sources.first()?.0)?;
    let (of_run, runs) = (runs.set, runs.runs);
    let sets = distinct(&summary.set);
    let mut checks = Vec::new();
    let both = |label: &&Label| runs.column(&label.key).is_some() && summary.response.contains(&label.key);
    for response in params.responses.iter().filter(both) {
        let values = runs.numbers(&response.key, &response.unit)?;
        let counts = |row: &usize| {
            let left_out = not_valid.as_ref().is_some_and(|list| list.leaves_out(&response.key, *row));
            values[*row].is_finite() && !left_out
        };
        let of = |set: &i64| -> Vec<f64> {
            let rows: Vec<usize> = rows_of(&of_run, *set).into_iter().filter(counts).collect();
            pick(&values, &rows)
        };
        let mut targets = Vec::with_capacity(sets.len());
        for set in &sets {
            let line = rows_of(&summary.set, *set).into_iter().find(|&line| summary.response[line] == response.key);
            targets.push(match line {
                Some(line) => {
                    let shown = Conversion::between(&summary.unit[line], &response.unit);
                    shown
                        .map_err(|e| StageError::new(format!("the target of `{}`: {e}", response.key)))?
                        .of(summary.target[line])
                }
                None => f64::NAN,
            });
        }
        checks.push(Check { response: response.quantity(), target: targets, runs: sets.iter().map(of).collect() });
    }
    if checks.is_empty() {
        return Err(StageError::new("no response is in both tables `runs` and `summary`"));
    }
    Ok(Verification { sets: sets.iter().map(i64::to_string).collect(), checks })
}
