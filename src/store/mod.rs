//! The store: the folder that keeps results, and the only code that knows HDF5 and the disk.
//!
//! ```text
//! store/
//!   objects/ab/abcd…-0123….h5   one immutable file per task, named by content       object.rs, hdf5.rs
//!   journal/*.journal           task → object, digest, size, provenance             journal.rs
//!   memo/ab/abcd…               what a stage came to                                memo.rs
//!   runs/N.json                 what a campaign did                                 campaign.rs
//!   locks/*.lock                tasks being computed now                            lock.rs
//!   aside/                      damaged files that were found and replaced
//!   listing                     names of the objects, so that the folders need not be listed    presence.rs
//! ```
//!
//! **What holds at any moment**, also after a process was killed: an object has its name only when it is complete; a
//! record is in the journal only when its object has its name; what a record says is checked against the object before
//! it is believed. So whatever is lost or damaged is computed again, and nothing wrong is ever handed out. Nothing is
//! overwritten, and nothing is deleted but by gc.

mod cache;
mod campaign;
mod clean;
mod disk;
mod error;
mod hdf5;
mod journal;
mod lock;
mod memo;
mod object;
mod origin;
mod presence;

pub use campaign::{Campaign, StageRun};
pub use clean::{Amount, Swept, Usage, Verdict};
pub use error::{Damage, StoreError};
pub use hdf5::Hdf5Error;
pub use lock::{Guard, Holder, Waiting};
pub use memo::Memo;
pub use object::ObjectId;
pub use origin::Origin;

use crate::artifact::{Artifact, ContentHash, Key};
use cache::Cache;
use disk::Disk;
use journal::{Index, Segment};
use object::Seal;
use presence::Presence;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// What the journal says about a finished task.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The task.
    pub key: Key,
    /// Its result.
    pub content: ContentHash,
    /// Start of the task, milliseconds since 1970 UTC.
    pub started: i64,
    /// Duration of the task, seconds.
    pub seconds: f64,
    /// Where and by what it was computed.
    pub origin: Arc<Origin>,
    seal: Seal,
}

impl Record {
    /// The object that holds the result.
    pub fn object(&self) -> ObjectId {
        ObjectId { content: self.content, key: self.key }
    }

    /// Size of the object's file, bytes.
    pub fn bytes(&self) -> u64 {
        self.seal.size
    }
}

/// When a task ran.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Its start.
    pub started: SystemTime,
    /// Its duration, seconds.
    pub seconds: f64,
}

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

/// An open store. All methods take `&self` and may be called from many threads.
pub struct Store {
    disk: Disk,
    origin: LazyLock<Arc<Origin>, Box<dyn FnOnce() -> Arc<Origin> + Send>>,
    index: OnceLock<Mutex<Index>>,
    segment: Mutex<Segment>,
    cache: Mutex<Cache>,
    presence: Mutex<Presence>,
    damages: Mutex<Vec<Damage>>,
    in_use: Option<lock::Held>,
}

impl Store {
    /// Opens the store in the folder `root`, which is made if there is none.
    ///
    /// # Errors
    /// The path is not a folder, or cannot be made or read.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        let disk = Disk { root: root.to_owned() };
        if !root.is_dir() {
            create(&disk)?;
        }
        let in_use = lock::share(&disk);
        Ok(Self {
            disk,
            origin: LazyLock::new(Box::new(|| Arc::new(Origin::here()))),
            index: OnceLock::new(),
            segment: Mutex::default(),
            cache: Mutex::default(),
            presence: Mutex::default(),
            damages: Mutex::default(),
            in_use,
        })
    }

    /// Says where and by what results are computed, asked when the first is; without it [`Origin::here`] is taken.
    #[must_use]
    pub fn with_origin(mut self, origin: impl FnOnce() -> Origin + Send + 'static) -> Self {
        self.origin = LazyLock::new(Box::new(|| Arc::new(origin())));
        self
    }

    /// Where and by what results are computed now.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The folder of the store.
    pub fn root(&self) -> &Path {
        &self.disk.root
    }

    /// The record of a finished task whose object is in the store.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn find(&self, key: &Key) -> Result<Option<Record>, StoreError> {
        let Some(record) = locked(self.index()?).find(key) else { return Ok(None) };
        Ok(self.has_all(&[record.object()])?.then_some(record))
    }

    /// Whether all these objects are in the store; that they are sound is seen when they are read.
    ///
    /// # Errors
    /// The folders cannot be listed.
    pub fn has_all(&self, objects: &[ObjectId]) -> Result<bool, StoreError> {
        let mut presence = locked(&self.presence);
        presence.expect(&self.disk, objects.len())?;
        Ok(objects.iter().all(|object| presence.contains(&self.disk, object)))
    }

    /// The artifact with this content.
    ///
    /// # Errors
    /// [`StoreError::Missing`] or [`StoreError::Damaged`] (see [`StoreError::is_missing`]): compute it again. Any
    /// other: the store cannot be read.
    pub fn get(&self, content: &ContentHash) -> Result<Arc<Artifact>, StoreError> {
        if let Some(artifact) = locked(&self.cache).get(content) {
            return Ok(artifact);
        }
        let mut failure = StoreError::Missing { content: *content };
        let mut records = locked(self.index()?).with_content(content);
        if records.is_empty() {
            // Another process may have recorded it since the journals were read.
            self.refresh()?;
            records = locked(self.index()?).with_content(content);
        }
        for record in records {
            match self.read(&record) {
                Ok((artifact, _)) => {
                    let artifact = Arc::new(artifact);
                    locked(&self.cache).put(*content, artifact.clone());
                    return Ok(artifact);
                }
                Err(error) => failure = error,
            }
        }
        Err(failure)
    }

    /// The text of a finished task, from its object.
    ///
    /// # Errors
    /// As [`Store::get`].
    pub fn task_text(&self, record: &Record) -> Result<String, StoreError> {
        let image = self.image(record)?;
        hdf5::task_text(image).map_err(|why| self.unreadable(record, why))
    }

    /// Stores the result of a claimed task and releases it. When the function returns, the result can be found.
    ///
    /// # Errors
    /// The result cannot be held by a file, or the disk refuses it.
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
        let seal = object::write(&self.disk, &id, &image, durable, claim)?;
        let record = Record {
            key: id.key,
            content: id.content,
            seal,
            started: milliseconds(timing.started),
            seconds: timing.seconds,
            origin: Arc::clone(&self.origin),
        };
        locked(&self.segment).append(&self.disk, &record, durable)?;
        if let Some(index) = self.index.get() {
            locked(index).add(&record);
        }
        locked(&self.presence).add(&id);
        locked(&self.cache).put(id.content, artifact.clone());
        Ok((record, artifact))
    }

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
        match lock::take(&self.disk, &key.to_string(), &self.origin.machine)? {
            lock::Taken::Theirs(waiting) => Ok(Claim::Theirs(waiting)),
            lock::Taken::Mine(guard) => {
                // Its last holder recorded the result before it let go.
                self.refresh()?;
                let found = if again { None } else { self.find(key)? };
                Ok(found.map_or(Claim::Mine(guard), Claim::Done))
            }
        }
    }

    /// The memo of a stage. Its objects may be gone: ask [`Store::has_all`].
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn memo(&self, stage: &Key) -> Result<Option<Memo>, StoreError> {
        memo::read(&self.disk, stage)
    }

    /// Keeps the memo of a stage, in place of an earlier one.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn keep_memo(&self, stage: &Key, memo: &Memo) -> Result<(), StoreError> {
        memo::write(&self.disk, stage, memo)
    }

    /// Records a campaign and returns its number.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn record_campaign(&self, campaign: &Campaign) -> Result<u64, StoreError> {
        campaign::record(&self.disk, campaign)
    }

    /// Numbers of the recorded campaigns, the last one last.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn campaigns(&self) -> Result<Vec<u64>, StoreError> {
        campaign::numbers(&self.disk)
    }

    /// A recorded campaign.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn campaign(&self, number: u64) -> Result<Option<Campaign>, StoreError> {
        campaign::read(&self.disk, number)
    }

    /// All records, in the order of their keys.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn records(&self) -> Result<Vec<Record>, StoreError> {
        Ok(locked(self.index()?).records())
    }

    /// The file of an object, whether it is there or not.
    pub fn path(&self, object: &ObjectId) -> PathBuf {
        object::path(&self.disk, object)
    }

    /// The damaged files found since the last call, for the report of a run.
    pub fn take_damages(&self) -> Vec<Damage> {
        std::mem::take(&mut locked(&self.damages))
    }

    fn read(&self, record: &Record) -> Result<(Artifact, String), StoreError> {
        let image = self.image(record)?;
        hdf5::decode(image).map_err(|why| self.unreadable(record, why))
    }

    fn image(&self, record: &Record) -> Result<Vec<u8>, StoreError> {
        let image = object::read(&self.disk, &record.object(), &record.seal);
        if let Err(StoreError::Damaged { fault }) = &image {
            locked(&self.damages).push(fault.clone());
        }
        if image.is_err() {
            locked(&self.presence).remove(&record.object());
        }
        image
    }

    /// An object with the right digest that cannot be read.
    fn unreadable(&self, record: &Record, why: Hdf5Error) -> StoreError {
        let path = self.path(&record.object());
        if matches!(why, Hdf5Error::Newer { .. }) {
            return StoreError::Newer { path, why };
        }
        self.set_aside(&record.object(), &why.to_string())
    }

    /// Moves a damaged object out of the way and reports it.
    fn set_aside(&self, object: &ObjectId, why: &str) -> StoreError {
        locked(&self.presence).remove(object);
        match object::set_aside(&self.disk, &self.path(object), why) {
            Ok(fault) => {
                locked(&self.damages).push(fault.clone());
                StoreError::Damaged { fault }
            }
            Err(error) => error,
        }
    }

    /// The journals, read when they are first asked for.
    fn index(&self) -> Result<&Mutex<Index>, StoreError> {
        if let Some(index) = self.index.get() {
            return Ok(index);
        }
        // Records that this process appends meanwhile are read from its own segment, or added twice, which is the same.
        let mut index = Index::default();
        let segment = locked(&self.segment);
        index.refresh(&self.disk, segment.name())?;
        Ok(self.index.get_or_init(|| Mutex::new(index)))
    }

    /// Reads what other processes have recorded since.
    fn refresh(&self) -> Result<(), StoreError> {
        let own = locked(&self.segment).name().map(OsStr::to_owned);
        locked(self.index()?).refresh(&self.disk, own.as_deref())
    }
}

/// Makes the folder of a new store, with a note that keeps its files out of version control.
fn create(disk: &Disk) -> Result<(), StoreError> {
    let root = &disk.root;
    if root.exists() {
        return Err(StoreError::NotAStore { path: root.clone(), why: "it is not a folder".to_owned() });
    }
    std::fs::create_dir_all(root).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotADirectory => {
            StoreError::NotAStore { path: root.clone(), why: "a part of the path is a file".to_owned() }
        }
        // The folder that is missing cannot have vanished.
        _ => StoreError::io("make the folder", root, Path::new("/"), error),
    })?;
    disk.replace(&root.join(".gitignore"), b"*\n")
}

/// Locks; a thread that panicked while it held the lock has left the value as it was before or after one change.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn milliseconds(time: SystemTime) -> i64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis() as i64)
}

fn now_ms() -> i64 {
    milliseconds(SystemTime::now())
}

#[cfg(test)]
mod tests;
