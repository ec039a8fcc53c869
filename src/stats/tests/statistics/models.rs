//! Fits through the origin, by groups and with categories, standardised effects and plain summaries against other programs.

use super::other_code::{all_close, close};
use super::{number, numbers, reference, texts};
use stats::anova::{self, anova};
use stats::groups::{groups, pivot};
use stats::range::range_analysis;
use stats::regression::{self, Regression, regress};
use stats::sample::{Factor, Response, Sample};
use stats::screening::screen;
use stats::summary::{Summary, histogram};
use stats::terms::Term;
use toml::Table;

fn terms(names: &[&str]) -> Vec<Term> {
    names.iter().map(|t| Term::parse(t).unwrap()).collect()
}

fn fit(sample: &Sample, names: &[&str]) -> Regression {
    regress(sample, "y", &terms(names), &regression::Settings::default()).unwrap()
}

fn set(name: &str) -> Table {
    reference("models.toml")[name].as_table().unwrap().clone()
}

#[test]
fn fits_through_the_origin_by_groups() {
    let set = set("origin");
    let column = |name: &str| numbers(&set[name]);
    let (radius, ratio, scn) = (column("radius"), column("ratio"), column("scn"));
    let formula: Vec<f64> = scn.iter().zip(&ratio).map(|(s, k)| s / (1.0 + k)).collect();
    let term = "scn/(1+ratio)";
    let table = Sample {
        factors: vec![Factor::new(term, formula)],
        responses: vec![Response::new("y", column("st"))],
        weights: None,
    };
    let own: Vec<Sample> = groups(&[&radius, &ratio]).iter().map(|g| table.with_rows(&g.rows)).collect();
    let zero: Vec<Regression> = own.iter().map(|s| fit(s, &[term])).collect();
    let line: Vec<Regression> = own.iter().map(|s| fit(s, &["const", term])).collect();
    let part = |list: &[Regression], i: usize| list.iter().map(|r| r.natural[i].clone()).collect::<Vec<_>>();
    let (slope, constant, beside) = (part(&zero, 0), part(&line, 0), part(&line, 1));
    all_close(slope.iter().map(|c| c.estimate), &column("slope"), 1e-11, "slope");
    all_close(slope.iter().map(|c| c.std_error.unwrap()), &column("slope_error"), 1e-11, "its error");
    all_close(slope.iter().map(|c| c.p.unwrap()), &column("slope_p"), 1e-9, "its p");
    assert!(
        zero.iter().all(|r| !r.fit.constant) && line.iter().all(|r| r.fit.constant && r.fit.r2_about_mean.is_none())
    );
    all_close(zero.iter().map(|r| r.fit.r2), &column("r2"), 1e-12, "R² about zero");
    all_close(zero.iter().map(|r| r.fit.r2_about_mean.unwrap()), &column("r2_about_mean"), 1e-12, "R² about the mean");
    all_close(constant.iter().map(|c| c.estimate), &column("intercept"), 1e-9, "intercept");
    all_close(constant.iter().map(|c| c.std_error.unwrap()), &column("intercept_error"), 1e-11, "its error");
    all_close(beside.iter().map(|c| c.estimate), &column("with_slope"), 1e-11, "slope beside an intercept");
    all_close(beside.iter().map(|c| c.std_error.unwrap()), &column("with_slope_error"), 1e-11, "its error");
    all_close(line.iter().map(|r| r.fit.r2), &column("with_r2"), 1e-12, "R² with an intercept");
    let predicted = zero[0].model.predict(&[6.0], 0.95);
    let (mean, run) = (predicted.confidence.unwrap(), predicted.prediction.unwrap());
    all_close([predicted.value, mean.0, mean.1, run.0, run.1], &column("band"), 1e-11, "band");
    let cells = pivot(&radius, &ratio, &column("st")).cells;
    all_close(cells.iter().map(|c| c.unwrap().mean), &column("pivot_mean"), 1e-14, "pivot");
    all_close(cells.iter().map(|c| c.unwrap().deviation.unwrap()), &column("pivot_std"), 1e-14, "pivot");
}

#[test]
fn categories_enter_by_dummy_coding() {
    let set = set("categories");
    let table = Sample {
        factors: vec![
            Factor::named("cement", &texts(&set["cement"])),
            Factor::named("aggregate", &texts(&set["aggregate"])),
            Factor::new("w", numbers(&set["w"])),
        ],
        responses: vec![Response::new("y", numbers(&set["y"]))],
        weights: None,
    };
    let found = fit(&table, &["const", "cement", "w"]);
    assert_eq!(found.natural.iter().map(|c| c.term.as_str()).collect::<Vec<_>>(), texts(&set["terms"]));
    all_close(found.natural.iter().map(|c| c.estimate), &numbers(&set["estimate"]), 1e-11, "estimates");
    all_close(found.natural.iter().map(|c| c.std_error.unwrap()), &numbers(&set["error"]), 1e-11, "errors");
    all_close(found.natural.iter().map(|c| c.p.unwrap()), &numbers(&set["p_values"]), 1e-9, "p");
    close(found.fit.r2, number(&set["r2"]), 1e-13, "R²");
    let found = fit(&table, &["const", "cement", "w", "cement*w"]);
    all_close(found.natural.iter().map(|c| c.estimate), &numbers(&set["with_products"]), 1e-9, "products");
    let errors = found.natural.iter().map(|c| c.std_error.unwrap());
    all_close(errors, &numbers(&set["with_products_error"]), 1e-9, "errors of products");
    let table = Sample { factors: table.factors[..2].to_vec(), ..table };
    let found = &anova(&table, &anova::Settings::default()).unwrap()[0];
    all_close(found.lines[..3].iter().map(|l| l.ss), &numbers(&set["ss3"]), 1e-11, "ss");
    all_close(found.lines[..2].iter().map(|l| l.f.unwrap()), &numbers(&set["f3"]), 1e-11, "F");
    all_close(found.lines[..2].iter().map(|l| l.p.unwrap()), &numbers(&set["p3"]), 1e-9, "p");
    let ranges = range_analysis(&table).unwrap();
    assert_eq!(ranges[0].names, ["CEM I*", "fly ash", "slag"]);
    all_close(ranges[0].means.iter().copied(), &numbers(&set["level_means"]), 1e-14, "means of levels");
}

#[test]
fn standardised_effects_of_twelve_runs() {
    let set = set("plackett_burman");
    let names = ["A", "B", "C", "D", "E", "F", "G"];
    let table = Sample {
        factors: names.iter().map(|n| Factor::new(n, numbers(&set[*n]))).collect(),
        responses: vec![Response::new("y", numbers(&set["y"]))],
        weights: None,
    };
    let found = screen(&table, "y", &terms(&names), 0.05).unwrap();
    all_close(found.effects.iter().map(|e| e.effect), &numbers(&set["effects"]), 1e-12, "effects");
    let t = found.effects.iter().map(|e| e.standardized.unwrap());
    all_close(t, &numbers(&set["standardized"]), 1e-11, "standardised");
    all_close(found.effects.iter().map(|e| e.p.unwrap()), &numbers(&set["p_values"]), 1e-9, "p");
    close(found.critical.unwrap(), number(&set["critical"]), 1e-12, "critical value");
    let active: Vec<&str> =
        found.effects.iter().filter(|e| e.significant == Some(true)).map(|e| e.term.as_str()).collect();
    assert_eq!(active, ["A", "E"]);
    // All eleven columns leave nothing for the error.
    let full = Sample { factors: table.factors[..1].to_vec(), ..table.clone() };
    let full = full.with_rows(&[0, 1]);
    let found = screen(&full, "y", &terms(&["A"]), 0.05).unwrap();
    assert!(found.critical.is_none() && found.effects[0].standardized.is_none());
}

#[test]
fn boxes_and_bins() {
    let set = set("plain");
    for name in ["normal", "skew", "few"] {
        let values = numbers(&set[name]);
        let s = Summary::of(&values).unwrap();
        let found = [s.low, s.first, s.median, s.third, s.high, s.mean, s.deviation.unwrap()];
        all_close(found, &numbers(&set[&format!("{name}_box")]), 1e-13, name);
        close(s.half_interval(0.95).unwrap(), number(&set[&format!("{name}_half")]), 1e-12, name);
        assert!(s.beyond.iter().all(|v| *v < s.low || *v > s.high));
        let bins = histogram(&values, None);
        let counts: Vec<f64> = bins.counts.iter().map(|&c| c as f64).collect();
        assert_eq!(counts, numbers(&set[&format!("{name}_counts")]), "{name}");
        all_close(bins.edges, &numbers(&set[&format!("{name}_edges")]), 1e-13, name);
    }
    assert_eq!(Summary::of(&[f64::NAN]), None);
    let one = histogram(&[3.0, 3.0], None);
    assert_eq!((one.edges, one.counts), (vec![2.5, 3.5], vec![2]));
}
