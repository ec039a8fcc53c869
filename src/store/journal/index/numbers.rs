//! Records by the first bytes of a hash.

use super::records::Records;
use crate::artifact::FirstBytes;
use crate::store::journal::record::word;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;

/// Numbers of records by the first bytes of a hash in them.
#[derive(Default)]
pub(super) struct Numbers {
    last: HashMap<u64, u32, BuildHasherDefault<FirstBytes>>,
    /// The record before each one that begins alike; itself when there is none.
    before: Vec<u32>,
}

impl Numbers {
    /// Takes in the records that are new; their hashes begin at byte `place`.
    pub(super) fn update(&mut self, records: &Records, place: usize) {
        self.last.reserve(records.len() - self.before.len());
        for number in self.before.len()..records.len() {
            let number = number as u32;
            let before = self.last.insert(word(records.get(number as usize), place), number);
            self.before.push(before.unwrap_or(number));
        }
    }

    /// Numbers of the records whose hash begins so, the last one first.
    pub(super) fn of(&self, hash: &[u8; 32]) -> impl Iterator<Item = usize> {
        let mut next = self.last.get(&word(hash, 0)).copied();
        std::iter::from_fn(move || {
            let number = next?;
            next = Some(self.before[number as usize]).filter(|&before| before != number);
            Some(number as usize)
        })
    }
}
