//! Results of calibration and verification as they are stored.
//!
//! The columns of factors and responses have the names that the workflow gives them: they are in a field of type
//! [`Table`], and [`Table::numbers`] reads one by its name.

use super::notes::NoteTable;
use super::validity::NotValid;
use super::{ArtifactKind, Cells, Table, Unread};

crate::artifact! {
    /// Calibrated parameters.
    pub struct Solution = ArtifactKind::SOLUTION {
        /// the calibrated parameters and the responses that they are predicted to give
        pub solution: Solved, "";
        /// the parameters with their intervals
        pub parameters: Parameters, "";
        /// the targets and the expected responses
        pub prediction: Prediction, "";
        /// the evaluations
        pub history: Evaluations, "";
        /// evaluations until the responses were near the targets
        pub effort: Effort, "";
        /// further parameters that give the responses of the solution
        pub solution_set: Alternatives, "";
        /// what a reader must know first
        pub notes: NoteTable, "";
    }
}

crate::artifact! {
    /// Calibrated parameters on new specimens.
    pub struct Verification = ArtifactKind::VERIFICATION {
        /// the targets and the moments of the runs
        pub summary: Summary, "";
        /// the runs
        pub runs: VerifiedRuns, "";
        /// the runs that are not valid
        pub not_valid: Option<NotValid>, "";
    }
}

crate::words! {
    /// The answer to a question about a target.
    pub enum Answer {
        /// It does.
        Yes = "yes",
        /// It does not.
        No = "no",
        /// The data do not tell.
        Unknown = "unknown",
    }
}

crate::words! {
    /// How far the targets determine a parameter.
    pub enum Determination {
        /// It lies in a small part of its range.
        Determined = "determined",
        /// It lies in a part of its range.
        Partly = "partly determined",
        /// It can have nearly any value of its range.
        Free = "free",
        /// There is no model that tells.
        Unknown = "unknown",
    }
}

crate::words! {
    /// The simulators of an evaluation.
    pub enum Level {
        /// The coarse twins.
        Coarse = "coarse",
        /// The simulators themselves.
        Full = "full",
    }
}

crate::table! {
    /// calibrated parameters and the responses that they are predicted to give
    pub struct Solved {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// of the optimiser
        pub seed: Option<Vec<i64>>, "";
        /// factors, calibrated and held, and responses
        pub point: Table, "";
        /// of the predicted responses
        pub misfit: Vec<f64>, "";
        /// of the model
        pub evaluations: Vec<usize>, "";
        /// evaluations on the coarse twins
        pub coarse: Option<Vec<usize>>, "";
        /// evaluations without responses
        pub failed: Vec<usize>, "";
        /// why the search ended
        pub stop: Vec<String>, "";
        /// whether all targets are expected to be met
        pub met: Vec<Answer>, "";
        /// number of directions that change no response
        pub free: Vec<f64>, "";
    }
}

crate::table! {
    /// calibrated parameters, and the values for which no response differs by more than its 95 % interval
    pub struct Parameters {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// the parameter
        pub factor: Vec<String>, "";
        /// of the numbers in this row
        pub unit: Vec<String>, "";
        /// of the solution
        pub value: Vec<f64>, "";
        /// least over all equally good solutions
        pub low: Vec<f64>, "";
        /// greatest
        pub high: Vec<f64>, "";
        /// lower end of its range
        pub range_low: Vec<f64>, "";
        /// upper end
        pub range_high: Vec<f64>, "";
        /// part of the range that is equally good
        pub part_percent: Vec<f64>, "";
        /// how far the targets determine it
        pub known: Vec<Determination>, "";
    }
}

crate::table! {
    /// evaluations: all simulations, or those that improved on a surface
    pub struct Evaluations {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// counted from 1
        pub evaluation: Vec<usize>, "";
        /// of the optimiser
        pub seed: Option<Vec<i64>>, "";
        /// the simulators
        pub level: Option<Vec<Level>>, "";
        /// of the stage, for `flow show`
        pub row: Option<Vec<usize>>, "";
        /// factors, calibrated and held, and responses
        pub point: Table, "";
        /// of this evaluation
        pub misfit: Vec<f64>, "";
        /// best misfit so far
        pub best: Vec<f64>, "";
        /// misfit expected at the recommended point after this evaluation
        pub recommended: Vec<f64>, "";
        /// why it gave no result; empty when it did
        pub failure: Vec<String>, "";
        /// checks that a run does not meet; empty when all are valid
        pub validity: Option<Vec<String>>, "";
    }
}

crate::table! {
    /// further parameters that give the responses of the solution
    pub struct Alternatives {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// factors
        pub point: Table, "";
    }
}

crate::table! {
    /// one row per run
    pub struct VerifiedRuns {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// counted from 1
        pub specimen: Vec<usize>, "";
        /// factors, responses, and the columns of [`super::results::Verdicts`]
        pub runs: Table, "";
    }
}

crate::table! {
    /// targets, expected responses, and the range of each response over the ranges of the factors
    pub struct Prediction {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// the response
        pub response: Vec<String>, "";
        /// of the numbers in this row
        pub unit: Vec<String>, "";
        /// the target; the lower end of a band
        pub target: Vec<f64>, "";
        /// lower end of a band
        pub at_least: Option<Vec<f64>>, "";
        /// upper end of a band
        pub at_most: Option<Vec<f64>>, "";
        /// at the solution
        pub expected: Vec<f64>, "";
        /// lower end of the 95 % interval of the mean; missing where only one run is known
        pub low: Vec<f64>, "";
        /// upper end
        pub high: Vec<f64>, "";
        /// as in the misfit
        pub deviation_percent: Vec<f64>, "";
        /// by the run at the solution, the best of many
        pub observed: Option<Vec<f64>>, "";
        /// standard deviation of a single run, from packing to packing
        pub scatter: Vec<f64>, "";
        /// least over the ranges
        pub reach_low: Vec<f64>, "";
        /// greatest over the ranges
        pub reach_high: Vec<f64>, "";
        /// whether the target can be reached by itself
        pub reach: Vec<String>, "";
        /// whether the expected value lies within the tolerance
        pub met: Vec<Answer>, "";
    }
}

/// First words of [`Prediction::reach`] for a target that cannot be reached.
pub const OUT_OF_REACH: &str = "out of reach";

impl Prediction {
    /// Whether the target in a row cannot be reached even by itself.
    pub fn out_of_reach(&self, row: usize) -> bool {
        self.reach[row].starts_with(OUT_OF_REACH)
    }

    /// The target band of each row; an open end is infinite.
    pub fn bands(&self) -> Vec<[f64; 2]> {
        let end = |ends: &Option<Vec<f64>>, row: usize, open: f64| match ends {
            Some(ends) if ends[row].is_nan() => open,
            Some(ends) => ends[row],
            None => self.target[row],
        };
        let band = |row| [end(&self.at_least, row, f64::NEG_INFINITY), end(&self.at_most, row, f64::INFINITY)];
        (0..self.target.len()).map(band).collect()
    }
}

crate::table! {
    /// evaluations until all responses were near their targets; missing where they never were
    pub struct Effort {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// of the optimiser
        pub seed: Option<Vec<i64>>, "";
        /// the method of the search
        pub method: Vec<String>, "";
        /// in all
        pub evaluations: Vec<usize>, "";
        /// before them, on coarse twins
        pub coarse: Vec<usize>, "";
        /// until a run showed it
        pub to: Percents, "";
        /// until the recommended point was expected to
        pub expected: Percents, "";
    }
}

/// Columns `NAME_10_percent`, `NAME_5_percent`, `NAME_2_percent`: evaluations until the greatest deviation was within
/// each of [`Percents::LEVELS`], NaN where it never was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Percents(pub [Vec<f64>; 3]);

impl Percents {
    /// The deviations in per cent.
    pub const LEVELS: [u32; 3] = [10, 5, 2];
}

impl Cells for Percents {
    fn put(&self, table: &mut Table, name: &str, unit: &str, about: &str) {
        for (level, values) in Self::LEVELS.iter().zip(&self.0) {
            values.put(table, &format!("{name}_{level}_percent"), unit, about);
        }
    }
    fn take(table: &Table, name: &str, unit: &str) -> Result<Self, Unread> {
        let [ten, five, two] = Self::LEVELS.map(|level| Cells::take(table, &format!("{name}_{level}_percent"), unit));
        Ok(Self([ten?, five?, two?]))
    }
}

crate::table! {
    /// calibrated sets on new specimens
    pub struct Summary {
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// the response
        pub response: Vec<String>, "";
        /// of the numbers in this row
        pub unit: Vec<String>, "";
        /// the target; the lower end of a band
        pub target: Vec<f64>, "";
        /// of the runs
        pub mean: Vec<f64>, "";
        /// standard deviation of a run
        pub std: Vec<f64>, "";
        /// standard deviation over mean
        pub cv_percent: Vec<f64>, "";
        /// difference between mean and target over target
        pub relative_error_percent: Vec<f64>, "";
        /// the same difference over the mean
        pub error_of_mean_percent: Vec<f64>, "";
        /// lower end of the 95 % interval of the mean
        pub low: Vec<f64>, "";
        /// upper end
        pub high: Vec<f64>, "";
        /// whether the interval holds the target
        pub target_inside: Vec<Answer>, "";
        /// runs with a value
        pub n: Vec<usize>, "";
    }
}
