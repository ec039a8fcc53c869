//! Units in the row below the names, as laboratories and spreadsheets write them.

use super::super::sheet::Sheet;
use super::cells::{Cells, DIMENSIONLESS, name_and_unit};
use crate::unit::Unit;

/// What the first row says of a column.
enum Below<'a> {
    /// This unit.
    Unit(&'a str),
    /// That it has none.
    Nothing,
    /// Something else: the row is one of values.
    Value,
}

/// The unit in a cell, alone or in brackets.
fn below(cell: &str) -> Below<'_> {
    let within = |open, close| cell.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
    let unit = within('[', ']').or_else(|| within('(', ')')).unwrap_or(cell).trim();
    match unit {
        "" => Below::Nothing,
        unit if DIMENSIONLESS.contains(&unit) => Below::Nothing,
        unit if !unit.starts_with(|c: char| c.is_ascii_digit()) && Unit::parse(unit).is_ok() => Below::Unit(unit),
        _ => Below::Value,
    }
}

/// Moves the units of the first row behind the names, where that row holds nothing but units of columns of numbers. Returns
/// whether it did.
pub(super) fn raise(sheet: &mut Sheet, how: &Cells) -> bool {
    let mut heads: Vec<String> = Vec::with_capacity(sheet.heads.len());
    let mut units = 0;
    for (head, cells) in sheet.heads.iter().zip(&sheet.columns) {
        let [first, rest @ ..] = cells.as_slice() else { return false };
        match below(first) {
            Below::Value => return false,
            Below::Nothing => heads.push(head.clone()),
            Below::Unit(unit) => {
                let numbers = rest.iter().map(|cell| how.number(cell)).collect::<Option<Vec<f64>>>();
                let some = numbers.is_some_and(|numbers| numbers.iter().any(|number| number.is_finite()));
                if !some || !name_and_unit(head).is_ok_and(|(_, own)| own.is_empty()) {
                    return false;
                }
                heads.push(format!("{head} [{unit}]"));
                units += 1;
            }
        }
    }
    if units > 0 {
        sheet.heads = heads;
        sheet.columns.iter_mut().for_each(|cells| drop(cells.remove(0)));
    }
    units > 0
}

#[cfg(test)]
mod tests {
    use super::super::dialect::Decimal;
    use super::*;

    fn raised(heads: &[&str], rows: &[&[&str]]) -> Option<(Vec<String>, usize)> {
        let column = |i: usize| rows.iter().map(|row| row[i].to_owned()).collect();
        let columns = (0..heads.len()).map(column).collect();
        let mut sheet = Sheet { heads: heads.iter().map(|&head| head.to_owned()).collect(), columns };
        let how = Cells { decimal: Decimal::Point, missing: None };
        raise(&mut sheet, &how).then(|| (sheet.heads.clone(), sheet.rows()))
    }

    #[test]
    fn a_row_of_units_is_raised_to_the_names_and_no_other_row() {
        let heads = ["sample", "UCS", "nu"];
        let found = raised(&heads, &[&["", "[MPa]", "-"], &["A1", "31.2", "0.2"], &["A2", "", "0.21"]]);
        assert_eq!(found, Some((vec!["sample".into(), "UCS [MPa]".into(), "nu".into()], 2)));
        // values, words among the numbers, a name with a unit of its own, no unit, and no row below it
        assert_eq!(raised(&heads, &[&["", "31", "0.2"], &["A1", "32", "0.2"]]), None);
        assert_eq!(raised(&heads, &[&["", "MPa", ""], &["A1", "high", "0.2"]]), None);
        assert_eq!(raised(&["a", "UCS [MPa]"], &[&["", "MPa"], &["1", "2"]]), None);
        assert_eq!(raised(&["a", "b"], &[&["", "-"], &["1", "2"]]), None);
        assert_eq!(raised(&["a", "b"], &[&["", "MPa"]]), None);
        // letters of categories are units, too, but not those of numbers
        assert_eq!(raised(&["mix", "y"], &[&["m", "1"], &["s", "2"]]), None);
    }
}
