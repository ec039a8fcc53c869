//! Contacts of one class, in blocks of eight; between them the classes hold the whole list.
//!
//! The order of contacts (class, wall or image, i, j) decides the order of every sum, so it depends on nothing but the contacts.
//! Blocks are stored in chunks, which a [`Reader`] gives back one by one: while a list is written anew, no second list
//! exists beside it.

use crate::interaction::Bond;
use crate::law::{ENERGIES, Memory, RowIndex, flat_joint_rows, fresh, idle, smooth_joint_rows};
use crate::simd::{Row, WIDEST};
use crate::space::Space;
use std::ops::Range;

/// Blocks of a chunk.
const CHUNK: usize = 128;

/// Which law a class follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LawKind {
    Linear,
    ContactBond,
    ParallelBond,
    FlatJoint {
        /// Elements of an interface.
        elements: u32,
    },
    SmoothJoint,
}

impl LawKind {
    pub(crate) fn of(bond: &Bond) -> Self {
        match bond {
            Bond::None => Self::Linear,
            Bond::Contact(_) => Self::ContactBond,
            Bond::Parallel(_) => Self::ParallelBond,
            Bond::Flat(joint) => Self::FlatJoint { elements: joint.division.count() },
        }
    }

    /// Rows of memory of a contact.
    fn rows<S: Space>(self) -> usize {
        match self {
            Self::Linear => RowIndex::<S>::TENSION,
            Self::ContactBond => RowIndex::<S>::BOND,
            Self::ParallelBond => RowIndex::<S>::COUNT,
            Self::FlatJoint { elements } => flat_joint_rows::<S>(elements),
            Self::SmoothJoint => smooth_joint_rows::<S>(),
        }
    }

    /// Whether a contact that is not bonded gives the same bits by the linear law, with fewer rows.
    pub(crate) fn begins_linear(self) -> bool {
        matches!(self, Self::ParallelBond | Self::FlatJoint { .. })
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

/// What the contacts of a section have in common; sections are in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank {
    /// True when the second ends are walls.
    pub(crate) at_wall: bool,
    /// Index in the contact table.
    pub(crate) class: usize,
    /// The wall, or the image of the second ends in a periodic cell (0 for themselves).
    pub(crate) second: u32,
}

impl Rank {
    /// The key of a contact with these ends (i and the wall at a wall).
    pub(crate) fn key(self, [i, j]: [u32; 2]) -> Key {
        if self.at_wall {
            return Key { i, at_wall: true, j: self.second, image: 0 };
        }
        Key { i, at_wall: false, j, image: self.second as u8 }
    }
}

/// Some blocks of a section, side by side.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chunk {
    /// Ends of each block: i, then j.
    pub(crate) ends: Vec<[[u32; WIDEST]; 2]>,
    /// As many rows a block as the law has.
    pub(crate) rows: Vec<Row>,
    /// Force on the wall, `DIMENSION` rows a block; empty between particles.
    pub(crate) reactions: Vec<Row>,
    /// What the contacts have spent, `ENERGIES` rows a block; empty unless a run tracks its energy.
    pub(crate) account: Vec<Row>,
}

/// Contacts of one class: between particles, or with one wall.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// What they have in common.
    pub(crate) rank: Rank,
    /// The law that they follow: that of the class, or the linear one as long as no parallel bond was installed in the
    /// class. It gives the same bits with fewer rows.
    pub(crate) law: LawKind,
    /// Real contacts; the last block is filled up with idle ones.
    pub(crate) count: usize,
    /// The contacts before this one belong to another stretch, which computes them too.
    pub(crate) own_from: usize,
    /// The blocks, `CHUNK` in each chunk but the last.
    pub(crate) chunks: Vec<Chunk>,
    /// The first of the two dummies that idle lanes join.
    dummy: u32,
}

/// Chunk, block and lane of a contact.
fn locate(c: usize) -> (usize, usize, usize) {
    (c / (CHUNK * WIDEST), c / WIDEST % CHUNK, c % WIDEST)
}

impl Section {
    /// Without contacts. The two dummies follow the `particles` real ones.
    pub(crate) fn new(rank: Rank, law: LawKind, particles: usize) -> Self {
        Self { rank, law, count: 0, own_from: 0, chunks: Vec::new(), dummy: particles as u32 }
    }

    /// The wall, for contacts with one.
    pub(crate) fn wall(&self) -> Option<u32> {
        self.rank.at_wall.then_some(self.rank.second)
    }

    /// The key of contact `c`.
    pub(crate) fn key(&self, c: usize) -> Key {
        let (chunk, block, lane) = locate(c);
        self.rank.key(self.chunks[chunk].ends[block].map(|end| end[lane]))
    }

    /// Row `row` of contact `c`.
    pub(crate) fn value<S: Space>(&self, c: usize, row: usize) -> f64 {
        let (chunk, block, lane) = locate(c);
        let rows = self.law.rows::<S>();
        if row < rows { self.chunks[chunk].rows[block * rows + row].0[lane] } else { fresh::<S>()[row] }
    }

    /// The memory of contact `c`.
    pub(crate) fn memory<S: Space>(&self, c: usize) -> Memory {
        let (chunk, block, lane) = locate(c);
        let rows = self.law.rows::<S>();
        let mut memory = fresh::<S>();
        let own = &self.chunks[chunk].rows[block * rows..(block + 1) * rows];
        let (shared, tail) = own.split_at(rows.min(RowIndex::<S>::COUNT));
        for (value, row) in memory.iter_mut().zip(shared) {
            *value = row.0[lane];
        }
        // Rows of elements matter where there is an interface.
        if memory[RowIndex::<S>::BOND] > 0.0 {
            memory.tail.extend(tail.iter().map(|row| row.0[lane]));
        }
        memory
    }

    /// Adds a contact at the end; `room` contacts are expected from here on, this one among them.
    pub(crate) fn push<S: Space>(&mut self, key: Key, memory: &Memory, room: usize) {
        let (chunk, block, lane) = locate(self.count);
        let rows = self.law.rows::<S>();
        if chunk == self.chunks.len() {
            let blocks = room.div_ceil(WIDEST).clamp(1, CHUNK);
            let (ends, rows) = (Vec::with_capacity(blocks), Vec::with_capacity(blocks * rows));
            self.chunks.push(Chunk { ends, rows, ..Chunk::default() });
        }
        let chunk = &mut self.chunks[chunk];
        if block == chunk.ends.len() {
            chunk.ends.push([[self.dummy; WIDEST], [self.dummy + 1; WIDEST]]);
            let (idle_memory, shared) = (fresh::<S>(), RowIndex::<S>::COUNT);
            let flat = matches!(self.law, LawKind::FlatJoint { .. });
            let tail = |row| if flat { idle::<S>(row) } else { 0.0 };
            let value = |row| if row < shared { idle_memory[row] } else { tail(row) };
            chunk.rows.extend((0..rows).map(|row| Row([value(row); WIDEST])));
            if self.rank.at_wall {
                chunk.reactions.resize(chunk.ends.len() * S::DIMENSION, Row::default());
            }
        }
        let ends = &mut chunk.ends[block];
        ends[0][lane] = key.i;
        if !key.at_wall {
            ends[1][lane] = key.j;
        }
        let own = &mut chunk.rows[block * rows..(block + 1) * rows];
        let (shared, tail) = own.split_at_mut(rows.min(RowIndex::<S>::COUNT));
        for (row, value) in shared.iter_mut().zip(&**memory) {
            row.0[lane] = *value;
        }
        for (row, value) in tail.iter_mut().zip(&memory.tail) {
            row.0[lane] = *value;
        }
        self.count += 1;
    }

    /// Whether contact `c` is bonded.
    pub(crate) fn bonded<S: Space>(&self, c: usize) -> bool {
        self.value::<S>(c, RowIndex::<S>::TENSION) < f64::INFINITY
    }

    /// Whether contact `c` is bonded or an interface, bonded or not.
    pub(crate) fn joined<S: Space>(&self, c: usize) -> bool {
        self.bonded::<S>(c) || self.value::<S>(c, RowIndex::<S>::BOND) > 0.0
    }

    /// Force of contact `c` on the wall; the third component is 0 in the plane.
    pub(crate) fn reaction<S: Space>(&self, c: usize) -> [f64; 3] {
        let (chunk, block, lane) = locate(c);
        let rows = &self.chunks[chunk].reactions[block * S::DIMENSION..];
        std::array::from_fn(|k| if k < S::DIMENSION { rows[k].0[lane] } else { 0.0 })
    }

    /// Opens the books.
    pub(crate) fn open_ledger(&mut self) {
        for chunk in &mut self.chunks {
            chunk.account = vec![Row::default(); chunk.ends.len() * ENERGIES];
        }
    }

    /// What one contact has spent.
    pub(crate) fn spent(&self, c: usize) -> [f64; ENERGIES] {
        let (chunk, block, lane) = locate(c);
        std::array::from_fn(|row| self.chunks[chunk].account[block * ENERGIES + row].0[lane])
    }

    /// Writes what one contact has spent.
    pub(crate) fn set_spent(&mut self, c: usize, spent: [f64; ENERGIES]) {
        let (chunk, block, lane) = locate(c);
        for (row, energy) in spent.into_iter().enumerate() {
            self.chunks[chunk].account[block * ENERGIES + row].0[lane] = energy;
        }
    }

    /// Adds one row of the account of some contacts to `sum`, one by one: the order of the list decides the bits.
    pub(crate) fn add_spent(&self, row: usize, contacts: Range<usize>, sum: &mut f64) {
        for (chunk, block, lane) in contacts.map(locate) {
            *sum += self.chunks[chunk].account.get(block * ENERGIES + row).map_or(0.0, |r| r.0[lane]);
        }
    }
}

/// Reads the own contacts of sections of one rank, and gives back the chunks that were read.
pub(crate) struct Reader {
    sections: std::vec::IntoIter<Section>,
    now: Option<(Section, usize)>,
}

impl Reader {
    /// At the first contact of `sections`, which are in the order of their stretches.
    pub(crate) fn new(sections: Vec<Section>) -> Self {
        let mut reader = Self { sections: sections.into_iter(), now: None };
        reader.open();
        reader
    }

    /// Goes to the next section that has own contacts.
    fn open(&mut self) {
        self.now = self.sections.find(|s| s.own_from < s.count).map(|section| {
            let first = section.own_from;
            (section, first)
        });
    }

    /// The next contact.
    pub(crate) fn key(&self) -> Option<Key> {
        self.now.as_ref().map(|(section, next)| section.key(*next))
    }

    /// Takes the memory of the next contact.
    pub(crate) fn take<S: Space>(&mut self) -> Memory {
        let Some((section, next)) = &mut self.now else { return fresh::<S>() };
        let memory = section.memory::<S>(*next);
        *next += 1;
        if *next % (CHUNK * WIDEST) == 0 {
            section.chunks[locate(*next - 1).0] = Chunk::default();
        }
        if *next == section.count {
            self.open();
        }
        memory
    }
}

/// Writes the contacts of one rank into a section for each stretch of particles.
pub(crate) struct Writer<'a> {
    cuts: &'a [usize],
    expected: usize,
    /// One for each stretch.
    pub(crate) sections: Vec<Section>,
}

impl<'a> Writer<'a> {
    /// For the stretches between `cuts`; about `expected` contacts will come.
    pub(crate) fn new(rank: Rank, law: LawKind, cuts: &'a [usize], expected: usize) -> Self {
        let (stretches, particles) = (cuts.len() - 1, cuts[cuts.len() - 1]);
        let sections = (0..stretches).map(|_| Section::new(rank, law, particles)).collect();
        Self { cuts, expected: expected.div_ceil(stretches), sections }
    }

    /// Adds a contact, behind those that precede it in the order of the list.
    pub(crate) fn push<S: Space>(&mut self, key: Key, memory: &Memory) {
        let stretch = |p: u32| self.cuts.partition_point(|&cut| cut <= p as usize) - 1;
        let first = stretch(key.i);
        let second = if key.at_wall { first } else { stretch(key.j) };
        for d in [Some(first), (second != first).then_some(second)].into_iter().flatten() {
            let section = &mut self.sections[d];
            let room = self.expected.saturating_sub(section.count);
            section.push::<S>(key, memory, room);
            // i < j, so a contact whose i lies elsewhere comes before the own ones.
            section.own_from += usize::from(d != first);
        }
    }
}
