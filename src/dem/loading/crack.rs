//! Cracks of a loading test: one for each bond that broke, with the strain of the specimen at that moment.

use super::material::AGGREGATE;
use crate::measure::Mode;
use crate::{Engine, Other, Space, Vector};
use serde::{Deserialize, Serialize};

/// Contact group of a crack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CrackGroup {
    /// Between mortar balls.
    Mortar,
    /// Between mortar and aggregate.
    Interface,
}

/// A broken bond.
#[derive(Clone, Copy, Debug)]
pub struct CrackEvent<S: Space> {
    /// Axial strain of the specimen.
    pub strain: f64,
    /// Tension or shear.
    pub mode: Mode,
    /// Contact group.
    pub group: CrackGroup,
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
        let touches_aggregate = |particle: usize| engine.group(particle) == AGGREGATE;
        let other = matches!(crack.other, Other::Particle(j) if touches_aggregate(j));
        cracks.push(CrackEvent {
            strain: strain + share * (now - strain),
            mode: crack.mode,
            group: if other || touches_aggregate(crack.particle) { CrackGroup::Interface } else { CrackGroup::Mortar },
            position: crack.position,
            normal: crack.normal,
            size: crack.size,
        });
    }
}
