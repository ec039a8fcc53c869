//! One pool of threads, and the one budget of cores. It knows neither tasks nor physics.
//!
//! `--jobs` bounds everything. The pool has that many threads. A piece of work given to it runs on one of them; what that
//! work does in parallel through rayon (the statistics) runs on the same threads. A simulation brings threads of its own,
//! because they meet at a barrier in every step: it asks its [`Share`] how many, again and again while it runs. The shares
//! of all running pieces of work together are never more than the budget, except for the moment between the start of new
//! work and the next question of the others.

use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    /// Pieces of work that hold a share.
    holders: Arc<AtomicUsize>,
}

impl Budget {
    fn new(cores: usize) -> Self {
        Self { cores, holders: Arc::default() }
    }

    fn share(&self) -> Share {
        self.holders.fetch_add(1, Ordering::Relaxed);
        Share(self.clone())
    }
}

/// The share of one piece of work in the budget; it is given back when it is dropped.
pub struct Share(Budget);

impl Share {
    /// Threads that this work may use now: at least one, all of the budget when nothing else runs. The number changes as
    /// other work starts and ends, so long work asks again.
    pub fn threads(&self) -> usize {
        (self.0.cores / self.0.holders.load(Ordering::Relaxed).max(1)).max(1)
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.0.holders.fetch_sub(1, Ordering::Relaxed);
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
        assert_eq!([first.threads(), others[0].threads(), others[1].threads()], [2, 2, 2]);
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
