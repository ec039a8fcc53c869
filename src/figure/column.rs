//! A named column of numbers or words: the form in which figures and tables return their data.

/// Values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; NaN is a missing value.
    Reals(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Words.
    Words(Vec<String>),
}

/// How numbers of a column are written for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// As short as possible without loss.
    Shortest,
    /// This many decimals.
    Fixed(usize),
    /// This many significant digits.
    Significant(usize),
    /// This many significant digits, but whole numbers with all digits: for columns of quantities of several kinds.
    Unlike(usize),
}

/// A column with the parts of its head.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Plain name, used as head in CSV.
    pub key: String,
    /// Symbol in LaTeX notation without dollar signs; may be empty.
    pub symbol: String,
    /// Unit; may be empty.
    pub unit: String,
    /// Values.
    pub values: Values,
    /// Format for people; CSV always has all digits.
    pub digits: Digits,
}

impl Column {
    /// Numbers.
    pub fn reals(key: &str, values: Vec<f64>) -> Self {
        Self::of(key, Values::Reals(values))
    }

    /// Whole numbers.
    pub fn whole(key: &str, values: Vec<i64>) -> Self {
        Self::of(key, Values::Whole(values))
    }

    /// Words.
    pub fn words(key: &str, values: Vec<String>) -> Self {
        Self::of(key, Values::Words(values))
    }

    fn of(key: &str, values: Values) -> Self {
        Self { key: key.into(), symbol: String::new(), unit: String::new(), values, digits: Digits::Shortest }
    }

    /// Sets the unit.
    pub fn with_unit(mut self, unit: &str) -> Self {
        self.unit = unit.into();
        self
    }

    /// Sets the symbol.
    pub fn with_symbol(mut self, symbol: &str) -> Self {
        self.symbol = symbol.into();
        self
    }

    /// Sets the format.
    pub fn with_digits(mut self, digits: Digits) -> Self {
        self.digits = digits;
        self
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Reals(v) => v.len(),
            Values::Whole(v) => v.len(),
            Values::Words(v) => v.len(),
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
