//! Workflows from beginning to end: designs, a stand-in simulator, and every stage of statistics, through the program
//! itself. `tests/good/statistics.toml` is made so that its results have closed forms or stand in the reference files.

#![allow(clippy::unwrap_used)]

use math::distribution::t_for_coverage;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A reference file of `tests/reference/statistics`.
fn reference(name: &str) -> toml::Table {
    let path = format!("{}/tests/reference/statistics/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}")).parse().unwrap()
}

/// A number, written with or without a point.
fn number(value: &toml::Value) -> f64 {
    value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64)
}

/// A list of numbers.
fn numbers(value: &toml::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// A list of texts.
fn texts(value: &toml::Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|t| t.as_str().unwrap()).collect()
}

fn close(found: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!((found - wanted).abs() <= tolerance * wanted.abs(), "{what}: {found:e} for {wanted:e}");
}

/// A workflow that was run.
struct Ran {
    workflow: PathBuf,
    store: TempDir,
    output: Output,
}

impl Ran {
    fn of(workflow: &Path) -> Self {
        let store = tempfile::tempdir().unwrap();
        let output = flow(&["run", "--keep-going"], workflow, store.path(), &[]);
        Self { workflow: workflow.to_owned(), store, output }
    }

    /// The rows of a table, each by the names of its columns.
    fn table(&self, stage: &str, table: &str) -> Vec<BTreeMap<String, String>> {
        let shown = flow(&["show"], &self.workflow, self.store.path(), &[stage, "--table", table, "--csv"]);
        assert!(shown.status.success(), "{stage}: {}", String::from_utf8_lossy(&shown.stderr));
        let mut reader = csv::Reader::from_reader(&shown.stdout[..]);
        let heads = reader.headers().unwrap().clone();
        let name = |head: &str| head.split(" [").next().unwrap_or(head).to_owned();
        let row = |record: csv::StringRecord| heads.iter().map(name).zip(record.iter().map(str::to_owned)).collect();
        reader.records().map(|record| row(record.unwrap())).collect()
    }

    /// One number: the column `what` in the row whose column `key` is `value`.
    fn number(&self, (stage, table): (&str, &str), (key, value): (&str, &str), what: &str) -> f64 {
        let rows = self.table(stage, table);
        let row = rows.iter().find(|row| row[key] == value).unwrap_or_else(|| panic!("{stage}: no {key} {value}"));
        row[what].parse().unwrap_or(f64::NAN)
    }

    /// A column as numbers, NaN where a cell is empty.
    fn column(&self, stage: &str, table: &str, name: &str) -> Vec<f64> {
        self.table(stage, table).iter().map(|row| row[name].parse().unwrap_or(f64::NAN)).collect()
    }

    fn notes(&self, stage: &str) -> Vec<String> {
        self.table(stage, "notes").into_iter().map(|row| row["note"].clone()).collect()
    }
}

fn flow(before: &[&str], workflow: &Path, store: &Path, after: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flow"));
    command.args(before).arg(workflow).args(after).arg("--store").arg(store);
    command.output().unwrap()
}

fn all_near(found: &[f64], wanted: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), wanted.len(), "{what}: {found:?}");
    for (f, w) in found.iter().zip(wanted) {
        assert!((f - w).abs() <= tolerance * w.abs().max(1.0), "{what}: {found:?} for {wanted:?}");
    }
}

#[test]
fn a_campaign_of_every_design_and_analysis() {
    let ran = Ran::of(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good/statistics.toml"));
    assert!(ran.output.status.success(), "{}", String::from_utf8_lossy(&ran.output.stderr));
    balanced(&ran);
    replicated(&ran);
    unbalanced(&ran);
    screened(&ran);
    surfaces(&ran);
}

/// y = 10s + t²/100 + 7 on L9: level means and sums of squares by hand.
fn balanced(ran: &Ran) {
    let ranges = ran.table("range", "range");
    let brief: Vec<(&str, &str)> = ranges.iter().map(|row| (row["factor"].as_str(), row["rank"].as_str())).collect();
    assert_eq!(brief, [("s", "1"), ("t", "2"), ("u", "3"), ("v", "3")]);
    all_near(&ran.column("range", "range", "range"), &[20.0, 8.0, 0.0, 0.0], 1e-14, "ranges");
    let of = |factor| ran.number(("exact", "anova"), ("source", factor), "ss");
    all_near(&["s", "t", "v", "residual", "total"].map(of), &[600.0, 98.0, 0.0, 0.0, 698.0], 1e-13, "sums of squares");
    let eta2 = ran.number(("exact", "anova"), ("source", "s"), "eta2");
    assert!((eta2 - 600.0 / 698.0).abs() < 1e-14);
    assert!(ran.number(("exact", "anova"), ("source", "s"), "f").is_nan(), "there is nothing to divide by");
    assert_eq!(ran.notes("exact"), ["the model meets every run to the last digit: there is no error to test against"]);
}

/// Pure error straight from the runs: squares about the means of equal rows.
fn replicated(ran: &Ran) {
    let runs = ran.table("scattered", "runs");
    assert_eq!(runs.len(), 27);
    let mut cells: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for row in &runs {
        cells.entry((&row["s"], &row["t"])).or_default().push(row["y"].parse().unwrap());
    }
    let about_mean = |values: &Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()
    };
    assert!(cells.values().all(|values| values.len() == 3));
    let pure: f64 = cells.values().map(about_mean).sum();
    let residual = ran.number(("replicated", "anova"), ("source", "residual"), "ss");
    assert!((residual / pure - 1.0).abs() < 1e-10, "{residual} for {pure}");
    assert_eq!(ran.number(("replicated", "anova"), ("source", "residual"), "df"), 18.0);
    assert!(ran.number(("replicated", "anova"), ("source", "s*t"), "p") < 1e-6);
    let fit = |what| ran.number(("line", "fit"), ("response", "y"), what);
    let squares = fit("s").powi(2) * 24.0;
    let lack = ((squares - pure) / 6.0) / (pure / 18.0);
    assert_eq!((fit("n"), fit("df_residual"), fit("df_pure_error")), (27.0, 24.0, 18.0));
    assert!((fit("lack_of_fit_f") / lack - 1.0).abs() < 1e-9, "{} for {lack}", fit("lack_of_fit_f"));
    let notes = ran.notes("line");
    assert!(notes.iter().any(|note| note.starts_with("lack of fit (F = ")), "{notes:?}");
}

/// The reference file has the sums of squares by statsmodels; z = 2a + b has lost three runs.
fn unbalanced(ran: &Ran) {
    let file = reference("other_code.toml");
    let set = file["unbalanced"].as_table().unwrap();
    let ss = |stage: &str| ran.column(stage, "anova", "ss")[..5].to_vec();
    all_near(&ss("type1"), &numbers(&set["ss1"]), 1e-11, "type I");
    all_near(&ss("type3"), &numbers(&set["weighted_ss3"]), 1e-11, "weighted, type III");
    let p = ran.column("type3", "anova", "p")[..4].to_vec();
    for (found, wanted) in p.iter().zip(numbers(&set["weighted_p3"])) {
        close(*found, wanted, 1e-9, "weighted p");
    }
    let coefficient = |term| ran.number(("missing", "coefficients"), ("term", term), "estimate");
    all_near(&["const", "a", "b"].map(coefficient), &[0.0, 2.0, 0.001], 1e-13, "z in MPa and kPa");
    assert_eq!(ran.number(("missing", "fit"), ("response", "z"), "missing"), 3.0);
    assert_eq!(ran.notes("missing")[0], "3 of 37 runs have no value; the analysis is of 34");
    let (a, z) = (numbers(&set["a"]), ran.column("unbalanced", "runs", "z"));
    let w = numbers(&set["w"]);
    let at_one = (0..37).filter(|&i| a[i] == 1.0 && !z[i].is_nan());
    let (sum, weight) = at_one.fold((0.0, 0.0), |(sum, weight), i| (sum + w[i] * z[i], weight + w[i]));
    let rows = ran.table("missing_range", "range");
    let own = rows.iter().find(|row| row["response"] == "z" && row["factor"] == "a").unwrap();
    close(own["level_1"].parse().unwrap(), sum / weight, 1e-14, "weighted mean");
    assert_eq!(ran.notes("missing_range").len(), 2);
}

/// Montgomery's filtration rates, and effects that were put in.
fn screened(ran: &Ran) {
    let file = reference("other_code.toml");
    let wanted = file["screening"].as_table().unwrap();
    let effects = ran.table("screening", "effects");
    let terms: Vec<&str> = effects.iter().map(|row| row["term"].as_str()).collect();
    assert_eq!(terms, texts(&wanted["terms"]));
    all_near(&ran.column("screening", "effects", "effect"), &numbers(&wanted["effects"]), 1e-13, "effects");
    all_near(
        &ran.column("screening", "effects", "half_normal"),
        &numbers(&wanted["half_normal"]),
        1e-12,
        "half-normal",
    );
    for (limit, digits) in [("pse", 1e-13), ("margin", 1e-12), ("simultaneous", 1e-12)] {
        let found = ran.number(("screening", "limits"), ("response", "rate"), limit);
        close(found, wanted[limit].as_float().unwrap(), digits, limit);
    }
    let picked = |word: &str| -> Vec<&str> {
        effects.iter().filter(|row| row["verdict"] == word).map(|row| row["term"].as_str()).collect()
    };
    assert_eq!(picked("beyond both margins"), ["A", "D", "A*C", "A*D"]);
    assert_eq!(picked("beyond the margin of error"), ["C"]);
    assert_eq!(
        ran.notes("screening"),
        ["A, D, A*C, A*D: beyond both margins: real", "C: beyond the margin of error only: perhaps real"]
    );
    let put_in = [8.0, -6.0, 1.0, -0.5, 0.25, 0.75, -1.25];
    all_near(&ran.column("pb_screening", "effects", "effect"), &put_in, 1e-13, "effects of eight runs");
    // 1.5 · median{1, ½, ¼, ¾, 1¼}, those below 2.5 · 1.5 · 1
    let limit = |what| ran.number(("pb_screening", "limits"), ("response", "y"), what);
    close(limit("pse"), 1.125, 1e-13, "PSE");
    close(limit("margin"), 1.125 * t_for_coverage(0.95, 7.0 / 3.0), 1e-12, "margin");
    // A + AB in 0 and 1: effects 1½, ½ and ½, the others nothing
    let found = ran.column("fraction_screening", "effects", "effect");
    all_near(&found, &[1.5, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0], 1e-13, "effects of the fraction");
    assert!(ran.number(("fraction_screening", "limits"), ("response", "y"), "pse").is_nan());
    assert!(ran.notes("fraction_screening")[0].starts_with("Lenth's limits need three effects"));
}

/// In coded units y = 2 + w + 1.5x² − xw + w², flat at x = −0.2, w = −0.6, which is x2 = 14, where y = 1.7.
fn surfaces(ran: &Ran) {
    let wanted = [("const", 4.0), ("x1", 2.0), ("x2", -0.3), ("x1^2", 1.5), ("x2^2", 0.01), ("x1*x2", -0.1)];
    for stage in ["ccd_surface", "bbd_surface", "lhs_surface", "sobol_surface", "own_surface"] {
        for (term, value) in wanted {
            let found = ran.number((stage, "coefficients"), ("term", term), "estimate");
            assert!((found - value).abs() < 1e-12, "{stage} {term}: {found}");
        }
    }
    for stage in ["ccd_surface", "lhs_surface", "sobol_surface", "own_surface"] {
        let place = |factor| ran.number((stage, "stationary"), ("factor", factor), "natural");
        assert!((place("x1") + 0.2).abs() < 1e-10 && (place("x2") - 14.0).abs() < 1e-9, "{stage}");
        let rows = ran.table(stage, "stationary");
        assert_eq!((rows[0]["nature"].as_str(), rows[0]["domain"].as_str()), ("minimum", "inside"), "{stage}");
        close(rows[0]["value"].parse().unwrap(), 1.7, 1e-11, stage);
    }
    let lost = ran.column("lhs", "design", "x1").iter().filter(|x| **x > 0.5).count();
    assert!(lost > 5);
    assert_eq!(ran.number(("lhs_surface", "fit"), ("response", "y"), "missing"), lost as f64);
    assert!(ran.notes("lhs_surface")[0].starts_with(&format!("{lost} of 40 runs have no value")));
    let predicted = ran.table("ccd_surface", "predictions");
    close(predicted[0]["value"].parse().unwrap(), 2.13375, 1e-12, "prediction");
    assert_eq!(
        (predicted[0]["extrapolation"].as_str(), predicted[1]["extrapolation"].as_str()),
        ("", "x1 outside the domain")
    );
    assert!(ran.notes("ccd_surface").contains(&"prediction 2 extrapolates: x1 outside the domain".to_owned()));
    // the third factor of the Box–Behnken design does nothing
    let terms: Vec<String> = ran.table("bbd_surface", "coefficients").iter().map(|row| row["term"].clone()).collect();
    assert!(!terms.iter().any(|term| term.contains("x3")), "{terms:?}");
}

/// What only the data can show is told when the stage runs: factor, row, remedy.
#[test]
fn data_that_cannot_be_analysed() {
    let folder = tempfile::tempdir().unwrap();
    let workflow = folder.path().join("bad.toml");
    let head = "[workflow]\nseed = 1\n[factor]\na = { levels = [1, 2, 3] }\nb = { levels = [1, 2] }\n\
                [response]\ny = {}\n[stage.data]\nkind = \"data\"\nfile = \"bad.csv\"\n[stage.it]\ntable = \"data\"\n";
    let cases = [
        (
            "a,b,y\n1,1,5\n2,2,5\n3,1,5\n",
            "anova",
            "response `y` is 5 in all 3 usable rows; there is nothing to explain",
        ),
        ("a,b,y\n1,1,1\n2,1,2\n3,1,4\n1,1,3\n", "anova", "factor `b` is 1 in every usable row; vary it or take it out"),
        ("a,b,y\n1,1,1\n2,2,2\n3,2,4\n1,1,3\n3,2,5\n", "anova", "`b` is aliased with `a` in the usable rows of `y`"),
        (
            "a,b,y\n1,1,1\n2,2,2\n3,1,\n3,2,4\n",
            "anova",
            "response `y` has 3 usable rows (1 missing) for 4 coefficients",
        ),
        ("a,b,y\n1,1,1\n2,2,2\n4,1,4\n", "range", "row 3: `a` is 4, which is none of its levels 1, 2, 3"),
        ("a,b,y\n1,1,1\n2,,2\n3,1,4\n", "range", "row 2: `b` is NaN; mark the row as missing or give a finite number"),
        (
            "a,b,y\n1,1,1\n2,2,2\n3,1,4\n3,2,\n",
            "regression\"\nterms.y = [\"a\", \"a^2\", \"b\", \"a*b\"]#",
            "for 5 coefficients",
        ),
        (
            "a,b,y\n1,1,1\n2,2,2\n3,1,4\n",
            "screening",
            "factor `a` has 3 levels; a screening analysis needs exactly two",
        ),
    ];
    let run = |data: &str, kind: &str| {
        fs::write(folder.path().join("bad.csv"), data).unwrap();
        let kind = match kind.strip_suffix('#') {
            Some(kind) => format!("kind = \"{kind}\n"),
            None => format!("kind = \"{kind}\"\n"),
        };
        fs::write(&workflow, format!("{head}{kind}")).unwrap();
        let ran = Ran::of(&workflow);
        (ran.output.status.code(), String::from_utf8_lossy(&ran.output.stderr).into_owned())
    };
    for (data, kind, wanted) in cases {
        let (code, told) = run(data, kind);
        assert_eq!(code, Some(1), "{kind}{data}{told}");
        assert!(told.contains(wanted), "wanted: {wanted}\ntold: {told}");
    }
    // What no analysis could use is found before the run.
    let (code, told) = run("a,b,y\n1,1,1\n2,2,inf\n3,1,4\n", "range");
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("row 2: `y` is `inf`, which is no number here"), "{told}");
}
