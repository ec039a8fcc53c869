//! Bad input: every fault names the factor, the row and the remedy, and all faults come at once.

use stats::anova::{self, Error, Interactions, anova};
use stats::error::{Fault, Faults};
use stats::range::range_analysis;
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::screening::screen;
use stats::selection::{Direction, Selection};
use stats::terms::Term;

/// A 3 × 2 factorial with one run per cell.
fn table() -> Sample {
    Sample {
        factors: vec![
            Factor::new("a", vec![1.0, 1.0, 2.0, 2.0, 3.0, 3.0]),
            Factor::new("b", vec![1.0, 2.0, 1.0, 2.0, 1.0, 2.0]),
        ],
        responses: vec![Response::new("y", vec![1.0, 2.5, 3.0, 4.0, 6.0, 7.0])],
        weights: None,
    }
}

fn anova_faults(table: &Sample, settings: &anova::Settings) -> Vec<Fault> {
    anova(table, settings).unwrap_err().0
}

fn regression_faults(table: &Sample, terms: &[&str]) -> Vec<Fault> {
    let terms: Vec<Term> = terms.iter().map(|t| Term::parse(t).unwrap()).collect();
    regress(table, "y", &terms, &regression::Settings::default()).unwrap_err().0
}

#[test]
fn every_fault_of_a_table_at_once() {
    let mut table = table();
    table.factors[0].values[2] = f64::NAN;
    table.factors[1].levels = vec![1.0, 2.0];
    table.factors[1].values[3] = 2.5;
    table.factors.push(Factor::new("a", vec![1.0; 5]));
    table.responses[0].values[5] = Some(f64::INFINITY);
    table.weights = Some(vec![1.0, 1.0, 0.0, 1.0, 1.0, 1.0]);
    let Faults(faults) = table.check().unwrap_err();
    let text: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert_eq!(
        text,
        [
            "two columns are named `a`; give each factor and response its own name",
            "column `a` has 5 rows where the table has 6",
            "row 3: `a` is NaN; mark the row as missing or give a finite number",
            "row 4: `b` is 2.5, which is none of its levels 1, 2; correct the row or add the level",
            "row 6: `y` is inf; mark the row as missing or give a finite number",
            "row 3: weight 0 is not a positive number",
        ]
    );
    let same = |found: Vec<Fault>| assert_eq!(found.iter().map(ToString::to_string).collect::<Vec<_>>(), text);
    same(range_analysis(&table).unwrap_err().0);
    same(anova_faults(&table, &anova::Settings::default()));
    same(regression_faults(&table, &["const"]));
}

#[test]
fn constant_responses_and_one_level_factors() {
    let mut table = table();
    table.factors[1].values = vec![4.0; 6];
    table.responses[0] = Response::new("y", vec![2.0; 6]);
    let wanted = [
        Fault::OneLevel { factor: "b".into(), value: "4".into() },
        Fault::ConstantResponse { response: "y".into(), value: 2.0, rows: 6 },
    ];
    assert_eq!(anova_faults(&table, &anova::Settings::default()), wanted);
    assert_eq!(regression_faults(&table, &["const", "b"]), wanted);
}

/// `b = Σxy/Σx²`, which one level gives as the mean of y over x, with the error of a mean.
#[test]
fn one_level_gives_a_slope_through_the_origin() {
    let mut table = table();
    table.factors[1].values = vec![4.0; 6];
    table.responses[0] = Response::new("y", vec![8.0, 9.0, 7.5, 8.5, 8.25, 7.75]);
    let found = regress(&table, "y", &[Term::parse("b").unwrap()], &regression::Settings::default()).unwrap();
    let slope = &found.natural[0];
    assert!((slope.estimate - 49.0 / 6.0 / 4.0).abs() < 1e-14, "{slope:?}");
    // numpy: std([8, 9, 7.5, 8.5, 8.25, 7.75], ddof=1)/sqrt(6)/4
    assert!((slope.std_error.unwrap() - 0.055_119_818_980_512_31).abs() < 1e-14, "{slope:?}");
    // Two such factors are one column twice.
    table.factors[0].values = vec![2.0; 6];
    let faults = regression_faults(&table, &["a", "b"]);
    assert!(matches!(&faults[..], [Fault::Aliased { .. }]), "{faults:?}");
}

#[test]
fn aliased_terms_are_named_with_their_partners() {
    let mut table = table();
    table.factors.push(Factor::new("c", table.factors[0].values.iter().map(|a| 10.0 * a - 3.0).collect()));
    let faults = regression_faults(&table, &["const", "a", "b", "c"]);
    assert_eq!(faults, [Fault::Aliased { response: "y".into(), term: "c".into(), others: vec!["a".into()] }]);
    assert_eq!(
        faults[0].to_string(),
        "`c` is aliased with `a` in the usable rows of `y`; drop one of them or use a larger design"
    );
    let faults = regression_faults(&table, &["const", "b", "b^2"]);
    assert!(matches!(&faults[..], [Fault::Aliased { term, .. }] if term == "b^2"), "{faults:?}");
    let faults = anova_faults(&table, &anova::Settings::default());
    assert_eq!(faults, [Fault::Aliased { response: "y".into(), term: "c".into(), others: vec!["a".into()] }]);
}

#[test]
fn too_few_rows_and_no_error_left() {
    let mut table = table();
    let interaction =
        anova::Settings { interactions: Interactions::Named(vec![("a".into(), "b".into())]), ..Default::default() };
    assert_eq!(anova_faults(&table, &interaction), [Fault::NoErrorLeft { response: "y".into(), rows: 6, terms: 6 }]);
    let pure = anova::Settings { error: Error::PureError, ..Default::default() };
    assert_eq!(anova_faults(&table, &pure), [Fault::NoReplicates { response: "y".into() }]);
    for row in [1, 2, 5] {
        table.responses[0].values[row] = None;
    }
    let found = anova_faults(&table, &anova::Settings::default());
    assert_eq!(found, [Fault::TooFewRows { response: "y".into(), rows: 3, missing: 3, terms: 4 }]);
    table.responses[0].values[4] = None;
    let found = anova_faults(&table, &anova::Settings::default());
    assert!(
        found.contains(&Fault::EmptyLevel { factor: "a".into(), level: "3".into(), response: "y".into(), missing: 4 }),
        "{found:?}"
    );
    let terms = ["const", "a", "a^2", "b"];
    let found = regression_faults(&table, &terms);
    assert!(found.contains(&Fault::TooFewRows { response: "y".into(), rows: 2, missing: 4, terms: 4 }), "{found:?}");
}

#[test]
fn names_terms_and_levels_that_make_no_sense() {
    let table = table();
    let found = regression_faults(&table, &["const", "z", "z^2", "a", "a"]);
    let known = vec!["a".to_string(), "b".to_string()];
    assert_eq!(
        found,
        [Fault::Unknown { what: "factor", name: "z".into(), known }, Fault::Model { problem: "has `a` twice".into() },]
    );
    assert!(matches!(&regression_faults(&table, &[])[..], [Fault::Model { .. }]));
    let bad = anova::Settings {
        as_error: vec!["z".into()],
        interactions: Interactions::Named(vec![("a".into(), "a".into())]),
        pool_above: Some(1.5),
        ..Default::default()
    };
    let found = anova_faults(&table, &bad);
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(found[1].to_string(), "the model has the interaction `a*a`; list each of its terms once");
    let settings = regression::Settings {
        selection: Some(Selection { direction: Direction::Backward, alpha: 0.0 }),
        ..Default::default()
    };
    let found = regress(&table, "y", &Term::first_order(&["a"]), &settings).unwrap_err();
    assert_eq!(found.to_string(), "selection level is 0; it must lie between 0 and 1");
    let found = screen(&table, "y", &Term::first_order(&["a", "b"]), 0.05).unwrap_err();
    assert_eq!(found.0, [Fault::NotTwoLevels { factor: "a".into(), levels: 3 }]);
    assert!(regress(&table, "z", &[Term::constant()], &regression::Settings::default()).is_err());
}

/// A table with no rows and one with no columns are refused, not divided by.
#[test]
fn empty_tables() {
    let empty = Sample { responses: vec![Response::new("y", vec![])], ..Default::default() };
    assert!(matches!(&regression_faults(&empty, &["const"])[..], [Fault::TooFewRows { rows: 0, .. }]));
    assert!(anova(&empty, &anova::Settings::default()).is_err());
    assert!(range_analysis(&empty).is_err());
    assert_eq!(range_analysis(&Sample::default()), Ok(vec![]));
}
