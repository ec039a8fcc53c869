//! What the runs of a search say about the responses at any point: models over all factors, or the slope of a proportional
//! response.

use super::params::Told;
use super::twin;
use optim::proportional::{AVERAGED, Slopes};
use optim::search::{Knowledge, Method, Run};
use optim::surrogate::Model;
use optim::surrogate::models::Models;
use optim::{Problem, Recommendation, Trial};

/// Number of runs, beyond one for each factor, from which on a model gives intervals.
const SPARE: usize = 3;

/// The responses that the runs lead to expect.
pub(super) enum Seen {
    /// By models of the responses.
    Models(Box<Models>),
    /// By the mean slope of the one response over the one factor.
    Slopes(Box<Problem>, Slopes),
}

impl Seen {
    /// The surrogate predicts with its own models, proportional corrections with their slopes, other methods with models fitted
    /// to their runs. `None` where the runs are too few.
    pub(super) fn of(method: &Method, problem: &Problem, knowledge: &Knowledge, runs: &[Told]) -> Option<Self> {
        let settings = match method {
            Method::Surrogate(settings) => settings,
            Method::Proportional(_) => {
                let slope = |told: &Told| Some(told.responses.as_ref()?[0] / told.point[0]);
                let slopes: Vec<f64> = runs.iter().filter_map(slope).collect();
                return Some(Self::Slopes(Box::new(problem.clone()), Slopes::of(&slopes)?));
            }
            _ if count(runs) < needed(method, problem) => return None,
            _ => return twin::fitted(problem, runs).map(Self::models),
        };
        let trial = |run: Run| {
            let responses = run.responses.unwrap_or_default();
            Trial { point: problem.domain.unit(&run.point), misfit: f64::NAN, responses }
        };
        let all: Vec<Trial> = knowledge.earlier.iter().cloned().chain(runs.iter().map(Told::run)).map(trial).collect();
        let process = settings.model == Model::GaussianProcess;
        Models::fit(&all, problem, process, knowledge.trend.as_ref()).map(Self::models)
    }

    fn models(models: Models) -> Self {
        Self::Models(Box::new(models))
    }

    /// What is expected at a point of the unit box.
    pub(super) fn at(&self, unit: Vec<f64>) -> Recommendation {
        match self {
            Self::Models(models) => models.at(unit),
            Self::Slopes(problem, slopes) => {
                let expected = slopes.expected(problem.domain.natural(&unit)[0]);
                let misfit = problem.misfit.of(&[expected.mean]);
                Recommendation { point: unit, responses: vec![expected], misfit }
            }
        }
    }

    /// The responses that are expected at a point in the factors' units.
    pub(super) fn expected_at(&self, natural: &[f64]) -> Vec<f64> {
        match self {
            Self::Models(models) => models.expected_at(natural),
            Self::Slopes(_, slopes) => vec![slopes.expected(natural[0]).mean],
        }
    }

    /// The scatter of a single run at a point of the unit box, one standard deviation of each response in its unit.
    pub(super) fn deviations(&self, unit: &[f64]) -> Vec<f64> {
        match self {
            Self::Models(models) => models.deviations(unit),
            Self::Slopes(problem, slopes) => vec![slopes.scatter(problem.domain.natural(unit)[0])],
        }
    }
}

fn count(runs: &[Told]) -> usize {
    runs.iter().filter(|told| told.responses.is_some()).count()
}

/// Number of runs with responses from which on there are intervals.
fn needed(method: &Method, problem: &Problem) -> usize {
    match method {
        Method::Proportional(_) => AVERAGED,
        _ => problem.domain.len() + SPARE,
    }
}

/// Why there are no intervals.
pub(super) fn too_few(method: &Method, problem: &Problem, runs: &[Told]) -> String {
    format!("{} runs gave responses, and an interval needs at least {}", count(runs), needed(method, problem))
}

#[cfg(test)]
mod tests {
    use super::*;
    use optim::constraint::{Domain, Factor};
    use optim::misfit::{Denominator, Form, Misfit, Target};
    use optim::proportional::Settings;

    fn told(point: f64, response: f64) -> Told {
        Told { point: vec![point], responses: Some(vec![response]), failure: String::new(), validity: String::new() }
    }

    /// A response that scatters by a quarter says nothing of a bend: models over such runs called a target out of reach.
    #[test]
    fn slopes_reach_every_target_of_a_proportional_response() {
        let domain = Domain::new(vec![Factor::linear("sigma_cn", 1.0, 100.0)], &[]).expect("a box");
        let target = Target::exactly("sigma_t", 9.08, 1.0);
        let misfit = Misfit::new(vec![target], Form::Sum, Denominator::Target).expect("a target");
        let problem = Problem { domain, misfit, start: None };
        let method = Method::Proportional(Settings { runs: 5 });
        let runs: Vec<Told> = [0.40, 0.24, 0.30, 0.35, 0.31].map(|slope| told(28.0, slope * 28.0)).into();
        assert!(Seen::of(&method, &problem, &Knowledge::default(), &runs[..2]).is_none());
        let why = too_few(&method, &problem, &runs[..2]);
        assert_eq!(why, "2 runs gave responses, and an interval needs at least 3");
        let seen = Seen::of(&method, &problem, &Knowledge::default(), &runs).expect("slopes");
        for value in [10.0, 60.0] {
            let found = seen.at(problem.domain.unit(&[value])).responses[0];
            let (mean, half) = (0.32 * value, 0.073_980_670_919_812_02 * value);
            assert!((found.mean - mean).abs() < 1e-9, "{found:?}");
            assert!((found.low - (mean - half)).abs() < 1e-9 && (found.high - (mean + half)).abs() < 1e-9, "{found:?}");
            assert!((seen.expected_at(&[value])[0] - mean).abs() < 1e-9);
        }
        // numpy: np.std([0.40, 0.24, 0.30, 0.35, 0.31], ddof=1)
        let scatter = seen.deviations(&problem.domain.unit(&[10.0]))[0];
        assert!((scatter - 10.0 * 0.059_581_876_439_064_92).abs() < 1e-9, "{scatter}");
    }
}
