//! A column of a table spread over two others: one row for each value of the one, one column for each value of the other.

use super::{Params, chosen_rows, column_of, shown};
use crate::artifact::{self, validity::Statement};
use crate::stage::StageError;
use figure::column::{Column, Values};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stats::groups::{Cell, pivot};

/// Columns of a pivot table: `pivot = { down = "R_min", across = "ratio", value = "estimate" }`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pivot {
    /// Column of numbers whose values are the heads of the rows.
    pub down: String,
    /// Column of numbers whose values are the heads of the columns.
    pub across: String,
    /// Column of numbers in the cells; the mean where several rows fall in one cell.
    pub value: String,
}

impl Pivot {
    /// The columns that it reads.
    pub(super) fn names(&self) -> [&String; 3] {
        [&self.down, &self.across, &self.value]
    }

    /// How many rows of a table are in no cell, because they lack the value that says in which.
    pub(super) fn unplaced(&self, table: &artifact::Table) -> Option<Statement> {
        let lacks = |name: &String, row: usize| {
            let values = table.column(name).map(|column| &column.values);
            values.is_some_and(|values| matches!(values, artifact::Values::Reals(reals) if reals[row].is_nan()))
        };
        let without = (0..table.rows()).filter(|&row| lacks(&self.down, row) || lacks(&self.across, row)).count();
        let words = format!(
            "{without} of {} rows have no {} or no {}, so they are in no cell",
            table.rows(),
            self.down,
            self.across
        );
        (without > 0).then(|| words.into())
    }
}

/// The columns of the pivot table over the allowed rows. A cell without rows, or without values, is missing.
///
/// # Errors
/// A column does not exist, or holds words.
pub(super) fn spread(
    table: &artifact::Table,
    params: &Params,
    of: &Pivot,
    allowed: &dyn Fn(usize) -> bool,
) -> Result<Vec<Column>, StageError> {
    let rows = chosen_rows(table, params, allowed)?;
    let [down, across, value] =
        of.names().map(|name| column_of(table, name).map(|column| shown(column, &rows, params)));
    let (down, across, value) = (down?, across?, value?);
    let found = pivot(&numbers(&down)?, &numbers(&across)?, &numbers(&value)?);
    let mut columns = vec![Column { values: Values::Reals(found.rows.clone()), ..down }];
    for (place, level) in found.columns.iter().enumerate() {
        let cells = found.cells.iter().skip(place).step_by(found.columns.len());
        columns.push(Column {
            key: format!("{} {}", across.key, with_unit(*level, &across.unit)),
            symbol: heading(&across, *level),
            unit: value.unit.clone(),
            values: Values::Reals(cells.map(|cell| cell.map_or(f64::NAN, |Cell { mean, .. }| mean)).collect()),
            digits: value.digits,
        });
    }
    Ok(columns)
}

fn with_unit(level: f64, unit: &str) -> String {
    if unit.is_empty() { format!("{level}") } else { format!("{level} {unit}") }
}

/// Symbol of a column, where the quantity across has a symbol and is a pure number.
fn heading(across: &Column, level: f64) -> String {
    if across.symbol.is_empty() || !across.unit.is_empty() {
        return String::new();
    }
    format!("{} = {level}", across.symbol)
}

fn numbers(column: &Column) -> Result<Vec<f64>, StageError> {
    match &column.values {
        Values::Reals(values) => Ok(values.clone()),
        Values::Whole(values) => Ok(values.iter().map(|&value| value as f64).collect()),
        Values::Words(_) => Err(StageError::new(format!("`pivot` names `{}`, which holds words", column.key))
            .hint("name columns of numbers")),
    }
}
