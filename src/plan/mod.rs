//! From TOML text to a checked graph, and from tasks to keys; pure but for reading the file.
//!
//! [`load`] reads the text into a tree of values that know their locations (`syntax`), lays the profile and the `--set`
//! options over it (`overlay`), reads each table into its own type (`read`), checks names, units, ports and cycles
//! (`check`), and puts the stages in order (`graph`). It finds all faults of a file at once.
//! [`key`](mod@key) writes the task text and its hash, [`why`] says how two task texts differ.

mod check;
mod collect;
mod fault;
mod file;
mod graph;
pub mod key;
mod node;
mod overlay;
mod read;
mod reader;
pub mod schema;
mod sets;
mod stages;
mod syntax;
pub mod why;

pub use fault::{Fault, Location, Source, nearest};

use crate::stage::{Context, Stage};
use std::path::{Path, PathBuf};

/// Overrides of the values of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    /// Name of a profile of the file.
    pub profile: Option<String>,
    /// Options such as `stage.anova.alpha=0.01`: a path, and a TOML value or else text.
    pub sets: Vec<String>,
}

/// A checked workflow.
pub struct Workflow {
    /// The file's name without its extension.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Title for reports; empty when none is given.
    pub title: String,
    /// What it is about; empty when not given.
    pub about: String,
    /// Seed, factors and responses.
    pub context: Context,
    /// The profile whose overrides apply.
    pub profile: Option<String>,
    /// Names of all profiles of the file.
    pub profiles: Vec<String>,
    /// Stages so that each comes after its inputs, else in the order of the file.
    pub stages: Vec<StageNode>,
    /// Files beside it that cannot be read, or lack columns that stages read. They are faults of a run, but stored results can be
    /// shown without them.
    pub absent: Vec<Fault>,
    /// Warnings: no faults, but a reader must know them before trusting the results.
    pub warnings: Vec<Fault>,
}

/// A stage of a workflow.
pub struct StageNode {
    /// Its name.
    pub name: String,
    /// Its title for people, where the workflow gives one.
    pub title: Option<String>,
    /// The word after `kind =`.
    pub kind: &'static str,
    /// The configured stage.
    pub stage: Box<dyn Stage>,
    /// Its inputs, port by port: the port's key, and which of the workflow's stages it is.
    pub inputs: Vec<(&'static str, usize)>,
}

impl Workflow {
    /// The index of the stage with this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.stages.iter().position(|stage| stage.name == name)
    }
}

/// Reads and checks a workflow file.
///
/// # Errors
/// All faults of the file at once.
pub fn load(path: &Path, overrides: &Overrides) -> Result<Workflow, Vec<Fault>> {
    let text = syntax::read_file(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut workflow = check::workflow(&path.display().to_string(), &text, overrides, Some(folder))?;
    path.clone_into(&mut workflow.path);
    Ok(workflow)
}

/// Checks the text of a workflow without a look at files beside it; `name` is that of its file.
///
/// # Errors
/// All faults of the text at once.
pub fn parse(name: &str, text: &str, overrides: &Overrides) -> Result<Workflow, Vec<Fault>> {
    check::workflow(name, text, overrides, None)
}

#[cfg(test)]
mod tests;
