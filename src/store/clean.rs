//! Keeping the store in order: what may go, what is damaged, what it takes.
//!
//! Nothing is removed from a store that another process uses: every process shares a lock while it has the store open,
//! and gc wants it alone. Where the file system has no locks, objects younger than a day are kept.

use super::disk::{Disk, TEMPORARY};
use super::object;
use super::presence::{self, short_of_name};
use super::{Damage, Index, Record, Store, StoreError, Timing, hdf5, journal, lock, locked, memo};
use crate::artifact::{Artifact, ContentHash, Key};
use rayon::prelude::*;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Files of one sort: how many, and their size together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// How many.
    pub files: u64,
    /// Their size together, bytes.
    pub bytes: u64,
}

impl Amount {
    fn add(&mut self, bytes: u64) {
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
    /// Results that are not, and old memos.
    pub removed: Amount,
    /// Damaged files, and leftovers of processes that were killed.
    pub rubbish: Amount,
    /// Journal segments before.
    pub segments: u64,
}

/// What verify found.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Results that are what their records say.
    pub sound: Amount,
    /// Objects that were not, and were set aside.
    pub damages: Vec<Damage>,
    /// Records whose object is not there.
    pub missing: Vec<Key>,
    /// Sound objects without a record, which have been recorded again.
    pub adopted: Vec<Key>,
    /// Records of the journal that could not be read.
    pub lost_records: usize,
    /// Tasks that gave two different results: they depend on something that is not in their key.
    pub contradictions: Vec<(Key, ContentHash, ContentHash)>,
}

impl Store {
    /// What the store takes on the disk.
    ///
    /// # Errors
    /// The store cannot be listed.
    pub fn usage(&self) -> Result<Usage, StoreError> {
        let mut usage = Usage::default();
        walk(&self.disk, "objects", &mut |path, bytes| match is_temporary(path) {
            true => usage.temporary.add(bytes),
            false => usage.objects.add(bytes),
        });
        for (folder, amount) in [
            ("aside", &mut usage.aside),
            ("journal", &mut usage.journal),
            ("memo", &mut usage.memos),
            ("runs", &mut usage.runs),
        ] {
            walk(&self.disk, folder, &mut |path, bytes| match is_temporary(path) {
                true => usage.temporary.add(bytes),
                false => amount.add(bytes),
            });
        }
        Ok(usage)
    }

    /// Removes the results of all tasks that are not in `reachable`, memos that rest on them, damaged files and
    /// leftovers, and merges the journal. Without `really` it only says what it would remove.
    ///
    /// # Errors
    /// [`StoreError::InUse`] when another process has the store open; the store cannot be read or written.
    pub fn sweep(&self, reachable: &HashSet<Key>, really: bool) -> Result<Swept, StoreError> {
        if !really {
            return self.sweep_alone(reachable, false, Duration::ZERO);
        }
        let Some(lock::Held(lock)) = &self.in_use else {
            return self.sweep_alone(reachable, true, Duration::from_secs(86_400));
        };
        if lock.try_lock().is_err() {
            let _ = lock.lock_shared();
            return Err(StoreError::InUse { root: self.disk.root.clone() });
        }
        let swept = self.sweep_alone(reachable, true, Duration::ZERO);
        let _ = lock.lock_shared();
        swept
    }

    fn sweep_alone(&self, reachable: &HashSet<Key>, really: bool, grace: Duration) -> Result<Swept, StoreError> {
        let mut swept = Swept::default();
        let mut doomed = Vec::new();
        // Names hold the first bytes of a key: an object goes only if no reachable key begins like that.
        let starts: HashSet<u64> = reachable.iter().map(|key| presence::first_word(&key.0)).collect();
        object::list(&self.disk, |folder, name| {
            let path = folder.join(name);
            let Ok(metadata) = fs::metadata(&path) else { return };
            let amount = match short_of_name(name) {
                Some([_, start]) if starts.contains(&start) || is_young(&metadata, grace) => {
                    return swept.kept.add(metadata.len());
                }
                Some(_) => &mut swept.removed,
                None => &mut swept.rubbish,
            };
            amount.add(metadata.len());
            doomed.push(path);
        })?;
        for folder in ["aside", "memo", "journal", "runs", "locks"] {
            let all = folder == "aside" || folder == "locks";
            walk(&self.disk, folder, &mut |path, bytes| {
                if all || is_temporary(path) {
                    swept.rubbish.add(bytes);
                    doomed.push(path.to_owned());
                } else if folder == "memo" && !memo_is_reachable(path, reachable) {
                    swept.removed.add(bytes);
                    doomed.push(path.to_owned());
                }
            });
        }
        walk(&self.disk, "journal", &mut |path, _| swept.segments += u64::from(!is_temporary(path)));
        if really {
            for path in doomed {
                self.disk.remove(&path)?;
            }
            self.compact()?;
        }
        Ok(swept)
    }

    /// Merges all segments into one per origin, without the records whose objects are gone. The new segments are
    /// whole before the old ones go, so a kill in between costs nothing: a record that stands twice counts once.
    fn compact(&self) -> Result<(), StoreError> {
        let mut segment = locked(&self.segment);
        let mut index = Index::default();
        index.refresh(&self.disk, None)?;
        let old = index.segments();
        let mut records = index.records();
        records.retain(|record| object::path(&self.disk, &record.object()).exists());
        records.sort_by(|a, b| (&a.origin, a.key).cmp(&(&b.origin, b.key)));
        for same in records.chunk_by(|a, b| a.origin == b.origin) {
            journal::write_segment(&self.disk, same)?;
        }
        *segment = Default::default();
        for name in old {
            self.disk.remove(&journal::folder(&self.disk).join(name))?;
        }
        drop(segment);
        *locked(&self.presence) = Default::default();
        let mut index = Index::default();
        index.refresh(&self.disk, None)?;
        *locked(self.index()?) = index;
        Ok(())
    }

    /// Reads every object and compares it with its record, its name and its task. Damaged ones are set aside; sound
    /// ones that no record knows (their journal was lost) are recorded again.
    ///
    /// # Errors
    /// The store cannot be read, or a newer version wrote a part of it.
    pub fn verify(&self) -> Result<Verdict, StoreError> {
        self.refresh()?;
        let mut verdict = Verdict::default();
        let records = self.records()?;
        {
            let faults = locked(self.index()?).faults();
            verdict.lost_records = faults.damaged;
            verdict.contradictions = faults.contradictions;
        }
        let checked: Vec<_> = records.par_iter().map(|record| (record, self.verify_one(record))).collect();
        for (record, result) in checked {
            match result {
                Ok(()) => verdict.sound.add(record.bytes()),
                Err(StoreError::Missing { .. }) => verdict.missing.push(record.key),
                Err(StoreError::Damaged { fault }) => verdict.damages.push(fault),
                Err(other) => return Err(other),
            }
        }
        self.adopt(&records, &mut verdict)?;
        Ok(verdict)
    }

    fn verify_one(&self, record: &Record) -> Result<(), StoreError> {
        let (artifact, text) = self.read(record)?;
        let why = match () {
            () if artifact.content_hash() != record.content => "its values are not those of its name",
            () if Key::of(&text) != record.key => "it belongs to another task",
            () => return Ok(()),
        };
        Err(self.set_aside(&record.object(), why))
    }

    /// Records the objects again that no record knows.
    fn adopt(&self, records: &[Record], verdict: &mut Verdict) -> Result<(), StoreError> {
        let known: HashSet<PathBuf> = records.iter().map(|record| self.path(&record.object())).collect();
        let mut orphans = Vec::new();
        object::list(&self.disk, |folder, name| {
            let path = folder.join(name);
            if !name.starts_with(TEMPORARY) && !known.contains(&path) {
                orphans.push(path);
            }
        })?;
        for path in orphans {
            let Some(image) = self.disk.read(&path)? else { continue };
            let started = fs::metadata(&path).and_then(|data| data.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
            match hdf5::decode(image) {
                Ok((artifact, text)) if self.path(&id_of(&artifact, &text)) == path => {
                    // Putting it again finds the file there and records it.
                    let (record, _) = self.put(&text, artifact, &Timing { started, seconds: 0.0 })?;
                    verdict.adopted.push(record.key);
                    verdict.sound.add(record.bytes());
                }
                Err(why @ hdf5::Hdf5Error::Newer { .. }) => return Err(StoreError::Newer { path, why }),
                _ => verdict.damages.push(object::set_aside(&self.disk, &path, "no record knows it, nor is it sound")?),
            }
        }
        Ok(())
    }
}

fn id_of(artifact: &Artifact, text: &str) -> object::ObjectId {
    object::ObjectId { content: artifact.content_hash(), key: Key::of(text) }
}

fn memo_is_reachable(path: &Path, reachable: &HashSet<Key>) -> bool {
    let memo = fs::read(path).ok().and_then(|bytes| memo::unpack(&bytes));
    memo.is_some_and(|memo| memo.objects.iter().all(|object| reachable.contains(&object.key)))
}

fn is_temporary(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(TEMPORARY))
}

fn is_young(metadata: &fs::Metadata, grace: Duration) -> bool {
    let age = metadata.modified().ok().and_then(|time| time.elapsed().ok()).unwrap_or_default();
    age < grace
}

/// Calls `visit` with every file below a folder of the store and its size; a folder that is not there has none.
fn walk(disk: &Disk, folder: &str, visit: &mut impl FnMut(&Path, u64)) {
    let mut folders = vec![disk.root.join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            match entry.metadata() {
                Ok(data) if data.is_dir() => folders.push(entry.path()),
                Ok(data) => visit(&entry.path(), data.len()),
                Err(_) => {}
            }
        }
    }
}
