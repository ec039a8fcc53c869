//! Cracks of a loading test: one for each bond, or element of an interface, that broke, with the strain of the specimen at that moment.

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
    /// The two balls, by their indices in the specimen.
    pub balls: [usize; 2],
    /// Middle of what broke (m).
    pub position: Vector<S>,
    /// Contact point (m).
    pub contact: Vector<S>,
    /// Unit normal of the contact; the crack lies across it.
    pub normal: Vector<S>,
    /// Which element of the interface broke, from 0.
    pub element: u32,
    /// Elements of the interface, of equal area; 1 for a bond that breaks as a whole.
    pub elements: u32,
    /// Length of the crack, the diameter of the bond or of the element (m).
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
        // Walls are never bonded.
        let other = if let Other::Particle(other) = crack.other { other } else { crack.particle };
        let balls = [crack.particle, other];
        let [first, second] = balls.map(|ball| usize::from(engine.group(ball).0));
        cracks.push(CrackEvent {
            strain: strain + share * (now - strain),
            mode: crack.mode,
            groups: [first.min(second), first.max(second)],
            balls,
            position: crack.position,
            contact: crack.contact,
            normal: crack.normal,
            element: crack.element,
            elements: crack.elements,
            size: crack.size,
        });
    }
}
