//! Covariance matrix adaptation evolution strategy with restarts.
//!
//! A generation samples λ points from N(m, σ² C). The mean m moves to the weighted mean of the best half; the evolution
//! paths p_σ and p_c steer the step size σ (cumulative step-size adaptation) and the rank-one update of C; the ranked
//! steps give the rank-μ update, bad ones with negative weight. When a run has converged or stagnates a new one starts
//! elsewhere with a larger population (IPOP; three times, so that a short budget still reaches a large one).
//!
//! A point outside the domain is evaluated at the nearest allowed one, and ranked by misfit + γ distance², with γ from
//! the spread of the misfits, so that the mean is drawn back without bending the covariance.
//!
//! Sources: Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv:1604.00772 (constants: table 1, equations 49–58);
//! Auger & Hansen 2005, doi:10.1109/CEC.2005.1554902 (restarts, there twice as large); Hansen et al. 2009, doi:10.1109/TEVC.2008.924423
//! (bounds). Under noise the population must grow: `population` is the setting for it.

use super::constraint::Domain;
use super::{Optimiser, Stop, Trial};
use math::elementary::{exp, ln, pow};
use math::random::Stream;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Points in a generation; 4 + ⌊3 ln d⌋ when left out.
    pub population: Option<usize>,
    /// Step size at the start, in ranges.
    pub step: f64,
    /// Restarts.
    pub restarts: usize,
    /// How much larger the population of each restart is.
    pub growth: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { population: None, step: 0.3, restarts: 6, growth: 3 }
    }
}

/// Spread of the misfit and largest step, in ranges, that end a run.
const CONVERGED: f64 = 1e-13;
/// Condition of the covariance that ends a run.
const CONDITION: f64 = 1e14;

/// The algorithm's state.
pub struct CmaEs {
    settings: Settings,
    domain: Domain,
    random: Stream,
    run: Run,
    restarts: usize,
    stopped: Option<Stop>,
}

impl CmaEs {
    /// A fresh search from a given point of the unit box.
    pub fn new(settings: &Settings, domain: &Domain, seed: u64, start: &[f64]) -> Self {
        let d = domain.len();
        let population = settings.population.unwrap_or(4 + (3.0 * ln(d as f64)).floor() as usize).max(4);
        Self {
            settings: settings.clone(),
            domain: domain.clone(),
            random: Stream::new(seed, "cma-es", 0),
            run: Run::new(start, settings.step, population),
            restarts: 0,
            stopped: None,
        }
    }

    fn restart(&mut self) {
        if self.restarts >= self.settings.restarts {
            self.stopped = Some(Stop::Stalled);
            return;
        }
        self.restarts += 1;
        let start = self.domain.sample(&mut self.random);
        self.run = Run::new(&start, self.settings.step, self.settings.growth.max(1) * self.run.weights.len());
    }
}

impl Optimiser for CmaEs {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        let count = self.run.weights.len();
        self.run.steps = (0..count).map(|_| self.run.step(&mut self.random)).collect();
        self.run.steps.iter().map(|y| self.domain.repair((&self.run.mean + self.run.sigma * y).as_slice())).collect()
    }

    fn tell(&mut self, trials: &[Trial]) {
        self.run.update(trials);
        if self.run.is_over() {
            self.restart();
        }
    }

    fn stop(&self) -> Option<Stop> {
        self.stopped
    }
}

/// Constants of the method for a dimension and population (table 1).
struct Rates {
    mu_eff: f64,
    sigma: f64,
    damping: f64,
    path: f64,
    one: f64,
    mu: f64,
    /// Expected length of a standard normal vector.
    length: f64,
}

/// One run between restarts.
struct Run {
    mean: DVector<f64>,
    sigma: f64,
    /// C = B D² Bᵀ.
    covariance: DMatrix<f64>,
    basis: DMatrix<f64>,
    lengths: DVector<f64>,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    /// Recombination weights by rank; the bad half is negative.
    weights: Vec<f64>,
    rates: Rates,
    steps: Vec<DVector<f64>>,
    generation: usize,
    stale: usize,
    /// Best misfit of each generation.
    best: Vec<f64>,
    spread: f64,
}

impl Run {
    fn new(start: &[f64], sigma: f64, population: usize) -> Self {
        let n = start.len();
        let (weights, rates) = constants(n, population);
        Self {
            mean: DVector::from_column_slice(start),
            sigma,
            covariance: DMatrix::identity(n, n),
            basis: DMatrix::identity(n, n),
            lengths: DVector::from_element(n, 1.0),
            path_sigma: DVector::zeros(n),
            path_c: DVector::zeros(n),
            weights,
            rates,
            steps: Vec::new(),
            generation: 0,
            stale: 0,
            best: Vec::new(),
            spread: f64::INFINITY,
        }
    }

    /// A draw from N(0, C).
    fn step(&self, random: &mut Stream) -> DVector<f64> {
        let z = DVector::from_fn(self.lengths.len(), |i, _| self.lengths[i] * random.normal());
        times(&self.basis, &z)
    }

    fn update(&mut self, trials: &[Trial]) {
        self.generation += 1;
        let order = self.ranking(trials);
        let n = self.mean.len() as f64;
        let good = self.weights.iter().filter(|w| **w > 0.0).count();
        let mut shift = DVector::zeros(self.mean.len());
        for (rank, &i) in order.iter().take(good).enumerate() {
            shift.axpy(self.weights[rank], &self.steps[i], 1.0);
        }
        self.mean.axpy(self.sigma, &shift, 1.0);

        let r = &self.rates;
        let white = self.whiten(&shift);
        self.path_sigma.axpy((r.sigma * (2.0 - r.sigma) * r.mu_eff).sqrt(), &white, 1.0 - r.sigma);
        let length = self.path_sigma.norm();
        let faded = 1.0 - pow(1.0 - r.sigma, 2.0 * self.generation as f64);
        let moving = length / faded.sqrt() < (1.4 + 2.0 / (n + 1.0)) * r.length;
        let gain = if moving { (r.path * (2.0 - r.path) * r.mu_eff).sqrt() } else { 0.0 };
        self.path_c.axpy(gain, &shift, 1.0 - r.path);
        let step_factor = exp((r.sigma / r.damping * (length / r.length - 1.0)).min(1.0));
        self.adapt(&order, moving);
        self.sigma *= step_factor;
        self.decompose();
    }

    /// Indices of the trials from good to bad, those moved into the domain with a penalty.
    fn ranking(&mut self, trials: &[Trial]) -> Vec<usize> {
        let mut finite: Vec<f64> = trials.iter().map(|t| t.misfit).filter(|m| m.is_finite()).collect();
        finite.sort_by(f64::total_cmp);
        let quartile = |part: usize| finite.get(finite.len() * part / 4).copied().unwrap_or(0.0);
        self.best.push(finite.first().copied().unwrap_or(f64::INFINITY));
        self.spread = finite.last().map_or(f64::INFINITY, |last| last - finite[0]);
        let scale = self.sigma * self.sigma * self.covariance.trace() / self.mean.len() as f64;
        let gamma = 2.0 * (quartile(3) - quartile(1)) / scale;
        let value = |(t, y): (&Trial, &DVector<f64>)| {
            let outside: f64 =
                t.point.iter().zip((&self.mean + self.sigma * y).iter()).map(|(a, b)| (a - b) * (a - b)).sum();
            t.misfit + gamma * outside
        };
        let values: Vec<f64> = trials.iter().zip(&self.steps).map(value).collect();
        let mut order: Vec<usize> = (0..trials.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        order
    }

    /// C^(−1/2) y.
    fn whiten(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut z = self.basis.tr_mul(y);
        z.iter_mut().zip(self.lengths.iter()).for_each(|(z, d)| *z /= d);
        times(&self.basis, &z)
    }

    /// Rank-one and rank-μ update of the covariance (equations 30, 46, 47).
    fn adapt(&mut self, order: &[usize], moving: bool) {
        let Rates { one, mu, path, .. } = self.rates;
        let n = self.mean.len() as f64;
        let lost = if moving { 0.0 } else { one * path * (2.0 - path) };
        let keep = 1.0 + lost - one - mu * self.weights.iter().sum::<f64>();
        self.covariance *= keep;
        self.covariance.ger(one, &self.path_c, &self.path_c, 1.0);
        for (rank, &i) in order.iter().enumerate() {
            let weight = self.weights[rank];
            let bent = if weight < 0.0 { n / self.whiten(&self.steps[i]).norm_squared().max(1e-300) } else { 1.0 };
            self.covariance.ger(mu * weight * bent, &self.steps[i], &self.steps[i], 1.0);
        }
    }

    /// Eigenvalues of C, every few generations as the tutorial allows.
    fn decompose(&mut self) {
        let n = self.mean.len();
        self.stale += 1;
        if (self.stale as f64) < 1.0 / ((self.rates.one + self.rates.mu) * n as f64 * 10.0) {
            return;
        }
        self.stale = 0;
        for i in 0..n {
            for j in 0..i {
                let mean = 0.5 * (self.covariance[(i, j)] + self.covariance[(j, i)]);
                self.covariance[(i, j)] = mean;
                self.covariance[(j, i)] = mean;
            }
        }
        let eigen = SymmetricEigen::new(self.covariance.clone());
        self.lengths = eigen.eigenvalues.map(|value| value.max(1e-300).sqrt());
        self.basis = eigen.eigenvectors;
    }

    fn is_over(&self) -> bool {
        let n = self.mean.len();
        let window = 10 + (30 * n).div_ceil(self.weights.len());
        let recent = &self.best[self.best.len().saturating_sub(window)..];
        let (low, high) = recent.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &b| (l.min(b), h.max(b)));
        let flat = recent.len() == window && high - low <= CONVERGED * (1.0 + low.abs()) && self.spread <= CONVERGED;
        let longest = self.lengths.max();
        let condition = pow(longest / self.lengths.min(), 2.0);
        flat || self.sigma * longest < CONVERGED || !(condition < CONDITION) || self.is_stagnant(n)
    }

    /// No better median over the last tenth of a long history (tutorial, B.3).
    fn is_stagnant(&self, n: usize) -> bool {
        let long = 120 + 30 * n * 10 / self.weights.len();
        if self.best.len() < long {
            return false;
        }
        let part = (self.best.len() / 5).min(2000);
        let history = &self.best[self.best.len() - 2 * part..];
        median(&history[part..]) >= median(&history[..part])
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Matrix times vector in a fixed order.
fn times(a: &DMatrix<f64>, x: &DVector<f64>) -> DVector<f64> {
    let mut sum = DVector::zeros(a.nrows());
    for j in 0..a.ncols() {
        sum.axpy(x[j], &a.column(j), 1.0);
    }
    sum
}

/// Weights and learning rates (equations 49–58).
fn constants(n: usize, population: usize) -> (Vec<f64>, Rates) {
    let dimension = n as f64;
    let raw: Vec<f64> = (0..population).map(|i| ln((population as f64 + 1.0) / 2.0) - ln(i as f64 + 1.0)).collect();
    let effective = |part: &[f64]| pow(part.iter().sum::<f64>(), 2.0) / part.iter().map(|w| w * w).sum::<f64>();
    let (good, bad) = raw.split_at(population / 2);
    let (mu_eff, bad_eff) = (effective(good), effective(bad));
    let path = (4.0 + mu_eff / dimension) / (dimension + 4.0 + 2.0 * mu_eff / dimension);
    let one = 2.0 / (pow(dimension + 1.3, 2.0) + mu_eff);
    let mu = (2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / (pow(dimension + 2.0, 2.0) + mu_eff)).min(1.0 - one);
    let sigma = (mu_eff + 2.0) / (dimension + mu_eff + 5.0);
    let damping = 1.0 + 2.0 * (((mu_eff - 1.0) / (dimension + 1.0)).sqrt() - 1.0).max(0.0) + sigma;
    let length = dimension.sqrt() * (1.0 - 1.0 / (4.0 * dimension) + 1.0 / (21.0 * dimension * dimension));
    let limit = (1.0 + one / mu).min(1.0 + 2.0 * bad_eff / (mu_eff + 2.0)).min((1.0 - one - mu) / (dimension * mu));
    let (up, down) = (good.iter().sum::<f64>(), bad.iter().map(|w| w.abs()).sum::<f64>());
    let weight = |&w: &f64| if w >= 0.0 { w / up } else { limit * w / down };
    (raw.iter().map(weight).collect(), Rates { mu_eff, sigma, damping, path, one, mu, length })
}
