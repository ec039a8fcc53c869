//! Strength over confining stress as it is stored.

use super::ArtifactKind;
use super::notes::NoteTable;
use super::validity::NotValid;

crate::artifact! {
    /// Strength over confining stress.
    pub struct Envelope = ArtifactKind::ENVELOPE {
        /// parameters of the criteria
        pub parameters: Parameters, "";
        /// tests and the values of the criteria there
        pub tests: Tests, "";
        /// the criteria as curves
        pub curves: Curves, "";
        /// runs that are not valid, and what became of them
        pub not_valid: Option<NotValid>, "";
        /// what a reader must know
        pub notes: Option<NoteTable>, "";
    }
}

crate::table! {
    /// parameters of the criteria
    pub struct Parameters {
        /// Mohr–Coulomb or Hoek–Brown
        pub criterion: Vec<String>, "";
        /// the parameter
        pub parameter: Vec<String>, "";
        /// in the unit beside it
        pub value: Vec<f64>, "";
        /// standard error
        pub std_error: Vec<f64>, "";
        /// unit of both
        pub unit: Vec<String>, "";
        /// coefficient of determination of the fit
        pub r2: Vec<f64>, "";
    }
}

crate::table! {
    /// tests and the values of the criteria there
    pub struct Tests {
        /// confining stress
        pub sigma_3: Vec<f64>, "MPa";
        /// stress at failure
        pub sigma_1: Vec<f64>, "MPa";
        /// of the line
        pub mohr_coulomb: Vec<f64>, "MPa";
        /// of the curve
        pub hoek_brown: Vec<f64>, "MPa";
    }
}

crate::table! {
    /// the criteria as curves
    pub struct Curves {
        /// confining stress
        pub sigma_3: Vec<f64>, "MPa";
        /// of the line
        pub mohr_coulomb: Vec<f64>, "MPa";
        /// of the curve
        pub hoek_brown: Vec<f64>, "MPa";
    }
}
