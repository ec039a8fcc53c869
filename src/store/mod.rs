//! The store: the folder that keeps results, and the only code that knows HDF5 and the disk.
//!
//! ```text
//! store/
//!   flow.store                  says that flow made this folder                         root.rs
//!   objects/ab/abcd…-0123….h5   one immutable file per task, named by content           object.rs, hdf5.rs
//!   journal/*.journal           task → object, digest, size, provenance                 journal.rs
//!   memo/ab/abcd…               what a stage came to                                    memo.rs
//!   runs/N.json                 what a campaign did                                     campaign.rs
//!   locks/*.lock                tasks being computed now                                lock.rs
//!   queue/ID/…                  tasks for the workers of a cluster, and their reports    queue.rs
//!   remote/                     segments of far remotes, and which remote is attached    remote.rs, attached.rs
//!   aside/                      damaged files that were found and replaced
//!   listing-…                   names of the objects, so that the folders need not be listed    presence.rs
//! ```
//!
//! **What holds at any moment**, also after a process was killed: an object has its name only when it is complete; a
//! record is in the journal only when its object has its name. Nothing is overwritten, and nothing is deleted but by gc.
//!
//! **A store is somebody else's until proven** (the README says what is left to an attacker). Files are reached by
//! `folder.rs` alone: plain ones, no links, bounded sizes. Records and notes that this user's own flow wrote carry a mark
//! (`mark.rs`) and are believed; what does not is proven from the object (`prove.rs`), whose task text must give the key
//! and whose values the content hash. A lost record is found again by the names of the objects. Of two different results
//! of one task none is believed: it is computed again, and the other goes aside. So whatever is lost, damaged or forged is
//! found, computed again or refused, and no clock decides anything.

mod attached;
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
#[cfg(any(test, fuzzing))]
pub mod hostile;
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
mod read;
mod record;
mod remote;
mod root;
mod verify;

pub use attached::Attachment;
pub use campaign::{Campaign, StageRun};
pub use claim::Claim;
pub use clean::{Amount, Swept, Usage};
pub use error::{Aside, Damage, StoreError};
pub use hdf5::Hdf5Error;
pub use located::Located;
pub use lock::{Guard, Holder, Waiting};
pub use mark::{Mark, MarkFault};
pub use memo::{Memo, MemoDraft};
pub use object::ObjectId;
pub use origin::Origin;
pub use queue::{LookedAfter, MOST_NEWS, Queue, ReportFile};
pub use record::{Record, Timing};
pub use remote::{Address, Mirrored, Pulled, Pushed, RemoteError, Signing, Trust, mirror};
pub use verify::Verdict;

use crate::artifact::Key;
use attached::Attached;
use cache::Cache;
use disk::Disk;
use journal::{Index, Segments};
use presence::Presence;
use record::milliseconds;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

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
    /// Tasks with two different results, each said once.
    contradictions: Mutex<HashSet<Key>>,
    attached: OnceLock<Option<Mutex<Attached>>>,
    in_use: Option<lock::Held>,
}

impl Store {
    /// Opens the store in the folder `root`, which is made if there is none.
    ///
    /// # Errors
    /// The path is no folder, or one that flow has not made; it cannot be made or read.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        Self::open_as(root, Mark::of_user())
    }

    /// As [`Store::open`], for the user with this mark.
    ///
    /// # Errors
    /// As [`Store::open`].
    pub fn open_as(root: &Path, mark: Mark) -> Result<Self, StoreError> {
        Self::at(Disk { root: root.to_owned(), read_only: false }, mark)
    }

    /// Opens the store in the folder `root` to read it. The user's own is opened as ever: it takes what reading finds, such as
    /// a damaged object or an answer that was asked for. In one of another owner, or one that cannot be written, nothing is
    /// written or moved. A folder that is not there is an empty store.
    ///
    /// # Errors
    /// The path is no folder, or one that flow has not made; it cannot be read.
    pub fn open_to_read(root: &Path) -> Result<Self, StoreError> {
        let read_only = !root::is_own(root);
        Self::at(Disk { root: root.to_owned(), read_only }, Mark::of_user())
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
            attached: OnceLock::new(),
            in_use,
        })
    }

    /// Makes the folder of an earlier flow, which has no marker yet, a store.
    ///
    /// # Errors
    /// It holds what flow does not make, or nothing that flow made; it cannot be written.
    pub fn adopt(root: &Path) -> Result<(), StoreError> {
        root::adopt(&Disk { root: root.to_owned(), read_only: false })
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

    /// The memo of a stage that this user's own flow made. Its objects may be gone: ask [`Store::has_all`].
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn memo(&self, stage: &Key) -> Result<Option<Memo>, StoreError> {
        memo::read(&self.disk, &self.mark, stage)
    }

    /// Keeps the memo of a stage, in place of an earlier one.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn keep_memo<'a>(&self, stage: &Key, memo: impl Into<MemoDraft<'a>>) -> Result<(), StoreError> {
        memo::write(&self.disk, &self.mark, stage, memo.into())
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

    /// A recorded campaign; whether this user's own flow recorded it is said in it.
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

    /// The file of an object, whether it is there or not.
    pub fn path(&self, object: &ObjectId) -> PathBuf {
        object::path(&self.disk, object)
    }

    /// The damaged files found since the last call, for the report of a run.
    pub fn take_damages(&self) -> Vec<Damage> {
        std::mem::take(&mut locked(&self.damages))
    }

    /// The journals, read when they are first asked for.
    fn index(&self) -> Result<&Mutex<Index>, StoreError> {
        if let Some(index) = self.index.get() {
            return Ok(index);
        }
        // Records that this process appends meanwhile are read from its own segment, or added twice, which is the same.
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

/// Locks; a thread that panicked while it held the lock has left the value as it was before or after one change.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_ms() -> i64 {
    milliseconds(SystemTime::now())
}

#[cfg(test)]
mod tests;
