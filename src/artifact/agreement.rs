//! Computed results beside values from elsewhere, as they are stored.

use super::ArtifactKind;
use super::notes::NoteTable;
use super::validity::NotValid;

crate::artifact! {
    /// Computed results beside values from elsewhere.
    pub struct Agreement = ArtifactKind::AGREEMENT {
        /// the ratio computed/reference
        pub summary: Ratios, "";
        /// what the ratio depends on
        pub trends: Trends, "";
        /// every pair
        pub pairs: Pairs, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
        /// rows and pairs that the comparison is not of
        pub notes: Option<NoteTable>, "";
    }
}

crate::table! {
    /// the ratio computed/reference
    pub struct Ratios {
        /// the response
        pub response: Vec<String>, "";
        /// `all`: all tables together
        pub table: Vec<String>, "";
        /// pairs
        pub n: Vec<i64>, "";
        /// median
        pub median: Vec<f64>, "";
        /// first quartile
        pub lower: Vec<f64>, "";
        /// third quartile
        pub upper: Vec<f64>, "";
        /// least
        pub least: Vec<f64>, "";
        /// greatest
        pub greatest: Vec<f64>, "";
        /// mean
        pub mean: Vec<f64>, "";
        /// standard deviation
        pub std: Vec<f64>, "";
        /// rank correlation of the values
        pub spearman: Vec<f64>, "";
    }
}

crate::table! {
    /// what the ratio depends on: regression of 100 ln ratio
    pub struct Trends {
        /// the response
        pub response: Vec<String>, "";
        /// the stage with the computed values
        pub table: Vec<String>, "";
        /// the factor
        pub factor: Vec<String>, "";
        /// change of the ratio over the factor's span
        pub effect: Vec<f64>, "%";
        /// standard error
        pub std_error: Vec<f64>, "%";
        /// effect over standard error
        pub t: Vec<f64>, "";
        /// probability of such a t by chance
        pub p: Vec<f64>, "";
    }
}

crate::table! {
    /// every pair, in the units of the responses
    pub struct Pairs {
        /// the response
        pub response: Vec<String>, "";
        /// the stage with the computed values
        pub table: Vec<String>, "";
        /// of the reference
        pub row: Vec<i64>, "";
        /// the computed value
        pub computed: Vec<f64>, "";
        /// the value to compare with
        pub reference: Vec<f64>, "";
        /// computed over reference
        pub ratio: Vec<f64>, "";
    }
}
