//! A Gaussian process for one response: quadratic trend, smooth rest, noise.
//!
//! Over coded factors z ∈ \[−1, 1\]ᵈ the covariance of two responses is
//!
//! k(z, z′) = c² + a² z·z′ + q² (z·z′)² + s² exp(−|z − z′|² / 2ℓ²) + σ² δ
//!
//! The first three terms are a second-order response surface with normal priors on its coefficients (a linear term of
//! size a, squares of size q, interactions of size √2 q), so that few runs give a nearly linear model and many runs a
//! full quadratic one; the fourth follows what is not quadratic; σ is the scatter of a single run.
//! Mean and variance of the expected response at z, with K over the runs and k to them (Rasmussen & Williams 2006,
//! *Gaussian Processes for Machine Learning*, eq. 2.25, 2.26):
//!
//! m = kᵀ K⁻¹ y,   v = k(z, z) − σ² − kᵀ K⁻¹ k
//!
//! The sizes maximise the log marginal likelihood (eq. 2.30) times log-normal priors.

use crate::constraint::{Domain, Factor};
use crate::local::Local;
use crate::{Optimiser, Trial};
use math::elementary::{exp, ln};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The sizes of the terms of the covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// c, of the constant.
    pub constant: f64,
    /// a, of the linear terms.
    pub linear: f64,
    /// q, of the quadratic terms.
    pub quadratic: f64,
    /// s, of the smooth rest; 0 leaves it out.
    pub smooth: f64,
    /// ℓ, over which the rest changes.
    pub length: f64,
    /// σ, of the noise of a run.
    pub noise: f64,
}

/// Median and log-spread of the priors, for responses in logarithms (or in their own spread): effects of tens of
/// percent over half a range, curvature and rest of some percent, runs that scatter by a few percent.
const PRIORS: [(f64, f64); 5] = [(0.3, 1.0), (0.05, 1.0), (0.05, 1.0), (1.0, 0.5), (0.03, 1.5)];
/// Ranges of the sizes, in logarithms' spreads of their priors.
const RANGE: f64 = 4.0;
/// How much smaller the effects of a correction are than those of a response.
const CORRECTION: f64 = 0.3;
/// Prior deviation of the level, which the data decide.
const LEVEL: f64 = 3.0;

impl Sizes {
    fn from_prior(coordinates: &[f64], smooth: bool, effects: f64) -> Self {
        let of = |i: usize| PRIORS[i].0 * exp(PRIORS[i].1 * coordinates[i]) * if i < 3 { effects } else { 1.0 };
        Self {
            constant: LEVEL,
            linear: of(0),
            quadratic: of(1),
            smooth: if smooth { of(2) } else { 0.0 },
            length: of(3),
            noise: of(4),
        }
    }

    /// The covariance of the expected responses at two points.
    fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let (mut product, mut distance) = (0.0, 0.0);
        for (a, b) in a.iter().zip(b) {
            product += a * b;
            distance += (a - b) * (a - b);
        }
        self.of(product, distance)
    }

    fn of(&self, product: f64, distance: f64) -> f64 {
        let square = |x: f64| x * x;
        let rest =
            if self.smooth > 0.0 { square(self.smooth) * exp(-0.5 * distance / square(self.length)) } else { 0.0 };
        square(self.constant) + square(self.linear) * product + square(self.quadratic * product) + rest
    }
}

/// A fitted process.
#[derive(Clone, Debug)]
pub struct Gaussian {
    points: Vec<Vec<f64>>,
    sizes: Sizes,
    factor: Cholesky<f64, Dyn>,
    weights: DVector<f64>,
}

impl Gaussian {
    /// The process with given sizes; none when the covariance is not positive definite.
    pub fn with(points: &[Vec<f64>], values: &[f64], sizes: Sizes) -> Option<Self> {
        let n = points.len();
        let noise = sizes.noise * sizes.noise;
        let k =
            DMatrix::from_fn(n, n, |i, j| sizes.covariance(&points[i], &points[j]) + if i == j { noise } else { 0.0 });
        let factor = k.cholesky()?;
        let weights = factor.solve(&DVector::from_column_slice(values));
        Some(Self { points: points.to_vec(), sizes, factor, weights })
    }

    /// The process with the most likely sizes; `corrects` when it describes what a trend leaves, whose effects are
    /// expected to be smaller.
    pub fn fit(points: &[Vec<f64>], values: &[f64], smooth: bool, corrects: bool) -> Option<Self> {
        let effects = if corrects { CORRECTION } else { 1.0 };
        let table = Table::new(points, values);
        let range = |i: usize| Factor::linear(&i.to_string(), -RANGE, RANGE);
        let prior_box = Domain::new((0..PRIORS.len()).map(range).collect(), &[]).ok()?;
        let loss = |unit: &[f64]| {
            let coordinates = prior_box.natural(unit);
            let prior: f64 = coordinates.iter().map(|p| 0.5 * p * p).sum();
            prior - table.likelihood(Sizes::from_prior(&coordinates, smooth, effects)).unwrap_or(f64::NEG_INFINITY)
        };
        let start = vec![0.5; PRIORS.len()];
        let mut descent = Local::new(&prior_box, &start, loss(&start));
        for _ in 0..80 {
            let trial = |point: Vec<f64>| Trial { misfit: loss(&point), point, responses: Vec::new() };
            let trials: Vec<Trial> = descent.ask().into_iter().map(trial).collect();
            descent.tell(&trials);
            if descent.stop().is_some() {
                break;
            }
        }
        Self::with(points, values, Sizes::from_prior(&prior_box.natural(descent.best().0), smooth, effects))
    }

    /// Mean and variance of the expected response (without the noise of a run).
    pub fn predict(&self, z: &[f64]) -> (f64, f64) {
        let mut k = DVector::from_iterator(self.points.len(), self.points.iter().map(|p| self.sizes.covariance(p, z)));
        let mean = k.dot(&self.weights);
        self.factor.l_dirty().solve_lower_triangular_mut(&mut k);
        (mean, (self.sizes.covariance(z, z) - k.norm_squared()).max(0.0))
    }

    /// The sizes in use.
    pub fn sizes(&self) -> Sizes {
        self.sizes
    }
}

/// What the likelihood needs of the runs, computed once.
struct Table {
    products: Vec<f64>,
    distances: Vec<f64>,
    values: DVector<f64>,
}

impl Table {
    fn new(points: &[Vec<f64>], values: &[f64]) -> Self {
        let (mut products, mut distances) = (Vec::new(), Vec::new());
        for a in points {
            for b in points {
                products.push(a.iter().zip(b).map(|(a, b)| a * b).sum());
                distances.push(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum());
            }
        }
        Self { products, distances, values: DVector::from_column_slice(values) }
    }

    /// Log marginal likelihood.
    fn likelihood(&self, sizes: Sizes) -> Option<f64> {
        let n = self.values.len();
        let noise = sizes.noise * sizes.noise;
        let k = DMatrix::from_fn(n, n, |i, j| {
            let at = i * n + j;
            // Only the lower triangle is read by the factorisation.
            if i < j { 0.0 } else { sizes.of(self.products[at], self.distances[at]) + if i == j { noise } else { 0.0 } }
        });
        let factor = k.cholesky()?;
        let mut white = self.values.clone();
        factor.l_dirty().solve_lower_triangular_mut(&mut white);
        let determinant: f64 = (0..n).map(|i| ln(factor.l_dirty()[(i, i)])).sum();
        Some(-0.5 * white.norm_squared() - determinant - 0.5 * n as f64 * ln(std::f64::consts::TAU))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reals(value: &toml::Value) -> Vec<f64> {
        value.as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect()
    }

    /// Values of scikit-learn with the same covariance: `tests/reference/optim/gaussian_process.py`.
    #[test]
    fn values_are_those_of_scikit_learn() {
        let text = include_str!("../../../tests/reference/optim/gaussian_process.toml");
        let table: toml::Table = text.parse().unwrap();
        let rows = |name: &str| -> Vec<Vec<f64>> { table[name].as_array().unwrap().iter().map(reals).collect() };
        let (points, values, at) = (rows("points"), reals(&table["values"]), rows("at"));
        for case in ["full", "quadratic"] {
            let of = |name: &str| table[case][name].as_float().unwrap();
            let sizes = Sizes {
                constant: of("constant"),
                linear: of("linear"),
                quadratic: of("quadratic"),
                smooth: of("smooth"),
                length: of("length"),
                noise: of("noise"),
            };
            let process = Gaussian::with(&points, &values, sizes).unwrap();
            let (means, variances) = (reals(&table[case]["mean"]), reals(&table[case]["variance"]));
            for (z, (mean, variance)) in at.iter().zip(means.iter().zip(&variances)) {
                let own = process.predict(z);
                assert!((own.0 - mean).abs() < 1e-9, "{case} {own:?} {mean}");
                assert!((own.1 - variance).abs() < 1e-9, "{case} {own:?} {variance}");
            }
            let likelihood = Table::new(&points, &values).likelihood(sizes).unwrap();
            assert!((likelihood - of("likelihood")).abs() < 1e-8, "{case} {likelihood}");
        }
    }

    /// With plenty of runs the fit finds the scatter that was put in, and the function to within it.
    #[test]
    fn the_fit_finds_scatter_and_function() {
        let mut random = math::random::Stream::new(2, "gaussian test", 0);
        let truth = |z: &[f64]| 0.4 * z[0] - 0.3 * z[1] + 0.1 * z[0] * z[1] - 0.05 * z[2] * z[2];
        let points: Vec<Vec<f64>> = (0..60).map(|_| (0..3).map(|_| random.uniform_in(-1.0, 1.0)).collect()).collect();
        let values: Vec<f64> = points.iter().map(|z| truth(z) + 0.03 * random.normal()).collect();
        let process = Gaussian::fit(&points, &values, true, false).unwrap();
        assert!((0.022..0.038).contains(&process.sizes().noise), "{:?}", process.sizes());
        for z in [[0.5, 0.5, 0.5], [-0.7, 0.2, 0.0], [0.0, 0.0, -0.8]] {
            let (mean, variance) = process.predict(&z);
            let error = (mean - truth(&z)).abs();
            assert!(error < 4.0 * variance.sqrt() && error < 0.03, "{error} {variance}");
        }
    }
}
