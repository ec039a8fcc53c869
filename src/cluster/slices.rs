//! Which task of the lists a worker begins next: first its own slice in order, then the last task of the fullest slice.
//!
//! Worker `index` of `of` owns the `index`-th part of every list, so that workers seldom want the same task: one that takes
//! from the slice of another begins at the end that the owner reaches last.

use std::collections::VecDeque;

/// The tasks that a worker believes to be open, by the slices they belong to.
pub struct Slices {
    slices: Vec<VecDeque<usize>>,
    own: usize,
}

impl Slices {
    /// No tasks yet, for worker `index` of `of`; both count from 0 and 1.
    pub fn new(index: usize, of: usize) -> Self {
        let of = of.max(1);
        Self { slices: vec![VecDeque::new(); of], own: index % of }
    }

    /// Adds the tasks of one list.
    pub fn add(&mut self, tasks: std::ops::Range<usize>) {
        let (count, of) = (tasks.len(), self.slices.len());
        for (number, task) in tasks.enumerate() {
            // With fewer tasks than workers each of the first workers has one.
            let slice = if count < of { number } else { number * of / count };
            self.slices[slice].push_back(task);
        }
    }

    /// The task to begin next; it is not offered again.
    pub fn take(&mut self) -> Option<usize> {
        if let Some(task) = self.slices[self.own].pop_front() {
            return Some(task);
        }
        let (fullest, _) = self.slices.iter().enumerate().max_by_key(|(_, slice)| slice.len())?;
        self.slices[fullest].pop_back()
    }

    /// Puts a task back that is not begun after all.
    pub fn put_back(&mut self, task: usize) {
        self.slices[self.own].push_front(task);
    }

    /// Forgets the tasks that others have begun; returns how many.
    pub fn forget(&mut self, begun: &std::collections::HashSet<usize>) -> usize {
        let before = self.left();
        self.slices.iter_mut().for_each(|slice| slice.retain(|task| !begun.contains(task)));
        before - self.left()
    }

    fn left(&self) -> usize {
        self.slices.iter().map(VecDeque::len).sum()
    }

    /// Tasks that are left outside of the own slice.
    pub fn has_own(&self) -> bool {
        !self.slices[self.own].is_empty()
    }
}

/// When a worker lists the tasks that are begun, instead of trying a hundred thousand one by one: after a few misses in a
/// row. A shared disk may show late what others have begun, so after a look that found nothing it waits twice as long.
pub struct Patience {
    missed: usize,
    most: usize,
}

impl Default for Patience {
    fn default() -> Self {
        Self { missed: 0, most: MISSES }
    }
}

/// Tasks in a row that others had begun before a worker looks which are.
const MISSES: usize = 8;

impl Patience {
    /// Counts a task that another worker had begun; returns whether it is time to look.
    pub fn miss(&mut self) -> bool {
        self.missed += 1;
        self.missed >= self.most
    }

    /// A look after misses found this many tasks that are begun.
    pub fn looked(&mut self, found: usize) {
        self.missed = 0;
        if found == 0 {
            self.most *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(mut slices: Slices) -> Vec<usize> {
        std::iter::from_fn(|| slices.take()).collect()
    }

    #[test]
    fn a_worker_begins_with_its_own_slice_and_then_helps_from_the_end() {
        let with = |index, of, tasks: std::ops::Range<usize>| {
            let mut slices = Slices::new(index, of);
            slices.add(tasks);
            all(slices)
        };
        assert_eq!(with(0, 3, 0..6), [0, 1, 5, 3, 4, 2]);
        assert_eq!(with(1, 3, 0..6), [2, 3, 5, 1, 4, 0]);
        assert_eq!(with(2, 4, 10..12), [11, 10], "a worker without a slice helps");
        assert_eq!(with(7, 4, 0..4)[0], 3, "a later round begins where the first did");
    }

    #[test]
    fn every_task_is_offered_to_every_worker_once() {
        for of in 1..9 {
            for index in 0..of {
                let mut slices = Slices::new(index, of);
                slices.add(0..17);
                slices.add(17..20);
                assert_eq!((slices.forget(&[3, 18].into()), slices.forget(&[3].into())), (2, 0));
                let mut tasks = all(slices);
                tasks.sort_unstable();
                let wanted: Vec<usize> = (0..20).filter(|task| ![3, 18].contains(task)).collect();
                assert_eq!(tasks, wanted);
            }
        }
    }

    #[test]
    fn patience_grows_only_with_looks_that_find_nothing() {
        let mut patience = Patience::default();
        let misses = |patience: &mut Patience| (1..).find(|_| patience.miss());
        let mut looks = Vec::new();
        for found in [3, 1, 0, 5, 0, 2] {
            looks.extend(misses(&mut patience));
            patience.looked(found);
        }
        assert_eq!(looks, [8, 8, 8, 16, 16, 32]);
    }
}
