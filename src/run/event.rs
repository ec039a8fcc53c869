//! Events of a run, for the person who watches it.

use super::{StageReport, TaskCount};
use crate::stage::Progress;

/// An event of a run.
pub enum Event<'a> {
    /// A task of a stage was started.
    Started {
        /// The stage.
        stage: &'a str,
        /// Its row.
        row: Option<usize>,
    },
    /// A running task reports its progress.
    Progress {
        /// The stage.
        stage: &'a str,
        /// Its row.
        row: Option<usize>,
        /// Its progress.
        progress: &'a Progress,
    },
    /// A stage asked for tasks: how many there are, and how many of them are in the store.
    Counted {
        /// The stage.
        stage: &'a str,
        /// Its counts.
        count: TaskCount,
        /// Whether the store has its result, so that it asks for nothing more.
        is_done: bool,
    },
    /// A stage that decides by outcomes asked for more.
    Asked {
        /// The stage.
        stage: &'a str,
        /// Its counts.
        count: TaskCount,
        /// Its progress.
        note: &'a str,
    },
    /// A task ended, with a result or a failure.
    Ended {
        /// The stage.
        stage: &'a str,
        /// Its row.
        row: Option<usize>,
        /// The stage's counts after it.
        count: TaskCount,
        /// Why it failed.
        failure: Option<&'a str>,
    },
    /// Something about the workers on other machines.
    Word {
        /// In words.
        text: &'a str,
    },
    /// A stage ended.
    Stage {
        /// Its outcome.
        report: &'a StageReport,
    },
}

/// Takes events; called from any thread.
pub trait Watch: Sync {
    /// One event.
    fn event(&self, event: Event<'_>);
}

/// Ignores all events.
pub struct Silent;

impl Watch for Silent {
    fn event(&self, _: Event<'_>) {}
}
