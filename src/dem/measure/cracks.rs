//! Cracks: one for each bond, or element of an interface, that broke.

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
    /// Middle of what broke: the contact point, or that of an element of an interface, m.
    pub position: Vector<S>,
    /// Contact point: the middle of the whole interface, m.
    pub contact: Vector<S>,
    /// Unit normal of the contact, from the first end to the second: the crack lies across it.
    pub normal: Vector<S>,
    /// Which element of the interface broke, from 0; 0 for a bond that breaks as a whole.
    pub element: u32,
    /// Elements of the interface, of equal area; 1 for a bond that breaks as a whole.
    pub elements: u32,
    /// Diameter of what broke, m: that of a bond, the width of a segment in the plane, the diameter of a disc of the area of an
    /// element in space.
    pub size: f64,
    /// Gap at the break, m.
    pub gap: f64,
}
