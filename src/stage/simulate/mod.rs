//! `kind = "simulate"`: a loading test on a specimen, once or per design row and replicate.
//!
//! A row is a set of microparameters: the material with the row's factors applied. Factors may set numbers of the test and
//! of the specimen too ([`vary`](super::vary)); rows that change the specimen have packings of their own. Equal rows of a
//! design are replicates, each on its own packing. Whether *different* rows share packings is a setting:
//! * `packing = "shared"`: replicate k of every row uses replicate k of the specimen. Differences between rows are then
//!   free of packing noise, and one packing serves a whole design.
//! * `packing = "own"`: every row and replicate has a packing of its own, whose seed follows from the row's content. All
//!   runs then have independent scatter, which pure error, lack of fit and the F-tests of an analysis of variance assume.
//!
//! Each test declares its responses ([`TestKind::responses`](dem::loading::kind::TestKind::responses)), in SI units:
//! `uniaxial` gives `UCS`, `E`, `nu` by the published definitions (peak stress; tangent modulus around half of it; strain
//! ratio there), `tension` `sigma_t`, `E`, `nu`, `brazilian` `sigma_t`, `biaxial` and `triaxial` `q`, `sigma_1`, `sigma_3`,
//! `bending` `f_b`, and each test a few more. What is computed and why: [`dem::loading`].
//!
//! `material` names a `[material.NAME]`, or a stage whose result is one ([`material`](super::material)): a `formula` stage
//! whose responses are microparameters, or a calibration; `set` chooses the target set of its solution.

mod config;
mod fissures;
mod laid;
mod loading;
mod record;
mod speed;
mod traces;

pub use config::{BondConfig, PackingChoice, Simulate};
pub use fissures::{FissureConfig, JointConfig, NetworkConfig};
pub use speed::PlatenSpeed;

use super::beside::Beside;
use super::cost::Bulk;
use super::forecast::{Ahead, Forecast, TaskForecast};
use super::rows::{self, GATHER};
use super::specimen::Loaded;
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Point, Port, Progress, Sketch, Stage, StageError, Step, Task,
    Work,
};
use crate::artifact::run::{Responses, Run};
use crate::artifact::specimen::Specimen as Stored;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use config::Params;
use dem::Space;
use dem::loading::curve::Sample;
use dem::loading::piece::Piece;
use laid::Laid;
use math::random::Stream;
use serde_json::json;
use std::sync::Arc;

impl Stage for Simulate {
    fn inputs(&self) -> Vec<Port> {
        let specimen = Port {
            key: "specimen",
            stages: vec![self.specimen.clone()],
            accepts: Accepts::Only(&[ArtifactKind::SPECIMEN]),
        };
        let design = self.design.iter().map(|name| Port {
            key: "design",
            stages: vec![name.clone()],
            accepts: Accepts::Only(&[ArtifactKind::DESIGN]),
        });
        std::iter::once(specimen).chain(design).collect()
    }

    fn gives(&self) -> ArtifactKind {
        if self.design.is_some() { ArtifactKind::RESULTS } else { ArtifactKind::RUN }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = rows::check_units(context);
        let given = self.test.responses().iter();
        found.extend(given.filter_map(|own| rows::check_response("test", own.name, own.unit, context)));
        found.extend(self.faults(context));
        found
    }

    fn beside(&self, context: &Context, found: &mut Beside) {
        let region = context.sketches.get(&self.specimen).and_then(|sketch| sketch.region);
        fissures::look_into(&self.fissures, region.map(|region| region.dimension()), found);
    }

    fn sketch(&self) -> Sketch {
        let responses = self.test.responses().iter().map(|response| response.name.to_owned()).collect();
        let material = Some(self.material.clone());
        Sketch { material, responses: Some(responses), varies: true, ..Sketch::default() }
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        // The result of the specimen's stage is its first replicate.
        let specimens = |design: &Forecast, rows: usize| match self.packing {
            PackingChoice::Own => TaskForecast::Exactly(rows),
            PackingChoice::Shared if self.varies_specimen(ahead.context) => TaskForecast::AtMost(rows),
            PackingChoice::Shared => TaskForecast::Exactly(design.replicates - 1),
        };
        let found = Forecast { per_run: 2, ..Forecast::of_design(ahead, specimens) };
        let PlatenSpeed { speed, pace } = self.platen_speed;
        let bulk = (ahead.behind)("specimen").first().and_then(|specimen| specimen.bulk);
        let one = |bulk: Bulk| (bulk.test(speed, pace, self.masses), bulk.packing());
        let all = |(test, packing): (f64, f64)| {
            let rows = if self.design.is_some() { found.rows? } else { 1 };
            let packed = found.tasks?.count().saturating_sub(rows + 1);
            Some(rows as f64 * test + packed as f64 * packing)
        };
        let run_seconds = bulk.map(one).map(|(test, packing)| test + packing);
        Forecast { seconds: bulk.map(one).and_then(all), run_seconds, ..found }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        rows::fan_out(self, known)
    }

    fn sample(&self, known: &Known, point: &Point, number: u64) -> Result<Task, StageError> {
        self.concerned(known, point)?;
        let given = self.given(known)?;
        // Values of the row replace calibrated ones.
        let mut point = point.clone();
        for (name, value) in given.point {
            point.entry(name).or_insert(value);
        }
        let material = self.contacts(known.context, &given.material, &point)?;
        let specimen = known.one("specimen")?;
        let packing = match self.packing {
            PackingChoice::Shared => number,
            PackingChoice::Own => own_packing(&point, number),
        };
        let task = Task::new("simulate", json!(Params::new(material, self.spec())));
        let task = fissures::add_files(&self.fissures, known, task)?;
        if let Some(make) = (specimen.vary)(&point, packing)? {
            return Ok(task.after("specimen", Arc::new(make)).seed(number));
        }
        if packing == 1 {
            return Ok(task.input("specimen", specimen.content).seed(1));
        }
        let make = (specimen.replicate)(packing)
            .ok_or_else(|| StageError::new(format!("stage `{}` cannot make replicates", specimen.stage)))?;
        Ok(task.after("specimen", Arc::new(make)).seed(number))
    }
}

impl Simulate {
    /// Whether a factor of its design sets numbers of its specimen, or of a stage from which the specimen is made.
    fn varies_specimen(&self, context: &Context) -> bool {
        let design = self.design.as_ref().and_then(|design| context.sketches.get(design));
        let factors = design.and_then(|sketch| sketch.factors.as_ref());
        let sets = factors.into_iter().flatten().filter_map(|name| context.factors.get(name)).flat_map(|own| &own.sets);
        let own = sets.filter_map(|path| path.split_once('.').map(|(stage, _)| stage));
        let makes = |stage: &str| context.sketches.get(stage).is_some_and(|own| own.varies && own.responses.is_none());
        own.into_iter().any(makes)
    }

    /// Refuses a row with a factor that sets a value of neither this stage, nor its specimen, nor its material.
    fn concerned(&self, known: &Known, point: &Point) -> Result<(), StageError> {
        for name in point.keys() {
            let paths = known.context.factors.get(name).map_or(&[][..], |factor| &factor.sets);
            let mine = |path: &String| {
                let stage = path.split_once('.').map_or("", |(stage, _)| stage);
                !known.context.sets_stage(path) || stage == known.name || stage == self.specimen
            };
            if !paths.is_empty() && !paths.iter().any(mine) {
                let message = format!("factor `{name}` sets `{}`, which this test does not use", paths.join("`, `"));
                let hint =
                    format!("it tests `{}`; let the factor set that, or leave it out of the design", self.specimen);
                return Err(StageError::new(message).hint(hint));
            }
        }
        Ok(())
    }
}

/// The number of the specimen's replicate for one row and replicate of a design with `packing = "own"`.
fn own_packing(point: &Point, number: u64) -> u64 {
    let text: Vec<String> =
        point.iter().map(|(name, value)| format!("{name}={:016x}", (value + 0.0).to_bits())).collect();
    Stream::new(number, &text.join(" "), 0).bits()
}

impl Kind for Simulate {
    const NAME: &'static str = "simulate";
    const ABOUT: &'static str = "a loading test on a specimen, once or per design row";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS, ArtifactKind::RUN];
    const CLASS: Class = Class::Simulation;
    /// 4: the rate is judged by wave transits before failure, no longer by an absolute strain in a step and speed; the strain
    /// rate of a tension test is that between its grips, and a rate that is given is that of the piece in tension and bending.
    /// 3: thresholds and sampling follow from the specimen where the workflow gives none, checks say what they mean.
    /// 2: the same numbers in another layout: states and their centres stand beside the curve, positions and normals are
    /// `position_x`, `normal_x`, ….
    const WORKS: &'static [Work] = &[Work { name: "simulate", version: 4, run: simulate }, GATHER];
    const FAR: Option<&'static str> = Some("simulate");
}

/// Observes the run between two reports of progress.
const REPORT_EVERY: usize = 50;

fn simulate(job: &Job) -> Result<Artifact, Failure> {
    let specimen = job.input("specimen")?;
    if let Some(why) = Stored::from_artifact(specimen).map_err(StageError::from)?.failure {
        return Ok(Run::plain(&format!("no specimen: {why}"), Responses::default()).to_artifact());
    }
    match super::specimen::load(specimen)? {
        Loaded::Plane(specimen) => tested(job, &Piece::from(&specimen)),
        Loaded::Solid(specimen) => tested(job, &Piece::from(&specimen)),
    }
}

/// Runs the test on a piece, in the plane or in the solid.
fn tested<S: Space>(job: &Job, piece: &Piece<S>) -> Result<Artifact, Failure> {
    let mut params: Params = job.params()?;
    fissures::read_files(job, &mut params.material.fissures, S::DIMENSION)?;
    let fail = |fault: &dyn std::fmt::Display| StageError::new(fault.to_string());
    if let Some(warning) = params.test.warning(piece, &params.material).map_err(|faults| fail(&faults))? {
        (job.say)(Progress::warning(&warning));
    }
    let mut seen = 0;
    let mut watch = |sample: &Sample| {
        seen += 1;
        if seen % REPORT_EVERY == 0 {
            let note = format!("ε {:.3} %, σ {:.1} MPa", sample.axial * 100.0, sample.stress / 1e6);
            (job.say)(Progress::note(note));
        }
        job.watch()
    };
    let seed = job.seed.unwrap_or_default();
    let record = params.test.run(piece, &params.material, seed, &mut watch).map_err(|fault| fail(&fault))?;
    if record.run.interrupted {
        return Err(Failure::Stopped);
    }
    record.invalid().for_each(|check| (job.say)(Progress::warning(&format!("not valid: {check}"))));
    let laid = Laid::of(piece, &params.material, seed, &record.run.on_fissures);
    laid.iter().filter_map(Laid::idle).for_each(|words| (job.say)(Progress::warning(&words)));
    Ok(record::artifact(&record, &params, laid.as_ref()))
}
