//! All the parameters that meet the targets, when there is more than one answer.
//!
//! Three targets leave a four-dimensional set of seven parameters free. From one minimiser of the misfit:
//! * the **chosen** point is the solution nearest a preference, by default the centre of the box: minimise ‖u − p‖
//!   subject to the responses of the minimiser, by sequential linearisation; each step is one
//!   [`least_distance`](super::least_distance) problem, halved while it makes the responses worse than they were;
//! * the **sample** takes the solutions nearest random points of the domain;
//! * the number of **free** directions is d minus the rank of the sensitivities there;
//! * the **reach** of every response over the domain shows which target cannot be met by itself, and how near one
//!   can get; where each can be met alone the misfit that is left is a conflict between them.
//!
//! It asks the model far more often than a simulation could bear: give it fitted surfaces.
//!
//! Source: Nocedal & Wright, *Numerical Optimization* (2006, doi:10.1007/978-0-387-40065-5), chapter 18.

use super::constraint::Domain;
use super::level::{Level, rank};
use super::local::Local;
use super::misfit::Target;
use super::{Optimiser, Problem, Trial};
use math::random::Stream;

/// A model that answers at once: natural units in, responses in the order of the targets out.
pub type Model<'a> = dyn Fn(&[f64]) -> Option<Vec<f64>> + 'a;

/// The solutions of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionSet {
    /// The solution nearest the preference, in the unit box.
    pub chosen: Vec<f64>,
    /// Responses there.
    pub responses: Vec<f64>,
    /// Misfit there.
    pub misfit: f64,
    /// Directions in which the parameters can be changed without changing a response.
    pub free: usize,
    /// Other solutions, in the unit box.
    pub sample: Vec<Vec<f64>>,
    /// What each response can be over the domain.
    pub reach: Vec<Reach>,
}

/// Least and greatest value of a response over the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// The target of the response.
    pub target: Target,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

impl Reach {
    /// The value nearest the target.
    pub fn nearest(&self) -> f64 {
        if self.low > self.target.high {
            self.low
        } else if self.high < self.target.low {
            self.high
        } else {
            self.target.value().clamp(self.low, self.high)
        }
    }

    /// Whether the target can be met by itself.
    pub fn holds_target(&self) -> bool {
        self.low <= self.target.high && self.high >= self.target.low
    }
}

/// Explores the solutions around a minimiser `best` (unit box).
pub fn explore(
    problem: &Problem,
    model: &Model,
    best: &[f64],
    preference: Option<&[f64]>,
    size: usize,
    seed: u64,
) -> Option<SolutionSet> {
    let domain = &problem.domain;
    let found = model(&domain.natural(best))?;
    let wanted: Vec<[f64; 2]> = problem.misfit.targets().iter().map(|t| [t.low, t.high]).collect();
    // The targets themselves where they can be met, else the responses of the best point.
    let at_target = Level { domain, model, wanted };
    let exact = at_target.nearest(best, best).filter(|u| at_target.is_met(u));
    let level = match exact.is_some() {
        true => at_target,
        false => Level { wanted: found.iter().map(|&y| [y, y]).collect(), ..at_target },
    };
    let anchor = exact.unwrap_or_else(|| best.to_vec());

    let preference = preference.map_or_else(|| domain.centre().to_vec(), |p| domain.repair(p));
    let met = |u: Option<Vec<f64>>| u.filter(|u| level.is_met(u));
    let chosen = met(level.nearest(&anchor, &preference)).unwrap_or_else(|| anchor.clone());
    let mut random = Stream::new(seed, "solution set", 0);
    let points: Vec<Vec<f64>> = (0..size).map(|_| domain.sample(&mut random)).collect();
    let sample = points.iter().filter_map(|p| met(level.nearest(&chosen, p))).collect();
    let responses = model(&domain.natural(&chosen))?;
    Some(SolutionSet {
        misfit: problem.misfit.of(&responses),
        free: domain.len() - rank(&level.active(&chosen)?, domain.len()),
        reach: reach(problem, model, &mut random),
        chosen,
        responses,
        sample,
    })
}

/// Least and greatest value of every response: random points, the best of them refined by descent.
fn reach(problem: &Problem, model: &Model, random: &mut Stream) -> Vec<Reach> {
    let domain = &problem.domain;
    let starts: Vec<Vec<f64>> = (0..400).map(|_| domain.sample(random)).collect();
    let targets = problem.misfit.targets().iter().enumerate();
    targets
        .map(|(k, target)| {
            let extreme = |sign: f64| {
                let size = target.value().abs();
                let scale = if size == 0.0 { sign } else { sign / size };
                let value = |u: &[f64]| model(&domain.natural(u)).map_or(f64::INFINITY, |y| y[k] * scale);
                lowest(domain, &starts, &value) / scale
            };
            Reach { target: target.clone(), low: extreme(1.0), high: extreme(-1.0) }
        })
        .collect()
}

/// The least value found from the best few of many points.
fn lowest(domain: &Domain, starts: &[Vec<f64>], value: &dyn Fn(&[f64]) -> f64) -> f64 {
    let mut ranked: Vec<(f64, &Vec<f64>)> = starts.iter().map(|u| (value(u), u)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let descents = ranked.iter().take(4).map(|(start, from)| descend(domain, from, *start, value).1);
    descents.fold(ranked[0].0, f64::min)
}

/// The end of a descent of a function that answers at once.
pub(super) fn descend(domain: &Domain, from: &[f64], start: f64, value: &dyn Fn(&[f64]) -> f64) -> (Vec<f64>, f64) {
    let mut descent = Local::new(domain, from, start);
    while descent.stop().is_none() {
        let trial = |point: Vec<f64>| Trial { misfit: value(&point), point, responses: Vec::new() };
        let trials: Vec<Trial> = descent.ask().into_iter().map(trial).collect();
        descent.tell(&trials);
    }
    let (point, misfit) = descent.best();
    (point.to_vec(), misfit)
}

#[cfg(test)]
mod tests {
    use super::super::benchmark;
    use super::super::misfit::{Denominator, Form, Misfit};
    use super::super::{constraint::Factor, genetic, search};
    use super::*;

    fn plane(target: f64) -> Problem {
        let factor = |name: &str| Factor::linear(name, 0.0, 1.0);
        let target = Target::exactly("y", target, 1.0);
        Problem {
            domain: Domain::new(vec![factor("a"), factor("b")], &[]).expect("a box"),
            misfit: Misfit::new(vec![target], Form::Sum, Denominator::Target).expect("a target"),
            start: None,
        }
    }

    /// a b = ¼ comes nearest the centre at a = b = ½, and nearest (1, 1) there too; nearest (1, 0) it ends at a = 1.
    #[test]
    fn the_nearest_solution_of_a_hyperbola_is_the_known_one() {
        let product = |x: &[f64]| Some(vec![x[0] * x[1]]);
        let set = explore(&plane(0.25), &product, &[1.0, 0.25], None, 50, 1).expect("solutions");
        assert!(set.chosen.iter().all(|u| (u - 0.5).abs() < 1e-6), "{:?}", set.chosen);
        assert_eq!((set.free, set.sample.len()), (1, 50));
        assert!(set.sample.iter().all(|u| (u[0] * u[1] - 0.25).abs() < 1e-6));
        let corner = explore(&plane(0.25), &product, &[0.5, 0.5], Some(&[1.0, 0.0]), 0, 1).expect("solutions");
        assert!((corner.chosen[0] - 1.0).abs() < 1e-6 && (corner.chosen[1] - 0.25).abs() < 1e-6, "{:?}", corner.chosen);
    }

    #[test]
    fn an_unreachable_target_is_named_with_the_nearest_value() {
        let product = |x: &[f64]| Some(vec![x[0] * x[1]]);
        let set = explore(&plane(3.0), &product, &[1.0, 1.0], None, 5, 1).expect("a best point");
        assert!(!set.reach[0].holds_target());
        assert!((set.reach[0].nearest() - 1.0).abs() < 1e-9 && set.reach[0].low.abs() < 1e-9);
        assert!((set.misfit - 2.0 / 3.0).abs() < 1e-9);
    }

    /// Of "at least ¼" the centre itself is a solution, and nothing is tied there; beyond the reach the nearest is returned.
    #[test]
    fn a_band_leaves_free_what_lies_within() {
        let product = |x: &[f64]| Some(vec![x[0] * x[1]]);
        let at_least = |low: f64| {
            let misfit =
                Misfit::new(vec![Target::band("y", [low, f64::INFINITY], 1.0)], Form::Sum, Denominator::Target);
            Problem { misfit: misfit.expect("a target"), ..plane(1.0) }
        };
        let set = explore(&at_least(0.2), &product, &[1.0, 0.9], None, 20, 1).expect("solutions");
        assert_eq!((set.chosen, set.free), (vec![0.5, 0.5], 2));
        assert!(set.sample.len() >= 18 && set.sample.iter().all(|u| u[0] * u[1] >= 0.2 - 1e-6));
        let high = explore(&at_least(0.64), &product, &[1.0, 0.9], None, 0, 1).expect("solutions");
        assert!(high.chosen.iter().all(|u| (u - 0.8).abs() < 1e-6) && high.free == 1, "{high:?}");
        let beyond = explore(&at_least(2.0), &product, &[1.0, 1.0], None, 0, 1).expect("a best point");
        assert!(!beyond.reach[0].holds_target() && (beyond.reach[0].nearest() - 1.0).abs() < 1e-9);
    }

    /// Seven parameters and three targets leave four free directions on the paper's surfaces.
    #[test]
    fn the_published_surfaces_leave_four_directions_free() {
        let problem = benchmark::su2021(1, Form::Sum, Denominator::Computed);
        let model = |x: &[f64]| Some(benchmark::surfaces(x));
        let method = search::Method::Genetic(genetic::Settings::su2021());
        let (_, state) = search::minimise(&problem, &method, &search::Limits::default(), 1, model);
        let best = state.best.expect("a best point").point;
        let set = explore(&problem, &model, &best, None, 40, 1).expect("solutions");
        assert_eq!(set.free, 4);
        assert!(set.misfit < 1e-5, "{}", set.misfit);
        assert!(set.sample.len() >= 35, "{}", set.sample.len());
        let distance = |u: &[f64]| u.iter().map(|u| (u - 0.5) * (u - 0.5)).sum::<f64>();
        assert!(set.sample.iter().chain([&best]).all(|other| distance(other) >= distance(&set.chosen) - 1e-6));
        assert!(set.reach.iter().all(Reach::holds_target));
    }
}
