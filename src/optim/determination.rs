//! How well the responses determine each parameter.
//!
//! Solutions are equally good when no response tells them apart: when each lies within the interval of its expected
//! value, which holds what the scatter of packings leaves unknown. The extent of a parameter is what it takes over all of
//! them,
//!
//! min and max of u_k subject to y_j(u) ∈ [low_j, high_j] for every response j, and u in the domain,
//!
//! the profile of the likelihood cut at these intervals. Each end is found by bisection: whether a point with u_k ≥ v
//! meets all intervals is one projection onto them ([`super::solution_set`]). A parameter whose extent is
//! its whole range is free: the targets say nothing of it. The intervals are those of the responses one by one; a
//! parameter that several responses tie is wider here than jointly at the same level, never narrower.
//!
//! Source: Venzon & Moolgavkar 1988, doi:10.2307/2347496 (profile intervals).

use super::level::Level;
use super::solution_set::Model;
use super::{Interval, Problem};

/// Halvings of a bisection: ends are known to a thousandth of the range.
const HALVINGS: usize = 10;

/// What each parameter takes over all equally good solutions, in the unit box: from the solution `at` and from others
/// that are known to be as good. None where the model has no value there.
pub fn extents(
    problem: &Problem,
    model: &Model,
    at: &[f64],
    expected: &[Interval],
    others: &[Vec<f64>],
) -> Option<Vec<[f64; 2]>> {
    let responses = model(&problem.domain.natural(at))?;
    let bands: Vec<[f64; 2]> = (0..responses.len()).map(|j| band(problem, responses[j], expected, j)).collect();
    let extent = |k: usize| {
        let end = |sign: f64| furthest(problem, model, (at, others), &bands, (k, sign));
        [end(-1.0), end(1.0)]
    };
    Some((0..at.len()).map(extent).collect())
}

/// What response `j` may be: the interval of its expected value around what the model says, and all of its target's band
/// when it lies within.
fn band(problem: &Problem, y: f64, expected: &[Interval], j: usize) -> [f64; 2] {
    let Interval { mean, low, high } = expected[j];
    let target = &problem.misfit.targets()[j];
    let (below, above) = if low.is_nan() || high.is_nan() { (0.0, 0.0) } else { (mean - low, high - mean) };
    let (mut least, mut most) = (y - below, y + above);
    if target.low != target.high && (target.low..=target.high).contains(&y) {
        (least, most) = (least.min(target.low), most.max(target.high));
    }
    [least, most]
}

/// The furthest place of coordinate `k` in the direction of `sign` over the points that meet all bands.
fn furthest(
    problem: &Problem,
    model: &Model,
    (at, others): (&[f64], &[Vec<f64>]),
    bands: &[[f64; 2]],
    (k, sign): (usize, f64),
) -> f64 {
    // The coordinate stands beside the responses, as one more that must reach a wanted value.
    let domain = &problem.domain;
    let coordinate = |u: f64| if sign > 0.0 { 1.0 + u } else { 2.0 - u };
    let with_coordinate = |x: &[f64]| {
        let mut y = model(x)?;
        y.push(coordinate(domain.unit(x)[k]));
        Some(y)
    };
    let meets = |v: f64, from: &[f64]| {
        let mut wanted = bands.to_vec();
        wanted.push([coordinate(v), f64::INFINITY]);
        let level = Level { domain, model: &with_coordinate, wanted };
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

    fn about(mean: f64, half: f64) -> Interval {
        Interval { mean, low: mean - half, high: mean + half }
    }

    /// y₁ = a, y₂ = b + c/2 with b, c ∈ [0, 1]: a is known as well as y₁; b lies within 0.8 − c/2 ± 0.1, so from 0.2 to
    /// 0.9, and c from 0 to 1; d appears in none.
    #[test]
    fn extents_of_a_linear_model_are_those_of_its_linear_programme() {
        let targets = vec![Target::exactly("y1", 0.5, 1.0), Target::exactly("y2", 0.8, 1.0)];
        let model = |x: &[f64]| Some(vec![x[0], x[1] + 0.5 * x[2]]);
        let at = [0.5, 0.55, 0.5, 0.5];
        let found = extents(&problem(targets, 4), &model, &at, &[about(0.5, 0.02), about(0.8, 0.1)], &[]).unwrap();
        for (found, wanted) in found.iter().zip([[0.48, 0.52], [0.2, 0.9], [0.0, 1.0], [0.0, 1.0]]) {
            assert!((found[0] - wanted[0]).abs() < 2e-3 && (found[1] - wanted[1]).abs() < 2e-3, "{found:?} {wanted:?}");
        }
    }

    /// a b = ¼ within 4 %: at the least a = 0.24, where b = 1.
    #[test]
    fn extents_follow_a_curved_set() {
        let model = |x: &[f64]| Some(vec![x[0] * x[1]]);
        let product = problem(vec![Target::exactly("y", 0.25, 1.0)], 2);
        let found = extents(&product, &model, &[0.5, 0.5], &[about(0.25, 0.01)], &[]).unwrap();
        for found in found {
            assert!((found[0] - 0.24).abs() < 2e-3 && found[1] == 1.0, "{found:?}");
        }
    }

    /// Without an interval a determined parameter has none either; a band leaves what lies within it.
    #[test]
    fn unknown_intervals_and_bands_are_told_apart() {
        let model = |x: &[f64]| Some(vec![x[0]]);
        let unknown = Interval { mean: 0.5, low: f64::NAN, high: f64::NAN };
        let exact = problem(vec![Target::exactly("y", 0.5, 1.0)], 1);
        assert_eq!(extents(&exact, &model, &[0.5], &[unknown], &[]), Some(vec![[0.5, 0.5]]));
        let least = problem(vec![Target::band("y", [0.3, f64::INFINITY], 1.0)], 1);
        let found = extents(&least, &model, &[0.5], &[unknown], &[]).unwrap();
        assert!((found[0][0] - 0.3).abs() < 2e-3 && found[0][1] == 1.0, "{found:?}");
    }
}
