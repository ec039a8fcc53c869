//! Calibration as optimisation: which parameters give the wanted responses?
//!
//! * [`constraint`]: the box of the parameters and linear constraints in it; [`least_distance`] projects onto them
//! * [`misfit`]: how far responses are from their targets
//! * [`genetic`], [`annealing`], [`differential`], [`cma_es`]: minimise the misfit as one number
//! * [`proportional`]: one parameter to which one response is proportional
//! * [`surrogate`]: models every response over all runs, which is what noisy and dear simulations need
//! * [`local`], [`polish`]: the descent from a found point that may follow the four of them
//! * [`search`]: the loop around any of them, as a pure function of settings, seed and history
//! * [`solution_set`]: all the parameters that meet the targets when there is more than one answer
//! * [`determination`]: how well the responses determine each parameter
//!
//! An optimiser proposes points and receives their results. It never sees the model, a clock or a thread, so the
//! same history gives the same points: a killed calibration is resumed by replaying its history.
//!
//! Optimisers work in the *unit box*: every parameter is mapped from its range to 0 … 1, linearly or by logarithms
//! ([`factor`]).

pub mod annealing;
pub mod cma_es;
pub mod constraint;
pub mod determination;
pub mod differential;
pub mod factor;
pub mod genetic;
pub mod least_distance;
mod level;
pub mod local;
pub mod misfit;
pub mod polish;
pub mod proportional;
pub mod search;
pub mod solution_set;
pub mod surrogate;

#[cfg(test)]
mod benchmark;
#[cfg(test)]
mod tests;

use constraint::Domain;
use misfit::Misfit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// One evaluated point.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The parameters in the unit box.
    pub point: Vec<f64>,
    /// The misfit of the responses; infinite when the evaluation failed.
    pub misfit: f64,
    /// The responses in the order of the targets; empty when the evaluation failed.
    pub responses: Vec<f64>,
}

impl Trial {
    /// Whether the evaluation gave responses.
    pub fn succeeded(&self) -> bool {
        !self.responses.is_empty()
    }
}

/// The problem of an optimiser: its domain and its targets, never the model.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Box and linear constraints.
    pub domain: Domain,
    /// Targets and how deviations from them are combined.
    pub misfit: Misfit,
    /// A first guess in the unit box: the first point of a search, and the centre of what is tried around it.
    pub start: Option<Vec<f64>>,
}

/// A minimiser that proposes points and receives their results.
///
/// [`ask`](Self::ask) and [`tell`](Self::tell) alternate; `tell` gets one trial for every point of the last `ask`, in
/// its order; only the very last batch of a search may be cut short, by its budget. Both are deterministic: all
/// randomness comes from the seed of its construction.
pub trait Optimiser {
    /// The next batch of points in the unit box, at least one; they can be evaluated in parallel.
    fn ask(&mut self) -> Vec<Vec<f64>>;

    /// The results of the last batch.
    fn tell(&mut self, trials: &[Trial]);

    /// Why the method itself has ended, if it has. Budgets and target misfits belong to [`search`].
    fn stop(&self) -> Option<Stop>;

    /// The point that the method recommends, when that is not simply the best trial.
    fn recommended(&self) -> Option<Recommendation> {
        None
    }
}

/// The point that a method recommends, with its prediction there.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// The parameters in the unit box.
    pub point: Vec<f64>,
    /// Expected response and its interval, one per target.
    pub responses: Vec<Interval>,
    /// The misfit of the expected responses.
    pub misfit: f64,
}

/// An expected mean response with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Expected value.
    pub mean: f64,
    /// Lower end of the 95 % interval of the mean.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// The wanted misfit was met by a trial.
    Reached,
    /// The interval of every expected response lies within the tolerance of its target.
    Settled,
    /// No improvement worth the name over the method's stall window.
    Stalled,
    /// The last requested generation, temperature or iteration.
    Iterations,
    /// The budget of evaluations is used up.
    Evaluations,
    /// The population or step has become too small to find anything new.
    Collapsed,
    /// The runs that a slope is taken from gave no response, or one of the other sign than the target.
    NoSlope,
    /// Every evaluation failed.
    AllFailed,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reached => "the wanted misfit is reached",
            Self::Settled => "the expected responses are known to lie within the tolerance",
            Self::Stalled => "no improvement any more",
            Self::Iterations => "the last iteration is done",
            Self::Evaluations => "the budget of evaluations is used up",
            Self::Collapsed => "the population has collapsed",
            Self::NoSlope => "no slope: runs failed, are not valid, or have the other sign than the target",
            Self::AllFailed => "every evaluation failed",
        })
    }
}

/// A fault of a calibration problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A constraint names a factor that is not calibrated.
    #[error("unknown factor `{found}`; the factors are {}", list(known))]
    UnknownFactor {
        /// The name as written.
        found: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A duplicate factor or target.
    #[error("`{name}` is given twice")]
    Twice {
        /// The name.
        name: String,
    },
    /// No factor, or no target.
    #[error("no {what} given; at least one is needed")]
    Nothing {
        /// "factor" or "target".
        what: &'static str,
    },
    /// A range without inside.
    #[error("the range of `{factor}` is empty: from {low} to {high}; the lower end must be below the upper one")]
    EmptyRange {
        /// The factor.
        factor: String,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A logarithmic scale from zero or below.
    #[error("the range of `{factor}` begins at {low}, and a logarithmic scale needs a positive lower end")]
    NoLogarithm {
        /// The factor.
        factor: String,
        /// Lower end.
        low: f64,
    },
    /// A constraint that is not linear in logarithms.
    #[error(
        "{constraint} names factors on a logarithmic scale, where only a bound of one factor or a ratio of two holds"
    )]
    NotLogarithmic {
        /// The constraint, written out.
        constraint: String,
    },
    /// A band of targets whose ends are the wrong way round.
    #[error("the target of `{response}` lies between {low} and {high}; the lower end must be below the upper one")]
    EmptyBand {
        /// The response.
        response: String,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Not a number, or infinite.
    #[error("{what} is {value}; a finite number is needed")]
    NotFinite {
        /// What it is.
        what: String,
        /// The value found.
        value: f64,
    },
    /// No point of the box meets these constraints together.
    #[error("no point of the box meets {} together", list(constraints))]
    Contradiction {
        /// The constraints, written out.
        constraints: Vec<String>,
    },
    /// A relative deviation from zero.
    #[error(
        "the target of `{response}` is 0, and a deviation relative to it is undefined; \
         use the denominator `largest`, or leave the target out"
    )]
    ZeroTarget {
        /// The response.
        response: String,
    },
    /// A weight that is negative, or weights that are all zero.
    #[error("the weight of `{response}` is {weight}; weights must be positive")]
    Weight {
        /// The response.
        response: String,
        /// The weight found.
        weight: f64,
    },
    /// A setting out of its range.
    #[error("`{setting}` is {value}; {expected}")]
    Setting {
        /// Its name as in the workflow.
        setting: &'static str,
        /// The value found.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A history of another search.
    #[error(
        "run {index} of the history stands at {found:?}, but this calibration asked for {asked:?}: \
         the history belongs to other settings or another seed"
    )]
    ForeignHistory {
        /// Number of the run, from 0.
        index: usize,
        /// Where the search asks.
        asked: Vec<f64>,
        /// Strain that the run reached.
        found: Vec<f64>,
    },
    /// A point outside the box or its constraints.
    #[error("the point {point:?} leaves the domain: {reason}")]
    Outside {
        /// The point in natural units.
        point: Vec<f64>,
        /// Which bound it breaks.
        reason: String,
    },
    /// A curve that does not cover the strains of the target.
    #[error("the curve covers strains from {low} to {high}, the target asks for {wanted}")]
    CurveTooShort {
        /// First strain of the curve.
        low: f64,
        /// Last strain of the curve.
        high: f64,
        /// The requested strain.
        wanted: f64,
    },
}

fn list(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
