//! The only way to the numbers of a table: every reader names the unit that it wants them in.

use super::{Column, Table, Values};
use crate::unit::{Conversion, UnitError};

/// Why a column cannot be read as requested.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unread {
    /// The table has no such column.
    #[error("the table has no column `{name}`; it has {known}")]
    Missing {
        /// The column that was wanted.
        name: String,
        /// The columns that are there.
        known: String,
    },
    /// A column of texts where numbers are wanted.
    #[error(
        "row {row}: `{name}` is `{text}`, which is not a finite number; leave a cell empty where a run has no value"
    )]
    Text {
        /// The column.
        name: String,
        /// The first row, from 1, that is no number.
        row: usize,
        /// What stands there.
        text: String,
    },
    /// A text that is none of the words of a column.
    #[error("row {row}: `{name}` is `{text}`; known are {known}")]
    Word {
        /// The column.
        name: String,
        /// The first such row, from 1.
        row: usize,
        /// The text.
        text: String,
        /// The words of the column.
        known: String,
    },
    /// A column of another type.
    #[error("column `{name}` holds {found}, wanted {wanted}")]
    Type {
        /// The column.
        name: String,
        /// What it holds.
        found: &'static str,
        /// What was wanted.
        wanted: &'static str,
    },
    /// A unit of another kind of quantity, or one that is none.
    #[error(
        "column `{name}` is in {found} and cannot be read {wanted}: {why}; give the column's unit in its head, as in `Ec [GPa]`"
    )]
    Unit {
        /// The column.
        name: String,
        /// Its unit.
        found: String,
        /// The unit that was wanted.
        wanted: String,
        /// What is wrong.
        why: Box<UnitError>,
    },
}

impl Table {
    /// The column called `name`.
    ///
    /// # Errors
    /// There is none.
    pub fn find(&self, name: &str) -> Result<&Column, Unread> {
        self.column(name).ok_or_else(|| {
            let known = self.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ");
            Unread::Missing { name: name.to_owned(), known }
        })
    }

    /// The numbers of a column in `unit` (`""` for pure numbers); NaN where a value is missing.
    ///
    /// # Errors
    /// There is no such column, it holds texts, or it is in a unit of another kind.
    pub fn numbers(&self, name: &str, unit: &str) -> Result<Vec<f64>, Unread> {
        self.find(name)?.numbers(unit)
    }

    /// The numbers of a column as they stand, and their unit: for what shows both.
    ///
    /// # Errors
    /// There is no such column, or it holds texts.
    pub fn shown(&self, name: &str) -> Result<(Vec<f64>, &str), Unread> {
        let column = self.find(name)?;
        Ok((column.numbers(&column.unit)?, &column.unit))
    }

    /// The texts of a column.
    ///
    /// # Errors
    /// There is no such column, or it holds numbers.
    pub fn texts(&self, name: &str) -> Result<&[String], Unread> {
        let column = self.find(name)?;
        match &column.values {
            Values::Texts(texts) => Ok(texts),
            Values::Reals(_) | Values::Ints(_) => Err(column.of_type("texts")),
        }
    }

    /// The whole numbers of a column: indices, counts, flags.
    ///
    /// # Errors
    /// There is no such column, or it holds something else.
    pub fn ints(&self, name: &str) -> Result<&[i64], Unread> {
        let column = self.find(name)?;
        match &column.values {
            Values::Ints(ints) => Ok(ints),
            Values::Reals(_) | Values::Texts(_) => Err(column.of_type("whole numbers")),
        }
    }
}

impl Column {
    /// Its numbers in `unit`.
    ///
    /// # Errors
    /// It holds texts, or is in a unit of another kind.
    pub fn numbers(&self, unit: &str) -> Result<Vec<f64>, Unread> {
        let values = match &self.values {
            Values::Reals(values) => values.clone(),
            Values::Ints(values) => values.iter().map(|&value| value as f64).collect(),
            Values::Texts(texts) => {
                let number = |text: &String| text.is_empty() || text.parse().is_ok_and(f64::is_finite);
                let at = texts.iter().position(|text| !number(text)).unwrap_or(0);
                let text = texts.get(at).cloned().unwrap_or_default();
                return Err(Unread::Text { name: self.name.clone(), row: at + 1, text });
            }
        };
        let conversion = Conversion::between(&self.unit, unit).map_err(|why| Unread::Unit {
            name: self.name.clone(),
            found: if self.unit.is_empty() { "no unit".to_owned() } else { format!("`{}`", self.unit) },
            wanted: if unit.is_empty() { "as a pure number".to_owned() } else { format!("in `{unit}`") },
            why: Box::new(why),
        })?;
        Ok(conversion.of_all(values))
    }

    fn of_type(&self, wanted: &'static str) -> Unread {
        Unread::Type { name: self.name.clone(), found: self.values.type_name(), wanted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_in_the_unit_that_is_asked_for() {
        let table = Table::default()
            .reals_column("Ec", "GPa", "", vec![16.1, f64::NAN])
            .ints_column("n", "", vec![7, 14])
            .texts_column("mode", "", vec!["shear".to_owned(), "1.5".to_owned()]);
        let moduli = table.numbers("Ec", "MPa").unwrap();
        assert!(moduli[0] == 16100.0 && moduli[1].is_nan());
        assert_eq!(table.numbers("n", "%").unwrap(), [700.0, 1400.0]);
        assert_eq!(table.ints("n"), Ok(&[7, 14][..]));
        let message = |result: Result<Vec<f64>, Unread>| result.unwrap_err().to_string();
        assert_eq!(message(table.numbers("x", "")), "the table has no column `x`; it has Ec, n, mode");
        assert!(message(table.numbers("mode", "")).starts_with("row 1: `mode` is `shear`, which is not a finite"));
        assert!(message(table.numbers("Ec", "mm")).starts_with("column `Ec` is in `GPa` and cannot be read in `mm`"));
        assert!(
            message(table.numbers("Ec", "")).starts_with("column `Ec` is in `GPa` and cannot be read as a pure number")
        );
        assert!(table.texts("n").is_err() && table.ints("mode").is_err());
    }
}
