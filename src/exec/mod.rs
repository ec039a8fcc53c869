//! How work is started: a pool of threads that takes closures. It knows neither tasks nor physics.

use std::num::NonZero;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Scope;

type Work<'env> = Box<dyn FnOnce() + Send + 'env>;

/// Worker threads that live as long as their scope; work is taken in the order it was given.
pub struct Threads<'env> {
    queue: Sender<Work<'env>>,
    count: usize,
}

impl<'env> Threads<'env> {
    /// Starts `count` workers in `scope`; they end when the pool is dropped and their work is done.
    pub fn start<'scope>(scope: &'scope Scope<'scope, 'env>, count: usize) -> Self
    where
        'env: 'scope,
    {
        let (queue, work): (Sender<Work<'env>>, Receiver<Work<'env>>) = channel();
        let work = Arc::new(Mutex::new(work));
        for _ in 0..count {
            let work = Arc::clone(&work);
            scope.spawn(move || {
                loop {
                    let next = work.lock().unwrap_or_else(PoisonError::into_inner).recv();
                    match next {
                        Ok(run) => run(),
                        Err(_) => return,
                    }
                }
            });
        }
        Self { queue, count }
    }

    /// Hands one piece of work to the pool.
    pub fn give(&self, work: impl FnOnce() + Send + 'env) {
        if self.queue.send(Box::new(work)).is_err() {
            panic!("BUG: the workers ended before their pool");
        }
    }

    /// Number of workers.
    pub fn count(&self) -> usize {
        self.count
    }
}

/// Cores that this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}
