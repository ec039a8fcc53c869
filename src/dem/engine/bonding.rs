//! Bonds put into contacts, and overlaps taken as the state of rest.

use super::Engine;
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
        self.margin = self.margin.max(1.01 * gap);
        self.relist();
        let mut order: Vec<(usize, usize, usize, usize)> = Vec::new();
        for (s, section) in self.sections.iter().enumerate() {
            for c in 0..section.count {
                let key = section.key(c);
                let near = self.gap(key) <= gap && !section.bonded::<S>(c);
                if near && self.table.entries[section.class].2.bond != Bond::None {
                    let i = self.caller[key.i as usize] as usize;
                    let j = if key.at_wall {
                        self.caller.len() + key.j as usize
                    } else {
                        self.caller[key.j as usize] as usize
                    };
                    order.push((i.min(j), i.max(j), s, c));
                }
            }
        }
        order.sort_unstable();
        let mut stream = Stream::new(seed, "bond strength", 0);
        for &(_, _, s, c) in &order {
            self.install_bond(s, c, &mut stream);
        }
        self.derive_step();
        order.len()
    }

    fn install_bond(&mut self, s: usize, c: usize, stream: &mut Stream) {
        let key = self.sections[s].key(c);
        let (gap, radii) = (self.gap(key), self.contact_radii(key));
        let small = radii[0].min(radii[1]);
        let bond = self.table.entries[self.sections[s].class].2.bond;
        let (strengths, deviation, section, stiffness, reference) = match bond {
            Bond::None => return,
            Bond::Contact(b) => ([b.tensile_strength, b.shear_strength], b.deviation, S::section(small), 0.0, gap),
            Bond::Parallel(b) => {
                let reference = if gap < 0.0 { gap } else { self.sections[s].value::<S>(c, REFERENCE) };
                ([b.tensile_strength, b.cohesion], b.deviation, b.section::<S>(radii), b.normal::<S>(radii), reference)
            }
        };
        let capacity = strengths.map(|mean| (draw(mean, deviation, stream) * section).min(f64::MAX));
        let rows = &mut self.sections[s];
        rows.set_value::<S>(c, REFERENCE, reference);
        for k in 0..S::SHEAR {
            rows.set_value::<S>(c, SHEAR + k, 0.0);
        }
        for row in Rows::<S>::BOND..Rows::<S>::COUNT {
            rows.set_value::<S>(c, row, 0.0);
        }
        rows.set_value::<S>(c, Rows::<S>::TENSION, capacity[0]);
        rows.set_value::<S>(c, Rows::<S>::COHESION, capacity[1]);
        rows.set_value::<S>(c, Rows::<S>::BOND, stiffness);
    }

    /// Takes every overlap, at walls too, as the state of rest: its gap becomes the reference gap and its forces vanish.
    pub fn absorb_overlaps(&mut self) {
        self.relist();
        for s in 0..self.sections.len() {
            for c in 0..self.sections[s].count {
                let gap = self.gap(self.sections[s].key(c));
                if gap < self.sections[s].value::<S>(c, REFERENCE).min(0.0) {
                    self.sections[s].set_value::<S>(c, REFERENCE, gap);
                    for k in 0..S::SHEAR {
                        self.sections[s].set_value::<S>(c, SHEAR + k, 0.0);
                    }
                }
            }
        }
        self.derive_step();
    }

    /// Bonds in force.
    pub fn bond_count(&self) -> usize {
        self.sections.iter().map(|s| (0..s.count).filter(|&c| s.bonded::<S>(c)).count()).sum()
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
