//! What can be wrong with a request for a design. All faults of a request are returned together.

use thiserror::Error;

/// One thing that is wrong, with the factor or option it concerns and the remedy.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// No factor.
    #[error("the design has no factors; name at least one, with its levels or its range")]
    NoFactors,
    /// A factor without a name.
    #[error("factor {number} has no name")]
    NoName {
        /// Position of the factor, from 1.
        number: usize,
    },
    /// Two factors share a name.
    #[error("factor `{factor}` is named twice, as factors {first} and {second}; give each its own name")]
    DuplicateName {
        /// The name.
        factor: String,
        /// Its first position, from 1.
        first: usize,
        /// Its second position, from 1.
        second: usize,
    },
    /// A factor that cannot vary.
    #[error(
        "factor `{factor}` has {}; a factor needs at least two, or else it is a constant of the model",
        levels(found)
    )]
    TooFewLevels {
        /// The factor.
        factor: String,
        /// How many levels it has.
        found: usize,
    },
    /// A duplicate level.
    #[error(
        "factor `{factor}` has the level {value} twice, as levels {first} and {second}; remove one (to run a level more often, use `doubled` or `replicates`)"
    )]
    DuplicateLevel {
        /// The factor.
        factor: String,
        /// The repeated value.
        value: f64,
        /// Its first position, from 1.
        first: usize,
        /// Its second position, from 1.
        second: usize,
    },
    /// NaN or infinity among the levels or limits.
    #[error("factor `{factor}`: {what} is {value}, not a finite number")]
    NotFinite {
        /// The factor.
        factor: String,
        /// "level 2", "the lower limit", …
        what: String,
        /// What was found.
        value: f64,
    },
    /// A logarithmic scale of values that have no logarithm.
    #[error("factor `{factor}` has a logarithmic scale and begins at {low}; give values above 0")]
    NoLogarithm {
        /// The factor.
        factor: String,
        /// Its lowest value.
        low: f64,
    },
    /// A range whose limits are equal or the wrong way round.
    #[error("factor `{factor}` has an empty range, {low} to {high}; the lower limit must be below the upper one")]
    EmptyRange {
        /// The factor.
        factor: String,
        /// Lower limit of the input.
        low: f64,
        /// Upper limit of the input.
        high: f64,
    },
    /// The design wants another number of levels than the factor has.
    #[error("factor `{factor}` has {found} levels, but {design} sets {wanted}; {remedy}")]
    WrongLevels {
        /// The factor.
        factor: String,
        /// How many levels it has.
        found: usize,
        /// The design.
        design: String,
        /// What the design sets, in words.
        wanted: String,
        /// What to do.
        remedy: String,
    },
    /// Levels that are not evenly spaced where a coded centre is needed.
    #[error(
        "factor `{factor}` has the middle level {middle}, but the centre of {low} to {high} is {centre}; space its levels evenly or give the range"
    )]
    UnevenLevels {
        /// The factor.
        factor: String,
        /// The middle level.
        middle: f64,
        /// Lowest level.
        low: f64,
        /// Highest level.
        high: f64,
        /// Their mean.
        centre: f64,
    },
    /// No construction is published (or none is known here) for this size.
    #[error("{design}: {found}; {remedy}")]
    NoConstruction {
        /// The design.
        design: String,
        /// The request.
        found: String,
        /// What exists instead.
        remedy: String,
    },
    /// An option that cannot be read or has no meaning here.
    #[error("`{option}` is {found}; {wanted}")]
    BadOption {
        /// Key of the option.
        option: String,
        /// What was found.
        found: String,
        /// What is possible.
        wanted: String,
    },
    /// A given row that does not fit the factors.
    #[error("row {row}: {found}; {wanted}")]
    BadRow {
        /// Position of the row, from 1.
        row: usize,
        /// What was found.
        found: String,
        /// What was expected.
        wanted: String,
    },
}

fn levels(found: &usize) -> String {
    match found {
        0 => "no levels".to_owned(),
        1 => "one level".to_owned(),
        more => format!("{more} levels"),
    }
}

/// Everything that is wrong with a request, one fault a line.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}", .faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct DesignError {
    /// The faults, in the order of the factors and options they concern.
    pub faults: Vec<Fault>,
}

impl From<Vec<Fault>> for DesignError {
    fn from(faults: Vec<Fault>) -> Self {
        Self { faults }
    }
}
