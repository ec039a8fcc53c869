//! The rows of a design, identified by their content.

use super::factor_columns;
use crate::artifact::{Artifact, Column, Values};
use crate::stage::{Context, Point, StageError};
use math::occurrence::occurrences;

/// The rows of a design. Equal rows are replicates, numbered from 1 by occurrence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignRows {
    /// Names of the factors, ascending.
    factors: Vec<String>,
    /// For each row the bits of its values, factor by factor, and its replicate.
    words: Vec<u64>,
}

impl DesignRows {
    /// The rows of a design.
    ///
    /// # Errors
    /// It has no rows, or a factor column does not hold numbers.
    pub fn of(design: &Artifact, context: &Context) -> Result<Self, StageError> {
        let mut columns = factor_columns(design, context)?;
        columns.sort_by(|a, b| a.name.cmp(&b.name));
        let count = columns.first().map_or(0, |column| column.values.len());
        if count == 0 {
            return Err(StageError::new("the design has no rows of known factors"));
        }
        if let Some(column) = columns.iter().find(|column| matches!(column.values, Values::Texts(_))) {
            let message = format!("factor `{}` has names for levels, which no simulator can set", column.name);
            return Err(
                StageError::new(message).hint("export the design, run it, and read the results with kind = \"data\"")
            );
        }
        let value = |column: &Column, index: usize| match &column.values {
            Values::Reals(values) => values[index] + 0.0,
            Values::Ints(values) => values[index] as f64,
            Values::Texts(_) => f64::NAN,
        };
        let bits = |index: usize| columns.iter().map(move |column| value(column, index).to_bits());
        let points: Vec<u64> = (0..count).flat_map(bits).collect();
        let replicates = occurrences(&points, columns.len(), count);
        let mut words = Vec::with_capacity(points.len() + count);
        for (point, replicate) in points.chunks_exact(columns.len()).zip(replicates) {
            words.extend_from_slice(point);
            words.push(replicate);
        }
        Ok(Self { factors: columns.iter().map(|column| column.name.clone()).collect(), words })
    }

    /// Rows from the output of [`DesignRows::factors`] and [`DesignRows::words`].
    pub fn from_parts(factors: Vec<String>, words: Vec<u64>) -> Option<Self> {
        words.len().is_multiple_of(factors.len() + 1).then_some(Self { factors, words })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.words.len() / (self.factors.len() + 1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Names of the factors, ascending.
    pub fn factors(&self) -> &[String] {
        &self.factors
    }

    /// All rows as numbers, [`DesignRows::name`] after name.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// The name of a row, which is unique among rows over the same factors.
    pub fn name(&self, index: usize) -> &[u64] {
        let width = self.factors.len() + 1;
        &self.words[index * width..(index + 1) * width]
    }

    /// Values of the factors of a row, in the factors' units.
    pub fn point(&self, index: usize) -> Point {
        let values = self.name(index).iter().map(|&bits| f64::from_bits(bits));
        self.factors.iter().cloned().zip(values).collect()
    }

    /// Number of a row among the rows that are equal to it, from 1.
    pub fn replicate(&self, index: usize) -> u64 {
        self.name(index)[self.factors.len()]
    }
}
