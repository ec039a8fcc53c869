//! Forecasts for `flow plan`: the number of tasks of a stage, as far as the workflow and its files determine it before
//! anything runs.

use super::Context;
use super::cost::Bulk;

/// Tasks and rows of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Rows of its result, for stages that run them; `None` where only the run shows it.
    pub rows: Option<usize>,
    /// Largest number of equal rows among them.
    pub replicates: usize,
    /// Tasks of one more run on a specimen of its own: the specimen and the run.
    pub per_run: usize,
    /// Its tasks; `None` where only the run shows their number.
    pub tasks: Option<TaskForecast>,
    /// Seconds that all its tasks take on one core, roughly; none where nothing tells, as of a program.
    pub seconds: Option<f64>,
    /// Seconds of one more run of it on a specimen of its own.
    pub run_seconds: Option<f64>,
    /// The specimen that it makes.
    pub bulk: Option<Bulk>,
}

/// Number of tasks of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskForecast {
    /// This number; fewer are run where stages share tasks.
    Exactly(usize),
    /// This number or fewer: the stage may end early.
    AtMost(usize),
}

/// The information for a forecast.
pub struct Ahead<'a> {
    /// The context of the whole workflow.
    pub context: &'a Context,
    /// The forecasts of the stages behind a port.
    pub behind: &'a dyn Fn(&str) -> Vec<Forecast>,
    /// Reads a file beside the workflow; `None` when it cannot be read.
    pub file: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl TaskForecast {
    /// The number, exact or an upper bound.
    pub fn count(self) -> usize {
        match self {
            Self::Exactly(tasks) | Self::AtMost(tasks) => tasks,
        }
    }

    /// Whether the number is an upper bound.
    pub fn is_bound(self) -> bool {
        matches!(self, Self::AtMost(_))
    }

    /// The sum of these tasks and `more`.
    pub fn and(self, more: usize) -> Self {
        match self {
            Self::Exactly(tasks) => Self::Exactly(tasks.saturating_add(more)),
            Self::AtMost(tasks) => Self::AtMost(tasks.saturating_add(more)),
        }
    }
}

impl Forecast {
    /// One task.
    pub const ONE: Self = Self {
        rows: None,
        replicates: 1,
        per_run: 1,
        tasks: Some(TaskForecast::Exactly(1)),
        seconds: Some(0.0),
        run_seconds: Some(0.0),
        bulk: None,
    };

    /// An unknown number of tasks.
    pub const UNKNOWN: Self = Self { tasks: None, seconds: None, run_seconds: None, ..Self::ONE };

    /// Seconds of so many runs of each of these simulators.
    pub fn seconds_of(simulators: impl Iterator<Item = Self>, runs: usize) -> Option<f64> {
        simulators.map(|simulator| simulator.run_seconds).sum::<Option<f64>>().map(|each| each * runs as f64)
    }

    /// A run for each row of the design behind the port `design`, on specimens that `specimens` counts from the design's
    /// forecast, and the task that gathers them; one run without a design.
    pub fn of_design(ahead: &Ahead, specimens: impl Fn(&Self, usize) -> TaskForecast) -> Self {
        let Some(design) = (ahead.behind)("design").into_iter().next() else { return Self::ONE };
        let tasks = |rows: usize| specimens(&design, rows).and(rows.saturating_add(1));
        Self { rows: design.rows, tasks: design.rows.map(tasks), ..Self::ONE }
    }
}
