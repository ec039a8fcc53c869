//! Bodies as the caller describes them: balls, rigid clumps of balls, flat walls.

use super::space::{Space, Spin, Vector};

/// A set of bodies with the same contact properties; their names are the caller's affair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Group(pub u8);

/// A disc of unit thickness or a sphere: a body of its own, or a pebble of a clump.
#[derive(Clone, Debug)]
pub struct Particle<S: Space> {
    /// Centre, m.
    pub position: Vector<S>,
    /// Radius, m.
    pub radius: f64,
    /// Velocity, m/s.
    pub velocity: Vector<S>,
    /// Spin, rad/s.
    pub spin: Spin<S>,
    /// Mass, kg (per metre of thickness in the plane). Not read for a pebble.
    pub mass: f64,
    /// Moment of inertia, kg·m². Not read for a pebble.
    pub inertia: f64,
    /// Contact group.
    pub group: Group,
}

impl<S: Space> Particle<S> {
    /// A ball at rest with the mass and inertia of its density.
    pub fn ball(position: Vector<S>, radius: f64, density: f64, group: Group) -> Self {
        use super::space::Tuple;
        let mass = density * S::volume(radius);
        let (velocity, spin) = (Vector::<S>::zero(), Spin::<S>::zero());
        Self { position, radius, velocity, spin, mass, inertia: S::inertia(mass, radius), group }
    }
}

/// A rigid body of overlapping pebbles. Pebbles of one clump do not touch each other.
#[derive(Clone, Debug)]
pub struct Clump<S: Space> {
    /// Indices of the pebbles in the caller's list of particles.
    pub pebbles: Vec<usize>,
    /// Centre of mass, m.
    pub centre: Vector<S>,
    /// Velocity of the centre, m/s.
    pub velocity: Vector<S>,
    /// Spin, rad/s.
    pub spin: Spin<S>,
    /// Mass of the union, kg.
    pub mass: f64,
    /// Inertia of the union about the centre, kg·m²: in the plane only `[2][2]` is read; in the solid the symmetric
    /// tensor in the present frame.
    pub inertia: [[f64; 3]; 3],
}
