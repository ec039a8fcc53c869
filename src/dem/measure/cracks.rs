//! Cracks: one for each bond that broke.

use crate::contact::Other;
use crate::space::{Space, Vector};

/// How a bond broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// The normal stress reached the tensile strength.
    Tension,
    /// The shear stress reached the shear strength.
    Shear,
}

/// A broken bond.
#[derive(Clone, Debug)]
pub struct Crack<S: Space> {
    /// Step in which it broke.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// How.
    pub mode: Mode,
    /// First end, by its index in the caller's list.
    pub particle: usize,
    /// Second end.
    pub other: Other,
    /// Contact point, m.
    pub position: Vector<S>,
    /// Unit normal of the contact, from the first end to the second: the crack lies across it.
    pub normal: Vector<S>,
    /// Diameter of the broken bond, m.
    pub size: f64,
    /// Gap at the break, m.
    pub gap: f64,
}
