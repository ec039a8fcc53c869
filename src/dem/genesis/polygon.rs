//! Convex polygons as the outline of aggregate.
//!
//! Points are put on a circle and joined in order, so the polygon is convex for all points:
//!
//! ```text
//! N   = round(N_min + u (N_max − N_min)),  u uniform in [0, 1)                             Su et al. 2021 eq. (7)
//! x_k = R cos θ_k,  y_k = R sin θ_k                                                                        eq. (8)
//! ```
//!
//! The rounding makes the two ends of the range half as likely as each number between them. The paper leaves the law
//! of the angles and the meaning of R open; both are settings:
//! * [`AngleLaw`]: angles fully random; even ones, each moved by a share of the even step; or even ones. The whole
//!   polygon is turned at random in every case.
//! * [`SizeRule`]: the polygon lies *in* the circle of its size (its area is then a fraction of the circle's, 0.42 on
//!   average for 4–6 fully random points), or it is enlarged until its area *equals* that of the circle.
//!
//! Fully random points sometimes fall close together and give slivers; draws that fill less than `least_fill` of
//! their circle are repeated.
//!
//! Lengths in metres, vertices anticlockwise. Source: doi:10.3390/ma14071627, section 2.3.

use super::region::Point;
use math::elementary::sin_cos;
use math::random::Stream;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// How large the polygon of a particle of given size is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SizeRule {
    /// Vertices on the circle of the size.
    Inscribed,
    /// Area of the circle of the size.
    EqualArea,
}

/// How the vertex angles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AngleLaw {
    /// Independent and uniform on the circle.
    Random,
    /// Even steps, each vertex moved by up to a quarter of a step either way.
    Jittered,
    /// Even steps: regular polygons.
    Even,
}

/// How polygons are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolygonRecipe {
    /// Fewest vertices, at least 3.
    pub min_vertices: usize,
    /// Most vertices.
    pub max_vertices: usize,
    /// Meaning of the size.
    pub size: SizeRule,
    /// Law of the vertex angles.
    pub angles: AngleLaw,
    /// Smallest share of its circle that a polygon fills, 0 … 0.4.
    pub least_fill: f64,
}

/// What is wrong with a recipe.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Vertex range.
    #[error("polygon: {min} to {max} vertices; give a range of at least 3 that does not decrease")]
    Vertices {
        /// Fewest.
        min: usize,
        /// Most.
        max: usize,
    },
    /// Fill beyond what a triangle can reach.
    #[error("polygon: least_fill is {0}; it must be between 0 and 0.4 (a regular triangle fills 0.41 of its circle)")]
    Fill(f64),
}

/// A convex polygon, vertices anticlockwise (m).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Vertices.
    pub vertices: Vec<Point>,
}

/// Area, centroid and polar second moment about the centroid of a plane figure (m², m, m⁴).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaMoments {
    /// Area (m²).
    pub area: f64,
    /// Centroid (m).
    pub centroid: Point,
    /// Polar second moment of area about the centroid (m⁴).
    pub polar: f64,
}

impl PolygonRecipe {
    /// All that is wrong with the recipe.
    pub fn faults(&self) -> Vec<PolygonError> {
        let mut faults = Vec::new();
        if self.min_vertices < 3 || self.max_vertices < self.min_vertices {
            faults.push(PolygonError::Vertices { min: self.min_vertices, max: self.max_vertices });
        }
        if !(0.0..=0.4).contains(&self.least_fill) {
            faults.push(PolygonError::Fill(self.least_fill));
        }
        faults
    }

    /// A polygon for a particle of `diameter` (m), its circle centred at the origin. The recipe must be without faults.
    pub fn draw(&self, diameter: f64, stream: &mut Stream) -> Polygon {
        let circle = PI * 0.25 * diameter * diameter;
        // A sliver of no width cannot be scaled to an area, hence the floor.
        let least = self.least_fill.max(1e-3) * circle;
        loop {
            let mut polygon = self.on_circle(0.5 * diameter, stream);
            let area = polygon.moments().area;
            if area < least {
                continue;
            }
            if self.size == SizeRule::EqualArea {
                polygon.scale((circle / area).sqrt());
            }
            return polygon;
        }
    }

    fn on_circle(&self, radius: f64, stream: &mut Stream) -> Polygon {
        let range = (self.max_vertices - self.min_vertices) as f64;
        let count = (self.min_vertices as f64 + stream.uniform() * range).round() as usize;
        let turn = TAU * stream.uniform();
        let step = TAU / count as f64;
        let mut angles: Vec<f64> = (0..count)
            .map(|k| match self.angles {
                AngleLaw::Random => TAU * stream.uniform(),
                AngleLaw::Jittered => turn + step * (k as f64 + stream.uniform_in(-0.25, 0.25)),
                AngleLaw::Even => turn + step * k as f64,
            })
            .collect();
        angles.sort_by(f64::total_cmp);
        let vertex = |&angle: &f64| {
            let (sin, cos) = sin_cos(angle);
            [radius * cos, radius * sin]
        };
        Polygon { vertices: angles.iter().map(vertex).collect() }
    }
}

impl Polygon {
    /// Area, centroid, polar moment, exact (Green's theorem over the edges).
    pub fn moments(&self) -> AreaMoments {
        let base = self.vertices[0];
        let (mut area, mut first, mut polar) = (0.0, [0.0; 2], 0.0);
        for (a, b) in self.edges() {
            let (a, b) = (sub(a, base), sub(b, base));
            let cross = cross(a, b);
            area += cross / 2.0;
            first[0] += cross * (a[0] + b[0]) / 6.0;
            first[1] += cross * (a[1] + b[1]) / 6.0;
            polar += cross * (dot(a, a) + dot(a, b) + dot(b, b)) / 12.0;
        }
        let centre = [first[0] / area, first[1] / area];
        let centroid = [base[0] + centre[0], base[1] + centre[1]];
        AreaMoments { area, centroid, polar: polar - area * dot(centre, centre) }
    }

    /// Whether `point` lies inside or on the outline.
    pub fn contains(&self, point: Point) -> bool {
        self.edges().all(|(a, b)| cross(sub(b, a), sub(point, a)) >= 0.0)
    }

    /// Distance to another polygon (m); 0 when they touch or overlap.
    pub fn distance(&self, other: &Self) -> f64 {
        if !self.apart_along_own_edges(other) && !other.apart_along_own_edges(self) {
            return 0.0;
        }
        self.vertices_to_edges(other).min(other.vertices_to_edges(self)).sqrt()
    }

    /// Distance of the farthest vertex from the origin (m).
    pub fn reach(&self) -> f64 {
        self.vertices.iter().map(|&v| dot(v, v)).fold(0.0, f64::max).sqrt()
    }

    /// The polygon moved by `shift` (m).
    pub fn moved(&self, shift: Point) -> Self {
        Self { vertices: self.vertices.iter().map(|v| [v[0] + shift[0], v[1] + shift[1]]).collect() }
    }

    fn scale(&mut self, factor: f64) {
        for v in &mut self.vertices {
            *v = [factor * v[0], factor * v[1]];
        }
    }

    fn edges(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        let n = self.vertices.len();
        (0..n).map(move |k| (self.vertices[k], self.vertices[(k + 1) % n]))
    }

    /// Whether the normal of one of this polygon's edges separates the two (separating-axis theorem).
    fn apart_along_own_edges(&self, other: &Self) -> bool {
        self.edges().any(|(a, b)| other.vertices.iter().all(|&v| cross(sub(b, a), sub(v, a)) < 0.0))
    }

    /// Least squared distance from this polygon's vertices to the other's edges.
    fn vertices_to_edges(&self, other: &Self) -> f64 {
        let to_edge = |v: Point, (a, b): (Point, Point)| {
            let along = sub(b, a);
            let length = dot(along, along);
            let share = if length > 0.0 { (dot(sub(v, a), along) / length).clamp(0.0, 1.0) } else { 0.0 };
            let off = sub(v, [a[0] + share * along[0], a[1] + share * along[1]]);
            dot(off, off)
        };
        let nearest = |v: &Point| other.edges().map(|edge| to_edge(*v, edge)).fold(f64::INFINITY, f64::min);
        self.vertices.iter().map(nearest).fold(f64::INFINITY, f64::min)
    }
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe(size: SizeRule, angles: AngleLaw) -> PolygonRecipe {
        PolygonRecipe { min_vertices: 4, max_vertices: 6, size, angles, least_fill: 0.0 }
    }

    fn square(side: f64) -> Polygon {
        Polygon { vertices: vec![[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]] }
    }

    #[test]
    fn moments_of_a_square_off_the_origin() {
        let got = square(2.0).moved([10.0, -3.0]).moments();
        assert!((got.area - 4.0).abs() < 1e-14);
        assert!((got.centroid[0] - 11.0).abs() < 1e-14 && (got.centroid[1] + 2.0).abs() < 1e-14);
        assert!((got.polar - 16.0 / 6.0).abs() < 1e-13); // a⁴/6
    }

    /// Regular polygon in a circle: A = n/2 R² sin(2π/n), J = A R² (2 + cos(2π/n)) / 6.
    #[test]
    fn regular_polygons_have_their_closed_forms() {
        for n in 3..9 {
            let even =
                PolygonRecipe { min_vertices: n, max_vertices: n, ..recipe(SizeRule::Inscribed, AngleLaw::Even) };
            let got = even.draw(2.0, &mut Stream::new(3, "even", n as u64)).moments();
            let step = TAU / n as f64;
            let area = 0.5 * n as f64 * math::elementary::sin(step);
            assert!((got.area - area).abs() < 1e-13);
            assert!((got.polar - area * (2.0 + math::elementary::cos(step)) / 6.0).abs() < 1e-13);
        }
    }

    /// Mean area of n random points on the unit circle is (n/2) E[sin gap], the gap having density
    /// (n−1)(1−g/2π)^(n−2)/2π: 3/π for n = 4, 10(1/2π − 6/(2π)³) for 5, 15(1/2π − 12/(2π)³) for 6.
    #[test]
    fn random_polygons_have_the_mean_area_of_random_points() {
        let draws = 4000;
        for (n, mean) in [(4, 3.0 / PI), (5, 10.0 / TAU - 60.0 / TAU.powi(3)), (6, 15.0 / TAU - 180.0 / TAU.powi(3))] {
            let law =
                PolygonRecipe { min_vertices: n, max_vertices: n, ..recipe(SizeRule::Inscribed, AngleLaw::Random) };
            let mut stream = Stream::new(1, "mean area", n as u64);
            let sum: f64 = (0..draws).map(|_| law.draw(2.0, &mut stream).moments().area).sum();
            assert!((sum / f64::from(draws) - mean).abs() < 0.03, "{n}: {}", sum / f64::from(draws));
        }
    }

    #[test]
    fn ends_of_the_vertex_range_are_half_as_likely() {
        let mut stream = Stream::new(5, "vertices", 0);
        let mut seen = [0; 7];
        for _ in 0..4000 {
            seen[recipe(SizeRule::Inscribed, AngleLaw::Jittered).draw(1.0, &mut stream).vertices.len()] += 1;
        }
        let share = |n: usize| f64::from(seen[n]) / 4000.0;
        assert!((share(4) - 0.25).abs() < 0.03 && (share(5) - 0.5).abs() < 0.03 && (share(6) - 0.25).abs() < 0.03);
    }

    #[test]
    fn equal_area_is_that_of_the_circle_and_every_polygon_is_convex() {
        let mut stream = Stream::new(9, "convex", 0);
        for angles in [AngleLaw::Random, AngleLaw::Jittered, AngleLaw::Even] {
            for _ in 0..200 {
                let polygon = recipe(SizeRule::EqualArea, angles).draw(0.01, &mut stream);
                assert!((polygon.moments().area / (PI * 0.25e-4) - 1.0).abs() < 1e-12);
                assert!(polygon.contains(polygon.moments().centroid));
                let corners: Vec<_> = polygon.edges().collect();
                for (k, &(a, b)) in corners.iter().enumerate() {
                    let (_, c) = corners[(k + 1) % corners.len()];
                    assert!(cross(sub(b, a), sub(c, b)) >= 0.0);
                }
            }
        }
    }

    #[test]
    fn distance_between_squares() {
        let a = square(1.0);
        assert!((a.distance(&a.moved([1.5, 0.2])) - 0.5).abs() < 1e-15);
        assert!((a.distance(&a.moved([4.0, 5.0])) - 5.0).abs() < 1e-14); // corner to corner: 3, 4
        assert_eq!(a.distance(&a.moved([0.9, 0.9])), 0.0);
        assert_eq!(a.distance(&square(0.2).moved([0.4, 0.4])), 0.0); // one inside the other
    }

    #[test]
    fn faults_are_named() {
        let bad = PolygonRecipe {
            min_vertices: 2,
            max_vertices: 1,
            least_fill: 0.9,
            ..recipe(SizeRule::Inscribed, AngleLaw::Even)
        };
        assert_eq!(bad.faults(), [PolygonError::Vertices { min: 2, max: 1 }, PolygonError::Fill(0.9)]);
    }
}
