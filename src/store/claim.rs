//! Claims: of all processes that share the store, one computes a task.

use super::{Guard, Record, Store, StoreError, Waiting, lock};
use crate::artifact::Key;

/// The answer to [`Store::claim`].
#[derive(Debug)]
pub enum Claim {
    /// The task is the caller's to compute: hand the guard to [`Store::finish`], or drop it to give the task up.
    Mine(Guard),
    /// Another process, or another thread of this one, computes it.
    Theirs(Waiting),
    /// It is finished already.
    Done(Record),
}

impl Store {
    /// Claims a task. The answer says whether the caller computes it, another process does, or it has been finished in the
    /// meantime.
    ///
    /// # Errors
    /// The lock cannot be made or the journals cannot be read.
    pub fn claim(&self, key: &Key) -> Result<Claim, StoreError> {
        self.claimed(key, false)
    }

    /// Claims a task although it may be finished; the new result replaces the earlier one.
    ///
    /// # Errors
    /// As [`Store::claim`].
    pub fn claim_again(&self, key: &Key) -> Result<Claim, StoreError> {
        self.claimed(key, true)
    }

    fn claimed(&self, key: &Key, again: bool) -> Result<Claim, StoreError> {
        match lock::take(&self.disk, &key.to_string(), &self.machine)? {
            lock::Taken::Theirs(waiting) => Ok(Claim::Theirs(waiting)),
            lock::Taken::Mine(guard) => {
                // Its last holder recorded the result before it released the lock.
                self.refresh()?;
                let found = if again { None } else { self.find(key)? };
                Ok(found.map_or(Claim::Mine(guard), Claim::Done))
            }
        }
    }
}
