//! How a result enters the store: its object first, then its record.

use super::disk::Disk;
use super::object::Seal;
use super::record::milliseconds;
use super::{Guard, ObjectId, Origin, Record, Store, StoreError, Timing, hdf5, journal, locked, object, prove};
use crate::artifact::{Artifact, Key};
use std::io::ErrorKind;
use std::sync::Arc;

impl Store {
    /// Stores the result of a claimed task and releases it. When the function returns, the result can be found.
    ///
    /// # Errors
    /// No file can hold the result, or the disk refuses it.
    pub fn finish(
        &self,
        mut claim: Guard,
        task_text: impl Into<String>,
        artifact: Artifact,
        timing: &Timing,
    ) -> Result<(Record, Arc<Artifact>), StoreError> {
        self.store(Some(&mut claim), task_text.into(), artifact, timing)
    }

    /// Stores the result of a task that was not claimed.
    ///
    /// # Errors
    /// As [`Store::finish`].
    pub fn put(
        &self,
        task_text: &str,
        artifact: Artifact,
        timing: &Timing,
    ) -> Result<(Record, Arc<Artifact>), StoreError> {
        self.store(None, task_text.to_owned(), artifact, timing)
    }

    fn store(
        &self,
        claim: Option<&mut Guard>,
        task_text: String,
        artifact: Artifact,
        timing: &Timing,
    ) -> Result<(Record, Arc<Artifact>), StoreError> {
        let artifact = Arc::new(artifact.canonical());
        let id = ObjectId { content: artifact.content_hash(), key: Key::of(&task_text) };
        let image = hdf5::encode(&artifact, task_text).map_err(StoreError::Unstorable)?;
        let durable = timing.seconds >= object::SYNC_FROM;
        // In a store that is only read the result lives as long as this process.
        let stores = !self.disk.read_only;
        let seal = if stores { write(&self.disk, &id, &image, durable, claim)? } else { Seal::of(&image) };
        let record = self.marked(&id, seal, timing, Arc::clone(&self.origin));
        if stores {
            locked(&self.segments).append(&self.disk, &record, durable)?;
        }
        if let Some(index) = self.index.get() {
            locked(index).add(&record);
            self.settle(&record)?;
        }
        locked(&self.presence).add(&id);
        locked(&self.cache).put(id.content, artifact.clone());
        Ok((record, artifact))
    }

    /// Sets aside the other results of a task that was computed again because its results differed.
    fn settle(&self, record: &Record) -> Result<(), StoreError> {
        let others = self.index.get().map(|index| locked(index).of_task(&record.key)).unwrap_or_default();
        for other in others.iter().filter(|other| other.content != record.content) {
            let id = other.object();
            if object::is_there(&self.disk, &id) {
                self.set_aside(&id, "its task was computed again and gave another result")?;
            }
        }
        locked(&self.contradictions).remove(&record.key);
        Ok(())
    }

    pub(super) fn set_aside(&self, id: &ObjectId, why: &str) -> Result<(), StoreError> {
        locked(&self.presence).remove(id);
        let fault = object::set_aside(&self.disk, &id.folder(), &id.file_name(), why)?;
        locked(&self.damages).push(fault);
        Ok(())
    }

    /// A record of this user's own.
    pub(super) fn marked(&self, id: &ObjectId, seal: Seal, timing: &Timing, origin: Arc<Origin>) -> Record {
        let ObjectId { key, content } = *id;
        let (started, seconds) = (milliseconds(timing.started), timing.seconds);
        let record = Record { key, content, started, seconds, origin, seal, mark: Default::default(), own: true };
        journal::seal(&self.mark, record)
    }
}

/// Writes an object, into the file of its claim if there is one; returns the seal of the file under the object's name.
pub(super) fn write(
    disk: &Disk,
    id: &ObjectId,
    image: &[u8],
    durable: bool,
    mut claim: Option<&mut Guard>,
) -> Result<Seal, StoreError> {
    let (folder, name) = (id.folder(), id.file_name());
    let seal = Seal::of(image);
    for _ in 0..3 {
        let linked = match claim.as_mut().and_then(|claim| claim.draft()) {
            Some(draft) => disk.link_new(draft, (&folder, &name), image, durable)?,
            None => None,
        };
        let written = match linked {
            Some(written) => written,
            // The claim's file belongs to another process now, or there was none.
            None => {
                claim = None;
                disk.write_new(&folder, &name, image, durable)?
            }
        };
        if written {
            return Ok(seal);
        }
        match prove::object(disk, id, None) {
            // Another version of flow may describe the same values differently.
            Ok(proven) => return Ok(proven.seal),
            Err(error) if error.is_missing() => {}
            Err(error) => return Err(error),
        }
    }
    Err(disk.fail("write", &disk.path(&folder, &name), ErrorKind::AlreadyExists.into()))
}
