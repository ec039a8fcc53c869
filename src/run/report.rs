//! The outcome of a campaign.

use super::board::{Board, TaskCount, TaskReport};
use super::stages::{StageReport, Stages};
use crate::store::ObjectId;

/// Why nobody can tell what a store holds.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unreadable(pub(super) String);

/// The outcome of a campaign.
pub struct Report {
    /// Every wanted stage, in the order of the workflow.
    pub stages: Vec<StageReport>,
    /// Whether it was interrupted.
    pub interrupted: bool,
    /// The store could not be read; what was wrong.
    pub broken: Option<String>,
    pub(super) board: Board,
    pub(super) states: Stages,
}

impl Report {
    /// The tasks that are known, in the order they became known; none of stages that were remembered.
    pub fn tasks(&self) -> impl DoubleEndedIterator<Item = TaskReport> {
        self.board.reports()
    }

    /// Every object that the campaign rests on.
    pub fn objects(&self) -> impl DoubleEndedIterator<Item = ObjectId> {
        self.board.objects().chain(self.states.remembered())
    }

    /// Counts over all stages.
    pub fn count(&self) -> TaskCount {
        self.stages.iter().fold(TaskCount::default(), |sum, stage| sum + stage.tasks)
    }
}
