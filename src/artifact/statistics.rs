//! Results of the statistics as they are stored. A column that mixes responses has no unit: each row is in that of its
//! response, which stands in `[response.NAME]`.

use super::notes::NoteTable;
use super::validity::NotValid;
use super::{ArtifactKind, Cells, Table, Unread};

crate::artifact! {
    /// An analysis of variance.
    pub struct Anova = ArtifactKind::ANOVA {
        /// the lines of the analysis
        pub anova: Variances, "";
        /// quality of the models
        pub fit: Fits, "";
        /// what should be looked at before the numbers are trusted
        pub notes: NoteTable, "";
        /// every row seen by every model
        pub residuals: Residuals, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

crate::artifact! {
    /// Effects of a two-level design.
    pub struct Screening = ArtifactKind::SCREENING {
        /// the effects
        pub effects: Effects, "";
        /// Lenth's limits and the critical value of t
        pub limits: Limits, "";
        /// quality of the models
        pub fit: Fits, "";
        /// what should be looked at before the numbers are trusted
        pub notes: NoteTable, "";
        /// every row seen by every model
        pub residuals: Residuals, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

/// Printed values beside computed ones: the columns `published` and `deviation`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Published {
    /// As printed.
    pub published: Vec<f64>,
    /// Computed minus published.
    pub deviation: Vec<f64>,
}

impl Cells for Published {
    fn put(&self, table: &mut Table, _name: &str, unit: &str, _about: &str) {
        self.published.put(table, "published", unit, "as printed");
        self.deviation.put(table, "deviation", unit, "computed minus published");
    }
    fn take(table: &Table, _name: &str, unit: &str) -> Result<Self, Unread> {
        Ok(Self {
            published: Cells::take(table, "published", unit)?,
            deviation: Cells::take(table, "deviation", unit)?,
        })
    }
}

crate::table! {
    /// quality of the fits
    pub struct Fits {
        /// the response
        pub response: Vec<String>, "";
        /// runs used
        pub n: Vec<i64>, "";
        /// runs without a value, or left out
        pub missing: Vec<i64>, "";
        /// residual degrees of freedom
        pub df_residual: Vec<i64>, "";
        /// residual standard deviation, unit of the response
        pub s: Vec<f64>, "";
        /// coefficient of determination
        pub r2: Vec<f64>, "";
        /// adjusted for degrees of freedom
        pub r2_adjusted: Vec<f64>, "";
        /// 1 - PRESS/SST
        pub r2_predicted: Vec<f64>, "";
        /// sum of squared leave-one-out residuals
        pub press: Vec<f64>, "";
        /// F of the whole model
        pub f: Vec<f64>, "";
        /// probability of such an F by chance
        pub p: Vec<f64>, "";
        /// degrees of freedom of replicates
        pub df_pure_error: Vec<i64>, "";
        /// lack of fit against pure error
        pub lack_of_fit_f: Vec<f64>, "";
        /// probability of such an F by chance
        pub lack_of_fit_p: Vec<f64>, "";
        /// what r2 is a share of
        pub model: Option<Vec<String>>, "";
        /// 1 - SSE over squares about the mean
        pub r2_about_mean: Option<Vec<f64>>, "";
        /// terms pooled into the error
        pub pooled: Option<Vec<String>>, "";
        /// interactions that the runs cannot tell apart
        pub not_estimable: Option<Vec<String>>, "";
        /// printed values beside the computed ones
        pub published: Option<Published>, "";
        /// how the two compare, and what is odd
        pub remark: Option<Vec<String>>, "";
    }
}

crate::table! {
    /// residuals; outliers are flagged, not dropped
    pub struct Residuals {
        /// the response
        pub response: Vec<String>, "";
        /// counted from 1
        pub row: Vec<i64>, "";
        /// as measured
        pub observed: Vec<f64>, "";
        /// as the model says
        pub fitted: Vec<f64>, "";
        /// observed minus fitted
        pub residual: Vec<f64>, "";
        /// diagonal of the hat matrix
        pub leverage: Vec<f64>, "";
        /// internally studentized residual
        pub standardized: Vec<f64>, "";
        /// externally studentized residual
        pub studentized: Vec<f64>, "";
        /// Cook's distance
        pub cook: Vec<f64>, "";
        /// what is suspicious
        pub flag: Vec<String>, "";
    }
}

crate::table! {
    /// effects: mean at the high level minus mean at the low one
    pub struct Effects {
        /// the response
        pub response: Vec<String>, "";
        /// the term
        pub term: Vec<String>, "";
        /// in the unit of the response
        pub effect: Vec<f64>, "";
        /// where the design leaves degrees of freedom
        pub std_error: Vec<f64>, "";
        /// effect over its standard error
        pub standardized: Vec<f64>, "";
        /// with that standard error
        pub p: Vec<f64>, "";
        /// effect over the pseudo standard error
        pub lenth_t: Vec<f64>, "";
        /// 1 is the largest in size
        pub rank: Vec<i64>, "";
        /// of the sum of squared effects
        pub share: Vec<f64>, "";
        /// share of this and all larger effects
        pub cumulative: Vec<f64>, "";
        /// abscissa of the normal plot
        pub normal: Vec<f64>, "";
        /// abscissa of the half-normal plot
        pub half_normal: Vec<f64>, "";
        /// against Lenth's margins
        pub verdict: Vec<String>, "";
        /// against the critical value of the standardised effect
        pub significance: Vec<String>, "";
    }
}

crate::table! {
    /// Lenth's limits, and the critical value of t where there is an error to test against
    pub struct Limits {
        /// the response
        pub response: Vec<String>, "";
        /// pseudo standard error
        pub pse: Vec<f64>, "";
        /// margin of error
        pub margin: Vec<f64>, "";
        /// simultaneous margin of error
        pub simultaneous: Vec<f64>, "";
        /// critical value of the standardised effects
        pub critical: Vec<f64>, "";
    }
}

crate::table! {
    /// analysis of variance
    pub struct Variances {
        /// the response
        pub response: Vec<String>, "";
        /// factor, interaction, residual or total
        pub source: Vec<String>, "";
        /// degrees of freedom
        pub df: Vec<i64>, "";
        /// sum of squares, squared unit of the response
        pub ss: Vec<f64>, "";
        /// mean square
        pub ms: Vec<f64>, "";
        /// ratio to the mean square of the error
        pub f: Vec<f64>, "";
        /// probability of such an F by chance
        pub p: Vec<f64>, "";
        /// by the levels of the field
        pub significance: Vec<String>, "";
        /// share of the total sum of squares
        pub eta2: Vec<f64>, "";
        /// the same without what chance alone gives
        pub omega2: Vec<f64>, "";
        /// standard deviation of F when the responses are rounded
        pub f_rounding: Option<Vec<f64>>, "";
        /// printed values beside the computed ones
        pub published: Option<Published>, "";
        /// how the two compare, and what is odd
        pub remark: Option<Vec<String>>, "";
    }
}
