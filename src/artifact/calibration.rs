//! Results of calibration and verification as they are stored.
//!
//! What readers of these artifacts rely on: the tables may hold further columns, which are found by their names in a
//! table that is printed. The tables `solution`, `history`, `solution_set` and `runs` have a column for each factor and response of the
//! workflow besides those that are declared here; [`Table::numbers`] reads such a column by its name.

use super::validity::NotValid;
use super::{ArtifactKind, Table};

crate::artifact! {
    /// Calibrated parameters.
    pub struct Solution = ArtifactKind::SOLUTION {
        /// calibrated parameters and the responses they are predicted to give: [`Solved`] with factors and responses
        pub solution: Table, "";
        /// targets and what is expected
        pub prediction: Prediction, "";
        /// evaluations: [`Evaluations`] with factors and responses
        pub history: Table, "";
        /// further parameters that give the responses of the solution: [`Alternatives`] with factors
        pub solution_set: Table, "";
    }
}

crate::artifact! {
    /// Calibrated parameters on fresh specimens.
    pub struct Verification = ArtifactKind::VERIFICATION {
        /// the targets and what the runs gave
        pub summary: Summary, "";
        /// the runs: [`VerifiedRuns`] with factors and responses
        pub runs: Table, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

crate::table! {
    /// calibrated parameters and the responses they are predicted to give
    pub struct Solved {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// of the predicted responses
        pub misfit: Vec<f64>, "";
        /// of the model
        pub evaluations: Vec<i64>, "";
        /// evaluations without responses
        pub failed: Vec<i64>, "";
        /// why the search ended
        pub stop: Vec<String>, "";
        /// directions that change no response
        pub free: Vec<f64>, "";
    }
}

crate::table! {
    /// evaluations: all simulations, or those that improved on a surface
    pub struct Evaluations {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// counted from 1
        pub evaluation: Vec<i64>, "";
        /// of this evaluation
        pub misfit: Vec<f64>, "";
        /// best misfit so far
        pub best: Vec<f64>, "";
        /// misfit expected at the point that was recommended then
        pub recommended: Vec<f64>, "";
        /// empty when it went well
        pub failure: Vec<String>, "";
    }
}

crate::table! {
    /// further parameters that give the responses of the solution
    pub struct Alternatives {
        /// target set, from 1
        pub set: Vec<i64>, "";
    }
}

crate::table! {
    /// one row per run
    pub struct VerifiedRuns {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// counted from 1
        pub specimen: Vec<i64>, "";
        /// why the run gave no result; empty when it did
        pub failure: Vec<String>, "";
    }
}

crate::table! {
    /// targets, what is expected, and what can be had over the ranges
    pub struct Prediction {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// the response
        pub response: Vec<String>, "";
        /// of the numbers beside it
        pub unit: Vec<String>, "";
        /// wanted
        pub target: Vec<f64>, "";
        /// at the solution
        pub expected: Vec<f64>, "";
        /// lower end of the 95 % interval of the mean
        pub low: Vec<f64>, "";
        /// upper end
        pub high: Vec<f64>, "";
        /// as in the misfit
        pub deviation_percent: Vec<f64>, "";
        /// least over the ranges
        pub reach_low: Vec<f64>, "";
        /// greatest over the ranges
        pub reach_high: Vec<f64>, "";
        /// whether the target can be had by itself
        pub reach: Vec<String>, "";
    }
}

crate::table! {
    /// calibrated sets on fresh specimens
    pub struct Summary {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// the response
        pub response: Vec<String>, "";
        /// of the numbers beside it
        pub unit: Vec<String>, "";
        /// wanted
        pub target: Vec<f64>, "";
        /// of the runs
        pub mean: Vec<f64>, "";
        /// standard deviation of a run
        pub std: Vec<f64>, "";
        /// standard deviation over mean
        pub cv_percent: Vec<f64>, "";
        /// of the mean against the target
        pub relative_error_percent: Vec<f64>, "";
        /// the same difference against the mean
        pub error_of_mean_percent: Vec<f64>, "";
        /// lower end of the 95 % interval of the mean
        pub low: Vec<f64>, "";
        /// upper end
        pub high: Vec<f64>, "";
        /// whether the interval holds the target
        pub target_inside: Vec<String>, "";
        /// runs with a value
        pub n: Vec<i64>, "";
    }
}
