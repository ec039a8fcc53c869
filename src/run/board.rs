//! Every task known so far, as a graph that grows while the campaign runs.
//!
//! A node stands for one task; equal tasks are one node, whichever stage asked first. Equality is that of the
//! *recipe*: the key of a task whose inputs are known; else a hash of its text with the recipe of each input task in place
//! of its result, so it is known before anything ran. A run that an earlier campaign made has no node: it stands with the
//! task that gathers it ([`Task::cached`]), and counts there.

use crate::artifact::{ContentHash, FirstBytes, Key};
use crate::plan::key::{task_text, text_without_inputs};
use crate::stage::{Source, Task};
use crate::store::ObjectId;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::ops::Add;
use std::sync::Arc;

pub(super) type NodeId = usize;
pub(super) type ByKey = HashMap<Key, NodeId, BuildHasherDefault<FirstBytes>>;

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
    pub(super) const CACHED: Self = Self { total: 1, ran: 0, cached: 1, failed: 0, skipped: 0 };

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

struct Node {
    task: Arc<Task>,
    stage: usize,
    /// The node of each input that is a task, in the order of the task's inputs.
    inputs: Vec<Option<NodeId>>,
    dependents: Vec<NodeId>,
    /// Inputs that are not done, each as often as it is named.
    missing: usize,
    recipe: Key,
    /// Its key, once its inputs are known.
    key: Option<Key>,
    state: TaskState,
}

/// Bytes that are hashed at once.
const BLOCK: usize = 1 << 16;

/// The runs of an earlier campaign among the inputs of a task.
fn cached_runs(task: &Task) -> &[(usize, usize, Key, ContentHash)] {
    task.cached.as_ref().map_or(&[], |cached| &cached.runs)
}

/// The graph of tasks.
#[derive(Default)]
pub(super) struct Board {
    nodes: Vec<Node>,
    by_recipe: ByKey,
    /// Tasks seen already, by address; the board keeps them alive, so an address stays theirs.
    by_address: HashMap<*const Task, NodeId>,
    alive: Vec<Arc<Task>>,
    /// The text that was written last: what is decided about is often started next, and texts may be long.
    written: Option<(NodeId, String)>,
    counts: Vec<TaskCount>,
    /// Seconds that the tasks of each stage took in this run.
    seconds: Vec<f64>,
}

impl Board {
    /// Puts a task and all that it needs on the board; new nodes are pushed to `new`, inputs first.
    pub(super) fn put(&mut self, task: &Arc<Task>, stage: usize, new: &mut Vec<NodeId>) -> NodeId {
        if let Some(&node) = self.by_address.get(&Arc::as_ptr(task)) {
            return node;
        }
        self.expect(task.inputs.iter().filter(|(_, source)| matches!(source, Source::Task(_))).count());
        let inputs: Vec<Option<NodeId>> = task
            .inputs
            .iter()
            .map(|(_, source)| match source {
                Source::Content(_) => None,
                Source::Task(task) => Some(self.put(task, stage, new)),
            })
            .collect();
        let (recipe, text) = self.recipe(task, &inputs);
        self.alive.push(Arc::clone(task));
        let node = match self.by_recipe.get(&recipe) {
            Some(&node) => node,
            None => {
                let missing = inputs.iter().flatten().filter(|&&input| !self.is_done(input)).count();
                let key = text.is_some().then_some(recipe);
                let (dependents, state) = (Vec::new(), TaskState::Open);
                let task = Arc::clone(task);
                let node = self.add(Node { task, stage, inputs, dependents, missing, recipe, key, state });
                self.by_recipe.insert(recipe, node);
                self.written = text.map(|text| (node, text));
                new.push(node);
                node
            }
        };
        self.by_address.insert(Arc::as_ptr(task), node);
        node
    }

    /// Makes room for a fan-out, which would otherwise leave up to half of the room unused.
    fn expect(&mut self, tasks: usize) {
        if tasks > self.nodes.len() {
            self.nodes.reserve_exact(tasks + 1);
            self.alive.reserve_exact(tasks + 1);
        }
    }

    fn add(&mut self, node: Node) -> NodeId {
        let id = self.nodes.len();
        for &input in node.inputs.iter().flatten() {
            if !self.is_done(input) {
                self.nodes[input].dependents.push(id);
            }
        }
        if self.counts.len() <= node.stage {
            self.counts.resize(node.stage + 1, TaskCount::default());
            self.seconds.resize(node.stage + 1, 0.0);
        }
        let cached = cached_runs(&node.task).len();
        self.counts[node.stage].total += 1 + cached;
        self.counts[node.stage].cached += cached;
        let lost = |input: &NodeId| matches!(self.state(*input), TaskState::Failed(_) | TaskState::Skipped);
        let lost = node.inputs.iter().flatten().any(lost);
        self.nodes.push(node);
        if lost {
            self.nodes[id].state = TaskState::Skipped;
            self.count_mut(id).skipped += 1;
        }
        id
    }

    /// The recipe of a task, and its text when no input is a task: then the recipe is the key.
    fn recipe(&self, task: &Task, inputs: &[Option<NodeId>]) -> (Key, Option<String>) {
        let part = |((_, source), node): (&(_, Source), &Option<NodeId>)| match (source, node) {
            (Source::Content(content), _) => *content,
            (Source::Task(_), Some(node)) => ContentHash(self.nodes[*node].recipe.0),
            (Source::Task(_), None) => panic!("BUG: an input task without a node"),
        };
        let parts = task.inputs.iter().zip(inputs).map(part);
        if task.inputs.iter().all(|(_, source)| matches!(source, Source::Content(_))) {
            let text = task_text(task, &parts.collect::<Vec<_>>());
            return (Key::of(&text), Some(text));
        }
        let mut hash = blake3::Hasher::new();
        let mut bytes = text_without_inputs(task, 0).into_bytes();
        for ((name, _), part) in task.inputs.iter().zip(parts) {
            bytes.extend_from_slice(&(name.len() as u64).to_le_bytes());
            bytes.extend_from_slice(name.as_bytes());
            bytes.extend_from_slice(&part.0);
            if bytes.len() >= BLOCK {
                hash.update(&bytes);
                bytes.clear();
            }
        }
        (Key(*hash.update(&bytes).finalize().as_bytes()), None)
    }

    /// The node of a task that was put on the board before.
    pub(super) fn find(&self, task: &Task) -> Option<NodeId> {
        let inputs: Option<Vec<Option<NodeId>>> = task
            .inputs
            .iter()
            .map(|(_, source)| match source {
                Source::Content(_) => Some(None),
                Source::Task(task) => self.find(task).map(Some),
            })
            .collect();
        self.by_recipe.get(&self.recipe(task, &inputs?).0).copied()
    }

    /// Contents of a node's inputs, when all are known.
    pub(super) fn inputs(&self, node: NodeId) -> Option<Vec<ContentHash>> {
        let node = &self.nodes[node];
        if node.missing > 0 {
            return None;
        }
        node.task
            .inputs
            .iter()
            .zip(&node.inputs)
            .map(|((_, source), input)| match (source, input) {
                (Source::Content(content), _) => Some(*content),
                (Source::Task(_), Some(input)) => match self.nodes[*input].state {
                    TaskState::Done { content, .. } => Some(content),
                    _ => None,
                },
                (Source::Task(_), None) => None,
            })
            .collect()
    }

    /// The text of an open node whose inputs are known.
    pub(super) fn text(&self, node: NodeId) -> Option<String> {
        if self.nodes[node].state != TaskState::Open {
            return None;
        }
        Some(task_text(self.task(node), &self.inputs(node)?))
    }

    /// The key of an open node whose inputs are known.
    pub(super) fn key(&mut self, node: NodeId) -> Option<Key> {
        if self.nodes[node].state != TaskState::Open {
            return None;
        }
        if self.nodes[node].key.is_none() {
            self.written = self.text(node).map(|text| (node, text));
            self.nodes[node].key = self.written.as_ref().map(|(_, text)| Key::of(text));
        }
        self.nodes[node].key
    }

    /// As [`Board::text`]; the one that was written last is handed out as it is.
    pub(super) fn take_text(&mut self, node: NodeId) -> Option<String> {
        match self.written.take_if(|(of, _)| *of == node) {
            Some((_, text)) => Some(text),
            None => self.text(node),
        }
    }

    /// The key of the task that is one of the inputs of a node, unless that run is cached.
    pub(super) fn input_key(&self, node: NodeId, place: usize) -> Option<Key> {
        self.key_of(self.nodes[node].inputs[place]?)
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Nodes by their keys, where those are known.
    pub(super) fn by_key(&self) -> ByKey {
        (0..self.nodes.len()).filter_map(|node| Some((self.nodes[node].key?, node))).collect()
    }

    /// The key of a node whose inputs were known.
    pub(super) fn key_of(&self, node: NodeId) -> Option<Key> {
        self.nodes[node].key
    }

    /// How one node counts.
    pub(super) fn count_of(&self, node: NodeId) -> TaskCount {
        let one = TaskCount { total: 1, ..TaskCount::default() };
        match self.nodes[node].state {
            TaskState::Open | TaskState::Running => one,
            TaskState::Done { cached: true, .. } => TaskCount { cached: 1, ..one },
            TaskState::Done { cached: false, .. } => TaskCount { ran: 1, ..one },
            TaskState::Failed(_) => TaskCount { failed: 1, ..one },
            TaskState::Skipped => TaskCount { skipped: 1, ..one },
        }
    }

    /// The object that holds a node's result.
    pub(super) fn object(&self, node: NodeId) -> Option<ObjectId> {
        match self.nodes[node].state {
            TaskState::Done { content, .. } => Some(ObjectId { content, key: self.nodes[node].key? }),
            TaskState::Open | TaskState::Running | TaskState::Failed(_) | TaskState::Skipped => None,
        }
    }

    /// These nodes and all that they need, each once, in the order they were put on the board.
    pub(super) fn closure(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut seen = vec![false; self.nodes.len()];
        let mut open = roots.to_vec();
        while let Some(node) = open.pop() {
            if !seen[node] {
                seen[node] = true;
                open.extend(self.nodes[node].inputs.iter().flatten());
            }
        }
        (0..self.nodes.len()).filter(|&node| seen[node]).collect()
    }

    /// Results and rows of these nodes that are done, each behind the runs that are cached for it.
    pub(super) fn results(&self, nodes: &[NodeId]) -> impl Iterator<Item = (ObjectId, Option<usize>)> {
        nodes.iter().flat_map(|&node| {
            let cached = cached_runs(&self.nodes[node].task).iter();
            let cached = cached.map(|&(_, row, key, content)| (ObjectId { content, key }, Some(row)));
            cached.chain(self.object(node).map(|object| (object, self.row(node))))
        })
    }

    /// Keys of the runs that are cached for a node.
    pub(super) fn cached_keys(&self, node: NodeId) -> impl Iterator<Item = Key> {
        cached_runs(&self.nodes[node].task).iter().map(|&(_, _, key, _)| key)
    }

    /// Every task but the runs that are cached.
    pub(super) fn reports(&self) -> impl DoubleEndedIterator<Item = TaskReport> {
        (0..self.nodes.len()).map(|node| TaskReport {
            stage: self.nodes[node].stage,
            row: self.row(node),
            state: self.nodes[node].state.clone(),
            text: self.text(node),
            object: self.object(node),
        })
    }

    /// The object of every task that is done.
    pub(super) fn objects(&self) -> impl DoubleEndedIterator<Item = ObjectId> {
        (0..self.nodes.len()).flat_map(|node| {
            let cached = cached_runs(&self.nodes[node].task).iter();
            cached.map(|&(_, _, key, content)| ObjectId { content, key }).chain(self.object(node))
        })
    }

    /// Seconds that the tasks of a stage took in this run.
    pub(super) fn seconds(&self, stage: usize) -> f64 {
        self.seconds.get(stage).copied().unwrap_or(0.0)
    }

    /// Notes how long a task took.
    pub(super) fn took(&mut self, node: NodeId, seconds: f64) {
        let stage = self.nodes[node].stage;
        self.seconds[stage] += seconds;
    }

    /// Notes a result; answers with the nodes that can be decided now.
    pub(super) fn done(&mut self, node: NodeId, content: ContentHash, cached: bool) -> Vec<NodeId> {
        self.nodes[node].state = TaskState::Done { content, cached };
        let count = self.count_mut(node);
        if cached {
            count.cached += 1
        } else {
            count.ran += 1
        }
        let dependents = std::mem::take(&mut self.nodes[node].dependents);
        let mut freed = Vec::new();
        for dependent in dependents {
            self.nodes[dependent].missing -= 1;
            if self.nodes[dependent].missing == 0 {
                freed.push(dependent);
            }
        }
        freed
    }

    fn is_done(&self, node: NodeId) -> bool {
        matches!(self.nodes[node].state, TaskState::Done { .. })
    }

    pub(super) fn started(&mut self, node: NodeId) {
        self.nodes[node].state = TaskState::Running;
    }

    pub(super) fn is_running(&self, node: NodeId) -> bool {
        self.nodes[node].state == TaskState::Running
    }

    /// An interrupted task is as if it had not been started.
    pub(super) fn stopped(&mut self, node: NodeId) {
        self.nodes[node].state = TaskState::Open;
    }

    /// Notes a failure; all that needs this task is skipped.
    pub(super) fn failed(&mut self, node: NodeId, why: &str) {
        self.nodes[node].state = TaskState::Failed(why.to_owned());
        self.count_mut(node).failed += 1;
        let mut open = self.nodes[node].dependents.clone();
        while let Some(next) = open.pop() {
            if self.nodes[next].state == TaskState::Open {
                self.nodes[next].state = TaskState::Skipped;
                self.count_mut(next).skipped += 1;
                open.extend(self.nodes[next].dependents.iter().copied());
            }
        }
    }

    pub(super) fn state(&self, node: NodeId) -> &TaskState {
        &self.nodes[node].state
    }

    pub(super) fn stage(&self, node: NodeId) -> usize {
        self.nodes[node].stage
    }

    /// The design row of a node.
    pub(super) fn row(&self, node: NodeId) -> Option<usize> {
        self.nodes[node].task.row
    }

    /// The task of a node.
    pub(super) fn task(&self, node: NodeId) -> &Arc<Task> {
        &self.nodes[node].task
    }

    /// The first failure among a node and all that it needs.
    pub(super) fn cause(&self, node: NodeId) -> Option<(NodeId, &str)> {
        match &self.nodes[node].state {
            TaskState::Failed(why) => Some((node, why)),
            TaskState::Skipped => self.nodes[node].inputs.iter().flatten().find_map(|&input| self.cause(input)),
            TaskState::Open | TaskState::Running | TaskState::Done { .. } => None,
        }
    }

    pub(super) fn count(&self, stage: usize) -> TaskCount {
        self.counts.get(stage).copied().unwrap_or_default()
    }

    fn count_mut(&mut self, node: NodeId) -> &mut TaskCount {
        let stage = self.nodes[node].stage;
        &mut self.counts[stage]
    }
}
