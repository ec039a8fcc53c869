//! `kind = "calibrate"`: from wanted responses to the parameters that give them.
//!
//! The misfit of [`crate::optim::misfit`] is minimised over the ranges of the factors, for one or many target sets:
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

use super::{Complaint, Context, Kind, Known, Outcome, Point, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::Artifact;
use crate::optim::search::{Next, Run, next};
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
            Port { key: "surfaces", stages: one(&self.surfaces), accepts: &["surfaces"] },
            Port { key: "simulator", stages: one(&self.simulator), accepts: &["results", "run"] },
            Port { key: "learn_from", stages: self.learn_from.clone(), accepts: &["results"] },
        ]
    }

    fn gives(&self) -> &'static str {
        "solution"
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        self.faults(context)
    }

    fn settings(&self) -> Value {
        json!(self)
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
            task.params = json!(params);
            return Ok(Step::Finish(task));
        }
        let mut wanted = Vec::new();
        for set in 0..params.sets.len() {
            let (told, runs, asked) = self.simulated(known, &params, set)?;
            params.history.push(told);
            wanted.extend(asked);
            for run in runs {
                task = task.after("run", Arc::new(run));
            }
        }
        if !wanted.is_empty() {
            return Ok(Step::Ask(wanted));
        }
        task.params = json!(params);
        Ok(Step::Finish(task))
    }
}

/// What was told, by which tasks, and which are wanted next.
type Replayed = (Vec<Told>, Vec<Task>, Vec<Task>);

impl Calibrate {
    /// Replays one set against the outcomes there are: what was told, by which tasks, and which are wanted next.
    fn simulated(&self, known: &Known, params: &Params, set: usize) -> Result<Replayed, StageError> {
        let problem = params.problem(set)?;
        let load = |key: &str| known.port(key).map(|input| known.load(input)).collect::<Result<Vec<_>, _>>();
        let (surfaces, earlier) = (load("surfaces")?, load("learn_from")?);
        let knowledge = params.knowledge(set, surfaces.first().map(|a| &**a), &earlier)?;
        let simulator = known.one("simulator")?;
        let (mut told, mut runs, mut history) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            let step = next(&problem, &params.method, &params.limits, known.context.seed, &knowledge, &history);
            let asked = match step.map_err(|fault| StageError::new(fault.to_string()))? {
                Next::Stop(..) => return Ok((told, runs, Vec::new())),
                Next::Ask(points) => points,
            };
            let (mut wanted, first) = (Vec::new(), history.len());
            for (i, point) in asked.iter().enumerate() {
                let task = self.task(simulator, params, point, first + i)?;
                match known.library.outcome(&task) {
                    Some(Outcome::Done(content)) if wanted.is_empty() => {
                        let run = known.library.load(&content)?;
                        history.push(Run { point: point.clone(), responses: params.read(set, &run)?.ok() });
                        told.push(Told { point: point.clone(), run: Some(runs.len()), failure: String::new() });
                        runs.push(task);
                    }
                    Some(Outcome::Failed(failure)) if wanted.is_empty() => {
                        history.push(Run { point: point.clone(), responses: None });
                        told.push(Told { point: point.clone(), run: None, failure });
                    }
                    Some(_) => {}
                    None => wanted.push(task),
                }
            }
            if !wanted.is_empty() {
                return Ok((told, runs, wanted));
            }
        }
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
    const WORKS: &'static [Work] = &[Work { name: "calibrate", version: 2, run: solve::solve }];
}
