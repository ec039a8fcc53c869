//! The outcome of the search of one target set.

use optim::solution_set::SolutionSet;
use optim::{Interval, Problem, Stop};

/// Evaluations of one set until all responses lay within each of [`crate::artifact::calibration::Percents::LEVELS`]; `None` where they never did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Effort {
    /// Until the responses of a run did.
    pub seen: [Option<usize>; 3],
    /// Until the expected responses of the recommended point did, and still did after every later batch.
    pub settled: [Option<usize>; 3],
}

/// One line of the history.
#[derive(Default)]
pub(super) struct Line {
    pub evaluation: usize,
    /// Whether it ran the coarse twins.
    pub coarse: bool,
    pub point: Vec<f64>,
    /// NaN where it failed.
    pub responses: Vec<f64>,
    pub misfit: f64,
    pub best: f64,
    /// Misfit of the recommended point once the batch of this evaluation was known; NaN before there is one.
    pub recommended: f64,
    pub failure: String,
    /// Why a run that is used is not valid.
    pub validity: String,
}

/// The solution of one target set.
pub(super) struct Solved {
    pub problem: Problem,
    pub stop: Stop,
    pub evaluations: usize,
    /// Evaluations on the coarse twins.
    pub coarse: usize,
    pub failed: usize,
    /// The solution, in natural units.
    pub point: Vec<f64>,
    pub expected: Vec<Interval>,
    /// The responses of the run at the solution, for methods that recommend one of their runs.
    pub observed: Option<Vec<f64>>,
    /// Standard deviation of a single run; NaN where it is unknown.
    pub scatter: Vec<f64>,
    pub misfit: f64,
    pub set: Option<SolutionSet>,
    /// Range of each factor over equally good solutions, natural units; `None` without a model.
    pub extents: Option<Vec<[f64; 2]>>,
    /// Why intervals are unknown, where they are.
    pub unknown: String,
    pub history: Vec<Line>,
    pub effort: Effort,
}

/// Target sets as tables number them, from 1.
pub(super) fn numbered(sets: impl Iterator<Item = usize>) -> Vec<i64> {
    sets.map(|set| set as i64 + 1).collect()
}
