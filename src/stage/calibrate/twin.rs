//! Predictions of full-size runs from coarse ones, corrected by full-size runs.

use super::params::Told;
use crate::stage::StageError;
use optim::search::{Limits, Method};
use optim::surrogate::models::Models;
use optim::surrogate::{self, Trend};
use optim::{Problem, Trial};
use std::sync::Arc;

/// The models of the coarse runs.
pub(super) struct Twin(Models);

impl Twin {
    /// The models over the runs of a finished search.
    ///
    /// # Errors
    /// No coarse run gave responses.
    pub(super) fn of(problem: &Problem, told: &[Told]) -> Result<Self, StageError> {
        let models = fitted(problem, told).ok_or_else(|| {
            let first = told.iter().find(|told| !told.failure.is_empty()).map_or("", |told| told.failure.as_str());
            StageError::new(format!("all {} coarse simulations failed; the first: {first}", told.len()))
                .hint("look at the ranges of the factors, and at one run with `flow show`")
        })?;
        Ok(Self(models))
    }

    /// Its responses as the prior mean of the surrogate, at a point in natural units.
    pub(super) fn trend(self) -> Trend {
        let models = self.0;
        Arc::new(move |point: &[f64]| Some(models.expected_at(point)))
    }
}

/// Most runs in a model: those nearest the best one, and others from the whole history.
const NEAR: usize = 80;
const SPREAD: usize = 40;

/// Models over the runs of a search, most of them near its best run; `None` when no run gave responses.
pub(super) fn fitted(problem: &Problem, told: &[Told]) -> Option<Models> {
    let trials: Vec<Trial> = told.iter().map(|told| trial(problem, told)).collect();
    let misfit = |trial: &Trial| if trial.succeeded() { trial.misfit } else { f64::INFINITY };
    let best = trials.iter().min_by(|a, b| misfit(a).total_cmp(&misfit(b))).filter(|best| best.succeeded())?;
    let distance = |trial: &Trial| {
        let squares = trial.point.iter().zip(&best.point).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>()
    };
    let mut order: Vec<usize> = (0..trials.len()).collect();
    order.sort_by(|&a, &b| distance(&trials[a]).total_cmp(&distance(&trials[b])));
    let (near, far) = order.split_at(order.len().min(NEAR));
    let mut chosen = near.to_vec();
    let mut far = far.to_vec();
    far.sort_unstable();
    chosen.extend((0..far.len().min(SPREAD)).map(|k| far[k * far.len() / far.len().min(SPREAD)]));
    chosen.sort_unstable();
    let chosen: Vec<Trial> = chosen.into_iter().map(|i| trials[i].clone()).collect();
    Models::fit(&chosen, problem, true, None)
}

fn trial(problem: &Problem, told: &Told) -> Trial {
    let responses = told.responses.clone().unwrap_or_default();
    let misfit = if responses.is_empty() { f64::INFINITY } else { problem.misfit.of(&responses) };
    Trial { point: problem.domain.unit(&told.point), misfit, responses }
}

/// The search of the full-size runs: by the surrogate, with the calibration's own settings where that is its method.
pub(super) fn full_method(method: &Method, runs: usize) -> Method {
    let own = match method {
        Method::Surrogate(settings) => settings.clone(),
        Method::Genetic(_)
        | Method::Annealing(_)
        | Method::Differential(_)
        | Method::CmaEs(_)
        | Method::Proportional(_) => surrogate::Settings::default(),
    };
    Method::Surrogate(surrogate::Settings { runs, ..own })
}

/// When the full-size runs end: with their number, or as the calibration ends.
pub(super) fn full_limits(limits: &Limits, runs: usize) -> Limits {
    Limits { evaluations: Some(runs), misfit: limits.misfit, polish: false }
}
