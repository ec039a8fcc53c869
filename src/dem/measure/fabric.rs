//! How the bodies hang together: coordination, fabric, forces between particles.

use crate::contact::{Contact, Other};
use crate::engine::Engine;
use crate::space::{Space, Tuple, Vector};

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
    let between = |c: &Contact<S>| c.active && matches!(c.other, Other::Particle(_));
    mean_dyad::<S>(engine.contacts().filter(between).map(|contact| contact.normal))
}

/// Mean of n_a n_b, row by row; zero for none.
pub(crate) fn mean_dyad<S: Space>(normals: impl Iterator<Item = Vector<S>>) -> [[f64; 3]; 3] {
    let (mut dyads, mut count) = (Dyads::<S>::default(), 0.0);
    for normal in normals {
        count += 1.0;
        dyads.add(normal, normal);
    }
    if count > 0.0 { dyads.sum.map(|row| row.map(|x| x / count)) } else { dyads.sum }
}

/// A sum of dyads a_i b_j.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dyads<S: Space> {
    /// Row by row; the third row and column are 0 in the plane.
    pub(crate) sum: [[f64; 3]; 3],
    space: std::marker::PhantomData<S>,
}

impl<S: Space> Default for Dyads<S> {
    fn default() -> Self {
        Self { sum: [[0.0; 3]; 3], space: std::marker::PhantomData }
    }
}

impl<S: Space> Dyads<S> {
    /// Adds one.
    pub(crate) fn add(&mut self, a: Vector<S>, b: Vector<S>) {
        for i in 0..S::DIMENSION {
            for j in 0..S::DIMENSION {
                self.sum[i][j] += a.at(i) * b.at(j);
            }
        }
    }
}

/// The force between two particles that touch or are bonded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The two particles, by their indices in the caller's list, the smaller first.
    pub ends: [usize; 2],
    /// Normal force, compression positive, N.
    pub normal: f64,
    /// Size of the force across the normal, N.
    pub shear: f64,
    /// Whether a bond carries part of it.
    pub bonded: bool,
}

/// The forces between particles, in the order of their ends. Force chains are those among them that carry more than the
/// mean (Radjai et al. 1998, doi:10.1103/PhysRevLett.80.61: the "strong" network).
pub fn links<S: Space>(engine: &Engine<S>) -> Vec<Link> {
    let link = |contact: Contact<S>| {
        let Other::Particle(second) = contact.other else { return None };
        let force = contact.force();
        let pull = force.dot(contact.normal);
        let across = force.minus(contact.normal.times(pull)).norm();
        let ends = [contact.particle.min(second), contact.particle.max(second)];
        contact.active.then_some(Link { ends, normal: -pull, shear: across, bonded: contact.bonded })
    };
    let mut links: Vec<Link> = engine.contacts().filter_map(link).collect();
    links.sort_unstable_by_key(|link| link.ends);
    links
}
