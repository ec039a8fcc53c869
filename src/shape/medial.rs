//! Balls about the medial axis of a solid: the bubbles of Taghavi (2011).
//!
//! The medial axis is the set of centres of balls that touch the surface at two points or more and lie inside. Taghavi takes
//! them from the Delaunay tetrahedra of points on the surface, whose circumscribed balls hold none of the points. Here each
//! point p of the surface with its normal n shrinks a ball that touches it from inside until no other point is in it
//!
//! ```text
//! c = p − r n        r ← |p − q|² / (2 n · (p − q))        q: the point nearest to c
//! ```
//!
//! (Ma, Bae & Choi 2012, doi:10.1007/s00371-011-0594-7), which gives the same balls: those that touch at p and at q and
//! are empty. A point q that lies within 30° of p as seen from the centre is noise of the facets and does not shrink the ball.
//! In the end each radius is the distance to the nearest point.
//!
//! Source: Taghavi, R. (2011), Automatic clump generation based on mid-surface, Continuum and Distinct Element Numerical
//! Modeling in Geomechanics, paper 05-02.

use super::Ball;
use super::mesh::{Mesh, area_vector};
use super::vector::{dot, minus, norm, plus, times};

/// Cosine of the angle between facets up to which the surface is smooth, and between p and q up to which q is noise.
const SMOOTH: f64 = 0.866_025_403_784_438_6;
/// Most iterations for one ball.
const ROUNDS: usize = 40;

/// A point of a surface with its outward normal.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Where.
    pub point: [f64; 3],
    /// Unit normal; across edges of less than 30° it turns smoothly.
    pub normal: [f64; 3],
}

/// Points spread over a surface, each representing the same area.
pub fn samples(mesh: &Mesh, number: usize) -> Vec<Sample> {
    let areas: Vec<[f64; 3]> = mesh.triangles().map(area_vector).collect();
    let normals = corner_normals(mesh, &areas);
    let whole: f64 = areas.iter().map(|&a| norm(a)).sum();
    let mut found = Vec::with_capacity(number);
    let mut passed = 0.0;
    for (facet, &area) in areas.iter().enumerate() {
        let share = norm(area) / whole * number as f64;
        let corners = mesh.corners(facet);
        while found.len() < number && (found.len() as f64 + 0.5) < passed + share {
            let [u, v] = pair(found.len());
            // A point of the unit square, folded into the triangle.
            let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
            let weights = [1.0 - u - v, u, v];
            let mix = |three: [[f64; 3]; 3]| (0..3).fold([0.0; 3], |sum, k| plus(sum, times(three[k], weights[k])));
            let normal = mix(normals[facet]);
            found.push(Sample { point: mix(corners), normal: times(normal, 1.0 / norm(normal)) });
        }
        passed += share;
    }
    found
}

/// Two coordinates of a low-discrepancy sequence (additive recurrence of the plastic number).
fn pair(k: usize) -> [f64; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| ((k as f64 + 1.0) * step).fract())
}

/// Normal at each corner of each facet: the mean over the facets at the vertex that are within 30° of it.
fn corner_normals(mesh: &Mesh, areas: &[[f64; 3]]) -> Vec<[[f64; 3]; 3]> {
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); mesh.vertices().len()];
    for (index, facet) in mesh.facets().iter().enumerate() {
        facet.iter().for_each(|&v| around[v as usize].push(index as u32));
    }
    let unit = |facet: usize| times(areas[facet], 1.0 / norm(areas[facet]));
    let normal = |facet: usize, vertex: u32| {
        let near = around[vertex as usize].iter().filter(|&&f| dot(unit(f as usize), unit(facet)) > SMOOTH);
        let sum = near.fold([0.0; 3], |sum, &f| plus(sum, areas[f as usize]));
        if norm(sum) > 0.0 { times(sum, 1.0 / norm(sum)) } else { unit(facet) }
    };
    (0..areas.len()).map(|facet| mesh.facets()[facet].map(|vertex| normal(facet, vertex))).collect()
}

/// For each point the largest ball that touches the surface there and contains none of the other points.
pub fn bubbles(samples: &[Sample]) -> Vec<Ball> {
    let (low, high) = super::vector::extent(samples.iter().map(|s| s.point));
    let widest = 0.5 * norm(minus(high, low));
    samples.iter().filter_map(|sample| bubble(sample, samples, widest)).collect()
}

fn bubble(at: &Sample, samples: &[Sample], widest: f64) -> Option<Ball> {
    let mut radius = widest;
    for _ in 0..ROUNDS {
        let centre = minus(at.point, times(at.normal, radius));
        let (point, distance) = nearest(centre, samples)?;
        let apart = minus(at.point, point);
        if distance >= radius * (1.0 - 1e-9) || norm(apart) == 0.0 {
            break;
        }
        let depth = dot(at.normal, apart);
        if depth <= 0.0 {
            break;
        }
        let smaller = dot(apart, apart) / (2.0 * depth);
        let middle = minus(at.point, times(at.normal, smaller));
        let (a, b) = (minus(at.point, middle), minus(point, middle));
        if dot(a, b) > SMOOTH * norm(a) * norm(b) {
            break;
        }
        radius = smaller;
    }
    let centre = minus(at.point, times(at.normal, radius));
    let (_, inside) = nearest(centre, samples)?;
    (inside > 0.5 * radius).then_some(Ball { centre, radius: inside })
}

/// The point nearest to a position, with its distance.
fn nearest(place: [f64; 3], samples: &[Sample]) -> Option<([f64; 3], f64)> {
    let square = |s: &Sample| {
        let d = minus(s.point, place);
        dot(d, d)
    };
    let best = samples.iter().map(|s| (square(s), s)).reduce(|a, b| if b.0 < a.0 { b } else { a })?;
    Some((best.1.point, best.0.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;

    #[test]
    fn points_lie_on_the_surface_and_share_it() {
        let found = samples(&cuboid([1.0, 2.0, 4.0]), 2800);
        assert_eq!(found.len(), 2800);
        let on_end = found.iter().filter(|s| s.normal == [0.0, 0.0, 1.0]).count();
        assert!(on_end.abs_diff(200) <= 2, "{on_end}"); // an end has 2 of 28
        assert!(found.iter().filter(|s| s.normal[2] == 1.0).all(|s| s.point[2] == 4.0));
    }

    /// In a ball every bubble is the ball; in a box of 1 × 1 × 4 the largest has a radius of 1/2 and a centre on the axis.
    #[test]
    fn bubbles_lie_about_the_medial_axis() {
        let ball = samples(&ellipsoid([1.0; 3], 40), 1500);
        let found = bubbles(&ball);
        let mean = found.iter().map(|b| b.radius).sum::<f64>() / found.len() as f64;
        assert!(found.len() > 1450 && mean > 0.97 && mean < 1.0, "{} {mean}", found.len());
        let boxed = bubbles(&samples(&cuboid([1.0, 1.0, 4.0]), 3000));
        let widest = boxed.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap();
        assert!((widest.radius - 0.5).abs() < 0.02, "{widest:?}");
        assert!((0..2).all(|k| (widest.centre[k] - 0.5).abs() < 0.03), "{widest:?}");
        // The medial axis of a box holds the diagonals of its corners.
        let corner = boxed.iter().filter(|b| b.radius < 0.3 && b.centre[2] < 0.35);
        assert!(corner.count() > 10);
    }
}
