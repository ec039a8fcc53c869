//! A closed surface of triangles.

use super::vector::{cross, dot, extent, minus, norm, times};
use std::collections::BTreeMap;

/// A closed surface of triangles whose corners run anticlockwise as seen from outside. [`super::loft::loft`] and
/// [`super::mend::mend`] make it; in both, every edge belongs to two triangles that run along it in opposite directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) facets: Vec<[u32; 3]>,
}

/// An edge with the two facets at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Its length.
    pub length: f64,
    /// Angle by which the outward normal turns across it (rad), positive where the surface is convex.
    pub turn: f64,
}

impl Mesh {
    /// A surface from stored vertices and triangles; `None` where a triangle names a vertex that does not exist.
    pub fn of(vertices: Vec<[f64; 3]>, facets: Vec<[u32; 3]>) -> Option<Self> {
        let there = facets.iter().flatten().all(|&v| (v as usize) < vertices.len());
        there.then_some(Self { vertices, facets })
    }

    /// The corners of the triangles.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// The triangles as indices of [`Self::vertices`].
    pub fn facets(&self) -> &[[u32; 3]] {
        &self.facets
    }

    /// Corners of one triangle.
    pub fn corners(&self, facet: usize) -> [[f64; 3]; 3] {
        self.facets[facet].map(|v| self.vertices[v as usize])
    }

    /// Corners of all triangles in order.
    pub fn triangles(&self) -> impl Iterator<Item = [[f64; 3]; 3]> + '_ {
        (0..self.facets.len()).map(|facet| self.corners(facet))
    }

    /// Area of the surface.
    pub fn surface(&self) -> f64 {
        self.triangles().map(|t| 0.5 * norm(area_vector(t))).sum()
    }

    /// Corners of the box along the axes that holds it.
    pub fn extent(&self) -> ([f64; 3], [f64; 3]) {
        extent(self.vertices.iter().copied())
    }

    /// The surface with every vertex moved by a function that preserves handedness.
    #[must_use]
    pub fn mapped(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self { vertices: self.vertices.iter().map(|&v| map(v)).collect(), facets: self.facets.clone() }
    }

    /// Every edge once, in the order of its vertices.
    pub fn edges(&self) -> Vec<Edge> {
        let mut facets_of: BTreeMap<[u32; 2], [usize; 2]> = BTreeMap::new();
        for (index, facet) in self.facets.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (facet[k], facet[(k + 1) % 3]);
                let pair = facets_of.entry([a.min(b), a.max(b)]).or_insert([usize::MAX; 2]);
                pair[usize::from(a > b)] = index;
            }
        }
        let edge = |(&[a, b], &[left, right]): (&[u32; 2], &[usize; 2])| {
            if left == usize::MAX || right == usize::MAX {
                return None;
            }
            let [n, m] = [left, right].map(|facet| {
                let vector = area_vector(self.corners(facet));
                times(vector, 1.0 / norm(vector))
            });
            let along = minus(self.vertices[b as usize], self.vertices[a as usize]);
            let length = norm(along);
            let sine = dot(cross(n, m), along) / length;
            Some(Edge { length, turn: math::elementary::atan2(sine, dot(n, m)) })
        };
        facets_of.iter().filter_map(edge).collect()
    }
}

/// Twice the area of a triangle along its normal.
pub(crate) fn area_vector([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    cross(minus(b, a), minus(c, a))
}

#[cfg(test)]
pub(crate) mod samples {
    use super::Mesh;
    use math::elementary::sin_cos;
    use std::f64::consts::PI;

    /// A box between the origin and a corner.
    pub(crate) fn cuboid(size: [f64; 3]) -> Mesh {
        let vertices = (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 1 { size[b] } else { 0.0 })).collect();
        let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { vertices, facets }
    }

    /// An ellipsoid about the origin, of `rows` times 2 `rows` facets between poles.
    pub(crate) fn ellipsoid(half: [f64; 3], rows: usize) -> Mesh {
        let columns = 2 * rows;
        let mut vertices = vec![[0.0, 0.0, -half[2]]];
        for row in 1..rows {
            let (sine, cosine) = sin_cos(PI * row as f64 / rows as f64);
            for column in 0..columns {
                let (s, c) = sin_cos(2.0 * PI * column as f64 / columns as f64);
                vertices.push([half[0] * sine * c, half[1] * sine * s, -half[2] * cosine]);
            }
        }
        vertices.push([0.0, 0.0, half[2]]);
        let at = |row: usize, column: usize| (1 + (row - 1) * columns + column % columns) as u32;
        let last = (vertices.len() - 1) as u32;
        let mut facets = Vec::new();
        for column in 0..columns {
            facets.push([0, at(1, column + 1), at(1, column)]);
            for row in 1..rows - 1 {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
                facets.extend([[a, b, c], [a, c, d]]);
            }
            facets.push([at(rows - 1, column), at(rows - 1, column + 1), last]);
        }
        Mesh { vertices, facets }
    }
}

#[cfg(test)]
mod tests {
    use super::samples::cuboid;
    use std::f64::consts::PI;

    /// A convex body turns its normal outwards at every edge; a box has twelve right angles and flat diagonals.
    #[test]
    fn the_edges_of_a_box_turn_by_right_angles() {
        let mesh = cuboid([1.0, 2.0, 3.0]);
        let edges = mesh.edges();
        let sharp: Vec<_> = edges.iter().filter(|edge| edge.turn.abs() > 1e-12).collect();
        assert_eq!((edges.len(), sharp.len()), (18, 12));
        assert!(sharp.iter().all(|edge| (edge.turn - PI / 2.0).abs() < 1e-12));
        assert!((sharp.iter().map(|edge| edge.length).sum::<f64>() - 24.0).abs() < 1e-12);
        assert!((mesh.surface() - 22.0).abs() < 1e-12);
    }
}
