//! A specimen as it is stored.

use super::{Array, ArtifactKind, Field, Node, Table, Values};

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
        /// centres of the balls from the centre of the specimen
        pub centres: Points, "m";
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
    }
}

/// Points of the plane or of the solid: an array of shape (n, 2) or (n, 3).
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// 2 or 3.
    pub dimension: usize,
    /// Coordinates, point by point.
    pub coordinates: Vec<f64>,
}

impl Field for Points {
    fn to_node(&self, unit: &str, about: &str) -> Node {
        Node::Array(Array {
            shape: vec![self.coordinates.len() / self.dimension, self.dimension],
            unit: unit.to_owned(),
            about: about.to_owned(),
            values: Values::Reals(self.coordinates.clone()),
        })
    }

    fn from_node(node: &Node) -> Result<Self, &'static str> {
        match node {
            Node::Array(Array { values: Values::Reals(values), shape, .. }) if matches!(shape[..], [n, 2 | 3] if n * shape[1] == values.len()) => {
                Ok(Self { dimension: shape[1], coordinates: values.clone() })
            }
            _ => Err("points of the plane or the solid"),
        }
    }
}
