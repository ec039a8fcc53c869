//! What a stage may look up when it is asked for its next step.

use super::board::{Board, TaskState};
use super::files::{Files, path_of};
use super::run_memo::RunMemo;
use super::task::Lost;
use crate::artifact::{Artifact, ContentHash};
use crate::plan::Workflow;
use crate::stage::beside::read;
use crate::stage::cached::CachedRun;
use crate::stage::rows::DesignRows;
use crate::stage::{FileInput, Library, Memory, Outcome, StageError, Task};
use crate::store::Store;
use std::cell::RefCell;
use std::sync::Arc;

/// The library of one stage: results, cached runs and files.
pub(super) struct Shelf<'a> {
    pub(super) workflow: &'a Workflow,
    pub(super) store: &'a Store,
    pub(super) board: &'a Board,
    /// The memo of the runs of the stage that asks.
    pub(super) run_memo: Option<&'a RunMemo>,
    /// What the stage that asks carries over from its last step.
    pub(super) memory: &'a Memory,
    pub(super) lookups: RefCell<Lookups>,
}

/// What a stage looked up in one step.
#[derive(Default)]
pub(super) struct Lookups {
    /// The files that it read, with their digests.
    pub(super) files: Files,
    /// The rows of a fan-out.
    pub(super) rows: Option<Arc<DesignRows>>,
    /// A result that could not be read.
    pub(super) lost: Option<Lost>,
}

impl Library for Shelf<'_> {
    fn load(&self, content: &ContentHash) -> Result<Arc<Artifact>, StageError> {
        self.store.get(content).map_err(|error| {
            let message = error.to_string();
            self.lookups.borrow_mut().lost.get_or_insert(Lost { content: *content, error });
            StageError::new(message)
        })
    }

    fn cached(&self, rows: &Arc<DesignRows>, index: usize) -> Option<CachedRun<'_>> {
        self.lookups.borrow_mut().rows.get_or_insert_with(|| Arc::clone(rows));
        self.run_memo?.cached(rows, index)
    }

    fn outcome(&self, task: &Task) -> Option<Outcome> {
        let node = self.board.find(task)?;
        match self.board.state(node) {
            TaskState::Done { content, .. } => Some(Outcome::Done(content)),
            TaskState::Failed(_) | TaskState::Skipped => {
                Some(Outcome::Failed(self.board.cause(node).map_or_else(String::new, |(_, why)| why.to_owned())))
            }
            TaskState::Open | TaskState::Running => None,
        }
    }

    fn memory(&self) -> Option<&Memory> {
        Some(self.memory)
    }

    fn file(&self, name: &str, path: &str) -> Result<FileInput, StageError> {
        let full = path_of(self.workflow, path);
        let absent = |why: String| {
            let message = format!("{}: {why}", full.display());
            StageError::new(message).hint("paths are relative to the folder of the workflow")
        };
        let bytes = read(&full).map_err(absent)?;
        let digest = blake3::hash(&bytes);
        self.lookups.borrow_mut().files.push((path.to_owned(), digest.to_hex().to_string()));
        Ok(FileInput { name: name.to_owned(), path: full, digest: *digest.as_bytes() })
    }
}
