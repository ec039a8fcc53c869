//! Every task known so far, as a graph that grows while the campaign runs.
//!
//! A node stands for one task; equal tasks are one node, whichever stage asked first. Equality is that of the
//! *recipe*: the key of a task whose inputs are known; else a hash of its text with the recipe of each input task in place
//! of its result, so it is known before anything ran. A run that an earlier campaign made has no node: it stands with the
//! task that gathers it ([`Task::cached`]), and counts there.

use crate::artifact::{ContentHash, Key};
use crate::plan::key::{task_text, text_without_inputs};
use crate::stage::rows::GATHER;
use crate::stage::{Source, Task};
use crate::store::ObjectId;
use by_hash::ByHash;
use node::{Edges, Keyed, NONE, Node, Stand, some};
use std::collections::HashMap;
use std::sync::Arc;

mod by_hash;
mod node;
mod state;
#[cfg(test)]
mod tests;

pub use state::{TaskCount, TaskReport, TaskState};

pub(super) type NodeId = usize;

/// Bytes that are hashed at once.
const BLOCK: usize = 1 << 16;

/// The runs of an earlier campaign among the inputs of a task.
fn cached_runs(node: &Node) -> &[(usize, usize, Key, ContentHash)] {
    node.task.as_ref().and_then(|task| task.cached.as_ref()).map_or(&[], |cached| &cached.runs)
}

/// The graph of tasks.
#[derive(Default)]
pub(super) struct Board {
    nodes: Vec<Node>,
    edges: Edges,
    by_recipe: ByHash,
    /// Keys that are not the recipes of their nodes, with these.
    keys: Vec<(Key, NodeId)>,
    by_key: ByHash,
    /// Why the tasks failed that did.
    failures: HashMap<NodeId, String>,
    /// Tasks that others refer to as well and that were seen in this step of a stage, by address; they are kept alive, so an
    /// address stays theirs.
    by_address: HashMap<*const Task, (NodeId, Arc<Task>)>,
    /// The text that was written last: what is decided about is often started next, and texts may be long.
    written: Option<(NodeId, String)>,
    counts: Vec<TaskCount>,
    /// Seconds that the tasks of each stage took in this run.
    seconds: Vec<f64>,
}

impl Board {
    /// Puts a task and all that it needs on the board; new nodes are pushed to `new`, inputs first. Input tasks that nobody
    /// else refers to are taken out of it, so that each can be let go when it is done.
    pub(super) fn put(&mut self, mut task: Arc<Task>, stage: usize, new: &mut Vec<NodeId>) -> NodeId {
        let shared = Arc::strong_count(&task) > 1;
        if let Some((node, _)) = shared.then(|| self.by_address.get(&Arc::as_ptr(&task))).flatten() {
            return *node;
        }
        let needs = task.inputs.iter().filter(|(_, source)| matches!(source, Source::Task(_))).count();
        self.expect(needs);
        let mut inputs = Vec::new();
        for index in (0..task.inputs.len()).filter(|_| needs > 0) {
            let input = match Arc::get_mut(&mut task) {
                Some(task) => task.inputs[index].1.take_task(),
                None => task.inputs[index].1.task().cloned(),
            };
            inputs.push(input.map_or(NONE, |input| self.put(input, stage, new) as u32));
        }
        let (recipe, text) = self.recipe(&task, &inputs);
        let known = self.of_recipe(&recipe);
        let held = shared.then(|| Arc::clone(&task));
        let node = known.unwrap_or_else(|| {
            let node = self.add(task, stage, inputs.into(), recipe, text.is_some());
            self.written = text.map(|text| (node, text));
            new.push(node);
            node
        });
        if let Some(task) = held {
            self.by_address.insert(Arc::as_ptr(&task), (node, task));
        }
        node
    }

    /// Forgets the addresses of tasks, after a step of a stage.
    pub(super) fn forget_addresses(&mut self) {
        self.by_address = HashMap::new();
    }

    /// Makes room for a fan-out, which would otherwise leave up to half of the room unused.
    fn expect(&mut self, tasks: usize) {
        if tasks > self.nodes.len() {
            self.nodes.reserve_exact(tasks + 1);
            self.edges.expect(tasks);
        }
    }

    fn add(&mut self, task: Arc<Task>, stage: usize, inputs: Box<[u32]>, recipe: Key, is_key: bool) -> NodeId {
        let id = self.nodes.len();
        let (mut missing, mut lost) = (0, false);
        for input in inputs.iter().copied().filter_map(some) {
            lost |= matches!(self.nodes[input].stand, Stand::Failed | Stand::Skipped);
            if !self.nodes[input].is_done() {
                missing += 1;
                self.nodes[input].needed_by = self.edges.add(id, self.nodes[input].needed_by);
            }
        }
        let node = Node {
            stage: stage as u32,
            row: task.row.map_or(NONE, |row| row as u32),
            task: Some(task),
            inputs,
            recipe,
            content: ContentHash([0; 32]),
            missing,
            needed_by: NONE,
            key: if is_key { Keyed::Recipe } else { Keyed::Unknown },
            stand: if lost { Stand::Skipped } else { Stand::Open },
            away: false,
        };
        if self.counts.len() <= stage {
            self.counts.resize(stage + 1, TaskCount::default());
            self.seconds.resize(stage + 1, 0.0);
        }
        let (cached, count) = (cached_runs(&node).len(), &mut self.counts[stage]);
        count.total += 1 + cached;
        count.cached += cached;
        count.skipped += usize::from(lost);
        self.nodes.push(node);
        let nodes = &self.nodes;
        self.by_recipe.add(id, |node| nodes[node].recipe.0);
        id
    }

    fn of_recipe(&self, recipe: &Key) -> Option<NodeId> {
        self.by_recipe.candidates(&recipe.0).find(|&node| self.nodes[node].recipe == *recipe)
    }

    /// The recipe of a task, and its text when no input is a task: then the recipe is the key. `inputs` are as in a node.
    fn recipe(&self, task: &Task, inputs: &[u32]) -> (Key, Option<String>) {
        if inputs.iter().all(|&input| input == NONE) {
            let text = task_text(task, &task.inputs.iter().map(|(_, source)| content(source)).collect::<Vec<_>>());
            return (Key::of(&text), Some(text));
        }
        let mut hash = blake3::Hasher::new();
        let mut bytes = text_without_inputs(task, 0).into_bytes();
        for ((name, source), &input) in task.inputs.iter().zip(inputs) {
            let part = some(input).map_or_else(|| content(source).0, |node| self.nodes[node].recipe.0);
            bytes.extend_from_slice(&(name.len() as u64).to_le_bytes());
            bytes.extend_from_slice(name.as_bytes());
            bytes.extend_from_slice(&part);
            if bytes.len() >= BLOCK {
                hash.update(&bytes);
                bytes.clear();
            }
        }
        (Key(*hash.update(&bytes).finalize().as_bytes()), None)
    }

    /// The node of a task that was put on the board before.
    pub(super) fn find(&self, task: &Task) -> Option<NodeId> {
        let node = |source: &Source| source.task().map_or(Some(NONE), |task| self.find(task).map(|node| node as u32));
        let inputs: Option<Vec<u32>> = task.inputs.iter().map(|(_, source)| node(source)).collect();
        self.of_recipe(&self.recipe(task, &inputs?).0)
    }

    /// Contents of a node's inputs, when all are known.
    pub(super) fn inputs(&self, node: NodeId) -> Option<Vec<ContentHash>> {
        let of = &self.nodes[node];
        if of.missing > 0 {
            return None;
        }
        let inputs = self.task(node).inputs.iter().enumerate();
        inputs
            .map(|(index, (_, source))| match of.input(index) {
                Some(input) => self.nodes[input].result(),
                None => Some(content(source)),
            })
            .collect()
    }

    /// The text of an open node whose inputs are known.
    pub(super) fn text(&self, node: NodeId) -> Option<String> {
        if self.nodes[node].stand != Stand::Open {
            return None;
        }
        Some(task_text(self.task(node), &self.inputs(node)?))
    }

    /// The key of an open node whose inputs are known.
    pub(super) fn key(&mut self, node: NodeId) -> Option<Key> {
        if self.nodes[node].stand != Stand::Open {
            return None;
        }
        if self.nodes[node].key == Keyed::Unknown {
            let text = self.text(node)?;
            self.nodes[node].key = Keyed::Own(self.keys.len() as u32);
            self.keys.push((Key::of(&text), node));
            let keys = &self.keys;
            self.by_key.add(keys.len() - 1, |number| keys[number].0.0);
            self.written = Some((node, text));
        }
        self.key_of(node)
    }

    /// As [`Board::text`]; the one that was written last is handed out as it is.
    pub(super) fn take_text(&mut self, node: NodeId) -> Option<String> {
        match self.written.take_if(|(of, _)| *of == node) {
            Some((_, text)) => Some(text),
            None => self.text(node),
        }
    }

    /// The object of the task that is one of the inputs of a node, unless that run is cached.
    pub(super) fn input(&self, node: NodeId, place: usize) -> Option<ObjectId> {
        self.object(self.nodes[node].input(place)?)
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The key of a node whose inputs were known.
    pub(super) fn key_of(&self, node: NodeId) -> Option<Key> {
        match self.nodes[node].key {
            Keyed::Unknown => None,
            Keyed::Recipe => Some(self.nodes[node].recipe),
            Keyed::Own(number) => Some(self.keys[number as usize].0),
        }
    }

    /// The nodes with a key: several when what they need came to the same result in different ways.
    pub(super) fn of_key<'a>(&'a self, key: &Key) -> impl Iterator<Item = NodeId> + use<'a> {
        let key = *key;
        let plain = self.of_recipe(&key).filter(|&node| self.nodes[node].key == Keyed::Recipe);
        let own = self.by_key.candidates(&key.0).map(|number| self.keys[number]);
        plain.into_iter().chain(own.filter(move |(known, _)| *known == key).map(|(_, node)| node))
    }

    /// Whether a task with this key was run, and why it failed if it did.
    pub(super) fn ended(&self, key: &Key) -> Option<Option<&str>> {
        self.of_key(key).find_map(|node| match self.nodes[node].stand {
            Stand::Ran => Some(None),
            Stand::Failed => Some(self.failures.get(&node).map(String::as_str)),
            Stand::Open | Stand::Running | Stand::Cached | Stand::Skipped => None,
        })
    }

    /// The keys of all tasks that were run, and why those failed that did.
    pub(super) fn all_ended(&self) -> impl Iterator<Item = (Key, Option<String>)> {
        let keys = (0..self.nodes.len()).filter_map(|node| self.key_of(node));
        keys.filter_map(|key| Some((key, self.ended(&key)?.map(str::to_owned))))
    }

    /// Notes that workers on other machines have a node.
    pub(super) fn hand_over(&mut self, node: NodeId) {
        self.nodes[node].away = true;
    }

    /// A node with this key that workers on other machines have.
    pub(super) fn away(&self, key: &Key) -> Option<NodeId> {
        self.of_key(key).find(|&node| self.nodes[node].away)
    }

    /// As [`Board::away`]; they do not have it any more.
    pub(super) fn take_back(&mut self, key: &Key) -> Option<NodeId> {
        let node = self.away(key)?;
        self.nodes[node].away = false;
        Some(node)
    }

    /// How one node counts.
    pub(super) fn count_of(&self, node: NodeId) -> TaskCount {
        let one = TaskCount { total: 1, ..TaskCount::default() };
        match self.nodes[node].stand {
            Stand::Open | Stand::Running => one,
            Stand::Cached => TaskCount { cached: 1, ..one },
            Stand::Ran => TaskCount { ran: 1, ..one },
            Stand::Failed => TaskCount { failed: 1, ..one },
            Stand::Skipped => TaskCount { skipped: 1, ..one },
        }
    }

    /// The object that holds a node's result.
    pub(super) fn object(&self, node: NodeId) -> Option<ObjectId> {
        Some(ObjectId { content: self.nodes[node].result()?, key: self.key_of(node)? })
    }

    /// These nodes and all that they need, each once, in the order they were put on the board.
    pub(super) fn closure(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut seen = vec![false; self.nodes.len()];
        let mut open = roots.to_vec();
        while let Some(node) = open.pop() {
            if !seen[node] {
                seen[node] = true;
                open.extend(self.nodes[node].input_nodes());
            }
        }
        (0..self.nodes.len()).filter(|&node| seen[node]).collect()
    }

    /// Results and rows of these nodes that are done, each behind the runs that are cached for it.
    pub(super) fn results(&self, nodes: &[NodeId]) -> impl Iterator<Item = (ObjectId, Option<usize>)> {
        nodes.iter().flat_map(|&node| {
            let cached = cached_runs(&self.nodes[node]).iter();
            let cached = cached.map(|&(_, row, key, content)| (ObjectId { content, key }, Some(row)));
            cached.chain(self.object(node).map(|object| (object, self.row(node))))
        })
    }

    /// Keys of the runs that are cached for a node.
    pub(super) fn cached_keys(&self, node: NodeId) -> impl Iterator<Item = Key> {
        cached_runs(&self.nodes[node]).iter().map(|&(_, _, key, _)| key)
    }

    /// Every task but the runs that are cached.
    pub(super) fn reports(&self) -> impl DoubleEndedIterator<Item = TaskReport> {
        (0..self.nodes.len()).map(|node| TaskReport {
            stage: self.stage(node),
            row: self.row(node),
            state: self.state(node),
            text: self.text(node),
            object: self.object(node),
        })
    }

    /// The object of every task that is done.
    pub(super) fn objects(&self) -> impl DoubleEndedIterator<Item = ObjectId> {
        (0..self.nodes.len()).flat_map(|node| {
            let cached = cached_runs(&self.nodes[node]).iter();
            cached.map(|&(_, _, key, content)| ObjectId { content, key }).chain(self.object(node))
        })
    }

    /// Seconds that the tasks of a stage took in this run.
    pub(super) fn seconds(&self, stage: usize) -> f64 {
        self.seconds.get(stage).copied().unwrap_or(0.0)
    }

    /// Notes how long a task took.
    pub(super) fn took(&mut self, node: NodeId, seconds: f64) {
        let stage = self.stage(node);
        self.seconds[stage] += seconds;
    }

    /// Notes a result; answers with the nodes that can be decided now.
    pub(super) fn done(&mut self, node: NodeId, content: ContentHash, cached: bool) -> Vec<NodeId> {
        let count = self.count_mut(node);
        if cached {
            count.cached += 1
        } else {
            count.ran += 1
        }
        let done = &mut self.nodes[node];
        done.stand = if cached { Stand::Cached } else { Stand::Ran };
        done.content = content;
        let mut needed_by = self.edges.from(std::mem::replace(&mut done.needed_by, NONE));
        // What gathers is asked for its cached runs later, and what was cached may be audited.
        if !cached && !needed_by.is_empty() && done.task.as_ref().is_some_and(|task| task.work != GATHER.name) {
            done.task = None;
        }
        needed_by.retain(|&next| {
            self.nodes[next].missing -= 1;
            self.nodes[next].missing == 0
        });
        needed_by
    }

    pub(super) fn started(&mut self, node: NodeId) {
        self.nodes[node].stand = Stand::Running;
    }

    pub(super) fn is_running(&self, node: NodeId) -> bool {
        self.nodes[node].stand == Stand::Running
    }

    /// Whether a node is neither open nor running.
    pub(super) fn is_settled(&self, node: NodeId) -> bool {
        !matches!(self.nodes[node].stand, Stand::Open | Stand::Running)
    }

    /// An interrupted task is as if it had not been started.
    pub(super) fn stopped(&mut self, node: NodeId) {
        self.nodes[node].stand = Stand::Open;
    }

    /// Notes a failure; all that needs this task is skipped.
    pub(super) fn failed(&mut self, node: NodeId, why: &str) {
        self.nodes[node].stand = Stand::Failed;
        self.failures.insert(node, why.to_owned());
        self.count_mut(node).failed += 1;
        let mut open = self.edges.from(self.nodes[node].needed_by);
        while let Some(next) = open.pop() {
            if self.nodes[next].stand == Stand::Open {
                self.nodes[next].stand = Stand::Skipped;
                self.count_mut(next).skipped += 1;
                open.extend(self.edges.from(self.nodes[next].needed_by));
            }
        }
    }

    pub(super) fn state(&self, node: NodeId) -> TaskState {
        let content = self.nodes[node].content;
        match self.nodes[node].stand {
            Stand::Open => TaskState::Open,
            Stand::Running => TaskState::Running,
            Stand::Cached => TaskState::Done { content, cached: true },
            Stand::Ran => TaskState::Done { content, cached: false },
            Stand::Failed => TaskState::Failed(self.failures.get(&node).cloned().unwrap_or_default()),
            Stand::Skipped => TaskState::Skipped,
        }
    }

    pub(super) fn stage(&self, node: NodeId) -> usize {
        self.nodes[node].stage as usize
    }

    /// The design row of a node.
    pub(super) fn row(&self, node: NodeId) -> Option<usize> {
        some(self.nodes[node].row)
    }

    /// The task of a node. Panics for a task that was computed in this run for others: it was let go.
    pub(super) fn task(&self, node: NodeId) -> &Arc<Task> {
        self.nodes[node].task.as_ref().unwrap_or_else(|| panic!("BUG: a task is asked for that was let go"))
    }

    /// The first failure among a node and all that it needs.
    pub(super) fn cause(&self, node: NodeId) -> Option<(NodeId, &str)> {
        match self.nodes[node].stand {
            Stand::Failed => self.failures.get(&node).map(|why| (node, why.as_str())),
            Stand::Skipped => self.nodes[node].input_nodes().find_map(|input| self.cause(input)),
            Stand::Open | Stand::Running | Stand::Cached | Stand::Ran => None,
        }
    }

    pub(super) fn count(&self, stage: usize) -> TaskCount {
        self.counts.get(stage).copied().unwrap_or_default()
    }

    fn count_mut(&mut self, node: NodeId) -> &mut TaskCount {
        let stage = self.stage(node);
        &mut self.counts[stage]
    }
}

/// The content of an input that is no task.
fn content(source: &Source) -> ContentHash {
    match source {
        Source::Content(content) => *content,
        Source::Task(_) | Source::Placed => panic!("BUG: an input task without a node"),
    }
}
