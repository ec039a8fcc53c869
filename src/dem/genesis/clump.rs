//! Rigid clumps: which balls a polygon turns into pebbles, and the mass and inertia of their union.
//!
//! A ball whose centre lies in a polygon becomes a pebble of that polygon's clump. The clump's mass and moment of
//! inertia are density × area and density × polar moment of either
//! * the **union** of its pebbles, overlapping parts counted once (default: it is the body that the contacts see), or
//! * the **polygon** it was cut from (the pores between pebbles filled).
//!
//! The union is exact, by Green's theorem over the arcs of each circle that no other disc covers: on the circle of
//! centre c and radius r, with u = (cos θ, sin θ) and q = c·u,
//!
//! ```text
//! A   = ½ Σ ∫ (r² + r q) dθ
//! A x = ⅓ Σ ∫ (c_x + r cos θ)(r² + r q) dθ        (y likewise)
//! J   = ¼ Σ ∫ (c² + r² + 2 r q)(r² + r q) dθ      about the origin
//! ```
//!
//! Lengths in metres; per metre of thickness in the plane. In a quasi-static test neither choice changes the result
//! beyond the noise of the loading rate.

use super::polygon::{AreaMoments, Polygon};
use super::region::{Point, norm};
use crate::space::{D2, Space, Vector};
use math::elementary::{acos, atan2, sin_cos};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// What the mass and inertia of a clump are computed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClumpMass {
    /// The union of the pebbles.
    Union,
    /// The polygon the clump was cut from.
    Polygon,
}

/// A rigid clump.
#[derive(Clone, Debug)]
pub struct Clump<S: Space = D2> {
    /// Index of its polygon.
    pub polygon: usize,
    /// Indices of the balls that became its pebbles, increasing.
    pub pebbles: Vec<usize>,
    /// Mass (kg; per metre of thickness in the plane).
    pub mass: f64,
    /// Inertia about the centre of mass (kg m²); in the plane only `[2][2]`, per metre of thickness.
    pub inertia: [[f64; 3]; 3],
    /// Centre of mass (m).
    pub centre: Vector<S>,
}

/// The inertia of a plane body of this moment.
pub fn plane_inertia(moment: f64) -> [[f64; 3]; 3] {
    let mut inertia = [[0.0; 3]; 3];
    inertia[2][2] = moment;
    inertia
}

/// The clumps that `polygons` cut out of the balls. A polygon with no ball centre in it makes no clump.
pub fn cut(polygons: &[Polygon], centres: &[Point], radii: &[f64], density: f64, mass: ClumpMass) -> Vec<Clump> {
    let mut clumps = Vec::with_capacity(polygons.len());
    for (index, polygon) in polygons.iter().enumerate() {
        let pebbles: Vec<usize> = (0..centres.len()).filter(|&i| polygon.contains(centres[i])).collect();
        if pebbles.is_empty() {
            continue;
        }
        let moments = match mass {
            ClumpMass::Polygon => polygon.moments(),
            ClumpMass::Union => {
                let discs: Vec<_> = pebbles.iter().map(|&i| (centres[i], radii[i])).collect();
                union_moments(&discs)
            }
        };
        clumps.push(Clump {
            polygon: index,
            pebbles,
            mass: density * moments.area,
            inertia: plane_inertia(density * moments.polar),
            centre: moments.centroid,
        });
    }
    clumps
}

/// Area, centroid and polar moment of the union of `discs` (centre, radius), not empty.
pub fn union_moments(discs: &[(Point, f64)]) -> AreaMoments {
    let base = discs[0].0;
    let local: Vec<_> = discs.iter().map(|&(c, r)| ([c[0] - base[0], c[1] - base[1]], r)).collect();
    let (mut area, mut first, mut polar) = (0.0, [0.0; 2], 0.0);
    for (index, &(centre, radius)) in local.iter().enumerate() {
        for (from, to) in free_arcs(index, &local) {
            let arc = arc_integrals(centre, radius, from, to);
            area += arc.area;
            first[0] += arc.centroid[0];
            first[1] += arc.centroid[1];
            polar += arc.polar;
        }
    }
    let centre = [first[0] / area, first[1] / area];
    let about_centre = polar - area * (centre[0] * centre[0] + centre[1] * centre[1]);
    AreaMoments { area, centroid: [base[0] + centre[0], base[1] + centre[1]], polar: about_centre }
}

/// Angles (from, to) of the parts of circle `index` that no other disc covers. Of equal discs the first counts.
fn free_arcs(index: usize, discs: &[(Point, f64)]) -> Vec<(f64, f64)> {
    let (centre, radius) = discs[index];
    let mut covered: Vec<(f64, f64)> = Vec::new();
    for (other, &(c, r)) in discs.iter().enumerate() {
        let apart = [c[0] - centre[0], c[1] - centre[1]];
        let distance = norm(apart);
        if other == index || distance >= radius + r {
            continue;
        }
        if distance + radius <= r {
            let same = distance == 0.0 && radius == r;
            if !same || other < index {
                return Vec::new();
            }
            continue;
        }
        if distance + r <= radius {
            continue;
        }
        let cosine = (distance * distance + radius * radius - r * r) / (2.0 * distance * radius);
        let (middle, half) = (atan2(apart[1], apart[0]), acos(cosine.clamp(-1.0, 1.0)));
        let from = (middle - half).rem_euclid(TAU);
        let to = from + 2.0 * half;
        if to <= TAU {
            covered.push((from, to));
        } else {
            covered.extend([(from, TAU), (0.0, to - TAU)]);
        }
    }
    covered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = Vec::new();
    let mut at = 0.0;
    for (from, to) in covered {
        if from > at {
            free.push((at, from));
        }
        at = to.max(at);
    }
    if at < TAU {
        free.push((at, TAU));
    }
    free
}

/// Contribution of one arc: area, area × centroid, polar moment about the origin.
fn arc_integrals(c: Point, r: f64, from: f64, to: f64) -> AreaMoments {
    let ((s0, c0), (s1, c1)) = (sin_cos(from), sin_cos(to));
    let turn = to - from;
    // ∫u, ∫cos², ∫sin², ∫sin cos over the arc.
    let u = [s1 - s0, c0 - c1];
    let twice = 0.5 * (s1 * c1 - s0 * c0);
    let (cc, ss, sc) = (0.5 * turn + twice, 0.5 * turn - twice, 0.5 * (s1 * s1 - s0 * s0));
    let q = c[0] * u[0] + c[1] * u[1];
    let qq = c[0] * c[0] * cc + c[1] * c[1] * ss + 2.0 * c[0] * c[1] * sc;
    let uq = [c[0] * cc + c[1] * sc, c[0] * sc + c[1] * ss];
    let flow = r * r * turn + r * q; // ∫ (r² + r q)
    let first = |k: usize| (c[k] * flow + r * (r * r * u[k] + r * uq[k])) / 3.0;
    let k = c[0] * c[0] + c[1] * c[1] + r * r;
    let polar = (k * flow + 2.0 * r * (r * r * q + r * qq)) / 4.0;
    AreaMoments { area: 0.5 * flow, centroid: [first(0), first(1)], polar }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn close(got: f64, expected: f64) {
        assert!((got - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{got} against {expected}");
    }

    #[test]
    fn one_disc_off_the_origin() {
        let got = union_moments(&[([5.0, -2.0], 3.0)]);
        close(got.area, 9.0 * PI);
        close(got.centroid[0], 5.0);
        close(got.centroid[1], -2.0);
        close(got.polar, PI * 81.0 / 2.0);
    }

    /// Two equal discs at distance d share a lens 2 R² acos(d/2R) − (d/2) √(4R² − d²).
    #[test]
    fn two_discs_share_a_lens() {
        let (r, d) = (1.0_f64, 1.2_f64);
        let lens = 2.0 * acos(d / 2.0) - 0.5 * d * (4.0 - d * d).sqrt();
        let got = union_moments(&[([0.0, 0.0], r), ([d * 0.6, d * 0.8], r)]);
        close(got.area, 2.0 * PI - lens);
        close(got.centroid[0], 0.36);
        close(got.centroid[1], 0.48);
    }

    /// The union of discs inside one large disc, duplicates included, is the large disc.
    #[test]
    fn covered_discs_count_once() {
        let discs = [([0.1, 0.0], 0.2), ([0.0, 0.0], 1.0), ([0.1, 0.0], 0.2), ([0.0, 0.0], 1.0), ([0.0, 0.5], 0.5)];
        let got = union_moments(&discs);
        close(got.area, PI);
        close(got.polar, PI / 2.0);
    }

    /// Separate discs add up by the parallel-axis theorem.
    #[test]
    fn separate_discs_follow_the_parallel_axis_theorem() {
        let got = union_moments(&[([-2.0, 0.0], 1.0), ([2.0, 0.0], 1.0), ([0.0, 7.0], 2.0)]);
        let area = 6.0 * PI;
        let height = 4.0 * PI * 7.0 / area;
        close(got.area, area);
        close(got.centroid[1], height);
        let own = PI / 2.0 * (1.0 + 1.0 + 16.0);
        close(got.polar, own + 2.0 * PI * (4.0 + height * height) + 4.0 * PI * (7.0 - height) * (7.0 - height));
    }

    /// A random heap of discs against a fine grid of points.
    #[test]
    fn a_heap_agrees_with_counting_points() {
        let mut stream = math::random::Stream::new(4, "heap", 0);
        let discs: Vec<(Point, f64)> =
            (0..12).map(|_| ([stream.uniform(), stream.uniform()], stream.uniform_in(0.05, 0.3))).collect();
        let (n, low, side) = (1200, -0.4, 1.8);
        let (mut area, mut polar) = (0.0, 0.0);
        let got = union_moments(&discs);
        let cell = side / f64::from(n);
        for i in 0..n {
            for j in 0..n {
                let p = [low + cell * (f64::from(i) + 0.5), low + cell * (f64::from(j) + 0.5)];
                if discs.iter().any(|&(c, r)| norm([p[0] - c[0], p[1] - c[1]]) < r) {
                    let off = norm([p[0] - got.centroid[0], p[1] - got.centroid[1]]);
                    area += cell * cell;
                    polar += cell * cell * off * off;
                }
            }
        }
        assert!((got.area / area - 1.0).abs() < 2e-3 && (got.polar / polar - 1.0).abs() < 4e-3);
    }

    #[test]
    fn a_polygon_takes_the_balls_whose_centres_it_holds() {
        let square = Polygon { vertices: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] };
        let far = square.moved([10.0, 0.0]);
        let centres = [[0.5, 0.5], [1.5, 0.5], [0.2, 0.1], [-0.1, 0.5]];
        let radii = [0.1, 0.1, 0.05, 0.3];
        let clumps = cut(&[square, far], &centres, &radii, 2650.0, ClumpMass::Union);
        assert_eq!(clumps.len(), 1);
        assert_eq!(clumps[0].pebbles, [0, 2]);
        close(clumps[0].mass, 2650.0 * PI * (0.01 + 0.0025));
        let whole = cut(
            &[Polygon { vertices: vec![[0.0; 2], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] }],
            &centres,
            &radii,
            1.0,
            ClumpMass::Polygon,
        );
        close(whole[0].inertia[2][2], 1.0 / 6.0);
    }
}
