//! Runs that are not valid: every kind of stage that takes runs says what became of them.

use crate::space::{Space, told};

/// Runs on a line y = 1 + 2 a, one of them far off it because the disc turned, and one that gave nothing.
const RUNS: &str = "a [mm],y [MPa],failure,validity\n1,3,,\n2,5,,\n3,100,,rotation\n4,9,,\n5,11,,\n2,,no peak,no peak\n1,3.02,,\n3,6.98,,\n";

fn workflow(invalid: &str) -> String {
    let stages = [
        ("fit", "kind = 'regression'\ntable = 'runs'\nterms.y = ['a']"),
        ("groups", "kind = 'regression'\ntable = 'runs'\nterms.y = ['a']\nby = ['site']"),
        ("surface", "kind = 'rsm'\ntables = ['runs']\nresponses = ['y']\nterms.y = ['a']"),
        ("variances", "kind = 'anova'\ntable = 'runs'\nfactors = ['a']"),
        ("ranges", "kind = 'range'\ntable = 'runs'\nfactors = ['a']"),
        ("effects", "kind = 'screening'\ntable = 'runs'\nterms = ['b']"),
        ("pairs", "kind = 'agreement'\nof = 'runs'\ncompare = 'printed'"),
        ("printed_table", "kind = 'table'\nof = 'runs'\ncolumns = ['a', 'y']\ndigits = 6"),
        ("picture", "kind = 'figure'\nshow = 'xy'\nof = 'runs'\nx = 'a'\ny = 'y'\nfit = 'line'"),
        ("bars", "kind = 'figure'\nshow = 'histogram'\nof = 'runs'\nx = 'y'"),
        ("points", "kind = 'figure'\nshow = 'agreement'\nof = 'runs'\ncompare = 'printed'"),
    ];
    let head = "[workflow]\nseed = 1\n[factor]\na = { unit = 'mm', levels = [1, 2, 3, 4, 5] }\nb = { levels = [0, 1] }\n[response]\ny = { unit = 'MPa' }\n";
    let data = "[stage.runs]\nkind = 'data'\nfile = 'runs.csv'\n[stage.printed]\nkind = 'data'\nfile = 'printed.csv'\n";
    let stage = |(name, text): &(&str, &str)| format!("[stage.{name}]\n{text}\n{invalid}\n");
    format!("{head}{data}{}", stages.iter().map(stage).collect::<String>())
}

fn space(invalid: &str) -> Space {
    let space = Space::new();
    space.write("w.toml", &workflow(invalid));
    let more = |(row, line): (usize, &str)| match row {
        0 => format!("{line},site,b\n"),
        _ => format!("{line},one,{}\n", row % 2),
    };
    space.write("runs.csv", &RUNS.lines().enumerate().map(more).collect::<String>());
    space.write("printed.csv", "a [mm],y [MPa]\n1,3\n2,5\n3,7\n4,9\n5,11\n");
    space
}

const LEFT: &str = "1 of 8 runs is not valid and was left out: rotation (1)";
const KEPT: &str = "1 of 8 runs is not valid and was kept: rotation (1)";

#[test]
fn statistics_leave_them_out_and_say_so() {
    let space = space("");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let said = told(&output);
    for stage in ["fit", "groups", "surface", "variances", "ranges", "effects", "pairs"] {
        assert!(said.contains(&format!("note: {stage}: y: {LEFT}")), "{stage}: {said}");
        let json = space.stdout(&["show", "w.toml", stage, "--json"]);
        assert!(json.contains("\"not_valid\""), "{stage}: {json}");
    }
    assert!(said.contains("note: runs: 1 of 8 runs gave no result: no peak (1)"), "{said}");
    assert!(said.contains("note: runs: 1 of 8 runs is not valid: rotation (1)"), "{said}");
    let slope = slope(&space);
    assert!((slope - 2.0).abs() < 0.02, "{slope}");
    let notes = space.stdout(&["show", "w.toml", "fit", "--table", "notes", "--csv"]);
    assert!(notes.contains(LEFT) && notes.contains("1 of 8 runs has no value; the analysis is of 6"), "{notes}");
    let page = space.flow(&["report", "w.toml", "-o", "page.html"]);
    assert!(page.status.success(), "{}", told(&page));
    let html = std::fs::read_to_string(space.path("page.html")).expect("the page");
    assert!(html.contains(LEFT) && html.contains("1 of 8 runs is not valid: rotation (1)"));
}

/// The slope of the fit.
fn slope(space: &Space) -> f64 {
    let table = space.stdout(&["show", "w.toml", "fit", "--table", "coefficients", "--csv"]);
    let line = table.lines().find(|line| line.contains(",a,")).expect("a slope");
    line.split(',').nth(2).expect("an estimate").parse().expect("a number")
}

/// Whether a table has the value of the run that is not valid.
fn has_100(csv: &str) -> bool {
    csv.split([',', '\n']).any(|cell| cell.parse() == Ok(100.0))
}

#[test]
fn tables_mark_them_and_figures_say_what_was_left_out() {
    let space = space("");
    let output = space.flow(&["run", "w.toml", "printed_table", "picture", "bars", "points"]);
    assert!(output.status.success(), "{}", told(&output));
    let table = space.stdout(&["show", "w.toml", "printed_table", "--table", "table", "--csv"]);
    assert!(table.contains("3,100,rotation"), "{table}");
    let json = space.stdout(&["show", "w.toml", "printed_table", "--json"]);
    assert!(json.contains("1 of 8 runs is not valid and was kept: rotation (1)."), "{json}");
    assert!(json.contains("footnotesize 1 of 8 runs gave no result: no peak (1)."), "{json}");
    for figure in ["picture", "bars", "points"] {
        let json = space.stdout(&["show", "w.toml", figure, "--json"]);
        assert!(json.contains(&format!("{LEFT}.")), "{figure}: {json}");
        let data = space.stdout(&["show", "w.toml", figure, "--table", "data", "--csv"]);
        assert!(!has_100(&data), "{figure}: {data}");
    }
}

#[test]
fn kept_ones_count_and_refused_ones_stop_the_stage() {
    let space = space("invalid = 'keep'");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let said = told(&output);
    assert!(said.contains(&format!("note: fit: y: {KEPT}")), "{said}");
    assert!((slope(&space) - 2.0).abs() > 0.1);
    let drawn = space.stdout(&["show", "w.toml", "picture", "--table", "data", "--csv"]);
    assert!(has_100(&drawn), "{drawn}");

    space.write("w.toml", &workflow("invalid = 'refuse'"));
    let output = space.flow(&["run", "w.toml", "--keep-going"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let said = told(&output);
    for stage in ["fit", "surface", "variances", "ranges", "effects", "pairs", "printed_table", "picture", "points"] {
        let line = format!("failed: {stage}: 1 of 8 runs is not valid: rotation (1)");
        assert!(said.contains(&line), "{stage}: {said}");
    }
    assert!(said.contains("invalid = \"keep\""), "{said}");
}

#[test]
fn an_analysis_that_lacks_what_was_left_out_says_so() {
    let space = space("");
    let runs = std::fs::read_to_string(space.path("runs.csv")).expect("runs");
    space.write("runs.csv", &runs.replace("3,6.98,,,one,0\n", ""));
    let output = space.flow(&["run", "w.toml", "variances"]);
    let said = told(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("never takes its level 3"), "{said}");
    assert!(said.contains("y: 1 of 7 runs is not valid and was left out: rotation (1)"), "{said}");
}

#[test]
fn a_choice_without_effect_and_an_unknown_one_are_faults() {
    let space = space("invalid = 'drop'");
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("leave-out") && said.contains("refuse"), "{said}");
    let text = workflow("").replace("show = 'histogram'", "show = 'specimen'\ninvalid = 'leave-out'");
    space.write("w.toml", &text);
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("`invalid` has no effect on a figure that shows `specimen`"), "{said}");
}

/// A Brazilian test has no modulus: said before anything runs, wherever it is asked for, with what the test gives.
#[test]
fn a_response_that_the_test_cannot_give_is_a_fault() {
    let space = Space::new();
    let workflow = r#"
[workflow]
seed = 1
[factor]
Ec = { sets = "mortar.Ec", unit = "GPa", range = [10, 20] }
[response]
E = { unit = "GPa" }
sigma_t = { unit = "kN" }
[material.m]
mortar = { Ec = "10 GPa", kn_ks = 2, sigma_c = "5 MPa", tau_c = "10 MPa", mu = 0.5 }
[stage.disc]
kind = "specimen"
diameter = "50 mm"
porosity = 0.12
mean_radius = "1 mm"
radius_ratio = 2
density = "2000 kg/m^3"
[stage.points]
kind = "design"
method = "full-factorial"
factors = ["Ec"]
[stage.split]
kind = "simulate"
specimen = "disc"
design = "points"
material = "m"
test = "brazilian"
platen_speed = "0.02 m/s"
[stage.ranges]
kind = "range"
table = "split"
responses = ["E"]
[stage.surface]
kind = "rsm"
tables = ["split"]
responses = ["E"]
[stage.found]
kind = "calibrate"
simulator = "split"
factors = ["Ec"]
targets = [{ E = "20 GPa" }]
"#;
    space.write("w.toml", workflow);
    let output = space.flow(&["check", "w.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    let said = told(&output);
    assert_eq!(said.matches("`E` is no response of `split`").count(), 3, "{said}");
    assert!(said.contains("`split` gives sigma_t, "), "{said}");
    assert!(said.contains("`sigma_t` comes in `Pa` and cannot be shown in `kN`"), "{said}");
}

/// Of discs whose radii differ eightfold the small ones are swallowed at 0.07 of the modulus: that row alone has no
/// result, and every disc that can be packed has one.
#[test]
fn a_disc_that_cannot_be_packed_costs_its_row_alone() {
    let space = Space::new();
    space.write(
        "w.toml",
        "[workflow]\nseed = 1\n[factor]\nratio = { sets = 'disc.radius_ratio', levels = [1.5, 2, 8] }\n\
         [response]\nsigma_t = { unit = 'MPa' }\n\
         [material.rock]\nrock = { Ec = '1 GPa', kn_ks = 2.5, sigma_c = '5 MPa', tau_c = '20 MPa', mu = 0.5 }\n\
         [stage.disc]\nkind = 'specimen'\ndiameter = '60 mm'\npacking = { stress = '70 MPa', modulus = '1 GPa' }\n\
         smallest_radius = '1 mm'\nradius_ratio = 1.5\ngives_way = 'number'\ndensity = '2600 kg/m^3'\ngroup = 'rock'\n\
         [stage.rows]\nkind = 'design'\nmethod = 'full-factorial'\nfactors = ['ratio']\n\
         [stage.runs]\nkind = 'simulate'\nspecimen = 'disc'\nmaterial = 'rock'\ndesign = 'rows'\ntest = 'brazilian'\n\
         bond = { kind = 'contact' }\nplaten_speed = { transits = 5 }\nmasses = 'equal-step'\n\
         [stage.fit]\nkind = 'regression'\ntable = 'runs'\nterms.sigma_t = ['ratio']\ninvalid = 'keep'\n",
    );
    let output = space.flow(&["run", "w.toml"]);
    let said = told(&output);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("runs: 1 of 3 runs gave no result: no specimen: packing: overlaps reach"), "{said}");
    let notes = space.stdout(&["show", "w.toml", "fit", "--table", "notes", "--csv"]);
    assert!(notes.contains("1 of 3 runs has no value; the analysis is of 2"), "{notes}");
    let runs = space.stdout(&["show", "w.toml", "runs", "--csv"]);
    let rows: Vec<&str> = runs.lines().skip(1).collect();
    assert_eq!(rows.len(), 3, "{runs}");
    assert!(rows[2].starts_with("8,,") && rows[2].contains("overlaps reach"), "{runs}");
    assert!(rows[..2].iter().all(|row| !row.contains("no specimen")), "{runs}");
    // A second run repeats nothing: the reason is stored.
    assert!(space.run(&[]).ran.is_empty());
}

#[test]
fn a_group_without_a_fit_says_how_many_of_its_runs_are_missing() {
    let space = Space::new();
    space.write(
        "w.toml",
        "[workflow]\nseed = 1\n[factor]\na = { levels = [1, 2, 3] }\n[response]\ny = {}\n[stage.runs]\nkind = 'data'\n\
         file = 'runs.csv'\n[stage.groups]\nkind = 'regression'\ntable = 'runs'\nterms.y = ['a']\nby = ['site']\n",
    );
    space.write("runs.csv", "a,y,validity,site\n1,3,,1\n2,5,,1\n3,7.1,,1\n1,3,rotation,2\n2,5,rotation,2\n3,7,,2\n");
    space.run(&[]);
    let table = space.stdout(&["show", "w.toml", "groups", "--table", "groups", "--csv"]);
    let column = |name: &str| table.lines().next().unwrap().split(',').position(|head| head == name).expect("a column");
    let missing = |group: &str| {
        let line = table.lines().find(|line| line.starts_with(group)).expect("the group");
        line.split(',').nth(column("missing")).expect("a cell")
    };
    assert_eq!((missing("y,1,"), missing("y,2,")), ("0", "2"), "{table}");
    assert!(table.contains("has 1 usable rows (2 missing) for 2 coefficients"), "{table}");
    let notes = space.stdout(&["show", "w.toml", "groups", "--table", "notes", "--csv"]);
    assert!(notes.contains("site 2: 2 of 3 runs have no value or are left out"), "{notes}");
}
