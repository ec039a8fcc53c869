//! Columns of a model matrix as products of parts, and the table of blocks that the reduction reads.
//!
//! A part is a power of a coded factor, `((x − centre)/half)ᵏ`, or a sum-to-zero contrast of a level: 1 on the level,
//! −1 on the last one, 0 elsewhere. The constant is the empty product. Rows are multiplied by the root of their weight.

use super::number::Real;
use super::sample::{Sample, Usable};
use super::triangle::Blocks;
use std::ops::Range;

/// One factor of a product column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    /// `((x − centre)/half)^power`.
    Power { factor: usize, power: u32, centre: f64, half: f64 },
    /// Contrast of one level against the last.
    Contrast { factor: usize, level: usize },
}

/// A product of parts; empty for the constant.
pub(crate) type Column = Vec<Part>;

/// A model matrix over the usable rows of one response, with that response as the last column.
pub(crate) struct Matrix<'a> {
    sample: &'a Sample,
    usable: &'a Usable,
    /// The model's columns.
    pub columns: Vec<Column>,
    /// Level number of each usable row, per factor of the sample; empty where no contrast needs it.
    levels: Vec<Vec<usize>>,
    /// Number of levels per factor.
    level_counts: Vec<usize>,
    /// Roots of the weights, `None` when all are one.
    weighted: bool,
}

impl<'a> Matrix<'a> {
    /// The matrix of `columns`; `levels` are the known levels of each factor that has contrasts.
    pub(crate) fn new(sample: &'a Sample, usable: &'a Usable, columns: Vec<Column>, levels: &[Vec<f64>]) -> Self {
        let number = |factor: usize, known: &[f64]| {
            let values = &sample.factors[factor].values;
            let index = |&row: &usize| known.iter().position(|&level| level == values[row]).unwrap_or(known.len());
            usable.rows.iter().map(index).collect::<Vec<_>>()
        };
        Self {
            levels: levels.iter().enumerate().map(|(f, known)| number(f, known)).collect(),
            level_counts: levels.iter().map(Vec::len).collect(),
            weighted: sample.weights.is_some(),
            sample,
            usable,
            columns,
        }
    }

    /// The root of the weight of usable row `i`.
    pub(crate) fn root_weight<T: Real>(&self, i: usize) -> T {
        if self.weighted { T::from(self.sample.weight(self.usable.rows[i])).sqrt() } else { T::from(1.0) }
    }

    /// The sum of squares that the rounding of the responses can leave of an exact fit: two units in the last digit of the
    /// largest, in every row.
    pub(crate) fn rounding<T: Real>(&self) -> T {
        let unit = T::from(2.0 * self.usable.last_digit());
        let weights = self.usable.rows.iter().map(|&row| T::from(self.sample.weight(row)));
        weights.fold(T::zero(), |sum, weight| sum + weight) * unit * unit
    }

    fn multiply<T: Real>(&self, part: &Part, rows: Range<usize>, column: &mut [T]) {
        match *part {
            Part::Power { factor, power, centre, half } => {
                let values = &self.sample.factors[factor].values;
                for (entry, &row) in column.iter_mut().zip(&self.usable.rows[rows]) {
                    let coded = coded::<T>(values[row], centre, half);
                    for _ in 0..power {
                        *entry = *entry * coded;
                    }
                }
            }
            Part::Contrast { factor, level } => {
                let last = self.level_counts[factor] - 1;
                for (entry, &found) in column.iter_mut().zip(&self.levels[factor][rows]) {
                    *entry = if found == level {
                        *entry
                    } else if found == last {
                        -*entry
                    } else {
                        T::zero()
                    };
                }
            }
        }
    }
}

/// `(x − centre)/half`.
pub(crate) fn coded<T: Real>(x: f64, centre: f64, half: f64) -> T {
    if centre == 0.0 && half == 1.0 { T::from(x) } else { (T::from(x) - T::from(centre)) / T::from(half) }
}

impl<T: Real> Blocks<T> for Matrix<'_> {
    fn rows(&self) -> usize {
        self.usable.rows.len()
    }

    fn width(&self) -> usize {
        self.columns.len() + 1
    }

    fn fill(&self, rows: Range<usize>, block: &mut [T]) {
        let height = rows.len();
        let (model, response) = block.split_at_mut(self.columns.len() * height);
        for (parts, column) in self.columns.iter().zip(model.chunks_exact_mut(height)) {
            column.fill(T::from(1.0));
            for part in parts {
                self.multiply(part, rows.clone(), column);
            }
        }
        for (entry, &value) in response.iter_mut().zip(&self.usable.values[rows.clone()]) {
            *entry = T::from(value);
        }
        if self.weighted {
            for column in block.chunks_exact_mut(height) {
                for (entry, i) in column.iter_mut().zip(rows.clone()) {
                    *entry = *entry * self.root_weight(i);
                }
            }
        }
    }
}
