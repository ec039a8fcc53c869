//! `kind = "specimen"`: balls packed in an outline of the plane or of space, with polygons of aggregate as rigid clumps.
//!
//! | outline | keys |
//! |---|---|
//! | rectangle | `width`, `height` |
//! | disc | `diameter` |
//! | box | `width`, `height`, `depth` |
//! | cylinder, its axis along the load | `diameter`, `height` |
//! | thick disc, its axis across the load | `diameter`, `depth` |
//!
//! Packed to a `porosity`, or as `[stage.NAME.packing]` says: to a `stress`, or as a `lattice`. Replicate k is another
//! packing and another aggregate of the same recipe; its seed comes from the workflow's seed and k. In a box or cylinder,
//! `[stage.NAME.stones]` places stones of the shapes of a `shapes` stage, and the balls are the mortar between them, at a
//! `porosity` of that room. What is computed and why: [`dem::genesis`].
//!
//! A packing that fails (overlaps beyond half a radius, no equilibrium) is a result with its reason, like a test without a
//! peak: the rows of a design on that packing have no result, and the others run.

mod aggregate;
mod config;
mod fault;
mod report;
mod stones;
mod stored;

pub use aggregate::{AggregateConfig, GradationName};
pub use config::{ClassesConfig, PackingConfig, SieveConfig, SizeName, Specimen};
pub use stones::{FullerConfig, StoneClassConfig, StonesConfig};
pub use stored::{Loaded, load, stored};

use super::cost::Bulk;
use super::forecast::{Ahead, Forecast};
use super::{
    Class, Complaint, Context, Demands, Failure, Job, Kind, Known, Port, Progress, Sketch, Stage, StageError, Step,
    Task, Work, shapes,
};
use crate::artifact::specimen::Specimen as Stored;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use dem::genesis::mix::Mix;
use dem::genesis::packing::PackingError;
use dem::genesis::specimen::{Recipe, SpecimenError};
use dem::{D2, D3, Space};
use math::random::Stream;
use serde::{Deserialize, Serialize};
use serde_json::json;

impl Specimen {
    fn task(&self, known: &Known, number: u64) -> Result<Task, Vec<Complaint>> {
        let seed = Stream::new(known.context.seed, "specimen", number).bits();
        let recipe = self.recipe()?;
        let Some(stones) = &self.stones else { return Ok(Task::new("specimen", json!(recipe)).seed(seed)) };
        let shapes = known.one("stones.shapes").map_err(|e| vec![Complaint::new("stones.shapes", e.message)])?;
        let mixture = Mixture { mix: stones.mix(&recipe)?, recipe };
        Ok(Task::new("mix", json!(mixture)).seed(seed).input("shapes", shapes.content))
    }
}

impl Stage for Specimen {
    fn inputs(&self) -> Vec<Port> {
        let accepts = Accepts::Only(&[ArtifactKind::SHAPES]);
        let port = |stones: &StonesConfig| Port { key: "stones.shapes", stages: vec![stones.shapes.clone()], accepts };
        self.stones.iter().map(port).collect()
    }

    fn gives(&self) -> ArtifactKind {
        Stored::KIND
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        match (self.recipe(), &self.stones) {
            (Err(faults), _) => faults,
            (Ok(recipe), Some(stones)) => stones.mix(&recipe).err().unwrap_or_default(),
            (Ok(_), None) => Vec::new(),
        }
    }

    fn sketch(&self) -> Sketch {
        let aggregate = self.aggregate.iter().map(|aggregate| aggregate.group.clone());
        let stones = self.stones.iter().map(|stones| stones.group.clone());
        let groups = self.shares().into_iter().map(|share| share.name).chain(aggregate).chain(stones).collect();
        Sketch { groups, region: self.region().ok(), varies: true, ..Sketch::default() }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let faults = |faults: Vec<Complaint>| {
            StageError::new(faults.iter().map(|fault| fault.message.as_str()).collect::<Vec<_>>().join("; "))
        };
        Ok(Step::Finish(self.task(known, 1).map_err(faults)?))
    }

    fn forecast(&self, _ahead: &Ahead) -> Forecast {
        let bulk = self.recipe().ok().and_then(|recipe| Bulk::of(&recipe.region, &recipe.packing));
        // Stones are settled before they are packed, and nothing tells for how long.
        let bulk = bulk.filter(|_| self.stones.is_none());
        Forecast { seconds: bulk.map(|bulk| bulk.packing()), bulk, ..Forecast::ONE }
    }

    fn demands(&self) -> Option<&dyn Demands> {
        Some(self)
    }

    fn replicate(&self, known: &Known, number: u64) -> Option<Task> {
        self.task(known, number).ok()
    }
}

impl Demands for Specimen {
    fn unmet(&self, result: &Artifact) -> Option<String> {
        Stored::from_artifact(result).ok()?.failure
    }
}

impl Kind for Specimen {
    const NAME: &'static str = "specimen";
    const ABOUT: &'static str =
        "balls packed to a porosity or a stress, in the plane or the solid; polygons of aggregate";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SPECIMEN];
    const CLASS: Class = Class::Simulation;
    const WORKS: &'static [Work] =
        &[Work { name: "specimen", version: 2, run: make }, Work { name: "mix", version: 1, run: mixed }];
    const FAR: Option<&'static str> = Some("specimen");
}

fn make(job: &Job) -> Result<Artifact, Failure> {
    let recipe: Recipe = job.params()?;
    let seed = job.seed.ok_or_else(|| StageError::new("a specimen needs a seed"))?;
    let made = match recipe.region.dimension() {
        2 => made::<D2>(&recipe, seed, job),
        _ => made::<D3>(&recipe, seed, job),
    };
    made.or_else(|faults| unmade(&recipe, &faults, job))
}

/// The artifact of a specimen whose packing failed, so that only the rows on this specimen lack a result.
fn unmade(recipe: &Recipe, faults: &[SpecimenError], job: &Job) -> Result<Artifact, Failure> {
    let words = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
    match faults {
        [SpecimenError::Packing(PackingError::Stopped)] => Err(Failure::Stopped),
        [fault] if fault.is_outcome() => {
            (job.say)(Progress::warning(fault));
            Ok(stored::nothing(&recipe.region, recipe.density, words).to_artifact())
        }
        _ => Err(StageError::new(words).into()),
    }
}

/// Parameters of the task: everything that decides a specimen with stones, besides its shapes.
#[derive(Debug, Serialize, Deserialize)]
struct Mixture {
    recipe: Recipe,
    mix: Mix,
}

fn mixed(job: &Job) -> Result<Artifact, Failure> {
    let Mixture { recipe, mix } = job.params()?;
    let seed = job.seed.ok_or_else(|| StageError::new("a specimen needs a seed"))?;
    let shapes: Vec<_> = shapes::load(job.input("shapes")?)?.into_iter().map(stones::template).collect();
    let (made, quality, report) = match mix.make(&recipe, &shapes, seed, &|| job.watch()) {
        Ok(made) => made,
        Err(faults) => return unmade(&recipe, &faults, job),
    };
    quality.warnings().iter().for_each(|warning| (job.say)(Progress::warning(warning)));
    let mut stored = stored::store(&made, &quality);
    stored.quality = report::with_mix(stored.quality, &report, quality.contacts);
    Ok(stored.to_artifact())
}

fn made<S: Space>(recipe: &Recipe, seed: u64, job: &Job) -> Result<Artifact, Vec<SpecimenError>> {
    let (made, quality) = recipe.make::<S>(seed, &|| job.watch())?;
    quality.warnings().iter().for_each(|warning| (job.say)(Progress::warning(warning)));
    Ok(stored::store(&made, &quality).to_artifact())
}

#[cfg(test)]
mod tests;
