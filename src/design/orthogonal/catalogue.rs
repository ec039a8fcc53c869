//! The arrays that are known here, and how a table of wanted columns is cut out of one.

use super::array::Array;
use super::construct::Recipe::{
    self, Bush, Contrasts, Developed, Fold, Hadamard, Halves, Product, Quadruple, RaoHamming,
};
use super::construct::Scheme::{Double, Eighteen, Products, Signs, Twelve};
use super::shape::{Counts, count};
use std::collections::BTreeSet;

/// Every array of strength two, by runs; of equal runs the plainest first.
pub(super) const STRENGTH_TWO: &[Recipe] = &[
    RaoHamming { q: 2, n: 2 },
    RaoHamming { q: 2, n: 3 },
    Developed(Products { order: 4, q: 2 }),
    RaoHamming { q: 3, n: 2 },
    Hadamard(12),
    Contrasts(3),
    Halves(6),
    RaoHamming { q: 2, n: 4 },
    RaoHamming { q: 4, n: 2 },
    Developed(Products { order: 8, q: 2 }),
    Developed(Double(3)),
    Hadamard(20),
    Contrasts(5),
    Halves(10),
    Hadamard(24),
    Quadruple(12),
    Developed(Signs(12)),
    RaoHamming { q: 5, n: 2 },
    RaoHamming { q: 3, n: 3 },
    Developed(Products { order: 9, q: 3 }),
    Hadamard(28),
    RaoHamming { q: 2, n: 5 },
    Developed(Products { order: 8, q: 4 }),
    Developed(Products { order: 16, q: 2 }),
    Hadamard(36),
    Developed(Twelve),
    Hadamard(40),
    Quadruple(20),
    Developed(Signs(20)),
    Hadamard(44),
    Hadamard(48),
    Quadruple(24),
    Developed(Signs(24)),
    RaoHamming { q: 7, n: 2 },
    Developed(Double(5)),
    Developed(Eighteen),
    RaoHamming { q: 2, n: 6 },
    RaoHamming { q: 4, n: 3 },
    RaoHamming { q: 8, n: 2 },
    Developed(Products { order: 16, q: 4 }),
    RaoHamming { q: 3, n: 4 },
    RaoHamming { q: 9, n: 2 },
    Developed(Products { order: 27, q: 3 }),
    Developed(Double(7)),
    RaoHamming { q: 5, n: 3 },
    RaoHamming { q: 2, n: 7 },
    Developed(Double(9)),
    RaoHamming { q: 3, n: 5 },
    RaoHamming { q: 4, n: 4 },
    RaoHamming { q: 16, n: 2 },
];

/// Every array of strength three.
pub(super) const STRENGTH_THREE: &[Recipe] = &[
    Fold(4),
    Fold(8),
    Fold(12),
    Bush { q: 3, t: 3 },
    Fold(16),
    Fold(20),
    Fold(24),
    Fold(28),
    Bush { q: 4, t: 3 },
    Fold(32),
    Fold(36),
    Fold(40),
    Fold(44),
    Fold(48),
    Bush { q: 5, t: 3 },
    Bush { q: 7, t: 3 },
    Bush { q: 8, t: 3 },
    Bush { q: 9, t: 3 },
];

/// What a column of so many levels can be replaced by, besides the arrays of so many runs above.
const PRODUCTS: &[Recipe] = &[Product(2, 3), Product(2, 5), Product(3, 4), Product(2, 7), Product(2, 9)];

/// A column of `levels` levels is replaced by the columns of `by`.
pub(super) struct Split {
    levels: usize,
    by: Recipe,
}

/// The replacements that make `recipe` hold at least the wanted columns, if there are any.
pub(super) fn splits(recipe: Recipe, wanted: &Counts) -> Option<Vec<Split>> {
    let degrees: usize = wanted.iter().map(|(levels, n)| (levels - 1) * n).sum();
    if degrees >= recipe.runs() {
        return None;
    }
    let mut search = Search { wanted, may_split: recipe.strength() == 2, failed: BTreeSet::new(), chosen: Vec::new() };
    search.from(count(&recipe.shape())).then_some(search.chosen)
}

/// Arrays that may stand in for a column of `levels` levels.
fn replacements(levels: usize) -> impl Iterator<Item = Recipe> {
    STRENGTH_TWO.iter().chain(PRODUCTS).copied().filter(move |by| by.runs() == levels)
}

/// Whether a column of `levels` levels can yield one of `target` levels.
fn reaches(levels: usize, target: usize) -> bool {
    levels == target || replacements(levels).any(|by| by.shape().iter().any(|&new| reaches(new, target)))
}

/// A depth-first search that remembers where it failed.
struct Search<'a> {
    wanted: &'a Counts,
    may_split: bool,
    failed: BTreeSet<Counts>,
    chosen: Vec<Split>,
}

impl Search<'_> {
    /// Makes the widest column that is missing out of the narrowest one that is spare.
    fn from(&mut self, have: Counts) -> bool {
        let at = |counts: &Counts, levels: usize| counts.get(&levels).copied().unwrap_or(0);
        let missing = self.wanted.iter().rev().find(|(levels, n)| at(&have, **levels) < **n);
        let Some((&missing, _)) = missing else { return true };
        if !self.may_split || self.failed.contains(&have) {
            return false;
        }
        for (&levels, &n) in &have {
            if levels <= missing || n <= at(self.wanted, levels) {
                continue;
            }
            for by in replacements(levels).filter(|by| by.shape().iter().any(|&new| reaches(new, missing))) {
                let mut after = have.clone();
                after.insert(levels, n - 1);
                for (new, more) in count(&by.shape()) {
                    *after.entry(new).or_insert(0) += more;
                }
                self.chosen.push(Split { levels, by });
                if self.from(after) {
                    return true;
                }
                self.chosen.pop();
            }
        }
        self.failed.insert(have);
        false
    }
}

/// Builds the array and makes the replacements, each in the last column of its kind.
pub(super) fn build(recipe: Recipe, splits: &[Split]) -> Array {
    let mut array = recipe.build();
    for split in splits {
        let last = array.columns.iter().rposition(|c| c.levels == split.levels);
        let at = last.unwrap_or_else(|| panic!("BUG: no column of {} levels to replace", split.levels));
        array.replace(at, &split.by.build());
    }
    array
}
