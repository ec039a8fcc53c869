//! External programs that say whether a run of theirs is valid: treated as tests of `simulate` that do not meet their
//! checks, in tables, statistics, calibration and verification.

use crate::space::{Space, told};
use serde_json::Value;

/// y = 2 x; at x = 3 the disc turns, and at x = 5 the program asks for caution. Of four replicates about x = 4.2 one turns.
const ENGINE: &str = r#"awk 'BEGIN { x = {{x}}; r = {{replicate}};
if (x == 3 || (x > 4 && x < 4.5 && r % 4 == 3)) v = "\"rotation of the disc\""; else v = "null";
if (x == 5) c = "\"coarse\""; else c = "\"\"";
y = (x == 3) ? 100 : 2 * x;
printf "{\"y\": %.17g, \"checks\": %s, \"look\": [%s]}\n", y, v, c > "out.json" }'
"#;

const WORKFLOW: &str = r#"
[workflow]
seed = 7
[factor]
x = { sets = "m.x", levels = [1, 2, 3, 4, 5] }
[response]
y = { unit = "MPa" }
[material.base]
m = { x = 4 }
[stage.points]
kind = "design"
method = "full-factorial"
factors = ["x"]
[stage.runs]
kind = "command"
design = "points"
material = "base"
run = ["sh", "engine.sh"]
templates = { "engine.sh" = "engine.sh" }
read.y = { file = "out.json", pointer = "/y", unit = "MPa" }
validity = { file = "out.json", pointer = "/checks" }
cautions = { file = "out.json", pointer = "/look" }
[stage.fit]
kind = "regression"
table = "runs"
terms.y = ["x"]
[stage.printed]
kind = "table"
of = "runs"
[stage.picture]
kind = "figure"
show = "xy"
of = "runs"
x = "x"
y = "y"
"#;

fn space(more: &str) -> Space {
    let space = Space::new();
    space.write("engine.sh", ENGINE);
    space.write("w.toml", &format!("{WORKFLOW}{more}"));
    space
}

#[test]
fn runs_of_a_program_that_are_not_valid_are_marked_left_out_and_counted() {
    let space = space("");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let said = told(&output);
    let left = "1 of 5 runs is not valid and was left out: rotation of the disc (1)";
    assert!(said.contains(&format!("note: fit: y: {left}")), "{said}");
    assert!(said.contains("note: runs: 1 of 5 runs is not valid: rotation of the disc (1)"), "{said}");
    assert!(said.contains("note: runs: 1 of 5 runs is to be read with caution: coarse (1)"), "{said}");
    let runs = space.stdout(&["show", "w.toml", "runs", "--table", "runs", "--csv", "--quiet"]);
    assert_eq!(
        runs,
        "x,y [MPa],failure,validity,cautions\n1,2,,,\n2,4,,,\n3,100,,rotation of the disc,\n4,8,,,\n5,10,,,coarse\n"
    );
    let fit = space.stdout(&["show", "w.toml", "fit", "--table", "coefficients", "--csv", "--quiet"]);
    let slope = fit.lines().find(|line| line.contains(",x,")).and_then(|line| line.split(',').nth(2));
    assert!((slope.expect("a slope").parse::<f64>().expect("a number") - 2.0).abs() < 1e-9, "{fit}");
    space.stdout(&["export", "w.toml", "--quiet"]);
    let file = |name: &str| std::fs::read_to_string(space.path(&format!("export/{name}"))).expect("an export");
    assert!(file("printed.tex").contains("1 of 5 runs is not valid and was kept: rotation of the disc (1)."));
    assert!(file("printed.md").contains("1 of 5 runs is not valid and was kept: rotation of the disc (1)."));
    let drawn = file("picture.svg");
    assert!(drawn.contains(left), "{drawn}");
    space.stdout(&["report", "w.toml", "-o", "page.html"]);
    let page = std::fs::read_to_string(space.path("page.html")).expect("the page");
    for words in [left, "1 of 5 runs is not valid: rotation of the disc (1)", "is to be read with caution: coarse (1)"]
    {
        assert!(page.contains(words), "no `{words}` in the report");
    }
}

/// The same words for one run as for many.
#[test]
fn one_run_of_a_program_is_treated_as_many_are() {
    let space = space("");
    for (value, words, columns) in [
        (
            "3",
            "the run is not valid: rotation of the disc",
            "response,value,unit,validity\ny,100,MPa,rotation of the disc\n",
        ),
        ("5", "the run is to be read with caution: coarse", "response,value,unit,cautions\ny,10,MPa,coarse\n"),
    ] {
        let text = WORKFLOW
            .replace("design = \"points\"\nmaterial", "material")
            .replace("m = { x = 4 }", &format!("m = {{ x = {value} }}"));
        let text = text.split("[stage.fit]").next().expect("the first stages").replace("{{x}}", "{{m.x}}");
        space.write("one.toml", &text);
        space.write("engine.sh", &ENGINE.replace("{{x}}", "{{m.x}}"));
        let output = space.flow(&["run", "one.toml", "runs"]);
        assert!(told(&output).contains(&format!("note: runs: {words}")), "{}", told(&output));
        let shown = space.stdout(&["show", "one.toml", "runs", "--table", "responses", "--csv", "--quiet"]);
        assert_eq!(shown, columns);
    }
}

const CALIBRATION: &str = r#"
[stage.found]
kind = "calibrate"
surfaces = "fit"
factors = ["x"]
targets = [{ y = "8.4 MPa" }]
[stage.verified]
kind = "verify"
solution = "found"
simulator = "runs"
replicates = 4
"#;

#[test]
fn a_verification_leaves_out_counts_and_names_runs_that_are_not_valid() {
    let space = space(CALIBRATION);
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let left = "1 of 4 runs is not valid and was left out: rotation of the disc (1)";
    assert!(told(&output).contains(left), "{}", told(&output));
    let shown = |table: &str| -> Value {
        let text = space.stdout(&["show", "w.toml", "verified", "--table", table, "--json", "--quiet"]);
        serde_json::from_str(&text).expect("JSON")
    };
    let summary = shown("summary");
    let column = |name: &str| {
        let columns = summary["columns"].as_array().expect("columns");
        columns.iter().find(|column| column["name"] == name).map(|column| column["values"][0].clone())
    };
    assert_eq!(column("n").and_then(|n| n.as_i64()), Some(3), "{summary}");
    let mean = column("mean").and_then(|mean| mean.as_f64()).expect("a mean");
    assert!((mean - 8.4).abs() < 1e-6, "{summary}");
    space.stdout(&["report", "w.toml", "-o", "page.html"]);
    assert!(std::fs::read_to_string(space.path("page.html")).expect("the page").contains(left));
    let refused = space.flow(&["run", "w.toml", "verified", "--set", "stage.verified.invalid=refuse"]);
    assert_eq!(refused.status.code(), Some(1), "{}", told(&refused));
    assert!(told(&refused).contains("not valid: rotation of the disc"), "{}", told(&refused));
    let kept = space.flow(&["run", "w.toml", "verified", "--set", "stage.verified.invalid=keep"]);
    assert!(told(&kept).contains("1 of 4 runs is not valid and was kept"), "{}", told(&kept));
}

#[test]
fn a_verdict_that_cannot_be_read_is_no_valid_run() {
    let space = space("");
    let bad = |set: &str| told(&space.flow(&["run", "w.toml", "runs", "--set", set]));
    let missing = bad("stage.runs.validity={ file = \"out.json\", pointer = \"/verdict\" }");
    assert!(missing.contains("`out.json`: nothing at `/verdict`"), "{missing}");
    let number = bad("stage.runs.validity={ file = \"out.json\", pointer = \"/y\" }");
    assert!(number.contains("neither a text, nor a list of texts, nor null"), "{number}");
    let checked = space.flow(&["check", "w.toml", "--set", "stage.runs.validity={ file = \"../x\" }"]);
    assert_eq!(checked.status.code(), Some(2));
    assert!(told(&checked).contains("`../x` must be a plain name"), "{}", told(&checked));
    space.write("w.toml", &WORKFLOW.replace("file = \"out.json\", pointer = \"/checks\"", "file = \"out.json\""));
    let checked = told(&space.flow(&["check", "w.toml"]));
    assert!(checked.contains("0 ways to read `validity`, not one"), "{checked}");
    space.write("w.toml", WORKFLOW);
    // No match of a pattern is no reason.
    let log = "file = \"stdout\", pattern = 'NOT VALID: (.+)'";
    space.write("w.toml", &WORKFLOW.replace("file = \"out.json\", pointer = \"/checks\"", log));
    space.run(&["runs"]);
    let runs = space.stdout(&["show", "w.toml", "runs", "--table", "runs", "--csv", "--quiet"]);
    assert!(runs.contains("\n3,100,,,\n"), "{runs}");
}
