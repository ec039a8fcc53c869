//! Calibration of one parameter to which one response is proportional.
//!
//! y = K x: from a first value x₁, which a slope known beforehand may give as x₁ = t / K, every further run takes the
//! mean of the slopes that the runs so far have shown, xᵢ₊₁ = t / mean(yⱼ / xⱼ), with the target t. Where proportionality is
//! exact the second run meets the target. The tensile strength of a disc of contact bonds against the bond strength is such a
//! response.
//!
//! Packings scatter: of two runs, as published, the better one is the recommended point, and luck decides which that is. With
//! three runs and more the recommended point is the one at which the mean slope meets the target, with the interval of
//! that mean.
//!
//! A run without the response (it failed, or it is not valid and left out) shows no slope, but a proportional response shows
//! the same slope everywhere: the search goes on a tenth above the value, then a tenth below, then farther off. Such runs do
//! not count as runs; after [`MOST_MISSES`] of them in a row the search ends.
//!
//! Source: the two-step calibration of a Brazilian disc, doi:10.1038/s41598-024-61410-x, section 5 (steps b and d, eq. 15).

use super::{Interval, Optimiser, Problem, Recommendation, Stop, Trial};
use math::sample::Moments;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most runs in a row without the response.
pub const MOST_MISSES: u32 = 6;

/// How far off the value the first run after one without the response lies.
const DETOUR: f64 = 1.1;

/// Fewest runs whose slopes are averaged; of fewer the best run is recommended.
pub const AVERAGED: usize = 3;

/// Settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Runs: the first, and those corrected by the ones before.
    pub runs: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { runs: 2 }
    }
}

/// The method's state.
pub struct Proportional {
    settings: Settings,
    problem: Problem,
    /// The value that is wanted next, natural units.
    next: f64,
    /// Slopes of the runs that gave the response.
    slopes: Vec<f64>,
    /// Runs without the response since the last that gave it.
    misses: u32,
    /// The points of those runs.
    missed: Vec<Vec<f64>>,
    stopped: Option<Stop>,
}

impl Proportional {
    /// A fresh search; it begins at the problem's first guess, or in the middle.
    ///
    /// # Panics
    /// The problem has more than one factor or target, which whoever makes it must refuse.
    pub fn new(settings: &Settings, problem: &Problem) -> Self {
        let (factors, targets) = (problem.domain.len(), problem.misfit.targets().len());
        assert!(factors == 1 && targets == 1, "BUG: one factor and one response, not {factors} and {targets}");
        let first = problem.start.as_deref().unwrap_or(problem.domain.centre());
        let next = problem.domain.natural(first)[0];
        Self {
            settings: settings.clone(),
            problem: problem.clone(),
            next,
            slopes: vec![],
            misses: 0,
            missed: vec![],
            stopped: None,
        }
    }

    /// The point that is tried next: the wanted value, or one beside it after runs without the response.
    fn point(&self) -> Vec<f64> {
        let factor = (0..self.misses.div_ceil(2)).fold(1.0, |factor, _| factor * DETOUR);
        let value = if self.misses % 2 == 1 { self.next * factor } else { self.next / factor };
        self.problem.domain.repair(&self.problem.domain.unit(&[value]))
    }

    /// Goes beside the wanted value after a run without the response; the ends of the range are tried once.
    fn go_beside(&mut self, tried: &[f64]) {
        self.missed.push(tried.to_vec());
        loop {
            self.misses += 1;
            if self.misses > MOST_MISSES {
                self.stopped = Some(Stop::NoSlope);
                return;
            }
            if !self.missed.contains(&self.point()) {
                return;
            }
        }
    }
}

impl Optimiser for Proportional {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        vec![self.point()]
    }

    fn tell(&mut self, trials: &[Trial]) {
        let trial = &trials[0];
        let tried = self.problem.domain.natural(&trial.point)[0];
        let Some(&y) = trial.responses.first() else { return self.go_beside(&trial.point) };
        let target = &self.problem.misfit.targets()[0];
        let wanted = target.nearest(y);
        self.slopes.push(y / tried);
        // A response of the other sign shows no slope, here or elsewhere.
        if !(y * wanted > 0.0) {
            self.stopped = Some(Stop::NoSlope);
            return;
        }
        self.next = match self.slopes.len() {
            // As published: a mean of one slope would differ in its last digit, and that is another simulation.
            1 => tried * wanted / y,
            _ => {
                let slope = Moments::of(&self.slopes).mean;
                target.nearest(slope * tried) / slope
            }
        };
        self.misses = 0;
        self.missed.clear();
        if self.slopes.len() >= self.settings.runs {
            self.stopped = Some(Stop::Iterations);
        } else if self.point() == trial.point {
            self.stopped = Some(Stop::Collapsed);
        }
    }

    fn stop(&self) -> Option<Stop> {
        self.stopped
    }

    fn recommended(&self) -> Option<Recommendation> {
        let slopes = Slopes::of(&self.slopes)?;
        let point = self.problem.domain.repair(&self.problem.domain.unit(&[self.next]));
        let response = slopes.expected(self.problem.domain.natural(&point)[0]);
        Some(Recommendation { point, misfit: self.problem.misfit.of(&[response.mean]), responses: vec![response] })
    }
}

/// The slopes that runs have shown, response per unit of the factor.
pub struct Slopes {
    mean: f64,
    /// Half the 95 % interval of the mean.
    half: f64,
    /// Standard deviation of one slope.
    deviation: f64,
}

impl Slopes {
    /// The mean of these slopes; `None` for fewer than [`AVERAGED`], and where they have not all one sign: then the response is
    /// not proportional.
    pub fn of(slopes: &[f64]) -> Option<Self> {
        let one_sign = slopes.iter().all(|slope| slope.is_finite() && slope * slopes[0] > 0.0);
        if slopes.len() < AVERAGED || !one_sign {
            return None;
        }
        let moments = Moments::of(slopes);
        Some(Self { mean: moments.mean, half: moments.half_interval()?, deviation: moments.deviation? })
    }

    /// The mean response to a value of the factor.
    pub fn expected(&self, value: f64) -> Interval {
        let (mean, half) = (self.mean * value, self.half * value.abs());
        Interval { mean, low: mean - half, high: mean + half }
    }

    /// Standard deviation of one response to a value of the factor.
    pub fn scatter(&self, value: f64) -> f64 {
        self.deviation * value.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::{Domain, Factor};
    use crate::misfit::{Denominator, Form, Misfit, Target};
    use crate::search::{Limits, Method, minimise};

    fn problem(start: f64) -> Problem {
        let domain = Domain::new(vec![Factor::linear("sigma_cn", 1.0, 60.0)], &[]).expect("a box");
        let start = Some(domain.unit(&[start]));
        let target = Target::exactly("sigma_t", 9.08, 1.0);
        Problem { domain, misfit: Misfit::new(vec![target], Form::Sum, Denominator::Target).expect("a target"), start }
    }

    /// The paper's pair of R_min 0.135 mm and R_max/R_min = 1.5, K′ = 0.8033 beforehand and 0.7419 found: 9.08 · 2.5 / 0.8033 MPa gives
    /// 8.386 MPa, and the corrected 9.08 · 2.5 / 0.7419 MPa the target.
    #[test]
    fn two_runs_meet_the_target_of_a_proportional_response() {
        let mut tried = Vec::new();
        let method = Method::Proportional(Settings::default());
        let first = 9.08 * 2.5 / 0.8033;
        let (stop, state) = minimise(&problem(first), &method, &Limits::default(), 1, |x| {
            tried.push(x[0]);
            Some(vec![0.7419 * x[0] / 2.5])
        });
        assert_eq!((stop, state.evaluations), (Stop::Iterations, 2));
        // Printed: 28.26 MPa.
        assert!((tried[0] - 28.26).abs() < 0.005 && (tried[1] - 9.08 * 2.5 / 0.7419).abs() < 1e-9, "{tried:?}");
        assert!(state.best.is_some_and(|best| best.misfit < 1e-12));
    }

    #[test]
    fn a_target_beyond_the_range_ends_at_its_end_and_one_of_the_other_sign_at_once() {
        let method = Method::Proportional(Settings { runs: 10 });
        let (stop, state) = minimise(&problem(10.0), &method, &Limits::default(), 1, |x| Some(vec![0.01 * x[0]]));
        assert_eq!((stop, state.evaluations), (Stop::Collapsed, 2));
        assert_eq!(state.best.map(|best| best.point), Some(vec![1.0]));
        let (stop, state) = minimise(&problem(10.0), &method, &Limits::default(), 1, |x| Some(vec![-x[0]]));
        assert_eq!((stop, state.evaluations), (Stop::NoSlope, 1));
    }

    #[test]
    fn runs_without_the_response_are_passed_and_do_not_count() {
        let method = Method::Proportional(Settings::default());
        let mut tried = Vec::new();
        let (stop, state) = minimise(&problem(20.0), &method, &Limits::default(), 1, |x| {
            tried.push(x[0]);
            (tried.len() > 2).then(|| vec![0.3 * x[0]])
        });
        assert_eq!((stop, state.evaluations), (Stop::Iterations, 4));
        for (found, wanted) in tried.iter().zip([20.0, 22.0, 20.0 / 1.1, 9.08 / 0.3]) {
            assert!((found - wanted).abs() < 1e-9, "{tried:?}");
        }
        // At the upper end of the range only values below are left.
        tried.clear();
        let (stop, _) = minimise(&problem(60.0), &method, &Limits::default(), 1, |x| {
            tried.push(x[0]);
            None
        });
        assert_eq!(stop, Stop::NoSlope);
        let below = [60.0, 60.0 / 1.1, 60.0 / 1.21, 60.0 / 1.331];
        assert!(tried.len() == 4 && tried.iter().zip(below).all(|(a, b)| (a - b).abs() < 1e-9), "{tried:?}");
    }

    #[test]
    fn slopes_of_both_signs_have_no_mean() {
        assert!(Slopes::of(&[0.30, 0.31, 0.29]).is_some());
        for others in [-0.1, 0.0, f64::NAN, f64::INFINITY] {
            assert!(Slopes::of(&[0.30, 0.31, others]).is_none(), "{others}");
        }
    }

    /// numpy 2.4.6 and scipy 1.17.1 of the slopes: `k.mean()`, `t.ppf(0.975, 4) * k.std(ddof=1) / 5**0.5`.
    #[test]
    fn slopes_that_scatter_are_averaged_and_the_recommended_point_has_their_interval() {
        let slopes = [0.40, 0.24, 0.30, 0.35, 0.31];
        let mut tried = Vec::new();
        let method = Method::Proportional(Settings { runs: 5 });
        let (stop, state) = minimise(&problem(28.0), &method, &Limits::default(), 1, |x| {
            tried.push(x[0]);
            Some(vec![slopes[tried.len() - 1] * x[0]])
        });
        assert_eq!((stop, state.evaluations), (Stop::Iterations, 5));
        for (found, slope) in tried[1..].iter().zip([0.40, 0.32, 0.94 / 3.0, 0.3225]) {
            assert!((found - 9.08 / slope).abs() < 1e-9, "{tried:?}");
        }
        let problem = problem(28.0);
        let own = state.recommended.expect("a recommendation");
        let value = problem.domain.natural(&own.point)[0];
        assert!((value - 9.08 / 0.32).abs() < 1e-9 && own.misfit < 1e-12, "{own:?}");
        let half = 0.073_980_670_919_812_02 / 0.32 * 9.08;
        let Interval { mean, low, high } = own.responses[0];
        assert!((mean - 9.08).abs() < 1e-12, "{mean}");
        assert!((high - mean - half).abs() < 1e-9 && (mean - low - half).abs() < 1e-9, "{low} {high} {half}");
    }
}
