//! Fits by groups of rows as they are stored.

use super::field::table_of;
use super::notes::NoteTable;
use super::validity::NotValid;
use super::{Artifact, ArtifactKind, Field, Table, Wanted};

crate::artifact! {
    /// One fit for each group of rows. The tables `groups` and `residuals` have, after the column of the response, the
    /// columns that the groups were made by.
    pub struct Groups = ArtifactKind::GROUPS {
        /// coefficients: [`GroupFits`] with the columns of the groups
        pub groups: Table, "";
        /// residuals: [`GroupResiduals`] with the columns of the groups
        pub residuals: Table, "";
        /// what should be looked at before the numbers are trusted
        pub notes: NoteTable, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

impl Groups {
    /// The coefficients of an artifact, without a copy.
    ///
    /// # Errors
    /// The artifact holds no fits by groups.
    pub fn table(artifact: &Artifact) -> Result<&Table, Wanted> {
        table_of(artifact, "groups")
    }

    /// The residuals of an artifact, without the columns that the groups were made by.
    ///
    /// # Errors
    /// The artifact holds no residuals of fits by groups.
    pub fn residuals(artifact: &Artifact) -> Result<GroupResiduals, Wanted> {
        Field::take(&artifact.root, "residuals", "")
    }
}

crate::table! {
    /// coefficients of one fit per group
    pub struct GroupFits {
        /// the response
        pub response: Vec<String>, "";
        /// the term
        pub term: Vec<String>, "";
        /// unit of the response per unit of the term
        pub estimate: Vec<f64>, "";
        /// standard error
        pub std_error: Vec<f64>, "";
        /// lower end of its confidence interval
        pub low: Vec<f64>, "";
        /// upper end of its confidence interval
        pub high: Vec<f64>, "";
        /// estimate over standard error
        pub t: Vec<f64>, "";
        /// probability of such a t by chance
        pub p: Vec<f64>, "";
        /// runs used
        pub n: Vec<i64>, "";
        /// runs without a value, or left out
        pub missing: Vec<i64>, "";
        /// residual standard deviation
        pub s: Vec<f64>, "";
        /// share of the squares about the mean; through the origin, about zero
        pub r2: Vec<f64>, "";
        /// through the origin: 1 - SSE over squares about the mean
        pub r2_about_mean: Option<Vec<f64>>, "";
        /// of the same terms with a constant
        pub constant: Option<Vec<f64>>, "";
        /// its standard error
        pub constant_std_error: Option<Vec<f64>>, "";
        /// this estimate with a constant
        pub beside_constant: Option<Vec<f64>>, "";
        /// about the mean
        pub r2_with_constant: Option<Vec<f64>>, "";
        /// why the group has no fit
        pub failure: Vec<String>, "";
    }
}

crate::table! {
    /// residuals; outliers are flagged, not dropped
    pub struct GroupResiduals {
        /// the response
        pub response: Vec<String>, "";
        /// in the table of runs, counted from 1
        pub row: Vec<i64>, "";
        /// as measured
        pub observed: Vec<f64>, "";
        /// as the model says
        pub fitted: Vec<f64>, "";
        /// observed minus fitted
        pub residual: Vec<f64>, "";
        /// diagonal of the hat matrix
        pub leverage: Vec<f64>, "";
        /// externally studentized residual
        pub studentized: Vec<f64>, "";
        /// what is suspicious
        pub flag: Vec<String>, "";
    }
}
