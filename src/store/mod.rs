//! The store: the folder of results, and the only code that knows HDF5 and the disk.
//!
//! ```text
//! store/
//!   flow.store                  says that flow made this folder                         root.rs
//!   objects/ab/abcd…-0123….h5   one immutable file per task, named by content           object.rs, hdf5.rs
//!   journal/*.journal           task → object, digest, size, provenance                 journal.rs
//!   memo/ab/abcd…               the outcome of a stage                                  memo.rs
//!   runs/N.json                 the record of a campaign                                campaign.rs
//!   locks/*.lock                tasks being computed now                                lock.rs
//!   queue/ID/…                  tasks for the workers of a cluster, and their reports    queue.rs
//!   aside/                      damaged files, set aside
//!   listing-…                   names of the objects, so that the folders need not be listed    presence.rs
//! ```
//!
//! **Invariants**, also after a process was killed: an object has its name only when it is complete; a
//! record is in the journal only when its object has its name. Nothing is overwritten, and nothing is deleted but by gc.
//!
//! **Nothing in a store is believed unproven** (the README says what is left to an attacker). Only `folder.rs` opens files:
//! plain ones, no links, bounded sizes. Records and memos that this user's own flow wrote carry a mark (`mark.rs`) and are
//! believed. Any other is proven from the object (`prove.rs`), whose task text must give the key and whose values the
//! content hash. A lost record is restored from the names of the objects. Of two different results of one task neither is
//! believed: the task is computed again, and the other result is set aside. So a lost, damaged or forged file is restored,
//! computed again or refused, and no clock decides anything.

mod cache;
mod campaign;
mod claim;
mod clean;
mod contents;
mod disk;
mod error;
mod fault;
mod finish;
mod folder;
mod hdf5;
mod journal;
mod located;
mod lock;
mod mark;
mod memo;
mod object;
mod origin;
mod presence;
mod prove;
mod queue;
mod record;
mod remote;
mod root;
mod verify;

pub use campaign::{Campaign, StageRun};
pub use claim::Claim;
pub use clean::{Amount, Swept, Usage};
pub use error::{Damage, StoreError};
pub use hdf5::Hdf5Error;
pub use located::Located;
pub use lock::{Guard, Holder, Waiting};
pub use mark::Mark;
pub use memo::Memo;
pub use object::ObjectId;
pub use origin::Origin;
pub use queue::{LookedAfter, Queue, ReportFile};
pub use record::{Record, Timing};
pub use remote::{Mirrored, Pulled, Pushed, RemoteError, Signing, Trust, mirror};
pub use verify::Verdict;

use crate::artifact::{Artifact, ContentHash, Key};
use cache::Cache;
use disk::Disk;
use journal::{Index, Segments};
use object::Seal;
use presence::Presence;
use prove::Proven;
use record::{milliseconds, moment};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// An open store. All methods take `&self` and may be called from many threads.
pub struct Store {
    disk: Disk,
    mark: Mark,
    machine: String,
    origin: LazyLock<Arc<Origin>, Box<dyn FnOnce() -> Arc<Origin> + Send>>,
    index: OnceLock<Mutex<Index>>,
    segments: Mutex<Segments>,
    cache: Mutex<Cache>,
    presence: Mutex<Presence>,
    damages: Mutex<Vec<Damage>>,
    /// Tasks with two different results, each reported once.
    contradictions: Mutex<HashSet<Key>>,
    in_use: Option<lock::Held>,
}

impl Store {
    /// Opens the store in the folder `root`, and makes it if there is none.
    ///
    /// # Errors
    /// The path is not a folder, or is one that flow has not made; the folder cannot be made or read.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        Self::open_as(root, Mark::of_user())
    }

    /// As [`Store::open`], for a user with another mark.
    ///
    /// # Errors
    /// As [`Store::open`].
    pub fn open_as(root: &Path, mark: Mark) -> Result<Self, StoreError> {
        Self::at(Disk { root: root.to_owned(), read_only: false }, mark)
    }

    /// Opens the store in the folder `root` to read it: nothing is written or moved, and a folder that is not there is an
    /// empty store.
    ///
    /// # Errors
    /// The path is no folder, or one that flow has not made; it cannot be read.
    pub fn open_to_read(root: &Path) -> Result<Self, StoreError> {
        Self::at(Disk { root: root.to_owned(), read_only: true }, Mark::of_user())
    }

    fn at(disk: Disk, mark: Mark) -> Result<Self, StoreError> {
        root::open(&disk)?;
        let in_use = lock::share(&disk);
        Ok(Self {
            disk,
            mark,
            machine: Origin::here().shortened().machine,
            origin: LazyLock::new(Box::new(|| Arc::new(Origin::here()))),
            index: OnceLock::new(),
            segments: Mutex::default(),
            cache: Mutex::default(),
            presence: Mutex::default(),
            damages: Mutex::default(),
            contradictions: Mutex::default(),
            in_use,
        })
    }

    /// Makes a store of the folder of an earlier flow, which has no marker yet.
    ///
    /// # Errors
    /// It holds what flow does not make, or nothing that flow made; it cannot be written.
    pub fn adopt(root: &Path) -> Result<(), StoreError> {
        root::adopt(&Disk { root: root.to_owned(), read_only: false })
    }

    /// Sets the function that gives the origin of results, called when the first result is stored; the default is
    /// [`Origin::here`].
    #[must_use]
    pub fn with_origin(mut self, origin: impl FnOnce() -> Origin + Send + 'static) -> Self {
        self.origin = LazyLock::new(Box::new(|| Arc::new(origin())));
        self
    }

    /// The origin of results that are computed now.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The folder of the store.
    pub fn root(&self) -> &Path {
        &self.disk.root
    }

    /// The record of a finished task whose object is in the store: one that this user's own flow wrote, or one that the
    /// object proves. `None` for a task with two different results, which is to be computed again.
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
            0 | 1 => Ok(sound.pop()),
            _ => {
                locked(&self.contradictions).insert(*key);
                Ok(None)
            }
        }
    }

    /// How long a task took, seconds, as its record says: for estimates, so nothing is proven.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn seconds(&self, key: &Key) -> Result<Option<f64>, StoreError> {
        let records = locked(self.index()?).of_task(key);
        Ok(records.iter().max_by_key(|record| record.own).map(|record| record.seconds))
    }

    /// Whether all these objects are in the store; damage is found when they are read.
    ///
    /// # Errors
    /// The folders cannot be listed.
    pub fn has_all(&self, objects: &[ObjectId]) -> Result<bool, StoreError> {
        let mut presence = locked(&self.presence);
        presence.expect(&self.disk, &self.mark, objects.len())?;
        Ok(objects.iter().all(|object| presence.contains(&self.disk, object)))
    }

    fn has(&self, object: &ObjectId) -> Result<bool, StoreError> {
        self.has_all(&[*object])
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
        for record in locked(self.index()?).with_content(content) {
            match self.read(&record) {
                Ok(proven) => return Ok(self.cached(*content, proven.artifact)),
                Err(error) => failure = error,
            }
        }
        // Its record may be lost, or not be read yet: the name of the object holds the content.
        for name in object::with_content(&self.disk, content) {
            if let Some(proven) = self.if_sound(prove::named(&self.disk, &name))? {
                self.record_again(&proven.id, proven.seal);
                return Ok(self.cached(*content, proven.artifact));
            }
        }
        Err(failure)
    }

    fn cached(&self, content: ContentHash, artifact: Artifact) -> Arc<Artifact> {
        let artifact = Arc::new(artifact);
        locked(&self.cache).put(content, artifact.clone());
        artifact
    }

    /// The text of a finished task, from its object.
    ///
    /// # Errors
    /// As [`Store::get`].
    pub fn task_text(&self, record: &Record) -> Result<String, StoreError> {
        Ok(self.read(record)?.text)
    }

    /// The memo of a stage that this user's own flow made. Its objects may have been removed: ask [`Store::has_all`].
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn memo(&self, stage: &Key) -> Result<Option<Memo>, StoreError> {
        memo::read(&self.disk, &self.mark, stage)
    }

    /// Writes the memo of a stage, which replaces an earlier one.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn keep_memo(&self, stage: &Key, memo: &Memo) -> Result<(), StoreError> {
        memo::write(&self.disk, &self.mark, stage, memo)
    }

    /// Records a campaign and returns its number.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn record_campaign(&self, campaign: &Campaign) -> Result<u64, StoreError> {
        campaign::record(&self.disk, &self.mark, campaign)
    }

    /// Numbers of the recorded campaigns, the last one last.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn campaigns(&self) -> Result<Vec<u64>, StoreError> {
        campaign::numbers(&self.disk)
    }

    /// A recorded campaign; its field `own` says whether this user's own flow recorded it.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn campaign(&self, number: u64) -> Result<Option<Campaign>, StoreError> {
        campaign::read(&self.disk, &self.mark, number)
    }

    /// All records, in the order of their keys.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn records(&self) -> Result<Vec<Record>, StoreError> {
        Ok(locked(self.index()?).records())
    }

    /// The path of an object's file, which need not exist.
    pub fn path(&self, object: &ObjectId) -> PathBuf {
        object::path(&self.disk, object)
    }

    /// The damaged files found since the last call, for the report of a run.
    pub fn take_damages(&self) -> Vec<Damage> {
        std::mem::take(&mut locked(&self.damages))
    }

    /// Reads and proves the object of a record.
    fn read(&self, record: &Record) -> Result<Proven, StoreError> {
        let id = record.object();
        let seal = record.own.then_some(&record.seal);
        self.noted(&id, prove::object(&self.disk, &id, seal))
    }

    /// Another user's record as an own one, if its object proves it.
    fn proven(&self, record: &Record) -> Result<Option<Record>, StoreError> {
        Ok(self.if_sound(self.read(record))?.map(|proven| self.own(record, proven.seal)))
    }

    /// Another user's record, whose object was proven just now, as an own one.
    fn own(&self, record: &Record, seal: Seal) -> Record {
        let timing = Timing { started: moment(record.started), seconds: record.seconds };
        self.remember(self.marked(&record.object(), seal, &timing, record.origin.clone()))
    }

    /// A new record of an object that had none.
    fn record_again(&self, id: &ObjectId, seal: Seal) -> Record {
        let timing = Timing { started: UNIX_EPOCH, seconds: 0.0 };
        self.remember(self.marked(id, seal, &timing, Arc::default()))
    }

    /// Records what was proven, so that it need not be proven again. Where the store cannot be written, only this process
    /// knows it.
    fn remember(&self, record: Record) -> Record {
        let _ = locked(&self.segments).append(&self.disk, &record, false);
        if let Some(index) = self.index.get() {
            locked(index).add(&record);
        }
        locked(&self.presence).add(&record.object());
        record
    }

    /// Collects the damage that was found when an object was read.
    fn noted<T>(&self, id: &ObjectId, result: Result<T, StoreError>) -> Result<T, StoreError> {
        if let Err(error) = &result {
            if let StoreError::Damaged { fault } = error {
                locked(&self.damages).push(fault.clone());
            }
            locked(&self.presence).remove(id);
        }
        result
    }

    /// `None` for an object that is missing or damaged; any other error is passed on.
    fn if_sound<T>(&self, result: Result<T, StoreError>) -> Result<Option<T>, StoreError> {
        match result {
            Ok(sound) => Ok(Some(sound)),
            Err(StoreError::Missing { .. } | StoreError::Damaged { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The journals, read at the first call.
    fn index(&self) -> Result<&Mutex<Index>, StoreError> {
        if let Some(index) = self.index.get() {
            return Ok(index);
        }
        // Records that this process appends meanwhile are read from its own segment or added twice, with the same result.
        let mut index = self.new_index();
        index.refresh(&self.disk, &locked(&self.segments))?;
        Ok(self.index.get_or_init(|| Mutex::new(index)))
    }

    fn new_index(&self) -> Index {
        Index::new(self.mark.clone(), &self.machine)
    }

    /// Reads what other processes have recorded since.
    ///
    /// # Errors
    /// The journals cannot be read.
    pub fn refresh(&self) -> Result<(), StoreError> {
        let index = self.index()?;
        let segments = locked(&self.segments);
        locked(index).refresh(&self.disk, &segments)
    }
}

/// Locks, also after a thread panicked with the lock: each change is complete, so the value is valid.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_ms() -> i64 {
    milliseconds(SystemTime::now())
}

#[cfg(test)]
mod tests;
