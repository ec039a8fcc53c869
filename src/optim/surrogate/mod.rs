//! Calibration with one model per response, for simulations that are dear and scatter.
//!
//! Every response gets its own model ([`gaussian`]) over *all* runs, its own and earlier ones that it learns from, so
//! that no single lucky run can win. A first design of two levels around the first guess, or the centre, finds the directions; then every
//! batch takes the point the models recommend and points around it, each off by a little in a direction of its own,
//! which measures the neighbourhood from all sides.
//!
//! The recommended point minimises the misfit with every deviation δ replaced by √(δ² + v), v the variance of the
//! expected response: among the many points that meet the targets it takes the one that is known best.
//!
//! Factors and responses that are positive are modelled in logarithms where their range calls for it: most
//! micromechanical laws are products of powers, so that ratios are closer to linear than differences. That is
//! a choice of coordinates, not a claim about which factor drives which response.
//!
//! A failed run shows where not to search: the chance of failure is estimated from the failed and successful neighbours
//! of a point, and multiplies its merit.
//!
//! Sources: Rasmussen & Williams 2006 (the models); Box & Wilson 1951, doi:10.1111/j.2517-6161.1951.tb00067.x
//! (sequential response surfaces).

pub mod gaussian;
pub mod models;

use super::{Optimiser, Problem, Recommendation, Stop, Trial};
use math::random::Stream;
use models::Models;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Prior belief: responses at a point in natural units, from fitted surfaces for example. The models
/// then describe the ratio (or difference) between runs and belief.
pub type Trend = Arc<dyn Fn(&[f64]) -> Option<Vec<f64>> + Send + Sync>;

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
    /// Runs per batch after the first design.
    pub batch: usize,
    /// Runs of the first design; the least power of two above the number of factors when left out.
    pub first: Option<usize>,
    /// Half width of the first design, in ranges.
    pub width: f64,
    /// Standard deviation of the batch around the recommended point, in ranges; twice the scatter of a run, at most a
    /// tenth, when left out, so that runs without scatter go straight to the point.
    pub jitter: Option<f64>,
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
            jitter: None,
            runs: 60,
            tolerance: 0.02,
        }
    }
}

/// Standard deviation of a batch where the scatter is unknown, in ranges.
const LARGEST_JITTER: f64 = 0.1;

/// The algorithm's state: all it knows are the runs.
pub struct Surrogate {
    settings: Settings,
    problem: Problem,
    seed: u64,
    /// Runs to learn from: earlier ones first, then its own.
    runs: Vec<Trial>,
    earlier: usize,
    trend: Option<Trend>,
    models: Option<Models>,
    recommended: Option<Recommendation>,
}

impl Surrogate {
    /// A fresh search that already knows some runs.
    pub fn new(settings: &Settings, problem: &Problem, seed: u64, earlier: Vec<Trial>, trend: Option<Trend>) -> Self {
        let mut fresh = Self {
            settings: settings.clone(),
            problem: problem.clone(),
            seed,
            earlier: earlier.len(),
            runs: earlier,
            trend,
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

    /// Whether the models can start without a design: a trend, or as many runs as the design has.
    fn designed(&self) -> bool {
        self.trend.is_some() || self.runs.iter().filter(|run| run.succeeded()).count() >= self.first()
    }

    fn stream(&self, purpose: &str) -> Stream {
        Stream::new(self.seed, purpose, self.own() as u64)
    }

    fn learn(&mut self) {
        let smooth = self.settings.model == Model::GaussianProcess;
        self.models = Models::fit(&self.runs, &self.problem, smooth, self.trend.as_ref());
        if let Some(models) = &self.models {
            self.recommended = Some(models.recommend(&self.runs, &mut self.stream("surrogate recommend")));
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
        let centre = self.problem.start.as_deref().unwrap_or(domain.centre());
        let row = |row| (0..domain.len()).map(|j| centre[j] + level(row, j)).collect::<Vec<_>>();
        let rows: Vec<usize> = (0..size).collect();
        rows.into_iter().map(|i| domain.repair(&row(i))).take(self.first()).collect()
    }

    /// The recommended point, and points around it in pairs on opposite sides.
    fn around(&self, centre: &[f64]) -> Vec<Vec<f64>> {
        let mut random = self.stream("surrogate batch");
        let scatter = self.models.as_ref().and_then(Models::scatter).unwrap_or(LARGEST_JITTER);
        let jitter = self.settings.jitter.unwrap_or((2.0 * scatter).min(LARGEST_JITTER));
        let size = self.settings.batch.max(1);
        let mut batch: Vec<Vec<f64>> = vec![centre.to_vec()];
        while batch.len() < size {
            let step: Vec<f64> = centre.iter().map(|_| jitter * random.normal()).collect();
            for sign in [1.0, -1.0] {
                let moved: Vec<f64> = centre.iter().zip(&step).map(|(u, s)| u + sign * s).collect();
                batch.push(self.problem.domain.repair(&moved));
            }
        }
        batch.truncate(size);
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
            self.problem
                .misfit
                .targets()
                .iter()
                .zip(&r.responses)
                .all(|(target, y)| target.holds([y.low, y.high], self.settings.tolerance))
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
