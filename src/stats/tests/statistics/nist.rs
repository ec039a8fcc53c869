//! NIST Statistical Reference Datasets. Certified values have 15 digits, so 14 or more may differ in the last one.

use super::{digits, number, numbers, reference, sample, texts};
use stats::anova::{Settings, anova};
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;
use toml::Table;

/// Digits wanted of every certified regression value; what misses to 15 is the rounding of the data to doubles
/// (Wampler2) and of the certified values.
const REGRESSION: f64 = 13.0;

#[test]
fn linear_regression_sets() {
    for set in reference("nist.toml")["regression"].as_array().unwrap() {
        let set = set.as_table().unwrap();
        let name = set["name"].as_str().unwrap();
        let terms: Vec<Term> = texts(&set["terms"]).iter().map(|t| Term::parse(t).unwrap()).collect();
        let table = sample(set["factor"].as_table().unwrap(), &set["y"]);
        let found = regress(&table, "y", &terms, &regression::Settings::default()).unwrap();
        let mut worst = ("", 16.0);
        let mut check = |what: &'static str, found: f64, wanted: f64| {
            let digits = digits(found, wanted);
            assert!(digits >= REGRESSION, "{name} {what}: {found:e} for {wanted:e}, {digits:.1} digits");
            if digits < worst.1 {
                worst = (what, digits);
            }
        };
        for (i, (estimate, error)) in numbers(&set["estimates"]).into_iter().zip(numbers(&set["errors"])).enumerate() {
            check("estimate", found.natural[i].estimate, estimate);
            check("standard error", found.natural[i].std_error.unwrap(), error);
        }
        check("s", found.fit.s.unwrap(), number(&set["s"]));
        check("R²", found.fit.r2, number(&set["r2"]));
        if let Some(f) = set.get("f") {
            check("F", found.fit.f.unwrap(), number(f));
        }
        println!("{name}: at least {:.1} digits ({})", worst.1, worst.0);
    }
}

/// The cells of a set as the doubles that its decimals read as.
fn cells(set: &Table) -> Vec<Vec<f64>> {
    if let Some(cells) = set.get("cells") {
        return cells.as_array().unwrap().iter().map(numbers).collect();
    }
    let lead = set["lead"].as_str().unwrap();
    let value = |tenths: i64| format!("{lead}.{tenths}").parse::<f64>().unwrap();
    let cell = |tenths: i64| {
        let turns = (1..set["runs"].as_integer().unwrap()).map(|i| value(tenths + if i % 2 == 1 { -1 } else { 1 }));
        std::iter::once(value(tenths)).chain(turns).collect()
    };
    set["centres"].as_array().unwrap().iter().map(|c| cell(c.as_integer().unwrap())).collect()
}

/// Nine digits and more wherever the doubles still hold them; the sets with 13 leading digits lose theirs when the
/// decimals are read, so there the exact F of those doubles is asked for.
#[test]
fn analysis_of_variance_sets() {
    for set in reference("nist.toml")["anova"].as_array().unwrap() {
        let set = set.as_table().unwrap();
        let name = set["name"].as_str().unwrap();
        let cells = cells(set);
        let treatment = cells.iter().enumerate().flat_map(|(i, cell)| vec![i as f64; cell.len()]).collect();
        let table = Sample {
            factors: vec![Factor::new("treatment", treatment)],
            responses: vec![Response::new("y", cells.concat())],
            weights: None,
        };
        let found = &anova(&table, &Settings::default()).unwrap()[0];
        let [between, within, total] = &found.lines[..] else { panic!("{:?}", found.lines) };
        assert_eq!([between.df, within.df], [0, 1].map(|i| set["df"][i].as_integer().unwrap() as usize), "{name}");
        assert_eq!(total.df, between.df + within.df);
        let f = between.f.unwrap();
        let exact = digits(f, number(&set["f_of_doubles"]));
        assert!(exact >= 14.0, "{name}: F {f} against {:?}, {exact:.1} digits", set["f_of_doubles"]);
        let limit = digits(number(&set["f_of_doubles"]), number(&set["f"])).min(14.0) - 0.1;
        let certified = digits(f, number(&set["f"]));
        assert!(certified >= limit, "{name}: F has {certified:.1} certified digits, {limit:.1} are possible");
        println!("{name}: {certified:.1} certified digits of F, {exact:.1} of what the doubles hold");
        let others = [(between.ss, &set["ss"][0]), (within.ss, &set["ss"][1]), (found.fit.r2, &set["r2"])];
        for (found, wanted) in others.into_iter().chain([(found.fit.s.unwrap(), &set["s"])]) {
            assert!(digits(found, number(wanted)) >= limit - 0.6, "{name}: {found} for {wanted}");
        }
    }
}
