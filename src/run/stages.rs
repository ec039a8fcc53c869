//! Where each stage of the workflow stands.

use super::board::{Board, ByKey, NodeId, TaskCount, TaskState};
use super::files::Files;
use super::ledger::Ledger;
use super::library::{Notes, Shelf};
use super::memo::{self, Base};
use super::task::Lost;
use crate::artifact::{ContentHash, FirstBytes, Key};
use crate::plan::Workflow;
use crate::stage::rows::Rows;
use crate::stage::{Input, Known, Library, Memory, StageError, Step, vary};
use crate::store::{ObjectId, Store};
use std::cell::RefCell;
use std::collections::HashSet;
use std::hash::BuildHasherDefault;
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
    /// Key of its memo, when its inputs are known.
    pub memo: Option<Key>,
    /// Time of the tasks that ran, seconds of one worker.
    pub seconds: f64,
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
    /// Some inputs are not there, or its step is still to be asked for.
    Waiting,
    /// It must see these first.
    Asking(Vec<NodeId>),
    /// The node whose result is the stage's.
    Finishing(NodeId),
    /// It cannot go on; why.
    Broken(String),
    Ended(StageStatus),
}

struct Place {
    state: State,
    wanted: bool,
    /// Key of its memo, from the moment its inputs are known.
    key: Option<Key>,
    /// Key of the ledger of its runs, known as soon.
    run: Option<Key>,
    /// The rows whose runs it gathers.
    rows: Option<Arc<Rows>>,
    /// Every node it asked for, and the one it finishes with.
    asked: Vec<NodeId>,
    files: Files,
    /// What it worked out at its last step.
    memory: Memory,
    /// What its memo said, when that was enough.
    remembered: Option<memo::Known>,
}

pub(super) struct Stages {
    places: Vec<Place>,
    base: Base,
    /// Whether memos are believed.
    memos: bool,
}

impl Stages {
    /// No stage begun; `memos` says whether memos may be believed.
    pub(super) fn new(workflow: &Workflow, targets: &[String], memos: bool) -> Self {
        let mut wanted: Vec<bool> =
            workflow.stages.iter().map(|stage| targets.is_empty() || targets.contains(&stage.name)).collect();
        for index in (0..workflow.stages.len()).rev().filter(|_| !targets.is_empty()) {
            if wanted[index] {
                workflow.stages[index].inputs.iter().for_each(|&(_, input)| wanted[input] = true);
            }
        }
        let place = |wanted| Place {
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
        Self { places: wanted.into_iter().map(place).collect(), base: memo::base(workflow), memos }
    }

    /// Wanted stages that can be asked for their next step.
    pub(super) fn due(&self, workflow: &Workflow, board: &Board) -> Vec<usize> {
        let settled = |node: &NodeId| !matches!(board.state(*node), TaskState::Open | TaskState::Running);
        let due = |index: &usize| match &self.places[*index].state {
            State::Waiting => workflow.stages[*index].inputs.iter().all(|&(_, input)| self.content(input).is_some()),
            State::Asking(nodes) => nodes.iter().all(settled),
            State::Finishing(_) | State::Broken(_) | State::Ended(_) => false,
        };
        (0..self.places.len()).filter(|&index| self.places[index].wanted).filter(due).collect()
    }

    fn content(&self, index: usize) -> Option<ContentHash> {
        match self.places[index].state {
            State::Ended(StageStatus::Done(content)) => Some(content),
            State::Waiting | State::Asking(_) | State::Finishing(_) | State::Broken(_) | State::Ended(_) => None,
        }
    }

    /// Ends a stage at once when its memo says what it comes to; whether it did.
    pub(super) fn recall(&mut self, workflow: &Workflow, index: usize, store: &Store) -> bool {
        if !matches!(self.places[index].state, State::Waiting) {
            return false;
        }
        let inputs = |key: fn(&Place) -> Option<Key>| -> Option<Vec<(Key, ContentHash)>> {
            let inputs = workflow.stages[index].inputs.iter();
            inputs.map(|&(_, input)| Some((key(&self.places[input])?, self.content(input)?))).collect()
        };
        let (Some(whole), Some(run)) = (inputs(|place| place.key), inputs(|place| place.run)) else { return false };
        let key = memo::key(workflow, index, &self.base.whole, &whole);
        let place = &mut self.places[index];
        place.key = Some(key);
        place.run = Some(memo::run_key(workflow, index, &self.base.run, &run));
        if !self.memos {
            return false;
        }
        let Some(known) = memo::recall(workflow, store, &key) else { return false };
        self.places[index].state = State::Ended(StageStatus::Done(known.content));
        self.places[index].remembered = Some(known);
        true
    }

    /// Asks a stage for its next step; answers with the nodes that are new on the board, and with where the stage stands
    /// when it asked for outcomes, or with a result that it needs and that cannot be read.
    pub(super) fn step(
        &mut self,
        workflow: &Workflow,
        index: usize,
        store: &Store,
        board: &mut Board,
    ) -> Result<(Vec<NodeId>, Option<String>), Box<Lost>> {
        let key = self.places[index].run.filter(|_| self.memos && matches!(self.places[index].state, State::Waiting));
        let ledger = key.and_then(|key| Ledger::read(workflow, store, &key));
        let memory = &self.places[index].memory;
        let shelf = Shelf { workflow, store, board, ledger: ledger.as_ref(), memory, notes: RefCell::default() };
        let step = workflow.stages[index].stage.next(&self.known(workflow, index, &shelf));
        let Notes { files, rows, lost } = shelf.notes.into_inner();
        if let Some(lost) = lost {
            return Err(Box::new(lost));
        }
        let (mut new, mut stands) = (Vec::new(), None);
        let mut put = |task| board.put(&Arc::new(task), index, &mut new);
        let state = match step {
            Ok(Step::Finish(task)) => State::Finishing(put(task)),
            Ok(Step::Ask(tasks, note)) => {
                stands = Some(note);
                State::Asking(tasks.into_iter().map(put).collect())
            }
            Err(error) => State::Broken(in_words(error)),
        };
        let place = &mut self.places[index];
        match &state {
            State::Finishing(node) => place.asked.push(*node),
            State::Asking(nodes) => place.asked.extend(nodes),
            State::Waiting | State::Broken(_) | State::Ended(_) => {}
        }
        place.files.extend(files);
        if rows.is_some() {
            // A kept run does not look at its files, and yet rests on them.
            place.files.extend(ledger.into_iter().flat_map(|ledger| ledger.files));
            place.rows = rows;
        }
        place.files.sort();
        place.files.dedup();
        place.state = state;
        Ok((new, stands))
    }

    /// Ends a stage that cannot go on.
    pub(super) fn fail(&mut self, index: usize, error: StageError) {
        self.places[index].state = State::Broken(in_words(error));
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

    /// Ends the stages that can end now, and keeps their memos when something was or may be run.
    pub(super) fn close(&mut self, workflow: &Workflow, board: &Board, store: Option<&Store>) -> Vec<StageReport> {
        let mut closed = Vec::new();
        for index in 0..self.places.len() {
            if !self.places[index].wanted {
                continue;
            }
            let Some(status) = self.end(workflow, index, board) else { continue };
            if let (StageStatus::Done(content), Some(store)) = (&status, store) {
                self.keep(index, *content, board, store);
            }
            self.places[index].state = State::Ended(status);
            closed.push(self.report(workflow, index, board));
        }
        closed
    }

    fn keep(&mut self, index: usize, content: ContentHash, board: &Board, store: &Store) {
        let place = &mut self.places[index];
        if let Some(key) = &place.key {
            if let (State::Finishing(node), Some(run), Some(rows)) = (&place.state, &place.run, &place.rows) {
                Ledger::keep(store, run, board, *node, rows, &place.files);
            }
            let nodes = board.closure(&place.asked);
            memo::keep(store, key, content, board, &nodes, std::mem::take(&mut place.files));
        }
    }

    fn end(&self, workflow: &Workflow, index: usize, board: &Board) -> Option<StageStatus> {
        match &self.places[index].state {
            State::Waiting => {
                workflow.stages[index].inputs.iter().find_map(|&(_, input)| match &self.places[input].state {
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
                TaskState::Done { content, .. } => Some(StageStatus::Done(*content)),
                TaskState::Failed(_) | TaskState::Skipped => Some(StageStatus::Failed(cause(board, *node))),
                TaskState::Open | TaskState::Running => None,
            },
            State::Broken(why) => Some(StageStatus::Failed(why.clone())),
            State::Asking(_) | State::Ended(_) => None,
        }
    }

    /// Where a stage stands, by the tasks that it asked for first.
    pub(super) fn report(&self, workflow: &Workflow, index: usize, board: &Board) -> StageReport {
        let place = &self.places[index];
        StageReport {
            name: workflow.stages[index].name.clone(),
            kind: workflow.stages[index].kind,
            status: match &place.state {
                State::Ended(status) => status.clone(),
                State::Waiting | State::Asking(_) | State::Finishing(_) | State::Broken(_) => StageStatus::Open,
            },
            tasks: place.remembered.as_ref().map_or_else(|| board.count(index), memo::Known::count),
            memo: place.key,
            seconds: board.seconds(index),
        }
    }

    /// Every wanted stage. A task that several stages rest on counts for the first of them in the workflow, whichever
    /// asked first, so that counts do not depend on timing.
    pub(super) fn reports(&self, workflow: &Workflow, board: &Board) -> Vec<StageReport> {
        let recalled = self.places.iter().any(|place| place.remembered.is_some());
        let by_key = if recalled { board.by_key() } else { ByKey::default() };
        let mut keys: HashSet<Key, BuildHasherDefault<FirstBytes>> = HashSet::default();
        let mut nodes = vec![false; board.len()];
        let wanted = (0..self.places.len()).filter(|&index| self.places[index].wanted);
        wanted
            .map(|index| {
                let place = &self.places[index];
                let mut tasks = TaskCount::default();
                for object in place.remembered.iter().flat_map(|known| &known.objects) {
                    if keys.insert(object.key) {
                        let node = by_key.get(&object.key).inspect(|&&node| nodes[node] = true);
                        tasks = tasks + node.map_or(TaskCount::CACHED, |&node| board.count_of(node));
                    }
                }
                for node in board.closure(&place.asked) {
                    let new = !std::mem::replace(&mut nodes[node], true);
                    for key in board.kept_keys(node).filter(|_| new) {
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

    /// Objects that memos spoke for.
    pub(super) fn remembered(&self) -> impl DoubleEndedIterator<Item = ObjectId> {
        self.places.iter().filter_map(|place| place.remembered.as_ref()).flat_map(|known| known.objects.iter().copied())
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
