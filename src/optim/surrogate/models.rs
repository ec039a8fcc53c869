//! The fitted models of all responses over all runs, and the chance of failure.

use super::Trend;
use super::gaussian::Gaussian;
use crate::constraint::Factor;
use crate::solution_set::descend;
use crate::{Interval, Problem, Recommendation, Trial};
use math::elementary::{exp, ln};
use math::random::Stream;
use math::scale::Scale as FactorScale;

/// Distance over which a failed run warns, in half ranges and per root of the number of factors.
const WARNING: f64 = 0.35;
/// How much a sure failure multiplies the misfit.
const PENALTY: f64 = 10.0;
/// Random points from which the recommended point is sought, and how many of the best are refined.
const STARTS: usize = 300;
const REFINED: usize = 3;
/// Normal quantile of a 95 % interval.
const WIDE: f64 = 1.96;

/// How a coordinate is modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// (x − centre) / width
    Linear { centre: f64, width: f64 },
    /// (ln x − centre) / width
    Logarithm { centre: f64, width: f64 },
}

impl Scale {
    /// Codes a factor's range to −1 … 1; by logarithms when it is searched so, or its ends are positive and apart by a
    /// factor of two.
    fn factor(factor: &Factor) -> Self {
        let (low, high) = (factor.low, factor.high);
        if factor.scale == FactorScale::Log || low > 0.0 && high / low >= 2.0 {
            let (low, high) = (ln(low), ln(high));
            Self::Logarithm { centre: 0.5 * (low + high), width: 0.5 * (high - low) }
        } else {
            Self::Linear { centre: 0.5 * (low + high), width: 0.5 * (high - low) }
        }
    }

    /// Codes a response: by logarithms when all are positive, else by their mean and spread.
    fn response(values: &[f64], target: f64) -> Self {
        let n = values.len().max(1) as f64;
        let mean = |part: &mut dyn Iterator<Item = f64>| part.sum::<f64>() / n;
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

/// One response: its scale and the process of its coded values, or of what a trend leaves of them.
struct Response {
    scale: Scale,
    process: Option<Gaussian>,
}

/// The models of all responses, and of failure.
pub struct Models {
    problem: Problem,
    trend: Option<Trend>,
    factors: Vec<Scale>,
    responses: Vec<Response>,
    failed: Vec<Vec<f64>>,
    succeeded: Vec<Vec<f64>>,
}

impl Models {
    /// Models over all runs; a response that a run lacks is NaN there. None without runs to go by: a response that no
    /// run has, and no trend.
    pub fn fit(runs: &[Trial], problem: &Problem, smooth: bool, trend: Option<&Trend>) -> Option<Self> {
        let factors: Vec<Scale> = problem.domain.factors().iter().map(Scale::factor).collect();
        let (good, bad): (Vec<&Trial>, Vec<&Trial>) = runs.iter().partition(|run| run.succeeded());
        let coded = |runs: &[&Trial]| -> Vec<Vec<f64>> {
            runs.iter().map(|run| code(&factors, &problem.domain.natural_beyond(&run.point))).collect()
        };
        let (succeeded, failed) = (coded(&good), coded(&bad));
        let mut fresh = Self {
            problem: problem.clone(),
            trend: trend.cloned(),
            factors,
            responses: Vec::new(),
            failed,
            succeeded: succeeded.clone(),
        };
        for k in 0..problem.misfit.targets().len() {
            let response = fresh.response(k, &good, &succeeded, smooth)?;
            fresh.responses.push(response);
        }
        Some(fresh)
    }

    fn response(&self, k: usize, good: &[&Trial], coded: &[Vec<f64>], smooth: bool) -> Option<Response> {
        let target = self.problem.misfit.targets()[k].value();
        let mut rows: Vec<(Vec<f64>, f64, Option<f64>)> = Vec::new();
        for (run, z) in good.iter().zip(coded).filter(|(run, _)| run.responses[k].is_finite()) {
            let expected = match &self.trend {
                Some(trend) => Some(trend(&self.problem.domain.natural_beyond(&run.point))?[k]),
                None => None,
            };
            rows.push((z.clone(), run.responses[k], expected));
        }
        let values: Vec<f64> = rows.iter().flat_map(|row| [Some(row.1), row.2]).flatten().collect();
        let scale = Scale::response(&values, target);
        if rows.is_empty() {
            return self.trend.is_some().then_some(Response { scale, process: None });
        }
        let points: Vec<Vec<f64>> = rows.iter().map(|row| row.0.clone()).collect();
        let left = |row: &(Vec<f64>, f64, Option<f64>)| scale.code(row.1) - row.2.map_or(0.0, |t| scale.code(t));
        let left: Vec<f64> = rows.iter().map(left).collect();
        Some(Response { scale, process: Some(Gaussian::fit(&points, &left, smooth, self.trend.is_some())?) })
    }

    /// Mean and variance of the expected responses at a point of the unit box, in coded units.
    fn predict(&self, unit: &[f64]) -> Vec<(f64, f64)> {
        let natural = self.problem.domain.natural(unit);
        let z = code(&self.factors, &natural);
        let trend = self.trend.as_ref().map(|trend| trend(&natural));
        let one = |(k, response): (usize, &Response)| {
            let (mean, variance) = response.process.as_ref().map_or((0.0, 0.0), |process| process.predict(&z));
            let level = match &trend {
                Some(Some(values)) => response.scale.code(values[k]),
                Some(None) => f64::NAN,
                None => 0.0,
            };
            (mean + level, variance)
        };
        self.responses.iter().enumerate().map(one).collect()
    }

    /// The expected responses at a point of the unit box.
    pub fn expected(&self, unit: &[f64]) -> Vec<f64> {
        self.responses.iter().zip(self.predict(unit)).map(|(r, (mean, _))| r.scale.decode(mean)).collect()
    }

    /// The expected responses at a point in natural units, which may lie outside the box.
    pub fn expected_at(&self, natural: &[f64]) -> Vec<f64> {
        self.expected(&self.problem.domain.unit(natural))
    }

    /// The scatter of a single run around the expected response at a point of the unit box, one standard deviation of
    /// each response in its unit.
    pub fn deviations(&self, unit: &[f64]) -> Vec<f64> {
        let one = |(response, (mean, _)): (&Response, (f64, f64))| {
            let noise = response.process.as_ref().map_or(f64::NAN, |process| process.sizes().noise);
            match response.scale {
                Scale::Linear { width, .. } => noise * width,
                Scale::Logarithm { width, .. } => response.scale.decode(mean) * noise * width,
            }
        };
        self.responses.iter().zip(self.predict(unit)).map(one).collect()
    }

    /// The largest scatter of a single run among the responses, in their coded units (logarithms: relative).
    pub fn scatter(&self) -> Option<f64> {
        self.responses.iter().filter_map(|r| r.process.as_ref()).map(|p| p.sizes().noise).reduce(f64::max)
    }

    /// Chance of failure: the weight of failed neighbours against that of successful ones and one success beforehand.
    pub fn failure(&self, unit: &[f64]) -> f64 {
        if self.failed.is_empty() {
            return 0.0;
        }
        let z = code(&self.factors, &self.problem.domain.natural(unit));
        let near = |p: &Vec<f64>| {
            let distance: f64 = p.iter().zip(&z).map(|(a, b)| (a - b) * (a - b)).sum();
            exp(-0.5 * distance / (WARNING * WARNING * z.len() as f64))
        };
        let bad: f64 = self.failed.iter().map(near).sum();
        let good: f64 = self.succeeded.iter().map(near).sum();
        bad / (bad + good + 1.0)
    }

    /// The misfit, with uncertainty counted as deviation, and with the chance of failure.
    fn risk(&self, unit: &[f64]) -> f64 {
        let misfit = &self.problem.misfit;
        let (mut expected, mut beyond) = (Vec::new(), Vec::new());
        for (response, (mean, variance)) in self.responses.iter().zip(self.predict(unit)) {
            expected.push(response.scale.decode(mean));
            beyond.push(response.scale.decode(mean + variance.sqrt()));
        }
        let pairs = misfit.deviations(&expected).into_iter().zip(misfit.deviations(&beyond));
        let total: Vec<f64> = pairs.map(|(d, b)| (d * d + (b - d) * (b - d)).sqrt()).collect();
        let value = misfit.combine(&total) * (1.0 + PENALTY * self.failure(unit));
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// The point of least risk, the best of many points refined by descent, and what is expected there.
    pub fn recommend(&self, runs: &[Trial], random: &mut Stream) -> Recommendation {
        let domain = &self.problem.domain;
        let mut starts: Vec<Vec<f64>> = (0..STARTS).map(|_| domain.sample(random)).collect();
        starts.extend(runs.iter().map(|run| domain.repair(&run.point)));
        starts.push(domain.centre().to_vec());
        let mut ranked: Vec<(f64, Vec<f64>)> = starts.into_iter().map(|u| (self.risk(&u), u)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.truncate(REFINED);
        let refined = ranked.into_iter().map(|(risk, from)| descend(domain, &from, risk, &|u| self.risk(u)));
        let best = refined.reduce(|best, this| if this.1 < best.1 { this } else { best });
        let (point, _) = best.unwrap_or_else(|| panic!("BUG: there is always the centre"));
        self.at(point)
    }

    /// The prediction at a point of the unit box.
    pub fn at(&self, point: Vec<f64>) -> Recommendation {
        let interval = |(response, (mean, variance)): (&Response, (f64, f64))| {
            let half = WIDE * variance.sqrt();
            let at = |coded| response.scale.decode(coded);
            Interval { mean: at(mean), low: at(mean - half), high: at(mean + half) }
        };
        let responses: Vec<Interval> = self.responses.iter().zip(self.predict(&point)).map(interval).collect();
        let misfit = self.problem.misfit.of(&responses.iter().map(|y| y.mean).collect::<Vec<_>>());
        Recommendation { point, responses, misfit }
    }
}

fn code(scales: &[Scale], natural: &[f64]) -> Vec<f64> {
    scales.iter().zip(natural).map(|(scale, &x)| scale.code(x)).collect()
}
