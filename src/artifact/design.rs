//! A design of experiments as it is stored.

use super::field::table_of;
use super::{Artifact, ArtifactKind, Table, Wanted};

crate::artifact! {
    /// A design of experiments.
    pub struct Design = ArtifactKind::DESIGN {
        /// the runs: [`DesignRows`] with the factors in their units
        pub design: Table, "";
        /// the factors in coded units
        pub coded: Table, "";
        /// what the design can tell
        pub report: DesignReport, "";
        /// rows that were left out, with the rules that they break
        pub left_out: Option<Table>, "";
    }
}

crate::table! {
    /// the runs of a design
    pub struct DesignRows {
        /// order of the runs
        pub run: Vec<i64>, "";
        /// place in the order of the construction
        pub standard_order: Vec<i64>, "";
        /// which of the equal rows it is
        pub replicate: Vec<i64>, "";
        /// centre, cube, axial, edge, grid, sample or given
        pub point_type: Vec<String>, "";
    }
}

crate::table! {
    /// what the design can tell, judged by its rows
    pub struct DesignReport {
        /// what it is about
        pub section: Vec<String>, "";
        /// factor, term or model
        pub subject: Vec<String>, "";
        /// what is told
        pub quantity: Vec<String>, "";
        /// missing where words say it
        pub value: Vec<f64>, "";
        /// in words
        pub text: Vec<String>, "";
    }
}

impl Design {
    /// The runs of an artifact, without a copy.
    ///
    /// # Errors
    /// The artifact holds no design.
    pub fn table(artifact: &Artifact) -> Result<&Table, Wanted> {
        table_of(artifact, "design")
    }
}
