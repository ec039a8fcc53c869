//! A specimen as it is stored.

use super::{ArtifactKind, Table};
use ndarray::Array2;

crate::artifact! {
    /// A specimen: balls in a vessel, aggregate as polygons and rigid clumps, stress-free as it stands.
    pub struct Specimen = ArtifactKind::SPECIMEN {
        /// `rectangle` or `disc` in the plane; `box`, `cylinder` (axis along the load) or `thick-disc` (axis across) in the solid
        pub outline: String, "";
        /// extent across the axis of loading (diameter of a round outline)
        pub width: f64, "m";
        /// extent along the axis of loading (diameter of a disc)
        pub height: f64, "m";
        /// second extent across the axis of loading; 0 in the plane
        pub depth: f64, "m";
        /// density of the balls that are no pebbles
        pub density: f64, "kg/m^3";
        /// centres of the balls from the centre of the specimen: two coordinates in the plane, three in the solid
        pub centres: Array2<f64>, "m";
        /// radii of the balls
        pub radii: Vec<f64>, "m";
        /// group of each ball, by its number below
        pub group_of: Vec<i64>, "";
        /// names of the groups
        pub groups: Vec<String>, "";
        /// row of the table of clumps that each ball is a pebble of, -1 for none
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
        /// why it could not be made: there are no balls then; absent where there are
        pub failure: Option<String>, "";
    }
}
