//! Bodies that several families use: a bonded block with a clump between platens, and short words for small models.

use dem::*;
use math::random::Stream;

use dem::space::Tuple;

pub(crate) const GRAIN: Group = Group(0);
pub(crate) const STONE: Group = Group(1);
pub(crate) const PLATEN: Group = Group(2);

/// A vector along one axis.
pub(crate) fn along<S: Space>(axis: usize, length: f64) -> Vector<S> {
    Vector::<S>::build(|k| if k == axis { length } else { 0.0 })
}

/// A spin about the axis out of the plane.
pub(crate) fn about<S: Space>(rate: f64) -> Spin<S> {
    Spin::<S>::build(|k| if k + 1 == Spin::<S>::LENGTH { rate } else { 0.0 })
}

/// The component of a spin or moment out of the plane.
pub(crate) fn turning<S: Space>(spin: Spin<S>) -> f64 {
    spin.at(Spin::<S>::LENGTH - 1)
}

/// A wall along the first axis through the origin, looking up the second.
pub(crate) fn floor<S: Space>() -> Wall<S> {
    Wall {
        point: along::<S>(1, 0.0),
        normal: along::<S>(1, 1.0),
        motion: Motion::Velocity(along::<S>(0, 0.0)),
        group: PLATEN,
    }
}

/// A model of balls (and walls) that all follow one law.
pub(crate) fn model<S: Space>(
    particles: Vec<Particle<S>>,
    walls: Vec<Wall<S>>,
    law: Interaction,
    settings: Settings<S>,
) -> Model<S> {
    let contacts = ContactTable::new().with(GRAIN, GRAIN, law).with(GRAIN, PLATEN, law);
    Model { particles, clumps: vec![], walls, contacts, settings }
}

/// Concrete-like values: spring and bond of 20 GPa, k_n/k_s 2.5, strengths of 20 MPa with 20 % scatter.
pub(crate) fn bonded() -> Interaction {
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::Modulus { modulus: 20e9, ratio: 2.5 },
        tensile_strength: 20e6,
        cohesion: 20e6,
        friction_angle: 0.3,
        moment_factor: 1.0,
        scatter: Scatter::both(0.2),
    };
    Interaction { linear: Linear::modulus(20e9, 2.5, 0.5), bond: Bond::Parallel(bond) }
}

/// The same with flat joints of four elements, a fifth of them slit and a fifth gapped.
pub(crate) fn jointed() -> Bond {
    Bond::Flat(FlatJoint {
        friction_angle: 0.3,
        shares: Shares { gapped: 0.2, slit: 0.2, gap: 2e-7 },
        scatter: Scatter::both(0.2),
        ..FlatJoint::new(20e9, 2.5, 20e6, 30e6)
    })
}

/// A table of mortar, stone (rigid clumps) and smooth platens.
pub(crate) fn table() -> ContactTable {
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
pub(crate) fn block<S: Space>(columns: usize, rows: usize, speed: f64) -> Model<S> {
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
