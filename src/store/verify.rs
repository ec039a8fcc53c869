//! Verification: reads every file and tells sound, damaged and foreign ones apart.

use super::object::{self, ObjectId};
use super::{Amount, Damage, Record, Store, StoreError, contents, locked, memo, prove};
use crate::artifact::{ContentHash, Key};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::PathBuf;

/// The outcome of a verification.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Sound results.
    pub sound: Amount,
    /// Objects that were not sound, and were set aside.
    pub damages: Vec<Damage>,
    /// Tasks with records whose objects are all missing.
    pub missing: Vec<Key>,
    /// Sound objects without a record, which have been recorded again.
    pub adopted: Vec<Key>,
    /// Sound objects that only others have recorded; they are recorded as proven now.
    pub proven: Vec<Key>,
    /// Records of the journal that could not be read.
    pub lost_records: usize,
    /// Tasks with two different sound results: the task depends on something that is not in its key, or one result is
    /// forged. Neither is believed; the next run computes the task again.
    pub contradictions: Vec<(Key, ContentHash, ContentHash)>,
    /// Memos and campaign records that others have made or that were changed: they are not believed.
    pub not_own: usize,
    /// Files in the store that flow has not written; they are not touched.
    pub strangers: Vec<PathBuf>,
}

impl Verdict {
    /// Whether every file is as flow wrote it, and no two results contradict each other.
    pub fn is_sound(&self) -> bool {
        self.damages.is_empty() && self.contradictions.is_empty()
    }
}

/// The results of a check of each item, on all cores; on the thread of the caller where the system grants no other.
fn each<'a, T: Sync, R: Send>(items: &'a [T], check: impl Fn(&'a T) -> R + Sync + Send) -> Vec<R> {
    match ThreadPoolBuilder::new().build() {
        Ok(pool) => pool.install(|| items.par_iter().map(check).collect()),
        Err(_) => items.iter().map(check).collect(),
    }
}

impl Store {
    /// Reads every object and compares it with its record, its name and its task. Damaged ones are set aside; sound
    /// ones that no record knows (their journal was lost) are recorded again.
    ///
    /// # Errors
    /// The store cannot be read, or a newer version wrote a part of it.
    pub fn verify(&self) -> Result<Verdict, StoreError> {
        self.refresh()?;
        let mut verdict = Verdict { lost_records: locked(self.index()?).damaged(), ..Verdict::default() };
        let records = self.records()?;
        // Only the seals stay in memory: all results of a store together may be larger than it.
        let checked = each(&records, |record| (record, self.read(record).map(|proven| proven.seal)));
        let (mut sound, mut lost): (Vec<ObjectId>, Vec<Key>) = Default::default();
        for (record, result) in checked {
            match result {
                Ok(seal) => {
                    verdict.sound.add(seal.size);
                    sound.push(record.object());
                    if !record.own {
                        verdict.proven.push(self.own(record, seal).key);
                    }
                }
                Err(StoreError::Missing { .. }) => lost.push(record.key),
                Err(StoreError::Damaged { fault }) => verdict.damages.push(fault),
                Err(other) => return Err(other),
            }
        }
        self.adopt_strays(&records, &mut sound, &mut verdict)?;
        sound.sort_unstable_by_key(|id| (id.key, id.content));
        let differ = |pair: &&[ObjectId]| pair[0].key == pair[1].key && pair[0].content != pair[1].content;
        let pairs = sound.windows(2).filter(differ);
        verdict.contradictions = pairs.map(|pair| (pair[0].key, pair[0].content, pair[1].content)).collect();
        let there: HashSet<Key> = sound.iter().map(|id| id.key).collect();
        lost.retain(|key| !there.contains(key));
        lost.dedup();
        verdict.missing = lost;
        self.look_around(&mut verdict)?;
        Ok(verdict)
    }

    /// Records the objects again that have no record.
    fn adopt_strays(
        &self,
        records: &[Record],
        sound: &mut Vec<ObjectId>,
        verdict: &mut Verdict,
    ) -> Result<(), StoreError> {
        let known: HashSet<String> = records.iter().map(|record| record.object().file_name()).collect();
        let mut strays = Vec::new();
        object::list(&self.disk, |_, _, name, _| {
            if !known.contains(name) {
                strays.push(name.to_owned());
            }
        })?;
        for result in each(&strays, |name| prove::named(&self.disk, name).map(|proven| (proven.id, proven.seal))) {
            match result {
                Ok((id, seal)) => {
                    verdict.adopted.push(self.record_again(&id, seal).key);
                    verdict.sound.add(seal.size);
                    sound.push(id);
                }
                Err(StoreError::Missing { .. }) => {}
                Err(StoreError::Damaged { fault }) => verdict.damages.push(fault),
                Err(other) => return Err(other),
            }
        }
        Ok(())
    }

    /// Finds memos and campaign records that are not this user's, and files that flow has not written.
    fn look_around(&self, verdict: &mut Verdict) -> Result<(), StoreError> {
        for number in self.campaigns()? {
            verdict.not_own += usize::from(!self.campaign(number)?.is_some_and(|campaign| campaign.own));
        }
        let (mark, disk) = (&self.mark, &self.disk);
        contents::walk(disk, &mut |place| {
            if place.folder.starts_with(memo::FOLDER) && place.is_ours() {
                let memo = memo::key_of(place.name).zip(place.at.read(place.name, memo::MOST).ok());
                let own = memo.is_some_and(|(key, bytes)| memo::unpack(mark, &key, &bytes).is_some());
                verdict.not_own += usize::from(!own);
            } else if !place.is_ours() {
                verdict.strangers.push(disk.path(place.folder, place.name));
            }
        })?;
        verdict.strangers.sort();
        Ok(())
    }
}
