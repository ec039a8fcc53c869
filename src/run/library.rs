//! What stages may look up while a campaign runs.

use super::board::{Board, TaskState};
use super::files::{Files, path_of};
use super::ledger::Ledger;
use super::task::Lost;
use crate::artifact::{Artifact, ContentHash};
use crate::plan::Workflow;
use crate::stage::beside::plain;
use crate::stage::ledger::Kept;
use crate::stage::rows::Rows;
use crate::stage::{FileInput, Library, Memory, Outcome, StageError, Task};
use crate::store::Store;
use std::cell::RefCell;
use std::sync::Arc;

pub(super) struct Shelf<'a> {
    pub(super) workflow: &'a Workflow,
    pub(super) store: &'a Store,
    pub(super) board: &'a Board,
    /// What is remembered of the runs of the stage that asks.
    pub(super) ledger: Option<&'a Ledger>,
    /// What the stage that asks remembers of its last step.
    pub(super) memory: &'a Memory,
    pub(super) notes: RefCell<Notes>,
}

/// What a stage asked for.
#[derive(Default)]
pub(super) struct Notes {
    /// Files that were looked at, with their digests.
    pub(super) files: Files,
    /// The rows of a fan-out.
    pub(super) rows: Option<Arc<Rows>>,
    /// A result that could not be read.
    pub(super) lost: Option<Lost>,
}

impl Library for Shelf<'_> {
    fn load(&self, content: &ContentHash) -> Result<Arc<Artifact>, StageError> {
        self.store.get(content).map_err(|error| {
            let message = error.to_string();
            self.notes.borrow_mut().lost.get_or_insert(Lost { content: *content, error });
            StageError::new(message)
        })
    }

    fn kept(&self, rows: &Arc<Rows>, index: usize) -> Option<Kept<'_>> {
        self.notes.borrow_mut().rows.get_or_insert_with(|| Arc::clone(rows));
        self.ledger?.kept(rows, index)
    }

    fn outcome(&self, task: &Task) -> Option<Outcome> {
        let node = self.board.find(task)?;
        match self.board.state(node) {
            TaskState::Done { content, .. } => Some(Outcome::Done(*content)),
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
        plain(&full).map_err(absent)?;
        let bytes = std::fs::read(&full).map_err(|e| absent(e.to_string()))?;
        let digest = blake3::hash(&bytes);
        self.notes.borrow_mut().files.push((path.to_owned(), digest.to_hex().to_string()));
        Ok(FileInput { name: name.to_owned(), path: full, digest: *digest.as_bytes() })
    }
}
