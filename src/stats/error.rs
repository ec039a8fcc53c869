//! What can be wrong with a table or a model, each fault with the factor, the row and the remedy.

use math::text::typed;
use std::fmt;
use thiserror::Error;

/// One fault in the data or the model. Rows are counted from 1.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Fault {
    /// Two columns bear the same name.
    #[error("two columns are named `{name}`; give each factor and response its own name")]
    DuplicateName {
        /// The name used twice.
        name: String,
    },
    /// A column is not as long as the table.
    #[error("column `{column}` has {found} rows where the table has {expected}")]
    Length {
        /// The column.
        column: String,
        /// Its length.
        found: usize,
        /// The length of the first factor.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("row {row}: `{column}` is {value}; mark the row as missing or give a finite number")]
    NotFinite {
        /// The column.
        column: String,
        /// The row, from 1.
        row: usize,
        /// What was found.
        value: f64,
    },
    /// Squares of a column are beyond what numbers of the machine hold.
    #[error(
        "`{column}` has values of the size {size}, whose squares no number of the machine holds; take another unit"
    )]
    Magnitude {
        /// The column.
        column: String,
        /// Its largest value, or its spread.
        size: String,
    },
    /// The values of a response have almost all their digits in common.
    #[error(
        "`{response}` has values of the size {size} that differ by at most {spread}: {lost} of the 16 digits of a number are \
         lost in what they have in common, and the rest is rounding; subtract a constant before the values are written"
    )]
    DigitsLost {
        /// The response.
        response: String,
        /// Its largest value.
        size: String,
        /// Largest value minus smallest.
        spread: f64,
        /// Digits in common.
        lost: String,
    },
    /// A value is none of the declared levels of its factor.
    #[error(
        "row {row}: `{factor}` is {}, which is none of its levels {}; correct the row or add the level",
        typed(*value), numbers(levels)
    )]
    UndeclaredLevel {
        /// The factor.
        factor: String,
        /// The row, from 1.
        row: usize,
        /// What was found.
        value: f64,
        /// The declared levels.
        levels: Vec<f64>,
    },
    /// A factor never changes.
    #[error("factor `{factor}` is {value} in every usable row; vary it or take it out of the model")]
    OneLevel {
        /// The factor.
        factor: String,
        /// Its only value.
        value: String,
    },
    /// A value has no logarithm.
    #[error(
        "row {row}: factor `{factor}` is {}, which has no logarithm; a logarithmic scale is for values above zero",
        typed(*value)
    )]
    NotPositive {
        /// The factor.
        factor: String,
        /// Counted from 1.
        row: usize,
        /// Its value.
        value: f64,
    },
    /// A declared level does not occur.
    #[error(
        "factor `{factor}` never takes its level {level} in a usable row of `{response}` ({missing} missing); \
         run that level or drop it"
    )]
    EmptyLevel {
        /// The factor.
        factor: String,
        /// The level without rows.
        level: String,
        /// The response looked at.
        response: String,
        /// Rows without a value of it.
        missing: usize,
    },
    /// A response never changes.
    #[error("response `{response}` is {} in all {rows} usable rows; there is nothing to explain", typed(*value))]
    ConstantResponse {
        /// The response.
        response: String,
        /// Its only value.
        value: f64,
        /// The usable rows.
        rows: usize,
    },
    /// The model has more terms than the table has usable rows.
    #[error(
        "response `{response}` has {rows} usable rows ({missing} missing) for {terms} coefficients; \
         add runs or drop terms"
    )]
    TooFewRows {
        /// The response.
        response: String,
        /// Usable rows.
        rows: usize,
        /// Rows without a value.
        missing: usize,
        /// Coefficients of the model, the constant counted.
        terms: usize,
    },
    /// No degree of freedom is left to estimate the error.
    #[error(
        "response `{response}`: {rows} usable rows for {terms} coefficients leave no degree of freedom for the error; \
         take the empty columns as error, pool weak factors or add runs"
    )]
    NoErrorLeft {
        /// The response.
        response: String,
        /// Usable rows.
        rows: usize,
        /// Coefficients of the model, the constant counted.
        terms: usize,
    },
    /// Pure error was requested and no two rows are replicates.
    #[error("response `{response}` has no replicated runs, so there is no pure error; use the residual as error")]
    NoReplicates {
        /// The response.
        response: String,
    },
    /// A term is aliased with others.
    #[error(
        "`{term}` is aliased with {} in the usable rows of `{response}`; drop one of them or use a larger design",
        names(others)
    )]
    Aliased {
        /// The response.
        response: String,
        /// The term that adds nothing.
        term: String,
        /// The terms that are aliased with it.
        others: Vec<String>,
    },
    /// A power of a factor whose levels are names.
    #[error("`{term}` takes a power of `{factor}`, whose levels are names; write `{factor}` without a power")]
    PowerOfNames {
        /// The term.
        term: String,
        /// The factor.
        factor: String,
    },
    /// A name that the table does not have.
    #[error("no {what} is named `{name}`; there are {}", names(known))]
    Unknown {
        /// "factor", "response" or "term".
        what: &'static str,
        /// The requested name.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A text that is no term.
    #[error("`{text}` is no term; write `const`, `Ec`, `Ec^2`, `Ec*kn_ks` or a formula such as `scn/(1+ratio)`")]
    Term {
        /// The text.
        text: String,
    },
    /// The model names a term twice, or no term at all.
    #[error("the model {problem}; list each of its terms once")]
    Model {
        /// What is wrong.
        problem: String,
    },
    /// A row weight is negative, zero or not finite.
    #[error("row {row}: weight {value} is not a positive number")]
    Weight {
        /// The row, from 1.
        row: usize,
        /// What was found.
        value: f64,
    },
    /// A probability outside (0, 1).
    #[error("{what} is {value}; it must lie between 0 and 1")]
    Probability {
        /// Which setting.
        what: &'static str,
        /// What was found.
        value: f64,
    },
    /// Screening needs two levels per factor.
    #[error("factor `{factor}` has {levels} levels; a screening analysis needs exactly two")]
    NotTwoLevels {
        /// The factor.
        factor: String,
        /// How many it has.
        levels: usize,
    },
}

/// Every fault found, at least one.
#[derive(Clone, Debug, Error, PartialEq)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    /// `Ok` without a fault.
    pub(crate) fn none_in(faults: Vec<Fault>) -> Result<(), Faults> {
        if faults.is_empty() { Ok(()) } else { Err(Faults(faults)) }
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Faults(vec![fault])
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            write!(f, "{}{fault}", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

/// 1, 2.5, 4; the first of many.
fn numbers(list: &[f64]) -> String {
    const MOST: usize = 12;
    let mut all: Vec<String> = list.iter().take(MOST).map(|value| typed(*value)).collect();
    if list.len() > MOST {
        all.push("…".to_owned());
    }
    all.join(", ")
}

/// `a`, `b` and `c`.
fn names(list: &[String]) -> String {
    let quoted: Vec<String> = list.iter().map(|n| format!("`{n}`")).collect();
    match quoted.split_last() {
        None => "none".into(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}
