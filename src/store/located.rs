//! The store for a process that reads no journal: the list of a worker names the objects of its inputs and their digests.

use super::object::{ObjectId, Seal};
use super::{Guard, Store, StoreError, lock, locked, object, prove};
use crate::artifact::{Artifact, ContentHash, Key};
use std::sync::Arc;

/// An object with the digest and size of its file, so that it can be read without a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Located {
    /// The object.
    pub object: ObjectId,
    seal: Seal,
}

impl Located {
    /// Its key, content, digest and size as one text.
    pub fn to_text(&self) -> String {
        let digest = u128::from_be_bytes(self.seal.digest);
        format!("{}:{}:{digest:032x}:{}", self.object.key, self.object.content, self.seal.size)
    }

    /// Reads such a text; `None` when it is not one.
    pub fn from_text(text: &str) -> Option<Self> {
        let parts: Vec<&str> = text.split(':').collect();
        let [key, content, digest, size] = parts[..] else { return None };
        let object = ObjectId { content: ContentHash::from_hex(content)?, key: Key::from_hex(key)? };
        let digest = u128::from_str_radix(digest, 16).ok()?.to_be_bytes();
        Some(Self { object, seal: Seal { digest, size: size.parse().ok()? } })
    }
}

impl Store {
    /// As [`Store::claim`], without reading the journals: for a worker, whose list holds unfinished tasks only.
    /// `None` when another process computes it.
    ///
    /// # Errors
    /// The lock cannot be made.
    pub fn claim_unseen(&self, key: &Key) -> Result<Option<Guard>, StoreError> {
        match lock::take(&self.disk, &key.to_string(), &self.machine)? {
            lock::Taken::Mine(guard) => Ok(Some(guard)),
            lock::Taken::Theirs(_) => Ok(None),
        }
    }

    /// The object of the artifact with this content, with digest and size of its file, for a process that reads no journal.
    ///
    /// # Errors
    /// As [`Store::get`].
    pub fn locate(&self, content: &ContentHash) -> Result<Located, StoreError> {
        loop {
            for record in locked(self.index()?).with_content(content).into_iter().filter(|record| record.own) {
                if object::is_there(&self.disk, &record.object()) {
                    return Ok(Located { object: record.object(), seal: record.seal });
                }
            }
            // Workers do not ask the attached remote.
            if !self.fetch(content)? {
                return Err(StoreError::Missing { content: *content });
            }
        }
    }

    /// The artifact that [`Store::locate`] found; size and digest are compared before a byte is decoded.
    ///
    /// # Errors
    /// As [`Store::get`].
    pub fn get_located(&self, located: &Located) -> Result<Arc<Artifact>, StoreError> {
        let content = located.object.content;
        if let Some(artifact) = locked(&self.cache).get(&content) {
            return Ok(artifact);
        }
        let proven = self.noted(&located.object, prove::object(&self.disk, &located.object, Some(&located.seal)))?;
        let artifact = Arc::new(proven.artifact);
        locked(&self.cache).put(content, artifact.clone());
        Ok(artifact)
    }
}
