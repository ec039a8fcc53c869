//! A specimen mounted in a testing machine: the engine with bonds in, overlaps absorbed and walls in place.
//!
//! Everything starts free of force: bonds take the gaps of the packing as reference gaps, and so do the contacts that
//! stay unbonded (clump–clump, platens). Reference gaps belong to the pair and outlive a loss of contact.

use super::material::Material;
use crate::genesis::region::Point;
use crate::genesis::specimen::Specimen;
use crate::{Clump, D2, Engine, Faults, Masses, Model, Particle, Settings, Wall};
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

/// Mounts the specimen between `walls`. `seed` draws bond strengths where they scatter.
///
/// # Errors
/// All faults that the engine finds.
pub fn mount(
    specimen: &Specimen,
    material: &Material,
    walls: Vec<Wall<D2>>,
    platen_friction: f64,
    machine: &Machine,
    seed: u64,
) -> Result<Engine<D2>, Faults> {
    let ball = |i: usize| Particle::ball(specimen.centres[i], specimen.radii[i], specimen.density, specimen.groups[i]);
    let [width, height] = specimen.region.extent();
    let model = Model {
        particles: (0..specimen.radii.len()).map(ball).collect(),
        clumps: specimen.clumps.iter().map(clump).collect(),
        walls,
        contacts: material.table(platen_friction),
        settings: Settings {
            damping: machine.damping,
            safety: machine.safety,
            masses: machine.masses,
            bounds: Some([[-1.5 * width, -height], [1.5 * width, height]]),
            ..Settings::default()
        },
    };
    let mut engine = Engine::new(&model)?;
    engine.install_bonds(material.gap * specimen.mean_radius(), seed)?;
    engine.absorb_overlaps();
    Ok(engine)
}

fn clump(clump: &crate::genesis::clump::Clump) -> Clump<D2> {
    Clump {
        pebbles: clump.pebbles.clone(),
        centre: clump.centre,
        velocity: [0.0; 2],
        spin: [0.0],
        mass: clump.mass,
        inertia: clump.inertia,
    }
}

/// Gives every body the velocity that `field` has at its centre, without spin: a start without a shock.
///
/// # Errors
/// A velocity that is not finite.
pub fn set_velocities(engine: &mut Engine<D2>, field: impl Fn(Point) -> Point) -> Result<(), Faults> {
    for i in 0..engine.particle_count() {
        if engine.clump_of(i).is_none() {
            let velocity = field(engine.position(i));
            engine.set_motion(i, velocity, [0.0])?;
        }
    }
    for c in 0..engine.clump_count() {
        let clump = engine.clump(c);
        engine.set_motion(clump.pebbles[0], field(clump.centre), [0.0])?;
    }
    Ok(())
}
