//! A test piece mounted in a testing machine: the engine with bonds in, overlaps absorbed and walls in place.
//!
//! Everything starts free of force: bonds take the gaps of the packing as reference gaps, and so do the contacts that
//! stay unbonded (clump–clump, platens). Reference gaps belong to the pair and outlive a loss of contact.
//!
//! [`Scales`] are the stress and the strain at which the piece can be expected to fail, from its own bonds: thresholds and
//! speeds that are given relative to the piece follow from them.

use super::fissure;
use super::material::{Material, PLATEN};
use super::piece::Piece;
use crate::measure::unbalanced_ratio;
use crate::space::Tuple;
use crate::{Bond, ContactTable, Engine, Failure, Faults, Masses, Model, Other, Particle, Settings, Space, Stiffness};
use crate::{Vector, Wall, Watch};
use serde::{Deserialize, Serialize};

/// What the machine adds to the physics: damping, masses, share of the critical time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Local damping α.
    pub damping: f64,
    /// Share of the critical time step.
    pub safety: f64,
    /// Which masses move the bodies.
    pub masses: Masses,
}

impl Default for Machine {
    fn default() -> Self {
        Self { damping: 0.7, safety: 0.8, masses: Masses::Real }
    }
}

/// Stress and stiffness of a piece, by its bonds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Mean modulus E* of the springs of its bonded contacts, or of all contacts where none is bonded (Pa).
    pub modulus: f64,
    /// Mean tensile strength of its bonds; a thousandth of the modulus where there is none (Pa).
    pub strength: f64,
    /// Density of the balls (kg/m³).
    pub density: f64,
}

/// Largest reference strain: beyond it the strengths mean "does not break" and do not predict a strain.
const LARGEST_STRAIN: f64 = 0.05;

impl Scales {
    /// Strain at which the weakest direction can be expected to fail, strength over modulus.
    pub fn strain(&self) -> f64 {
        (self.strength / self.modulus).min(LARGEST_STRAIN)
    }

    /// Stress that belongs to [`strain`](Self::strain) (Pa).
    pub fn stress(&self) -> f64 {
        self.strain() * self.modulus
    }

    /// Wave speed √(E*/ρ), which is below that of the piece (m/s).
    pub fn wave_speed(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }
}

/// A piece in the machine.
pub struct Mounted<S: Space> {
    /// The engine, free of force and at rest.
    pub engine: Engine<S>,
    /// Scales of the piece.
    pub scales: Scales,
    /// Bonds at the start.
    pub bonds: usize,
}

/// Contacts with the platens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Platens {
    /// Friction μ.
    pub friction: f64,
    /// Modulus E* of their contacts (Pa); that of the material when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<f64>,
}

impl Platens {
    /// The material's contact table with these platens.
    pub fn table(&self, material: &Material) -> ContactTable {
        let mut table = material.table(self.friction);
        let Some(own) = self.modulus else { return table };
        for entry in table.entries.iter_mut().filter(|entry| entry.0 == PLATEN || entry.1 == PLATEN) {
            if let Stiffness::Modulus { modulus, .. } = &mut entry.2.linear.stiffness {
                *modulus = own;
            }
        }
        table
    }
}

/// Mounts the piece between `walls`, with `rollers` (particles of the machine, held at rest) after its balls. `seed` draws
/// bond strengths where they scatter.
///
/// # Errors
/// All faults that the engine finds.
pub fn mount<S: Space>(
    piece: &Piece<S>,
    material: &Material,
    walls: Vec<Wall<S>>,
    rollers: Vec<Particle<S>>,
    (platens, machine): (&Platens, &Machine),
    seed: u64,
) -> Result<Mounted<S>, Faults> {
    let ball = |i: usize| Particle::ball(piece.centres[i], piece.radii[i], piece.density, piece.groups[i]);
    let [width, height, depth] = piece.outline.extents();
    let reach = [1.5 * width, height, 1.5 * depth];
    let mut table = platens.table(material);
    let balls = piece.radii.len();
    let fixed: Vec<usize> = (balls..balls + rollers.len()).collect();
    if let (false, Some(law)) = (rollers.is_empty(), table.get(PLATEN, piece.groups[0]).copied()) {
        table.set(PLATEN, PLATEN, law);
    }
    let model = Model {
        particles: (0..balls).map(ball).chain(rollers).collect(),
        clumps: piece.clumps.clone(),
        walls,
        contacts: table.clone(),
        settings: Settings {
            damping: machine.damping,
            safety: machine.safety,
            masses: machine.masses,
            bounds: Some([Vector::<S>::build(|k| -reach[k]), Vector::<S>::build(|k| reach[k])]),
            ..Settings::default()
        },
    };
    let mut engine = Engine::new(&model)?;
    if !fixed.is_empty() {
        engine.fix(&fixed, true, true)?;
    }
    let gap = material.gap * piece.mean_radius();
    fissure::lay(&mut engine, material, piece, (gap, seed))?;
    engine.install_bonds(gap, seed)?;
    engine.absorb_overlaps();
    let (bonds, scales) = (engine.bond_count(), scales(&engine, &table, piece.density));
    Ok(Mounted { engine, scales, bonds })
}

/// Means over the bonded contacts between balls, or over all of them where none is bonded.
fn scales<S: Space>(engine: &Engine<S>, table: &ContactTable, density: f64) -> Scales {
    let (mut count, mut modulus, mut strength) = ([0.0_f64; 2], [0.0; 2], 0.0);
    for contact in engine.contacts() {
        let Other::Particle(other) = contact.other else { continue };
        let groups = [contact.particle, other].map(|particle| engine.group(particle));
        let Some(law) = table.get(groups[0], groups[1]) else { continue };
        let radius = engine.radius(contact.particle).min(engine.radius(other));
        // E* of the spring of two equal balls, k_n L / A, whatever it was given as.
        let own = law.linear.stiffness.normal::<S>([radius; 2]) * 2.0 * radius / S::section(radius);
        let row = usize::from(!contact.bonded);
        count[row] += 1.0;
        modulus[row] += own;
        strength += match law.bond {
            _ if !contact.bonded => 0.0,
            Bond::None => 0.0,
            Bond::Contact(bond) => bond.tensile_strength,
            Bond::Parallel(bond) => bond.tensile_strength,
            Bond::Flat(joint) => joint.tensile_strength,
        };
    }
    if count[0] > 0.0 {
        return Scales { modulus: modulus[0] / count[0], strength: strength / count[0], density };
    }
    let modulus = if count[1] > 0.0 { modulus[1] / count[1] } else { f64::NAN };
    Scales { modulus, strength: 1e-3 * modulus, density }
}

/// Gives every body the velocity that `field` has at its centre, without spin: a start without a shock.
///
/// # Errors
/// A velocity that is not finite.
pub fn set_velocities<S: Space>(engine: &mut Engine<S>, field: impl Fn(Vector<S>) -> Vector<S>) -> Result<(), Faults> {
    let rest = crate::Spin::<S>::zero();
    for i in 0..engine.particle_count() {
        if engine.clump_of(i).is_none() {
            let velocity = field(engine.position(i));
            engine.set_motion(i, velocity, rest)?;
        }
    }
    for c in 0..engine.clump_count() {
        let clump = engine.clump(c);
        engine.set_motion(clump.pebbles[0], field(clump.centre), rest)?;
    }
    Ok(())
}

/// Steps between two looks at the equilibrium.
const SETTLE_EVERY: u64 = 100;

/// Steps until the unbalanced ratio is at most `limit`, and how near it came; at most `most` steps are made. A piece that is
/// free of force is in equilibrium.
///
/// # Errors
/// Why the engine failed.
pub fn settle<S: Space>(
    engine: &mut Engine<S>,
    (limit, most): (f64, u64),
    mut pause: impl FnMut() -> Watch,
) -> Result<Settled, Failure> {
    let end = engine.steps().saturating_add(most);
    loop {
        let ratio = unbalanced_ratio(engine);
        if ratio <= limit || engine.steps() >= end {
            return Ok(Settled { ratio, interrupted: false });
        }
        engine.advance(SETTLE_EVERY)?;
        if pause() == Watch::Stop {
            return Ok(Settled { ratio, interrupted: true });
        }
    }
}

/// How a search for equilibrium ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settled {
    /// Mean unbalanced force over mean contact force.
    pub ratio: f64,
    /// Whether the watcher stopped it.
    pub interrupted: bool,
}
