//! The lane trait, its scalar member, and the two kinds of memory row.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Contacts in a block, for every lane type.
pub const WIDEST: usize = 8;

/// One row of a particle's record: four numbers that are loaded and stored together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Quad(pub [f64; 4]);

impl Quad {
    /// Componentwise sum.
    #[inline(always)]
    pub(crate) fn plus(mut self, other: Self) -> Self {
        for (t, o) in self.0.iter_mut().zip(other.0) {
            *t += o;
        }
        self
    }

    /// Multiple.
    #[inline(always)]
    pub(crate) fn times(mut self, factor: f64) -> Self {
        for t in &mut self.0 {
            *t *= factor;
        }
        self
    }

    /// Componentwise the larger absolute value.
    #[inline(always)]
    pub(crate) fn larger(self, other: Self) -> Self {
        let mut top = self;
        for (t, o) in top.0.iter_mut().zip(other.0) {
            let size = o.abs();
            *t = if size > *t { size } else { *t };
        }
        top
    }
}

/// One quantity of the eight contacts of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; WIDEST]);

/// Some contacts side by side.
///
/// `min`, `max` return the second operand unless the first is strictly smaller (larger), as the machine's vector
/// instructions do.
pub trait Lane:
    Copy
    + std::fmt::Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Result of a comparison.
    type Mask: Copy;
    /// Contacts in one lane value; divides [`WIDEST`].
    const WIDTH: usize;
    /// One bit per contact, all set.
    const ALL: u8 = (u16::MAX >> (16 - Self::WIDTH)) as u8;
    /// The same number everywhere.
    fn splat(x: f64) -> Self;
    /// Contacts `at … at + WIDTH` of a row.
    fn load(row: &Row, at: usize) -> Self;
    /// Writes contacts `at … at + WIDTH` of a row.
    fn store(self, row: &mut Row, at: usize);
    /// Correctly rounded square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller one.
    fn min(self, other: Self) -> Self;
    /// The larger one.
    fn max(self, other: Self) -> Self;
    /// Strictly greater.
    fn above(self, other: Self) -> Self::Mask;
    /// Either.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// One bit per contact.
    fn bits(mask: Self::Mask) -> u8;
    /// The records `ends` of a table of records of `ROWS` rows, turned so that each result holds one component.
    fn gather<const ROWS: usize>(table: &[Quad], ends: &[u32]) -> [[Self; 4]; ROWS];
    /// Adds to each of the records `ends`, in their order.
    fn scatter_add<const ROWS: usize>(table: &mut [Quad], ends: &[u32], value: [[Self; 4]; ROWS]);
    /// Adds to both ends of each contact: contact by contact, its first end before its second.
    fn scatter_add_both<const ROWS: usize>(table: &mut [Quad], ends: [&[u32]; 2], value: [[[Self; 4]; ROWS]; 2]);
}

impl Lane for f64 {
    type Mask = bool;
    const WIDTH: usize = 1;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn load(row: &Row, at: usize) -> Self {
        row.0[at]
    }
    #[inline(always)]
    fn store(self, row: &mut Row, at: usize) {
        row.0[at] = self;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn above(self, other: Self) -> bool {
        self > other
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn bits(mask: bool) -> u8 {
        u8::from(mask)
    }
    #[inline(always)]
    fn gather<const ROWS: usize>(table: &[Quad], ends: &[u32]) -> [[Self; 4]; ROWS] {
        let record = &table.as_chunks::<ROWS>().0[ends[0] as usize];
        let mut values = [[0.0; 4]; ROWS];
        for (value, row) in values.iter_mut().zip(record) {
            *value = row.0;
        }
        values
    }
    #[inline(always)]
    fn scatter_add<const ROWS: usize>(table: &mut [Quad], ends: &[u32], value: [[Self; 4]; ROWS]) {
        let record = &mut table.as_chunks_mut::<ROWS>().0[ends[0] as usize];
        for (row, add) in record.iter_mut().zip(value) {
            for (t, v) in row.0.iter_mut().zip(add) {
                *t += v;
            }
        }
    }
    #[inline(always)]
    fn scatter_add_both<const ROWS: usize>(table: &mut [Quad], ends: [&[u32]; 2], value: [[[Self; 4]; ROWS]; 2]) {
        Self::scatter_add(table, ends[0], value[0]);
        Self::scatter_add(table, ends[1], value[1]);
    }
}
