//! Where each stage of the workflow stands.

use super::board::{Board, NodeId, TaskCount, TaskState};
use super::files::Files;
use super::library::{Lookups, Shelf};
use super::memo::{self, Base};
use super::run_memo::RunMemo;
use super::streamed::Streamed;
use super::task::Lost;
use crate::artifact::{ContentHash, FirstBytes, Key};
use crate::plan::Workflow;
use crate::stage::rows::DesignRows;
use crate::stage::{Input, Known, Library, Memory, StageError, Step, vary};
use crate::store::{ObjectId, Store};
use std::cell::RefCell;
use std::collections::HashSet;
use std::hash::BuildHasherDefault;
use std::sync::Arc;

/// The outcome of a stage, for people and programs.
#[derive(Clone, Debug)]
pub struct StageReport {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: &'static str,
    /// Its status.
    pub status: StageStatus,
    /// Its tasks.
    pub tasks: TaskCount,
    /// Key of its memo, when its inputs are known.
    pub memo: Option<Key>,
    /// Time of the tasks that ran, seconds of one worker.
    pub seconds: f64,
}

/// Status of a stage.
#[derive(Clone, Debug, PartialEq)]
pub enum StageStatus {
    /// Not finished: work is left, or was not started.
    Open,
    /// Its result.
    Done(ContentHash),
    /// Why it failed.
    Failed(String),
    /// A stage that it needs failed: this one.
    Skipped(String),
}

impl StageStatus {
    /// One word for it.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Done(_) => "done",
            Self::Failed(_) => "failed",
            Self::Skipped(_) => "skipped",
        }
    }
}

enum State {
    /// Inputs are missing, or the stage has not been asked for its next step.
    Waiting,
    /// It needs the outcomes of these tasks before its next step.
    Asking(Vec<NodeId>),
    /// The node whose result is the stage's.
    Finishing(NodeId),
    /// It cannot go on, for this reason.
    Broken(String),
    Ended(StageStatus),
}

struct Entry {
    state: State,
    wanted: bool,
    /// Key of its memo, from the moment its inputs are known.
    key: Option<Key>,
    /// Key of the memo of its runs, known at the same time.
    run: Option<Key>,
    /// The rows whose runs it gathers.
    rows: Option<Arc<DesignRows>>,
    /// Every node it asked for, and the node that is its result.
    asked: Vec<NodeId>,
    files: Files,
    /// What it carries over from its last step.
    memory: Memory,
    /// What its memo says, when the stage was completed from it.
    remembered: Option<memo::Recalled>,
}

pub(super) struct Stages {
    entries: Vec<Entry>,
    base: Base,
    /// Whether memos may complete stages.
    memos: bool,
}

/// Which stages are the targets or needed by them; all when no target is named.
pub(super) fn wanted(workflow: &Workflow, targets: &[String]) -> Vec<bool> {
    let mut wanted: Vec<bool> =
        workflow.stages.iter().map(|stage| targets.is_empty() || targets.contains(&stage.name)).collect();
    for index in (0..workflow.stages.len()).rev() {
        if wanted[index] {
            workflow.stages[index].inputs.iter().for_each(|&(_, input)| wanted[input] = true);
        }
    }
    wanted
}

impl Stages {
    /// All stages before their first step; `memos` says whether memos may complete them.
    pub(super) fn new(workflow: &Workflow, targets: &[String], memos: bool) -> Self {
        let wanted = wanted(workflow, targets);
        let entry = |wanted| Entry {
            state: State::Waiting,
            wanted,
            key: None,
            run: None,
            rows: None,
            asked: Vec::new(),
            files: Vec::new(),
            memory: Memory::default(),
            remembered: None,
        };
        Self { entries: wanted.into_iter().map(entry).collect(), base: memo::base(workflow), memos }
    }

    /// Wanted stages that can be asked for their next step.
    pub(super) fn due(&self, workflow: &Workflow, board: &Board) -> Vec<usize> {
        let due = |index: &usize| match &self.entries[*index].state {
            State::Waiting => workflow.stages[*index].inputs.iter().all(|&(_, input)| self.content(input).is_some()),
            State::Asking(nodes) => nodes.iter().all(|&node| board.is_settled(node)),
            State::Finishing(_) | State::Broken(_) | State::Ended(_) => false,
        };
        (0..self.entries.len()).filter(|&index| self.entries[index].wanted).filter(due).collect()
    }

    fn content(&self, index: usize) -> Option<ContentHash> {
        match self.entries[index].state {
            State::Ended(StageStatus::Done(content)) => Some(content),
            State::Waiting | State::Asking(_) | State::Finishing(_) | State::Broken(_) | State::Ended(_) => None,
        }
    }

    /// Completes the stage from its memo; returns whether it could.
    pub(super) fn recall(&mut self, workflow: &Workflow, index: usize, store: &Store) -> bool {
        if !matches!(self.entries[index].state, State::Waiting) {
            return false;
        }
        let inputs = |key: fn(&Entry) -> Option<Key>| -> Option<Vec<(Key, ContentHash)>> {
            let inputs = workflow.stages[index].inputs.iter();
            inputs.map(|&(_, input)| Some((key(&self.entries[input])?, self.content(input)?))).collect()
        };
        let (Some(whole), Some(run)) = (inputs(|entry| entry.key), inputs(|entry| entry.run)) else { return false };
        let key = memo::key(workflow, index, &self.base.whole, &whole);
        let entry = &mut self.entries[index];
        entry.key = Some(key);
        entry.run = Some(memo::run_key(workflow, index, &self.base.run, &run));
        if !self.memos {
            return false;
        }
        let Some(known) = memo::recall(workflow, store, &key) else { return false };
        self.entries[index].state = State::Ended(StageStatus::Done(known.content));
        self.entries[index].remembered = Some(known);
        true
    }

    /// Asks a stage for its next step. Returns the nodes that are new on the board, and a note on its progress when the stage
    /// asked for outcomes.
    ///
    /// # Errors
    /// A result that the stage needs cannot be read.
    pub(super) fn step(
        &mut self,
        workflow: &Workflow,
        index: usize,
        store: &Store,
        board: &mut Board,
    ) -> Result<(Vec<NodeId>, Option<String>), Box<Lost>> {
        let key = self.entries[index].run.filter(|_| self.memos && matches!(self.entries[index].state, State::Waiting));
        let run_memo = key.and_then(|key| RunMemo::read(workflow, store, &key));
        let memory = &self.entries[index].memory;
        let shelf = Shelf { workflow, store, board, run_memo: run_memo.as_ref(), memory, lookups: RefCell::default() };
        let step = workflow.stages[index].stage.next(&self.known(workflow, index, &shelf));
        let Lookups { files, rows, lost } = shelf.lookups.into_inner();
        if let Some(lost) = lost {
            return Err(Box::new(lost));
        }
        let (mut new, mut stands) = (Vec::new(), None);
        let mut put = |task| board.put(Arc::new(task), index, &mut new);
        let state = match step {
            Ok(Step::Finish(task)) => State::Finishing(put(task)),
            Ok(Step::Ask(tasks, note)) => {
                stands = Some(note);
                State::Asking(tasks.into_iter().map(put).collect())
            }
            Err(error) => State::Broken(in_words(error)),
        };
        board.forget_addresses();
        let entry = &mut self.entries[index];
        match &state {
            State::Finishing(node) => entry.asked.push(*node),
            State::Asking(nodes) => entry.asked.extend(nodes),
            State::Waiting | State::Broken(_) | State::Ended(_) => {}
        }
        entry.files.extend(files);
        if rows.is_some() {
            // A cached run reads no files now, but its result depends on them.
            entry.files.extend(run_memo.into_iter().flat_map(|run_memo| run_memo.files));
            entry.rows = rows;
        }
        entry.files.sort();
        entry.files.dedup();
        entry.state = state;
        Ok((new, stands))
    }

    /// Ends a stage that cannot go on.
    pub(super) fn fail(&mut self, index: usize, error: StageError) {
        self.entries[index].state = State::Broken(in_words(error));
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
                vary: Box::new(move |point, number| {
                    vary::replicate(&self.known(workflow, input, library), point, number)
                }),
                replicate: Box::new(move |number| maker.stage.replicate(&self.known(workflow, input, library), number)),
                sample: Box::new(move |point, number| {
                    vary::sample(&*maker.stage, &self.known(workflow, input, library), point, number)
                }),
            }
        };
        let inputs = workflow.stages[index].inputs.iter().map(input).collect();
        Known { name: &workflow.stages[index].name, context: &workflow.context, inputs, library }
    }

    /// Ends the stages that can end now, and stores their memos in `store`, if there is one.
    pub(super) fn close(
        &mut self,
        workflow: &Workflow,
        board: &Board,
        store: Option<&Store>,
        streamed: &mut Streamed,
    ) -> Vec<StageReport> {
        let mut closed = Vec::new();
        for index in 0..self.entries.len() {
            if !self.entries[index].wanted {
                continue;
            }
            let Some(status) = self.end(workflow, index, board) else { continue };
            if let (StageStatus::Done(content), Some(store)) = (&status, store) {
                self.store_memos(index, *content, board, store, streamed);
            }
            self.entries[index].state = State::Ended(status);
            closed.push(self.report(workflow, index, board));
        }
        closed
    }

    fn store_memos(
        &mut self,
        index: usize,
        content: ContentHash,
        board: &Board,
        store: &Store,
        streamed: &mut Streamed,
    ) {
        let entry = &mut self.entries[index];
        if let Some(key) = &entry.key {
            if let (State::Finishing(node), Some(run), Some(rows)) = (&entry.state, &entry.run, &entry.rows) {
                RunMemo::store(store, streamed, run, board, *node, rows, &entry.files);
            }
            let nodes = board.closure(&entry.asked);
            memo::store(store, key, content, board, &nodes, std::mem::take(&mut entry.files));
        }
    }

    fn end(&self, workflow: &Workflow, index: usize, board: &Board) -> Option<StageStatus> {
        match &self.entries[index].state {
            State::Waiting => {
                workflow.stages[index].inputs.iter().find_map(|&(_, input)| match &self.entries[input].state {
                    State::Ended(StageStatus::Failed(_)) => {
                        Some(StageStatus::Skipped(workflow.stages[input].name.clone()))
                    }
                    State::Ended(StageStatus::Skipped(cause)) => Some(StageStatus::Skipped(cause.clone())),
                    State::Waiting | State::Asking(_) | State::Finishing(_) | State::Broken(_) | State::Ended(_) => {
                        None
                    }
                })
            }
            State::Finishing(node) => match board.state(*node) {
                TaskState::Done { content, .. } => Some(StageStatus::Done(content)),
                TaskState::Failed(_) | TaskState::Skipped => Some(StageStatus::Failed(cause(board, *node))),
                TaskState::Open | TaskState::Running => None,
            },
            State::Broken(why) => Some(StageStatus::Failed(why.clone())),
            State::Asking(_) | State::Ended(_) => None,
        }
    }

    /// The tasks that a stage was the first to ask for.
    pub(super) fn count(&self, index: usize, board: &Board) -> TaskCount {
        self.entries[index].remembered.as_ref().map_or_else(|| board.count(index), memo::Recalled::count)
    }

    /// The report of a stage, with the tasks that it was the first to ask for.
    pub(super) fn report(&self, workflow: &Workflow, index: usize, board: &Board) -> StageReport {
        let entry = &self.entries[index];
        StageReport {
            name: workflow.stages[index].name.clone(),
            kind: workflow.stages[index].kind,
            status: match &entry.state {
                State::Ended(status) => status.clone(),
                State::Waiting | State::Asking(_) | State::Finishing(_) | State::Broken(_) => StageStatus::Open,
            },
            tasks: self.count(index, board),
            memo: entry.key,
            seconds: board.seconds(index),
        }
    }

    /// The reports of all wanted stages. A task that several stages share counts for the first of them in the workflow, so
    /// that counts do not depend on timing.
    pub(super) fn reports(&self, workflow: &Workflow, board: &Board) -> Vec<StageReport> {
        let mut keys: HashSet<Key, BuildHasherDefault<FirstBytes>> = HashSet::default();
        let mut nodes = vec![false; board.len()];
        let wanted = (0..self.entries.len()).filter(|&index| self.entries[index].wanted);
        wanted
            .map(|index| {
                let entry = &self.entries[index];
                let mut tasks = TaskCount::default();
                for object in entry.remembered.iter().flat_map(|known| &known.objects) {
                    if keys.insert(object.key) {
                        let node = board.of_key(&object.key).last().inspect(|&node| nodes[node] = true);
                        tasks = tasks + node.map_or(TaskCount::CACHED, |node| board.count_of(node));
                    }
                }
                for node in board.closure(&entry.asked) {
                    let new = !std::mem::replace(&mut nodes[node], true);
                    for key in board.cached_keys(node).filter(|_| new) {
                        if keys.insert(key) {
                            tasks = tasks + TaskCount::CACHED;
                        }
                    }
                    if new && board.key_of(node).is_none_or(|key| keys.insert(key)) {
                        tasks = tasks + board.count_of(node);
                    }
                }
                StageReport { tasks, ..self.report(workflow, index, board) }
            })
            .collect()
    }

    /// The objects of the stages that were completed from memos.
    pub(super) fn remembered(&self) -> impl DoubleEndedIterator<Item = ObjectId> {
        self.entries
            .iter()
            .filter_map(|entry| entry.remembered.as_ref())
            .flat_map(|known| known.objects.iter().copied())
    }
}

fn cause(board: &Board, node: NodeId) -> String {
    let Some((cause, why)) = board.cause(node) else { panic!("BUG: a failure without a cause") };
    board.row(cause).map_or_else(|| why.to_owned(), |row| format!("row {}: {why}", row + 1))
}

/// An error with its hint.
pub(super) fn in_words(error: StageError) -> String {
    match error.hint {
        Some(hint) => format!("{} ({hint})", error.message),
        None => error.message,
    }
}
