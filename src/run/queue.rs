//! The tasks that can be started, longest first.
//!
//! What counts is how long all tasks of a row took in earlier campaigns: a row is a chain of tasks (a specimen, its
//! simulation), and a long chain must begin early, or it is still going on when the other cores have nothing left to do.
//! Where nothing is recorded, tasks start in the order they were put on the board. The order decides when a result comes,
//! never what it is.

use super::board::NodeId;
use super::{Loop, Past};
use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap};

/// Tasks whose inputs are known and whose result is not in the store.
#[derive(Default)]
pub(super) struct Queue {
    nodes: BTreeSet<NodeId>,
    longest: BTreeSet<(Reverse<u64>, NodeId)>,
    /// Milliseconds that each node is expected to take, also after it was taken: it may come back.
    expected: HashMap<NodeId, u64>,
    /// Those of which nobody has said yet how long they take.
    unknown: Vec<NodeId>,
}

impl Queue {
    /// Adds a node.
    pub(super) fn put(&mut self, node: NodeId) {
        self.nodes.insert(node);
        self.longest.insert(self.entry(node));
        if !self.expected.contains_key(&node) {
            self.unknown.push(node);
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The nodes of which nobody has said yet how long they take; each is given out once.
    pub(super) fn unknown(&mut self) -> Vec<NodeId> {
        std::mem::take(&mut self.unknown)
    }

    /// Says how long a node is expected to take, in seconds.
    pub(super) fn expect(&mut self, node: NodeId, seconds: f64) {
        let waits = self.longest.remove(&self.entry(node));
        self.expected.insert(node, (1e3 * seconds) as u64);
        if waits {
            self.longest.insert(self.entry(node));
        }
    }

    /// Takes a node out.
    pub(super) fn remove(&mut self, node: NodeId) {
        self.nodes.remove(&node);
        self.longest.remove(&self.entry(node));
    }

    /// Takes out the node that is expected to take longest, the first on the board among equals.
    pub(super) fn take_longest(&mut self) -> Option<NodeId> {
        let (_, node) = *self.longest.first()?;
        self.remove(node);
        Some(node)
    }

    /// Takes out a node anywhere on the board: the one at `number`, or the next one after it.
    pub(super) fn take_at(&mut self, number: usize) -> Option<NodeId> {
        let (first, last) = (*self.nodes.first()?, *self.nodes.last()?);
        let node = *self.nodes.range(first + number % (last - first + 1)..).next()?;
        self.remove(node);
        Some(node)
    }

    /// All of them, in the order of the board.
    pub(super) fn iter(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.nodes.iter().copied()
    }

    fn entry(&self, node: NodeId) -> (Reverse<u64>, NodeId) {
        (Reverse(self.expected.get(&node).copied().unwrap_or(0)), node)
    }
}

impl Loop<'_, '_> {
    /// Tells the queue how long its nodes take, where there is a choice among them.
    pub(super) fn rank(&mut self) {
        if self.ready.len() <= self.pool.count() {
            return;
        }
        for node in self.ready.unknown() {
            let (stage, row) = (self.board.stage(node), self.board.row(node));
            if !self.row_seconds.contains_key(&stage) {
                let read = self.past().and_then(|past| past.row_seconds(&self.workflow.stages[stage].name));
                self.row_seconds.insert(stage, read);
            }
            if let Some(rows) = &self.row_seconds[&stage] {
                self.ready.expect(node, rows.of(row));
            }
        }
    }

    /// Earlier runs of the workflow.
    pub(super) fn past(&self) -> Option<&Past<'_>> {
        self.past.get_or_init(|| Past::of(self.workflow, self.store).ok()).as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_is_taken_first_and_equals_in_the_order_of_the_board() {
        let mut queue = Queue::default();
        for (node, seconds) in [(0, 0.0), (1, 2.5), (2, 60.0), (3, 2.5), (4, 0.0), (5, 61.0)] {
            queue.put(node);
            queue.expect(node, seconds);
        }
        queue.remove(5);
        let first = queue.take_longest();
        queue.put(2);
        assert_eq!((first, queue.take_longest()), (Some(2), Some(2)));
        assert_eq!(queue.iter().collect::<Vec<_>>(), [0, 1, 3, 4]);
        let rest: Vec<NodeId> = std::iter::from_fn(|| queue.take_longest()).collect();
        assert_eq!(rest, [1, 3, 0, 4]);
    }

    /// Eight rows of 10 s and one of 40 s on two cores: in the order of the board the last one runs alone from 40 s to 80 s,
    /// longest first all is over after 60 s.
    #[test]
    fn no_long_row_is_left_for_the_end() {
        let seconds = [10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 40.0];
        let end = |expected: &dyn Fn(usize) -> f64| {
            let mut queue = Queue::default();
            (0..seconds.len()).for_each(|node| queue.put(node));
            queue.unknown().into_iter().for_each(|node| queue.expect(node, expected(node)));
            let mut free = [0.0_f64; 2];
            while let Some(node) = queue.take_longest() {
                free.sort_by(f64::total_cmp);
                free[0] += seconds[node];
            }
            free[0].max(free[1])
        };
        assert_eq!((end(&|_| 0.0), end(&|node| seconds[node])), (80.0, 60.0));
    }
}
