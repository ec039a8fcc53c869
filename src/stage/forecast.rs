//! What a stage is expected to ask for, as far as the workflow and its files tell before anything runs: for `flow plan`.

use super::Context;

/// Tasks and rows of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forecast {
    /// Rows of its result, for stages that go through them; none where only the run tells.
    pub rows: Option<usize>,
    /// Tasks that it asks for; none where only the run tells.
    pub tasks: Option<TaskForecast>,
}

/// How many tasks a stage asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskForecast {
    /// So many; fewer where stages ask for the same ones.
    Exactly(usize),
    /// So many, or fewer: it may end early.
    AtMost(usize),
}

/// What can be seen ahead of a run.
pub struct Ahead<'a> {
    /// Of the whole workflow.
    pub context: &'a Context,
    /// Rows of the stage behind a port, where they are known.
    pub rows: &'a dyn Fn(&str) -> Option<usize>,
    /// The bytes of a file beside the workflow; none when it cannot be read.
    pub file: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Forecast {
    /// One task.
    pub const ONE: Self = Self { rows: None, tasks: Some(TaskForecast::Exactly(1)) };

    /// Nothing is known.
    pub const UNKNOWN: Self = Self { rows: None, tasks: None };

    /// A run for each of these rows, and the task that gathers them.
    pub fn of_rows(rows: Option<usize>) -> Self {
        Self { rows, tasks: rows.map(|rows| TaskForecast::Exactly(rows.saturating_add(1))) }
    }
}
