//! All the parameters that meet the targets, when there is more than one answer.
//!
//! Three targets leave a four-dimensional set of seven parameters free. From one minimiser of the misfit:
//! * the **chosen** point is the solution nearest a preference, by default the centre of the box: minimise ‖u − p‖
//!   subject to the responses of the minimiser, by sequential linearisation; each step is one
//!   [`least_distance`] problem, halved while it makes the responses worse than they were;
//! * the **sample** takes the solutions nearest random points of the domain;
//! * the number of **free** directions is d minus the rank of the sensitivities there;
//! * the **reach** of every response over the domain tells which target cannot be met by itself, and how near one
//!   can get; where each can be met alone the misfit that is left is a conflict between them.
//!
//! It asks the model far more often than a simulation could bear: give it fitted surfaces.
//!
//! Source: Nocedal & Wright, *Numerical Optimization* (2006, doi:10.1007/978-0-387-40065-5), chapter 18.

use super::constraint::Domain;
use super::least_distance::least_distance;
use super::local::Local;
use super::{Optimiser, Problem, Trial};
use math::random::Stream;
use nalgebra::DMatrix;

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
    /// The response.
    pub response: String,
    /// Its target.
    pub target: f64,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

impl Reach {
    /// The value nearest the target.
    pub fn nearest(&self) -> f64 {
        self.target.clamp(self.low, self.high)
    }

    /// Whether the target itself can be had.
    pub fn holds_target(&self) -> bool {
        (self.low..=self.high).contains(&self.target)
    }
}

/// Largest relative difference of responses within the set.
const SAME: f64 = 1e-6;
/// Step of the finite differences, in ranges.
const DIFFERENCE: f64 = 1e-6;
/// Pivots below this part of the largest count as zero.
const RANK: f64 = 1e-6;

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
    let wanted: Vec<f64> = problem.misfit.targets().iter().map(|t| t.value).collect();
    // The targets themselves where they can be met, else the responses of the best point.
    let at_target = Level { domain, model, wanted };
    let exact = at_target.nearest(best, best).filter(|u| at_target.is_met(u));
    let level = if exact.is_some() { at_target } else { Level { wanted: found.clone(), ..at_target } };
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
        free: domain.len() - rank(&level.sensitivities(&chosen)?, domain.len()),
        reach: reach(problem, model, &mut random),
        chosen,
        responses,
        sample,
    })
}

/// The set of points with given responses.
struct Level<'a> {
    domain: &'a Domain,
    model: &'a Model<'a>,
    wanted: Vec<f64>,
}

impl Level<'_> {
    /// Deviations from the wanted responses, relative where these are not zero.
    fn deviations(&self, unit: &[f64]) -> Option<Vec<f64>> {
        let scale = |w: f64| if w == 0.0 { 1.0 } else { w.abs() };
        let y = (self.model)(&self.domain.natural(unit))?;
        Some(y.iter().zip(&self.wanted).map(|(y, &w)| (y - w) / scale(w)).collect())
    }

    fn is_met(&self, unit: &[f64]) -> bool {
        self.deviations(unit).is_some_and(|d| d.iter().all(|d| d.abs() <= SAME))
    }

    /// Rows of derivatives of the deviations, one per response.
    fn sensitivities(&self, unit: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut rows = vec![Vec::with_capacity(unit.len()); self.wanted.len()];
        for j in 0..unit.len() {
            let at = |step: f64| {
                let mut moved = unit.to_vec();
                moved[j] = (unit[j] + step).clamp(0.0, 1.0);
                Some((moved[j], self.deviations(&moved)?))
            };
            let ((left, low), (right, high)) = (at(-DIFFERENCE)?, at(DIFFERENCE)?);
            for (row, (a, b)) in rows.iter_mut().zip(low.iter().zip(&high)) {
                row.push((b - a) / (right - left));
            }
        }
        Some(rows)
    }

    /// The point of the set nearest `preference`, sought from `start`.
    fn nearest(&self, start: &[f64], preference: &[f64]) -> Option<Vec<f64>> {
        let mut unit = start.to_vec();
        for _ in 0..60 {
            let deviations = self.deviations(&unit)?;
            let aim = self.step(&unit, &deviations, &self.sensitivities(&unit)?, preference)?;
            let worst = |d: &[f64]| d.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
            let (mut part, limit) = (1.0, (2.0 * worst(&deviations)).max(0.02));
            let mut next = aim.clone();
            while part > 1e-3 && self.deviations(&next).is_none_or(|d| worst(&d) > limit) {
                part *= 0.5;
                next = unit.iter().zip(&aim).map(|(u, a)| u + part * (a - u)).collect();
            }
            let moved = unit.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            unit = self.domain.repair(&next);
            if moved < 1e-10 {
                break;
            }
        }
        Some(unit)
    }

    /// The allowed point nearest `preference` that meets the linearised responses, or as much of them as is allowed.
    fn step(&self, unit: &[f64], deviations: &[f64], rows: &[Vec<f64>], preference: &[f64]) -> Option<Vec<f64>> {
        let mut part = 1.0;
        for _ in 0..12 {
            let (mut g, mut h) = self.domain.walls_from(preference);
            for (row, d) in rows.iter().zip(deviations) {
                let length = dot(row, row).sqrt();
                if length == 0.0 {
                    continue;
                }
                let offset: f64 = row.iter().zip(unit.iter().zip(preference)).map(|(r, (u, p))| r * (u - p)).sum();
                let level = (offset - part * d) / length;
                g.push(row.iter().map(|r| r / length).collect());
                h.push(level);
                g.push(row.iter().map(|r| -r / length).collect());
                h.push(-level);
            }
            if let Ok(y) = least_distance(&g, &h) {
                return Some(preference.iter().zip(y).map(|(p, y)| (p + y).clamp(0.0, 1.0)).collect());
            }
            part *= 0.5;
        }
        None
    }
}

/// By elimination with full pivoting, whose pivots fall off as the singular values do.
fn rank(rows: &[Vec<f64>], columns: usize) -> usize {
    let upper = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]).full_piv_lu().u();
    let pivots: Vec<f64> = (0..rows.len().min(columns)).map(|i| upper[(i, i)].abs()).collect();
    let largest = pivots.iter().fold(0.0_f64, |m, &v| m.max(v));
    pivots.iter().filter(|&&v| v > RANK * largest).count()
}

/// Least and greatest value of every response: random places, the best of them refined by descent.
fn reach(problem: &Problem, model: &Model, random: &mut Stream) -> Vec<Reach> {
    let domain = &problem.domain;
    let places: Vec<Vec<f64>> = (0..400).map(|_| domain.sample(random)).collect();
    let targets = problem.misfit.targets().iter().enumerate();
    targets
        .map(|(k, target)| {
            let extreme = |sign: f64| {
                let scale = if target.value == 0.0 { sign } else { sign / target.value.abs() };
                let value = |u: &[f64]| model(&domain.natural(u)).map_or(f64::INFINITY, |y| y[k] * scale);
                lowest(domain, &places, &value) / scale
            };
            Reach { response: target.response.clone(), target: target.value, low: extreme(1.0), high: extreme(-1.0) }
        })
        .collect()
}

/// The least value found from the best few of many places.
fn lowest(domain: &Domain, places: &[Vec<f64>], value: &dyn Fn(&[f64]) -> f64) -> f64 {
    let mut ranked: Vec<(f64, &Vec<f64>)> = places.iter().map(|u| (value(u), u)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let descents = ranked.iter().take(4).map(|(start, place)| descend(domain, place, *start, value).1);
    descents.fold(ranked[0].0, f64::min)
}

/// The end of a descent of a function that answers at once.
pub(super) fn descend(domain: &Domain, from: &[f64], start: f64, value: &dyn Fn(&[f64]) -> f64) -> (Vec<f64>, f64) {
    let mut descent = Local::new(domain, from, start);
    while descent.stop().is_none() {
        let told = |point: Vec<f64>| Trial { misfit: value(&point), point, responses: Vec::new() };
        let trials: Vec<Trial> = descent.ask().into_iter().map(told).collect();
        descent.tell(&trials);
    }
    let (point, misfit) = descent.best();
    (point.to_vec(), misfit)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::benchmark;
    use super::super::misfit::{Denominator, Form, Misfit, Target};
    use super::super::{constraint::Factor, genetic, search};
    use super::*;

    fn plane(target: f64) -> Problem {
        let factor = |name: &str| Factor { name: name.into(), low: 0.0, high: 1.0 };
        let target = Target { response: "y".into(), value: target, weight: 1.0 };
        Problem {
            domain: Domain::new(vec![factor("a"), factor("b")], &[]).expect("a box"),
            misfit: Misfit::new(vec![target], Form::Sum, Denominator::Target).expect("a target"),
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

    /// Proportional rows count once, as do those that differ by rounding.
    #[test]
    fn the_rank_is_that_of_the_independent_rows() {
        let (a, b) = (vec![1.0, 2.0, 3.0], vec![-4.0, 0.5, 1.0]);
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.1 * a + 0.7 * b).collect();
        assert_eq!(rank(&[a.clone(), b.clone(), sum.clone()], 3), 2);
        assert_eq!(rank(&[a.clone(), a.iter().map(|a| -3.0 * a).collect()], 3), 1);
        assert_eq!(rank(&[vec![0.0; 3]], 3), 0);
        assert_eq!(rank(&[a, b, vec![0.0, 0.0, 1e-3]], 3), 3);
    }

    #[test]
    fn an_unreachable_target_is_named_with_the_nearest_value() {
        let product = |x: &[f64]| Some(vec![x[0] * x[1]]);
        let set = explore(&plane(3.0), &product, &[1.0, 1.0], None, 5, 1).expect("a best point");
        assert!(!set.reach[0].holds_target());
        assert!((set.reach[0].nearest() - 1.0).abs() < 1e-9 && set.reach[0].low.abs() < 1e-9);
        assert!((set.misfit - 2.0 / 3.0).abs() < 1e-9);
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
