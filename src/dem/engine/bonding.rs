//! Bonds put into contacts, and overlaps taken as the state of rest.

use super::Engine;
use crate::dem::contact::{Key, Packed};
use crate::dem::interaction::Bond;
use crate::dem::law::{REFERENCE, Rows, SHEAR};
use crate::dem::space::Space;
use crate::math::random::Stream;

impl<S: Space> Engine<S> {
    /// Installs the bond of its class into every unbonded contact whose gap is at most `gap` (m); how many.
    ///
    /// The bond starts without force. A negative gap becomes the reference gap (a contact bond takes any gap), and the
    /// spring's shear force is dropped with its overlap. Strengths are drawn per contact from N(mean, deviation),
    /// negative ones again, from the stream "bond strength" of `seed`, contacts in the caller's order.
    pub fn install_bonds(&mut self, gap: f64, seed: u64) -> usize {
        // Bonded bodies move little: begin with a narrow list.
        self.margin = (0.02 * self.smallest_radius).max(1.01 * gap);
        self.relist();
        let mut listed = self.packed();
        let near = |k: &usize| {
            let (key, class) = listed.keys[*k];
            let bonded = listed.rows::<S>(*k)[Rows::<S>::TENSION] < f64::INFINITY;
            self.table.entries[class as usize].2.bond != Bond::None && !bonded && self.gap(key) <= gap
        };
        let mut chosen: Vec<usize> = (0..listed.keys.len()).filter(near).collect();
        chosen.sort_by_cached_key(|&k| self.caller_ends(listed.keys[k].0));
        let mut stream = Stream::new(seed, "bond strength", 0);
        for &k in &chosen {
            self.install_bond(&mut listed, k, &mut stream);
        }
        self.adopt(&listed);
        self.choose_masses();
        chosen.len()
    }

    /// The caller's places of the two ends, the smaller first; walls after all particles.
    fn caller_ends(&self, key: Key) -> (usize, usize) {
        let i = self.caller[key.i as usize] as usize;
        let j = if key.at_wall { self.caller.len() + key.j as usize } else { self.caller[key.j as usize] as usize };
        (i.min(j), i.max(j))
    }

    fn install_bond(&self, listed: &mut Packed, k: usize, stream: &mut Stream) {
        let (key, class) = listed.keys[k];
        let (gap, radii) = (self.gap(key), self.contact_radii(key));
        let rows = listed.rows_mut::<S>(k);
        let (strengths, deviation, section, stiffness, reference) = match self.table.entries[class as usize].2.bond {
            Bond::None => return,
            Bond::Contact(b) => {
                let section = S::section(radii[0].min(radii[1]));
                ([b.tensile_strength, b.shear_strength], b.deviation, section, 0.0, gap)
            }
            Bond::Parallel(b) => {
                let reference = if gap < 0.0 { gap } else { rows[REFERENCE] };
                ([b.tensile_strength, b.cohesion], b.deviation, b.section::<S>(radii), b.normal::<S>(radii), reference)
            }
        };
        // A bond is in force where its capacity is finite, so an endless strength is the largest number.
        let capacity = strengths.map(|mean| (draw(mean, deviation, stream) * section).min(f64::MAX));
        rows[REFERENCE] = reference;
        rows[SHEAR..SHEAR + S::SHEAR].fill(0.0);
        rows[Rows::<S>::BOND..].fill(0.0);
        rows[Rows::<S>::TENSION] = capacity[0];
        rows[Rows::<S>::COHESION] = capacity[1];
        rows[Rows::<S>::BOND] = stiffness;
    }

    /// Takes every overlap, at walls too, as the state of rest: its gap becomes the reference gap and its forces vanish.
    pub fn absorb_overlaps(&mut self) {
        self.relist();
        let mut listed = self.packed();
        for k in 0..listed.keys.len() {
            let gap = self.gap(listed.keys[k].0);
            let rows = listed.rows_mut::<S>(k);
            if gap < rows[REFERENCE].min(0.0) {
                rows[REFERENCE] = gap;
                rows[SHEAR..SHEAR + S::SHEAR].fill(0.0);
            }
        }
        self.adopt(&listed);
        self.derive_step();
    }

    /// Bonds in force.
    pub fn bond_count(&self) -> usize {
        self.stretches().map(|(s, own)| own.filter(|&c| s.bonded::<S>(c)).count()).sum()
    }
}

/// A strength, never negative.
fn draw(mean: f64, deviation: f64, stream: &mut Stream) -> f64 {
    if deviation == 0.0 || !mean.is_finite() {
        return mean;
    }
    loop {
        let strength = mean * (1.0 + deviation * stream.normal());
        if strength > 0.0 {
            return strength;
        }
    }
}
