//! `kind = "calibrate"`: finds the parameters that give the target responses.
//!
//! The misfit of [`optim::misfit`] is minimised over the ranges of the factors, for one or many target sets:
//! * with `surfaces` alone, on the fitted surfaces, at once;
//! * with `simulator` (or several `simulators`, all run at every point), by simulations: each is an ordinary task (cached,
//!   parallel, resumed by replay), because the next points are a pure function of the outcomes so far; failed ones tell
//!   the optimiser which regions to avoid;
//! * with both, by the surrogate, which uses the surfaces as its prior mean and corrects them by simulations;
//! * with `coarse` twins of the simulators, on these, and a bounded number of runs of the simulators corrects the result.
//!
//! Simulation k of a set stands on replicate k of the specimen (or cycles through `specimens` of them), so the scatter
//! of packings enters the runs and is not hidden by a single packing. `learn_from` names stages whose runs the
//! surrogate uses too; the result depends on these inputs and on nothing else in the store.
//!
//! The artifact `solution` holds the tables
//! * `solution`: a row per target set with the parameters, the predicted responses, `misfit`, `evaluations`, `stop`,
//!   whether the targets are `met`, and `free`, the number of directions in which the parameters can change without
//!   changing a response;
//! * `parameters`: per set and factor its value, its interval over all equally good solutions, and whether the
//!   targets determine it or leave it free;
//! * `prediction`: per set and response the target, the expected value with its 95 % interval, the scatter of a run, and
//!   the range of the response over the ranges of the factors; a target outside it is named, with the nearest value;
//! * `history`: every simulation, or on surfaces every evaluation that improved; the simulation itself, with its curve,
//!   is row `row` of the stage: `flow show W 'calibrate[17]'`;
//! * `effort`: evaluations until the responses came within 10, 5 and 2 % of the targets;
//! * `solution_set`: further parameters that meet the targets;
//! * `notes`: what a reader must know before the numbers are used.
//!
//! Where there are more parameters than targets, the solution nearest the centre of the ranges (or `preference`) is taken.

mod config;
mod constraint;
mod course;
mod curve;
mod effort;
mod faults;
mod goal;
mod instrument;
mod outlook;
mod params;
mod read;
mod record;
mod seen;
mod sets;
mod slope;
mod solve;
mod solved;
mod start;
#[cfg(test)]
mod tests;
mod twin;
mod words;

pub use config::{Calibrate, First, MethodName, Unmet};
pub use constraint::Constraint;
pub use curve::{Curve, Weights};
pub use goal::{Goal, GoalTable, Wanted};
pub use instrument::{Instrument, Parameter, Surface, instrument};
pub(super) use read::Judgement;
pub use slope::Slope;

pub use words::parameters_in_words;

use super::forecast::{Ahead, Forecast, TaskForecast};
use super::invalid::Invalid;
use super::{Class, Complaint, Context, Demands, Kind, Known, Port, Sketch, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use course::Course;
use params::Params;
use serde_json::json;
use std::collections::BTreeMap;

/// One response of the runs of a point in the unit of the target, each run with its simulator, or why there is none;
/// `stress at 0.001` reads the curve.
pub(super) fn read_response(
    runs: &[(&str, &Artifact)],
    from: &BTreeMap<String, String>,
    (response, unit): (&str, &str),
    invalid: Invalid,
) -> Result<Result<f64, String>, StageError> {
    let strain = response.strip_prefix(params::ORDINATE).and_then(|strain| strain.parse().ok());
    let (response, unit) = (response.to_owned(), unit.to_owned());
    let target = params::TargetParam { response, unit, low: None, high: None, weight: 1.0, tolerance: None, strain };
    let parts: Vec<read::Part<'_>> = runs.iter().map(|&(stage, run)| read::Part { stage, run }).collect();
    Ok(read::evaluation(&parts, from, &[target], invalid)?.map(|values| values[0]))
}

/// Validity and failures of the runs of a point.
pub(super) fn judgement(runs: &[(&str, &Artifact)]) -> Result<Judgement, StageError> {
    let parts: Vec<read::Part<'_>> = runs.iter().map(|&(stage, run)| read::Part { stage, run }).collect();
    Judgement::of(&parts)
}

impl Stage for Calibrate {
    fn inputs(&self) -> Vec<Port> {
        let one = |name: &Option<String>| name.iter().cloned().collect::<Vec<_>>();
        let simulators = Accepts::Only(&[ArtifactKind::RESULTS, ArtifactKind::RUN]);
        let results = Accepts::Only(&[ArtifactKind::RESULTS]);
        let curve = self.curve.as_ref().map(|curve| curve.of.list()).unwrap_or_default();
        let slopes = self.proportional.as_ref().and_then(|slope| slope.slopes.clone());
        vec![
            Port { key: "surfaces", stages: one(&self.surfaces), accepts: Accepts::Only(&[ArtifactKind::SURFACES]) },
            Port { key: "simulator", stages: one(&self.simulator), accepts: simulators },
            Port { key: "simulators", stages: self.simulators.clone(), accepts: simulators },
            Port { key: "coarse", stages: self.coarse.list(), accepts: simulators },
            Port { key: "learn_from", stages: self.learn_from.clone(), accepts: results },
            Port { key: "curve", stages: curve, accepts: simulators },
            Port { key: "proportional", stages: one(&slopes), accepts: Accepts::Tables },
        ]
    }

    fn sketch(&self) -> Sketch {
        let responses = self.targets.iter().flat_map(BTreeMap::keys).cloned().collect();
        let simulator = self.simulators().into_iter().next();
        Sketch { material: self.material.clone(), responses: Some(responses), simulator, ..Sketch::default() }
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::SOLUTION
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        // A curve without other targets makes one target set.
        let sets = self.targets.len().max(1);
        let one = Forecast { rows: Some(sets), ..Forecast::ONE };
        if self.simulators().is_empty() {
            return one;
        }
        let behind = || ["simulator", "simulators", "coarse"].into_iter().flat_map(|port| (ahead.behind)(port));
        let each: usize = behind().map(|simulator| simulator.per_run).sum();
        let tasks = self.evaluations.map(|count| count.saturating_mul(sets).saturating_mul(each).saturating_add(1));
        let runs = self.evaluations.map(|count| count.saturating_mul(sets));
        let seconds = runs.and_then(|runs| Forecast::seconds_of(behind(), runs));
        Forecast { tasks: tasks.map(TaskForecast::AtMost), seconds, ..one }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        self.faults(context)
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let params = self.known_params(known)?;
        let mut task = Task::new("calibrate", json!(params)).seed(known.context.seed);
        for key in ["surfaces", "learn_from"] {
            for input in known.port(key) {
                task = task.input(key, input.content);
            }
        }
        if self.simulators().is_empty() {
            return Ok(Step::Finish(task));
        }
        let memory = known.library.memory();
        let remembered = memory.and_then(super::Memory::take).filter(|course: &Course| course.is_of(&task));
        let mut course = remembered.map_or_else(|| Course::new(&task, known, &params), Ok)?;
        let wanted = course.advance(self, known, &params)?;
        if !wanted.is_empty() {
            let note = course.in_words();
            if let Some(memory) = memory {
                memory.put(course);
            }
            return Ok(Step::Ask(wanted, note));
        }
        task.params = json!(Params { history: course.into_histories(), ..params }).into();
        Ok(Step::Finish(task))
    }

    fn demands(&self) -> Option<&dyn Demands> {
        Some(self)
    }
}

impl Demands for Calibrate {
    fn unmet(&self, result: &Artifact) -> Option<String> {
        (self.unmet == Unmet::Fail).then(|| record::unmet(result)).flatten()
    }
}

impl Calibrate {
    /// All parameters that decide the result, now that the inputs are known.
    fn known_params(&self, known: &Known) -> Result<Params, StageError> {
        let measured = known.port("curve").map(|input| known.load(input)).collect::<Result<Vec<_>, _>>()?;
        let mut params = self.params(known.context, &measured)?;
        if let Some(slope) = &self.proportional {
            let slopes = known.port("proportional").next().map(|input| known.load(input)).transpose()?;
            let factor = params.factors.first().map_or("", |factor| factor.name.as_str());
            for set in &mut params.sets {
                set.start = slope.first(slopes.as_deref(), set, factor)?.map(|first| vec![first]);
            }
        }
        params.check()?;
        Ok(params)
    }

    /// The specimen of the simulation of this index, counted from 0 in its set.
    fn specimen(&self, index: u64) -> u64 {
        1 + self.specimens.map_or(index, |count| index % count)
    }

    /// For each response in `from` the name of the stage that gives it; `names` are the simulators or their coarse twins.
    fn givers(&self, names: &[String]) -> BTreeMap<String, String> {
        let simulators = self.simulators();
        let named = |(response, own): (&String, &String)| {
            let index = simulators.iter().position(|name| name == own)?;
            Some((response.clone(), names[index].clone()))
        };
        self.from.iter().filter_map(named).collect()
    }
}

/// Version 3: extents of the parameters, targets met or not, effort; intervals of every method are those of models over all
/// runs; responses enter by the history, and runs are no inputs. Version 4: effort by expectation counts whole batches.
impl Kind for Calibrate {
    const NAME: &'static str = "calibrate";
    const ABOUT: &'static str = "parameters that give wanted responses, on surfaces or by simulations";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SOLUTION];
    const CLASS: Class = Class::Calibration;
    // 7: proportional corrections average the slopes of more than two runs. 6: beyond its end a curve falls; a run without a peak has the ordinates that its curve reaches. 5: proportional corrections go on after a run without the response
    const WORKS: &'static [Work] = &[Work { name: "calibrate", version: 7, run: solve::solve }];
}
