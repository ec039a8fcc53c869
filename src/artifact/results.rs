//! Runs or measurements as they are stored: what simulators, external programs, formulas and data files give alike.

use super::field::table_of;
use super::statistics::Remarks;
use super::{Artifact, ArtifactKind, Table, Values, Wanted};

crate::artifact! {
    /// Runs or measurements. Besides factors (in their units) and responses (in the units of `[response.NAME]`) the
    /// table of a simulator has the column of [`Results::failures`].
    pub struct Results = ArtifactKind::RESULTS {
        /// one row per run
        pub runs: Table, "";
        /// how a file was read, where that was detected and is not the plain way
        pub notes: Option<Remarks>, "";
    }
}

/// The column with the reasons of failures.
const FAILURE: &str = "failure";

impl Results {
    /// The runs of a simulator: `runs` without the reasons, which are empty where all went well.
    pub fn of(runs: Table, failures: Vec<String>) -> Self {
        Self::from(runs.texts_column(FAILURE, "why the run gave no result; empty when it did", failures))
    }

    /// The table of an artifact, without a copy.
    ///
    /// # Errors
    /// The artifact holds no runs.
    pub fn table(artifact: &Artifact) -> Result<&Table, Wanted> {
        table_of(artifact, "runs")
    }

    /// Why each run gave no result, empty when it did; none where runs cannot fail.
    pub fn failures(runs: &Table) -> &[String] {
        match runs.column(FAILURE).map(|column| &column.values) {
            Some(Values::Texts(reasons)) => reasons,
            Some(Values::Reals(_) | Values::Ints(_)) | None => &[],
        }
    }
}

/// Rows without notes.
impl From<Table> for Results {
    fn from(runs: Table) -> Self {
        Self { runs, notes: None }
    }
}
