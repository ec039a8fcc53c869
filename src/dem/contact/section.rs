//! Contacts of one class, in blocks of eight; between them the classes hold the whole list.
//!
//! The order of contacts (class, wall or image, i, j) decides the order of every sum, so it depends on nothing but the contacts.

use crate::dem::interaction::Bond;
use crate::dem::law::{KN, LEDGER, REFERENCE, Rows};
use crate::dem::simd::{Row, WIDEST};
use crate::dem::space::Space;
use std::ops::Range;

/// Which law a class follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LawKind {
    Linear,
    ContactBond,
    ParallelBond,
}

impl LawKind {
    pub(crate) fn of(bond: &Bond) -> Self {
        match bond {
            Bond::None => Self::Linear,
            Bond::Contact(_) => Self::ContactBond,
            Bond::Parallel(_) => Self::ParallelBond,
        }
    }
}

/// Who meets whom, in the engine's numbering: i with particle j, or with wall j.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    /// The first particle.
    pub(crate) i: u32,
    /// True when j is a wall.
    pub(crate) at_wall: bool,
    /// The second particle (above i), or the wall.
    pub(crate) j: u32,
    /// Image of the second particle in a periodic cell; 0 for itself.
    pub(crate) image: u8,
}

/// Contacts of one class: between particles, or with one wall.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// Place in the contact table.
    pub(crate) class: usize,
    /// The wall, for contacts with one.
    pub(crate) wall: Option<u32>,
    /// Image of the second ends in a periodic cell; 0 for themselves.
    pub(crate) image: u8,
    /// Real contacts; the last block is filled up with idle ones.
    pub(crate) count: usize,
    /// The contacts before this one belong to another stretch, which computes them too.
    pub(crate) own_from: usize,
    /// Ends of each block: i, then j.
    pub(crate) ends: Vec<[[u32; WIDEST]; 2]>,
    /// `Rows::COUNT` rows a block.
    pub(crate) rows: Vec<Row>,
    /// Force on the wall, `DIMENSION` rows a block; empty between particles.
    pub(crate) reactions: Vec<Row>,
    /// What the contacts have spent, `LEDGER` rows a block; empty unless a run keeps the books.
    pub(crate) ledger: Vec<Row>,
}

impl Section {
    /// An idle section. Idle lanes join the two dummies that stand after the `particles` real ones.
    pub(crate) fn new<S: Space>(class: usize, wall: Option<u32>, contacts: usize, particles: usize) -> Self {
        let blocks = contacts.div_ceil(WIDEST);
        let dummy = [[particles as u32; WIDEST], [particles as u32 + 1; WIDEST]];
        let mut rows = vec![Row::default(); blocks * Rows::<S>::COUNT];
        for block in rows.chunks_exact_mut(Rows::<S>::COUNT) {
            block[Rows::<S>::TENSION] = Row([f64::INFINITY; WIDEST]);
            block[Rows::<S>::COHESION] = Row([f64::INFINITY; WIDEST]);
        }
        let reactions = if wall.is_some() { vec![Row::default(); blocks * S::DIMENSION] } else { Vec::new() };
        Self {
            class,
            wall,
            image: 0,
            count: contacts,
            own_from: 0,
            ends: vec![dummy; blocks],
            rows,
            reactions,
            ledger: Vec::new(),
        }
    }

    /// Its place in the order of sections.
    pub(crate) fn rank(&self) -> (bool, usize, u32) {
        (self.wall.is_some(), self.class, self.wall.unwrap_or(u32::from(self.image)))
    }

    /// The key of contact `c`.
    pub(crate) fn key(&self, c: usize) -> Key {
        let [i, j] = self.ends[c / WIDEST].map(|end| end[c % WIDEST]);
        Key { i, at_wall: self.wall.is_some(), j: self.wall.unwrap_or(j), image: self.image }
    }

    /// Sets the ends of contact `c`.
    pub(crate) fn set_key(&mut self, c: usize, key: Key) {
        let ends = &mut self.ends[c / WIDEST];
        ends[0][c % WIDEST] = key.i;
        if !key.at_wall {
            ends[1][c % WIDEST] = key.j;
        }
    }

    /// Row `row` of contact `c`.
    pub(crate) fn value<S: Space>(&self, c: usize, row: usize) -> f64 {
        self.rows[c / WIDEST * Rows::<S>::COUNT + row].0[c % WIDEST]
    }

    /// Writes row `row` of contact `c`.
    pub(crate) fn set_value<S: Space>(&mut self, c: usize, row: usize, value: f64) {
        self.rows[c / WIDEST * Rows::<S>::COUNT + row].0[c % WIDEST] = value;
    }

    /// Whether contact `c` is bonded.
    pub(crate) fn bonded<S: Space>(&self, c: usize) -> bool {
        self.value::<S>(c, Rows::<S>::TENSION) < f64::INFINITY
    }

    /// Opens the books.
    pub(crate) fn open_ledger(&mut self) {
        self.ledger = vec![Row::default(); self.ends.len() * LEDGER];
    }

    /// Adds one row of the ledger of some contacts to `sum`, one by one: the order of the list decides the bits.
    pub(crate) fn add_spent(&self, row: usize, contacts: Range<usize>, sum: &mut f64) {
        for c in contacts {
            *sum += self.ledger.get(c / WIDEST * LEDGER + row).map_or(0.0, |r| r.0[c % WIDEST]);
        }
    }

    /// Copies contact `c` out.
    pub(crate) fn pack<S: Space>(&self, c: usize, into: &mut Packed) {
        into.keys.push((self.key(c), self.class as u32));
        into.values.extend((0..Rows::<S>::COUNT).map(|row| self.value::<S>(c, row)));
    }
}

/// Contacts one after the other, `Rows::COUNT` numbers each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Packed {
    /// Key and class.
    pub(crate) keys: Vec<(Key, u32)>,
    /// Rows of each.
    pub(crate) values: Vec<f64>,
}

impl Packed {
    /// Empty, with room for `contacts`.
    pub(crate) fn with_capacity<S: Space>(contacts: usize) -> Self {
        let (keys, values) = (Vec::with_capacity(contacts), Vec::with_capacity(contacts * Rows::<S>::COUNT));
        Self { keys, values }
    }

    /// Adds a fresh, unbonded contact.
    pub(crate) fn push_new<S: Space>(&mut self, key: Key, class: u32, kn: f64) {
        self.keys.push((key, class));
        let first = self.values.len();
        self.values.resize(first + Rows::<S>::COUNT, 0.0);
        self.values[first + KN] = kn;
        self.values[first + REFERENCE] = 0.0;
        self.values[first + Rows::<S>::TENSION] = f64::INFINITY;
        self.values[first + Rows::<S>::COHESION] = f64::INFINITY;
    }

    /// Adds contact `k` of another list.
    pub(crate) fn push_old<S: Space>(&mut self, from: &Packed, k: usize) {
        self.keys.push(from.keys[k]);
        self.values.extend_from_slice(from.rows::<S>(k));
    }

    /// Rows of contact `k`.
    pub(crate) fn rows<S: Space>(&self, k: usize) -> &[f64] {
        &self.values[k * Rows::<S>::COUNT..(k + 1) * Rows::<S>::COUNT]
    }

    /// Rows of contact `k`.
    pub(crate) fn rows_mut<S: Space>(&mut self, k: usize) -> &mut [f64] {
        &mut self.values[k * Rows::<S>::COUNT..(k + 1) * Rows::<S>::COUNT]
    }

    /// Sections in the order (wall or not, class, wall or image), contacts by (i, j) within each; of the contacts that touch
    /// `particles`, a stretch of all `total` ones.
    pub(crate) fn sections<S: Space>(&self, total: usize, particles: &Range<usize>) -> Vec<Section> {
        let own = |p: u32| particles.contains(&(p as usize));
        let touches = |k: &u32| {
            let key = self.keys[*k as usize].0;
            own(key.i) || (!key.at_wall && own(key.j))
        };
        let mut order: Vec<u32> = (0..self.keys.len() as u32).filter(touches).collect();
        let place = |k: u32| {
            let (key, class) = self.keys[k as usize];
            (key.at_wall, class, if key.at_wall { key.j } else { u32::from(key.image) }, key.i, key.j)
        };
        order.sort_unstable_by_key(|&k| place(k));
        let same = |a: &u32, b: &u32| {
            let (a, b) = (place(*a), place(*b));
            (a.0, a.1, a.2) == (b.0, b.1, b.2)
        };
        order.chunk_by(same).map(|chunk| self.section::<S>(chunk, total, particles)).collect()
    }

    fn section<S: Space>(&self, chunk: &[u32], total: usize, particles: &Range<usize>) -> Section {
        let (key, class) = self.keys[chunk[0] as usize];
        let wall = key.at_wall.then_some(key.j);
        let mut section = Section::new::<S>(class as usize, wall, chunk.len(), total);
        section.image = key.image;
        // i < j, so a contact whose i lies elsewhere has it before the stretch.
        section.own_from = chunk.partition_point(|&k| (self.keys[k as usize].0.i as usize) < particles.start);
        for (c, &k) in chunk.iter().enumerate() {
            section.set_key(c, self.keys[k as usize].0);
            for (row, &value) in self.rows::<S>(k as usize).iter().enumerate() {
                section.set_value::<S>(c, row, value);
            }
        }
        section
    }
}
