//! Bounds on how many runs of an external program go on at once, such as the number of its licences.
//!
//! A node that must wait is set aside; when a run of its program ends, the first of those that wait comes back.

use super::board::NodeId;
use crate::stage::AtOnce;
use std::collections::{BTreeMap, BTreeSet};

/// How many runs of each bounded program go on, and the nodes that wait for one of them.
#[derive(Default)]
pub(super) struct Licences {
    programs: BTreeMap<String, Program>,
}

#[derive(Default)]
struct Program {
    running: BTreeSet<NodeId>,
    waiting: BTreeSet<NodeId>,
}

impl Licences {
    /// Whether a node may start now; one that may not waits here.
    pub(super) fn admits(&mut self, node: NodeId, bound: Option<&AtOnce>) -> bool {
        let Some(AtOnce { program, most }) = bound else { return true };
        let own = self.programs.entry(program.clone()).or_default();
        let admitted = own.running.len() < *most;
        if admitted {
            own.running.insert(node)
        } else {
            own.waiting.insert(node)
        };
        admitted
    }

    /// A node runs no longer, or could not be started; the node that may try next, when this one had been admitted.
    pub(super) fn release(&mut self, node: NodeId, bound: Option<&AtOnce>) -> Option<NodeId> {
        let own = self.programs.get_mut(&bound?.program)?;
        if own.running.remove(&node) { own.waiting.pop_first() } else { None }
    }

    /// Forgets the nodes that wait, when all is decided anew; nothing runs then.
    pub(super) fn clear(&mut self) {
        self.programs.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_runs_as_often_as_it_may_and_those_that_wait_come_back_in_order() {
        let bound = |program: &str, most| Some(AtOnce { program: program.to_owned(), most });
        let (two, other) = (bound("pfc", 2), bound("yade", 1));
        let mut licences = Licences::default();
        let admitted: Vec<bool> = [5, 6, 9, 7].map(|node| licences.admits(node, two.as_ref())).into();
        assert_eq!(admitted, [true, true, false, false]);
        assert!(licences.admits(1, other.as_ref()) && licences.admits(2, None));
        assert_eq!(licences.release(5, two.as_ref()), Some(7));
        assert!(licences.admits(7, two.as_ref()) && !licences.admits(8, two.as_ref()));
        assert_eq!(licences.release(2, None), None);
        assert_eq!([7, 7, 6].map(|node| licences.release(node, two.as_ref())), [Some(8), None, Some(9)]);
    }
}
