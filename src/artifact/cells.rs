//! Columns of typed tables: one [`Cells`] per type of column.

use super::{Table, Unread};
use math::scale::Scale;
use ndarray::Array2;

/// A type whose values fill one column of a table, or several.
pub trait Cells: Sized {
    /// Adds the column or columns; unit and description come from the declaration.
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str);

    /// Reads them back, numbers in the declared unit.
    ///
    /// # Errors
    /// The column that is missing or has another type or unit.
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread>;

    /// Reads the columns that no field of the declaration names; `declared` are the names of its fields.
    fn take_undeclared(&mut self, _table: &Table, _declared: &[&str]) {}
}

/// Adds a column through the methods that build tables.
fn add(table: &mut Table, with: impl FnOnce(Table) -> Table) {
    *table = with(std::mem::take(table));
}

impl Cells for Vec<f64> {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        add(table, |table| table.reals_column(name, unit, about, self.clone()));
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        table.numbers(name, unit)
    }
}

impl Cells for Vec<i64> {
    fn put(&self, table: &mut Table, name: &str, _unit: &str, about: &str) {
        add(table, |table| table.ints_column(name, about, self.clone()));
    }
    fn take(table: &Table, name: &str, _unit: &str) -> Result<Self, Unread> {
        Ok(table.ints(name)?.to_vec())
    }
}

/// Counts, and indices from 0.
impl Cells for Vec<usize> {
    fn put(&self, table: &mut Table, name: &str, _unit: &str, about: &str) {
        add(table, |table| table.ints_column(name, about, self.iter().map(|&value| value as i64).collect()));
    }
    fn take(table: &Table, name: &str, _unit: &str) -> Result<Self, Unread> {
        let index = |&value: &i64| usize::try_from(value);
        let all: Result<Vec<usize>, _> = table.ints(name)?.iter().map(index).collect();
        all.map_err(|_| Unread::Type { name: name.to_owned(), found: "a negative number", wanted: "counts" })
    }
}

/// Flags, stored as 1 and 0.
impl Cells for Vec<bool> {
    fn put(&self, table: &mut Table, name: &str, _unit: &str, about: &str) {
        add(table, |table| table.ints_column(name, about, self.iter().map(|&flag| i64::from(flag)).collect()));
    }
    fn take(table: &Table, name: &str, _unit: &str) -> Result<Self, Unread> {
        Ok(table.ints(name)?.iter().map(|&flag| flag != 0).collect())
    }
}

impl Cells for Vec<String> {
    fn put(&self, table: &mut Table, name: &str, _unit: &str, about: &str) {
        add(table, |table| table.texts_column(name, about, self.clone()));
    }
    fn take(table: &Table, name: &str, _unit: &str) -> Result<Self, Unread> {
        Ok(table.texts(name)?.to_vec())
    }
}

/// The columns of a table that its declaration does not name, such as those of factors and responses.
impl Cells for Table {
    fn put(&self, table: &mut Table, _name: &str, _unit: &str, _about: &str) {
        table.columns.extend(self.columns.iter().cloned());
    }
    fn take(_table: &Table, _name: &str, _unit: &str) -> Result<Self, Unread> {
        Ok(Self::default())
    }
    fn take_undeclared(&mut self, table: &Table, declared: &[&str]) {
        let undeclared = table.columns.iter().filter(|column| !declared.contains(&column.name.as_str()));
        self.columns = undeclared.cloned().collect();
    }
}

/// The axes of space: a table in the plane has the first two.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Vectors of the plane or of space, row by row: a column for each axis, `NAME_x`, `NAME_y` and in space `NAME_z`.
impl Cells for Array2<f64> {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        for (axis, values) in AXES.iter().zip(self.columns()) {
            add(table, |table| table.reals_column(&format!("{name}_{axis}"), unit, about, values.to_vec()));
        }
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        let there = |axis: &&str| table.column(&format!("{name}_{axis}")).is_some();
        let axes = if AXES.iter().all(there) { &AXES[..] } else { &AXES[..2] };
        let columns = axes.iter().map(|axis| table.numbers(&format!("{name}_{axis}"), unit));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        Ok(Array2::from_shape_fn((table.rows(), axes.len()), |(row, axis)| columns[axis][row]))
    }
}

/// Numbered columns `NAME_1`, `NAME_2`, …, as many as there are: one list per column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbered<T = f64>(pub Vec<Vec<T>>);

impl<T> Cells for Numbered<T>
where
    Vec<T>: Cells,
{
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        for (values, number) in self.0.iter().zip(1..) {
            values.put(table, &format!("{name}_{number}"), unit, about);
        }
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        let names = (1..).map(|number| format!("{name}_{number}"));
        let there = names.take_while(|name| table.column(name).is_some());
        there.map(|name| Cells::take(table, &name, unit)).collect::<Result<_, _>>().map(Self)
    }
}

impl Numbered {
    /// The values of a row up to the first that is missing.
    pub fn row(&self, row: usize) -> Vec<f64> {
        self.0.iter().map(|column| column[row]).take_while(|value| value.is_finite()).collect()
    }
}

/// Columns that only some tables have.
impl<C: Cells> Cells for Option<C> {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        if let Some(cells) = self {
            cells.put(table, name, unit, about);
        }
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        match C::take(table, name, unit) {
            Err(Unread::Missing { .. }) => Ok(None),
            read => read.map(Some),
        }
    }
}

/// A word of a fixed list: a list of such words fills a column of texts.
pub trait Word: Copy + 'static {
    /// All of them.
    const ALL: &'static [Self];

    /// The word in files.
    fn word(self) -> &'static str;
}

impl<W: Word> Cells for Vec<W> {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        let words: Vec<String> = self.iter().map(|own| own.word().to_owned()).collect();
        words.put(table, name, unit, about);
    }
    fn take(table: &Table, name: &str, _unit: &str) -> Result<Self, Unread> {
        let known = || W::ALL.iter().map(|own| own.word()).collect::<Vec<_>>().join(", ");
        let own = |(row, word): (usize, &String)| {
            let found = W::ALL.iter().copied().find(|own| own.word() == word);
            found.ok_or_else(|| Unread::Word { name: name.to_owned(), row, text: word.clone(), known: known() })
        };
        (1..).zip(table.texts(name)?).map(own).collect()
    }
}

/// The scale of a factor in a model, as files have it.
impl Word for Scale {
    const ALL: &'static [Self] = &[Self::Linear, Self::Log];

    fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Log => "log",
        }
    }
}

/// Declares words that stand in a column: an enum that is a column of texts.
///
/// ```text
/// words! {
///     /// How a bond broke.
///     pub enum CrackMode {
///         /// Pulled apart.
///         Tension = "tension",
///         /// Sheared.
///         Shear = "shear",
///     }
/// }
/// assert_eq!(CrackMode::ALL.map(CrackMode::word), ["tension", "shear"]);
/// ```
#[macro_export]
macro_rules! words {
    ($(#[$attribute:meta])* $visible:vis enum $name:ident {
        $($(#[$variant_attribute:meta])* $variant:ident = $word:literal,)*
    }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visible enum $name { $($(#[$variant_attribute])* $variant,)* }

        impl $name {
            /// All of them, in the order of their declaration.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$variant),*];

            /// The word in files and pictures.
            pub const fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)* }
            }
        }

        impl $crate::artifact::Word for $name {
            const ALL: &'static [Self] = &Self::ALL;

            fn word(self) -> &'static str {
                self.word()
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    crate::table! {
        /// columns of every type
        struct Sample {
            /// where
            at: Array2<f64>, "mm";
            /// which
            index: Vec<usize>, "";
            /// whether
            met: Vec<bool>, "";
            /// only sometimes
            mass: Option<Vec<f64>>, "kg";
        }
    }

    #[test]
    fn a_table_comes_back_in_the_plane_and_in_space() {
        let plane = Sample { at: array![[1.0, 2.0]], index: vec![3], met: vec![true], mass: None };
        let space = Sample { at: array![[1.0, 2.0, 3.0]], mass: Some(vec![0.5]), ..plane.clone() };
        for sample in [plane, space] {
            assert_eq!(Sample::from_table(&sample.to_table()), Ok(sample));
        }
    }

    crate::table! {
        /// columns that the workflow names among declared ones
        struct Runs {
            /// which
            index: Vec<usize>, "";
            /// factors and responses
            point: Table, "";
            /// why
            failure: Vec<String>, "";
        }
    }

    #[test]
    fn undeclared_columns_stand_where_the_declaration_has_them_and_come_back() {
        let point =
            Table::default().reals_column("Ec", "GPa", "", vec![35.0]).reals_column("UCS", "MPa", "", vec![30.0]);
        let runs = Runs { index: vec![1], point, failure: vec![String::new()] };
        let table = runs.to_table();
        assert_eq!(
            table.columns.iter().map(|column| &*column.name).collect::<Vec<_>>(),
            ["index", "Ec", "UCS", "failure"]
        );
        assert_eq!(Runs::from_table(&table), Ok(runs));
    }

    #[test]
    fn a_word_that_is_not_in_the_list_is_named_with_its_row() {
        let table = Table::default().texts_column("scale", "", vec!["log".to_owned(), "wide".to_owned()]);
        let error = <Vec<Scale> as Cells>::take(&table, "scale", "").unwrap_err();
        assert_eq!(error.to_string(), "row 2: `scale` is `wide`; known are linear, log");
    }

    #[test]
    fn faults_name_the_column() {
        let message = |table: Table| Sample::from_table(&table).unwrap_err().to_string();
        let at =
            || Table::default().reals_column("at_x", "m", "", vec![0.001]).reals_column("at_y", "m", "", vec![0.0]);
        assert_eq!(message(Table::default()), "the table has no column `at_x`; it has ");
        assert!(message(at()).starts_with("the table has no column `index`"));
        assert_eq!(
            message(at().ints_column("index", "", vec![-1])),
            "column `index` holds a negative number, wanted counts"
        );
        let whole = at().ints_column("index", "", vec![1]).ints_column("met", "", vec![0]);
        assert_eq!(Sample::from_table(&whole).unwrap().at, array![[1.0, 0.0]]);
    }
}
