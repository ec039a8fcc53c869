//! A table of rows that begins at a cache line.

use super::{Quad, Row};
use std::ops::{Deref, DerefMut};

/// Rows that begin at a multiple of 64 bytes, so that a record of two rows never lies across two cache lines.
#[derive(Debug, Default)]
pub(crate) struct Table {
    quads: Vec<Quad>,
    skip: usize,
    len: usize,
}

impl Table {
    /// Zeros.
    pub(crate) fn new(len: usize) -> Self {
        let quads = vec![Quad::default(); len + 1];
        let skip = (quads.as_ptr() as usize / 32) % 2;
        Self { quads, skip, len }
    }
}

/// Asks for record `k` of a table of records of `rows` rows ahead of its use.
#[inline(always)]
pub(crate) fn prefetch(table: &[Quad], rows: usize, k: u32) {
    #[cfg(target_arch = "x86_64")]
    if let Some(record) = table.get(k as usize * rows..(k as usize + 1) * rows) {
        for quad in record.iter().step_by(2) {
            // SAFETY: a hint about an address inside the table; it reads nothing.
            unsafe { std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(quad.0.as_ptr().cast()) }
        }
    }
}

/// Asks for the rows of a block ahead of their use.
#[inline(always)]
pub(crate) fn prefetch_rows(rows: &[Row]) {
    #[cfg(target_arch = "x86_64")]
    for row in rows {
        // SAFETY: a hint about an address inside the slice; it reads nothing.
        unsafe { std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(row.0.as_ptr().cast()) }
    }
}

impl Clone for Table {
    fn clone(&self) -> Self {
        let mut copy = Self::new(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl Deref for Table {
    type Target = [Quad];
    fn deref(&self) -> &[Quad] {
        &self.quads[self.skip..self.skip + self.len]
    }
}

impl DerefMut for Table {
    fn deref_mut(&mut self) -> &mut [Quad] {
        &mut self.quads[self.skip..self.skip + self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_begins_at_a_cache_line_also_when_copied() {
        for len in [1, 2, 7, 1000] {
            let mut table = Table::new(len);
            table[len - 1] = Quad([1.0; 4]);
            let copy = table.clone();
            assert_eq!((table.as_ptr() as usize % 64, copy.as_ptr() as usize % 64), (0, 0));
            assert_eq!((copy.len(), copy[len - 1]), (len, Quad([1.0; 4])));
        }
    }
}
