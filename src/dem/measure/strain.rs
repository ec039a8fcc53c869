//! Mean strain of a region: the gradient that fits the motion of the centres in it best.
//!
//! With primes for what differs from the mean over the N centres inside, the gradient G of a motion u (row: u, column: x)
//! has the least Σ |u' − G x'|², so G = (Σ u' ⊗ x') (Σ x' ⊗ x')⁻¹ (the measurement region of PFC). Its symmetric part is the
//! strain, extension positive, its other part the rotation. Every particle counts alike, pebbles of a clump too, so a
//! stone counts by the room that it takes.

use super::stress::Region;
use crate::engine::Engine;
use crate::space::{Space, Tuple, Vector};

/// Velocity gradient of a region, 1/s, row by row; nothing where fewer centres than it takes lie in the region, or all on
/// one line (plane).
pub fn velocity_gradient<S: Space>(engine: &Engine<S>, region: &Region<S>) -> Option<[[f64; 3]; 3]> {
    let motion = |particle| (engine.position(particle), engine.velocity(particle));
    gradient::<S>((0..engine.particle_count()).map(motion).filter(|(x, _)| region.holds(*x)))
}

/// Displacement gradient since the centres stood at `start` (in the caller's order, m), of the particles that were in the
/// region then, row by row; nothing where they are too few, or all on one line (plane).
pub fn displacement_gradient<S: Space>(
    engine: &Engine<S>,
    region: &Region<S>,
    start: &[Vector<S>],
) -> Option<[[f64; 3]; 3]> {
    let motion = |(particle, &x): (usize, &Vector<S>)| (x, engine.position(particle).minus(x));
    gradient::<S>(start.iter().enumerate().take(engine.particle_count()).map(motion).filter(|(x, _)| region.holds(*x)))
}

/// G of positions and displacements.
fn gradient<S: Space>(points: impl Iterator<Item = (Vector<S>, Vector<S>)>) -> Option<[[f64; 3]; 3]> {
    let points: Vec<(Vector<S>, Vector<S>)> = points.collect();
    let n = points.len() as f64;
    let zero = (Vector::<S>::zero(), Vector::<S>::zero());
    let sum = points.iter().fold(zero, |sum, point| (sum.0.plus(point.0), sum.1.plus(point.1)));
    let mean = (sum.0.times(1.0 / n), sum.1.times(1.0 / n));
    let (mut square, mut cross) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for (x, u) in &points {
        let (x, u) = (x.minus(mean.0), u.minus(mean.1));
        for a in 0..S::DIMENSION {
            for b in 0..S::DIMENSION {
                square[a][b] += x.at(a) * x.at(b);
                cross[a][b] += u.at(a) * x.at(b);
            }
        }
    }
    let inverse = inverse(&square, S::DIMENSION)?;
    Some(std::array::from_fn(|a| std::array::from_fn(|b| (0..3).map(|k| cross[a][k] * inverse[k][b]).sum())))
}

/// Inverse of the leading part of a symmetric tensor that is not negative; nothing where it is singular.
fn inverse(tensor: &[[f64; 3]; 3], dimension: usize) -> Option<[[f64; 3]; 3]> {
    let scale = (0..dimension).map(|k| tensor[k][k]).fold(0.0, f64::max);
    let mut t = tensor.map(|row| row.map(|x| x / scale));
    for k in dimension..3 {
        t[k][k] = 1.0;
    }
    let minor = |a: usize, b: usize| {
        let [a1, a2, b1, b2] = [(a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3];
        t[a1][b1] * t[a2][b2] - t[a1][b2] * t[a2][b1]
    };
    let determinant: f64 = (0..3).map(|b| t[0][b] * minor(0, b)).sum();
    // Not above rounding: too few centres, or all on one line.
    if !(determinant > 1e-12) {
        return None;
    }
    let within = |k: usize| k < dimension;
    Some(std::array::from_fn(|a| {
        std::array::from_fn(|b| if within(a) && within(b) { minor(b, a) / determinant / scale } else { 0.0 })
    }))
}
