//! Garbage collection: what may be removed, and the room that the store takes.
//!
//! Only files that flow has written are removed: plain files with a name that flow gives, in a folder that flow makes, that
//! begin as flow's files do. Folders are opened without following links, so nothing outside of the store can be reached.
//!
//! Nothing is removed from a store that another process uses: every process shares a lock while it has the store open,
//! and gc takes that lock exclusively. Where the file system has no locks, objects younger than a day stay.

use super::disk::is_temporary;
use super::presence::{self, short_of_name};
use super::{Store, StoreError, contents, journal, lock, locked, memo, object, queue};
use crate::artifact::Key;
use std::collections::HashSet;

/// Number and total size of files of one sort.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// Number of files.
    pub files: u64,
    /// Total size, bytes.
    pub bytes: u64,
}

impl Amount {
    pub(super) fn add(&mut self, bytes: u64) {
        self.files += 1;
        self.bytes += bytes;
    }
}

/// Disk space that the store takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Results.
    pub objects: Amount,
    /// Damaged files that were set aside.
    pub aside: Amount,
    /// Leftovers of processes that were killed while they wrote.
    pub temporary: Amount,
    /// Journal segments.
    pub journal: Amount,
    /// Memos of stages.
    pub memos: Amount,
    /// Records of campaigns.
    pub runs: Amount,
}

/// Files that gc removed, or would remove.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    /// Results that are reachable.
    pub kept: Amount,
    /// Results that are not.
    pub removed: Amount,
    /// Memos that rest on results that are not.
    pub memos: Amount,
    /// Damaged files, and leftovers of processes that were killed.
    pub rubbish: Amount,
    /// Journal segments before.
    pub segments: u64,
}

/// Where no lock shows it, objects that were written less than this many seconds ago may belong to a process that still runs.
const GRACE: i64 = 86_400;

impl Store {
    /// Disk space that the files of flow take in the store.
    ///
    /// # Errors
    /// The store cannot be listed.
    pub fn usage(&self) -> Result<Usage, StoreError> {
        let mut usage = Usage::default();
        contents::walk(&self.disk, &mut |place| {
            if !place.is_ours() {
                return;
            }
            let amount = match place.folder.split('/').next().unwrap_or_default() {
                _ if is_temporary(place.name) => &mut usage.temporary,
                "objects" => &mut usage.objects,
                object::ASIDE => &mut usage.aside,
                journal::FOLDER => &mut usage.journal,
                memo::FOLDER => &mut usage.memos,
                super::campaign::FOLDER => &mut usage.runs,
                _ => return,
            };
            amount.add(place.bytes());
        })?;
        Ok(usage)
    }

    /// Removes the results of all tasks that are not in `reachable`, memos that rest on them, damaged files and
    /// leftovers, and merges the journal. Without `really` it removes nothing and returns what it would remove.
    ///
    /// # Errors
    /// [`StoreError::InUse`] when another process has the store open; the store cannot be read or written.
    pub fn sweep(&self, reachable: &HashSet<Key>, really: bool) -> Result<Swept, StoreError> {
        if !really {
            return self.sweep_alone(reachable, false, false);
        }
        let Some(lock::Held(lock)) = &self.in_use else {
            return self.sweep_alone(reachable, true, true);
        };
        if lock.try_lock().is_err() {
            let _ = lock.lock_shared();
            return Err(StoreError::InUse { root: self.disk.root.clone() });
        }
        let swept = self.sweep_alone(reachable, true, false);
        let _ = lock.lock_shared();
        swept
    }

    fn sweep_alone(&self, reachable: &HashSet<Key>, really: bool, grace: bool) -> Result<Swept, StoreError> {
        for (name, shard) in object::open_shards(&self.disk)? {
            let listed = shard.list(|_, _| {});
            listed.map_err(|error| self.disk.fail("list", &self.disk.root.join(&name), error))?;
        }
        let mut swept = Swept::default();
        let mut doomed: Vec<(String, String)> = Vec::new();
        // Names hold the first bytes of a key: an object goes only if no reachable key begins like that.
        let starts: HashSet<u64> = reachable.iter().map(|key| presence::first_word(&key.0)).collect();
        // By the clock of the file system, as the times of the objects are.
        let now = if grace { self.disk.draft("", 0o444)?.file_time() } else { None };
        let is_young = |place: &contents::Place<'_>| {
            let age = now.zip(place.at.modified(place.name)).map(|(now, written)| now.saturating_sub(written));
            grace && age.is_none_or(|age| age < GRACE)
        };
        contents::walk(&self.disk, &mut |place| {
            if !place.is_ours() {
                return;
            }
            let amount = match place.folder.split('/').next().unwrap_or_default() {
                _ if is_temporary(place.name) && !is_young(&place) => &mut swept.rubbish,
                "objects" => match short_of_name(place.name) {
                    Some([_, start]) if !starts.contains(&start) && !is_young(&place) => &mut swept.removed,
                    _ => return swept.kept.add(place.bytes()),
                },
                object::ASIDE | lock::FOLDER | queue::FOLDER => &mut swept.rubbish,
                memo::FOLDER if !self.memo_is_reachable(&place, reachable) => &mut swept.memos,
                journal::FOLDER => {
                    swept.segments += 1;
                    return;
                }
                _ => return,
            };
            amount.add(place.bytes());
            doomed.push((place.folder.to_owned(), place.name.to_owned()));
        })?;
        if really {
            for (folder, name) in doomed {
                self.disk.remove(&folder, &name)?;
            }
            self.remove_empty_queues();
            self.compact()?;
        }
        Ok(swept)
    }

    /// Merges all segments into one per origin, without the records whose objects are gone. The new segments are
    /// complete before the old ones are removed, so a kill in between loses nothing: a record that stands twice counts once.
    fn compact(&self) -> Result<(), StoreError> {
        let mut segments = locked(&self.segments);
        let mut index = self.new_index();
        index.refresh(&self.disk, &Default::default())?;
        let old = index.segments();
        let mut records = index.marked_records();
        records.retain(|record| object::is_there(&self.disk, &record.object()));
        for same in records.chunk_by(|a, b| a.origin == b.origin) {
            journal::write_segment(&self.disk, same)?;
        }
        *segments = Default::default();
        for name in old {
            self.disk.remove(journal::FOLDER, &name)?;
        }
        *locked(&self.presence) = Default::default();
        let mut index = self.new_index();
        index.refresh(&self.disk, &segments)?;
        drop(segments);
        *locked(self.index()?) = index;
        Ok(())
    }

    /// Whether all objects that a memo names stay. Another user's memo stays, because only that user can read it.
    fn memo_is_reachable(&self, place: &contents::Place<'_>, reachable: &HashSet<Key>) -> bool {
        if !place.name.ends_with(&format!("-{}", self.mark.name())) {
            return place.name.contains('-');
        }
        let memo = memo::key_of(place.name).zip(place.at.read(place.name, memo::MOST).ok());
        let memo = memo.and_then(|(key, bytes)| memo::unpack(&self.mark, &key, &bytes));
        memo.is_some_and(|memo| memo.objects.iter().all(|object| reachable.contains(&object.key)))
    }
}
