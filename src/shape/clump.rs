//! Clumps: few balls that represent a solid.
//!
//! Candidates are the bubbles about the medial axis ([`super::medial`]) or the maximal balls of the distance transform
//! ([`super::transform`]); those smaller than `ratio` times the largest are left out. Then either
//!
//! * **by distance** (Taghavi's rule): the largest first; a ball is dropped when the angle φ at which it meets a larger ball
//!   of the clump exceeds `distance` (degrees, 0 … 180: 0 is a touch, 180 two coincident balls)
//!
//!   ```text
//!   φ = π − arccos((r₁² + r₂² − d²) / (2 r₁ r₂))
//!   ```
//! * or **by error**: the candidate that covers most of the volume not yet covered comes next; all radii grow by one length
//!   until the union has the volume of the solid; the smallest number of balls that meets every bound is taken. Balls inside a
//!   convex stone cover it slowly, so without growth no clump of tens of balls is within 2 % of its volume.

use super::Ball;
use super::mesh::Mesh;
use super::moments::Moments;
use super::vector::{dot, minus, norm};
use super::voxels::Voxels;
use super::{medial, transform, union};
use math::elementary::acos;
use math::text::Amount;
use std::f64::consts::PI;

/// Points of the surface from which bubbles grow.
const SAMPLES: usize = 1500;
/// Cells along the longest extent for coverage and for the distance transform.
const CELLS: usize = 40;
/// Columns of the quadrature while searching, and for the result.
const COARSE: usize = 72;
const FINE: usize = 256;

/// Where the candidates come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Bubbles about the medial axis (Taghavi 2011).
    #[default]
    Bubble,
    /// Maximal balls of the Euclidean distance transform.
    Distance,
}

/// How pebbles are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pebbles {
    /// Where the candidates come from.
    pub method: Method,
    /// Smallest over largest radius of a candidate, above 0 and below 1.
    pub ratio: f64,
    /// Taghavi's angle in degrees; without it the error decides.
    pub distance: Option<f64>,
}

impl Default for Pebbles {
    fn default() -> Self {
        Self { method: Method::Bubble, ratio: 0.2, distance: None }
    }
}

/// Bounds on a clump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Largest relative error of the volume.
    pub volume: f64,
    /// Largest relative error of a principal moment of inertia.
    pub inertia: f64,
    /// Largest mean distance of the two surfaces over the radius of the ball of equal volume.
    pub surface: f64,
    /// Most pebbles.
    pub most: usize,
}

impl Default for Bound {
    fn default() -> Self {
        Self { volume: 0.02, inertia: 0.05, surface: 0.05, most: 60 }
    }
}

/// Relative differences between a clump and its solid; positive where the clump has more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of the volume.
    pub volume: f64,
    /// Of the area of the surface.
    pub surface: f64,
    /// Of the principal moments of inertia, smallest first, at equal density.
    pub inertia: [f64; 3],
    /// Distance of the centres over the radius of the ball of equal volume.
    pub centre: f64,
    /// Mean distance of the surfaces over that radius.
    pub distance: f64,
}

impl Errors {
    /// Whether they are within a bound.
    pub fn within(&self, bound: &Bound) -> bool {
        self.volume.abs() <= bound.volume
            && self.inertia.iter().all(|error| error.abs() <= bound.inertia)
            && self.distance <= bound.surface
    }
}

/// A clump of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Clump {
    /// Its pebbles, in the order in which they were chosen.
    pub balls: Vec<Ball>,
    /// Volume, centre and inertia of their union, of unit density.
    pub moments: Moments,
    /// Area of its surface.
    pub surface: f64,
    /// How it differs from the solid.
    pub errors: Errors,
    /// Length by which the radii of inscribed balls grew.
    pub growth: f64,
    /// Whether it is within the bounds.
    pub met: bool,
}

impl Clump {
    /// The clump in another frame: the pebbles about their centre of mass, with rows of `axes` as unit vectors.
    #[must_use]
    pub fn about_centre(&self, axes: [[f64; 3]; 3]) -> Self {
        let into = |v: [f64; 3]| axes.map(|axis| dot(axis, v));
        let turned = |ball: &Ball| Ball { centre: into(minus(ball.centre, self.moments.centre)), radius: ball.radius };
        let inertia = self.moments.inertia;
        let entry = |i: usize, j: usize| dot(axes[i], inertia.map(|row| dot(row, axes[j])));
        let inertia = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let moments = Moments { centre: [0.0; 3], inertia, ..self.moments };
        Self { balls: self.balls.iter().map(turned).collect(), moments, ..self.clone() }
    }
}

/// Why there is no clump.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClumpFault {
    /// A setting outside its range.
    #[error("{name} is {found:#}; it must be {expected}")]
    Value {
        /// Which.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// A solid too thin for its grid or without room for a ball.
    #[error("no ball fits into the solid: it is thinner than a fortieth of its length")]
    Thin,
}

/// What is wrong with the settings.
pub fn faults(pebbles: &Pebbles, bound: &Bound) -> Vec<ClumpFault> {
    let mut faults = Vec::new();
    let mut need = |ok: bool, name, found, expected| {
        faults.extend((!ok).then_some(ClumpFault::Value { name, found, expected }));
    };
    need(pebbles.ratio > 0.0 && pebbles.ratio < 1.0, "ratio", Amount::number(pebbles.ratio), "above 0 and below 1");
    let distance = pebbles.distance.unwrap_or(90.0);
    let angle = Amount(distance, "degrees");
    need(distance > 0.0 && distance < 180.0, "distance", angle, "an angle above 0 and below 180 degrees");
    for (name, value) in [("volume", bound.volume), ("inertia", bound.inertia), ("surface", bound.surface)] {
        need(value > 0.0 && value.is_finite(), name, Amount::number(value), "a relative error above 0");
    }
    need((1..=1000).contains(&bound.most), "most", Amount::number(bound.most as f64), "from 1 to 1000 pebbles");
    faults
}

/// The clump of a solid.
///
/// # Errors
/// The first setting outside its range; a solid into which no ball fits. A bound that is not reached is in the result.
pub fn fill(solid: &Mesh, pebbles: &Pebbles, bound: &Bound) -> Result<Clump, ClumpFault> {
    if let Some(fault) = faults(pebbles, bound).into_iter().next() {
        return Err(fault);
    }
    let voxels = Voxels::of(solid, CELLS);
    let samples = medial::samples(solid, SAMPLES);
    let mut candidates = match pebbles.method {
        Method::Bubble => medial::bubbles(&samples),
        Method::Distance => transform::balls(&voxels),
    };
    candidates.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let largest = candidates.first().ok_or(ClumpFault::Thin)?.radius;
    candidates.retain(|ball| ball.radius >= pebbles.ratio * largest);
    let whole = Moments::of(solid);
    let judge = Judge { whole, principal: whole.principal().0, surface: solid.surface(), samples: &samples };
    if let Some(distance) = pebbles.distance {
        return judge.clump(apart(&candidates, distance), 0.0, bound).ok_or(ClumpFault::Thin);
    }
    let chosen = covering(&candidates, &voxels, bound.most);
    for number in 1..=chosen.len() {
        let Some(growth) = judge.growth(&chosen[..number]) else { continue };
        let balls = grown(&chosen[..number], growth);
        let moments = union::moments(&balls, COARSE).ok_or(ClumpFault::Thin)?;
        // The coarse quadrature decides whether the fine one is needed.
        let rough = Bound { volume: 1.5 * bound.volume, inertia: 1.1 * bound.inertia, ..*bound };
        if number < chosen.len() && !judge.errors(&balls, &moments, None).within(&rough) {
            continue;
        }
        let clump = judge.clump(balls, growth, bound).ok_or(ClumpFault::Thin)?;
        if clump.met || number == chosen.len() {
            return Ok(clump);
        }
    }
    Err(ClumpFault::Thin)
}

/// The solid with which its clumps are compared.
struct Judge<'a> {
    whole: Moments,
    principal: [f64; 3],
    surface: f64,
    samples: &'a [medial::Sample],
}

impl Judge<'_> {
    fn clump(&self, balls: Vec<Ball>, growth: f64, bound: &Bound) -> Option<Clump> {
        let moments = union::moments(&balls, FINE)?;
        let surface = union::surface(&balls);
        let errors = self.errors(&balls, &moments, Some(surface));
        let met = errors.within(bound) && balls.len() <= bound.most;
        Some(Clump { balls, moments, surface, errors, growth, met })
    }

    fn errors(&self, balls: &[Ball], moments: &Moments, surface: Option<f64>) -> Errors {
        let radius = self.whole.equal_radius();
        let found = moments.principal().0;
        let beyond =
            |p: [f64; 3]| balls.iter().map(|b| norm(minus(p, b.centre)) - b.radius).fold(f64::INFINITY, f64::min);
        let distance = self.samples.iter().map(|s| beyond(s.point).abs()).sum::<f64>() / self.samples.len() as f64;
        Errors {
            volume: moments.volume / self.whole.volume - 1.0,
            surface: surface.map_or(0.0, |surface| surface / self.surface - 1.0),
            inertia: std::array::from_fn(|k| found[k] / self.principal[k] - 1.0),
            centre: norm(minus(moments.centre, self.whole.centre)) / radius,
            distance: distance / radius,
        }
    }

    /// The length by which radii must grow for the union to have the solid's volume; `None` when a fifth of the radius of the
    /// ball of equal volume is not enough.
    fn growth(&self, balls: &[Ball]) -> Option<f64> {
        let volume = |growth: f64| union::moments(&grown(balls, growth), COARSE).map_or(0.0, |m| m.volume);
        let (mut low, mut high) = (0.0, 0.2 * self.whole.equal_radius());
        if volume(high) < self.whole.volume {
            return None;
        }
        if volume(low) >= self.whole.volume {
            return Some(0.0);
        }
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if volume(middle) < self.whole.volume { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}

fn grown(balls: &[Ball], growth: f64) -> Vec<Ball> {
    balls.iter().map(|b| Ball { centre: b.centre, radius: b.radius + growth }).collect()
}

/// Taghavi's choice among balls, the largest first.
fn apart(candidates: &[Ball], distance: f64) -> Vec<Ball> {
    let mut kept: Vec<Ball> = Vec::new();
    for ball in candidates {
        if kept.iter().all(|other| meeting_angle(ball, other) <= distance) {
            kept.push(*ball);
        }
    }
    kept
}

/// The angle at which two balls meet, degrees: 0 where they are apart or touch, 180 where one contains the other.
fn meeting_angle(a: &Ball, b: &Ball) -> f64 {
    let d = norm(minus(a.centre, b.centre));
    let cosine = (a.radius * a.radius + b.radius * b.radius - d * d) / (2.0 * a.radius * b.radius);
    (PI - acos(cosine.clamp(-1.0, 1.0))).to_degrees()
}

/// Chooses balls greedily: each covers most of the cells not yet covered. At most `most` of them.
fn covering(candidates: &[Ball], voxels: &Voxels, most: usize) -> Vec<Ball> {
    let cells: Vec<[f64; 3]> =
        (0..voxels.inside.len()).filter(|&c| voxels.inside[c]).map(|c| voxels.middle(c)).collect();
    let mut free = vec![true; cells.len()];
    let covers: Vec<Vec<u32>> = candidates
        .iter()
        .map(|ball| {
            // Half a cell more, so that slivers between neighbours count as covered.
            let reach = ball.radius + 0.5 * voxels.side;
            let held = (0..cells.len()).filter(|&c| norm(minus(cells[c], ball.centre)) <= reach);
            held.map(|c| c as u32).collect()
        })
        .collect();
    // The gain of a ball only decreases, so an old gain is an upper bound on the new one.
    let mut gains: Vec<usize> = covers.iter().map(Vec::len).collect();
    let mut chosen = Vec::new();
    while chosen.len() < most {
        let mut best: Option<(usize, usize)> = None;
        for (index, held) in covers.iter().enumerate() {
            if best.is_some_and(|(gain, _)| gains[index] <= gain) {
                continue;
            }
            gains[index] = held.iter().filter(|&&c| free[c as usize]).count();
            if best.is_none_or(|(gain, _)| gains[index] > gain) {
                best = Some((gains[index], index));
            }
        }
        let Some((gain, index)) = best else { break };
        if gain == 0 {
            break;
        }
        covers[index].iter().for_each(|&c| free[c as usize] = false);
        chosen.push(candidates[index]);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::super::loft::{Section, loft};
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;

    #[test]
    fn the_meeting_angle_is_that_of_two_balls() {
        let ball = |x: f64, radius: f64| Ball { centre: [x, 0.0, 0.0], radius };
        assert!(meeting_angle(&ball(0.0, 1.0), &ball(2.0, 1.0)).abs() < 1e-6);
        assert!((meeting_angle(&ball(0.0, 1.0), &ball(0.0, 1.0)) - 180.0).abs() < 1e-6);
        // Radii of 3 and 4 at a distance of 5 meet at right angles.
        assert!((meeting_angle(&ball(0.0, 3.0), &ball(5.0, 4.0)) - 90.0).abs() < 1e-9);
    }

    /// The five kinds of stones of the campaign, by either method, within the bounds and 60 pebbles.
    #[test]
    fn clumps_keep_the_bounds() {
        let section = |position: f64, thickness: f64, height: f64, exponent: f64| Section {
            position,
            thickness,
            height,
            exponent,
        };
        let stones = [
            loft(&[section(0.0, 0.9, 0.9, 5.0), section(1.0, 0.9, 0.95, 5.0)], 32).unwrap(),
            loft(&[section(0.0, 0.7, 0.3, 3.0), section(0.6, 1.0, 0.45, 3.0), section(1.2, 0.6, 0.35, 3.0)], 32)
                .unwrap(),
            loft(&[section(0.0, 0.0, 0.0, 2.0), section(1.0, 1.0, 0.9, 2.0), section(2.0, 0.0, 0.0, 2.0)], 32).unwrap(),
            ellipsoid([1.0, 0.8, 0.7], 32),
        ];
        for (k, stone) in stones.iter().enumerate() {
            for method in [Method::Bubble, Method::Distance] {
                let found = fill(stone, &Pebbles { method, ..Pebbles::default() }, &Bound::default()).unwrap();
                println!("{k} {method:?} {} {:?} {}", found.balls.len(), found.errors, found.growth);
                assert!(found.met, "{k} {method:?} {} {:?}", found.balls.len(), found.errors);
                assert!(found.errors.within(&Bound::default()) && found.balls.len() <= 60);
            }
        }
    }

    /// Taghavi's rule: a larger distance keeps more pebbles, a larger ratio fewer; none leaves the solid.
    #[test]
    fn distance_and_ratio_decide_how_many() {
        let solid = cuboid([1.0, 1.0, 1.5]);
        let count = |ratio, distance| {
            let pebbles = Pebbles { method: Method::Bubble, ratio, distance: Some(distance) };
            let found = fill(&solid, &pebbles, &Bound::default()).unwrap();
            for b in &found.balls {
                for k in 0..3 {
                    let depth = b.centre[k].min([1.0, 1.0, 1.5][k] - b.centre[k]);
                    assert!(b.radius < depth + 0.03, "{b:?}");
                }
            }
            assert!(found.errors.volume < 0.0 && found.growth == 0.0);
            found.balls.len()
        };
        assert!(count(0.3, 150.0) > count(0.3, 100.0));
        assert!(count(0.2, 120.0) > count(0.6, 120.0));
    }

    /// In its own principal axes a clump has a diagonal inertia of the same values.
    #[test]
    fn a_clump_turns_into_its_principal_axes() {
        let ball = |x: f64, y: f64, radius: f64| Ball { centre: [x, y, 0.3], radius };
        let balls = vec![ball(0.0, 0.0, 1.0), ball(1.0, 1.0, 0.8), ball(2.0, 2.5, 0.6)];
        let moments = union::moments(&balls, 128).unwrap();
        let clump = Clump { balls, moments, surface: 0.0, errors: Errors::default(), growth: 0.0, met: true };
        let (values, axes) = moments.principal();
        let own = clump.about_centre(axes);
        for (k, value) in values.into_iter().enumerate() {
            assert!((own.moments.inertia[k][k] / value - 1.0).abs() < 1e-9);
        }
        assert!(own.moments.inertia[0][1].abs() + own.moments.inertia[1][2].abs() < 1e-9 * values[0]);
        let again = union::moments(&own.balls, 256).unwrap();
        assert!((again.inertia[2][2] / values[2] - 1.0).abs() < 1e-3 && norm(again.centre) < 1e-3);
    }

    #[test]
    fn settings_outside_their_range_are_faults() {
        let pebbles = Pebbles { ratio: 1.0, distance: Some(200.0), ..Pebbles::default() };
        let found = faults(&pebbles, &Bound { volume: f64::NAN, inertia: 0.0, surface: -1.0, most: 0 });
        assert_eq!(found.len(), 6);
    }
}
