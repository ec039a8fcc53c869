//! Fitted models as they are stored.

use super::ArtifactKind;
use super::notes::NoteTable;
use super::statistics::{Fits, Published, Residuals};
use super::validity::NotValid;
use math::scale::Scale;
use ndarray::Array2;
use std::collections::BTreeMap;

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
