//! Bonds put into contacts, and overlaps taken as the state of rest.

use super::Engine;
use crate::contact::Key;
use crate::error::Faults;
use crate::interaction::{Bond, FlatJoint};
use crate::law::{Memory, REFERENCE, RowIndex, SHEAR, join};
use crate::space::Space;
use crate::strength::Strength;
use math::random::Stream;

impl<S: Space> Engine<S> {
    /// Installs the bond of its class into every unbonded contact whose gap is at most `gap` (m); how many.
    ///
    /// The bond starts without force. A negative gap becomes the reference gap (a contact bond takes any gap), and the
    /// spring's shear force is dropped with its overlap. Strengths are drawn per contact, tension first
    /// ([`strength`](crate::strength)), from the stream "bond strength" of `seed`, contacts in the caller's order. A flat
    /// joint takes any gap as well; which of them are bonded, gapped or slit is drawn from the stream "interface". All three
    /// count.
    ///
    /// # Errors
    /// A gap that is not finite or above the largest radius.
    pub fn install_bonds(&mut self, gap: f64, seed: u64) -> Result<usize, Faults> {
        self.admit_gap(gap)?;
        // Bonded bodies move little: begin with a narrow list.
        self.margin = (0.02 * self.smallest_radius).max(1.01 * gap);
        self.relist();
        let mut chosen: Vec<(Key, u32)> = Vec::new();
        let mut classes: Vec<usize> = Vec::new();
        for (section, own) in self.stretches() {
            let class = section.rank.class;
            if self.table.entries.get(class).is_none_or(|entry| entry.2.bond == Bond::None) {
                continue;
            }
            let before = chosen.len();
            let near = own.filter(|&c| !section.joined::<S>(c)).map(|c| section.key(c));
            chosen.extend(near.filter(|&key| self.gap(key) <= gap).zip(before as u32..));
            classes.extend((chosen.len() > before).then_some(class));
        }
        let strengths = self.draw_strengths(&mut chosen, &mut Stream::new(seed, "bond strength", 0));
        let kinds = self.draw_kinds(&mut chosen, &mut Stream::new(seed, "interface", 0));
        chosen.sort_unstable_by_key(|&(_, order)| order);
        let mut next = 0;
        self.rewrite(&classes, |engine, key, memory| {
            if chosen.get(next).is_some_and(|&(chosen, _)| chosen == key) {
                engine.install_bond(key, memory, strengths[next], kinds[next]);
                next += 1;
            }
        });
        self.choose_masses();
        Ok(chosen.len())
    }

    /// Strengths of the chosen contacts, drawn in the caller's order; each at the index of its contact.
    fn draw_strengths(&self, chosen: &mut [(Key, u32)], stream: &mut Stream) -> Vec<[f64; 2]> {
        chosen.sort_unstable_by_key(|&(key, order)| (self.caller_ends(key), order));
        let laws: Vec<Option<[Strength; 2]>> =
            self.table.entries.iter().map(|entry| strengths(&entry.2.bond)).collect();
        let mut drawn = vec![[0.0; 2]; chosen.len()];
        for &(key, order) in &*chosen {
            if let Some(laws) = &laws[self.class_of(key) as usize] {
                drawn[order as usize] = laws.map(|law| law.draw(stream));
            }
        }
        drawn
    }

    /// Whether each chosen interface is bonded, gapped or slit, drawn in the caller's order; bonds of other laws are bonded.
    fn draw_kinds(&self, chosen: &mut [(Key, u32)], stream: &mut Stream) -> Vec<Kind> {
        chosen.sort_unstable_by_key(|&(key, order)| (self.caller_ends(key), order));
        let mut drawn = vec![Kind::Bonded; chosen.len()];
        for &(key, order) in &*chosen {
            if let Bond::Flat(joint) = &self.table.entries[self.class_of(key) as usize].2.bond {
                let (draw, shares) = (stream.uniform(), &joint.shares);
                if draw < shares.gapped {
                    drawn[order as usize] = Kind::Gapped;
                } else if draw < shares.gapped + shares.slit {
                    drawn[order as usize] = Kind::Slit;
                }
            }
        }
        drawn
    }

    /// The caller's indices of the two ends, the smaller first; walls after all particles.
    fn caller_ends(&self, key: Key) -> (usize, usize) {
        let i = self.caller[key.i as usize] as usize;
        let j = if key.at_wall { self.caller.len() + key.j as usize } else { self.caller[key.j as usize] as usize };
        (i.min(j), i.max(j))
    }

    fn install_bond(&self, key: Key, rows: &mut Memory, strengths: [f64; 2], kind: Kind) {
        let (gap, radii) = (self.gap(key), self.contact_radii(key));
        let (section, stiffness, reference) = match self.table.entries[self.class_of(key) as usize].2.bond {
            Bond::None => return,
            Bond::Flat(joint) => return self.install_joint(key, rows, &joint, strengths, kind),
            Bond::Contact(_) => (S::section(radii[0].min(radii[1])), 0.0, gap),
            Bond::Parallel(b) => {
                let reference = if gap < 0.0 { gap } else { rows[REFERENCE] };
                (b.section::<S>(radii), b.normal::<S>(radii), reference)
            }
        };
        // A bond is in force where its capacity is finite, so an endless strength is the largest number.
        let capacity = strengths.map(|strength| (strength * section).min(f64::MAX));
        rows[REFERENCE] = reference;
        rows[SHEAR..SHEAR + S::SHEAR].fill(0.0);
        rows[RowIndex::<S>::BOND..].fill(0.0);
        rows[RowIndex::<S>::TENSION] = capacity[0];
        rows[RowIndex::<S>::COHESION] = capacity[1];
        rows[RowIndex::<S>::BOND] = stiffness;
    }

    /// An interface in place of the contact.
    fn install_joint(&self, key: Key, rows: &mut Memory, joint: &FlatJoint, strengths: [f64; 2], kind: Kind) {
        let (gap, radii) = (self.gap(key), self.contact_radii(key));
        let section = joint.section::<S>(radii);
        let capacity = (kind == Kind::Bonded).then(|| strengths.map(|strength| strength * section));
        let origin = if kind == Kind::Gapped { gap - joint.shares.gap } else { gap };
        let layout = &self.classes[self.class_of(key) as usize].constants.layout;
        rows[SHEAR..SHEAR + S::SHEAR].fill(0.0);
        rows[RowIndex::<S>::BOND..].fill(0.0);
        join::<S>(rows, layout, origin, joint.normal::<S>(radii), capacity, self.normal_of(key));
    }

    /// Takes every overlap, at walls too, as the state of rest: its gap becomes the reference gap and its forces vanish.
    pub fn absorb_overlaps(&mut self) {
        self.relist();
        self.rewrite(&[], |engine, key, memory| {
            let gap = engine.gap(key);
            if gap < memory[REFERENCE].min(0.0) {
                memory[REFERENCE] = gap;
                memory[SHEAR..SHEAR + S::SHEAR].fill(0.0);
            }
        });
        self.derive_step();
    }

    /// Bonds in force.
    pub fn bond_count(&self) -> usize {
        self.stretches().map(|(s, own)| own.filter(|&c| s.bonded::<S>(c)).count()).sum()
    }
}

/// How an interface is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bonded,
    Gapped,
    Slit,
}

/// The laws of the two strengths of a bond, tension first.
fn strengths(bond: &Bond) -> Option<[Strength; 2]> {
    let (means, scatter) = match bond {
        Bond::None => return None,
        Bond::Contact(b) => ([b.tensile_strength, b.shear_strength], b.scatter),
        Bond::Parallel(b) => ([b.tensile_strength, b.cohesion], b.scatter),
        Bond::Flat(b) => ([b.tensile_strength, b.cohesion], b.scatter),
    };
    let law = |mean, deviation| Strength::new(mean, deviation, scatter.distribution);
    Some([law(means[0], scatter.tensile), law(means[1], scatter.shear)])
}
