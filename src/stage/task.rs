//! The unit of work, and the function that computes it.

use super::beside::read;
use super::cached::CachedRuns;
use super::{Packed, StageError};
use crate::artifact::{Artifact, ContentHash};
use dem::Watch;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// One unit of work: everything that decides its result, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Name of its [`Work`].
    pub work: &'static str,
    /// Parameters that decide its result, in SI units; [`Job::params`] reads them.
    pub params: Packed,
    /// Its seed, when it draws random numbers.
    pub seed: Option<u64>,
    /// Named inputs in a fixed order.
    pub inputs: Vec<(Cow<'static, str>, Source)>,
    /// Files it reads, known by content.
    pub files: Vec<FileInput>,
    /// The design row (from 0) that it computes; for readers only, not part of its key.
    pub row: Option<usize>,
    /// Seconds after which an external program is ended; not part of its key.
    pub time_limit: Option<f64>,
    /// Bound on how many tasks of its program run at once; not part of its key.
    pub at_once: Option<Arc<AtOnce>>,
    /// Those of its inputs whose summaries are cached, so that they need not be read; not part of its key.
    pub cached: Option<Arc<CachedRuns>>,
}

impl Task {
    /// A task without inputs.
    pub fn new(work: &'static str, params: Value) -> Self {
        Self {
            work,
            params: params.into(),
            seed: None,
            inputs: Vec::new(),
            files: Vec::new(),
            row: None,
            time_limit: None,
            at_once: None,
            cached: None,
        }
    }

    /// Sets its seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = Some(seed);
        self
    }

    /// Adds an artifact as an input.
    #[must_use]
    pub fn input(mut self, name: impl Into<Cow<'static, str>>, content: ContentHash) -> Self {
        self.inputs.push((name.into(), Source::Content(content)));
        self
    }

    /// Adds the result of another task as an input.
    #[must_use]
    pub fn after(mut self, name: impl Into<Cow<'static, str>>, task: Arc<Task>) -> Self {
        self.inputs.push((name.into(), Source::Task(task)));
        self
    }

    /// Sets the design row that it computes.
    #[must_use]
    pub fn row(mut self, row: usize) -> Self {
        self.row = Some(row);
        self
    }
}

/// A bound on how many tasks run an external program at once, such as the number of its licences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AtOnce {
    /// The program; stages with the same program share its licences.
    pub program: String,
    /// Most runs at once.
    pub most: usize,
}

/// Source of an input.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// An artifact that is in the store.
    Content(ContentHash),
    /// The result of another task.
    Task(Arc<Task>),
    /// The result of a task that the runner took out of here: it knows which.
    Placed,
}

impl Source {
    /// The task that makes it.
    pub fn task(&self) -> Option<&Arc<Task>> {
        match self {
            Self::Task(task) => Some(task),
            Self::Content(_) | Self::Placed => None,
        }
    }

    /// Takes out the task that makes it.
    pub fn take_task(&mut self) -> Option<Arc<Task>> {
        match std::mem::replace(self, Self::Placed) {
            Self::Task(task) => Some(task),
            other => {
                *self = other;
                None
            }
        }
    }
}

/// A file that a task reads: the content is in its key, the path is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileInput {
    /// Its name in the task.
    pub name: String,
    /// Its path now.
    pub path: PathBuf,
    /// blake3 of its bytes, checked by the reader.
    pub digest: [u8; 32],
}

/// The next step of a stage.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The result of this task is the stage's result.
    Finish(Task),
    /// Tasks whose outcomes it needs first, and its progress in a few words.
    Ask(Vec<Task>, String),
}

/// A function that tasks name.
#[derive(Clone, Copy)]
pub struct Work {
    /// Its name, unique among all works.
    pub name: &'static str,
    /// Version of its results.
    pub version: u32,
    /// Computes the artifact of one task.
    pub run: fn(&Job) -> Result<Artifact, Failure>,
}

/// A task that runs, with its inputs.
pub struct Job<'a> {
    /// Parameters of the task.
    pub params: &'a Value,
    /// Its seed.
    pub seed: Option<u64>,
    /// Its inputs by name, in order; cached runs are together in one input `cached` at the end.
    pub inputs: &'a [(String, Arc<Artifact>)],
    /// Files it reads.
    pub files: &'a [FileInput],
    /// Number of threads that it may use at present; results do not depend on it. Long work calls this repeatedly.
    pub threads: &'a (dyn Fn() -> usize + Sync),
    /// Seconds after which an external program is ended.
    pub time_limit: Option<f64>,
    /// Receives reports of progress.
    pub say: &'a (dyn Fn(Progress) + Sync),
    /// Set when the run is interrupted.
    pub stop: &'a AtomicBool,
}

impl Job<'_> {
    /// The parameters in their type.
    ///
    /// # Errors
    /// They do not fit, which happens when a task text was written by hand.
    pub fn params<P: DeserializeOwned>(&self) -> Result<P, Failure> {
        P::deserialize(self.params).map_err(|e| StageError::new(format!("parameters of the task: {e}")).into())
    }

    /// The input called `name`.
    ///
    /// # Errors
    /// There is none.
    pub fn input(&self, name: &str) -> Result<&Arc<Artifact>, Failure> {
        let found = self.inputs.iter().find(|(n, _)| n == name);
        found.map(|(_, artifact)| artifact).ok_or_else(|| StageError::new(format!("no input `{name}`")).into())
    }

    /// The bytes of the file called `name`, checked against its digest.
    ///
    /// # Errors
    /// It cannot be read or has changed since the plan was made.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, Failure> {
        let fail = |message: String| Failure::from(StageError::new(message));
        let file = self.files.iter().find(|f| f.name == name).ok_or_else(|| fail(format!("no file `{name}`")))?;
        let unread = |why: String| fail(format!("{}: {why}", file.path.display()));
        let bytes = read(&file.path).map_err(unread)?;
        if *blake3::hash(&bytes).as_bytes() != file.digest {
            return Err(fail(format!("{} changed while the campaign ran", file.path.display())));
        }
        Ok(bytes)
    }

    /// Whether the run is being interrupted; long work checks this repeatedly and then returns [`Failure::Stopped`].
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Whether to stop, in the form that engine and packing take.
    pub fn watch(&self) -> Watch {
        if self.stopped() { Watch::Stop } else { Watch::Threads((self.threads)()) }
    }
}

/// The progress of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Part done, 0 to 1, when it is known.
    pub fraction: Option<f64>,
    /// A few words, such as `ε 0.12 %, σ 23.1 MPa`.
    pub note: String,
    /// Whether the words are a warning, which must stay visible.
    pub warning: bool,
}

impl Progress {
    /// Progress in a few words.
    pub fn note(note: String) -> Self {
        Self { note, ..Self::default() }
    }

    /// A warning on the result, sent as early as possible.
    pub fn warning(words: &dyn std::fmt::Display) -> Self {
        Self { note: words.to_string(), warning: true, ..Self::default() }
    }
}

/// Why a task has no artifact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The run was interrupted; the task can be run again.
    #[error("interrupted")]
    Stopped,
    /// It cannot be done.
    #[error(transparent)]
    Failed(#[from] StageError),
}
