//! `kind = "calibrate"`: from wanted responses to the parameters that give them.
//!
//! The misfit of [`optim::misfit`] is minimised over the ranges of the factors, for one or many target sets:
//! * with `surfaces` alone, on the fitted surfaces, at once;
//! * with `simulator`, by simulations: each is an ordinary task (cached, parallel, resumed by replay), because what is
//!   asked next is a pure function of the outcomes so far; failed ones tell the optimiser where not to go;
//! * with both, by the surrogate, which takes the surfaces for its first belief and corrects them by simulations.
//!
//! Simulation k of a set stands on replicate k of the specimen (or cycles through `specimens` of them), so the scatter
//! of packings is in the runs and not hidden behind one lucky packing. `learn_from` names stages whose runs the
//! surrogate takes in; the result depends on these inputs and on nothing else in the store.
//!
//! The artifact `solution` holds the tables
//! * `solution`: a row per target set with the parameters, the predicted responses, `misfit`, `evaluations`, `stop`
//!   and `free`, the number of directions in which the parameters can change without changing a response;
//! * `prediction`: per set and response the target, the expected value with its 95 % interval, and what the response
//!   can be over the ranges: a target outside that reach is named, with the nearest value;
//! * `history`: every simulation, or on surfaces every evaluation that improved;
//! * `solution_set`: further parameters that meet the targets.
//!
//! Where parameters outnumber targets the solution nearest the centre of the ranges (or `preference`) is taken.

mod config;
mod params;
mod read;
mod record;
mod solve;
#[cfg(test)]
mod tests;

pub use config::{Calibrate, Constraint, Curve, MethodName, Wanted};

use super::{Class, Complaint, Context, Kind, Known, Outcome, Point, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use optim::search::{Search, State};
use params::{Params, Told};
use serde_json::{Value, json};
use std::sync::Arc;

/// One response of a run in the wanted unit, or why there is none; `stress at 0.001` reads the curve.
pub(super) fn read_response(run: &Artifact, response: &str, unit: &str) -> Result<Result<f64, String>, StageError> {
    let strain = response.strip_prefix(params::ORDINATE).and_then(|strain| strain.parse().ok());
    let (response, unit) = (response.to_owned(), unit.to_owned());
    let target = params::TargetParam { response, unit, value: 0.0, weight: 1.0, strain };
    Ok(read::run(run, &[target])?.map(|values| values[0]))
}

impl Stage for Calibrate {
    fn inputs(&self) -> Vec<Port> {
        let one = |name: &Option<String>| name.iter().cloned().collect::<Vec<_>>();
        vec![
            Port { key: "surfaces", stages: one(&self.surfaces), accepts: Accepts::Only(&[ArtifactKind::SURFACES]) },
            Port {
                key: "simulator",
                stages: one(&self.simulator),
                accepts: Accepts::Only(&[ArtifactKind::RESULTS, ArtifactKind::RUN]),
            },
            Port {
                key: "learn_from",
                stages: self.learn_from.clone(),
                accepts: Accepts::Only(&[ArtifactKind::RESULTS]),
            },
        ]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::SOLUTION
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        self.faults(context)
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut params = self.params(known.context)?;
        params.check()?;
        let mut task = Task::new("calibrate", Value::Null).seed(known.context.seed);
        for key in ["surfaces", "learn_from"] {
            for input in known.port(key) {
                task = task.input(key, input.content);
            }
        }
        if self.simulator.is_none() {
            task.params = json!(params).into();
            return Ok(Step::Finish(task));
        }
        let (mut wanted, mut stands) = (Vec::new(), Vec::new());
        for set in 0..params.sets.len() {
            let replayed = self.simulated(known, &params, set)?;
            params.history.push(replayed.told);
            wanted.extend(replayed.wanted);
            stands.push(replayed.state);
            for run in replayed.runs {
                task = task.after("run", Arc::new(run));
            }
        }
        if !wanted.is_empty() {
            return Ok(Step::Ask(wanted, in_words(&stands)));
        }
        task.params = json!(params).into();
        Ok(Step::Finish(task))
    }
}

/// Where the search of one set stands.
struct Replayed {
    told: Vec<Told>,
    /// The tasks that told it, in order.
    runs: Vec<Task>,
    /// The tasks that it must see next; none when it is over.
    wanted: Vec<Task>,
    state: State,
}

/// Evaluations, best and recommended misfit, set by set.
fn in_words(sets: &[State]) -> String {
    let each = |pick: &dyn Fn(&State) -> String| sets.iter().map(pick).collect::<Vec<_>>().join("/");
    let failed: usize = sets.iter().map(|set| set.failed).sum();
    let misfit = |misfit: Option<f64>| misfit.map_or_else(|| "–".to_owned(), |misfit| format!("{misfit:.2e}"));
    format!(
        "{} evaluations{}, misfit best {}, recommended {}",
        each(&|set| set.evaluations.to_string()),
        if failed > 0 { format!(" ({failed} failed)") } else { String::new() },
        each(&|set| misfit(set.best.as_ref().map(|best| best.misfit))),
        each(&|set| misfit(set.recommended.as_ref().map(|own| own.misfit))),
    )
}

impl Calibrate {
    /// Replays one set against the outcomes there are.
    fn simulated(&self, known: &Known, params: &Params, set: usize) -> Result<Replayed, StageError> {
        let problem = params.problem(set)?;
        let load = |key: &str| known.port(key).map(|input| known.load(input)).collect::<Result<Vec<_>, _>>();
        let (surfaces, earlier) = (load("surfaces")?, load("learn_from")?);
        let knowledge = params.knowledge(set, surfaces.first().map(|a| &**a), &earlier)?;
        let simulator = known.one("simulator")?;
        let mut search = Search::new(&problem, &params.method, &params.limits, known.context.seed, &knowledge);
        let (mut told, mut runs) = (Vec::new(), Vec::new());
        while search.stop().is_none() {
            let (mut answers, mut wanted) = (Vec::new(), Vec::new());
            let first = told.len();
            for (i, point) in search.ask().into_iter().enumerate() {
                let task = self.task(simulator, params, &point, first + i)?;
                match known.library.outcome(&task) {
                    Some(Outcome::Done(content)) if wanted.is_empty() => {
                        answers.push(params.read(set, &*known.library.load(&content)?)?.ok());
                        told.push(Told { point, run: Some(runs.len()), failure: String::new() });
                        runs.push(task);
                    }
                    Some(Outcome::Failed(failure)) if wanted.is_empty() => {
                        answers.push(None);
                        told.push(Told { point, run: None, failure });
                    }
                    Some(_) => {}
                    None => wanted.push(task),
                }
            }
            if !wanted.is_empty() {
                return Ok(Replayed { told, runs, wanted, state: search.state() });
            }
            search.tell(&answers);
        }
        Ok(Replayed { told, runs, wanted: Vec::new(), state: search.state() })
    }

    /// The task that tries one point; `index` counts the simulations of its set from 0.
    fn task(&self, simulator: &super::Input, params: &Params, point: &[f64], index: usize) -> Result<Task, StageError> {
        let names = params.factors.iter().map(|factor| factor.name.clone());
        let point: Point = names.zip(point.iter().copied()).collect();
        let index = index as u64;
        (simulator.sample)(&point, 1 + self.specimens.map_or(index, |count| index % count))
    }
}

/// Version 2: intervals of what surfaces expect, and the recommended misfit in the history.
impl Kind for Calibrate {
    const NAME: &'static str = "calibrate";
    const ABOUT: &'static str = "parameters that give wanted responses, on surfaces or by simulations";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SOLUTION];
    const CLASS: Class = Class::Calibration;
    const WORKS: &'static [Work] = &[Work { name: "calibrate", version: 2, run: solve::solve }];
}
