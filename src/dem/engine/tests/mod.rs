//! The engine's own mechanics: small systems against closed forms, and bits against bits.

mod beam;
mod bits;
mod clump;
mod energy;
mod faults;
mod memory;
mod pair;
mod twin;

use crate::dem::*;
use crate::math::random::Stream;

pub(super) const GRAIN: Group = Group(0);
pub(super) const STONE: Group = Group(1);
pub(super) const PLATEN: Group = Group(2);

/// Concrete-like values: spring and bond of 20 GPa, k_n/k_s 2.5, strengths of 20 MPa with 20 % scatter.
pub(super) fn bonded() -> Interaction {
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::Modulus { modulus: 20e9, ratio: 2.5 },
        tensile_strength: 20e6,
        cohesion: 20e6,
        friction_angle: 0.3,
        moment_factor: 1.0,
        deviation: 0.2,
    };
    Interaction { linear: Linear::modulus(20e9, 2.5, 0.5), bond: Bond::Parallel(bond) }
}

/// A table of mortar, stone (rigid clumps) and smooth platens.
pub(super) fn table() -> ContactTable {
    let smooth = Interaction::unbonded(Linear::modulus(20e9, 2.5, 0.0));
    let rough = Interaction::unbonded(Linear::modulus(40e9, 2.5, 0.5));
    ContactTable::new()
        .with(GRAIN, GRAIN, bonded())
        .with(GRAIN, STONE, bonded())
        .with(STONE, STONE, rough)
        .with(GRAIN, PLATEN, smooth)
        .with(STONE, PLATEN, smooth)
}

/// A close-packed block of balls of slightly random radius, `columns` × `rows` (× `columns`), with a clump in the middle
/// and a platen below and above that close on each other.
pub(super) fn block<S: Space>(columns: usize, rows: usize, speed: f64) -> Model<S> {
    use crate::dem::space::Tuple;
    let mut stream = Stream::new(5, "block", 0);
    let (r, height) = (0.5e-3, 3.0_f64.sqrt() * 0.5e-3);
    let layers = if S::DIMENSION == 3 { columns } else { 1 };
    let mut particles: Vec<Particle<S>> = Vec::new();
    for layer in 0..layers {
        for row in 0..rows {
            for column in 0..columns {
                let shift = r * ((row + layer) % 2) as f64;
                let x = [2.0 * r * column as f64 + shift, height * row as f64, 2.0 * r * layer as f64];
                let radius = r * stream.uniform_in(0.97, 1.03);
                particles.push(Particle::ball(Vector::<S>::build(|k| x[k]), radius, 2000.0, GRAIN));
            }
        }
    }
    let middle = [2.0 * r * columns as f64 / 2.0, height * rows as f64 / 2.0, 2.0 * r * layers as f64 / 2.0 - r];
    let centre = Vector::<S>::build(|k| middle[k]);
    let pebbles: Vec<usize> =
        (0..particles.len()).filter(|&p| particles[p].position.minus(centre).norm() < 2.6 * r).collect();
    for &p in &pebbles {
        particles[p].group = STONE;
    }
    let mean = pebbles.iter().fold(Vector::<S>::zero(), |sum, &p| sum.plus(particles[p].position));
    let centre = mean.times(1.0 / pebbles.len() as f64);
    let mass: f64 = pebbles.iter().map(|&p| particles[p].mass).sum();
    let inertia = mass * r * r * 4.0;
    let diagonal = [[inertia, 0.0, 0.0], [0.0, 1.1 * inertia, 0.0], [0.0, 0.0, 1.2 * inertia]];
    let (velocity, spin) = (Vector::<S>::zero(), Spin::<S>::zero());
    let clump = Clump { pebbles, centre, velocity, spin, mass, inertia: diagonal };
    let platen = |y: f64, up: f64| {
        let axis = |v: f64| Vector::<S>::build(|k| if k == 1 { v } else { 0.0 });
        Wall { point: axis(y), normal: axis(up), motion: Motion::Velocity(axis(up * speed)), group: PLATEN }
    };
    let top = height * (rows - 1) as f64 + r;
    let walls = vec![platen(-r, 1.0), platen(top, -1.0)];
    Model { particles, clumps: vec![clump], walls, contacts: table(), settings: Settings::default() }
}
