//! Relations that hold whatever the data, and what the settings change.

use math::random::Stream;
use proptest::prelude::*;
use stats::anova::{self, Error, Interactions, Squares, anova};
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;

/// Random levels and a response that depends on the first two factors.
fn table(rows: usize, factors: usize, seed: u64) -> Sample {
    let mut stream = Stream::new(seed, "statistics", 0);
    let column = |k: usize, stream: &mut Stream| {
        Factor::new(&format!("x{k}"), (0..rows).map(|i| ((i + k) % 3 + stream.below(2)) as f64).collect())
    };
    let factors: Vec<Factor> = (0..factors).map(|k| column(k, &mut stream)).collect();
    let value = |i: usize, stream: &mut Stream| {
        let x = |k: usize| factors[k].values[i];
        5.0 + 2.0 * x(0) - x(1) * x(1) + 0.3 * stream.normal()
    };
    let y = (0..rows).map(|i| value(i, &mut stream)).collect();
    Sample { factors, responses: vec![Response::new("y", y)], weights: None }
}

fn names(table: &Sample) -> Vec<String> {
    table.factors.iter().map(|f| f.name.clone()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    /// Type I sums add up to the total; leverages add up to the coefficients; residuals add up to nothing.
    #[test]
    fn sums(seed in 0_u64..1000, rows in 40_usize..90) {
        let table = table(rows, 3, seed);
        let settings = anova::Settings { squares: Squares::I, ..Default::default() };
        let found = &anova(&table, &settings).unwrap()[0];
        let (total, parts) = found.lines.split_last().unwrap();
        let sum: f64 = parts.iter().map(|l| l.ss).sum();
        prop_assert!((sum - total.ss).abs() < 1e-10 * total.ss);
        let df: usize = parts.iter().map(|l| l.df).sum();
        prop_assert_eq!(df, total.df);
        let leverage: f64 = found.residuals.iter().map(|r| r.leverage).sum();
        prop_assert!((leverage - (rows - found.fit.df_residual) as f64).abs() < 1e-10);
        let off: f64 = found.residuals.iter().map(|r| r.residual).sum();
        prop_assert!(off.abs() < 1e-10);
    }

    /// A change of units changes coefficients by the units and leaves t, R² and coded coefficients alone.
    #[test]
    fn units(seed in 0_u64..1000) {
        let plain = table(50, 3, seed);
        let mut scaled = plain.clone();
        for factor in &mut scaled.factors {
            factor.values.iter_mut().for_each(|v| *v = 1e9 * *v + 4e9);
        }
        let terms = Term::second_order(&names(&plain));
        let fit = |t: &Sample| regress(t, "y", &terms, &regression::Settings::default()).unwrap();
        let (a, b) = (fit(&plain), fit(&scaled));
        prop_assert!((a.fit.r2 - b.fit.r2).abs() < 1e-12);
        for (x, y) in a.coded.iter().zip(&b.coded) {
            prop_assert!((x.estimate - y.estimate).abs() < 1e-10 * x.estimate.abs().max(1e-3));
        }
        let last = terms.len() - 1;
        prop_assert!((a.natural[last].t.unwrap() - b.natural[last].t.unwrap()).abs() < 1e-8);
        let at = |r: &regression::Regression, x: [f64; 3]| r.model.value(&x);
        let here = at(&a, [1.0, 0.5, 2.0]);
        prop_assert!((here - at(&b, [5e9, 4.5e9, 6e9])).abs() < 1e-10 * here.abs());
    }

    /// A run with weight w counts as w equal runs.
    #[test]
    fn weights(seed in 0_u64..1000) {
        let single = table(45, 3, seed);
        let counts: Vec<usize> = (0..45).map(|i| 1 + (i * 7 + seed as usize) % 3).collect();
        let mut weighted = single.clone();
        weighted.weights = Some(counts.iter().map(|&c| c as f64).collect());
        let repeat = |values: &[f64]| values.iter().zip(&counts).flat_map(|(&v, &c)| vec![v; c]).collect::<Vec<_>>();
        let y: Vec<f64> = single.responses[0].values.iter().map(|v| v.unwrap()).collect();
        let repeated = Sample {
            factors: single.factors.iter().map(|f| Factor::new(&f.name, repeat(&f.values))).collect(),
            responses: vec![Response::new("y", repeat(&y))],
            weights: None,
        };
        let terms = Term::first_order(&names(&single));
        let fit = |t: &Sample| regress(t, "y", &terms, &regression::Settings::default()).unwrap();
        let (a, b) = (fit(&weighted), fit(&repeated));
        for (x, y) in a.natural.iter().zip(&b.natural) {
            prop_assert!((x.estimate - y.estimate).abs() < 1e-11 * y.estimate.abs().max(1.0));
        }
        prop_assert!((a.fit.r2 - b.fit.r2).abs() < 1e-12);
        let means = |t: &Sample| stats::range::range_analysis(t).unwrap()[0].means.clone();
        for (x, y) in means(&weighted).iter().zip(means(&repeated)) {
            prop_assert!((x - y).abs() < 1e-12 * y.abs());
        }
    }

    /// A leave-one-out fit gives the residual that PRESS takes from the leverage.
    #[test]
    fn leave_one_out(seed in 0_u64..1000, row in 0_usize..30) {
        let whole = table(30, 2, seed);
        let terms = Term::second_order(&names(&whole));
        let fit = |t: &Sample| regress(t, "y", &terms, &regression::Settings::default()).unwrap();
        let mut without = whole.clone();
        without.responses[0].values[row] = None;
        let (full, left) = (fit(&whole), fit(&without));
        prop_assert_eq!(left.fit.missing, 1);
        let own = &full.residuals[row];
        let point: Vec<f64> = whole.factors.iter().map(|f| f.values[row]).collect();
        let deleted = own.observed - left.model.value(&point);
        prop_assert!((deleted - own.residual / (1.0 - own.leverage)).abs() < 1e-9);
        let predicted = left.model.predict(&point, 0.95);
        let spread = left.fit.s.unwrap() * (1.0 + predicted.leverage).sqrt();
        prop_assert!((own.studentized.unwrap() - deleted / spread).abs() < 1e-8);
    }
}

/// A large table (plain doubles, many blocks) has the same bits for any number of threads, and the digits of a small one.
#[test]
fn large_tables_have_the_same_bits_for_any_number_of_threads() {
    let table = table(20_000, 6, 3);
    let terms = Term::second_order(&names(&table));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let surface = regress(&table, "y", &terms, &regression::Settings::default()).unwrap();
            (surface, anova(&table, &anova::Settings::default()).unwrap())
        })
    };
    let one = with(1);
    for threads in [2, 8] {
        assert!(one == with(threads), "{threads} threads");
    }
    let found = |term: &str| one.0.natural.iter().find(|c| c.term == term).unwrap();
    assert!((found("x0").estimate - 2.0).abs() < 4.0 * found("x0").std_error.unwrap());
    assert!((found("x1^2").estimate + 1.0).abs() < 4.0 * found("x1^2").std_error.unwrap());
}

/// Both number types on the same data: just below and just above the size at which doubles take over.
#[test]
fn doubles_agree_with_pairs_of_doubles() {
    let table = table(6_000, 4, 9);
    let terms = Term::second_order(&names(&table));
    let fit = |t: &Sample| regress(t, "y", &terms, &regression::Settings::default()).unwrap();
    let pairs = fit(&table);
    // Every row twice gives the same coefficients and R² from a table that is too large for pairs.
    let twice = |v: &[f64]| [v, v].concat();
    let y: Vec<f64> = table.responses[0].values.iter().map(|v| v.unwrap()).collect();
    let doubled = Sample {
        factors: table.factors.iter().map(|f| Factor::new(&f.name, twice(&f.values))).collect(),
        responses: vec![Response::new("y", twice(&y))],
        weights: None,
    };
    let doubles = fit(&doubled);
    for (a, b) in pairs.natural.iter().zip(&doubles.natural) {
        assert!((a.estimate - b.estimate).abs() < 1e-10 * a.estimate.abs().max(1.0), "{a:?} {b:?}");
    }
    assert!((pairs.fit.r2 - doubles.fit.r2).abs() < 1e-12);
}

#[test]
fn empty_columns_pooling_and_pure_error() {
    let table = table(60, 4, 5);
    let all = &anova(&table, &anova::Settings::default()).unwrap()[0];
    let left_out = anova::Settings { as_error: vec!["x2".into(), "x3".into()], ..Default::default() };
    let fewer = &anova(&table, &left_out).unwrap()[0];
    assert_eq!(fewer.lines.len(), 4);
    assert_eq!(fewer.fit.df_residual, all.fit.df_residual + 6);
    let pool = anova::Settings { pool_above: Some(0.2), ..Default::default() };
    let pooled = &anova(&table, &pool).unwrap()[0];
    let weak: Vec<&str> =
        all.lines.iter().filter(|l| l.p.is_some_and(|p| p > 0.2)).map(|l| l.source.as_str()).collect();
    assert_eq!(pooled.pooled, weak);
    assert!(pooled.lines.iter().all(|l| !weak.contains(&l.source.as_str())));
    // Replicates of two factors: F divides by their scatter.
    let two = Sample { factors: table.factors[..2].to_vec(), ..table.clone() };
    let settings = anova::Settings { error: Error::PureError, ..Default::default() };
    let pure = &anova(&two, &settings).unwrap()[0];
    let ms = pure.fit.ss_pure_error / pure.fit.df_pure_error as f64;
    assert!((pure.lines[0].f.unwrap() - pure.lines[0].ms.unwrap() / ms).abs() < 1e-9 * pure.lines[0].f.unwrap());
}

#[test]
fn estimable_interactions_are_taken_and_the_others_named() {
    // A half fraction of 2^4 with d = abc: each pair of factors is aliased with the pair of the other two.
    let sign = |run: usize, k: usize| if run >> k & 1 == 1 { 1.0 } else { -1.0 };
    let run = |i: usize| i / 2;
    let column = |k: usize| (0..16).map(|i| sign(run(i), k)).collect::<Vec<f64>>();
    let d = (0..16).map(|i| sign(run(i), 0) * sign(run(i), 1) * sign(run(i), 2)).collect();
    let y = (0..16).map(|i| 3.0 * sign(run(i), 0) + sign(run(i), 0) * sign(run(i), 1) + 0.1 * (i % 2) as f64).collect();
    let table = Sample {
        factors: vec![
            Factor::new("a", column(0)),
            Factor::new("b", column(1)),
            Factor::new("c", column(2)),
            Factor::new("d", d),
        ],
        responses: vec![Response::new("y", y)],
        weights: None,
    };
    let settings = anova::Settings { interactions: Interactions::Estimable, ..Default::default() };
    let found = &anova(&table, &settings).unwrap()[0];
    assert_eq!(found.not_estimable, ["b*c", "b*d", "c*d"]);
    let names: Vec<&str> = found.lines.iter().map(|l| l.source.as_str()).collect();
    assert_eq!(names, ["a", "b", "c", "d", "a*b", "a*c", "a*d", "residual", "total"]);
    assert_eq!(found.lines[4].significance, "Highly significant");
}
