//! A plane specimen as it is stored.

use super::{ArtifactKind, Table};

crate::artifact! {
    /// A specimen: discs in a vessel, aggregate as polygons and rigid clumps, stress-free as it stands.
    pub struct Specimen = ArtifactKind::SPECIMEN {
        /// `rectangle` or `disc`
        pub outline: String, "";
        /// extent across the axis of loading (diameter of a disc)
        pub width: f64, "m";
        /// extent along the axis of loading (diameter of a disc)
        pub height: f64, "m";
        /// density of the mortar
        pub density: f64, "kg/m^3";
        /// centres of the discs from the centre of the specimen
        pub centres: Vec<[f64; 2]>, "m";
        /// radii of the discs
        pub radii: Vec<f64>, "m";
        /// row of the table of clumps that each disc is a pebble of, -1 for mortar
        pub clump_of: Vec<i64>, "";
        /// rigid clumps: polygon, mass and moment of inertia per metre, centre of mass
        pub clumps: Table, "";
        /// polygon of each vertex below
        pub polygon_of: Vec<i64>, "";
        /// vertices of the polygons of aggregate, anticlockwise
        pub vertices: Vec<[f64; 2]>, "m";
        /// numbers by which the specimen is judged
        pub quality: Table, "";
        /// what should be known before its results are believed
        pub warnings: Vec<String>, "";
    }
}
