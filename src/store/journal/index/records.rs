//! The records that were read, in blocks: a list that grows is not copied, and leaves no room unused.

use crate::store::journal::record::RECORD;

/// Records of one block, of 1 MB.
const BLOCK: usize = 1 << 13;

/// Records by their numbers.
#[derive(Default)]
pub(super) struct Records(Vec<Vec<[u8; RECORD]>>);

impl Records {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.0.split_last().map_or(0, |(last, full)| full.len() * BLOCK + last.len())
    }

    /// Adds some.
    pub(super) fn extend(&mut self, mut records: &[[u8; RECORD]]) {
        while !records.is_empty() {
            if self.0.last().is_none_or(|last| last.len() == BLOCK) {
                self.0.push(Vec::new());
            }
            let Some(last) = self.0.last_mut() else { return };
            let (now, later) = records.split_at(records.len().min(BLOCK - last.len()));
            last.extend_from_slice(now);
            records = later;
        }
    }

    /// Drops those from number `count` on.
    pub(super) fn truncate(&mut self, count: usize) {
        self.0.truncate(count.div_ceil(BLOCK));
        if let Some((last, full)) = self.0.split_last_mut() {
            last.truncate(count - full.len() * BLOCK);
        }
    }

    /// One of them.
    pub(super) fn get(&self, number: usize) -> &[u8; RECORD] {
        &self.0[number / BLOCK][number % BLOCK]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_record_has_its_number_whatever_is_added_and_dropped() {
        let record = |number: usize| {
            let mut record = [0; RECORD];
            record[..8].copy_from_slice(&(number as u64).to_le_bytes());
            record
        };
        let some = |numbers: std::ops::Range<usize>| numbers.map(record).collect::<Vec<_>>();
        let mut records = Records::default();
        records.extend(&[]);
        assert_eq!(records.len(), 0);
        records.extend(&some(0..3));
        records.extend(&some(3..BLOCK));
        assert_eq!(records.len(), BLOCK);
        records.extend(&some(BLOCK..3 * BLOCK + 5));
        records.truncate(3 * BLOCK + 5);
        records.truncate(2 * BLOCK + 1);
        assert_eq!(records.len(), 2 * BLOCK + 1);
        records.truncate(2 * BLOCK);
        records.extend(&some(2 * BLOCK..2 * BLOCK + 2));
        assert_eq!(records.len(), 2 * BLOCK + 2);
        assert!((0..records.len()).all(|number| *records.get(number) == record(number)));
        records.truncate(0);
        assert_eq!(records.len(), 0);
    }
}
