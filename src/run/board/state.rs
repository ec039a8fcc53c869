//! What is said of tasks: where each stands, and how many stand where.

use crate::artifact::ContentHash;
use crate::store::ObjectId;
use std::ops::Add;

/// Where a task stands.
#[derive(Clone, Debug, PartialEq)]
pub enum TaskState {
    /// Not started: inputs are missing, or it waits for a worker.
    Open,
    /// A worker has it.
    Running,
    /// Its result is in the store.
    Done {
        /// The result.
        content: ContentHash,
        /// Whether it was there already.
        cached: bool,
    },
    /// It failed; why.
    Failed(String),
    /// A task that it needs failed.
    Skipped,
}

/// One task, for people and programs.
#[derive(Clone, Debug)]
pub struct TaskReport {
    /// Index of its stage in the workflow.
    pub stage: usize,
    /// Its design row.
    pub row: Option<usize>,
    /// Its state.
    pub state: TaskState,
    /// Its text, when its inputs are known and it is not done.
    pub text: Option<String>,
    /// The object that holds its result.
    pub object: Option<ObjectId>,
}

/// How many tasks stand where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TaskCount {
    /// All that are known.
    pub total: usize,
    /// Computed in this run.
    pub ran: usize,
    /// Found in the store.
    pub cached: usize,
    /// Failed.
    pub failed: usize,
    /// Left out because something they need failed.
    pub skipped: usize,
}

impl TaskCount {
    /// One task that was in the store.
    pub(in crate::run) const CACHED: Self = Self { total: 1, ran: 0, cached: 1, failed: 0, skipped: 0 };

    /// Tasks that have ended one way or another.
    pub fn ended(&self) -> usize {
        self.ran + self.cached + self.failed + self.skipped
    }
}

impl Add for TaskCount {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            total: self.total + other.total,
            ran: self.ran + other.ran,
            cached: self.cached + other.cached,
            failed: self.failed + other.failed,
            skipped: self.skipped + other.skipped,
        }
    }
}
