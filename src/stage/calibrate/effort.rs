//! Effort: the number of evaluations until the responses were near the targets.

use super::solved::{Effort, Line};
use crate::artifact::calibration::Percents;
use optim::{Problem, Recommendation};

impl Effort {
    /// From the history of one search, its recommendation after the batch of each evaluation, and the number of evaluations
    /// after each batch: a recommendation costs its whole batch.
    pub(super) fn of(
        problem: &Problem,
        lines: &[Line],
        recommended: &[Option<Recommendation>],
        ends: &[usize],
    ) -> Self {
        let worst = |responses: &[f64]| {
            let deviations = problem.misfit.deviations(responses);
            deviations.iter().fold(0.0_f64, |worst, d| if d.is_nan() { f64::INFINITY } else { worst.max(d.abs()) })
        };
        let expected = |own: &Option<Recommendation>| {
            let means = |own: &Recommendation| own.responses.iter().map(|y| y.mean).collect::<Vec<_>>();
            own.as_ref().map_or(f64::INFINITY, |own| worst(&means(own)))
        };
        let seen: Vec<f64> = lines.iter().map(|line| worst(&line.responses)).collect();
        let expected: Vec<f64> = recommended.iter().map(expected).collect();
        let first = |level: f64| seen.iter().position(|worst| *worst <= level).map(|i| lines[i].evaluation);
        let stays = |level: f64| {
            let last = expected.iter().rposition(|worst| *worst > level).map_or(0, |i| i + 1);
            let batch = || ends.iter().copied().find(|end| *end > last);
            if last < expected.len() { batch() } else { None }
        };
        let levels = Percents::LEVELS.map(|percent| f64::from(percent) / 100.0);
        Self { seen: levels.map(first), settled: levels.map(stays) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use optim::Interval;
    use optim::constraint::{Domain, Factor};
    use optim::misfit::{Denominator, Form, Misfit, Target};

    #[test]
    fn effort_counts_to_the_first_run_and_to_where_the_expectation_stays() {
        let targets = vec![Target::exactly("UCS", 100.0, 1.0), Target::exactly("E", 10.0, 1.0)];
        let problem = Problem {
            domain: Domain::new(vec![Factor::linear("x", 0.0, 1.0)], &[]).unwrap(),
            misfit: Misfit::new(targets, Form::Sum, Denominator::Target).unwrap(),
            start: None,
        };
        let runs = [[150.0, 10.0], [f64::NAN, f64::NAN], [108.0, 10.9], [101.0, 10.4], [120.0, 10.0]];
        let line = |(i, responses): (usize, &[f64; 2])| Line {
            evaluation: i + 1,
            coarse: false,
            point: vec![0.5],
            responses: responses.to_vec(),
            misfit: 0.0,
            best: 0.0,
            recommended: 0.0,
            failure: String::new(),
            validity: String::new(),
        };
        let lines: Vec<Line> = runs.iter().enumerate().map(line).collect();
        let own = |worst: f64| {
            let at = |mean: f64| Interval { mean, low: mean, high: mean };
            let responses = vec![at(100.0 * (1.0 + worst)), at(10.0)];
            Some(Recommendation { point: vec![0.5], responses, misfit: worst })
        };
        let recommended = [None, own(0.3), own(0.04), own(0.07), own(0.03)];
        let effort = Effort::of(&problem, &lines, &recommended, &[1, 2, 3, 4, 5]);
        assert_eq!(effort.seen, [Some(3), Some(4), None]);
        assert_eq!(effort.settled, [Some(3), Some(5), None]);
        // Two batches, of three and two evaluations.
        let recommended = [own(0.08), own(0.08), own(0.08), own(0.01), own(0.01)];
        let effort = Effort::of(&problem, &lines, &recommended, &[3, 5]);
        assert_eq!(effort.settled, [Some(3), Some(5), Some(5)]);
    }
}
