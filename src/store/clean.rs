//! Keeping the store in order: what may go, what it takes.
//!
//! Only what flow has written is touched: a plain file of a name that flow gives, in a folder that flow makes, that begins
//! as flow's files do. Folders are reached without links, so nothing outside of the store is reached at all.
//!
//! Nothing is removed from a store that another process uses: every process shares a lock while it has the store open,
//! and gc wants it alone. Where the file system has no locks, objects younger than a day are kept.

use super::disk::{Disk, is_temporary};
use super::folder::{Entry, Folder};
use super::presence::{self, short_of_name};
use super::{Store, StoreError, journal, lock, locked, memo, object, queue, root, verify};
use crate::artifact::Key;
use std::collections::HashSet;

/// Files of one sort: how many, and their size together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// How many.
    pub files: u64,
    /// Their size together, bytes.
    pub bytes: u64,
}

impl Amount {
    pub(super) fn add(&mut self, bytes: u64) {
        self.files += 1;
        self.bytes += bytes;
    }
}

/// What the store takes on the disk.
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

/// What gc removed, or would remove.
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

/// Something that lies in the store.
pub(super) struct Place<'a> {
    /// Its folder, open.
    pub(super) at: &'a Folder,
    /// The folder below the root.
    pub(super) folder: &'a str,
    pub(super) name: &'a str,
    pub(super) entry: Entry,
}

impl Place<'_> {
    /// Whether flow has written it.
    pub(super) fn is_ours(&self) -> bool {
        verify::is_ours(self)
    }

    fn bytes(&self) -> u64 {
        match self.entry {
            Entry::File(bytes) => bytes,
            Entry::Folder | Entry::Strange => 0,
        }
    }
}

/// Objects that were written this many seconds ago may belong to a run that goes on, where no lock tells.
const GRACE: i64 = 86_400;

impl Store {
    /// What the store takes on the disk, of what flow has written.
    ///
    /// # Errors
    /// The store cannot be listed.
    pub fn usage(&self) -> Result<Usage, StoreError> {
        let mut usage = Usage::default();
        walk(&self.disk, &mut |place| {
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
    /// leftovers, and merges the journal. Without `really` it only says what it would remove.
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
        let mut swept = Swept::default();
        let mut doomed: Vec<(String, String)> = Vec::new();
        // Names hold the first bytes of a key: an object goes only if no reachable key begins like that.
        let starts: HashSet<u64> = reachable.iter().map(|key| presence::first_word(&key.0)).collect();
        // By the clock of the file system, on which the objects have their times.
        let now = if grace { self.disk.draft("", 0o444)?.file_time() } else { None };
        let is_young = |place: &Place<'_>| {
            let age = now.zip(place.at.modified(place.name)).map(|(now, written)| now.saturating_sub(written));
            grace && age.is_none_or(|age| age < GRACE)
        };
        walk(&self.disk, &mut |place| {
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
    /// whole before the old ones go, so a kill in between costs nothing: a record that stands twice counts once.
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

    /// Whether all that a memo rests on stays; another user's memo stays, because only that user can read it.
    fn memo_is_reachable(&self, place: &Place<'_>, reachable: &HashSet<Key>) -> bool {
        if !place.name.ends_with(&format!("-{}", self.mark.name())) {
            return place.name.contains('-');
        }
        let memo = memo::key_of(place.name).zip(place.at.read(place.name, memo::MOST).ok());
        let memo = memo.and_then(|(key, bytes)| memo::unpack(&self.mark, &key, &bytes));
        memo.is_some_and(|memo| memo.objects.iter().all(|object| reachable.contains(&object.key)))
    }
}

/// Calls `visit` with all that lies in the folders that flow makes; other folders are not entered.
pub(super) fn walk(disk: &Disk, visit: &mut impl FnMut(Place<'_>)) -> Result<(), StoreError> {
    let fail = |error| disk.fail("list", &disk.root, error);
    enter(&disk.folder("").map_err(fail)?, "", visit).map_err(fail)
}

fn enter(at: &Folder, folder: &str, visit: &mut impl FnMut(Place<'_>)) -> std::io::Result<()> {
    let mut names = Vec::new();
    at.list(|name, _| names.push(name.to_owned()))?;
    names.sort_unstable();
    for name in names {
        let Ok(entry) = at.entry(&name) else { continue };
        if entry == Entry::Folder && root::is_folder(folder, &name) {
            let inside = if folder.is_empty() { name } else { format!("{folder}/{name}") };
            if let Ok(inner) = at.inner(inside.rsplit('/').next().unwrap_or_default()) {
                enter(&inner, &inside, visit)?;
            }
        } else {
            visit(Place { at, folder, name: &name, entry });
        }
    }
    Ok(())
}
