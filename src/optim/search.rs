//! The loop around an optimiser: budgets, the best so far, replay.
//!
//! [`next`] is a pure function: the same problem, settings, seed and history give the same points or the same end.
//! [`Search`] is the same loop held open, for models that answer at once.

use super::annealing::Annealing;
use super::cma_es::CmaEs;
use super::differential::Differential;
use super::genetic::Genetic;
use super::polish::Polish;
use super::proportional::Proportional;
use super::surrogate::{Surrogate, Trend};
use super::{Error, Interval, Optimiser, Problem, Recommendation, Stop, Trial};
use super::{annealing, cma_es, differential, genetic, proportional, surrogate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which optimiser, with its settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "method", rename_all = "kebab-case")]
pub enum Method {
    /// MATLAB's genetic algorithm.
    Genetic(genetic::Settings),
    /// Improved simulated annealing.
    Annealing(annealing::Settings),
    /// Adaptive differential evolution.
    Differential(differential::Settings),
    /// Covariance matrix adaptation.
    CmaEs(cma_es::Settings),
    /// One model per response over all runs.
    Surrogate(surrogate::Settings),
    /// Corrections of one parameter by the slope that the last run showed.
    Proportional(proportional::Settings),
}

/// When any method ends, and whether its end is refined.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Most evaluations.
    pub evaluations: Option<usize>,
    /// A misfit that is good enough.
    pub misfit: Option<f64>,
    /// Refine the best point at the end ([`super::polish`]): for models without noise.
    pub polish: bool,
}

/// Prior knowledge of the surrogate; the other methods do not use it.
#[derive(Clone, Default)]
pub struct Knowledge {
    /// Runs of other stages; a response that a run lacks is NaN.
    pub earlier: Vec<Run>,
    /// Responses believed beforehand, which runs then correct.
    pub trend: Option<Trend>,
}

/// A finished run: where, and what it gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The parameters in natural units.
    pub point: Vec<f64>,
    /// The responses in the order of the targets; none when it failed.
    pub responses: Option<Vec<f64>>,
}

/// State of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Evaluations received.
    pub evaluations: usize,
    /// Evaluations that failed.
    pub failed: usize,
    /// The best trial.
    pub best: Option<Trial>,
    /// The recommended point: that of the method, or the best trial.
    pub recommended: Option<Recommendation>,
}

/// What to do next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Evaluate these points (natural units); they can run in parallel.
    Ask(Vec<Vec<f64>>),
    /// The search is over.
    Stop(Stop, State),
}

/// The next points or the end, from the history alone.
///
/// Where the history ends within a batch the rest of that batch is requested.
///
/// # Errors
/// [`Error::ForeignHistory`] when the history does not belong to these settings and this seed.
pub fn next(
    problem: &Problem,
    method: &Method,
    limits: &Limits,
    seed: u64,
    knowledge: &Knowledge,
    history: &[Run],
) -> Result<Next, Error> {
    replay(&mut Search::new(problem, method, limits, seed, knowledge), history, |_| ())
}

/// Replays the history in a fresh search; `seen` is shown the search after every whole batch.
///
/// # Errors
/// As [`next`].
pub fn replay(search: &mut Search, history: &[Run], mut seen: impl FnMut(&Search)) -> Result<Next, Error> {
    let mut received = history;
    loop {
        if let Some(stop) = search.stop() {
            return Ok(Next::Stop(stop, search.state()));
        }
        let asked = search.ask();
        for (i, (asked, run)) in asked.iter().zip(received).enumerate() {
            if *asked != run.point {
                let index = history.len() - received.len() + i;
                return Err(Error::ForeignHistory { index, asked: asked.clone(), found: run.point.clone() });
            }
        }
        if received.len() < asked.len() {
            return Ok(Next::Ask(asked[received.len()..].to_vec()));
        }
        let (batch, rest) = received.split_at(asked.len());
        search.tell(&batch.iter().map(|run| run.responses.clone()).collect::<Vec<_>>());
        seen(search);
        received = rest;
    }
}

/// Minimises the misfit of a model that answers at once; `model` gives the responses in the order of the targets.
pub fn minimise(
    problem: &Problem,
    method: &Method,
    limits: &Limits,
    seed: u64,
    mut model: impl FnMut(&[f64]) -> Option<Vec<f64>>,
) -> (Stop, State) {
    let mut search = Search::new(problem, method, limits, seed, &Knowledge::default());
    loop {
        if let Some(stop) = search.stop() {
            return (stop, search.state());
        }
        let asked = search.ask();
        search.tell(&asked.iter().map(|point| model(point)).collect::<Vec<_>>());
    }
}

/// Failures in a row, from the first run, that end a search.
const HOPELESS: usize = 30;
/// Share of the budget reserved for the final refinement.
const POLISHING: f64 = 0.1;

/// An optimiser with its budget and its best point.
pub struct Search {
    problem: Problem,
    optimiser: Box<dyn Optimiser>,
    limits: Limits,
    seed: u64,
    polish: Option<Polish>,
    /// Why the method itself ended, once it has.
    ended: Option<Stop>,
    asked: Vec<Vec<f64>>,
    evaluations: usize,
    failed: usize,
    best: Option<Trial>,
}

impl Search {
    /// A fresh search.
    pub fn new(problem: &Problem, method: &Method, limits: &Limits, seed: u64, knowledge: &Knowledge) -> Self {
        let (domain, start) = (&problem.domain, problem.start.as_deref());
        let optimiser: Box<dyn Optimiser> = match method {
            Method::Genetic(s) => Box::new(Genetic::new(s, domain, seed, start)),
            Method::Annealing(s) => Box::new(Annealing::new(s, domain, seed, start)),
            Method::Differential(s) => Box::new(Differential::new(s, domain, seed, start)),
            Method::CmaEs(s) => Box::new(CmaEs::new(s, domain, seed, start.unwrap_or(domain.centre()))),
            Method::Proportional(s) => Box::new(Proportional::new(s, problem)),
            Method::Surrogate(s) => {
                let known = knowledge.earlier.iter().map(|run| earlier(problem, run)).collect();
                Box::new(Surrogate::new(s, problem, seed, known, knowledge.trend.clone()))
            }
        };
        Self {
            problem: problem.clone(),
            optimiser,
            limits: limits.clone(),
            seed,
            polish: None,
            ended: None,
            asked: Vec::new(),
            evaluations: 0,
            failed: 0,
            best: None,
        }
    }

    /// The next batch in natural units; at least one point.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        self.asked = match &mut self.polish {
            Some(polish) => polish.ask(),
            None => self.optimiser.ask(),
        };
        if let Some(left) = self.limits.evaluations.map(|most| most.saturating_sub(self.evaluations).max(1)) {
            self.asked.truncate(left);
        }
        self.asked.iter().map(|unit| self.problem.domain.natural(unit)).collect()
    }

    /// The responses to the last batch, none for a failed evaluation.
    pub fn tell(&mut self, responses: &[Option<Vec<f64>>]) {
        assert_eq!(responses.len(), self.asked.len(), "BUG: an answer per point");
        let units = std::mem::take(&mut self.asked);
        let trials: Vec<Trial> =
            units.into_iter().zip(responses).map(|(unit, r)| trial(&self.problem, unit, r.as_deref())).collect();
        self.evaluations += trials.len();
        self.failed += trials.iter().filter(|t| !t.succeeded()).count();
        for t in &trials {
            if t.succeeded() && self.best.as_ref().is_none_or(|best| t.misfit < best.misfit) {
                self.best = Some(t.clone());
            }
        }
        match &mut self.polish {
            Some(polish) => polish.tell(&trials),
            None => self.optimiser.tell(&trials),
        }
        self.begin_polish();
    }

    /// Starts the final refinement when the method has ended or its share of the budget is used.
    fn begin_polish(&mut self) {
        if self.polish.is_none() {
            self.ended = self.optimiser.stop();
        }
        let share = |most: usize| (most as f64 * (1.0 - POLISHING)) as usize;
        let due = self.ended.is_some() || self.limits.evaluations.is_some_and(|most| self.evaluations >= share(most));
        if let (true, true, None, Some(best)) = (self.limits.polish, due, &self.polish, &self.best) {
            self.polish = Some(Polish::new(&self.problem.domain, &best.point, best.misfit, self.seed));
        }
    }

    /// Why the search is over, if it is.
    pub fn stop(&self) -> Option<Stop> {
        if self.failed == self.evaluations && self.failed >= HOPELESS {
            return Some(Stop::AllFailed);
        }
        let reached = |best: &Trial| self.limits.misfit.is_some_and(|wanted| best.misfit <= wanted);
        if self.best.as_ref().is_some_and(reached) {
            return Some(Stop::Reached);
        }
        if self.limits.evaluations.is_some_and(|most| self.evaluations >= most) {
            return Some(Stop::Evaluations);
        }
        match &self.polish {
            Some(polish) => polish.stop().map(|stalled| self.ended.unwrap_or(stalled)),
            // Who asks for a misfit wants to see it in a run, not only to expect it.
            None => self.ended.filter(|&stop| stop != Stop::Settled || self.limits.misfit.is_none()),
        }
    }

    /// State of the search.
    pub fn state(&self) -> State {
        let own = self.optimiser.recommended();
        let best = || self.best.as_ref().map(observed);
        State {
            evaluations: self.evaluations,
            failed: self.failed,
            best: self.best.clone(),
            recommended: own.or_else(best),
        }
    }
}

/// The best trial as a recommendation: what was seen there in one run. How far another run would be from it is not known,
/// which does not mean that it is zero.
fn observed(trial: &Trial) -> Recommendation {
    let seen = |&y: &f64| Interval { mean: y, low: f64::NAN, high: f64::NAN };
    Recommendation {
        point: trial.point.clone(),
        responses: trial.responses.iter().map(seen).collect(),
        misfit: trial.misfit,
    }
}

/// An earlier run, with NaN for the responses that it lacks.
fn earlier(problem: &Problem, run: &Run) -> Trial {
    let responses = run.responses.clone().unwrap_or_default();
    let misfit = if responses.is_empty() { f64::INFINITY } else { problem.misfit.of(&responses) };
    Trial { point: problem.domain.unit(&run.point), misfit, responses }
}

fn trial(problem: &Problem, point: Vec<f64>, responses: Option<&[f64]>) -> Trial {
    match responses {
        Some(y) if y.iter().all(|v| v.is_finite()) => {
            Trial { point, misfit: problem.misfit.of(y), responses: y.to_vec() }
        }
        _ => Trial { point, misfit: f64::INFINITY, responses: Vec::new() },
    }
}
