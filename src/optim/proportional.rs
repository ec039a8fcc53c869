//! Calibration of one parameter to which one response is proportional.
//!
//! y = K x: from a first value x₁, which a slope known beforehand may give as x₁ = t / K, every further run takes the
//! slope that the last one showed, xᵢ₊₁ = xᵢ t / yᵢ, with the target t. Where proportionality is exact the second run meets
//! the target; the scatter of single packings remains. The tensile strength of a disc of contact bonds against
//! the bond strength is such a response.
//!
//! Source: the two-step calibration of a Brazilian disc, doi:10.1038/s41598-024-61410-x, section 5 (steps b and d, eq. 15).

use super::{Optimiser, Problem, Stop, Trial};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// The next value, natural units.
    next: f64,
    done: usize,
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
        Self { settings: settings.clone(), problem: problem.clone(), next, done: 0, stopped: None }
    }
}

impl Optimiser for Proportional {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        vec![self.problem.domain.repair(&self.problem.domain.unit(&[self.next]))]
    }

    fn tell(&mut self, trials: &[Trial]) {
        let trial = &trials[0];
        self.done += 1;
        let tried = self.problem.domain.natural(&trial.point)[0];
        let wanted = trial.responses.first().map(|&y| (y, self.problem.misfit.targets()[0].nearest(y)));
        match wanted {
            Some((y, wanted)) if y * wanted > 0.0 => self.next = tried * wanted / y,
            // A run without the response, or one of the other sign, shows no slope.
            Some(_) | None => self.stopped = Some(Stop::Stalled),
        }
        let unit = self.problem.domain.repair(&self.problem.domain.unit(&[self.next]));
        if self.done >= self.settings.runs {
            self.stopped.get_or_insert(Stop::Iterations);
        }
        if unit == trial.point {
            self.stopped.get_or_insert(Stop::Collapsed);
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
    fn a_target_beyond_the_range_ends_at_its_end_and_a_failed_run_ends_at_once() {
        let method = Method::Proportional(Settings { runs: 10 });
        let (stop, state) = minimise(&problem(10.0), &method, &Limits::default(), 1, |x| Some(vec![0.01 * x[0]]));
        assert_eq!((stop, state.evaluations), (Stop::Collapsed, 2));
        assert_eq!(state.best.map(|best| best.point), Some(vec![1.0]));
        let (stop, state) = minimise(&problem(10.0), &method, &Limits::default(), 1, |_| None);
        assert_eq!((stop, state.evaluations), (Stop::Stalled, 1));
    }
}
