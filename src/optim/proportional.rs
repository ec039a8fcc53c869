//! Calibration of one parameter to which one response is proportional.
//!
//! y = K x: from a first value x₁, which a slope known beforehand may give as x₁ = t / K, every further run takes the
//! slope that the last one showed, xᵢ₊₁ = xᵢ t / yᵢ, with the target t. Where proportionality is exact the second run meets
//! the target; the scatter of single packings remains. The tensile strength of a disc of contact bonds against
//! the bond strength is such a response.
//!
//! A run without the response (it failed, or it is not valid and left out) shows no slope, but a proportional response shows
//! the same slope everywhere: the search goes on a tenth above the value, then a tenth below, then farther off. Such runs do
//! not count as runs; after [`MOST_MISSES`] of them in a row the search ends.
//!
//! Source: the two-step calibration of a Brazilian disc, doi:10.1038/s41598-024-61410-x, section 5 (steps b and d, eq. 15).

use super::{Optimiser, Problem, Stop, Trial};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most runs in a row without the response.
pub const MOST_MISSES: u32 = 6;

/// How far off the value the first run after one without the response lies.
const DETOUR: f64 = 1.1;

/// Settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Runs: the first, and those corrected by the one before.
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
    /// Runs that gave the response.
    done: usize,
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
            done: 0,
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
        let wanted = self.problem.misfit.targets()[0].nearest(y);
        self.done += 1;
        // A response of the other sign shows no slope, here or elsewhere.
        if !(y * wanted > 0.0) {
            self.stopped = Some(Stop::NoSlope);
            return;
        }
        (self.next, self.misses) = (tried * wanted / y, 0);
        self.missed.clear();
        if self.done >= self.settings.runs {
            self.stopped = Some(Stop::Iterations);
        } else if self.point() == trial.point {
            self.stopped = Some(Stop::Collapsed);
        }
    }

    fn stop(&self) -> Option<Stop> {
        self.stopped
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
}
