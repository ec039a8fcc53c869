//! Values by hand, and every grammar that two readers could disagree about.

use super::*;
use crate::unit::{Unit, parse_any};
use proptest::prelude::*;

/// At a = 5, x = 2.
fn value(text: &str) -> f64 {
    let formula = Expression::parse(text).unwrap_or_else(|why| panic!("{why}"));
    let known = |name: &String| match name.as_str() {
        "a" => Measure::number(5.0),
        "x" => Measure::number(2.0),
        other => panic!("{other}"),
    };
    let values: Vec<Measure> = formula.names().iter().map(known).collect();
    formula.eval(&values).unwrap().value
}

#[test]
fn formulas_are_read_as_they_are_written() {
    for (text, expected) in [
        ("2*a/1e2 - 3", 2.0 * 5.0 / 1e2 - 3.0),
        ("-(a^2) + 1.5E+1", -25.0 + 15.0),
        ("(-a)^2 - a^2 * 1e-1", 25.0 - 2.5),
        ("sqrt(abs(-16)) + max(1, a)", 4.0 + 5.0),
        ("a - 1 - 1", 3.0),
        ("a / 5 / 2", 0.5),
        ("10 - a + 1", 6.0),
        ("-(a^2)", -25.0),
        ("-((a)^2)", -25.0),
        ("--a", 5.0),
        ("2 - -a", 7.0),
        ("2*-a", -10.0),
        ("+a", 5.0),
        (".5 + 5.", 5.5),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert_eq!(value("-a*(x^2)"), -20.0);
}

#[test]
fn powers_are_read_from_the_right() {
    assert_eq!(value("x^3^2"), 512.0);
    assert_eq!(value("(x^3)^2"), 64.0);
    assert_eq!(value("x^-1"), 0.5);
    assert_eq!(value("x^-x^0"), 0.5);
    assert_eq!(value("2^3^0^a"), 2.0);
}

#[test]
fn smallest_and_largest_take_any_number_of_values_and_stand_in_one_another() {
    assert_eq!(value("max(0, min(1, x))"), 1.0);
    assert_eq!(value("max(x, a, 3)"), 5.0);
    assert_eq!(value("min(a)"), 5.0);
    assert_eq!(value("min(max(x, 1), max(a, 1), min(9, 8), 7)"), 2.0);
    assert!(value("max(1, sqrt(0 - x))").is_nan(), "what is no number is not passed over");
}

#[test]
fn what_is_unclear_is_refused() {
    for unclear in ["-a^2", "3 * -sqrt(a)^2", "-(a + (1))^2 + 1", "max(-a^2, 1)", "2*-a^2", "- a ^ 2", "-(a)^(2)"] {
        let why = Expression::parse(unclear).unwrap_err();
        assert!(why.contains("a minus before a power"), "{unclear}: {why}");
    }
    for wrong in [
        "",
        " ",
        "a +* 2",
        "a b",
        "2a",
        "a 2",
        "(a",
        "a)",
        "()",
        "max()",
        "max(1,)",
        "sqrt(1, 2)",
        "wide(1)",
        "1e",
        "1..2",
        "1.2.3",
        "a,b",
        "a^",
        "^a",
        "a**2",
        "1e400",
        "a.b",
        "$",
        "a;b",
        "\u{0}",
        "0x10",
        "1_000",
        "a^*2",
    ] {
        assert!(Expression::parse(wrong).is_err(), "{wrong}");
    }
    assert!(Expression::parse(&"(".repeat(5000)).unwrap_err().contains("levels"));
    assert!(Expression::parse(&"a^".repeat(4000)).unwrap_err().contains("levels"));
    assert!(Expression::parse(&"-".repeat(9000)).unwrap_err().contains("levels"));
    assert!(Expression::parse(&"a+".repeat(9000)).unwrap_err().contains("at most"));
    let flat = ["a"; 4000].join("+");
    assert_eq!(value(&flat), 20_000.0);
}

#[test]
fn quantities_carry_their_dimension_through_a_formula() {
    let measure = |text: &str| parse_any(text).map(|(value, dimension)| Measure::of(value, dimension)).unwrap();
    let of = |text: &str, a: &str, b: &str| {
        let formula = Expression::parse(text).unwrap();
        let values = [measure(a), measure(b)];
        formula.eval(&values[..formula.names().len()]).unwrap()
    };
    let unit = |text: &str| Unit::parse(text).unwrap().dimension;
    assert_eq!(of("a / b", "30 MPa", "0.5"), Measure::of(60e6, unit("Pa")));
    assert_eq!(of("a*b^2/(2*b)", "2 N/m^3", "4 m"), Measure::of(4.0, unit("N/m^2")));
    assert_eq!(of("sqrt(a*b)", "4 Pa", "9 Pa"), Measure::of(6.0, unit("Pa")));
    assert_eq!(of("ln(a/b)", "1 GPa", "1 GPa"), Measure::number(0.0));
    let misfit = |text: &str, a: &str, b: &str| of(text, a, b).dimension.unwrap_err().to_string();
    assert_eq!(misfit("a + b", "1 MPa", "2 m"), "Pa and m cannot be added or compared");
    assert_eq!(misfit("a + b", "1 MPa", "2"), "Pa and a pure number cannot be added or compared");
    assert_eq!(misfit("exp(a)/b", "1 MPa", "2"), "a function or an exponent needs a pure number, not Pa");
    assert_eq!(misfit("b^a", "1 m", "2"), "a function or an exponent needs a pure number, not m");
}

/// A formula beside the value that it must have, each operation in brackets.
fn formula() -> impl Strategy<Value = (String, f64)> {
    let leaf = (0_u32..100).prop_map(|n| (n.to_string(), f64::from(n)));
    leaf.prop_recursive(5, 40, 3, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            pair.clone().prop_map(|((a, x), (b, y))| (format!("({a}) + ({b})"), x + y)),
            pair.clone().prop_map(|((a, x), (b, y))| (format!("({a}) - ({b})"), x - y)),
            pair.clone().prop_map(|((a, x), (b, y))| (format!("({a})*({b})"), x * y)),
            pair.clone().prop_map(|((a, x), (b, y))| (format!("({a}) / ({b})"), x / y)),
            pair.prop_map(|((a, x), (b, y))| (format!("({a})^({b})"), elementary::pow(x, y))),
            inner.clone().prop_map(|(a, x)| (format!("-({a})"), -x)),
            inner.prop_map(|(a, x)| (format!("abs({a})"), x.abs())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_formula_has_its_value((text, expected) in formula()) {
        let found = Expression::parse(&text).unwrap().eval(&[]).unwrap().value;
        prop_assert_eq!(found.to_bits(), expected.to_bits(), "{}", text);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[ax0-9.e+*/^(), -]{0,40}") {
        if let Ok(formula) = Expression::parse(&text) {
            let values = vec![Measure::number(1.5); formula.names().len()];
            prop_assert!(formula.eval(&values).is_ok());
            prop_assert!(formula.names().is_sorted());
        }
    }
}
