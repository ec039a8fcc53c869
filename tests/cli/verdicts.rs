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

/// A calibration that runs the program itself: y = 2 x, and between 3 and 4 the disc turns and shows 100.
const LOOP: &str = r#"
[workflow]
seed = 7
[factor]
x = { sets = "m.x", range = [1, 5] }
[response]
y = { unit = "MPa" }
[material.base]
m = { x = 4 }
[stage.runs]
kind = "command"
material = "base"
run = ["sh", "engine.sh"]
templates = { "engine.sh" = "engine.sh" }
read.y = { file = "out.json", pointer = "/y", unit = "MPa" }
validity = { file = "out.json", pointer = "/checks" }
[stage.found]
kind = "calibrate"
simulator = "runs"
factors = ["x"]
targets = [{ y = "8.4 MPa" }]
method = "genetic"
[stage.found.genetic]
population = 6
generations = 4
[stage.verified]
kind = "verify"
solution = "found"
simulator = "runs"
replicates = 3
"#;

fn in_a_loop(turns: &str) -> Space {
    let space = Space::new();
    space.write(
        "engine.sh",
        &format!(
            "awk 'BEGIN {{ x = {{{{m.x}}}}; turns = ({turns}); v = turns ? \"\\\"rotation\\\"\" : \"null\";\n\
             printf \"{{\\\"y\\\": %.17g, \\\"checks\\\": %s}}\\n\", turns ? 100 : 2 * x, v > \"out.json\" }}'\n"
        ),
    );
    space.write("w.toml", LOOP);
    space
}

/// The cells of a column of a table.
fn cells(space: &Space, more: &[&str], table: &str, column: &str) -> Vec<Value> {
    let text = space.stdout(&[&["show", "w.toml", "found", "--table", table, "--json", "--quiet"], more].concat());
    let shown: Value = serde_json::from_str(&text).expect("JSON");
    let columns = shown["columns"].as_array().expect("columns");
    let found = columns.iter().find(|own| own["name"] == column);
    found.map(|own| own["values"].as_array().expect("values").clone()).unwrap_or_default()
}

#[test]
fn a_calibration_that_runs_the_program_leaves_out_keeps_or_refuses_runs_that_are_not_valid() {
    let space = in_a_loop("x > 3 && x < 4");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let texts =
        |values: Vec<Value>| values.into_iter().map(|v| v.as_str().unwrap_or("").to_owned()).collect::<Vec<_>>();
    let failures = texts(cells(&space, &[], "history", "failure"));
    let left = failures.iter().filter(|failure| *failure == "not valid: rotation").count();
    assert!(left > 0, "no run was in the range: {failures:?}");
    assert_eq!(failures.iter().filter(|failure| !failure.is_empty()).count(), left);
    let notes = texts(cells(&space, &[], "notes", "note")).join("\n");
    let counted = format!("{left} of {} evaluations gave no result: not valid: rotation ({left})", failures.len());
    assert!(notes.contains(&counted), "{notes}");
    let xs: Vec<f64> = cells(&space, &[], "history", "x").iter().filter_map(Value::as_f64).collect();
    for (x, failure) in xs.iter().zip(&failures) {
        assert_eq!(*x > 3.0 && *x < 4.0, !failure.is_empty(), "{x}");
    }
    // None of them is among what the solution rests on.
    let best = cells(&space, &[], "solution", "x")[0].as_f64().expect("a solution");
    assert!(!(3.0..4.0).contains(&best) && (best - 4.2).abs() < 0.5, "{best}");

    let keep = ["--set", "stage.found.invalid=keep"];
    assert!(space.flow(&[&["run", "w.toml", "found"], &keep[..]].concat()).status.success());
    let marks = texts(cells(&space, &keep, "history", "validity"));
    let kept = marks.iter().filter(|mark| *mark == "rotation").count();
    assert!(kept > 0);
    let responses: Vec<f64> = cells(&space, &keep, "history", "y").iter().filter_map(Value::as_f64).collect();
    assert_eq!(responses.iter().filter(|y| **y == 100.0).count(), kept, "kept runs have their responses");

    let refused = space.flow(&["run", "w.toml", "found", "--set", "stage.found.invalid=refuse"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(told(&refused).contains("found: a run is not valid: rotation"), "{}", told(&refused));
}

/// With proportional corrections one run in the range is passed by, and two good ones meet the target.
#[test]
fn proportional_corrections_go_on_after_a_run_that_is_not_valid() {
    let space = in_a_loop("x > 2.9 && x < 3.1");
    let method = ["--set", "stage.found.method=proportional"];
    let text = LOOP.split("[stage.found.genetic]").next().expect("the first stages");
    space.write("w.toml", text);
    let output = space.flow(&[&["run", "w.toml", "found"], &method[..]].concat());
    assert!(output.status.success(), "{}", told(&output));
    let xs: Vec<f64> = cells(&space, &method, "history", "x").iter().filter_map(Value::as_f64).collect();
    assert!(xs.len() == 3 && (xs[1] - 3.3).abs() < 1e-9 && (xs[2] - 4.2).abs() < 1e-9, "{xs:?}");
    let space = in_a_loop("1");
    space.write("w.toml", text);
    let output = space.flow(&[&["run", "w.toml", "found"], &method[..]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(told(&output).contains("all 7 simulations failed; the first: not valid: rotation"), "{}", told(&output));
}

#[test]
fn a_verification_of_which_no_run_is_valid_knows_no_mean_and_no_deviation() {
    let space = space(CALIBRATION);
    space.write("engine.sh", &ENGINE.replace("r % 4 == 3", "r > 0"));
    let output = space.flow(&["run", "w.toml"]);
    let left = "4 of 4 runs are not valid and were left out: rotation of the disc (4)";
    assert!(told(&output).contains(left), "{}", told(&output));
    let shown = space.stdout(&["show", "w.toml", "verified", "--table", "summary", "--csv", "--quiet"]);
    assert!(shown.contains("\n1,y,MPa,8.4,,,,,,,,unknown,0\n"), "{shown}");
    let failed = space.flow(&["run", "w.toml", "verified", "--set", "stage.verified.unmet=fail"]);
    assert_eq!(failed.status.code(), Some(1));
    assert!(told(&failed).contains("set 1: no run gave a value of `y`"), "{}", told(&failed));
}
