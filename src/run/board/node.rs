//! A node of the board, in few bytes: there may be a million.

use super::NodeId;
use crate::artifact::{ContentHash, Key};
use crate::stage::Task;
use std::sync::Arc;

/// No node, row, or edge.
pub(super) const NONE: u32 = u32::MAX;

/// The number behind `NONE` or not.
pub(super) fn some(number: u32) -> Option<usize> {
    (number != NONE).then_some(number as usize)
}

/// Where a task stands, in one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stand {
    Open,
    Running,
    /// Its result was in the store.
    Cached,
    /// It was computed in this run.
    Ran,
    Failed,
    Skipped,
}

/// The key of a task, known once its inputs are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Keyed {
    Unknown,
    /// No input is a task, so it is the recipe.
    Recipe,
    /// Which of the board's keys it is.
    Own(u32),
}

pub(super) struct Node {
    /// None once it was computed in this run for others that need it: only its result is still of use.
    pub(super) task: Option<Arc<Task>>,
    /// The node of each input, [`NONE`] for contents; empty when no input is a task.
    pub(super) inputs: Box<[u32]>,
    pub(super) recipe: Key,
    /// Its result, once it is done.
    pub(super) content: ContentHash,
    pub(super) stage: u32,
    /// Its design row.
    pub(super) row: u32,
    /// Inputs that are not done, each as often as it is named.
    pub(super) missing: u32,
    /// The last of its edges to those that need it.
    pub(super) needed_by: u32,
    pub(super) key: Keyed,
    pub(super) stand: Stand,
    /// Whether workers on other machines have it.
    pub(super) away: bool,
}

impl Node {
    /// The node of an input that is a task.
    pub(super) fn input(&self, index: usize) -> Option<NodeId> {
        self.inputs.get(index).copied().and_then(some)
    }

    /// The nodes of all inputs that are tasks.
    pub(super) fn input_nodes(&self) -> impl Iterator<Item = NodeId> {
        self.inputs.iter().copied().filter_map(some)
    }

    pub(super) fn is_done(&self) -> bool {
        matches!(self.stand, Stand::Cached | Stand::Ran)
    }

    /// Its result, when it is done.
    pub(super) fn result(&self) -> Option<ContentHash> {
        self.is_done().then_some(self.content)
    }
}

/// The edges from nodes to those that need them: a list for each node, all in one vector.
#[derive(Default)]
pub(super) struct Edges(Vec<Edge>);

struct Edge {
    to: u32,
    /// The edge of the same node that was added before.
    before: u32,
}

impl Edges {
    /// Adds an edge in front of those that begin at `last`; returns where they begin now.
    pub(super) fn add(&mut self, to: NodeId, last: u32) -> u32 {
        self.0.push(Edge { to: to as u32, before: last });
        self.0.len() as u32 - 1
    }

    /// Makes room for so many.
    pub(super) fn expect(&mut self, count: usize) {
        self.0.reserve_exact(count);
    }

    /// The nodes at the ends of the edges that begin at `last`, in the order they were added.
    pub(super) fn from(&self, last: u32) -> Vec<NodeId> {
        let edges = std::iter::successors(some(last), |&edge| some(self.0[edge].before));
        let mut nodes: Vec<NodeId> = edges.map(|edge| self.0[edge].to as usize).collect();
        nodes.reverse();
        nodes
    }
}
