//! How far from equilibrium: the unbalanced ratio.

use crate::contact::Other;
use crate::engine::Engine;
use crate::space::{Space, Tuple, Vector};

/// Mean |unbalanced force| of the bodies over the mean sum of |contact forces| on them (PFC `aratio`), gravity and
/// applied forces included; 0 where nothing touches. Usual limits: 10⁻³ while packing, 10⁻⁵ before a test. Bodies that are held are left out.
pub fn unbalanced_ratio<S: Space>(engine: &Engine<S>) -> f64 {
    let n = engine.particle_count();
    let clumps = engine.clump_count();
    let body = |particle: usize| engine.clump_of(particle).unwrap_or(clumps + particle);
    let mut unbalanced = vec![Vector::<S>::zero(); clumps + n];
    let mut sums = vec![0.0; clumps + n];
    let gravity = engine.settings().gravity;
    for clump in 0..clumps {
        unbalanced[clump] = gravity.times(engine.clump_mass(clump));
    }
    for particle in (0..n).filter(|&p| engine.clump_of(p).is_none()) {
        unbalanced[clumps + particle] = gravity.times(engine.mass(particle));
    }
    for particle in 0..n {
        let body = body(particle);
        unbalanced[body] = unbalanced[body].plus(engine.applied_force(particle));
    }
    for contact in engine.contacts().filter(|c| c.active) {
        let force = contact.force();
        let size = force.norm();
        let first = body(contact.particle);
        unbalanced[first] = unbalanced[first].plus(force);
        sums[first] += size;
        if let Other::Particle(second) = contact.other {
            let second = body(second);
            unbalanced[second] = unbalanced[second].minus(force);
            sums[second] += size;
        }
    }
    let held = |b: usize| b >= clumps && engine.is_fixed(b - clumps);
    let free = (0..clumps + n).filter(|&b| !held(b));
    let (mut above, mut below) = (0.0, 0.0);
    for b in free {
        above += unbalanced[b].norm();
        below += sums[b];
    }
    if below > 0.0 { above / below } else { 0.0 }
}
