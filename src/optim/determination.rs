//! How well the responses determine each parameter.
//!
//! A solution is as good as another when no response tells them apart: when the interval of its expected value, which
//! holds what the scatter of packings and the number of runs leave unknown there, reaches the value y_j that the solution
//! at hand is expected to give. The extent of a parameter is what it takes over all of them,
//!
//! min and max of u_k subject to low_j(u) ≤ y_j ≤ high_j(u) for every response j, and u in the domain,
//!
//! the profile of the likelihood cut at these intervals. Each end is found by bisection: whether a point with u_k ≥ v
//! meets all conditions is one projection onto them ([`super::solution_set`]). A parameter whose extent is its whole range
//! is free: the targets do not determine it. Where a target is a band, all of it counts as y_j. The intervals are those
//! of the responses one by one; a parameter that several responses tie is wider here than jointly at the same level, never
//! narrower.
//!
//! Source: Venzon & Moolgavkar 1988, doi:10.2307/2347496 (profile intervals).

use super::level::Level;
use super::{Interval, Problem};

/// The predicted intervals at a point in natural units, by response; an end that is NaN is unknown.
pub type Outlook<'a> = dyn Fn(&[f64]) -> Option<Vec<Interval>> + 'a;

/// Halvings of a bisection: ends are known to a thousandth of the range.
const HALVINGS: usize = 10;

/// What each parameter takes over all equally good solutions, in the unit box: from the solution `at` and from others
/// that are known to be as good. `None` where nothing is predicted there.
pub fn extents(problem: &Problem, outlook: &Outlook, at: &[f64], others: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    let expected = outlook(&problem.domain.natural(at))?;
    let bands: Vec<[f64; 2]> = (0..expected.len()).map(|j| band(problem, expected[j].mean, j)).collect();
    let extent = |k: usize| {
        let end = |sign: f64| furthest(problem, outlook, (at, others), &bands, (k, sign));
        [end(-1.0), end(1.0)]
    };
    Some((0..at.len()).map(extent).collect())
}

/// What response `j` must reach: the value that the solution gives, and all of its target's band when that holds it.
fn band(problem: &Problem, y: f64, j: usize) -> [f64; 2] {
    let target = &problem.misfit.targets()[j];
    if target.low != target.high && (target.low..=target.high).contains(&y) {
        [target.low, target.high]
    } else {
        [y, y]
    }
}

/// The extreme of coordinate `k` in the direction of `sign` over the points whose intervals reach all bands.
fn furthest(
    problem: &Problem,
    outlook: &Outlook,
    (at, others): (&[f64], &[Vec<f64>]),
    bands: &[[f64; 2]],
    (k, sign): (usize, f64),
) -> f64 {
    // The two ends of every interval, and the coordinate as one more value that must reach what is wanted.
    let domain = &problem.domain;
    let coordinate = |u: f64| if sign > 0.0 { 1.0 + u } else { 2.0 - u };
    let ends = |x: &[f64]| {
        let mut values = Vec::with_capacity(2 * bands.len() + 1);
        for Interval { mean, low, high } in outlook(x)? {
            values.push(if high.is_nan() { mean } else { high });
            values.push(if low.is_nan() { mean } else { low });
        }
        values.push(coordinate(domain.unit(x)[k]));
        Some(values)
    };
    let reached = |[low, high]: &[f64; 2]| [[*low, f64::INFINITY], [f64::NEG_INFINITY, *high]];
    // An end of a band that is open asks for nothing.
    let asks = |[low, high]: &[f64; 2]| low.is_finite() || high.is_finite();
    let conditions: Vec<[f64; 2]> = bands.iter().flat_map(reached).collect();
    let open: Vec<bool> = conditions.iter().map(|condition| !asks(condition)).collect();
    let asked = |x: &[f64]| {
        let all = ends(x)?;
        Some(
            all.into_iter()
                .enumerate()
                .filter(|(i, _)| !open.get(*i).is_some_and(|open| *open))
                .map(|(_, y)| y)
                .collect(),
        )
    };
    let meets = |v: f64, from: &[f64]| {
        let mut wanted: Vec<[f64; 2]> = conditions.iter().copied().filter(asks).collect();
        wanted.push([coordinate(v), f64::INFINITY]);
        let level = Level { domain, model: &asked, wanted };
        level.nearest(from, from).filter(|u| level.is_met(u))
    };
    let known = others.iter().map(Vec::as_slice).chain([at]);
    let mut best = known.max_by(|a, b| (sign * a[k]).total_cmp(&(sign * b[k]))).unwrap_or(at).to_vec();
    let edge = if sign > 0.0 { 1.0 } else { 0.0 };
    if meets(edge, &best).is_some() {
        return edge;
    }
    let mut beyond = edge;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (best[k] + beyond);
        match meets(middle, &best) {
            Some(point) => best = point,
            None => beyond = middle,
        }
    }
    best[k].clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::{Domain, Factor};
    use crate::misfit::{Denominator, Form, Misfit, Target};

    fn problem(targets: Vec<Target>, factors: usize) -> Problem {
        let factors = (0..factors).map(|i| Factor::linear(&format!("x{i}"), 0.0, 1.0)).collect();
        let misfit = Misfit::new(targets, Form::Sum, Denominator::Target).expect("targets");
        Problem { domain: Domain::new(factors, &[]).expect("a box"), misfit, start: None }
    }

    fn about(means: Vec<f64>, halves: &[f64]) -> Option<Vec<Interval>> {
        let interval = |(mean, half): (f64, &f64)| Interval { mean, low: mean - half, high: mean + half };
        Some(means.into_iter().zip(halves).map(interval).collect())
    }

    /// y₁ = a, y₂ = b + c/2 with b, c ∈ [0, 1]: a is known as well as y₁; b lies within 0.8 − c/2 ± 0.1, so from 0.2 to
    /// 0.9, and c from 0 to 1; d appears in none.
    #[test]
    fn extents_of_a_linear_model_are_those_of_its_linear_programme() {
        let targets = vec![Target::exactly("y1", 0.5, 1.0), Target::exactly("y2", 0.8, 1.0)];
        let outlook = |x: &[f64]| about(vec![x[0], x[1] + 0.5 * x[2]], &[0.02, 0.1]);
        let found = extents(&problem(targets, 4), &outlook, &[0.5, 0.55, 0.5, 0.5], &[]).unwrap();
        for (found, wanted) in found.iter().zip([[0.48, 0.52], [0.2, 0.9], [0.0, 1.0], [0.0, 1.0]]) {
            assert!((found[0] - wanted[0]).abs() < 2e-3 && (found[1] - wanted[1]).abs() < 2e-3, "{found:?} {wanted:?}");
        }
    }

    /// a b = ¼ within 0.01: at the least a = 0.24, where b = 1.
    #[test]
    fn extents_follow_a_curved_set() {
        let outlook = |x: &[f64]| about(vec![x[0] * x[1]], &[0.01]);
        let product = problem(vec![Target::exactly("y", 0.25, 1.0)], 2);
        for found in extents(&product, &outlook, &[0.5, 0.5], &[]).unwrap() {
            assert!((found[0] - 0.24).abs() < 2e-3 && found[1] == 1.0, "{found:?}");
        }
    }

    /// y = a + b/10, where nothing is known of b's effect but that it is within ± 0.2 over half the range: b is free.
    #[test]
    fn what_is_not_known_far_away_determines_nothing() {
        let outlook = |x: &[f64]| about(vec![x[0] + 0.1 * x[1]], &[0.01 + 0.4 * (x[1] - 0.5).abs()]);
        let found = extents(&problem(vec![Target::exactly("y", 0.5, 1.0)], 2), &outlook, &[0.45, 0.5], &[]).unwrap();
        assert_eq!(found[1], [0.0, 1.0]);
    }

    /// Without an interval a determined parameter has none either; a band leaves what lies within it.
    #[test]
    fn unknown_intervals_and_bands_are_told_apart() {
        let outlook = |x: &[f64]| about(vec![x[0]], &[f64::NAN]);
        let exact = problem(vec![Target::exactly("y", 0.5, 1.0)], 1);
        let found = extents(&exact, &outlook, &[0.5], &[]).unwrap();
        assert!(found[0].iter().all(|u| (u - 0.5).abs() < 2e-6), "{found:?}");
        let least = problem(vec![Target::band("y", [0.3, f64::INFINITY], 1.0)], 1);
        let found = extents(&least, &outlook, &[0.5], &[]).unwrap();
        assert!((found[0][0] - 0.3).abs() < 2e-3 && found[0][1] == 1.0, "{found:?}");
    }
}
