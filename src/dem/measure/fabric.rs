//! How the bodies hang together: coordination, fabric, force chains.

use crate::dem::contact::{Contact, Other};
use crate::dem::engine::Engine;
use crate::dem::space::{Space, Tuple, Vector};

/// Contacts and bonds per body (a clump is one body).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordination {
    /// Active contacts of a body with other bodies, mean.
    pub contacts: f64,
    /// Bonds of a body with other bodies, mean.
    pub bonds: f64,
    /// Share of bodies with fewer than two active contacts (walls count).
    pub rattlers: f64,
}

/// Mean coordination; contacts between bodies count for both.
pub fn coordination<S: Space>(engine: &Engine<S>) -> Coordination {
    let (n, clumps) = (engine.particle_count(), engine.clump_count());
    let singles = (0..n).filter(|&p| engine.clump_of(p).is_none()).count();
    let body = |particle: usize| engine.clump_of(particle).unwrap_or(clumps + particle);
    let mut touched = vec![0_u32; clumps + n];
    let (mut contacts, mut bonds) = (0, 0);
    for contact in engine.contacts().filter(|c| c.active) {
        touched[body(contact.particle)] += 1;
        if let Other::Particle(second) = contact.other {
            touched[body(second)] += 1;
            contacts += 2;
            bonds += if contact.bonded { 2 } else { 0 };
        }
    }
    let alone = |p: &usize| engine.clump_of(*p).is_none() && touched[clumps + p] < 2;
    let rattlers = (0..n).filter(alone).count() + touched[..clumps].iter().filter(|&&t| t < 2).count();
    let bodies = (singles + clumps) as f64;
    Coordination {
        contacts: f64::from(contacts) / bodies,
        bonds: f64::from(bonds) / bodies,
        rattlers: rattlers as f64 / bodies,
    }
}

/// Fabric tensor: mean of n_a n_b over the active contacts between bodies, row by row; zero where nothing touches.
pub fn fabric<S: Space>(engine: &Engine<S>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    let mut count = 0.0;
    for contact in engine.contacts().filter(|c| c.active && matches!(c.other, Other::Particle(_))) {
        count += 1.0;
        for a in 0..S::DIMENSION {
            for b in 0..S::DIMENSION {
                sum[a][b] += contact.normal.at(a) * contact.normal.at(b);
            }
        }
    }
    if count > 0.0 { sum.map(|row| row.map(|x| x / count)) } else { sum }
}

/// One link of a force chain.
#[derive(Clone, Copy, Debug)]
pub struct Chain<S: Space> {
    /// Centre of the first end, m.
    pub from: Vector<S>,
    /// Centre of the second end (or the point on the wall), m.
    pub to: Vector<S>,
    /// Normal force, compression positive, N.
    pub normal_force: f64,
    /// Whole force, N.
    pub force: f64,
}

/// Links that carry at least `share` of the mean contact force.
pub fn force_chains<S: Space>(engine: &Engine<S>, share: f64) -> Vec<Chain<S>> {
    let active: Vec<Contact<S>> = engine.contacts().filter(|c| c.active).collect();
    let sizes: Vec<f64> = active.iter().map(|c| c.force().norm()).collect();
    let mean = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
    let link = |(contact, &force): (&Contact<S>, &f64)| {
        let from = engine.position(contact.particle);
        let to = from.plus(contact.branch);
        Chain { from, to, normal_force: -contact.force().dot(contact.normal), force }
    };
    active.iter().zip(&sizes).filter(|(_, size)| **size >= share * mean).map(link).collect()
}
