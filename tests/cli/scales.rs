//! A response surface over decades: design, fit, figure and inversion on one logarithmic scale.

use crate::space::{Space, told};

/// y = 5 + 3 ln(k) + 0.5 m, with k from 0.01 to 100.
const WORKFLOW: &str = r#"
[workflow]
seed = 1
[factor]
k = { sets = "mortar.k", range = [0.01, 100], scale = "log" }
m = { sets = "mortar.m", range = [0, 4] }
[response]
y = {}
[material.base]
mortar = { k = 1, m = 1 }
[stage.points]
kind = "design"
method = "central-composite"
alpha = "face"
factors = ["k", "m"]
[stage.runs]
kind = "formula"
design = "points"
material = "base"
responses.y = { value = "5 + 3*ln(k) + 0.5*m", unit = "" }
[stage.surface]
kind = "rsm"
tables = ["runs"]
responses = ["y"]
predict = { at = [{ k = 31.6227766, m = 1 }] }
[stage.picture]
kind = "figure"
show = "contour"
of = "surface"
compare = "points"
response = "y"
factors = ["k", "m"]
[stage.found]
kind = "calibrate"
surfaces = "surface"
factors = ["k"]
held = [{ m = 2 }]
targets = [{ y = 12.907755 }]
method = "differential"
"#;

fn cell(csv: &str, row: usize, name: &str) -> f64 {
    let place = csv.lines().next().and_then(|head| head.split(',').position(|own| own.split(' ').next() == Some(name)));
    let line = csv.lines().nth(row).unwrap_or_default();
    line.split(',').nth(place.unwrap_or(usize::MAX)).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
}

#[test]
fn a_surface_linear_in_the_logarithm_is_met_and_inverted() {
    let space = Space::new();
    space.write("w.toml", WORKFLOW);
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let natural = space.stdout(&["show", "w.toml", "surface", "--table", "coefficients", "--csv"]);
    let slope = natural.lines().find(|line| line.starts_with("y,k,")).expect("a slope");
    assert!((slope.split(',').nth(2).unwrap().parse::<f64>().unwrap() - 3.0).abs() < 1e-9, "{slope}");
    let predictions = space.stdout(&["show", "w.toml", "surface", "--table", "predictions", "--csv"]);
    // 5 + 3 ln(10^1.5) + 0.5
    assert!((cell(&predictions, 1, "value") - 15.861_632_6).abs() < 1e-6, "{predictions}");
    let domain = space.stdout(&["show", "w.toml", "surface", "--table", "domain", "--csv"]);
    assert!(domain.contains("0.01,100,log") && domain.contains("0,4,linear"), "{domain}");
    let notes = space.stdout(&["show", "w.toml", "surface", "--table", "notes", "--csv"]);
    assert!(notes.contains("`k` has a logarithmic scale: its terms are of the logarithm, ln(k)"), "{notes}");
    // 12.907755 = 5 + 3 ln(10) + 0.5 · 2: k = 10.
    let solution = space.stdout(&["show", "w.toml", "found", "--table", "solution", "--csv"]);
    assert!((cell(&solution, 1, "k") - 10.0).abs() < 1e-3, "{solution}");
    let data = space.stdout(&["show", "w.toml", "picture", "--table", "data", "--csv"]);
    // Nodes are even in the logarithm: the middle one is at 1, where y = 5 at m = 0.
    assert_eq!(cell(&data, 1, "k"), 0.01, "{data}");
    assert!((cell(&data, 31, "k") - 1.0).abs() < 1e-12 && (cell(&data, 31, "y") - 5.0).abs() < 1e-9, "{data}");
}
