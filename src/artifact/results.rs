//! Runs or measurements as they are stored: what simulators, external programs, formulas and data files give alike.

use super::field::table_of;
use super::notes::NoteTable;
use super::{Artifact, ArtifactKind, Table, Values, Wanted};

crate::artifact! {
    /// Runs or measurements. Besides factors (in their units) and responses (in the units of `[response.NAME]`) the
    /// table of a simulator has the columns of [`Verdicts`].
    pub struct Results = ArtifactKind::RESULTS {
        /// one row per run
        pub runs: Table, "";
        /// how a file was read, where that was detected and is not the plain way
        pub notes: Option<NoteTable>, "";
    }
}

/// The columns with the reasons.
pub(super) const FAILURE: &str = "failure";
pub(super) const VALIDITY: &str = "validity";
pub(super) const CAUTIONS: &str = "cautions";

/// Failure, validity and cautions of each run of a simulator; empty texts where all is well.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdicts {
    /// Why it gave no result.
    pub failures: Vec<String>,
    /// The checks that make it invalid, and those that make it one to look at; none where no run was checked.
    pub checked: Option<(Vec<String>, Vec<String>)>,
}

impl Results {
    /// The runs of a simulator: `runs` without the columns on their validity.
    pub fn of(runs: Table, verdicts: Verdicts) -> Self {
        let runs = runs.texts_column(FAILURE, "why the run gave no result; empty when it did", verdicts.failures);
        let Some((validity, cautions)) = verdicts.checked else { return Self::from(runs) };
        let runs = runs.texts_column(VALIDITY, "checks that the run does not meet; empty when it is valid", validity);
        Self::from(runs.texts_column(CAUTIONS, "checks that say to look at the run", cautions))
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
        texts(runs, FAILURE)
    }

    /// Why each run is to be looked at; none where runs are not checked.
    pub fn cautions(runs: &Table) -> &[String] {
        texts(runs, CAUTIONS)
    }

    /// The runs that gave a result and are not valid: their rows, from 0, and why.
    pub fn invalid(runs: &Table) -> Vec<(usize, &str)> {
        let failures = Self::failures(runs);
        let worked = |row: usize| failures.get(row).is_none_or(String::is_empty);
        let reasons = texts(runs, VALIDITY).iter().map(|why| why.trim()).enumerate();
        reasons.filter(|(row, why)| !why.is_empty() && worked(*row)).collect()
    }
}

/// A column of texts; none where the table has no such column.
fn texts<'a>(runs: &'a Table, name: &str) -> &'a [String] {
    match runs.column(name).map(|column| &column.values) {
        Some(Values::Texts(texts)) => texts,
        Some(Values::Reals(_) | Values::Ints(_)) | None => &[],
    }
}

/// Rows without notes.
impl From<Table> for Results {
    fn from(runs: Table) -> Self {
        Self { runs, notes: None }
    }
}
