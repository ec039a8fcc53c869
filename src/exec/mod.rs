//! One pool of threads, and the one budget of cores. It knows neither tasks nor physics.
//!
//! `--jobs` bounds everything. The pool has that many threads. A piece of work given to it runs on one of them; what that
//! work does in parallel through rayon (the statistics) runs on the same threads. A simulation brings threads of its own,
//! because they meet at a barrier in every step: it asks its [`Share`] how many, again and again while it runs. The shares
//! of all running pieces of work together are the whole budget (what does not divide goes to those that began first), and
//! never more, except for the moment between the start of new work and the next question of the others.

use std::collections::BTreeSet;
use std::num::NonZero;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A pool of threads whose work may borrow what outlives `'scope`.
pub struct Threads<'pool, 'scope> {
    scope: &'pool rayon::ScopeFifo<'scope>,
    budget: Budget,
}

/// Starts `count` threads, calls `decide` on the thread of the caller, and returns when it and all work are done.
///
/// # Errors
/// The system grants no threads.
pub fn with_threads<'scope, T>(
    count: usize,
    decide: impl FnOnce(Threads<'_, 'scope>) -> T,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let name = |index| format!("worker {index}");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.max(1)).thread_name(name).build()?;
    Ok(pool.in_place_scope_fifo(|scope| decide(Threads { scope, budget: Budget::new(count.max(1)) })))
}

impl<'scope> Threads<'_, 'scope> {
    /// Hands one piece of work to the pool; it receives its share of the cores.
    pub fn give(&self, work: impl FnOnce(&Share) + Send + 'scope) {
        let share = self.budget.share();
        self.scope.spawn_fifo(move |_| work(&share));
    }

    /// Number of threads.
    pub fn count(&self) -> usize {
        self.budget.cores
    }
}

/// The cores that all work together may use.
#[derive(Clone)]
struct Budget {
    cores: usize,
    holders: Arc<Mutex<Holders>>,
}

/// Pieces of work that hold a share, by number; those that began first have the smallest.
#[derive(Default)]
struct Holders {
    numbers: BTreeSet<usize>,
    begun: usize,
}

impl Budget {
    fn new(cores: usize) -> Self {
        Self { cores, holders: Arc::default() }
    }

    fn share(&self) -> Share {
        let mut holders = self.holders();
        holders.begun += 1;
        let number = holders.begun;
        holders.numbers.insert(number);
        Share { budget: self.clone(), number }
    }

    fn holders(&self) -> MutexGuard<'_, Holders> {
        // Nothing panics while it holds the lock.
        self.holders.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The share of one piece of work in the budget; it is given back when it is dropped.
pub struct Share {
    budget: Budget,
    number: usize,
}

impl Share {
    /// Threads that this work may use now: at least one, all of the budget when nothing else runs. The number changes as
    /// other work starts and ends, so long work asks again.
    pub fn threads(&self) -> usize {
        let holders = self.budget.holders();
        let (all, cores) = (holders.numbers.len().max(1), self.budget.cores);
        let before = holders.numbers.range(..self.number).count();
        (cores / all + usize::from(before < cores % all)).max(1)
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.budget.holders().numbers.remove(&self.number);
    }
}

/// Cores that this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn shares_follow_the_number_of_holders_and_stay_within_the_budget() {
        let budget = Budget::new(8);
        let first = budget.share();
        assert_eq!(first.threads(), 8);
        let others: Vec<Share> = (0..2).map(|_| budget.share()).collect();
        assert_eq!([first.threads(), others[0].threads(), others[1].threads()], [3, 3, 2]);
        let many: Vec<Share> = (0..20).map(|_| budget.share()).collect();
        assert_eq!(first.threads(), 1);
        drop((others, many));
        assert_eq!(first.threads(), 8);
    }

    #[test]
    fn parallel_statistics_run_on_the_threads_of_the_pool() {
        let (answers, inbox) = channel();
        with_threads(3, |pool| {
            pool.give(move |share| answers.send((rayon::current_num_threads(), share.threads())).unwrap());
            assert_eq!(inbox.recv().unwrap(), (3, 3));
        })
        .unwrap();
    }
}
