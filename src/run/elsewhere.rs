//! Tasks that other processes on the same store compute. This process checks them now and then, and works on other tasks.
//!
//! Two campaigns that begin together both reach for the same first task. From then on each continues at an index of its own
//! among the remaining tasks, so that they seldom reach for the same task again.

use super::board::NodeId;
use super::queue::Queue;
use crate::store::Waiting;
use std::time::Duration;

/// Longest pause between two looks.
const LONGEST: Duration = Duration::from_millis(50);

/// Tasks that other processes compute.
#[derive(Default)]
pub(super) struct Elsewhere {
    tasks: Vec<(NodeId, Waiting)>,
    /// How often another process already had a task that this one wanted.
    met: usize,
    pause: Duration,
}

impl Elsewhere {
    pub(super) fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// Adds a task that another process computes.
    pub(super) fn put(&mut self, node: NodeId, waiting: Waiting) {
        self.met += 1;
        self.pause = Duration::from_millis(1);
        self.tasks.push((node, waiting));
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.tasks.clear();
    }

    /// The tasks that no other process computes any more, finished or not.
    pub(super) fn over(&mut self) -> Vec<NodeId> {
        let over: Vec<NodeId> =
            self.tasks.extract_if(.., |(_, waiting)| waiting.is_over()).map(|(node, _)| node).collect();
        self.pause = if over.is_empty() { (self.pause * 2).min(LONGEST) } else { Duration::from_millis(1) };
        over
    }

    /// How long to wait before the next look.
    pub(super) fn pause(&self) -> Duration {
        self.pause
    }

    /// The first task that another process has, and who that is.
    pub(super) fn first(&self) -> Option<(NodeId, String)> {
        self.tasks.first().map(|(node, waiting)| (*node, waiting.holder.to_string()))
    }

    /// Takes the task to start next: the longest one, or one at a random index once another process was met.
    pub(super) fn next(&self, ready: &mut Queue) -> Option<NodeId> {
        if self.met == 0 {
            return ready.take_longest();
        }
        // A new index each time: the neighbours of an old one are soon taken by another process.
        let number = (u64::from(std::process::id()) << 20 | self.met as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ready.take_at((number >> 33) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_taken_once_wherever_one_begins() {
        for met in 0..20 {
            let elsewhere = Elsewhere { met, ..Elsewhere::default() };
            let mut ready = Queue::default();
            [3, 4, 9, 11].into_iter().for_each(|node| ready.put(node));
            let mut taken: Vec<NodeId> = std::iter::from_fn(|| elsewhere.next(&mut ready)).collect();
            if met == 0 {
                assert_eq!(taken, [3, 4, 9, 11]);
            }
            taken.sort_unstable();
            assert_eq!(taken, [3, 4, 9, 11]);
        }
    }
}
