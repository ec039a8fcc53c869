//! The work `calibrate`: from parameters, surfaces and finished simulations to the artifact `solution`.

use super::params::{Params, Told};
use super::{read, record};
use crate::artifact::Artifact;
use crate::stage::{Failure, Job, Progress, StageError};
use optim::search::{Knowledge, Method, Next, Run, Search, State, replay};
use optim::solution_set::{SolutionSet, explore};
use optim::surrogate::models::Models;
use optim::surrogate::{Model, Trend};
use optim::{Interval, Problem, Stop, Trial};
use std::sync::Arc;

/// One line of the history.
pub(super) struct Line {
    pub evaluation: usize,
    pub point: Vec<f64>,
    /// NaN where it failed.
    pub responses: Vec<f64>,
    pub misfit: f64,
    pub best: f64,
    /// Misfit of the recommended point once the batch of this evaluation was known; NaN before there is one.
    pub recommended: f64,
    pub failure: String,
}

/// What came of one target set.
pub(super) struct Solved {
    pub problem: Problem,
    pub stop: Stop,
    pub evaluations: usize,
    pub failed: usize,
    /// The solution, in natural units.
    pub point: Vec<f64>,
    pub expected: Vec<Interval>,
    pub misfit: f64,
    pub set: Option<SolutionSet>,
    pub history: Vec<Line>,
}

pub(super) fn solve(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let named = |name: &str| job.inputs.iter().filter(|(n, _)| n == name).map(|(_, a)| a.clone()).collect::<Vec<_>>();
    let (surfaces, earlier, mut runs) = (named("surfaces"), named("learn_from"), named("run"));
    let seed = job.seed.unwrap_or_default();
    let mut solved = Vec::new();
    for set in 0..params.sets.len() {
        if job.stopped() {
            return Err(Failure::Stopped);
        }
        let knowledge = params.knowledge(set, surfaces.first().map(|a| &**a), &earlier)?;
        let problem = params.problem(set)?;
        solved.push(match params.history.get(set) {
            None => {
                let mut found = on_surfaces(job, &params, problem, &knowledge, seed)?;
                if let Some(surfaces) = surfaces.first() {
                    found.expected = read::expected(surfaces, &params.factors, &params.sets[set], &found.point)?;
                }
                found
            }
            Some(told) => {
                let count = told.iter().filter_map(|t| t.run).count();
                let own: Vec<Arc<Artifact>> = runs.drain(..count).collect();
                simulated(&params, set, problem, &knowledge, (told, &own), seed)?
            }
        });
        let note = format!("set {} of {}", set + 1, params.sets.len());
        (job.say)(Progress { fraction: Some((set + 1) as f64 / params.sets.len() as f64), ..Progress::note(note) });
    }
    Ok(record::artifact(&params, &solved))
}

/// Minimises on the fitted surfaces, then explores all their solutions.
fn on_surfaces(
    job: &Job,
    params: &Params,
    problem: Problem,
    knowledge: &Knowledge,
    seed: u64,
) -> Result<Solved, Failure> {
    let surfaces = knowledge.trend.clone().ok_or_else(|| StageError::new("there are no surfaces"))?;
    // The optimiser must find what the surfaces hold, not be told it.
    let mut search = Search::new(&problem, &params.method, &params.limits, seed, &Knowledge::default());
    let (mut history, mut best, mut count) = (Vec::new(), f64::INFINITY, 0);
    let stop = loop {
        if let Some(stop) = search.stop() {
            break stop;
        }
        if job.stopped() {
            return Err(Failure::Stopped);
        }
        let points = search.ask();
        let answers: Vec<Option<Vec<f64>>> = points.iter().map(|point| surfaces(point)).collect();
        for (point, responses) in points.iter().zip(answers.iter().flatten()) {
            count += 1;
            let misfit = problem.misfit.of(responses);
            if misfit < best {
                best = misfit;
                let (point, responses) = (point.clone(), responses.clone());
                let (evaluation, recommended, failure) = (count, best, String::new());
                history.push(Line { evaluation, point, responses, misfit, best, recommended, failure });
            }
        }
        search.tell(&answers);
        (job.say)(Progress::note(format!("{count} evaluations, misfit {best:.2e}")));
    };
    let state = search.state();
    let found = state.best.clone().ok_or_else(|| StageError::new("the surfaces have no value anywhere"))?;
    let preference = params.preferred().map(|point| problem.domain.unit(&point));
    let set = explore(&problem, &|x| surfaces(x), &found.point, preference.as_deref(), params.solutions, seed);
    let chosen = set.as_ref().filter(|set| set.misfit <= found.misfit.max(REFINED)).map(|set| set.chosen.clone());
    let point = problem.domain.natural(&chosen.unwrap_or(found.point));
    let responses = surfaces(&point).unwrap_or_default();
    let exact = |&y: &f64| Interval { mean: y, low: f64::NAN, high: f64::NAN };
    let (expected, misfit) = (responses.iter().map(exact).collect(), problem.misfit.of(&responses));
    let State { evaluations, failed, .. } = state;
    Ok(Solved { problem, stop, evaluations, failed, point, expected, misfit, set, history })
}

/// Misfit up to which the solution nearest the preference is as good as the best point found.
const REFINED: f64 = 1e-5;

/// Replays the finished simulations of one set.
fn simulated(
    params: &Params,
    set: usize,
    problem: Problem,
    knowledge: &Knowledge,
    (told, artifacts): (&[Told], &[Arc<Artifact>]),
    seed: u64,
) -> Result<Solved, Failure> {
    let mut runs = Vec::new();
    let mut failures = Vec::new();
    for told in told {
        let (responses, failure) = match told.run {
            Some(i) => match params.read(set, &artifacts[i])? {
                Ok(values) => (Some(values), read::failure(&artifacts[i])),
                Err(reason) => (None, reason),
            },
            None => (None, told.failure.clone()),
        };
        runs.push(Run { point: told.point.clone(), responses });
        failures.push(failure);
    }
    let mut recommended = Vec::new();
    let mut search = Search::new(&problem, &params.method, &params.limits, seed, knowledge);
    let step = replay(&mut search, &runs, |search| {
        let State { evaluations, recommended: own, .. } = search.state();
        recommended.resize(evaluations, own.map_or(f64::NAN, |own| own.misfit));
    });
    let Next::Stop(stop, state) = step.map_err(|fault| StageError::new(fault.to_string()))? else {
        return Err(StageError::new("the simulations of this calibration are not complete").into());
    };
    if stop == Stop::AllFailed || state.best.is_none() {
        let first = failures.first().cloned().unwrap_or_default();
        return Err(StageError::new(format!("all {} simulations failed; the first: {first}", runs.len()))
            .hint("look at the ranges of the factors, and at one run with `flow show`")
            .into());
    }
    // The last batch can be cut short by the budget.
    recommended.resize(runs.len(), state.recommended.as_ref().map_or(f64::NAN, |own| own.misfit));
    let history = lines(&problem, &runs, &failures, &recommended);
    let State { evaluations, failed, recommended, .. } = state;
    let recommended = recommended.ok_or_else(|| StageError::new("no run gave responses"))?;
    let models = fitted(params, &problem, knowledge, &runs);
    let preference = params.preferred().map(|point| problem.domain.unit(&point));
    let explored = models.and_then(|models| {
        let model = |x: &[f64]| Some(models.expected(&problem.domain.unit(x)));
        explore(&problem, &model, &recommended.point, preference.as_deref(), params.solutions, seed)
    });
    let point = problem.domain.natural(&recommended.point);
    let (expected, misfit) = (recommended.responses, recommended.misfit);
    Ok(Solved { problem, stop, evaluations, failed, point, expected, misfit, set: explored, history })
}

/// The surrogate's models over all runs, for the solution set; none for the methods that have no models.
fn fitted(params: &Params, problem: &Problem, knowledge: &Knowledge, runs: &[Run]) -> Option<Models> {
    let Method::Surrogate(settings) = &params.method else { return None };
    let trial = |run: &Run| {
        let responses = run.responses.clone().unwrap_or_default();
        Trial { point: problem.domain.unit(&run.point), misfit: f64::NAN, responses }
    };
    let all: Vec<Trial> = knowledge.earlier.iter().chain(runs).map(trial).collect();
    let trend: Option<&Trend> = knowledge.trend.as_ref();
    Models::fit(&all, problem, settings.model == Model::GaussianProcess, trend)
}

fn lines(problem: &Problem, runs: &[Run], failures: &[String], recommended: &[f64]) -> Vec<Line> {
    let mut best = f64::INFINITY;
    let line = |(i, (run, failure)): (usize, (&Run, &String))| {
        let misfit = run.responses.as_ref().map_or(f64::NAN, |y| problem.misfit.of(y));
        best = best.min(misfit);
        let missing = vec![f64::NAN; problem.misfit.targets().len()];
        let responses = run.responses.clone().unwrap_or(missing);
        let (point, failure) = (run.point.clone(), failure.clone());
        Line { evaluation: i + 1, point, responses, misfit, best, recommended: recommended[i], failure }
    };
    runs.iter().zip(failures).enumerate().map(line).collect()
}
