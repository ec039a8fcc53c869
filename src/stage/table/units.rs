//! Quantities told row by row (`value,unit`, in SI units) in the units that people read them in.
//!
//! A response of the workflow (column `response`) gets the unit of its `[response.NAME]`; another quantity in pascal the
//! prefix that leaves one to three digits before the point, a length below a decimetre millimetres.

use crate::unit::Conversion;
use figure::column::{Column, Digits, Values};
use std::collections::BTreeMap;

/// The columns of a table that tells quantities row by row.
pub(super) const ROWWISE: [&str; 2] = ["value", "unit"];

/// Scales every number of the columns named after `value` to the wanted unit of its row, and names that unit.
pub(super) fn readable(columns: &mut [Column], wanted: &BTreeMap<String, String>) {
    let words = |name: &str| {
        columns.iter().find(|c| c.key == name).and_then(|c| match &c.values {
            Values::Words(words) => Some(words.clone()),
            Values::Reals(_) | Values::Whole(_) => None,
        })
    };
    let Some(units) = words("unit") else { return };
    let names = words("response").unwrap_or_else(|| vec![String::new(); units.len()]);
    let Some(values) = columns.iter().find_map(|c| match &c.values {
        Values::Reals(values) if c.key == "value" => Some(values.clone()),
        _ => None,
    }) else {
        return;
    };
    let rows = names.iter().zip(&units).zip(&values);
    let shown: Vec<(String, Conversion)> =
        rows.map(|((name, unit), &value)| one(wanted.get(name), unit, value)).collect();
    for column in columns {
        match &mut column.values {
            Values::Words(words) if column.key == "unit" => {
                words.iter_mut().zip(&shown).for_each(|(word, (unit, _))| word.clone_from(unit));
            }
            Values::Reals(values) if column.key == "value" || column.key == "value published" => {
                values.iter_mut().zip(&shown).for_each(|(value, (_, shown))| *value = shown.of(*value));
                if let Digits::Significant(digits) = column.digits {
                    column.digits = Digits::Unlike(digits);
                }
            }
            Values::Reals(_) | Values::Whole(_) | Values::Words(_) => {}
        }
    }
}

/// The unit to show a value in, and the conversion to it; its own where it cannot be shown in the one that is wanted.
fn one(wanted: Option<&String>, unit: &str, value: f64) -> (String, Conversion) {
    let prefixed = match value.abs() {
        size if unit == "Pa" && (1e3..1e6).contains(&size) => "kPa",
        size if unit == "Pa" && (1e6..1e9).contains(&size) => "MPa",
        size if unit == "Pa" && size >= 1e9 => "GPa",
        size if unit == "m" && size < 0.1 => "mm",
        _ => unit,
    };
    let shown = wanted.map_or(prefixed, String::as_str);
    match Conversion::between(unit, shown) {
        Ok(conversion) => (shown.to_owned(), conversion),
        Err(_) => (unit.to_owned(), Conversion::NONE),
    }
}
