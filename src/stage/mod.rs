//! Stages: where the domain folders meet workflows and artifacts.
//!
//! A workflow's `[stage.NAME]` table is read into the config type of its kind (`kind = "anova"` → [`Kind`]), which *is*
//! the configured stage: it implements [`Stage`]. A stage is a pure function of what is known: its context, the
//! artifacts of its inputs and the outcomes of the tasks that it has requested. [`Stage::next`] returns a [`Step`]:
//!
//! * `Finish(task)`: the artifact of this task is the stage's result. A task may take other tasks as inputs, so a
//!   stage that fans out (a simulation per design row, each on its own specimen) finishes at once with a gathering
//!   task whose inputs are the runs, whose input is the specimen. The runner walks the tree, computes keys from the
//!   bottom up, runs what is missing in parallel, and shares equal tasks wherever they come from.
//! * `Ask(tasks)`: a stage that must see outcomes before it can continue (calibration with the simulation in the loop).
//!   When all are done, `next` is called again and sees their outcomes in [`Known`]; a killed run resumes by replay.
//!
//! A [`Task`] holds everything that decides its result and nothing else. Its `work` names a function in
//! [`work`]; raise that function's version when its results change, with a line that says what changed (for one kind of
//! loading test alone, its revision in [`simulate`]).
//!
//! # Artifacts that several kinds exchange
//! * `results`: a table `runs` with one row per run: factors (in their units), `replicate`, responses (in the units of
//!   `[response.NAME]`), `failure` (text, empty when all went well; the responses are then missing), and where runs have
//!   checks of their own `validity` and `cautions` (texts: the checks that are not met; [`invalid::Invalid`] says what a
//!   stage does with runs that are not valid). From `simulate`, `command` and `data`.
//! * `design`: a table `design` with `point_type` and the factors, and a table `report`.
//! * `run`: one run of a simulator: a table `responses` (`response,value,unit`) and, for `simulate`, curve, cracks, ….
//! * `surfaces`: fitted models (tables `coefficients`, `fit`, `residuals`, `stationary` and what prediction needs).
//! * `solution`: calibrated sets (tables `solution`, `history`, `solution_set`).
//!
//! Columns that are factors bear the names of `[factor.NAME]` tables, responses those of `[response.NAME]`.
//!
//! # A new kind
//! One file with the config struct (serde, schemars, `deny_unknown_fields`; quantities as [`crate::unit::Quantity`]),
//! `impl Stage`, `impl Kind` and its work functions, and one line in the list below (`census.rs` is such a file, for
//! the tests). `Kind` says what artifacts it can
//! give and which class it belongs to; an artifact that no other kind gives is declared in the same file
//! ([`ArtifactKind::new`]). Options added later are skipped when at their default (`skip_serializing_if`), so that they
//! rerun nothing. Parameters of tasks are plain SI numbers (the domain's own spec types), built from the config in `next`.

pub mod agreement;
pub mod anova;
pub mod beside;
pub mod cached;
pub mod calibrate;
#[cfg(test)]
pub mod census;
mod columns;
pub mod command;
mod context;
pub mod cost;
pub mod data;
mod derived;
pub mod design;
pub mod effort;
pub mod envelope;
pub mod figure;
pub mod fitted;
pub mod forecast;
pub mod formula;
mod given;
pub mod invalid;
pub mod material;
mod memory;
mod notes;
mod packed;
mod published;
pub mod range;
pub mod reads;
pub mod regression;
pub mod rows;
pub mod rsm;
pub mod screening;
pub mod shapes;
mod sheet;
pub mod simulate;
pub mod specimen;
pub mod table;
mod task;
pub mod units;
pub mod vary;
pub mod verify;

pub use context::{
    Context, Factor, Input, Known, Library, Outcome, Outline, Parameter, Point, Response, Sampler, Sketch, Varier,
};
pub use memory::Memory;
pub use packed::Packed;
pub use task::{AtOnce, Failure, FileInput, Job, Progress, Source, Step, Task, Work};

use crate::artifact::{Accepts, Artifact, ArtifactKind, Unread, Wanted};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde::{Deserializer, Serialize};
use serde_json::Value;

/// Names of columns beside factors and responses in a table or template, which no factor or response can have.
pub const OWN_COLUMNS: [&str; 21] = [
    "run",
    "row",
    "standard_order",
    "replicate",
    "point_type",
    "failure",
    "validity",
    "cautions",
    "set",
    "specimen",
    "evaluation",
    "evaluations",
    "misfit",
    "best",
    "recommended",
    "failed",
    "stop",
    "free",
    "seed",
    "weight",
    "remark",
];

/// Columns whose cells name factors, responses, or products of their powers; people see symbols there.
pub const NAMING_COLUMNS: [&str; 6] = ["factor", "quantity", "response", "source", "subject", "term"];

/// The fault of a symbol, which becomes mathematics in figures, pages and LaTeX.
pub fn symbol_fault(symbol: &str) -> Option<String> {
    if symbol.is_empty() || ::figure::escape::is_mathematics(symbol) {
        return None;
    }
    let known = ::figure::text::check(&format!("${symbol}$")).err().map(|fault| fault.to_string());
    Some(known.unwrap_or_else(|| {
        format!("symbol `{symbol}`: $ % & # ~ \" are no mathematics; write `\\%` for a per cent sign")
    }))
}

/// The settings of a stage as canonical values.
pub trait Settings {
    /// All settings, defaults filled in, quantities as SI numbers: for recognising an unchanged stage at once, and for
    /// `flow diff`, run records and the report. Every field of the config type is there: none can be forgotten.
    fn settings(&self) -> Value;
}

impl<T: Serialize> Settings for T {
    fn settings(&self) -> Value {
        serde_json::to_value(self).unwrap_or_else(|e| panic!("BUG: settings that are no plain values: {e}"))
    }
}

/// One configured stage of a workflow: its config type, which serde reads and writes.
pub trait Stage: Settings + Send + Sync {
    /// The stages it takes as inputs, in a fixed order.
    fn inputs(&self) -> Vec<Port>;

    /// Kind of the artifact that is its result, one of [`Kind::GIVES`].
    fn gives(&self) -> ArtifactKind;

    /// Every fault that can be seen without running anything: unknown factors, empty ranges, settings without effect.
    fn check(&self, context: &Context) -> Vec<Complaint>;

    /// Checks the files that it names: files that do not exist, and files outside every key.
    fn beside(&self, _context: &Context, _found: &mut beside::Beside) {}

    /// The columns that it reads from the main tables of other stages, by the keys that name them.
    fn reads(&self) -> Vec<reads::Reads> {
        Vec::new()
    }

    /// The properties that other stages can use before anything runs.
    fn sketch(&self) -> Sketch {
        Sketch::default()
    }

    /// The forecast of its tasks.
    fn forecast(&self, _ahead: &forecast::Ahead) -> forecast::Forecast {
        forecast::Forecast::ONE
    }

    /// The next step; a pure function of what is known.
    ///
    /// # Errors
    /// The stage is impossible with these inputs, such as with a design that lacks a factor.
    fn next(&self, known: &Known) -> Result<Step, StageError>;

    /// What the workflow requires of the result, for kinds of which something can be required: only then is it read for that.
    fn demands(&self) -> Option<&dyn Demands> {
        None
    }

    /// The task that makes replicate `number` (counted from 1) of this stage's result, for kinds that have replicates
    /// (specimens): the result of the stage itself is replicate 1. `known` is what this stage knows.
    fn replicate(&self, _known: &Known, _number: u64) -> Option<Task> {
        None
    }

    /// The task that tries one point of the factor space on replicate `number` of its specimen, for kinds
    /// that can stand as a simulator (`simulate`, `command`): calibration and verification ask for such tasks. Its
    /// artifact is that of a single run. The task depends on the settings of the stage, its inputs, the seed, materials,
    /// responses, and the units and paths of factors, but not on their levels: a run does not depend on the rest of a design.
    ///
    /// # Errors
    /// The kind is no simulator, or a factor of the point is not one that it can set.
    fn sample(&self, _known: &Known, _point: &Point, _number: u64) -> Result<Task, StageError> {
        Err(StageError::new("this stage is no simulator").hint("name a stage of kind simulate or command"))
    }
}

/// What a workflow requires of the result of a stage.
pub trait Demands {
    /// A requirement that the computed result does not meet: `flow run` reports it and exits with 1.
    fn unmet(&self, result: &Artifact) -> Option<String>;
}

/// A kind of stage: its config type is the configured stage.
pub trait Kind: Stage + DeserializeOwned + JsonSchema + 'static {
    /// The word after `kind =`.
    const NAME: &'static str;
    /// One line for the schema and for `flow` help.
    const ABOUT: &'static str;
    /// The kinds of artifact that it can give; [`Stage::gives`] names one of them.
    const GIVES: &'static [ArtifactKind];
    /// Its class in pictures of a workflow.
    const CLASS: Class;
    /// The work that its tasks name.
    const WORKS: &'static [Work];
    /// The work that takes long enough to be sent to the workers of a cluster.
    const FAR: Option<&'static str> = None;
}

/// Classes of stages, as pictures of a workflow tell them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Makes specimens, or runs a model at points.
    Simulation,
    /// Reads values that were measured, or computed by other programs.
    Data,
    /// Plans experiments.
    Design,
    /// Analyses results.
    Statistics,
    /// Finds parameters, or verifies them.
    Calibration,
    /// Shows the results of other stages.
    Presentation,
}

impl Class {
    /// Whether its stages compute results, rather than read or show them.
    pub fn computes(self) -> bool {
        !matches!(self, Self::Data | Self::Presentation)
    }
}

/// A named input of a stage: the key under which the workflow names other stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The key in the stage's table, such as `design`.
    pub key: &'static str,
    /// The stages named there, in order.
    pub stages: Vec<String>,
    /// Kinds of artifact that are accepted.
    pub accepts: Accepts,
}

/// What has a name in a workflow, or in a table that it reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// A `[factor.NAME]`.
    Factor,
    /// A `[response.NAME]`.
    Response,
    /// A `[material.NAME]`.
    Material,
    /// A `[stage.NAME]`.
    Stage,
    /// A column of a table, which may be that of a factor or of a response.
    Column,
}

/// A name of something that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// What would have the name.
    pub what: Named,
    /// The name.
    pub name: String,
    /// Names one of which may have been meant.
    pub among: Vec<String>,
}

impl Missing {
    /// Whether `[SECTION.NAME]` would declare it.
    pub fn is(&self, section: &str, name: &str) -> bool {
        let sections: &[&str] = match self.what {
            Named::Factor => &["factor"],
            Named::Response => &["response"],
            Named::Material => &["material"],
            Named::Stage => &["stage"],
            Named::Column => &["factor", "response"],
        };
        self.name == name && sections.contains(&section)
    }
}

/// The hint of an unknown name: those that are known, or that the workflow declares none of this kind.
fn known_are<'a>(names: impl IntoIterator<Item = &'a String>, kind: &str) -> String {
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    if names.is_empty() {
        return format!("the workflow declares no {kind}");
    }
    format!("known are {}", names.join(", "))
}

/// A fault in a stage's settings, found before anything runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Complaint {
    /// Path below the stage's table, such as `["levels", "Ec"]`; empty for the table itself.
    pub path: Vec<String>,
    /// The `[material.NAME]` that the path lies below instead.
    pub material: Option<String>,
    /// What is not there, if the complaint is about that: where it was found missing already, the complaint is a consequence
    /// and is not printed.
    pub missing: Option<Box<Missing>>,
    /// What was found and what was expected.
    pub message: String,
    /// What to do.
    pub hint: Option<String>,
}

impl Complaint {
    /// A complaint about the value at `path` (keys separated by dots).
    pub fn new(path: &str, message: impl Into<String>) -> Self {
        let path = path.split('.').filter(|part| !part.is_empty()).map(str::to_owned).collect();
        Self { path, material: None, missing: None, message: message.into(), hint: None }
    }

    /// Says what is not there.
    #[must_use]
    pub fn missing(mut self, what: Named, name: &str) -> Self {
        self.missing = Some(Box::new(Missing { what, name: name.to_owned(), among: Vec::new() }));
        self
    }

    /// Adds names one of which may have been meant by the one that is not there.
    #[must_use]
    pub fn among<'a>(mut self, names: impl IntoIterator<Item = &'a String>) -> Self {
        if let Some(missing) = &mut self.missing {
            missing.among = names.into_iter().cloned().collect();
        }
        self
    }

    /// Sets the material below which the path lies.
    #[must_use]
    pub fn in_material(mut self, name: &str) -> Self {
        self.material = Some(name.to_owned());
        self
    }

    /// Adds what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// Why a stage or a task cannot continue, as a message for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct StageError {
    /// What was found, where, and what was expected.
    pub message: String,
    /// What to do.
    pub hint: Option<String>,
}

impl StageError {
    /// An error with its message.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None }
    }

    /// Adds what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds another thing to do.
    #[must_use]
    pub fn or(mut self, other: &str) -> Self {
        self.hint = Some(self.hint.map_or_else(|| other.to_owned(), |hint| format!("{hint}; {other}")));
        self
    }
}

impl From<Unread> for StageError {
    fn from(unread: Unread) -> Self {
        Self::new(unread.to_string())
    }
}

impl From<Wanted> for StageError {
    fn from(wanted: Wanted) -> Self {
        Self::new(wanted.to_string())
    }
}

/// The entry of one kind in [`KINDS`].
pub struct KindEntry {
    /// The word after `kind =`.
    pub name: &'static str,
    /// One line on it.
    pub about: &'static str,
    /// The kinds of artifact that it can give.
    pub gives: &'static [ArtifactKind],
    /// Its class in pictures of a workflow.
    pub class: Class,
    /// The work that its tasks name.
    pub works: &'static [Work],
    /// The work that takes long enough to be sent to the workers of a cluster.
    pub far: Option<&'static str>,
    /// Schema of its table.
    pub schema: fn(&mut SchemaGenerator) -> Schema,
}

/// Makes [`KINDS`] and [`read`] from the list of config types:
/// `kinds! { data::Data }` becomes a constant with one entry per type, and a function that tries each name in turn.
macro_rules! kinds {
    ($($(#[$attribute:meta])* $config:ty),* $(,)?) => {
        /// Every kind of stage.
        pub const KINDS: &[KindEntry] = &[$($(#[$attribute])* KindEntry {
            name: <$config as Kind>::NAME,
            about: <$config as Kind>::ABOUT,
            gives: <$config as Kind>::GIVES,
            class: <$config as Kind>::CLASS,
            works: <$config as Kind>::WORKS,
            far: <$config as Kind>::FAR,
            schema: <$config as JsonSchema>::json_schema,
        }),*];

        /// Reads the table of a stage of the named kind; `None` when there is no such kind.
        pub fn read<'de, D: Deserializer<'de>>(kind: &str, table: D) -> Option<Result<Box<dyn Stage>, D::Error>> {
            $($(#[$attribute])* if kind == <$config as Kind>::NAME {
                return Some(<$config as serde::Deserialize>::deserialize(table).map(|stage| Box::new(stage) as _));
            })*
            let _ = table;
            None
        }
    };
}

kinds! {
    agreement::Agreement,
    anova::Anova,
    calibrate::Calibrate,
    #[cfg(test)]
    census::Census,
    command::Command,
    data::Data,
    design::Design,
    envelope::Envelope,
    effort::Effort,
    figure::Figure,
    formula::Formula,
    range::Range,
    regression::Regression,
    rsm::Rsm,
    screening::Screening,
    shapes::Shapes,
    simulate::Simulate,
    specimen::Specimen,
    table::Table,
    verify::Verify,
}

/// The entry of the kind called `name`.
pub fn kind(name: &str) -> Option<&'static KindEntry> {
    KINDS.iter().find(|kind| kind.name == name)
}

/// The declared kind of an artifact; `None` for one that no kind of stage gives.
pub fn artifact_kind(artifact: &Artifact) -> Option<ArtifactKind> {
    KINDS.iter().flat_map(|kind| kind.gives).copied().find(|kind| artifact.is(*kind))
}

/// The work called `name`.
pub fn work(name: &str) -> Option<&'static Work> {
    KINDS.iter().flat_map(|kind| kind.works).find(|work| work.name == name)
}

/// Whether work takes long enough to be sent to the workers of a cluster.
pub fn is_far(work: &str) -> bool {
    KINDS.iter().any(|kind| kind.far == Some(work))
}
