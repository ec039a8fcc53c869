//! The contact list: searched again when some body came half the margin far; contacts keep their state.
//!
//! A pair is listed while its surfaces are nearer than the margin, while it is bonded, and while it has a reference gap
//! or a broken interface and is nearer than the smallest radius, so that both outlive a loss of contact. The margin follows the
//! motion: it widens when lists grow old fast and narrows when they last, by step counts alone.

use super::Engine;
use super::domain::Domain;
use crate::body::position;
use crate::contact::{Key, LawKind, Rank, Reader, Section, Writer};
use crate::law::{KN, Memory, REFERENCE, bonded, fresh};
use crate::neighbour::pairs;
use crate::space::{Space, Tuple, Vector, flat};
use std::collections::{BTreeMap, BTreeSet};

/// Ends of contacts by what they have in common, each list in order.
pub(super) type Found = BTreeMap<Rank, Vec<[u32; 2]>>;

/// Limits of the margin over the smallest radius.
const NARROW: f64 = 0.01;
const WIDE: f64 = 0.5;
/// A list that lasts fewer (more) steps than this makes the margin wider (narrower): a wide margin costs idle contacts in
/// every step, a narrow one a search, which takes as long as some thirty steps.
const SHORT: u64 = 500;
const LONG: u64 = 2000;

impl<S: Space> Engine<S> {
    /// Searches contacts again, with a margin that follows how long the last list held.
    pub(super) fn relist_when_old(&mut self) {
        let age = self.step - self.listed_at;
        let factor = if age < SHORT {
            1.5
        } else if age > LONG {
            1.0 / 1.5
        } else {
            1.0
        };
        self.margin = (self.margin * factor).clamp(NARROW * self.smallest_radius, WIDE * self.smallest_radius);
        self.relist();
    }

    /// Searches contacts with the present margin.
    pub(super) fn relist(&mut self) {
        let found = self.candidates();
        self.deal(found, &[], |_, _, _| ());
        self.origins = (0..self.caller.len()).map(|p| position::<S>(&self.records, p)).collect();
        if let Some(cell) = &mut self.cell {
            cell.origin = cell.edges;
        }
        let stiffness = self.wall_stiffness();
        for (wall, stiffness) in self.walls.iter_mut().zip(stiffness) {
            (wall.origin, wall.stiffness) = (wall.face.point, stiffness);
        }
        self.travelled = 0.0;
        self.listed_at = self.step;
        self.stale = false;
    }

    /// Sum of the normal stiffnesses of the contacts of each wall, in the order of their balls.
    fn wall_stiffness(&self) -> Vec<f64> {
        let mut contacts: Vec<(Key, f64)> = Vec::new();
        for (section, own) in self.stretches().filter(|(section, _)| section.wall().is_some()) {
            contacts.extend(own.map(|c| (section.key(c), section.value::<S>(c, KN))));
        }
        contacts.sort_unstable_by_key(|(key, _)| *key);
        let mut sums = vec![0.0; self.walls.len()];
        contacts.into_iter().for_each(|(key, kn)| sums[key.j as usize] += kn);
        sums
    }

    /// Calls `change` with the memory of every contact in the order of the list. Classes that are `bonded` now get the
    /// rows of their law.
    pub(super) fn rewrite(&mut self, bonded: &[usize], change: impl FnMut(&Self, Key, &mut Memory)) {
        let mut all = Found::new();
        for (section, own) in self.stretches() {
            let ends = all.entry(section.rank).or_insert_with(|| Vec::with_capacity(section.count));
            ends.extend(own.map(|c| section.key(c)).map(|key| [key.i, key.j]));
        }
        self.deal(all, bonded, change);
    }

    /// Writes the contact list anew with what was `found`. A contact of the old list keeps its memory; one that was not
    /// found stays if it must not be forgotten. `change` sees every contact in the order of the list. The old list is
    /// given back piece by piece.
    fn deal(&mut self, mut found: Found, bonded: &[usize], mut change: impl FnMut(&Self, Key, &mut Memory)) {
        self.close_accounts();
        let cuts = self.cuts(&found);
        let mut old: BTreeMap<Rank, Vec<Section>> = BTreeMap::new();
        let mut loads = Vec::new();
        for domain in std::mem::take(&mut self.domains) {
            loads.push(domain.loads);
            for section in domain.sections {
                old.entry(section.rank).or_default().push(section);
            }
        }
        let mut domains = self.divide(&cuts, loads);
        let ranks: BTreeSet<Rank> = old.keys().chain(found.keys()).copied().collect();
        for rank in ranks {
            let (ends, sections) = (found.remove(&rank).unwrap_or_default(), old.remove(&rank).unwrap_or_default());
            let law = self.classes[rank.class].law;
            let cemented = bonded.contains(&rank.class) || sections.iter().any(|s| s.law == law);
            let law = if law.begins_linear() && !cemented { LawKind::Linear } else { law };
            let mut writer = Writer::new(rank, law, &cuts, ends.len());
            self.merge(rank, &ends, Reader::new(sections), |key, mut memory| {
                change(self, key, &mut memory);
                writer.push::<S>(key, &memory);
            });
            for (domain, section) in domains.iter_mut().zip(writer.sections) {
                domain.sections.extend((section.count > 0).then_some(section));
            }
        }
        if self.energy_sums.is_some() {
            domains.iter_mut().for_each(Domain::track_energy);
        }
        self.domains = domains;
    }

    /// The contacts of one rank in their order: what was found, with the memory of the old contacts, and old ones that
    /// must not be forgotten.
    fn merge(&self, rank: Rank, found: &[[u32; 2]], mut old: Reader, mut put: impl FnMut(Key, Memory)) {
        let keep = |key: Key, old: &mut Reader, put: &mut dyn FnMut(Key, Memory)| {
            let memory = old.take::<S>();
            // A contact that a joint took is not this one any more.
            if self.memorable(key, &memory) && self.class_of(key) as usize == rank.class {
                put(key, memory);
            }
        };
        for &ends in found {
            let key = rank.key(ends);
            while let Some(earlier) = old.key().filter(|&earlier| earlier < key) {
                keep(earlier, &mut old, &mut put);
            }
            let mut memory = if old.key() == Some(key) { old.take::<S>() } else { fresh::<S>() };
            self.set_stiffness(key, &mut memory);
            put(key, memory);
        }
        while let Some(later) = old.key() {
            keep(later, &mut old, &mut put);
        }
    }

    /// Whether a contact that was not found must not be forgotten.
    fn memorable(&self, key: Key, memory: &Memory) -> bool {
        if key.at_wall && !self.walls[key.j as usize].present {
            return false;
        }
        let near = memory[REFERENCE] != 0.0 || !memory.tail.is_empty();
        bonded::<S>(memory) || (near && self.gap(key) < self.smallest_radius)
    }

    /// Everything nearer than the margin.
    fn candidates(&self) -> Found {
        let n = self.caller.len();
        let centres: Vec<[f64; 3]> = (0..n).map(|p| flat::<S>(position::<S>(&self.records, p))).collect();
        let mut found = Found::new();
        let mut put = |key: Key| {
            let second = if key.at_wall { key.j } else { u32::from(key.image) };
            let rank = Rank { at_wall: key.at_wall, class: self.class_of(key) as usize, second };
            found.entry(rank).or_default().push([key.i, key.j]);
        };
        pairs(&centres, &self.radii, &self.bodies, self.margin, |i, j| put(Key { i, at_wall: false, j, image: 0 }));
        for (w, wall) in self.walls.iter().enumerate().filter(|(_, wall)| wall.present) {
            for p in 0..n {
                let x = position::<S>(&self.records, p);
                let gap = x.minus(wall.face.point).dot(wall.face.normal) - self.radii[p];
                if gap < self.margin {
                    put(Key { i: p as u32, at_wall: true, j: w as u32, image: 0 });
                }
            }
        }
        self.across(centres, put);
        found
    }

    /// Contacts across the faces of a periodic cell, each once: from the particle that comes first.
    fn across(&self, mut centres: Vec<[f64; 3]>, mut put: impl FnMut(Key)) {
        let Some(cell) = &self.cell else { return };
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let n = centres.len();
        let positions: Vec<Vector<S>> = (0..n).map(|p| position::<S>(&self.records, p)).collect();
        let images = cell.images_near(&positions, 2.0 * largest + self.margin);
        centres.extend(images.iter().map(|(_, _, y)| flat::<S>(*y)));
        let origins: Vec<usize> = (0..n).chain(images.iter().map(|&(p, ..)| p)).collect();
        let radii: Vec<f64> = origins.iter().map(|&p| self.radii[p]).collect();
        let bodies: Vec<u32> = origins.iter().map(|&p| self.bodies[p]).collect();
        pairs(&centres, &radii, &bodies, self.margin, |i, k| {
            if (i as usize) < n && k as usize >= n && (i as usize) < origins[k as usize] {
                let (j, image, _) = images[k as usize - n];
                put(Key { i, at_wall: false, j: j as u32, image });
            }
        });
    }

    /// Distance of the surfaces of a pair, m.
    pub(super) fn gap(&self, key: Key) -> f64 {
        let i = key.i as usize;
        let x = position::<S>(&self.records, i);
        if key.at_wall {
            let face = &self.walls[key.j as usize].face;
            return x.minus(face.point).dot(face.normal) - self.radii[i];
        }
        self.apart(key).norm() - (self.radii[i] + self.radii[key.j as usize])
    }

    /// From the centre of the first particle of a pair to that of the second, or to its image, m.
    pub(super) fn apart(&self, key: Key) -> Vector<S> {
        let [x, y] = [key.i, key.j].map(|p| position::<S>(&self.records, p as usize));
        let apart = y.minus(x);
        if key.image == 0 { apart } else { apart.plus(self.shift(key)) }
    }

    /// From the second particle of a pair to the image of the pair, m.
    pub(super) fn shift(&self, key: Key) -> Vector<S> {
        match &self.cell {
            Some(cell) if key.image != 0 => cell.image(key.image).shift,
            _ => Vector::<S>::zero(),
        }
    }

    /// Gives a contact the stiffness of its class and radii. An incremental spring keeps its force.
    pub(super) fn set_stiffness(&self, key: Key, rows: &mut Memory) {
        if rows.tail.is_empty() {
            self.begin_joint(key, rows);
        }
        let (class, kn) = (self.class_of(key), self.linear_stiffness(key));
        if self.classes[class as usize].constants.incremental && rows[KN] > 0.0 && rows[KN] != kn {
            let gap = self.gap(key);
            let overlap = rows[REFERENCE] - gap;
            if overlap > 0.0 {
                rows[REFERENCE] = gap + overlap * rows[KN] / kn;
            }
        }
        // An interface stands in place of the spring.
        rows[KN] = if rows.tail.is_empty() { kn } else { 0.0 };
    }

    /// Radii on both sides of a contact, ∞ for a wall.
    pub(super) fn contact_radii(&self, key: Key) -> [f64; 2] {
        let second = if key.at_wall { f64::INFINITY } else { self.radii[key.j as usize] };
        [self.radii[key.i as usize], second]
    }

    /// Class of a contact: that of its pair of groups, or of the joint that it crosses, after those of all pairs.
    pub(super) fn class_of(&self, key: Key) -> u32 {
        self.joint_of(key).map_or_else(|| self.pair_class(key), |set| (self.table.entries.len() + set) as u32)
    }

    /// Class of a pair of groups. Checked with the model: every pair that can meet has one.
    fn pair_class(&self, key: Key) -> u32 {
        let other = if key.at_wall { self.walls[key.j as usize].group } else { self.groups[key.j as usize] };
        let class = self.table.class(self.groups[key.i as usize], other);
        class.unwrap_or_else(|| panic!("BUG: groups {:?} and {other:?} have no class", self.groups[key.i as usize]))
            as u32
    }

    pub(super) fn linear_stiffness(&self, key: Key) -> f64 {
        let interaction = &self.table.entries[self.pair_class(key) as usize].2;
        interaction.linear.stiffness.normal::<S>(self.contact_radii(key))
    }

    /// Largest distance that any particle or wall came since the list was made, m.
    pub(super) fn true_travel(&self) -> f64 {
        let moved = |(p, origin): (usize, &Vector<S>)| position::<S>(&self.records, p).minus(*origin).norm();
        let balls = self.origins.iter().enumerate().map(moved).fold(0.0, f64::max);
        let bodies = self.walls.iter().map(|w| w.face.point.minus(w.origin).norm()).fold(balls, f64::max);
        self.cell.as_ref().map_or(bodies, |cell| bodies + 0.5 * cell.travelled())
    }
}
