//! Results of the statistics as they are stored. A column that mixes responses has no unit: each row is in that of its
//! response, which stands in `[response.NAME]`.

use super::validity::NotValid;
use super::{ArtifactKind, Cells, Table, Unread};
use math::scale::Scale;
use ndarray::Array2;
use std::collections::BTreeMap;

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

crate::artifact! {
    /// Fitted models.
    pub struct Surfaces = ArtifactKind::SURFACES {
        /// coefficients in natural units
        pub coefficients: Coefficients, "";
        /// coefficients in coded units
        pub coded: Coefficients, "";
        /// quality of the models
        pub fit: Fits, "";
        /// every row seen by every model
        pub residuals: Residuals, "";
        /// stationary points
        pub stationary: Stationary, "";
        /// principal axes
        pub axes: PrincipalAxes, "";
        /// steepest ways from the centre
        pub path: Paths, "";
        /// where the models hold
        pub domain: Domains, "";
        /// steps of the selection of terms
        pub selection: Selections, "";
        /// what should be looked at before the numbers are trusted
        pub notes: NoteTable, "";
        /// what prediction needs of each model
        pub models: BTreeMap<String, FittedModel>, "";
        /// the same terms with a constant, for fits through the origin
        pub with_constant: Option<WithConstant>, "";
        /// predictions at the points that were asked for
        pub predictions: Option<Predictions>, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
    }
}

crate::group! {
    /// What prediction needs of the model of one response.
    pub struct FittedModel {
        /// coding and domain of the factors
        pub factors: CodedFactors, "";
        /// terms of the coded model
        pub terms: CodedTerms, "";
        /// inverse triangle: its rows span the covariance
        pub root: Array2<f64>, "";
        /// residual standard deviation; NaN when there is none
        pub s: f64, "";
        /// residual degrees of freedom
        pub df_residual: i64, "";
        /// greatest leverage of the runs
        pub greatest_leverage: f64, "";
    }
}

crate::table! {
    /// coding and domain of the factors
    pub struct CodedFactors {
        /// the factor
        pub factor: Vec<String>, "";
        /// value at coded 0; on a logarithmic scale its logarithm
        pub centre: Vec<f64>, "";
        /// length of a coded unit; on a logarithmic scale that of the logarithm
        pub half: Vec<f64>, "";
        /// least value fitted
        pub low: Vec<f64>, "";
        /// greatest value fitted
        pub high: Vec<f64>, "";
        /// how the model takes each, where it takes some by their logarithms
        pub scale: Option<Vec<Scale>>, "";
    }
}

crate::table! {
    /// terms of the coded model
    pub struct CodedTerms {
        /// the term
        pub term: Vec<String>, "";
        /// of the coded term
        pub coefficient: Vec<f64>, "";
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
    /// what to look at before trusting the numbers
    pub struct NoteTable {
        /// the response it is about
        pub response: Vec<String>, "";
        /// the remark
        pub note: Vec<String>, "";
    }
}

crate::table! {
    /// coefficients of the fitted models
    pub struct Coefficients {
        /// the response
        pub response: Vec<String>, "";
        /// the term
        pub term: Vec<String>, "";
        /// unit of the response per unit of the term
        pub estimate: Vec<f64>, "";
        /// standard error
        pub std_error: Vec<f64>, "";
        /// estimate over standard error
        pub t: Vec<f64>, "";
        /// probability of such a t by chance
        pub p: Vec<f64>, "";
        /// variance inflation factor
        pub vif: Vec<f64>, "";
        /// printed values beside the computed ones
        pub published: Option<Published>, "";
        /// how the two compare, and what is odd
        pub remark: Option<Vec<String>>, "";
    }
}

crate::table! {
    /// the same terms with a constant: whether the data point to the origin
    pub struct WithConstant {
        /// the response
        pub response: Vec<String>, "";
        /// the term
        pub term: Vec<String>, "";
        /// unit of the response per unit of the term
        pub estimate: Vec<f64>, "";
        /// standard error
        pub std_error: Vec<f64>, "";
        /// estimate over standard error
        pub t: Vec<f64>, "";
        /// probability of such a t by chance
        pub p: Vec<f64>, "";
        /// about the mean
        pub r2: Vec<f64>, "";
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
    /// stationary points of the second-order surfaces
    pub struct Stationary {
        /// the response
        pub response: Vec<String>, "";
        /// maximum, minimum or saddle
        pub nature: Vec<String>, "";
        /// the surface there
        pub value: Vec<f64>, "";
        /// whether it lies among the runs
        pub domain: Vec<String>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// in the factor's unit
        pub natural: Vec<f64>, "";
        /// in coded units
        pub coded: Vec<f64>, "";
    }
}

crate::table! {
    /// principal axes of the second-order surfaces, in coded units
    pub struct PrincipalAxes {
        /// the response
        pub response: Vec<String>, "";
        /// by falling eigenvalue
        pub axis: Vec<i64>, "";
        /// curvature along the axis
        pub eigenvalue: Vec<f64>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// component along the factor
        pub direction: Vec<f64>, "";
    }
}

crate::table! {
    /// domain of the models; predictions outside it are extrapolation
    pub struct Domains {
        /// the response
        pub response: Vec<String>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// unit of the factor
        pub unit: Vec<String>, "";
        /// least value fitted
        pub low: Vec<f64>, "";
        /// greatest value fitted
        pub high: Vec<f64>, "";
        /// how the model takes each, where it takes some by their logarithms
        pub scale: Option<Vec<Scale>>, "";
    }
}

crate::table! {
    /// terms that selection added or removed, in order
    pub struct Selections {
        /// the response
        pub response: Vec<String>, "";
        /// the term
        pub term: Vec<String>, "";
        /// added or removed
        pub step: Vec<String>, "";
        /// in the model that held it
        pub p: Vec<f64>, "";
    }
}

crate::table! {
    /// predictions with intervals; extrapolation is flagged
    pub struct Predictions {
        /// the response
        pub response: Vec<String>, "";
        /// counted from 1
        pub point: Vec<i64>, "";
        /// of the model
        pub value: Vec<f64>, "";
        /// of the mean response
        pub std_error: Vec<f64>, "";
        /// of the mean response
        pub confidence_low: Vec<f64>, "";
        /// of the mean response
        pub confidence_high: Vec<f64>, "";
        /// of one new run
        pub prediction_low: Vec<f64>, "";
        /// of one new run
        pub prediction_high: Vec<f64>, "";
        /// of the point
        pub leverage: Vec<f64>, "";
        /// the factors whose domain the point leaves
        pub extrapolation: Vec<String>, "";
    }
}

crate::table! {
    /// best points on spheres about the centre, in coded units
    pub struct Paths {
        /// the response
        pub response: Vec<String>, "";
        /// up or down
        pub way: Vec<String>, "";
        /// in coded units
        pub radius: Vec<f64>, "";
        /// the surface there
        pub value: Vec<f64>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// in the factor's unit
        pub natural: Vec<f64>, "";
        /// in coded units
        pub coded: Vec<f64>, "";
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
