//! Heads and cells of a table of text: names with units, numbers, words for missing values.

use super::super::StageError;
use super::dialect::{Decimal, is_meant_as_number, is_number};
use crate::artifact::{Column, Values};
use crate::unit::Unit;
use std::collections::HashSet;

/// Default words for missing values.
const MISSING: [&str; 8] = ["NA", "N/A", "n/a", "NaN", "nan", "null", "-", "–"];

/// How cells are read.
pub(super) struct Cells<'a> {
    pub decimal: Decimal,
    pub missing: Option<&'a [String]>,
}

/// The cells of a column that are neither numbers nor missing, where it is read as words.
#[derive(Debug, PartialEq)]
pub(super) struct Words {
    /// The column.
    pub name: String,
    unit: String,
    /// Their rows, from 1.
    rows: Vec<usize>,
    /// The different ones, in their order.
    words: Vec<String>,
    /// Words for missing values that the workflow names.
    missing: Vec<String>,
}

/// Most rows and words that a fault lists.
const MOST_LISTED: usize = 8;

/// `1, 2 and 3`, or the first of many and how many there are.
fn listed(all: impl ExactSizeIterator<Item = String>) -> String {
    let count = all.len();
    let mut shown: Vec<String> = all.take(MOST_LISTED).collect();
    match shown.pop() {
        Some(last) if count > MOST_LISTED => format!("{}, {last}, … ({count} in all)", shown.join(", ")),
        Some(last) if !shown.is_empty() => format!("{} and {last}", shown.join(", ")),
        last => last.unwrap_or_default(),
    }
}

impl Words {
    /// `rows 2 and 5: `UCS` [MPa] is `broken``.
    pub(super) fn found(&self) -> String {
        let rows = listed(self.rows.iter().map(usize::to_string));
        let words = listed(self.words.iter().map(|word| format!("`{}`", shortened(word))));
        let (plural, name) = (if self.rows.len() == 1 { "" } else { "s" }, &self.name);
        let unit = if self.unit.is_empty() { String::new() } else { format!(" [{}]", self.unit) };
        format!("row{plural} {rows}: `{name}`{unit} is {words}")
    }

    /// That they are no numbers, and what to do.
    pub(super) fn fault(&self) -> StageError {
        let none = if self.words.len() == 1 { "which is no number" } else { "which are no numbers" };
        StageError::new(format!("{}, {none}", self.found())).hint(format!("correct the file, or {}", self.as_missing()))
    }

    /// The key that takes them for missing values, with the words that it holds already.
    pub(super) fn as_missing(&self) -> String {
        let all: Vec<String> = self.missing.iter().chain(&self.words).map(|word| format!("{word:?}")).collect();
        let stands = if self.words.len() == 1 { "it stands" } else { "they stand" };
        format!("say `missing = [{}]` if {stands} for no value", all.join(", "))
    }

    /// The first of them.
    pub(super) fn first(&self) -> &str {
        self.words.first().map_or("", String::as_str)
    }
}

/// One column of the table; `names` are those of the columns before it. `words` receives what is no number in it.
pub(super) fn column(
    (head, cells): (&str, Vec<String>),
    how: &Cells,
    names: &mut HashSet<String>,
    found: &mut Vec<Words>,
) -> Result<Column, StageError> {
    let (name, unit) = name_and_unit(head)?;
    if name.is_empty() {
        let message = format!("column {} has no name: every column needs a name of its own", names.len() + 1);
        let hint = "say `first_line = 3` if the names stand in the third line; of merged cells only the first has a text, so \
                    write a name above every column";
        return Err(StageError::new(message).hint(hint));
    }
    if !names.insert(name.to_owned()) {
        return Err(StageError::new(format!("two columns are called `{name}`: every column needs a name of its own")));
    }
    let column =
        |unit: &str, values| Column { name: name.to_owned(), unit: unit.to_owned(), about: String::new(), values };
    let numbers: Option<Vec<f64>> = cells.iter().map(|cell| how.number(cell)).collect();
    if let Some(values) = numbers {
        return Ok(column(unit, Values::Reals(values)));
    }
    found.push(how.words(name, unit, &cells)?);
    let words = cells.into_iter().map(|cell| if how.is_missing(&cell) { String::new() } else { cell });
    Ok(column("", Values::Texts(words.collect())))
}

/// Signs in the place of a unit that say that there is none, as in `w/c [-]`.
pub(super) const DIMENSIONLESS: [&str; 3] = ["-", "–", "—"];

/// `UCS [MPa]`, `UCS (MPa)`, `UCS/MPa` or `UCS`. A bracket or stroke that holds no unit, as in `kn/ks`, is part of the name.
pub(super) fn name_and_unit(head: &str) -> Result<(&str, &str), StageError> {
    if let Some((name, unit)) = head.split_once('[') {
        let alone = unit.trim_end().strip_suffix(']').filter(|unit| !unit.contains(['[', ']']));
        let unit = alone.map(str::trim).ok_or_else(|| {
            StageError::new(format!("column `{head}`: the unit must stand alone in brackets at the end"))
                .hint("write for example `Ec [GPa]`")
        })?;
        if DIMENSIONLESS.contains(&unit) {
            return Ok((name.trim(), ""));
        }
        Unit::parse(unit).map_err(|e| StageError::new(format!("column `{head}`: {e}")))?;
        return Ok((name.trim(), unit));
    }
    let known = |unit: &str| !unit.is_empty() && unit != "1" && Unit::parse(unit).is_ok();
    let round = head.strip_suffix(')').and_then(|rest| rest.split_once('(')).filter(|(name, _)| !name.ends_with('/'));
    // the first slash: a unit may hold another, as in `v / m/s`
    let stroke = head.split_once('/').filter(|(_, unit)| is_plain_unit(bare(unit.trim())));
    let both = [round, stroke].into_iter().flatten().map(|(name, unit)| (name.trim(), unit.trim()));
    if let Some((name, _)) = round.filter(|(_, unit)| DIMENSIONLESS.contains(&unit.trim())) {
        return Ok((name.trim(), ""));
    }
    let found = both.into_iter().find(|(name, unit)| !name.is_empty() && known(bare(unit)));
    Ok(found.map_or((head, ""), |(name, unit)| (name, bare(unit))))
}

/// Whether a text after a slash can only be a unit: `ks` and `t` are units too, but `kn/ks` and `R/t` are ratios.
fn is_plain_unit(unit: &str) -> bool {
    let marked = unit.contains(|c: char| c.is_uppercase() || c.is_ascii_digit() || "%°µ/".contains(c));
    marked || ["m", "cm", "mm", "g", "kg", "s", "ms", "min", "rad", "deg"].contains(&unit)
}

/// `(kg/m^3)` of the head `density/(kg/m^3)`.
fn bare(unit: &str) -> &str {
    unit.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(unit)
}

impl Cells<'_> {
    fn is_missing(&self, cell: &str) -> bool {
        match self.missing {
            Some(words) => cell.is_empty() || words.iter().any(|word| word == cell),
            None => cell.is_empty() || MISSING.contains(&cell),
        }
    }

    /// The number of a cell, NaN for a missing one.
    pub(super) fn number(&self, cell: &str) -> Option<f64> {
        if self.is_missing(cell) {
            return Some(f64::NAN);
        }
        let text = match self.decimal {
            Decimal::Point => cell.to_owned(),
            Decimal::Comma if cell.contains('.') => return None,
            Decimal::Comma => cell.replacen(',', ".", 1),
        };
        // a true minus sign, as word processors write it
        let text = text.replacen('−', "-", 1);
        is_number(&text).then(|| text.parse().ok()).flatten()
    }

    /// What is no number in a column that is not one of numbers.
    ///
    /// # Errors
    /// A number with a thousands separator, numbers that are written otherwise, or words in a column with a unit.
    fn words(&self, name: &str, unit: &str, cells: &[String]) -> Result<Words, StageError> {
        let wrong: Vec<(usize, &String)> =
            cells.iter().enumerate().filter(|(_, cell)| self.number(cell).is_none()).collect();
        if let Some((row, cell)) = wrong.iter().find(|(_, cell)| grouped(cell)) {
            let message = format!("row {}: `{name}` is `{cell}`, a number with a thousands separator", row + 1);
            let hint = "remove the separators from the file: the same signs stand for decimals elsewhere, and a guess would \
                        be wrong by a thousand";
            return Err(StageError::new(message).hint(hint));
        }
        // A column of numbers but for some that are written otherwise would be a column of words, and nobody would see it.
        if let Some((row, cell)) = wrong.first().filter(|_| wrong.iter().all(|(_, cell)| is_meant_as_number(cell))) {
            let message = format!("row {}: `{name}` is `{}`, which is no number here", row + 1, shortened(cell));
            let hint = "write it as 5, 0.05 or 5e-2, between 1e-300 and 1e300; per cent stand in the head: `x [%]`";
            return Err(StageError::new(message).hint(hint));
        }
        let rows = wrong.iter().map(|(row, _)| row + 1).collect();
        let mut seen = HashSet::new();
        let words = wrong.into_iter().map(|(_, cell)| cell).filter(|cell| seen.insert(*cell)).cloned().collect();
        let missing = self.missing.unwrap_or_default().to_vec();
        let words = Words { name: name.to_owned(), unit: unit.to_owned(), rows, words, missing };
        let are_numbers = cells.iter().any(|cell| !self.is_missing(cell) && self.number(cell).is_some());
        if !unit.is_empty() && are_numbers { Err(words.fault()) } else { Ok(words) }
    }
}

/// A cell short enough for a message.
fn shortened(cell: &str) -> String {
    const LONGEST: usize = 40;
    match cell.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &cell[..end]),
        None => cell.to_owned(),
    }
}

/// `1.234,5`, `1,234.5`, `1 234`, `1'234`: digits in groups of three, with signs between them.
fn grouped(cell: &str) -> bool {
    let separator = |c: char| matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '’' | ',' | '.');
    let body = cell.strip_prefix(['-', '+', '−']).unwrap_or(cell);
    let parts: Vec<&str> = body.split(separator).collect();
    let digits = |part: &&str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    let [first, rest @ ..] = parts.as_slice() else { return false };
    // the last part may be decimals
    let groups = &rest[..rest.len().saturating_sub(1)];
    let last = rest.last().is_some_and(digits);
    !rest.is_empty()
        && (1..=3).contains(&first.len())
        && digits(first)
        && last
        && groups.iter().all(|g| g.len() == 3)
        && groups.iter().all(digits)
        && (!groups.is_empty() || rest.last().is_some_and(|last| last.len() == 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_in_three_ways() {
        let read = |head| name_and_unit(head).unwrap();
        assert_eq!(read("UCS [MPa]"), ("UCS", "MPa"));
        assert_eq!(read("UCS (MPa)"), ("UCS", "MPa"));
        assert_eq!(read("UCS/MPa"), ("UCS", "MPa"));
        assert_eq!(read("v / m/s"), ("v", "m/s"));
        assert_eq!(read("density/(kg/m^3)"), ("density", "kg/m^3"));
        assert_eq!(read("d/mm"), ("d", "mm"));
        assert_eq!(read("kn/ks"), ("kn/ks", ""));
        assert_eq!(read("R/t"), ("R/t", ""));
        assert_eq!(read("strength (mean)"), ("strength (mean)", ""));
        assert_eq!(read("nu"), ("nu", ""));
        assert_eq!([read("w/c [-]"), read("w/c (–)")], [("w/c", ""); 2]);
    }

    #[test]
    fn separators_of_thousands_are_told_from_decimals() {
        for cell in ["1.234,5", "1,234.5", "12 345", "1'234", "-1.234.567"] {
            assert!(grouped(cell), "{cell}");
        }
        for cell in ["1.5", "12.34", "A1", "2024-01-01", "1234.567", "CEM I", "1..234"] {
            assert!(!grouped(cell), "{cell}");
        }
    }
}
