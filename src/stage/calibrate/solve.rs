//! The work `calibrate`: computes the artifact `solution` from parameters, surfaces and finished simulations.

use super::params::{History, Params, Told};
use super::seen::{Seen, too_few};
use super::solved::{Effort, Line, Solved};
use super::twin::{Twin, full_limits, full_method};
use super::{read, record};
use crate::artifact::Artifact;
use crate::stage::{Failure, Job, Progress, StageError};
use optim::determination::{Outlook, extents};
use optim::search::{Knowledge, Method, Next, Run, Search, State, replay};
use optim::solution_set::explore;
use optim::{Interval, Problem, Recommendation, Stop};

pub(super) fn solve(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let named = |name: &str| job.inputs.iter().filter(|(n, _)| n == name).map(|(_, a)| a.clone()).collect::<Vec<_>>();
    let (surfaces, earlier) = (named("surfaces"), named("learn_from"));
    let usual = job.seed.unwrap_or_default();
    let mut solved = Vec::new();
    for set in 0..params.sets.len() {
        if job.stopped() {
            return Err(Failure::Stopped);
        }
        let knowledge = params.knowledge(set, surfaces.first().map(|a| &**a), &earlier)?;
        let (problem, seed) = (params.problem(set)?, params.seed(set, usual));
        solved.push(match params.history.get(set) {
            None => {
                let mut found = on_surfaces(job, &params, problem, &knowledge, seed)?;
                if let Some(surfaces) = surfaces.first() {
                    let outlook = read::outlook(surfaces, &params.factors, &params.sets[set])?;
                    found.expected = outlook(&found.point).unwrap_or_default();
                    found.determine(&outlook);
                }
                found
            }
            Some(history) => simulated(&params, problem, &knowledge, history, seed)?,
        });
        let note = format!("set {} of {}", set + 1, params.sets.len());
        (job.say)(Progress { fraction: Some((set + 1) as f64 / params.sets.len() as f64), ..Progress::note(note) });
    }
    let learned = earlier.iter().map(|runs| read::not_valid(runs, params.invalid));
    let learned = learned.filter_map(Result::transpose).collect::<Result<Vec<String>, StageError>>()?;
    Ok(record::artifact(&params, &solved, &learned))
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
    // The optimiser must find the optimum of the surfaces without help.
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
                let line = Line {
                    evaluation: count,
                    coarse: false,
                    point,
                    responses,
                    misfit,
                    best,
                    recommended: best,
                    ..Line::default()
                };
                history.push(line);
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
    let (expected, misfit): (Vec<Interval>, f64) =
        (responses.iter().map(exact).collect(), problem.misfit.of(&responses));
    let State { evaluations, failed, .. } = state;
    let effort = Effort::of(&problem, &history, &[], &[]);
    let (coarse, observed, scatter) = (0, None, vec![f64::NAN; expected.len()]);
    let (extents, unknown) = (None, String::new());
    Ok(Solved {
        problem,
        stop,
        evaluations,
        coarse,
        failed,
        point,
        expected,
        observed,
        scatter,
        misfit,
        set,
        extents,
        unknown,
        history,
        effort,
    })
}

/// Misfit up to which the solution nearest the preference is as good as the best point found.
const REFINED: f64 = 1e-5;

/// A finished search: why it ended, its state, and its recommendation after every batch.
struct Replayed {
    stop: Stop,
    state: State,
    recommended: Vec<Option<Recommendation>>,
    /// Evaluations after each batch.
    ends: Vec<usize>,
}

/// Replays a finished search.
fn replayed(search: &mut Search, told: &[Told]) -> Result<Replayed, StageError> {
    let runs: Vec<Run> = told.iter().map(Told::run).collect();
    let (mut recommended, mut ends) = (Vec::new(), Vec::new());
    let step = replay(search, &runs, |search| {
        let State { evaluations, recommended: own, .. } = search.state();
        recommended.resize(evaluations, own);
        ends.push(evaluations);
    });
    let Next::Stop(stop, state) = step.map_err(|fault| StageError::new(fault.to_string()))? else {
        return Err(StageError::new("the simulations of this calibration are not complete"));
    };
    if state.best.is_none() {
        let first = told.iter().find(|told| !told.failure.is_empty()).map_or("", |told| told.failure.as_str());
        return Err(StageError::new(format!("all {} simulations failed; the first: {first}", runs.len()))
            .hint("look at the ranges of the factors, and at one run with `flow show`"));
    }
    // The budget can shorten the last batch.
    recommended.resize(runs.len(), state.recommended.clone());
    ends.push(runs.len());
    Ok(Replayed { stop, state, recommended, ends })
}

/// Replays the finished simulations of one set.
fn simulated(
    params: &Params,
    problem: Problem,
    knowledge: &Knowledge,
    History { coarse, runs }: &History,
    seed: u64,
) -> Result<Solved, Failure> {
    let mut lines = Vec::new();
    let (method, limits, knowledge) = match params.full {
        None => (params.method.clone(), params.limits.clone(), knowledge.clone()),
        Some(count) => {
            let mut search = Search::new(&problem, &params.method, &params.limits, seed, knowledge);
            let searched = replayed(&mut search, coarse)?;
            lines = history(&problem, coarse, &searched.recommended, true);
            let trend = Some(Twin::of(&problem, coarse)?.trend());
            let knowledge = Knowledge { earlier: Vec::new(), trend };
            (full_method(&params.method, count), full_limits(&params.limits, count), knowledge)
        }
    };
    let mut search = Search::new(&problem, &method, &limits, seed, &knowledge);
    let Replayed { stop, state, recommended, ends } = replayed(&mut search, runs)?;
    let own = history(&problem, runs, &recommended, false);
    let effort = Effort::of(&problem, &own, &recommended, &ends);
    lines.extend(own);
    let State { evaluations, failed, recommended, best } = state;
    let mut recommended = recommended.ok_or_else(|| StageError::new("no run gave responses"))?;
    let seen = Seen::of(&method, &problem, &knowledge, runs);
    let mut observed = None;
    if !matches!(method, Method::Surrogate(_)) {
        observed = best.map(|best| best.responses);
        if let Some(seen) = &seen {
            recommended = seen.at(recommended.point);
        }
    }
    let unknown = if seen.is_some() { String::new() } else { too_few(&method, &problem, runs) };
    let expected = match seen {
        Some(_) => recommended.responses,
        // A single run does not show its scatter.
        None => {
            recommended.responses.iter().map(|y| Interval { mean: y.mean, low: f64::NAN, high: f64::NAN }).collect()
        }
    };
    let preference = params.preferred().map(|point| problem.domain.unit(&point));
    let model = |x: &[f64]| seen.as_ref().map(|seen| seen.expected_at(x));
    let set = explore(&problem, &model, &recommended.point, preference.as_deref(), params.solutions, seed);
    let scatter = match &seen {
        Some(seen) => seen.deviations(&recommended.point),
        None => vec![f64::NAN; expected.len()],
    };
    let failed = failed + coarse.iter().filter(|told| told.responses.is_none()).count();
    let (coarse, point, misfit) = (coarse.len(), problem.domain.natural(&recommended.point), recommended.misfit);
    let history = lines;
    let domain = problem.domain.clone();
    let mut solved = Solved {
        problem,
        stop,
        evaluations,
        coarse,
        failed,
        point,
        expected,
        observed,
        scatter,
        misfit,
        set,
        extents: None,
        unknown,
        history,
        effort,
    };
    let outlook = |x: &[f64]| Some(seen.as_ref()?.at(domain.unit(x)).responses);
    solved.determine(&outlook);
    Ok(solved)
}

impl Solved {
    /// Finds the range of each factor over all equally good solutions.
    fn determine(&mut self, outlook: &Outlook) {
        let Some(set) = &self.set else { return };
        let at = self.problem.domain.unit(&self.point);
        let found = extents(&self.problem, outlook, &at, &set.sample);
        let natural = |found: Vec<[f64; 2]>| {
            let end = |k: usize| self.problem.domain.natural(&found.iter().map(|ends| ends[k]).collect::<Vec<_>>());
            end(0).into_iter().zip(end(1)).map(|(low, high)| [low, high]).collect()
        };
        self.extents = found.map(natural);
    }
}

fn history(problem: &Problem, runs: &[Told], recommended: &[Option<Recommendation>], coarse: bool) -> Vec<Line> {
    let mut best = f64::INFINITY;
    let line = |(i, run): (usize, &Told)| {
        let misfit = run.responses.as_ref().map_or(f64::NAN, |y| problem.misfit.of(y));
        best = best.min(misfit);
        let missing = vec![f64::NAN; problem.misfit.targets().len()];
        let responses = run.responses.clone().unwrap_or(missing);
        let (point, failure, validity) = (run.point.clone(), run.failure.clone(), run.validity.clone());
        let recommended = recommended[i].as_ref().map_or(f64::NAN, |own| own.misfit);
        Line { evaluation: i + 1, coarse, point, responses, misfit, best, recommended, failure, validity }
    };
    runs.iter().enumerate().map(line).collect()
}
