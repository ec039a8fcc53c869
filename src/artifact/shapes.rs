//! Shapes of stones as they are stored: solids, and the clumps that stand for them.

use super::ArtifactKind;

crate::artifact! {
    /// Stones and their clumps; every length as measured.
    pub struct Shapes = ArtifactKind::SHAPES {
        /// one row for each shape
        pub shapes: Stones, "";
        /// row of the shape that each pebble belongs to
        pub pebble_of: Vec<i64>, "";
        /// centres of the pebbles from the centre of mass of their clump, in its principal axes, the longest side first
        pub centres: Vec<[f64; 3]>, "m";
        /// radii of the pebbles
        pub radii: Vec<f64>, "m";
        /// row of the shape that each vertex belongs to
        pub vertex_of: Vec<i64>, "";
        /// vertices of the closed surfaces, in the frame of the pebbles
        pub vertices: Vec<[f64; 3]>, "m";
        /// three vertices for each facet, anticlockwise from outside
        pub facets: Vec<i64>, "";
        /// what should be known before a shape is used
        pub warnings: Vec<String>, "";
    }
}

crate::table! {
    /// stones and the clumps that stand for them
    pub struct Stones {
        /// name of the shape
        pub shape: Vec<String>, "";
        /// share of the stones, by number
        pub share: Vec<f64>, "";
        /// longest extent along the principal axes
        pub length: Vec<f64>, "m";
        /// intermediate extent, by which a stone passes a sieve
        pub breadth: Vec<f64>, "m";
        /// shortest extent
        pub thickness: Vec<f64>, "m";
        /// intermediate over longest extent
        pub elongation: Vec<f64>, "";
        /// shortest over intermediate extent
        pub flatness: Vec<f64>, "";
        /// surface of the ball of equal volume over that of the stone
        pub sphericity: Vec<f64>, "";
        /// share of the curvature that lies in edges sharper than 30 degrees
        pub angularity: Vec<f64>, "";
        /// share of the edges' length that is not concave
        pub convexity: Vec<f64>, "";
        /// class of Zingg
        pub zingg: Vec<String>, "";
        /// volume of the stone
        pub volume: Vec<f64>, "m^3";
        /// surface of the stone
        pub surface: Vec<f64>, "m^2";
        /// facets of its surface
        pub facets: Vec<usize>, "";
        /// pebbles of its clump
        pub pebbles: Vec<usize>, "";
        /// volume of the union of the pebbles
        pub clump_volume: Vec<f64>, "m^3";
        /// smallest principal moment of inertia of the union over the density
        pub inertia_1: Vec<f64>, "m^5";
        /// middle principal moment of inertia of the union over the density
        pub inertia_2: Vec<f64>, "m^5";
        /// largest principal moment of inertia of the union over the density
        pub inertia_3: Vec<f64>, "m^5";
        /// error of the volume
        pub volume_error: Vec<f64>, "";
        /// error of the surface
        pub surface_error: Vec<f64>, "";
        /// error of the principal moment of inertia that is worst
        pub inertia_error: Vec<f64>, "";
        /// distance of the centres over the radius of the ball of equal volume
        pub centre_error: Vec<f64>, "";
        /// mean distance of the surfaces over that radius
        pub distance: Vec<f64>, "";
        /// length by which the radii of inscribed balls grew
        pub growth: Vec<f64>, "m";
        /// what was mended on the surface as read
        pub mended: Vec<String>, "";
    }
}
