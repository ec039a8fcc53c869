//! Runs or measurements as they are stored: what simulators, external programs, formulas and data files give alike.

use super::{Artifact, ArtifactKind, Node, Table, Values, Wanted};

crate::artifact! {
    /// Runs or measurements. Besides factors (in their units) and responses (in the units of `[response.NAME]`) the
    /// table of a simulator has the column of [`Results::failures`].
    pub struct Results = ArtifactKind::RESULTS {
        /// one row per run
        pub runs: Table, "";
    }
}

/// The column with the reasons of failures.
const FAILURE: &str = "failure";

impl Results {
    /// The runs of a simulator: `runs` without the reasons, which are empty where all went well.
    pub fn of(runs: Table, failures: Vec<String>) -> Self {
        Self { runs: runs.texts_column(FAILURE, "why the run gave no result; empty when it did", failures) }
    }

    /// The table of an artifact, without a copy.
    ///
    /// # Errors
    /// The artifact holds no runs.
    pub fn table(artifact: &Artifact) -> Result<&Table, Wanted> {
        match artifact.root.get("runs") {
            Some(Node::Table(table)) => Ok(table),
            Some(other) => Err(Wanted::new("runs", "a table", other.type_name())),
            None => Err(Wanted::new("runs", "a table", "nothing")),
        }
    }

    /// Why each run gave no result, empty when it did; none where runs cannot fail.
    pub fn failures(runs: &Table) -> &[String] {
        match runs.column(FAILURE).map(|column| &column.values) {
            Some(Values::Texts(reasons)) => reasons,
            Some(Values::Reals(_) | Values::Ints(_)) | None => &[],
        }
    }
}
