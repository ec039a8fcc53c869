//! The course of a calibration by simulations: which evaluations come next.
//!
//! The next points are a pure function of the outcomes so far: a new course replays the whole history and continues. A
//! course in the memory of the stage ([`crate::stage::Memory`]) continues from its state with the new outcomes alone, so
//! that an evaluation costs the same however many came before. It holds points and responses, no artifacts.
//!
//! With coarse simulators a set is searched twice: first on these, by the calibration's method; then on the simulators
//! themselves by the surrogate, whose prior mean is the model of the coarse runs, so that full runs measure the ratio
//! between the two, response by response, near the solution.

use super::config::Calibrate;
use super::params::{History, Params, Told};
use super::read::{Judgement, Part, evaluation};
use super::twin::{Twin, full_limits, full_method};
use crate::artifact::Artifact;
use crate::stage::{Input, Known, Outcome, Point, StageError, Task};
use optim::Problem;
use optim::search::{Knowledge, Search, State};
use std::sync::Arc;

/// The searches of all sets.
pub(super) struct Course {
    /// The calibration that it belongs to; it is valid for no other.
    task: Task,
    sets: Vec<Trail>,
}

/// The level of the simulators that are run, coarse or full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Coarse,
    Full,
}

/// The search of one set.
struct Trail {
    problem: Problem,
    search: Search,
    level: Level,
    history: History,
    /// Points whose outcomes are not all known yet, each with its tasks.
    pending: Vec<(Vec<f64>, Vec<Task>)>,
}

impl Course {
    /// A new course; `task` is the calibration without its history.
    pub(super) fn new(task: &Task, known: &Known, params: &Params) -> Result<Self, StageError> {
        let load = |key: &str| known.port(key).map(|input| known.load(input)).collect::<Result<Vec<_>, _>>();
        let (surfaces, earlier) = (load("surfaces")?, load("learn_from")?);
        let trail = |set: usize| {
            let problem = params.problem(set)?;
            let knowledge = params.knowledge(set, surfaces.first().map(|a| &**a), &earlier)?;
            let seed = params.seed(set, known.context.seed);
            let search = Search::new(&problem, &params.method, &params.limits, seed, &knowledge);
            let level = if params.full.is_some() { Level::Coarse } else { Level::Full };
            Ok(Trail { problem, search, level, history: History::default(), pending: Vec::new() })
        };
        let sets = (0..params.sets.len()).map(trail).collect::<Result<_, StageError>>()?;
        Ok(Self { task: task.clone(), sets })
    }

    /// Whether it is the course of this calibration.
    pub(super) fn is_of(&self, task: &Task) -> bool {
        self.task == *task
    }

    /// Processes all outcomes there are and returns the tasks of the next evaluations; none when every search is over.
    pub(super) fn advance(
        &mut self,
        stage: &Calibrate,
        known: &Known,
        params: &Params,
    ) -> Result<Vec<Task>, StageError> {
        let mut wanted = Vec::new();
        let count = self.sets.len();
        for (set, trail) in self.sets.iter_mut().enumerate() {
            wanted.extend(trail.advance(stage, known, params, (set, count))?);
        }
        Ok(wanted)
    }

    /// The outcomes of each set so far.
    pub(super) fn into_histories(self) -> Vec<History> {
        self.sets.into_iter().map(|trail| trail.history).collect()
    }

    /// Progress in a few words: evaluations, best and recommended misfit, set by set.
    pub(super) fn in_words(&self) -> String {
        let states: Vec<State> = self.sets.iter().map(|trail| trail.search.state()).collect();
        let each = |pick: &dyn Fn(&State) -> String| states.iter().map(pick).collect::<Vec<_>>().join("/");
        let misfit = |misfit: Option<f64>| misfit.map_or_else(|| "–".to_owned(), |misfit| format!("{misfit:.2e}"));
        let failed: usize = self.sets.iter().map(Trail::failed).sum();
        format!(
            "{} evaluations{}, misfit best {}, recommended {}",
            self.sets.iter().map(Trail::count).collect::<Vec<_>>().join("/"),
            if failed > 0 { format!(" ({failed} failed)") } else { String::new() },
            each(&|state| misfit(state.best.as_ref().map(|best| best.misfit))),
            each(&|state| misfit(state.recommended.as_ref().map(|own| own.misfit))),
        )
    }
}

impl Trail {
    fn told(&mut self) -> &mut Vec<Told> {
        match self.level {
            Level::Coarse => &mut self.history.coarse,
            Level::Full => &mut self.history.runs,
        }
    }

    /// Evaluations so far, for a reader.
    fn count(&self) -> String {
        match self.history.coarse.len() {
            0 => self.history.runs.len().to_string(),
            coarse => format!("{coarse}+{}", self.history.runs.len()),
        }
    }

    fn failed(&self) -> usize {
        self.history.coarse.iter().chain(&self.history.runs).filter(|told| told.responses.is_none()).count()
    }

    fn advance(
        &mut self,
        stage: &Calibrate,
        known: &Known,
        params: &Params,
        (set, sets): (usize, usize),
    ) -> Result<Vec<Task>, StageError> {
        loop {
            if self.pending.is_empty() {
                if self.search.stop().is_some() && !self.refine(known, params, set)? {
                    return Ok(Vec::new());
                }
                self.ask(stage, known, params, (set, sets))?;
            }
            let tasks = self.pending.iter().flat_map(|(_, tasks)| tasks);
            let wanted: Vec<Task> = tasks.filter(|task| known.library.outcome(task).is_none()).cloned().collect();
            if !wanted.is_empty() {
                return Ok(wanted);
            }
            self.take(stage, known, params, set)?;
        }
    }

    /// Switches from the coarse simulators to the full ones; false when there are none, or it runs them already.
    fn refine(&mut self, known: &Known, params: &Params, set: usize) -> Result<bool, StageError> {
        let (Level::Coarse, Some(runs)) = (self.level, params.full) else { return Ok(false) };
        let seed = params.seed(set, known.context.seed);
        let twin = Twin::of(&self.problem, &self.history.coarse)?;
        let (method, limits) = (full_method(&params.method, runs), full_limits(&params.limits, runs));
        let knowledge = Knowledge { earlier: Vec::new(), trend: Some(twin.trend()) };
        self.search = Search::new(&self.problem, &method, &limits, seed, &knowledge);
        self.level = Level::Full;
        Ok(true)
    }

    /// Asks the search for its next points and makes their tasks.
    fn ask(
        &mut self,
        stage: &Calibrate,
        known: &Known,
        params: &Params,
        (set, sets): (usize, usize),
    ) -> Result<(), StageError> {
        let simulators: Vec<&Input<'_>> = simulators(known, self.level).collect();
        let before = self.told().len();
        let all = self.history.coarse.len() + self.history.runs.len();
        for (i, point) in self.search.ask().into_iter().enumerate() {
            let names = params.factors.iter().map(|factor| factor.name.clone());
            let mut values: Point = names.zip(point.iter().copied()).collect();
            values.extend(params.sets[set].held.clone());
            let number = stage.specimen((before + i) as u64);
            // Rows are numbered as in the history: set by set, and simulator by simulator within an evaluation.
            let row = |k: usize| ((all + i) * sets + set) * simulators.len() + k;
            let task = |(k, simulator): (usize, &&Input<'_>)| Ok((simulator.sample)(&values, number)?.row(row(k)));
            let tasks = simulators.iter().enumerate().map(task).collect::<Result<_, StageError>>()?;
            self.pending.push((point, tasks));
        }
        Ok(())
    }

    /// Gives the search the outcomes of its points.
    fn take(&mut self, stage: &Calibrate, known: &Known, params: &Params, set: usize) -> Result<(), StageError> {
        let names: Vec<String> = simulators(known, self.level).map(|input| input.stage.to_owned()).collect();
        let from = stage.givers(&names);
        let (mut answers, mut told) = (Vec::new(), Vec::new());
        for (point, tasks) in std::mem::take(&mut self.pending) {
            let (mut runs, mut failure) = (Vec::new(), String::new());
            for task in &tasks {
                match known.library.outcome(task) {
                    Some(Outcome::Done(content)) => runs.push(known.library.load(&content)?),
                    Some(Outcome::Failed(why)) if failure.is_empty() => failure = why,
                    Some(Outcome::Failed(_)) => {}
                    None => panic!("BUG: an outcome was known before"),
                }
            }
            let responses = match failure.is_empty() {
                true => evaluation(&parts(&names, &runs), &from, &params.sets[set].targets, params.invalid)?,
                false => Err(failure),
            };
            let (responses, failure) = match responses {
                Ok(values) => (Some(values), String::new()),
                Err(why) => (None, why),
            };
            let validity = match responses {
                Some(_) => Judgement::of(&parts(&names, &runs))?.validity,
                None => String::new(),
            };
            answers.push(responses.clone());
            told.push(Told { point, responses, failure, validity });
        }
        self.search.tell(&answers);
        self.told().extend(told);
        Ok(())
    }
}

/// The inputs that are run at a level, in order.
fn simulators<'a>(known: &'a Known<'a>, level: Level) -> impl Iterator<Item = &'a Input<'a>> {
    let keys: &[&str] = match level {
        Level::Coarse => &["coarse"],
        Level::Full => &["simulator", "simulators"],
    };
    known.inputs.iter().filter(move |input| keys.contains(&input.key))
}

fn parts<'a>(names: &'a [String], runs: &'a [Arc<Artifact>]) -> Vec<Part<'a>> {
    names.iter().zip(runs).map(|(stage, run)| Part { stage, run }).collect()
}
