//! The numbers of another table beside ours, row by row.

use super::super::StageError;
use super::column_of;
use crate::artifact;
use figure::column::{Column, Digits, Values};

/// Adds, after each column of numbers that both tables have, the value of the other and the deviation of ours in per cent; at
/// the end the notes of the other table.
pub(super) fn beside(columns: Vec<Column>, other: &artifact::Table, by: &[String]) -> Result<Vec<Column>, StageError> {
    let keys = by.iter().map(|name| {
        let ours = columns.iter().find(|c| c.key == *name);
        let ours =
            ours.ok_or_else(|| StageError::new(format!("`by` names `{name}`, which is not among the columns")))?;
        let theirs = column_of(other, name)?;
        let theirs = if theirs.values.are_numbers() {
            artifact::Values::Reals(theirs.numbers(&ours.unit)?)
        } else {
            theirs.values.clone()
        };
        Ok((&ours.values, theirs))
    });
    let keys = keys.collect::<Result<Vec<_>, StageError>>()?;
    let rows = columns.first().map_or(0, Column::len);
    let mut used = vec![false; other.rows()];
    let partner: Vec<Option<usize>> = (0..rows)
        .map(|i| {
            let hit = (0..other.rows()).find(|&j| !used[j] && keys.iter().all(|(a, b)| equal(a, i, b, j)))?;
            used[hit] = true;
            Some(hit)
        })
        .collect();
    let mut out = Vec::new();
    for column in columns {
        let theirs = other.column(&column.key).filter(|other| !by.contains(&other.name) && other.values.are_numbers());
        let printed = theirs.map(|theirs| theirs.numbers(&column.unit)).transpose()?;
        let ours: Option<Vec<f64>> = match &column.values {
            Values::Reals(values) => Some(values.clone()),
            Values::Whole(values) => Some(values.iter().map(|&v| v as f64).collect()),
            Values::Words(_) => None,
        };
        let (Some(printed), Some(ours)) = (printed, ours) else {
            out.push(column);
            continue;
        };
        let theirs: Vec<f64> = partner.iter().map(|p| p.map_or(f64::NAN, |j| printed[j])).collect();
        let deviation = ours.iter().zip(&theirs).map(|(a, b)| 100.0 * (a / b - 1.0)).collect();
        let (key, digits, unit) = (column.key.clone(), column.digits, column.unit.clone());
        out.push(column);
        out.push(Column::reals(&format!("{key} published"), theirs).with_unit(&unit).with_digits(digits));
        out.push(Column::reals(&format!("{key} deviation"), deviation).with_unit("%").with_digits(Digits::Fixed(1)));
    }
    if let Some(notes) = other.column(NOTE).filter(|_| out.iter().all(|column| column.key != NOTE))
        && let artifact::Values::Texts(notes) = &notes.values
    {
        let own = partner.iter().map(|p| p.map_or_else(String::new, |j| notes[j].clone())).collect();
        out.push(Column::words(NOTE, own));
    }
    Ok(out)
}

/// The column in which the other table says what is odd about a value, such as a misprint.
const NOTE: &str = "note";

/// Whether two cells are equal; numbers within a thousandth, because printed ones are rounded.
fn equal(ours: &Values, i: usize, theirs: &artifact::Values, j: usize) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a.abs().max(b.abs()).max(1e-12);
    let number = match theirs {
        artifact::Values::Reals(v) => Some(v[j]),
        artifact::Values::Ints(v) => Some(v[j] as f64),
        artifact::Values::Texts(_) => None,
    };
    match (ours, number, theirs) {
        (Values::Reals(a), Some(b), _) => near(a[i], b),
        (Values::Whole(a), Some(b), _) => near(a[i] as f64, b),
        (Values::Words(a), None, artifact::Values::Texts(b)) => a[i] == b[j],
        _ => false,
    }
}
