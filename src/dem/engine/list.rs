//! The contact list: searched again when some body came half the margin far; contacts keep their state.
//!
//! A pair is listed while its surfaces are nearer than the margin, while it is bonded, and while it has a reference gap
//! and is nearer than the smallest radius, so that a reference gap outlives a loss of contact. The margin follows the
//! motion: it widens when lists grow old fast and narrows when they last, by step counts alone.

use super::Engine;
use crate::dem::body::position;
use crate::dem::contact::{Key, Packed};
use crate::dem::law::{KN, REFERENCE, Rows};
use crate::dem::neighbour::pairs;
use crate::dem::space::{Space, Tuple, Vector};

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
        self.close_ledgers();
        let old = self.packed();
        // The blocks are written anew; two lists at a time are enough memory.
        self.domains.iter_mut().for_each(|domain| domain.sections = Vec::new());
        let found = self.candidates();
        let listed = self.merge(&old, &found);
        drop(old);
        self.adopt(&listed);
    }

    /// Makes `listed` (sorted by key) the contact list, as of now.
    pub(super) fn adopt(&mut self, listed: &Packed) {
        self.divide(listed);
        self.origins = (0..self.caller.len()).map(|p| position::<S>(&self.records, p)).collect();
        if let Some(cell) = &mut self.cell {
            cell.origin = cell.edges;
        }
        for wall in &mut self.walls {
            wall.origin = wall.face.point;
            wall.stiffness = 0.0;
        }
        for (k, (key, _)) in listed.keys.iter().enumerate().filter(|(_, (key, _))| key.at_wall) {
            self.walls[key.j as usize].stiffness += listed.rows::<S>(k)[KN];
        }
        self.travelled = 0.0;
        self.listed_at = self.step;
        self.stale = false;
    }

    /// All contacts, sorted by key.
    pub(super) fn packed(&self) -> Packed {
        let mut places: Vec<_> = Vec::new();
        for (section, own) in self.stretches() {
            places.extend(own.map(|c| (section.key(c), section, c)));
        }
        places.sort_unstable_by_key(|place| place.0);
        let mut packed = Packed::with_capacity::<S>(places.len());
        for (_, section, c) in places {
            section.pack::<S>(c, &mut packed);
        }
        packed
    }

    /// Keys of everything nearer than the margin, sorted.
    fn candidates(&self) -> Vec<Key> {
        let n = self.caller.len();
        let positions: Vec<Vector<S>> = (0..n).map(|p| position::<S>(&self.records, p)).collect();
        let flat: Vec<[f64; 3]> = positions.iter().map(coordinates::<S>).collect();
        let mut keys: Vec<Key> = pairs(&flat, &self.radii, &self.bodies, self.margin)
            .into_iter()
            .map(|(i, j)| Key { i, at_wall: false, j, image: 0 })
            .collect();
        for (w, wall) in self.walls.iter().enumerate().filter(|(_, wall)| wall.present) {
            for (p, x) in positions.iter().enumerate() {
                let gap = x.minus(wall.face.point).dot(wall.face.normal) - self.radii[p];
                if gap < self.margin {
                    keys.push(Key { i: p as u32, at_wall: true, j: w as u32, image: 0 });
                }
            }
        }
        keys.extend(self.across(&positions));
        keys.sort_unstable();
        keys
    }

    /// Keys of the contacts across the faces of a periodic cell, each once: from the particle that comes first.
    fn across(&self, positions: &[Vector<S>]) -> Vec<Key> {
        let Some(cell) = &self.cell else { return Vec::new() };
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let images = cell.images_near(positions, 2.0 * largest + self.margin);
        let n = positions.len();
        let places = positions.iter().chain(images.iter().map(|(_, _, y)| y));
        let flat: Vec<[f64; 3]> = places.map(coordinates::<S>).collect();
        let origins: Vec<usize> = (0..n).chain(images.iter().map(|&(p, ..)| p)).collect();
        let radii: Vec<f64> = origins.iter().map(|&p| self.radii[p]).collect();
        let bodies: Vec<u32> = origins.iter().map(|&p| self.bodies[p]).collect();
        let found = pairs(&flat, &radii, &bodies, self.margin).into_iter();
        let outward = found.filter(|&(i, k)| (i as usize) < n && k as usize >= n && (i as usize) < origins[k as usize]);
        let key = |(i, k): (u32, u32)| {
            let (j, image, _) = images[k as usize - n];
            Key { i, at_wall: false, j: j as u32, image }
        };
        outward.map(key).collect()
    }

    /// The new list: what was found, with the state of the old contacts, and old ones that must not be forgotten.
    fn merge(&self, old: &Packed, found: &[Key]) -> Packed {
        let mut listed = Packed::with_capacity::<S>(found.len());
        let mut next = 0;
        for &key in found {
            while next < old.keys.len() && old.keys[next].0 < key {
                self.keep_if_needed(old, next, &mut listed);
                next += 1;
            }
            if next < old.keys.len() && old.keys[next].0 == key {
                listed.push_old::<S>(old, next);
                next += 1;
            } else {
                listed.push_new::<S>(key, self.class_of(key), 0.0);
            }
            let last = listed.keys.len() - 1;
            self.set_stiffness(key, listed.rows_mut::<S>(last));
        }
        for k in next..old.keys.len() {
            self.keep_if_needed(old, k, &mut listed);
        }
        listed
    }

    fn keep_if_needed(&self, old: &Packed, k: usize, listed: &mut Packed) {
        let key = old.keys[k].0;
        if key.at_wall && !self.walls[key.j as usize].present {
            return;
        }
        let rows = old.rows::<S>(k);
        let bonded = rows[Rows::<S>::TENSION] < f64::INFINITY;
        let remembered = rows[REFERENCE] != 0.0 && self.gap(key) < self.smallest_radius;
        if bonded || remembered {
            listed.push_old::<S>(old, k);
        }
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

    /// From the second particle of a pair to the image that is meant, m.
    pub(super) fn shift(&self, key: Key) -> Vector<S> {
        match &self.cell {
            Some(cell) if key.image != 0 => cell.image(key.image).shift,
            _ => Vector::<S>::zero(),
        }
    }

    /// Gives a contact the stiffness of its class and radii. An incremental spring keeps its force.
    pub(super) fn set_stiffness(&self, key: Key, rows: &mut [f64]) {
        let (class, kn) = (self.class_of(key), self.linear_stiffness(key));
        if self.classes[class as usize].constants.incremental && rows[KN] > 0.0 && rows[KN] != kn {
            let gap = self.gap(key);
            let overlap = rows[REFERENCE] - gap;
            if overlap > 0.0 {
                rows[REFERENCE] = gap + overlap * rows[KN] / kn;
            }
        }
        rows[KN] = kn;
    }

    /// Radii that a contact stands between, ∞ for a wall.
    pub(super) fn contact_radii(&self, key: Key) -> [f64; 2] {
        let second = if key.at_wall { f64::INFINITY } else { self.radii[key.j as usize] };
        [self.radii[key.i as usize], second]
    }

    /// Class of a pair. Checked with the model: every pair that can meet has one.
    pub(super) fn class_of(&self, key: Key) -> u32 {
        let other = if key.at_wall { self.walls[key.j as usize].group } else { self.groups[key.j as usize] };
        let class = self.table.class(self.groups[key.i as usize], other);
        class.unwrap_or_else(|| panic!("BUG: groups {:?} and {other:?} have no class", self.groups[key.i as usize]))
            as u32
    }

    pub(super) fn linear_stiffness(&self, key: Key) -> f64 {
        let interaction = &self.table.entries[self.class_of(key) as usize].2;
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

/// Three coordinates, the third 0 in the plane.
pub(super) fn coordinates<S: Space>(x: &Vector<S>) -> [f64; 3] {
    std::array::from_fn(|k| if k < S::DIMENSION { x.at(k) } else { 0.0 })
}
