//! Canonical analysis of a second-order surface: where it is flat, what kind of point that is, and the way up or down.
//!
//! In coded units the surface is `y = b₀ + xᵀb + xᵀBx` with `B` symmetric (half of each interaction on either side).
//! Stationary point `xₛ = −½ B⁻¹ b`; the eigenvectors of `B` are the principal axes through it and the eigenvalues the
//! curvatures along them: all negative a maximum, all positive a minimum, mixed a saddle. An eigenvalue that is negligible
//! beside the largest makes a ridge: the surface is then flat or linear along that axis and no single point is stationary.
//!
//! The steepest path follows the best point on spheres about the centre of the design (ridge analysis): on radius `r` it
//! solves `(B − μI)x = −½ b` with `μ` above the largest eigenvalue (below the least one for the way down).
//!
//! Sources: Box and Draper, Response Surfaces, Mixtures, and Ridge Analyses, 2nd ed., 2007, chapters 10–12;
//! Draper 1963, doi:10.1080/00401706.1963.10490139 (ridge analysis).

use super::model::Model;
use serde::{Deserialize, Serialize};

/// An eigenvalue counts as zero below this share of the largest.
const FLAT: f64 = 1e-9;

/// The kind of the stationary point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Nature {
    /// Every way leads down.
    Maximum,
    /// Every way leads up.
    Minimum,
    /// Some ways lead up, some down.
    Saddle,
    /// Some way leads neither up nor down.
    Ridge,
}

impl Nature {
    /// The word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Maximum => "maximum",
            Self::Minimum => "minimum",
            Self::Saddle => "saddle",
            Self::Ridge => "ridge",
        }
    }
}

/// A principal axis of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Principal {
    /// Curvature along the axis, in units of the response per squared coded unit.
    pub eigenvalue: f64,
    /// Direction in coded units, of length 1, its largest component positive.
    pub direction: Vec<f64>,
}

/// The stationary point of a surface with its principal axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Canonical {
    /// Names of the factors.
    pub factors: Vec<String>,
    /// The stationary point in coded units; on a ridge the one nearest to the centre in the remaining axes.
    pub coded: Vec<f64>,
    /// The same in natural units.
    pub natural: Vec<f64>,
    /// The surface there.
    pub value: f64,
    /// The kind of the point.
    pub nature: Nature,
    /// Whether it lies in the domain of every factor.
    pub inside: bool,
    /// Axes by falling eigenvalue.
    pub axes: Vec<Principal>,
}

/// One point of a steepest path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathPoint {
    /// Distance from the centre in coded units.
    pub radius: f64,
    /// The point in coded units.
    pub coded: Vec<f64>,
    /// The point in natural units.
    pub natural: Vec<f64>,
    /// The surface there.
    pub value: f64,
    /// Whether it lies in the domain of every factor.
    pub inside: bool,
}

/// Linear and quadratic part of a model in coded units; `None` when a term is of higher degree or nothing is curved.
fn parts(model: &Model) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let n = model.axes.len();
    let mut linear = vec![0.0; n];
    let mut curved = vec![vec![0.0; n]; n];
    for (term, &b) in model.coefficients.iter().enumerate() {
        let powers = &model.powers[term * n..(term + 1) * n];
        let held: Vec<usize> = (0..n).flat_map(|axis| (0..powers[axis]).map(move |_| axis)).collect();
        match held[..] {
            [] => {}
            [i] => linear[i] = b,
            [i, j] if i == j => curved[i][i] = b,
            [i, j] => {
                curved[i][j] = b / 2.0;
                curved[j][i] = b / 2.0;
            }
            _ => return None,
        }
    }
    Some((linear, curved))
}

/// Canonical analysis; `None` when the model is not of second order.
pub fn canonical(model: &Model) -> Option<Canonical> {
    let (linear, curved) = parts(model)?;
    let mut axes = eigen(curved);
    let largest = axes.iter().map(|a| a.eigenvalue.abs()).fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    axes.sort_by(|a, b| b.eigenvalue.total_cmp(&a.eigenvalue));
    let flat = |a: &Principal| a.eigenvalue.abs() <= FLAT * largest;
    let mut coded = vec![0.0; linear.len()];
    for axis in axes.iter().filter(|a| !flat(a)) {
        let share = -0.5 * dot(&axis.direction, &linear) / axis.eigenvalue;
        add(&mut coded, share, &axis.direction);
    }
    let nature = if axes.iter().any(flat) {
        Nature::Ridge
    } else if axes.iter().all(|a| a.eigenvalue < 0.0) {
        Nature::Maximum
    } else if axes.iter().all(|a| a.eigenvalue > 0.0) {
        Nature::Minimum
    } else {
        Nature::Saddle
    };
    let (natural, inside) = located(model, &coded);
    let factors = model.axes.iter().map(|a| a.name.clone()).collect();
    Some(Canonical { factors, value: model.value_coded(&coded), coded, natural, nature, inside, axes })
}

/// The path of steepest ascent (or descent) from the centre over the given radii in coded units; `None` when the model
/// is of higher than second order or has no slope anywhere.
pub fn steepest_path(model: &Model, up: bool, radii: &[f64]) -> Option<Vec<PathPoint>> {
    let (mut linear, mut curved) = parts(model)?;
    if !up {
        linear.iter_mut().for_each(|b| *b = -*b);
        curved.iter_mut().flatten().for_each(|b| *b = -*b);
    }
    if linear.iter().chain(curved.iter().flatten()).all(|&b| b == 0.0) {
        return None;
    }
    let axes = eigen(curved);
    let at = |&radius: &f64| {
        let coded = farthest_up(&linear, &axes, radius);
        let (natural, inside) = located(model, &coded);
        PathPoint { radius, value: model.value_coded(&coded), coded, natural, inside }
    };
    Some(radii.iter().map(at).collect())
}

/// The highest point of the surface on a sphere, by bisection on the multiplier.
fn farthest_up(linear: &[f64], axes: &[Principal], radius: f64) -> Vec<f64> {
    let point = |mu: f64| {
        let mut x = vec![0.0; linear.len()];
        for axis in axes {
            add(&mut x, 0.5 * dot(&axis.direction, linear) / (mu - axis.eigenvalue), &axis.direction);
        }
        x
    };
    if radius <= 0.0 {
        return vec![0.0; linear.len()];
    }
    let top = axes.iter().map(|a| a.eigenvalue).fold(f64::NEG_INFINITY, f64::max);
    let scale = axes.iter().map(|a| a.eigenvalue.abs()).fold(norm(linear), f64::max);
    let mut low = top + 1e-14 * scale;
    let mut high = top + norm(linear) / (2.0 * radius) + 1e-13 * scale;
    if norm(&point(low)) < radius {
        return along_top_axis(point(low), axes, top, radius);
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if norm(&point(middle)) > radius {
            low = middle;
        } else {
            high = middle;
        }
    }
    point(high)
}

/// The slope has no part along the steepest axis: the rest of the radius is travelled along that axis.
fn along_top_axis(mut x: Vec<f64>, axes: &[Principal], top: f64, radius: f64) -> Vec<f64> {
    let rest = (radius * radius - dot(&x, &x)).max(0.0).sqrt();
    if let Some(axis) = axes.iter().find(|a| a.eigenvalue == top) {
        add(&mut x, rest, &axis.direction);
    }
    x
}

/// Natural units of a point and whether it lies in the domain.
fn located(model: &Model, coded: &[f64]) -> (Vec<f64>, bool) {
    let natural: Vec<f64> = model.axes.iter().zip(coded).map(|(axis, &u)| axis.natural(u)).collect();
    let inside = model.axes.iter().zip(&natural).all(|(axis, &x)| axis.holds(x));
    (natural, inside)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y)
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn add(to: &mut [f64], share: f64, of: &[f64]) {
    to.iter_mut().zip(of).for_each(|(t, o)| *t += share * o);
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix by cyclic Jacobi rotations (Golub and Van Loan §8.5), which
/// find small eigenvalues as well as large ones and need only square roots, so the bits are the same everywhere.
fn eigen(mut a: Vec<Vec<f64>>) -> Vec<Principal> {
    let n = a.len();
    let mut v: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _ in 0..60 {
        let off = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).fold(0.0, |s, (i, j)| s + a[i][j] * a[i][j]);
        if off == 0.0 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] != 0.0 {
                    rotate(&mut a, &mut v, p, q);
                }
            }
        }
    }
    let axis = |(i, direction): (usize, Vec<f64>)| {
        let lead =
            direction.iter().copied().fold(0.0, |lead: f64, d| if d.abs() > lead.abs() * 1.000_001 { d } else { lead });
        let sign = if lead < 0.0 { -1.0 } else { 1.0 };
        Principal { eigenvalue: a[i][i], direction: direction.iter().map(|d| sign * d).collect() }
    };
    v.into_iter().enumerate().map(axis).collect()
}

/// Turns the plane (p, q) so that `a[p][q]` vanishes; the rows of `v` are the eigenvectors.
fn rotate(a: &mut [Vec<f64>], v: &mut [Vec<f64>], p: usize, q: usize) {
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    let (first, second) = a.split_at_mut(q);
    for (x, y) in first[p].iter_mut().zip(&mut second[0]) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let (first, second) = v.split_at_mut(q);
    for (x, y) in first[p].iter_mut().zip(&mut second[0]) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}
