//! How a result is found and read: its record or its name, then its object, proven.

use super::object::{self, Seal};
use super::prove::{self, Proven};
use super::record::moment;
use super::{ObjectId, Record, Store, StoreError, Timing, locked};
use crate::artifact::{Artifact, ContentHash, Key};
use std::sync::Arc;
use std::time::UNIX_EPOCH;

impl Store {
    /// The record of a finished task whose object is in the store: one that this user's own flow wrote, or one that the
    /// object proves. None of a task with two different results, which is to be computed again.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn find(&self, key: &Key) -> Result<Option<Record>, StoreError> {
        let records = locked(self.index()?).of_task(key);
        let (own, others): (Vec<Record>, Vec<Record>) = records.into_iter().partition(|record| record.own);
        let mut sound = Vec::new();
        for record in own {
            sound.extend(self.has(&record.object())?.then_some(record));
        }
        if sound.is_empty() {
            for record in others {
                if self.has(&record.object())? {
                    sound.extend(self.proven(&record)?);
                }
            }
        }
        if sound.is_empty() {
            // Its record may be lost.
            let names = locked(&self.presence).names_of_task(&self.disk, &self.mark, key)?;
            for name in names {
                let proven = self.if_sound(prove::named(&self.disk, &name))?.filter(|proven| proven.id.key == *key);
                sound.extend(proven.map(|proven| self.record_again(&proven.id, proven.seal)));
            }
        }
        match sound.len() {
            0 => self.listed(key),
            1 => Ok(sound.pop()),
            _ => {
                locked(&self.contradictions).insert(*key);
                Ok(None)
            }
        }
    }

    /// How long a task took, as its record says: for estimates, so nothing is proven.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn seconds(&self, key: &Key) -> Result<Option<f64>, StoreError> {
        let records = locked(self.index()?).of_task(key);
        Ok(records.iter().max_by_key(|record| record.own).map(|record| record.seconds))
    }

    /// Whether all these objects are in the store, or in the attached remote; that they are sound is seen when they are read.
    ///
    /// # Errors
    /// The folders cannot be listed.
    pub fn has_all(&self, objects: &[ObjectId]) -> Result<bool, StoreError> {
        let mut presence = locked(&self.presence);
        presence.expect(&self.disk, &self.mark, objects.len())?;
        for object in objects {
            if !presence.contains(&self.disk, object) && !self.is_listed(object)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(super) fn has(&self, object: &ObjectId) -> Result<bool, StoreError> {
        self.has_all(&[*object])
    }

    /// Whether every folder of objects can be opened.
    ///
    /// # Errors
    /// One cannot, or is none.
    pub fn check_folders(&self) -> Result<(), StoreError> {
        object::open_shards(&self.disk).map(drop)
    }

    /// The artifact with this content; it is fetched from the attached remote when only that has it.
    ///
    /// # Errors
    /// [`StoreError::Missing`] or [`StoreError::Damaged`] (see [`StoreError::is_missing`]): compute it again. Any
    /// other: the store, or the remote, cannot be read.
    pub fn get(&self, content: &ContentHash) -> Result<Arc<Artifact>, StoreError> {
        if let Some(artifact) = locked(&self.cache).get(content) {
            return Ok(artifact);
        }
        let artifact = Arc::new(self.get_from_disk(content)?);
        locked(&self.cache).put(*content, artifact.clone());
        Ok(artifact)
    }

    /// As [`Store::get`], for one that nobody is likely to read again soon: what others read stays in memory.
    ///
    /// # Errors
    /// Those of [`Store::get`].
    pub fn get_once(&self, content: &ContentHash) -> Result<Arc<Artifact>, StoreError> {
        let in_memory = locked(&self.cache).get(content);
        in_memory.map_or_else(|| self.get_from_disk(content).map(Arc::new), Ok)
    }

    fn get_from_disk(&self, content: &ContentHash) -> Result<Artifact, StoreError> {
        match self.get_here(content) {
            Err(error) if error.is_missing() && self.fetch(content)? => self.get_here(content),
            got => got,
        }
    }

    fn get_here(&self, content: &ContentHash) -> Result<Artifact, StoreError> {
        let mut failure = StoreError::Missing { content: *content };
        let records = locked(self.index()?).with_content(content);
        for record in records {
            match self.read(&record) {
                Ok(proven) => return Ok(proven.artifact),
                Err(error) => failure = error,
            }
        }
        // Its record may be lost, or not be read yet: its name says what it is.
        for name in object::with_content(&self.disk, content) {
            if let Some(proven) = self.if_sound(prove::named(&self.disk, &name))? {
                self.record_again(&proven.id, proven.seal);
                return Ok(proven.artifact);
            }
        }
        Err(failure)
    }

    /// The text of a finished task, from its object.
    ///
    /// # Errors
    /// As [`Store::get`].
    pub fn task_text(&self, record: &Record) -> Result<String, StoreError> {
        match self.read(record) {
            Err(error) if error.is_missing() && self.fetch(&record.content)? => Ok(self.read(record)?.text),
            read => Ok(read?.text),
        }
    }

    /// The object of a record, proven.
    pub(super) fn read(&self, record: &Record) -> Result<Proven, StoreError> {
        let id = record.object();
        let seal = record.own.then_some(&record.seal);
        self.noted(&id, prove::object(&self.disk, &id, seal))
    }

    /// The record of somebody else, as one's own when its object proves it.
    pub(super) fn proven(&self, record: &Record) -> Result<Option<Record>, StoreError> {
        Ok(self.if_sound(self.read(record))?.map(|proven| self.own(record, proven.seal)))
    }

    /// The record of somebody else, whose object was proven just now, as one's own.
    pub(super) fn own(&self, record: &Record, seal: Seal) -> Record {
        let timing = Timing { started: moment(record.started), seconds: record.seconds };
        self.remember(self.marked(&record.object(), seal, &timing, record.origin.clone()))
    }

    /// A record of an object that had none.
    pub(super) fn record_again(&self, id: &ObjectId, seal: Seal) -> Record {
        let timing = Timing { started: UNIX_EPOCH, seconds: 0.0 };
        self.remember(self.marked(id, seal, &timing, Arc::default()))
    }

    /// Records what was proven, so that it need not be proven again. Where the store cannot be written, it is known to
    /// this process alone.
    pub(super) fn remember(&self, record: Record) -> Record {
        let _ = locked(&self.segments).append(&self.disk, &record, false);
        if let Some(index) = self.index.get() {
            locked(index).add(&record);
        }
        locked(&self.presence).add(&record.object());
        record
    }

    /// Notes the damage that reading an object has met.
    pub(super) fn noted<T>(&self, id: &ObjectId, result: Result<T, StoreError>) -> Result<T, StoreError> {
        if let Err(error) = &result {
            if let StoreError::Damaged { fault } = error {
                locked(&self.damages).push(fault.clone());
            }
            locked(&self.presence).remove(id);
        }
        result
    }

    /// What is missing or was damaged is nothing; any other error stays.
    pub(super) fn if_sound<T>(&self, result: Result<T, StoreError>) -> Result<Option<T>, StoreError> {
        match result {
            Ok(sound) => Ok(Some(sound)),
            Err(StoreError::Missing { .. } | StoreError::Damaged { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}
