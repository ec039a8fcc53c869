//! Cracks of a loading test: one for each bond that broke, with the strain of the specimen at that moment.

use crate::measure::Mode;
use crate::{Engine, Other, Space, Vector};

/// A broken bond.
#[derive(Clone, Copy, Debug)]
pub struct CrackEvent<S: Space> {
    /// Axial strain of the specimen.
    pub strain: f64,
    /// Tension or shear.
    pub mode: Mode,
    /// Groups of the two particles, by number, the smaller first.
    pub groups: [usize; 2],
    /// Contact point (m).
    pub position: Vector<S>,
    /// Unit normal of the contact; the crack lies across it.
    pub normal: Vector<S>,
    /// Length of the crack, the bond's diameter (m).
    pub size: f64,
}

/// Adds the cracks since (step, strain), their strains interpolated by step.
pub(super) fn note_cracks<S: Space>(
    engine: &Engine<S>,
    cracks: &mut Vec<CrackEvent<S>>,
    (step, strain): (u64, f64),
    now: f64,
) {
    let steps = (engine.steps() - step).max(1) as f64;
    for crack in &engine.cracks()[cracks.len()..] {
        // What broke before the loading counts from its start.
        let share = crack.step.saturating_sub(step) as f64 / steps;
        let group = |particle: usize| usize::from(engine.group(particle).0);
        let first = group(crack.particle);
        // Walls are never bonded.
        let second = if let Other::Particle(other) = crack.other { group(other) } else { first };
        cracks.push(CrackEvent {
            strain: strain + share * (now - strain),
            mode: crack.mode,
            groups: [first.min(second), first.max(second)],
            position: crack.position,
            normal: crack.normal,
            size: crack.size,
        });
    }
}
