//! A range analysis as it is stored.

use super::notes::NoteTable;
use super::validity::NotValid;
use super::{ArtifactKind, Cells, Numbered, Table, Unread, Values};

crate::artifact! {
    /// A range analysis.
    pub struct Range = ArtifactKind::RANGE {
        /// mean response at each level
        pub range: Ranges, "";
        /// values of the levels
        pub levels: LevelValues, "";
        /// what should be looked at before the numbers are trusted
        pub notes: NoteTable, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

crate::table! {
    /// mean response at each level
    pub struct Ranges {
        /// the response
        pub response: Vec<String>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// mean response at the level, in its unit
        pub level: Numbered, "";
        /// greatest mean minus least
        pub range: Vec<f64>, "";
        /// 1 has the largest range
        pub rank: Vec<i64>, "";
        /// runs without a value, or left out
        pub missing: Vec<i64>, "";
    }
}

crate::table! {
    /// values of the levels
    pub struct LevelValues {
        /// the factor
        pub factor: Vec<String>, "";
        /// unit of the factor
        pub unit: Vec<String>, "";
        /// in the factor's unit, or its name
        pub level: Levels, "";
    }
}

/// Numbered columns of levels: numbers, or texts in a table where a factor has names for levels.
#[derive(Clone, Debug, PartialEq)]
pub enum Levels {
    /// In the units of the factors.
    Numbers(Numbered),
    /// Names, and numbers as texts.
    Names(Numbered<String>),
}

impl Default for Levels {
    fn default() -> Self {
        Self::Numbers(Numbered::default())
    }
}

impl Levels {
    /// The levels of a row up to the first that is missing; `None` where one is a name.
    pub fn numbers(&self, row: usize) -> Option<Vec<f64>> {
        match self {
            Self::Numbers(levels) => Some(levels.row(row)),
            Self::Names(levels) => {
                let texts = levels.0.iter().map(|column| &column[row]).take_while(|text| !text.is_empty());
                texts.map(|text| text.parse().ok()).collect()
            }
        }
    }
}

impl Cells for Levels {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        match self {
            Self::Numbers(levels) => levels.put(table, name, unit, about),
            Self::Names(levels) => levels.put(table, name, unit, about),
        }
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        match table.column(&format!("{name}_1")).map(|column| &column.values) {
            Some(Values::Texts(_)) => Ok(Self::Names(Cells::take(table, name, unit)?)),
            Some(Values::Reals(_) | Values::Ints(_)) | None => Ok(Self::Numbers(Cells::take(table, name, unit)?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_come_back_as_numbers_or_as_names() {
        let texts = |values: [&str; 2]| values.map(String::from).to_vec();
        let numbers = Levels::Numbers(Numbered(vec![vec![1.0, 10.0], vec![2.5, f64::NAN]]));
        let names = Levels::Names(Numbered(vec![texts(["OPC", "10"]), texts(["slag", ""])]));
        for (level, rows) in [(numbers, [Some(vec![1.0, 2.5]), Some(vec![10.0])]), (names, [None, Some(vec![10.0])])] {
            let (factor, unit) = (texts(["a", "b"]), texts(["", "mm"]));
            let table = LevelValues { factor, unit, level }.to_table();
            let back = LevelValues::from_table(&table).unwrap();
            assert_eq!([0, 1].map(|row| back.level.numbers(row)), rows);
        }
    }
}
