//! Where each stage of the workflow stands.

use super::board::{Board, NodeId, TaskCount, TaskState};
use crate::artifact::ContentHash;
use crate::plan::Workflow;
use crate::stage::{Input, Known, Library, StageError, Step};
use std::sync::Arc;

/// What became of a stage, for people and programs.
#[derive(Clone, Debug)]
pub struct StageReport {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: &'static str,
    /// Where it stands.
    pub status: StageStatus,
    /// Its tasks.
    pub tasks: TaskCount,
}

/// Where a stage stands.
#[derive(Clone, Debug, PartialEq)]
pub enum StageStatus {
    /// Not begun or not ended: work is left to do, or was not started.
    Open,
    /// Its result.
    Done(ContentHash),
    /// Why it failed.
    Failed(String),
    /// A stage that it needs failed; which.
    Skipped(String),
}

enum State {
    /// Some inputs are not there, or its step is still to be asked for.
    Waiting,
    /// It must see these first.
    Asking(Vec<NodeId>),
    /// The node whose result is the stage's.
    Finishing(NodeId),
    Ended(StageStatus),
}

pub(super) struct Stages {
    states: Vec<State>,
    wanted: Vec<bool>,
}

impl Stages {
    pub(super) fn new(workflow: &Workflow, targets: &[String]) -> Self {
        let mut wanted: Vec<bool> =
            workflow.stages.iter().map(|stage| targets.is_empty() || targets.contains(&stage.name)).collect();
        for index in (0..workflow.stages.len()).rev().filter(|_| !targets.is_empty()) {
            if wanted[index] {
                workflow.stages[index].inputs.iter().for_each(|&(_, input)| wanted[input] = true);
            }
        }
        Self { states: workflow.stages.iter().map(|_| State::Waiting).collect(), wanted }
    }

    /// Wanted stages that can be asked for their next step.
    pub(super) fn due(&self, workflow: &Workflow, board: &Board) -> Vec<usize> {
        let settled = |node: &NodeId| !matches!(board.state(*node), TaskState::Open | TaskState::Running);
        (0..self.states.len())
            .filter(|&index| self.wanted[index])
            .filter(|&index| match &self.states[index] {
                State::Waiting => workflow.stages[index].inputs.iter().all(|&(_, input)| self.content(input).is_some()),
                State::Asking(nodes) => nodes.iter().all(settled),
                State::Finishing(_) | State::Ended(_) => false,
            })
            .collect()
    }

    fn content(&self, index: usize) -> Option<ContentHash> {
        match self.states[index] {
            State::Ended(StageStatus::Done(content)) => Some(content),
            State::Waiting | State::Asking(_) | State::Finishing(_) | State::Ended(_) => None,
        }
    }

    /// Asks a stage for its next step.
    pub(super) fn ask(&self, workflow: &Workflow, index: usize, library: &dyn Library) -> Result<Step, StageError> {
        workflow.stages[index].stage.next(&self.known(workflow, index, library))
    }

    /// What a stage knows once its inputs are there.
    fn known<'a>(&'a self, workflow: &'a Workflow, index: usize, library: &'a dyn Library) -> Known<'a> {
        let input = |&(key, input): &(&'static str, usize)| {
            let Some(content) = self.content(input) else { panic!("BUG: asked before its inputs were there") };
            let maker = &workflow.stages[input];
            Input {
                key,
                stage: &maker.name,
                content,
                replicate: Box::new(|number| maker.stage.replicate(&workflow.context, number)),
                sample: Box::new(move |point, number| {
                    maker.stage.sample(&self.known(workflow, input, library), point, number)
                }),
            }
        };
        let inputs = workflow.stages[index].inputs.iter().map(input).collect();
        Known { context: &workflow.context, inputs, library }
    }

    /// Takes a step; answers with the nodes that are new on the board.
    pub(super) fn take(&mut self, index: usize, step: Result<Step, StageError>, board: &mut Board) -> Vec<NodeId> {
        let mut new = Vec::new();
        self.states[index] = match step {
            Ok(Step::Finish(task)) => State::Finishing(board.put(&Arc::new(task), index, &mut new)),
            Ok(Step::Ask(tasks)) => {
                State::Asking(tasks.into_iter().map(|task| board.put(&Arc::new(task), index, &mut new)).collect())
            }
            Err(error) => State::Ended(StageStatus::Failed(match error.hint {
                Some(hint) => format!("{} ({hint})", error.message),
                None => error.message,
            })),
        };
        new
    }

    /// Ends the stages that can end now.
    pub(super) fn close(&mut self, workflow: &Workflow, board: &Board) -> Vec<StageReport> {
        let mut closed = Vec::new();
        for index in 0..self.states.len() {
            let Some(status) = self.end(workflow, index, board) else { continue };
            self.states[index] = State::Ended(status);
            closed.push(self.report(workflow, index, board));
        }
        closed
    }

    fn end(&self, workflow: &Workflow, index: usize, board: &Board) -> Option<StageStatus> {
        match &self.states[index] {
            State::Waiting => workflow.stages[index].inputs.iter().find_map(|&(_, input)| match &self.states[input] {
                State::Ended(StageStatus::Failed(_)) => Some(StageStatus::Skipped(workflow.stages[input].name.clone())),
                State::Ended(StageStatus::Skipped(cause)) => Some(StageStatus::Skipped(cause.clone())),
                _ => None,
            }),
            State::Finishing(node) => match board.state(*node) {
                TaskState::Done { content, .. } => Some(StageStatus::Done(*content)),
                TaskState::Failed(_) | TaskState::Skipped => {
                    Some(StageStatus::Failed(board.cause(*node).map_or_else(String::new, |(cause, why)| {
                        match board.task(cause).row {
                            Some(row) => format!("row {}: {why}", row + 1),
                            None => why.to_owned(),
                        }
                    })))
                }
                TaskState::Open | TaskState::Running => None,
            },
            State::Asking(_) | State::Ended(_) => None,
        }
    }

    fn report(&self, workflow: &Workflow, index: usize, board: &Board) -> StageReport {
        StageReport {
            name: workflow.stages[index].name.clone(),
            kind: workflow.stages[index].kind,
            status: match &self.states[index] {
                State::Ended(status) => status.clone(),
                State::Waiting | State::Asking(_) | State::Finishing(_) => StageStatus::Open,
            },
            tasks: board.count(index),
        }
    }

    /// Every wanted stage.
    pub(super) fn reports(&self, workflow: &Workflow, board: &Board) -> Vec<StageReport> {
        let wanted = (0..self.states.len()).filter(|&index| self.wanted[index]);
        wanted.map(|index| self.report(workflow, index, board)).collect()
    }
}
