//! Descent from a point to the nearest minimum: projected quasi-Newton with finite differences.
//!
//! The direction is −H g with the BFGS estimate H of the inverse Hessian, restricted to the parameters that are free to
//! move; the path is projected onto the domain and the step halved until it decreases enough (Armijo, 10⁻⁴). The
//! gradient takes one batch of d points, forward differences of 1.5·10⁻⁸ of the range, turned inwards at a bound.
//!
//! Made for smooth, noise-free misfits (fitted surfaces); on Σ|d| it still works in practice (Lewis & Overton 2013,
//! doi:10.1007/s10107-012-0514-2), but without a proof.
//!
//! Source: Nocedal & Wright, *Numerical Optimization* (2006, doi:10.1007/978-0-387-40065-5), sections 6.1 and 16.7;
//! Bertsekas 1982, doi:10.1137/0320018 (projected Newton).

use super::constraint::Domain;
use super::{Optimiser, Stop, Trial};

/// Step of the finite differences, in ranges: the square root of the precision.
const DIFFERENCE: f64 = 1.5e-8;
/// Length of the very first step, in ranges.
const FIRST: f64 = 0.05;
/// A step shorter than this ends the descent.
const SHORTEST: f64 = 1e-12;

enum Phase {
    /// The gradient at the current point has been requested, with these signed differences.
    Gradient(Vec<f64>),
    /// A trial at this fraction of the direction has been requested.
    Line(f64),
    Done,
}

/// The state of a descent.
pub struct Local {
    domain: Domain,
    point: Vec<f64>,
    misfit: f64,
    gradient: Vec<f64>,
    /// Inverse Hessian by rows; none before the first curvature is seen.
    inverse: Option<Vec<Vec<f64>>>,
    /// The last accepted step and the gradient before it.
    last: Option<(Vec<f64>, Vec<f64>)>,
    direction: Vec<f64>,
    phase: Phase,
    left: usize,
}

impl Local {
    /// A descent from an evaluated point of the unit box.
    pub fn new(domain: &Domain, point: &[f64], misfit: f64) -> Self {
        let n = domain.len();
        Self {
            domain: domain.clone(),
            point: point.to_vec(),
            misfit,
            gradient: vec![0.0; n],
            inverse: None,
            last: None,
            direction: vec![0.0; n],
            phase: if misfit.is_finite() { Phase::Gradient(Vec::new()) } else { Phase::Done },
            left: 100 + 10 * n,
        }
    }

    /// The lowest point so far and its misfit.
    pub fn best(&self) -> (&[f64], f64) {
        (&self.point, self.misfit)
    }

    fn differences(&mut self) -> Vec<Vec<f64>> {
        let mut steps = Vec::new();
        let mut points = Vec::new();
        for j in 0..self.point.len() {
            let mut moved = self.point.clone();
            moved[j] += DIFFERENCE;
            if !self.domain.contains(&moved) || moved[j] > 1.0 {
                moved[j] = self.point[j] - DIFFERENCE;
            }
            steps.push(moved[j] - self.point[j]);
            points.push(moved);
        }
        self.phase = Phase::Gradient(steps);
        points
    }

    fn learn(&mut self, gradient: Vec<f64>) {
        if let Some((step, before)) = self.last.take() {
            let change: Vec<f64> = gradient.iter().zip(&before).map(|(a, b)| a - b).collect();
            self.update(&step, &change);
        }
        self.gradient = gradient;
        self.aim();
    }

    /// BFGS update of the inverse Hessian; skipped without positive curvature.
    fn update(&mut self, s: &[f64], y: &[f64]) {
        let (sy, yy) = (dot(s, y), dot(y, y));
        if sy <= 1e-12 * (dot(s, s) * yy).sqrt() {
            return;
        }
        let n = s.len();
        let start = || (0..n).map(|i| (0..n).map(|j| if i == j { sy / yy } else { 0.0 }).collect()).collect();
        let mut h: Vec<Vec<f64>> = self.inverse.take().unwrap_or_else(start);
        let hy: Vec<f64> = h.iter().map(|row| dot(row, y)).collect();
        let scale = (1.0 + dot(y, &hy) / sy) / sy;
        for i in 0..n {
            for j in 0..n {
                h[i][j] += scale * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / sy;
            }
        }
        self.inverse = Some(h);
    }

    /// Sets the direction from gradient and curvature and begins the line search.
    fn aim(&mut self) {
        let pinned = |u: f64, g: f64| (u <= 0.0 && g > 0.0) || (u >= 1.0 && g < 0.0);
        let free: Vec<f64> =
            self.point.iter().zip(&self.gradient).map(|(&u, &g)| if pinned(u, g) { 0.0 } else { g }).collect();
        let steepest = dot(&free, &free).sqrt();
        if steepest == 0.0 || self.left == 0 {
            self.phase = Phase::Done;
            return;
        }
        self.left -= 1;
        let along = |row: &Vec<f64>, g: f64| if g == 0.0 { 0.0 } else { -dot(row, &free) };
        self.direction = match &self.inverse {
            Some(h) => h.iter().zip(&free).map(|(row, &g)| along(row, g)).collect(),
            None => free.iter().map(|g| -g * FIRST / steepest).collect(),
        };
        if dot(&self.direction, &free) >= 0.0 {
            self.inverse = None;
            self.direction = free.iter().map(|g| -g * FIRST / steepest).collect();
        }
        self.phase = Phase::Line(1.0);
    }

    fn along(&self, fraction: f64) -> Vec<f64> {
        let moved: Vec<f64> = self.point.iter().zip(&self.direction).map(|(u, d)| u + fraction * d).collect();
        self.domain.repair(&moved)
    }

    fn judge(&mut self, fraction: f64, trial: &Trial) {
        let step: Vec<f64> = trial.point.iter().zip(&self.point).map(|(a, b)| a - b).collect();
        let expected = dot(&self.gradient, &step);
        if trial.misfit < self.misfit && trial.misfit <= self.misfit + 1e-4 * expected.min(0.0) {
            self.point.clone_from(&trial.point);
            self.misfit = trial.misfit;
            self.last = Some((step, self.gradient.clone()));
            self.phase = Phase::Gradient(Vec::new());
            return;
        }
        // The minimum of the parabola through the start, its slope and this trial.
        let slope = dot(&self.gradient, &self.direction) * fraction;
        let parabola = -0.5 * slope / (trial.misfit - self.misfit - slope);
        let shrink = if parabola.is_finite() { parabola.clamp(0.1, 0.5) } else { 0.1 };
        if dot(&step, &step).sqrt() * shrink > SHORTEST {
            self.phase = Phase::Line(fraction * shrink);
        } else if self.inverse.take().is_some() {
            self.aim();
        } else {
            self.phase = Phase::Done;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Optimiser for Local {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        match self.phase {
            Phase::Gradient(_) => self.differences(),
            Phase::Line(fraction) => vec![self.along(fraction)],
            Phase::Done => vec![self.point.clone()],
        }
    }

    fn tell(&mut self, trials: &[Trial]) {
        match std::mem::replace(&mut self.phase, Phase::Done) {
            Phase::Gradient(steps) if steps.len() == trials.len() => {
                let slope = |(t, h): (&Trial, f64)| {
                    let slope = (t.misfit - self.misfit) / h;
                    if slope.is_finite() { slope } else { 0.0 }
                };
                let gradient = trials.iter().zip(steps).map(slope).collect();
                self.learn(gradient);
            }
            Phase::Line(fraction) => self.judge(fraction, &trials[0]),
            Phase::Gradient(_) | Phase::Done => {}
        }
    }

    fn stop(&self) -> Option<Stop> {
        matches!(self.phase, Phase::Done).then_some(Stop::Stalled)
    }
}
