//! One contact as a caller sees it.

use crate::law::Interface;
use crate::space::{Space, Spin, Tuple, Vector};

/// The other end of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Other {
    /// A particle, by its index in the caller's list.
    Particle(usize),
    /// A wall, by its index in the caller's list.
    Wall(usize),
}

/// State of one contact. Forces and moments act on `particle`; the other end feels the opposite.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Space> {
    /// First end, by its index in the caller's list.
    pub particle: usize,
    /// Second end.
    pub other: Other,
    /// Unit normal from the first end to the second.
    pub normal: Vector<S>,
    /// Contact point, m.
    pub point: Vector<S>,
    /// From the centre of the first end to that of the second (to the contact point at a wall), m.
    pub branch: Vector<S>,
    /// From the second end to its image, m; zero but across the faces of a periodic cell.
    pub shift: Vector<S>,
    /// Distance of the surfaces, m.
    pub gap: f64,
    /// Reference gap of the linear spring, m.
    pub reference: f64,
    /// Whether it is bonded.
    pub bonded: bool,
    /// Whether it can carry force now: bonded, or the spring is compressed.
    pub active: bool,
    /// Normal and shear stiffness of the linear spring, N/m.
    pub stiffness: [f64; 2],
    /// Normal and shear stiffness of the bond, N/m, of a flat joint as it was made; 0 without a bond that has its own.
    pub bond_stiffness: [f64; 2],
    /// Tensile and shear force at which its bond (all of its elements) breaks when nothing else loads it, N; 0 where unbonded.
    pub capacity: [f64; 2],
    /// I/A of the bond's section, m².
    pub gyration: f64,
    /// Force of the linear spring, N.
    pub spring: Vector<S>,
    /// Force of the bond, N.
    pub cement: Vector<S>,
    /// Moment of the bond, N·m.
    pub moment: Spin<S>,
    /// Its part about the normal (solid only), N·m.
    pub twist: f64,
    /// The interface, for a flat or smooth joint. `cement` and `moment` are its resultants.
    pub interface: Option<Interface>,
}

impl<S: Space> Contact<S> {
    /// Whole force on the first end, N.
    pub fn force(&self) -> Vector<S> {
        self.spring.plus(self.cement)
    }

    /// Strain energy of the spring and of the bond, J.
    pub fn strain_energy(&self) -> [f64; 2] {
        let half = |square: f64, stiffness: f64| if stiffness > 0.0 { 0.5 * square / stiffness } else { 0.0 };
        let parts = |force: Vector<S>| {
            let normal = force.dot(self.normal);
            (normal * normal, (force.dot(force) - normal * normal).max(0.0))
        };
        let ([kn, ks], [bn, bs]) = (self.stiffness, self.bond_stiffness);
        let (normal, shear) = parts(self.spring);
        let spring = half(normal, kn) + half(shear, ks);
        if let Some(interface) = self.interface {
            return [spring, interface.energy];
        }
        let (normal, shear) = parts(self.cement);
        let twist = self.twist * self.twist;
        let bend = (self.moment.dot(self.moment) - twist).max(0.0);
        let turning = half(bend, bn * self.gyration) + half(twist, 2.0 * bs * self.gyration);
        [spring, half(normal, bn) + half(shear, bs) + turning]
    }
}
