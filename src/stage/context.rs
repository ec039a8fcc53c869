//! The context of a stage: everything on which its next step depends.

use super::cached::CachedRun;
use super::material::Material;
use super::rows::DesignRows;
use super::vary::Template;
use super::{Memory, StageError, Task};
use crate::artifact::{Artifact, ContentHash};
use crate::expression::Measure;
use crate::unit::{Dimension, Unit};
use dem::genesis::region::Region;
use math::scale::Scale;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the whole workflow shares: its seed, its factors and its responses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Context {
    /// The workflow's seed.
    pub seed: u64,
    /// `[factor.NAME]` tables.
    pub factors: BTreeMap<String, Factor>,
    /// `[response.NAME]` tables.
    pub responses: BTreeMap<String, Response>,
    /// `[material.NAME]` tables.
    pub materials: BTreeMap<String, Material>,
    /// Sketches of the stages before anything runs, by name; empty until all are read.
    pub sketches: BTreeMap<String, Sketch>,
    /// The tables of stages that factors may set numbers of, by name.
    pub templates: BTreeMap<String, Template>,
    /// The stages in order, for pictures of the workflow itself; empty until all are read.
    pub outline: Vec<Outline>,
}

impl Context {
    /// Whether a path that a factor sets belongs to a stage, not to a material.
    pub fn sets_stage(&self, path: &str) -> bool {
        path.split_once('.').is_some_and(|(stage, _)| self.sketches.contains_key(stage))
    }

    /// Symbols of factors and responses by name, of those that have one.
    pub fn symbols(&self) -> BTreeMap<String, String> {
        let factors = self.factors.iter().map(|(name, factor)| (name, &factor.symbol));
        let all = factors.chain(self.responses.iter().map(|(name, response)| (name, &response.symbol)));
        all.filter(|(_, symbol)| !symbol.is_empty()).map(|(name, symbol)| (name.clone(), symbol.clone())).collect()
    }
}

/// The properties of a stage that other stages can use before anything runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// Names of the groups of particles in the specimen that it makes, by their number; empty for other kinds.
    pub groups: Vec<String>,
    /// The outline of the specimen that it makes.
    pub region: Option<Region>,
    /// The factors that its rows vary; none for a kind that is no design.
    pub factors: Option<Vec<String>>,
    /// The name under its key `material`: a `[material.NAME]`, or a stage that gives one.
    pub material: Option<String>,
    /// The responses that its runs, fits or targets are of; `None` where that is not known before it runs.
    pub responses: Option<Vec<String>>,
    /// The stage whose runs it requests.
    pub simulator: Option<String>,
    /// Whether factors may set its numbers: it makes specimens, or runs tests.
    pub varies: bool,
}

/// A stage as the workflow's graph shows it.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// The word after `kind =`.
    pub kind: String,
    /// Indices of the stages that it takes results from, each once.
    pub inputs: Vec<usize>,
}

/// One value of a material, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The value.
    pub value: f64,
    /// Its dimension; the reader of the path checks it.
    pub dimension: Dimension,
}

/// An experimental factor: the values that it sets, its unit and symbol, and its levels or range in that unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Factor {
    /// Paths of the values that it sets, such as `mortar.Ec`; empty for a column that sets nothing by itself.
    pub sets: Vec<String>,
    /// Unit of levels and range, `""` for a pure number.
    pub unit: String,
    /// Symbol for tables and figures, such as `\bar\sigma_c`.
    pub symbol: String,
    /// Its scale, linear or logarithmic.
    pub scale: Scale,
    /// Levels, in `unit`; empty when there is only a range. For a category 0, 1, 2 ….
    pub levels: Vec<f64>,
    /// Names of the levels of a category, such as the kind of cement; empty for a factor of numbers.
    pub names: Vec<String>,
    /// Low and high end, in `unit`; by default those of the levels.
    pub range: Option<[f64; 2]>,
}

impl Factor {
    /// A number in the factor's unit as a quantity; `None` when the unit cannot be read.
    pub fn measure(&self, value: f64) -> Option<Measure> {
        let unit = Unit::parse(&self.unit).ok()?;
        Some(Measure::of(value * unit.factor, unit.dimension))
    }

    /// One of its values, for checks that do not depend on which.
    pub fn sample(&self) -> Option<Measure> {
        let value = self.levels.first().copied().or(self.range.map(|[low, _]| low))?;
        self.measure(value)
    }
}

/// A response: the unit and symbol in tables and figures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Unit in tables and figures, such as `MPa`.
    pub unit: String,
    /// Symbol, such as `\sigma_u`.
    pub symbol: String,
}

/// A finished input of a stage.
pub struct Input<'a> {
    /// The port's key.
    pub key: &'static str,
    /// The stage's name.
    pub stage: &'a str,
    /// Hash of its result.
    pub content: ContentHash,
    /// [`super::vary::replicate`] of that stage: its replicate with the settings of a point, where the point has any.
    pub vary: Varier<'a>,
    /// [`super::Stage::replicate`] of that stage.
    pub replicate: Box<dyn Fn(u64) -> Option<Task> + 'a>,
    /// [`super::Stage::sample`] of that stage.
    pub sample: Sampler<'a>,
}

/// Makes the task that tries a point on a replicate.
pub type Sampler<'a> = Box<dyn Fn(&Point, u64) -> Result<Task, StageError> + 'a>;

/// Makes a replicate with the settings of a point, if it has any.
pub type Varier<'a> = Box<dyn Fn(&Point, u64) -> Result<Option<Task>, StageError> + 'a>;

/// Values of factors by name, in the factors' units.
pub type Point = BTreeMap<String, f64>;

/// The outcome of a task that the stage requested.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Its artifact.
    Done(ContentHash),
    /// It failed; the reason.
    Failed(String),
}

/// Access to artifacts, outcomes and files, which the runner implements.
pub trait Library {
    /// The artifact of this content.
    ///
    /// # Errors
    /// It cannot be read.
    fn load(&self, content: &ContentHash) -> Result<Arc<Artifact>, StageError>;

    /// The outcome of a task; `None` when the stage has not requested it yet.
    fn outcome(&self, task: &Task) -> Option<Outcome>;

    /// The run of a row that an earlier campaign made, if there is one and everything else that decides a run is unchanged.
    /// Called once for every row of a fan-out, in order.
    fn cached(&self, _rows: &Arc<DesignRows>, _index: usize) -> Option<CachedRun<'_>> {
        None
    }

    /// The memory of the stage between its steps, if it has one.
    fn memory(&self) -> Option<&Memory> {
        None
    }

    /// A file beside the workflow, with its hash.
    ///
    /// # Errors
    /// It cannot be read.
    fn file(&self, name: &str, path: &str) -> Result<super::FileInput, StageError>;
}

/// Everything that a stage knows when it decides.
pub struct Known<'a> {
    /// Name of the stage.
    pub name: &'a str,
    /// The context that all stages share.
    pub context: &'a Context,
    /// Finished inputs, port by port in the order of [`super::Stage::inputs`].
    pub inputs: Vec<Input<'a>>,
    /// Artifacts, outcomes and files.
    pub library: &'a dyn Library,
}

impl Known<'_> {
    /// The inputs of one port, in the order the workflow names them.
    pub fn port(&self, key: &str) -> impl Iterator<Item = &Input<'_>> {
        self.inputs.iter().filter(move |input| input.key == key)
    }

    /// The only input of a port.
    ///
    /// # Errors
    /// The port has none.
    pub fn one(&self, key: &str) -> Result<&Input<'_>, StageError> {
        self.port(key).next().ok_or_else(|| StageError::new(format!("`{key}` names no stage")))
    }

    /// The artifact of an input.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn load(&self, input: &Input<'_>) -> Result<Arc<Artifact>, StageError> {
        self.library.load(&input.content)
    }
}
