//! Other programs on the same data. Tolerances are what those programs hold themselves (checked by their own scatter).

use super::{number, numbers, reference, texts};
use stats::anova::{self, Interactions, Squares, anova};
use stats::canonical::{Nature, canonical, steepest_path};
use stats::regression::{self, Coefficient, Regression, regress};
use stats::sample::{Factor, Response, Sample};
use stats::screening::screen;
use stats::selection::{Direction, Selection};
use stats::terms::Term;
use toml::Table;

/// Relative to the larger of the wanted value and `scale`.
pub(super) fn close(found: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!((found - wanted).abs() <= tolerance * wanted.abs(), "{what}: {found:e} for {wanted:e}");
}

pub(super) fn all_close(found: impl IntoIterator<Item = f64>, wanted: &[f64], tolerance: f64, what: &str) {
    let found: Vec<f64> = found.into_iter().collect();
    assert_eq!(found.len(), wanted.len(), "{what}");
    let scale = wanted.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
    for (i, (f, w)) in found.iter().zip(wanted).enumerate() {
        assert!((f - w).abs() <= tolerance * w.abs().max(1e-6 * scale), "{what} [{i}]: {f:e} for {w:e}");
    }
}

#[test]
fn types_of_sums_of_squares_on_unbalanced_data() {
    let file = reference("other_code.toml");
    let set = file["unbalanced"].as_table().unwrap();
    let mut table = Sample {
        factors: ["a", "b", "c"].map(|n| Factor::new(n, numbers(&set[n]))).to_vec(),
        responses: vec![Response::new("y", numbers(&set["y"]))],
        weights: None,
    };
    let settings = |squares| anova::Settings {
        squares,
        interactions: Interactions::Named(vec![("a".into(), "b".into())]),
        ..Default::default()
    };
    for (kind, squares) in [(1, Squares::I), (2, Squares::II), (3, Squares::III)] {
        let found = &anova(&table, &settings(squares)).unwrap()[0];
        let names: Vec<&str> = found.lines.iter().map(|l| l.source.as_str()).collect();
        assert_eq!(names[..5], texts(&set["sources"])[..]);
        all_close(found.lines[..5].iter().map(|l| l.ss), &numbers(&set[&format!("ss{kind}")]), 1e-11, "ss");
        all_close(found.lines[..4].iter().map(|l| l.f.unwrap()), &numbers(&set[&format!("f{kind}")]), 1e-11, "F");
        all_close(found.lines[..4].iter().map(|l| l.p.unwrap()), &numbers(&set[&format!("p{kind}")]), 1e-9, "p");
        if kind == 3 {
            all_close(found.lines[..4].iter().map(|l| l.omega2.unwrap()), &numbers(&set["omega2"]), 1e-11, "omega2");
        }
    }
    table.weights = Some(numbers(&set["w"]));
    let found = &anova(&table, &settings(Squares::III)).unwrap()[0];
    all_close(found.lines[..5].iter().map(|l| l.ss), &numbers(&set["weighted_ss3"]), 1e-11, "weighted ss");
    all_close(found.lines[..4].iter().map(|l| l.p.unwrap()), &numbers(&set["weighted_p3"]), 1e-9, "weighted p");
}

/// The columns of a CSV of `workflows/su2021`.
pub(super) fn columns(file: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let path = format!("{}/../../workflows/su2021/{file}", env!("CARGO_MANIFEST_DIR"));
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|h| h.split(' ').next() == Some(name)).unwrap();
    let columns: Vec<usize> = names.iter().map(|n| column(n)).collect();
    let mut found = vec![Vec::new(); names.len()];
    for row in reader.records() {
        let row = row.unwrap();
        for (values, &column) in found.iter_mut().zip(&columns) {
            values.push(row[column].parse().unwrap());
        }
    }
    found
}

fn surface(set: &Table) -> Regression {
    let names = texts(&set["factors"]);
    let response = set["response"].as_str().unwrap();
    let file = set["file"].as_str().unwrap();
    let values = columns(file, &names);
    let (low, high) = (numbers(&set["low"]), numbers(&set["high"]));
    let factor =
        |(i, values): (usize, Vec<f64>)| Factor { coding: Some((low[i], high[i])), ..Factor::new(names[i], values) };
    let table = Sample {
        factors: values.into_iter().enumerate().map(factor).collect(),
        responses: vec![Response::new(response, columns(file, &[response]).remove(0))],
        weights: set.get("weights").map(numbers),
    };
    regress(&table, response, &Term::second_order(&names), &regression::Settings::default()).unwrap()
}

fn part(list: &[Coefficient], part: impl Fn(&Coefficient) -> Option<f64>) -> Vec<f64> {
    list.iter().filter_map(part).collect()
}

#[test]
fn surfaces_of_central_composite_and_box_behnken_designs() {
    let file = reference("other_code.toml");
    for (name, set) in file["surface"].as_table().unwrap() {
        let set = set.as_table().unwrap();
        let found = surface(set);
        let wanted = |key: &str| numbers(&set[key]);
        all_close(part(&found.coded, |c| Some(c.estimate)), &wanted("coded"), 1e-9, name);
        all_close(part(&found.coded, |c| c.std_error), &wanted("coded_error"), 1e-11, name);
        all_close(part(&found.natural, |c| Some(c.estimate)), &wanted("natural"), 1e-9, name);
        all_close(part(&found.natural, |c| c.std_error), &wanted("natural_error"), 1e-9, name);
        all_close(part(&found.natural, |c| c.p), &wanted("natural_p"), 1e-8, name);
        let fit = &found.fit;
        for (found, key) in [(Some(fit.r2), "r2"), (fit.r2_adjusted, "r2_adjusted"), (fit.s, "s"), (fit.f, "f")] {
            close(found.unwrap(), number(&set[key]), 1e-11, key);
        }
        close(fit.p.unwrap(), number(&set["p"]), 1e-10, "p");
        if set.contains_key("leverage") {
            rows_agree(&found, set);
        }
        point_agrees(&found, set);
        canonical_agrees(&found, set);
    }
}

fn rows_agree(found: &Regression, set: &Table) {
    all_close(part(&found.coded, |c| c.vif), &numbers(&set["vif"]), 1e-10, "vif");
    all_close(part(&found.natural, |c| c.vif), &numbers(&set["natural_vif"]), 1e-8, "natural vif");
    let rows = &found.residuals;
    all_close(rows.iter().map(|r| r.leverage), &numbers(&set["leverage"]), 1e-10, "leverage");
    all_close(rows.iter().map(|r| r.standardized.unwrap()), &numbers(&set["standardized"]), 1e-8, "standardized");
    all_close(rows.iter().map(|r| r.studentized.unwrap()), &numbers(&set["studentized"]), 1e-8, "studentized");
    all_close(rows.iter().map(|r| r.cook.unwrap()), &numbers(&set["cook"]), 1e-8, "cook");
    let fit = &found.fit;
    close(fit.press.unwrap(), number(&set["press"]), 1e-11, "press");
    close(fit.r2_predicted.unwrap(), number(&set["r2_predicted"]), 1e-11, "r2_predicted");
    close(fit.ss_pure_error, number(&set["pure_error"]), 1e-11, "pure error");
    close(fit.lack_of_fit_f.unwrap(), number(&set["lack_of_fit_f"]), 1e-10, "lack of fit");
    close(fit.lack_of_fit_p.unwrap(), number(&set["lack_of_fit_p"]), 1e-10, "lack of fit p");
}

fn point_agrees(found: &Regression, set: &Table) {
    let predicted = found.model.predict(&numbers(&set["point"]), 0.95);
    let (confidence, prediction) = (predicted.confidence.unwrap(), predicted.prediction.unwrap());
    let predicted_numbers =
        [predicted.value, predicted.std_error.unwrap(), confidence.0, confidence.1, prediction.0, prediction.1];
    all_close(predicted_numbers, &numbers(&set["prediction"]), 1e-10, "prediction");
    assert!(predicted.outside.is_empty() && !predicted.far);
    let beyond: Vec<f64> = found.model.axes.iter().map(|a| a.high + 0.1 * a.half).collect();
    let predicted = found.model.predict(&beyond, 0.95);
    assert!(predicted.far && predicted.outside.len() == found.model.axes.len());
}

fn canonical_agrees(found: &Regression, set: &Table) {
    let point = canonical(&found.model).unwrap();
    all_close(point.axes.iter().map(|a| a.eigenvalue), &numbers(&set["eigenvalues"]), 1e-9, "eigenvalues");
    all_close(point.coded.iter().copied(), &numbers(&set["stationary"]), 1e-9, "stationary point");
    close(point.value, number(&set["stationary_value"]), 1e-10, "stationary value");
    let up = point.axes.iter().filter(|a| a.eigenvalue > 0.0).count();
    let nature =
        [Nature::Maximum, Nature::Saddle, Nature::Minimum][usize::from(up > 0) + usize::from(up == point.axes.len())];
    assert_eq!(point.nature, nature);
    for (upward, key) in [(true, "highest_on_unit_sphere"), (false, "lowest_on_unit_sphere")] {
        let path = steepest_path(&found.model, upward, &[0.0, 0.5, 1.0]).unwrap();
        close(path[2].value, number(&set[key]), 1e-9, key);
        assert_eq!(path[0].value, found.model.value_coded(&vec![0.0; point.coded.len()]));
        let length = path[2].coded.iter().map(|u| u * u).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-9);
    }
}

#[test]
fn backward_selection_takes_the_same_steps() {
    let file = reference("other_code.toml");
    let wanted = file["backward"].as_table().unwrap();
    let names = ["Ec", "kn_ks", "mu", "kn_ks_j"];
    let table = Sample {
        factors: names.iter().zip(columns("table11.csv", &names)).map(|(n, v)| Factor::new(n, v)).collect(),
        responses: vec![Response::new("nu", columns("table11.csv", &["nu"]).remove(0))],
        weights: None,
    };
    let settings = |direction| regression::Settings {
        selection: Some(Selection { direction, alpha: 0.05 }),
        ..Default::default()
    };
    let found = regress(&table, "nu", &Term::second_order(&names), &settings(Direction::Backward)).unwrap();
    let gone: Vec<&str> = found.steps.iter().map(|s| s.term.as_str()).collect();
    assert_eq!(gone, texts(&wanted["gone"]));
    all_close(found.steps.iter().map(|s| s.p), &numbers(&wanted["p"]), 1e-8, "p of the steps");
    let terms: Vec<&str> = found.natural.iter().map(|c| c.term.as_str()).collect();
    assert_eq!(terms, texts(&wanted["kept"]));
    close(found.fit.r2, number(&wanted["r2"]), 1e-11, "R²");
    let forward = regress(&table, "nu", &Term::second_order(&names), &settings(Direction::Forward)).unwrap();
    assert!(forward.steps.iter().all(|s| s.added && s.p <= 0.05));
    assert_eq!(forward.steps[0].term, "kn_ks");
}

#[test]
fn screening_of_the_filtration_rate() {
    let file = reference("other_code.toml");
    let wanted = file["screening"].as_table().unwrap();
    let factor = |(k, name): (usize, &str)| Factor::new(name, (0..16).map(|run| f64::from(run >> k & 1)).collect());
    let table = Sample {
        factors: ["A", "B", "C", "D"].into_iter().enumerate().map(factor).collect(),
        responses: vec![Response::new("rate", numbers(&wanted["y"]))],
        weights: None,
    };
    let terms: Vec<Term> = texts(&wanted["terms"]).iter().map(|t| Term::parse(t).unwrap()).collect();
    let found = screen(&table, "rate", &terms, 0.05).unwrap();
    all_close(found.effects.iter().map(|e| e.effect), &numbers(&wanted["effects"]), 1e-13, "effects");
    all_close(found.effects.iter().map(|e| e.half_normal), &numbers(&wanted["half_normal"]), 1e-12, "half-normal");
    all_close(found.effects.iter().map(|e| e.normal), &numbers(&wanted["normal"]), 1e-12, "normal");
    close(found.pse.unwrap(), number(&wanted["pse"]), 1e-13, "PSE");
    close(found.margin.unwrap(), number(&wanted["margin"]), 1e-12, "ME");
    close(found.simultaneous.unwrap(), number(&wanted["simultaneous"]), 1e-12, "SME");
    // As printed by Montgomery: PSE 2.625, ME 6.748, SME 13.699; A, C, D, AC, AD stand out.
    let active: Vec<&str> = found.effects.iter().filter(|e| e.beyond_margin).map(|e| e.term.as_str()).collect();
    assert_eq!(active, ["A", "C", "D", "A*C", "A*D"]);
    assert_eq!(found.pse, Some(2.625));
    assert_eq!(found.effects[0].rank, 1);
    let last = found.effects.iter().find(|e| e.rank == 15).unwrap();
    assert!((last.cumulative - 1.0).abs() < 1e-14);
}
