//! Mean stress of a region: σ_ab = −(1/V) Σ f_a (x_c − X)_b over the ends of the contacts inside (Love–Weber), compression
//! positive, X the centre of the body that the force f acts on, x_c the contact point.
//!
//! A contact counts when its point is in the region. V is the whole region, voids included.

use super::fabric::Dyads;
use crate::contact::Other;
use crate::engine::Engine;
use crate::space::{Space, Tuple, Vector};

/// Where a stress is measured.
#[derive(Clone, Copy, Debug)]
pub enum Region<S: Space> {
    /// A disc or ball.
    Ball {
        /// Centre, m.
        centre: Vector<S>,
        /// Radius, m.
        radius: f64,
    },
    /// A box along the axes.
    Block {
        /// Lowest corner, m.
        low: Vector<S>,
        /// Highest corner, m.
        high: Vector<S>,
    },
}

impl<S: Space> Region<S> {
    /// Whether a point is inside.
    pub fn holds(&self, x: Vector<S>) -> bool {
        match *self {
            Self::Ball { centre, radius } => x.minus(centre).norm() <= radius,
            Self::Block { low, high } => (0..S::DIMENSION).all(|k| x.at(k) >= low.at(k) && x.at(k) <= high.at(k)),
        }
    }

    /// Volume (area in the plane), m³ (m²).
    pub fn volume(&self) -> f64 {
        match *self {
            Self::Ball { radius, .. } => S::volume(radius),
            Self::Block { low, high } => (0..S::DIMENSION).map(|k| high.at(k) - low.at(k)).product(),
        }
    }
}

/// Mean stress of a periodic cell, Pa, compression positive, row by row; nothing without a cell.
pub fn cell_stress<S: Space>(engine: &Engine<S>) -> Option<[[f64; 3]; 3]> {
    let volume = engine.cell_volume()?;
    Some(virial(engine, |_| true).map(|row| row.map(|x| x / volume)))
}

/// Mean stress of a region, Pa, compression positive, row by row.
pub fn stress<S: Space>(engine: &Engine<S>, region: &Region<S>) -> [[f64; 3]; 3] {
    let volume = region.volume();
    virial(engine, |x| region.holds(x)).map(|row| row.map(|x| x / volume))
}

/// −Σ f_a (x_c − X)_b over the contacts whose point is wanted, N·m.
fn virial<S: Space>(engine: &Engine<S>, wanted: impl Fn(Vector<S>) -> bool) -> [[f64; 3]; 3] {
    let mut dyads = Dyads::<S>::default();
    let centre = |particle: usize| match engine.clump_of(particle) {
        Some(clump) => engine.clump_centre(clump),
        None => engine.position(particle),
    };
    for contact in engine.contacts().filter(|c| c.active && wanted(c.point)) {
        let force = contact.force();
        dyads.add(force.times(-1.0), contact.point.minus(centre(contact.particle)));
        if let Other::Particle(second) = contact.other {
            dyads.add(force, contact.point.minus(centre(second).plus(contact.shift)));
        }
    }
    dyads.sum
}
