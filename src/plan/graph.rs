//! The order of stages, and cycles.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Nodes so that each comes after those it needs (`needs[i]` lists them); of those that are free, the first in number
/// comes first. Nodes on a cycle, or behind one, are left out.
pub(super) fn order(needs: &[Vec<usize>]) -> Vec<usize> {
    let mut open: Vec<usize> = needs.iter().map(Vec::len).collect();
    let mut needed_by = vec![Vec::new(); needs.len()];
    for (i, needs) in needs.iter().enumerate() {
        needs.iter().for_each(|&need| needed_by[need].push(i));
    }
    let mut free: BinaryHeap<_> = (0..needs.len()).filter(|&i| open[i] == 0).map(Reverse).collect();
    let mut order = Vec::with_capacity(needs.len());
    while let Some(Reverse(i)) = free.pop() {
        order.push(i);
        for &next in &needed_by[i] {
            open[next] -= 1;
            if open[next] == 0 {
                free.push(Reverse(next));
            }
        }
    }
    order
}

/// One cycle after another, each begun at its first node: `[a, b]` when a needs b and b needs a.
pub(super) fn cycles(needs: &[Vec<usize>]) -> Vec<Vec<usize>> {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        OnPath,
        Done,
    }
    let mut marks = vec![Mark::New; needs.len()];
    let mut cycles = Vec::new();
    for start in 0..needs.len() {
        if marks[start] != Mark::New {
            continue;
        }
        marks[start] = Mark::OnPath;
        let mut path = vec![(start, 0)];
        while let Some((node, next)) = path.last_mut() {
            let Some(&need) = needs[*node].get(*next) else {
                marks[*node] = Mark::Done;
                path.pop();
                continue;
            };
            *next += 1;
            match marks[need] {
                Mark::New => {
                    marks[need] = Mark::OnPath;
                    path.push((need, 0));
                }
                Mark::OnPath => {
                    let from = path.iter().position(|(node, _)| *node == need).unwrap_or(0);
                    let mut cycle: Vec<usize> = path[from..].iter().map(|(node, _)| *node).collect();
                    let first = (0..cycle.len()).min_by_key(|&i| cycle[i]).unwrap_or(0);
                    cycle.rotate_left(first);
                    cycles.push(cycle);
                }
                Mark::Done => {}
            }
        }
    }
    cycles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_comes_after_its_needs_and_else_in_order() {
        assert_eq!(order(&[vec![2], vec![], vec![], vec![0, 0]]), [1, 2, 0, 3]);
        assert_eq!(order(&[vec![], vec![], vec![]]), [0, 1, 2]);
        assert_eq!(order(&[vec![], vec![2], vec![1], vec![1]]), [0]);
    }

    #[test]
    fn every_cycle_is_reported_once_from_its_first_node() {
        assert_eq!(cycles(&[vec![1], vec![2], vec![0]]), [vec![0, 1, 2]]);
        assert_eq!(cycles(&[vec![0], vec![2], vec![1]]), [vec![0], vec![1, 2]]);
        assert_eq!(cycles(&[vec![1, 2], vec![], vec![1]]), Vec::<Vec<usize>>::new());
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_needs_no_stack() {
        let needs: Vec<Vec<usize>> = (0..100_000_usize).map(|i| (i + 1..(i + 2).min(100_000)).collect()).collect();
        assert_eq!(order(&needs).first(), Some(&99_999));
        assert!(cycles(&needs).is_empty());
    }
}
