//! Orthogonal reduction of a tall table to a triangle: the QR factorisation behind every fit.
//!
//! The rows are read in blocks; Householder reflections fold each block into the triangle `R` of what came before
//! (Golub and Van Loan, Matrix Computations, 4th ed., §5.2 and §12.5), so nothing taller than a block is held and `XᵀX`
//! is never formed. The responses ride along as the last columns: beside `R` stand the rotated responses
//! `z = Qᵀy`, and below it what the model leaves over. `m` rows and `p` columns cost `2mp²` operations.
//!
//! Blocks of [`BLOCK`] rows are folded in order within leaves of [`LEAF`] rows, the leaves' triangles in order after
//! that. Both sizes are constants, so the bits of a result do not depend on the number of threads.

use super::number::{PANEL, Real};
use rayon::prelude::*;
use std::ops::Range;

/// Rows folded at once: a block of a few hundred columns stays in the second-level cache.
pub(crate) const BLOCK: usize = 192;

/// Rows reduced by one thread before triangles are joined.
pub(crate) const LEAF: usize = 16 * BLOCK;

/// A table that can hand out blocks of its rows.
pub(crate) trait Blocks<T>: Sync {
    /// Rows.
    fn rows(&self) -> usize;
    /// Columns, the responses counted.
    fn width(&self) -> usize;
    /// Writes the given rows column by column: entry (i, j) at `j · rows.len() + i`.
    fn fill(&self, rows: Range<usize>, block: &mut [T]);
}

/// An upper triangle, row by row; entry (i, j) at `i · width + j`.
#[derive(Clone, Debug)]
pub(crate) struct Triangle<T> {
    width: usize,
    entries: Vec<T>,
}

impl<T: Real> Triangle<T> {
    fn new(width: usize) -> Self {
        Self { width, entries: vec![T::zero(); width * width] }
    }

    /// Reduces a whole table.
    pub(crate) fn of(table: &impl Blocks<T>) -> Self {
        let leaves: Vec<Self> = (0..table.rows().div_ceil(LEAF))
            .into_par_iter()
            .map(|leaf| Self::of_leaf(table, leaf * LEAF..table.rows().min((leaf + 1) * LEAF)))
            .collect();
        let mut leaves = leaves.into_iter();
        let mut whole = leaves.next().unwrap_or_else(|| Self::new(table.width()));
        for leaf in leaves {
            whole.join(&leaf);
        }
        whole
    }

    fn of_leaf(table: &impl Blocks<T>, rows: Range<usize>) -> Self {
        let mut triangle = Self::new(table.width());
        let mut block = vec![T::zero(); table.width() * BLOCK.min(rows.len())];
        for start in rows.clone().step_by(BLOCK) {
            let end = rows.end.min(start + BLOCK);
            let part = &mut block[..table.width() * (end - start)];
            table.fill(start..end, part);
            triangle.absorb(part, end - start, |_| end - start);
        }
        triangle
    }

    /// Folds another triangle into this one.
    fn join(&mut self, other: &Self) {
        let n = self.width;
        let mut block = vec![T::zero(); n * n];
        for i in 0..n {
            for j in i..n {
                block[j * n + i] = other.entries[i * n + j];
            }
        }
        self.absorb(&mut block, n, |column| column + 1);
    }

    /// Folds `height` rows, stored column by column, into the triangle. Column `j` has entries only in its first
    /// `depth(j)` rows, which never falls with `j`.
    ///
    /// Reflections are made in panels of [`PANEL`] columns; each later column is read and written once per panel.
    fn absorb(&mut self, block: &mut [T], height: usize, depth: impl Fn(usize) -> usize) {
        let n = self.width;
        for start in (0..n).step_by(PANEL) {
            let end = n.min(start + PANEL);
            let length = depth(end - 1);
            let (head, later) = block.split_at_mut(end * height);
            let panel = &mut head[start * height..];
            let strengths = self.reflect(panel, height, length, start);
            if later.is_empty() {
                return;
            }
            let reflectors: [&[T]; PANEL] = std::array::from_fn(|i| &panel[i * height..i * height + length]);
            let overlaps = reflectors.map(|own| T::dots(reflectors, own));
            for (k, column) in (end..n).zip(later.chunks_exact_mut(height)) {
                let column = &mut column[..length];
                let products = T::dots(reflectors, column);
                let mut shares = [T::zero(); PANEL];
                for i in 0..PANEL {
                    let entry = &mut self.entries[(start + i) * n + k];
                    let before = (0..i).fold(T::zero(), |sum, l| sum + shares[l] * overlaps[i][l]);
                    shares[i] = strengths[i] * (*entry + products[i] - before);
                    *entry = *entry - shares[i];
                }
                T::add_multiples(column, shares.map(|share| -share), reflectors);
            }
        }
    }

    /// Turns the columns of a panel, which begins at column `start`, into reflectors; gives their strengths.
    fn reflect(&mut self, panel: &mut [T], height: usize, length: usize, start: usize) -> [T; PANEL] {
        let n = self.width;
        let mut strengths = [T::zero(); PANEL];
        for i in 0..panel.len() / height {
            let j = start + i;
            let (before, after) = panel.split_at_mut((i + 1) * height);
            let reflector = &mut before[i * height..i * height + length];
            let diagonal = self.entries[j * n + j];
            let below = T::dot(reflector, reflector);
            if below == T::zero() {
                continue;
            }
            let norm = (diagonal * diagonal + below).sqrt();
            let pivot = if diagonal > T::zero() { -norm } else { norm };
            let scale = T::from(1.0) / (diagonal - pivot);
            for entry in reflector.iter_mut() {
                *entry = *entry * scale;
            }
            strengths[i] = (pivot - diagonal) / pivot;
            self.entries[j * n + j] = pivot;
            for (k, column) in (j + 1..n).zip(after.chunks_exact_mut(height)) {
                let column = &mut column[..length];
                let share = strengths[i] * (self.entries[j * n + k] + T::dot(reflector, column));
                self.entries[j * n + k] = self.entries[j * n + k] - share;
                T::add_multiple(column, -share, reflector);
            }
        }
        strengths
    }

    /// Entry (i, j), zero below the diagonal.
    pub(crate) fn at(&self, i: usize, j: usize) -> T {
        self.entries[i * self.width + j]
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// The triangle of the same table with only the listed columns, in the listed order.
    pub(crate) fn with_columns(&self, columns: &[usize]) -> Self {
        let height = self.width;
        let mut block = vec![T::zero(); columns.len() * height];
        for (to, &from) in columns.iter().enumerate() {
            for i in 0..=from {
                block[to * height + i] = self.at(i, from);
            }
        }
        let mut reduced = Self::new(columns.len());
        reduced.absorb(&mut block, height, |_| height);
        reduced
    }

    /// Euclidean norm of column `j` of the table, over the rows `from..` of the triangle.
    pub(crate) fn column_norm(&self, j: usize, from: usize) -> T {
        (from..=j).fold(T::zero(), |sum, i| sum + self.at(i, j) * self.at(i, j)).sqrt()
    }

    /// For each of the first `terms` columns that depends on earlier ones: its number and theirs.
    ///
    /// A reflection along rounding noise would hide the contribution of later columns, so a dependent column is set
    /// aside and the others are reduced without it.
    pub(crate) fn dependent(&self, terms: usize) -> Vec<(usize, Vec<usize>)> {
        if self.is_independent(terms) {
            return Vec::new();
        }
        let mut independent: Vec<usize> = Vec::new();
        let mut found = Vec::new();
        for j in 0..terms {
            let mut columns = independent.clone();
            columns.push(j);
            let trial = self.with_columns(&columns);
            if trial.stands_alone(independent.len()) {
                independent.push(j);
                continue;
            }
            let weights = trial.solve(independent.len(), independent.len());
            let norm = self.column_norm(j, 0).value().max(f64::MIN_POSITIVE);
            let counts =
                |i: &usize| weights[*i].value().abs() * self.column_norm(independent[*i], 0).value() > 1e-8 * norm;
            found.push((j, (0..independent.len()).filter(counts).map(|i| independent[i]).collect()));
        }
        found
    }

    /// Whether none of the first `terms` columns depends on those before it.
    pub(crate) fn is_independent(&self, terms: usize) -> bool {
        (0..terms).all(|j| self.stands_alone(j))
    }

    fn stands_alone(&self, j: usize) -> bool {
        let norm = self.column_norm(j, 0).value();
        norm > 0.0 && self.at(j, j).value().abs() > T::DEPENDENT * norm
    }

    /// Solves the leading `terms × terms` triangle for column `right` as the right-hand side.
    pub(crate) fn solve(&self, terms: usize, right: usize) -> Vec<T> {
        let mut x = vec![T::zero(); terms];
        for i in (0..terms).rev() {
            let known = (i + 1..terms).fold(T::zero(), |sum, k| sum + self.at(i, k) * x[k]);
            x[i] = (self.at(i, right) - known) / self.at(i, i);
        }
        x
    }

    /// The inverse of the leading `terms × terms` triangle, row by row.
    pub(crate) fn inverse(&self, terms: usize) -> Vec<T> {
        let mut inverse = vec![T::zero(); terms * terms];
        for i in (0..terms).rev() {
            let (head, tail) = inverse.split_at_mut((i + 1) * terms);
            let row = &mut head[i * terms..];
            row[i] = T::from(1.0);
            for (k, below) in (i + 1..terms).zip(tail.chunks_exact(terms)) {
                T::add_multiple(&mut row[k..], -self.at(i, k), &below[k..]);
            }
            for entry in &mut row[i..] {
                *entry = *entry / self.at(i, i);
            }
        }
        inverse
    }
}

#[cfg(test)]
mod tests {
    use super::super::number::Twofold;
    use super::*;

    /// Columns 1, x, x² and y = 3 − 2x + x² on 0, 0.01, 0.02 …
    struct Parabola(usize);

    impl<T: Real> Blocks<T> for Parabola {
        fn rows(&self) -> usize {
            self.0
        }
        fn width(&self) -> usize {
            4
        }
        fn fill(&self, rows: Range<usize>, block: &mut [T]) {
            let height = rows.len();
            for (i, row) in rows.enumerate() {
                let x = T::from(row as f64) / T::from(100.0);
                block[i] = T::from(1.0);
                block[height + i] = x;
                block[2 * height + i] = x * x;
                block[3 * height + i] = T::from(3.0) - T::from(2.0) * x + x * x;
            }
        }
    }

    #[test]
    fn a_parabola_is_found_again_across_blocks_and_leaves() {
        for rows in [3, BLOCK, BLOCK + 1, 2 * LEAF + 17] {
            let doubles = Triangle::<f64>::of(&Parabola(rows)).solve(3, 3);
            let twofold = Triangle::<Twofold>::of(&Parabola(rows)).solve(3, 3);
            for (k, wanted) in [3.0, -2.0, 1.0].into_iter().enumerate() {
                assert!((doubles[k] - wanted).abs() < 1e-9, "{rows} rows: {doubles:?}");
                assert!((twofold[k].value() - wanted).abs() < 1e-15, "{rows} rows: {twofold:?}");
            }
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_number_of_threads() {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Triangle::<f64>::of(&Parabola(5 * LEAF + 1))).entries
        };
        let one = with(1);
        for threads in [2, 8] {
            assert!(one.iter().zip(&with(threads)).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }

    #[test]
    fn the_inverse_is_the_inverse() {
        let triangle = Triangle::<f64>::of(&Parabola(50));
        let inverse = triangle.inverse(3);
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (i..=j.max(i)).map(|k| triangle.at(i, k) * inverse[k * 3 + j]).sum();
                assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_dependent_column_is_named_with_its_partners() {
        let triangle = Triangle::<f64>::of(&Parabola(50));
        assert_eq!(triangle.dependent(4), vec![(3, vec![0, 1, 2])]);
        assert!(triangle.dependent(3).is_empty());
    }
}
