//! Who computes a task: one caller of all that share the store.

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
    /// Claims a task: the caller's to compute, somebody else's, or finished by somebody else in the meantime.
    ///
    /// # Errors
    /// The lock cannot be made or the journals cannot be read.
    pub fn claim(&self, key: &Key) -> Result<Claim, StoreError> {
        self.claimed(key, false)
    }

    /// Claims a task although it may be finished: its new result counts from then on.
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
                // Its last holder recorded the result before it let go.
                self.refresh()?;
                let found = if again { None } else { self.find(key)? };
                Ok(found.map_or(Claim::Mine(guard), Claim::Done))
            }
        }
    }
}
