//! Factors that a model takes by their logarithms.

use math::elementary::ln;
use math::scale::Scale;
use stats::canonical::canonical;
use stats::regression::{Regression, Settings, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;

/// Rows of a 3 × 3 grid, even in the logarithm of `a` (0.01 … 100) and even in `b` (0 … 4).
fn grid() -> Vec<(f64, f64)> {
    [0.01, 1.0, 100.0].iter().flat_map(|&a| [0.0, 2.0, 4.0].map(|b| (a, b))).collect()
}

fn fitted(scale: Scale, truth: impl Fn(f64, f64) -> f64) -> Regression {
    let rows = grid();
    let a = Factor { scale, coding: Some((0.01, 100.0)), ..Factor::new("a", rows.iter().map(|r| r.0).collect()) };
    let b = Factor::new("b", rows.iter().map(|r| r.1).collect());
    let y = Response::new("y", rows.iter().map(|&(a, b)| truth(a, b)).collect());
    let sample = Sample { factors: vec![a, b], responses: vec![y], weights: None };
    let terms = Term::second_order(&["a".to_owned(), "b".to_owned()]);
    regress(&sample, "y", &terms, &Settings::default()).unwrap()
}

fn estimate(list: &[stats::regression::Coefficient], term: &str) -> f64 {
    list.iter().find(|c| c.term == term).unwrap().estimate
}

/// y = 3 + 2 ln a - 0.5 b + 0.25 ln a b: closed form. In coded units ln a = ln 100 u and b = 2 + 2 v.
#[test]
fn a_truth_linear_in_the_logarithm_is_met_exactly() {
    let found = fitted(Scale::Log, |a, b| 3.0 + 2.0 * ln(a) - 0.5 * b + 0.25 * ln(a) * b);
    let decade = ln(100.0);
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-11 * y.abs().max(1.0), "{x} is not {y}");
    for (term, natural, coded) in [
        ("const", 3.0, 2.0),
        ("a", 2.0, 2.5 * decade),
        ("b", -0.5, -1.0),
        ("a*b", 0.25, 0.5 * decade),
        ("a^2", 0.0, 0.0),
    ] {
        near(estimate(&found.natural, term), natural);
        near(estimate(&found.coded, term), coded);
    }
    // Between the rows, where a model in `a` itself is far off.
    let truth = 3.0 + 2.0 * ln(10.0) - 0.5 + 0.25 * ln(10.0);
    near(found.model.value(&[10.0, 1.0]), truth);
    assert!(
        (fitted(Scale::Linear, |a, b| 3.0 + 2.0 * ln(a) - 0.5 * b + 0.25 * ln(a) * b).model.value(&[10.0, 1.0])
            - truth)
            .abs()
            > 1.0
    );
    let axis = &found.model.axes[0];
    near(axis.coded(1.0), 0.0);
    near(axis.natural(0.5), 10.0);
    assert_eq!((axis.low, axis.high), (0.01, 100.0));
    assert_eq!(found.model.predict(&[200.0, 1.0], 0.95).outside, ["a"]);
}

/// y = (ln a - ln 10)² + (b - 1)²: its minimum is at a = 10, b = 1.
#[test]
fn the_stationary_point_is_told_in_natural_units() {
    let found = fitted(Scale::Log, |a, b| ln(a / 10.0).powi(2) + (b - 1.0).powi(2));
    let point = canonical(&found.model).unwrap();
    assert!((point.natural[0] - 10.0).abs() < 1e-9 && (point.natural[1] - 1.0).abs() < 1e-9, "{point:?}");
    assert!((point.coded[0] - 0.5).abs() < 1e-11 && point.inside);
}

/// A scale is the same as a column of logarithms: every number of the fit, to the last bit.
#[test]
fn a_scale_is_a_column_of_logarithms() {
    let truth = |a: f64, b: f64| 1.0 + a.sqrt() - b * b;
    let rows = grid();
    let column = |pick: fn(&(f64, f64)) -> f64| rows.iter().map(pick).collect::<Vec<f64>>();
    let ln = |x: f64| math::elementary::ln(x);
    let a = Factor { coding: Some((ln(0.01), ln(100.0))), ..Factor::new("a", column(|r| math::elementary::ln(r.0))) };
    let y = Response::new("y", rows.iter().map(|&(a, b)| truth(a, b)).collect());
    let sample = Sample { factors: vec![a, Factor::new("b", column(|r| r.1))], responses: vec![y], weights: None };
    let terms = Term::second_order(&["a".to_owned(), "b".to_owned()]);
    let by_hand = regress(&sample, "y", &terms, &Settings::default()).unwrap();
    let found = fitted(Scale::Log, truth);
    assert_eq!((found.natural, found.coded, found.fit), (by_hand.natural, by_hand.coded, by_hand.fit));
}

#[test]
fn a_value_without_a_logarithm_is_a_fault_with_its_row() {
    let a = Factor { scale: Scale::Log, ..Factor::new("a", vec![1.0, 10.0, 0.0, 5.0]) };
    let sample =
        Sample { factors: vec![a], responses: vec![Response::new("y", vec![1.0, 2.0, 3.0, 4.0])], weights: None };
    let fault = regress(&sample, "y", &Term::first_order(&["a".to_owned()]), &Settings::default()).unwrap_err();
    assert_eq!(
        fault.0[0].to_string(),
        "row 3: factor `a` is 0, which has no logarithm; a logarithmic scale is for values above zero"
    );
    // A factor that the model does not use may be what it is.
    let constant = regress(&sample, "y", &[Term::constant()], &Settings::default());
    assert!(constant.is_ok(), "{constant:?}");
}
