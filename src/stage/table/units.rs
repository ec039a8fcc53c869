//! Converts quantities that a table lists row by row (`value,unit`, in SI units) to the units of readers.
//!
//! A response of the workflow (column `response`) gets the unit of its `[response.NAME]`, another quantity that of the
//! field ([`super::super::units`]). So does a column that the workflow does not declare.

use super::super::units::shown_unit;
use crate::unit::Conversion;
use figure::column::{Column, Digits, Values};
use std::collections::BTreeMap;

/// The columns of a table that lists quantities row by row.
pub(super) const ROWWISE: [&str; 2] = ["value", "unit"];

/// Converts every number in columns called after `value` to the unit of its row for readers, and writes that unit.
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

/// Converts columns of quantities that the workflow does not declare, which are in SI units, to the units of the field.
pub(super) fn of_the_field(columns: &mut [Column], declared: &[String]) {
    for column in columns.iter_mut().filter(|column| !declared.contains(&column.key)) {
        let Values::Reals(values) = &mut column.values else { continue };
        let largest =
            values.iter().filter(|value| value.is_finite()).fold(0.0, |most: f64, value| most.max(value.abs()));
        let (unit, shown) = one(None, &column.unit, largest);
        if !shown.is_identity() {
            values.iter_mut().for_each(|value| *value = shown.of(*value));
            column.unit = unit;
        }
    }
}

/// The unit for readers and the conversion to it; the value's own unit where it cannot be converted.
fn one(wanted: Option<&String>, unit: &str, value: f64) -> (String, Conversion) {
    let shown = shown_unit(wanted, unit, value);
    let conversion = Conversion::between(unit, &shown).unwrap_or(Conversion::NONE);
    (shown, conversion)
}
