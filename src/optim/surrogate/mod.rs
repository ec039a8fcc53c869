//! Calibration with one model per response, for simulations that are dear and scatter.
//!
//! Every response gets its own model ([`gaussian`]) over *all* runs, its own and those it was told to learn from, so
//! that no single lucky run can win. A first design of two levels around the centre finds the directions; then every
//! batch is placed around the point the models recommend, each point off by a little in a direction of its own, which
//! measures the neighbourhood from all sides.
//!
//! The recommended point minimises the misfit with every deviation δ replaced by √(δ² + v), v the variance of the
//! expected response: among the many points that meet the targets it takes the one that is known best.
//!
//! Factors and responses that are positive are modelled in logarithms where their range calls for it: most
//! micromechanical laws are products of powers, so that ratios are closer to linear than differences. That is
//! a choice of coordinates, not a claim about which factor drives which response.
//!
//! A failed run tells where not to go: the chance of failure is estimated from the failed and successful neighbours
//! of a point, and multiplies its merit.
//!
//! Sources: Rasmussen & Williams 2006 (the models); Box & Wilson 1951, doi:10.1111/j.2517-6161.1951.tb00067.x
//! (sequential response surfaces); Plumlee & Joseph 2018, doi:10.5705/ss.202015.0404 (quadratic trend and smooth rest).

pub mod gaussian;

use super::local::Local;
use super::{Interval, Optimiser, Problem, Recommendation, Stop, Trial};
use crate::math::elementary::{exp, ln};
use crate::math::random::Stream;
use gaussian::Gaussian;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What follows the responses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// A quadratic trend and a smooth rest.
    #[default]
    GaussianProcess,
    /// The quadratic trend alone.
    Quadratic,
}

/// Settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// What follows the responses.
    pub model: Model,
    /// Runs asked for at once after the first design.
    pub batch: usize,
    /// Runs of the first design; the least power of two above the number of factors when left out.
    pub first: Option<usize>,
    /// Half width of the first design, in ranges.
    pub width: f64,
    /// Standard deviation of the batch around the recommended point, in ranges.
    pub jitter: f64,
    /// Most runs.
    pub runs: usize,
    /// Relative deviation that the 95 % interval of every response must stay within to end early.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: Model::GaussianProcess,
            batch: 4,
            first: None,
            width: 0.3,
            jitter: 0.08,
            runs: 60,
            tolerance: 0.02,
        }
    }
}

/// The algorithm's state: all it knows are the runs.
pub struct Surrogate {
    settings: Settings,
    problem: Problem,
    seed: u64,
    /// Runs to learn from: earlier ones first, then its own.
    runs: Vec<Trial>,
    earlier: usize,
    models: Option<Models>,
    recommended: Option<Recommendation>,
}

impl Surrogate {
    /// A fresh search that already knows some runs.
    pub fn new(settings: &Settings, problem: &Problem, seed: u64, earlier: Vec<Trial>) -> Self {
        let mut fresh = Self {
            settings: settings.clone(),
            problem: problem.clone(),
            seed,
            earlier: earlier.len(),
            runs: earlier,
            models: None,
            recommended: None,
        };
        fresh.learn();
        fresh
    }

    fn own(&self) -> usize {
        self.runs.len() - self.earlier
    }

    fn first(&self) -> usize {
        self.settings.first.unwrap_or((self.problem.domain.len() + 1).next_power_of_two())
    }

    /// Whether there are runs enough to trust the models rather than a design.
    fn designed(&self) -> bool {
        self.runs.iter().filter(|run| run.succeeded()).count() >= self.first()
    }

    fn stream(&self, purpose: &str) -> Stream {
        Stream::new(self.seed, purpose, self.own() as u64)
    }

    fn learn(&mut self) {
        self.models = Models::fit(&self.runs, &self.problem, self.settings.model);
        if let Some(models) = &self.models {
            let point = models.recommend(&self.problem, &self.runs, &mut self.stream("surrogate recommend"));
            self.recommended = Some(models.expect(&self.problem, point));
        }
    }

    /// Two levels around the centre: columns of a Hadamard matrix in random order and with random signs.
    fn design(&mut self) -> Vec<Vec<f64>> {
        let mut random = self.stream("surrogate design");
        let domain = &self.problem.domain;
        let size = self.first().max(domain.len() + 1).next_power_of_two();
        let mut columns: Vec<usize> = (1..size).collect();
        random.shuffle(&mut columns);
        let signs: Vec<f64> = columns.iter().map(|_| if random.uniform() < 0.5 { 1.0 } else { -1.0 }).collect();
        let level = |row: usize, j: usize| {
            let odd = (row & columns[j]).count_ones() % 2 == 1;
            self.settings.width * if odd { -signs[j] } else { signs[j] }
        };
        let row = |row| (0..domain.len()).map(|j| domain.centre()[j] + level(row, j)).collect::<Vec<_>>();
        let rows: Vec<usize> = (0..size).collect();
        rows.into_iter().map(|i| domain.repair(&row(i))).take(self.first()).collect()
    }

    /// Points around the recommended one, in pairs on opposite sides of it.
    fn around(&self, centre: &[f64]) -> Vec<Vec<f64>> {
        let mut random = self.stream("surrogate batch");
        let mut batch: Vec<Vec<f64>> = Vec::new();
        while batch.len() < self.settings.batch.max(1) {
            let step: Vec<f64> = centre.iter().map(|_| self.settings.jitter * random.normal()).collect();
            for sign in [1.0, -1.0] {
                let moved: Vec<f64> = centre.iter().zip(&step).map(|(u, s)| u + sign * s).collect();
                batch.push(self.problem.domain.repair(&moved));
            }
        }
        batch.truncate(self.settings.batch.max(1));
        batch
    }
}

impl Optimiser for Surrogate {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        match &self.recommended {
            Some(recommended) if self.designed() => self.around(&recommended.point),
            _ => self.design(),
        }
    }

    fn tell(&mut self, trials: &[Trial]) {
        self.runs.extend(trials.iter().cloned());
        self.learn();
    }

    fn stop(&self) -> Option<Stop> {
        let settled = |r: &Recommendation| {
            self.problem.misfit.targets().iter().zip(&r.responses).all(|(target, y)| {
                let bound = self.settings.tolerance * target.value.abs();
                (y.low - target.value).abs() <= bound && (y.high - target.value).abs() <= bound
            })
        };
        if self.designed() && self.own() > 0 && self.recommended.as_ref().is_some_and(settled) {
            return Some(Stop::Settled);
        }
        (self.own() >= self.settings.runs).then_some(Stop::Evaluations)
    }

    fn recommended(&self) -> Option<Recommendation> {
        self.recommended.clone()
    }
}

/// How a coordinate is modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// (x − centre) / width
    Linear { centre: f64, width: f64 },
    /// (ln x − centre) / width
    Logarithm { centre: f64, width: f64 },
}

impl Scale {
    /// Codes a factor's range to −1 … 1; by logarithms when its ends are positive and apart by a factor of two.
    fn factor(low: f64, high: f64) -> Self {
        if low > 0.0 && high / low >= 2.0 {
            let (low, high) = (ln(low), ln(high));
            Self::Logarithm { centre: 0.5 * (low + high), width: 0.5 * (high - low) }
        } else {
            Self::Linear { centre: 0.5 * (low + high), width: 0.5 * (high - low) }
        }
    }

    /// Codes a response: by logarithms when all are positive, else by their mean and spread.
    fn response(values: &[f64], target: f64) -> Self {
        let n = values.len() as f64;
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / n;
        if target > 0.0 && values.iter().all(|&v| v > 0.0) {
            return Self::Logarithm { centre: mean(&mut values.iter().map(|&v| ln(v))), width: 1.0 };
        }
        let centre = mean(&mut values.iter().copied());
        let width = mean(&mut values.iter().map(|v| (v - centre) * (v - centre))).sqrt();
        Self::Linear { centre, width: if width > 0.0 { width } else { 1.0 } }
    }

    fn code(self, value: f64) -> f64 {
        match self {
            Self::Linear { centre, width } => (value - centre) / width,
            Self::Logarithm { centre, width } => (ln(value) - centre) / width,
        }
    }

    fn decode(self, coded: f64) -> f64 {
        match self {
            Self::Linear { centre, width } => centre + width * coded,
            Self::Logarithm { centre, width } => exp(centre + width * coded),
        }
    }
}

/// The models of all responses, and of failure.
struct Models {
    factors: Vec<Scale>,
    responses: Vec<(Scale, Gaussian)>,
    failed: Vec<Vec<f64>>,
    succeeded: Vec<Vec<f64>>,
}

/// Distance over which a failed run warns, in half ranges.
const WARNING: f64 = 0.5;
/// Random places from which the recommended point is sought.
const STARTS: usize = 400;

impl Models {
    fn fit(runs: &[Trial], problem: &Problem, model: Model) -> Option<Self> {
        let factors: Vec<Scale> = problem.domain.factors().iter().map(|f| Scale::factor(f.low, f.high)).collect();
        let coded = |run: &Trial| code(&factors, &problem.domain.natural(&run.point));
        let (good, bad): (Vec<&Trial>, Vec<&Trial>) = runs.iter().partition(|run| run.succeeded());
        if good.is_empty() {
            return None;
        }
        let succeeded: Vec<Vec<f64>> = good.iter().map(|run| coded(run)).collect();
        let mut responses = Vec::new();
        for (k, target) in problem.misfit.targets().iter().enumerate() {
            let values: Vec<f64> = good.iter().map(|run| run.responses[k]).collect();
            let scale = Scale::response(&values, target.value);
            let coded: Vec<f64> = values.iter().map(|&v| scale.code(v)).collect();
            responses.push((scale, Gaussian::fit(&succeeded, &coded, model == Model::GaussianProcess)?));
        }
        let failed = bad.iter().map(|run| coded(run)).collect();
        Some(Self { factors, responses, failed, succeeded })
    }

    /// Chance of failure: the weight of failed neighbours against that of successful ones and a prior success.
    fn failure(&self, z: &[f64]) -> f64 {
        let near = |p: &Vec<f64>| {
            let distance: f64 = p.iter().zip(z).map(|(a, b)| (a - b) * (a - b)).sum();
            exp(-0.5 * distance / (WARNING * WARNING * z.len() as f64 / 2.0))
        };
        let bad: f64 = self.failed.iter().map(near).sum();
        let good: f64 = self.succeeded.iter().map(near).sum();
        bad / (bad + good + 1.0)
    }

    /// The misfit with the models' uncertainty counted in, and the chance of failure.
    fn risk(&self, problem: &Problem, unit: &[f64]) -> f64 {
        let z = code(&self.factors, &problem.domain.natural(unit));
        let (mut expected, mut spread) = (Vec::new(), Vec::new());
        for (scale, model) in &self.responses {
            let (mean, variance) = model.predict(&z);
            expected.push(scale.decode(mean));
            spread.push(scale.decode(mean + variance.sqrt()) - scale.decode(mean));
        }
        let deviations = problem.misfit.deviations(&expected);
        let off: Vec<f64> = expected.iter().zip(&spread).map(|(y, s)| y + s).collect();
        let beyond = problem.misfit.deviations(&off);
        let total: Vec<f64> = deviations.iter().zip(&beyond).map(|(d, b)| (d * d + (b - d) * (b - d)).sqrt()).collect();
        problem.misfit.combine(&total) * (1.0 + 10.0 * self.failure(&z))
    }

    /// The point of least risk: the best of many, refined by descent.
    fn recommend(&self, problem: &Problem, runs: &[Trial], random: &mut Stream) -> Vec<f64> {
        let domain = &problem.domain;
        let mut starts: Vec<Vec<f64>> = (0..STARTS).map(|_| domain.sample(random)).collect();
        starts.extend(runs.iter().map(|run| domain.repair(&run.point)));
        starts.push(domain.centre().to_vec());
        let mut ranked: Vec<(f64, Vec<f64>)> = starts.into_iter().map(|u| (self.risk(problem, &u), u)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let refined = ranked.iter().take(3).map(|(risk, start)| {
            let mut descent = Local::new(domain, start, *risk);
            for _ in 0..60 {
                let told = |point: Vec<f64>| Trial { misfit: self.risk(problem, &point), point, responses: Vec::new() };
                let trials: Vec<Trial> = descent.ask().into_iter().map(told).collect();
                descent.tell(&trials);
                if descent.stop().is_some() {
                    break;
                }
            }
            (descent.best().1, descent.best().0.to_vec())
        });
        let first = ranked[0].clone();
        refined.fold(first, |best, this| if this.0 < best.0 { this } else { best }).1
    }

    /// What is expected at a point.
    fn expect(&self, problem: &Problem, point: Vec<f64>) -> Recommendation {
        let z = code(&self.factors, &problem.domain.natural(&point));
        let interval = |(scale, model): &(Scale, Gaussian)| {
            let (mean, variance) = model.predict(&z);
            let half = 1.96 * variance.sqrt();
            Interval { mean: scale.decode(mean), low: scale.decode(mean - half), high: scale.decode(mean + half) }
        };
        let responses: Vec<Interval> = self.responses.iter().map(interval).collect();
        let misfit = problem.misfit.of(&responses.iter().map(|y| y.mean).collect::<Vec<_>>());
        Recommendation { point, responses, misfit }
    }
}

fn code(scales: &[Scale], natural: &[f64]) -> Vec<f64> {
    scales.iter().zip(natural).map(|(scale, &x)| scale.code(x)).collect()
}
