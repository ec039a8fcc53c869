//! Mass, centre and inertia of a union of overlapping balls: what a rigid clump of given density weighs.
//!
//! Plane: exact, by the arcs that no other disc covers ([`super::genesis::clump`]).
//!
//! Solid: slices. With A(s) the area that a plane at distance s along the unit vector e cuts out of the union,
//!
//! ```text
//! V = ∫ A ds        e · V X = ∫ s A ds        e · S e = ∫ s² A ds,   S = ∫ x ⊗ x dV
//! ```
//!
//! A is exact, for a slice of balls is a union of discs. Six directions, the axes and the diagonals of their planes, give all
//! of S: S_xy = e · S e − (S_xx + S_yy)/2 along (1, 1, 0)/√2. About the centre I = (tr S) 1 − S. Between the heights at which
//! a ball or the circle of two balls begins or ends A is smooth but at corners of three balls, and of the order (s − s₀)^³ᐟ²
//! near the ends; Gauss's rule with four times eight points in t, s = a + (b − a)(3t² − 2t³), leaves an error of 10⁻⁹, and
//! of 10⁻⁶ with such corners.

use super::error::{Fault, Faults};
use super::genesis::clump::union_moments;
use super::particle::{Clump, Particle};
use super::space::{Space, Spin, Tuple, Vector, flat};
use math::text::Amount;

/// Gauss–Legendre, eight points on −1 … 1: the positive abscissae, their weights (Abramowitz & Stegun, table 25.4).
static GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_3],
];

/// Parts of an interval between two heights.
const PARTS: usize = 4;

/// A ball: centre, radius.
type Ball = ([f64; 3], f64);

impl<S: Space> Clump<S> {
    /// The clump at rest whose mass, centre and inertia are those of the union of its pebbles, of one density (kg/m³).
    ///
    /// # Errors
    /// Every pebble that does not exist or has no sound centre and radius; no pebble; a density that is not above 0.
    pub fn of(particles: &[Particle<S>], pebbles: &[usize], density: f64) -> Result<Self, Faults> {
        let clump = 0;
        let mut faults = Vec::new();
        let mut balls = Vec::with_capacity(pebbles.len());
        for &pebble in pebbles {
            let Some(p) = particles.get(pebble) else {
                faults.push(Fault::Pebble { clump, pebble, problem: "does not exist" });
                continue;
            };
            if !(p.radius > 0.0 && p.radius.is_finite() && p.position.norm().is_finite()) {
                faults.push(Fault::Pebble { clump, pebble, problem: "has a radius or position that is none" });
            }
            balls.push((flat::<S>(p.position), p.radius));
        }
        let mut check = |quantity, value, good: bool, wanted| {
            faults.extend((!good).then_some(Fault::Clump { clump, quantity, value, wanted }));
        };
        check("number of pebbles", Amount::number(0.0), !pebbles.is_empty(), "at least 1");
        check("density", Amount(density, "kg/m^3"), density > 0.0 && density.is_finite(), "a number above 0");
        if !faults.is_empty() {
            return Err(Faults(faults));
        }
        let (volume, centre, inertia) = if S::DIMENSION == 2 { plane(&balls) } else { solid(&balls) };
        let mass = density * volume;
        let (velocity, spin) = (Vector::<S>::zero(), Spin::<S>::zero());
        let inertia = inertia.map(|row| row.map(|x| density * x));
        Ok(Self { pebbles: pebbles.to_vec(), centre: Vector::<S>::build(|k| centre[k]), velocity, spin, mass, inertia })
    }
}

/// Area, centre, second moments of a union of discs.
fn plane(balls: &[Ball]) -> (f64, [f64; 3], [[f64; 3]; 3]) {
    let discs: Vec<_> = balls.iter().map(|&([x, y, _], r)| ([x, y], r)).collect();
    let found = union_moments(&discs);
    let mut inertia = [[0.0; 3]; 3];
    inertia[2][2] = found.polar;
    (found.area, [found.centroid[0], found.centroid[1], 0.0], inertia)
}

/// Volume, centre, inertia about it (over the density) of a union of spheres.
fn solid(balls: &[Ball]) -> (f64, [f64; 3], [[f64; 3]; 3]) {
    // About the first ball, so that a centre far from the origin costs no digits.
    let base = balls[0].0;
    let local: Vec<Ball> = balls.iter().map(|&(x, r)| (x.minus(base), r)).collect();
    let along = |k: usize| sliced(&local, axis(k), axis(k + 1), axis(k + 2));
    let straight = [0, 1, 2].map(along);
    let volume = straight[0][0];
    let centre = straight.map(|moments| moments[1] / volume);
    let mut second = [[0.0; 3]; 3];
    for k in 0..3 {
        let (a, b) = (k, (k + 1) % 3);
        let half = 0.5_f64.sqrt();
        let (e, f) = (axis(a).plus(axis(b)).times(half), axis(a).minus(axis(b)).times(half));
        let diagonal = sliced(&local, e, f, axis(k + 2))[2];
        let whole = diagonal - 0.5 * (straight[a][2] + straight[b][2]);
        second[a][a] = straight[a][2] - volume * centre[a] * centre[a];
        second[a][b] = whole - volume * centre[a] * centre[b];
        second[b][a] = second[a][b];
    }
    let trace = second[0][0] + second[1][1] + second[2][2];
    let inertia = |a: usize, b: usize| if a == b { trace - second[a][b] } else { -second[a][b] };
    (volume, centre.plus(base), std::array::from_fn(|a| std::array::from_fn(|b| inertia(a, b))))
}

/// Unit vector of an axis, counted round.
fn axis(k: usize) -> [f64; 3] {
    std::array::from_fn(|a| f64::from(u8::from(a == k % 3)))
}

/// ∫ A ds, ∫ s A ds, ∫ s² A ds along `e`; `f` and `g` span the slices.
fn sliced(balls: &[Ball], e: [f64; 3], f: [f64; 3], g: [f64; 3]) -> [f64; 3] {
    let turned: Vec<([f64; 2], f64, f64)> = balls.iter().map(|&(x, r)| ([x.dot(f), x.dot(g)], x.dot(e), r)).collect();
    let heights = heights(balls, e);
    let mut sum = [0.0; 3];
    for pair in heights.windows(2).filter(|pair| pair[1] > pair[0]) {
        let length = pair[1] - pair[0];
        for (t, weight) in nodes() {
            let s = pair[0] + length * t * t * (3.0 - 2.0 * t);
            let area = weight * length * 6.0 * t * (1.0 - t) * slice(&turned, s);
            for (k, power) in [1.0, s, s * s].into_iter().enumerate() {
                sum[k] += area * power;
            }
        }
    }
    sum
}

/// Nodes and weights of Gauss's rule on the parts of 0 … 1.
fn nodes() -> impl Iterator<Item = (f64, f64)> {
    let parts = PARTS as f64;
    let signed = |node: &'static [f64; 2]| [(-node[0], node[1]), (node[0], node[1])];
    let part = move |k: usize| {
        GAUSS
            .iter()
            .flat_map(signed)
            .map(move |(x, weight)| ((k as f64 + 0.5 * (1.0 + x)) / parts, 0.5 * weight / parts))
    };
    (0..PARTS).flat_map(part)
}

/// Area of the slice at a height.
fn slice(balls: &[([f64; 2], f64, f64)], s: f64) -> f64 {
    let disc = |&(centre, height, r): &([f64; 2], f64, f64)| {
        let square = r * r - (s - height) * (s - height);
        (square > 0.0).then(|| (centre, square.sqrt()))
    };
    let discs: Vec<_> = balls.iter().filter_map(disc).collect();
    if discs.is_empty() { 0.0 } else { union_moments(&discs).area }
}

/// Where balls, and circles in which two of them meet, begin and end along `e`, in order.
fn heights(balls: &[Ball], e: [f64; 3]) -> Vec<f64> {
    let mut heights = Vec::new();
    for (k, &(x, r)) in balls.iter().enumerate() {
        heights.extend([x.dot(e) - r, x.dot(e) + r]);
        for &(y, q) in &balls[..k] {
            let apart = y.minus(x);
            let d = apart.norm();
            if d >= r + q || d <= (r - q).abs() {
                continue;
            }
            let normal = apart.times(1.0 / d);
            let from = (d * d + r * r - q * q) / (2.0 * d);
            let across = (r * r - from * from).max(0.0).sqrt();
            let tilt = (1.0 - normal.dot(e) * normal.dot(e)).max(0.0).sqrt();
            let middle = x.dot(e) + from * normal.dot(e);
            heights.extend([middle - across * tilt, middle + across * tilt]);
        }
    }
    heights.sort_by(f64::total_cmp);
    heights
}
