//! The rows of one contact outside its block, while a list is written anew.

use super::RowIndex;
use crate::space::{D3, Space};
use std::ops::{Deref, DerefMut};

/// RowIndex of one contact: those that all laws share, and after them those of the elements of a flat joint. A law with fewer
/// rows has the first ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Memory {
    rows: [f64; LONGEST],
    /// RowIndex from [`RowIndex::COUNT`] on; empty unless the contact is a flat joint.
    pub(crate) tail: Vec<f64>,
}

/// Shared rows in the space that has most.
const LONGEST: usize = RowIndex::<D3>::COUNT;

impl Deref for Memory {
    type Target = [f64; LONGEST];

    fn deref(&self) -> &Self::Target {
        &self.rows
    }
}

impl DerefMut for Memory {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.rows
    }
}

/// Memory of a fresh, unbonded contact.
pub(crate) fn fresh<S: Space>() -> Memory {
    let mut memory = Memory { rows: [0.0; LONGEST], tail: Vec::new() };
    unbond::<S>(&mut memory);
    memory
}

/// Takes the bond out of a contact's memory.
pub(crate) fn unbond<S: Space>(memory: &mut Memory) {
    memory[RowIndex::<S>::TENSION..].fill(0.0);
    memory[RowIndex::<S>::TENSION] = f64::INFINITY;
    memory[RowIndex::<S>::COHESION] = f64::INFINITY;
    memory.tail.clear();
}

/// Whether a contact's memory holds a bond.
pub(crate) fn bonded<S: Space>(memory: &Memory) -> bool {
    memory[RowIndex::<S>::TENSION] < f64::INFINITY
}
