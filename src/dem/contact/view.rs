//! One contact as a caller sees it.

use crate::dem::space::{Space, Spin, Vector};

/// The other end of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Other {
    /// A particle, by its place in the caller's list.
    Particle(usize),
    /// A wall, by its place in the caller's list.
    Wall(usize),
}

/// State of one contact. Forces and moments act on `particle`; the other end feels the opposite.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Space> {
    /// First end, by its place in the caller's list.
    pub particle: usize,
    /// Second end.
    pub other: Other,
    /// Unit normal from the first end to the second.
    pub normal: Vector<S>,
    /// Contact point, m.
    pub point: Vector<S>,
    /// From the centre of the first end to that of the second (to the contact point at a wall), m.
    pub branch: Vector<S>,
    /// Distance of the surfaces, m.
    pub gap: f64,
    /// Reference gap of the linear spring, m.
    pub reference: f64,
    /// Whether it is bonded.
    pub bonded: bool,
    /// Whether it can carry force now: bonded, or the spring is compressed.
    pub active: bool,
    /// Normal stiffness of the linear spring, N/m.
    pub kn: f64,
    /// Force of the linear spring, N.
    pub spring: Vector<S>,
    /// Force of the bond, N.
    pub cement: Vector<S>,
    /// Moment of the bond, N·m.
    pub moment: Spin<S>,
}

impl<S: Space> Contact<S> {
    /// Whole force on the first end, N.
    pub fn force(&self) -> Vector<S> {
        use crate::dem::space::Tuple;
        self.spring.plus(self.cement)
    }
}
