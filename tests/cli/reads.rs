//! Columns that a stage names and its table does not have: known before the run, with those that there are.

use crate::space::{Space, told};

const HEAD: &str = r#"
[workflow]
seed = 1
[factor]
a = { sets = "m.a", levels = [1, 2] }
b = { sets = "m.a", levels = [1, 2] }
p = { unit = "MPa", range = [0, 50] }
[response]
y = {}
z = {}
strength = { unit = "MPa" }
[material.base]
m = { a = 1 }
[stage.d]
kind = "data"
file = "d.csv"
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.sim]
kind = "formula"
design = "grid"
material = "base"
responses.y = { value = "a" }
[stage.s]
"#;

/// What `check` says of a stage `s` beside a table of measurements and a simulator.
fn said(stage: &str) -> (Option<i32>, String) {
    let space = Space::new();
    space.write("d.csv", "sample,a,y\nA1,1,3\nA2,2,4\nA3,1,5\nA4,2,7\n");
    space.write("w.toml", &format!("{HEAD}{stage}\n"));
    let output = space.flow(&["check", "w.toml"]);
    (output.status.code(), told(&output))
}

/// The words with which `check` refuses this stage: `table` lacks the column, and these are those that it has.
fn refused(stage: &str, column: &str, table: &str, columns: &str) -> String {
    let (code, said) = said(stage);
    assert_eq!(code, Some(2), "{stage}: {said}");
    assert!(said.contains(&format!("`{column}` is no column of `{table}`")), "{stage}: {said}");
    assert!(said.contains(&format!("`{table}` has {columns}")), "{stage}: {said}");
    said
}

#[test]
fn every_kind_of_stage_that_names_a_column_is_told_of_it_before_the_run() {
    for (stage, column) in [
        ("kind = \"anova\"\ntable = \"d\"\nfactors = [\"a\", \"b\"]", "b"),
        ("kind = \"anova\"\ntable = \"d\"\nresponses = [\"z\"]", "z"),
        ("kind = \"anova\"\ntable = \"d\"\nweights = \"n\"", "n"),
        ("kind = \"range\"\ntable = \"d\"\nfactors = [\"b\"]", "b"),
        ("kind = \"screening\"\ntable = \"d\"\nterms = [\"b\"]", "b"),
        ("kind = \"regression\"\ntable = \"d\"\nterms.y = [\"ln(b)\"]", "b"),
        ("kind = \"regression\"\ntable = \"d\"\nby = [\"sampel\"]\nterms.y = [\"a\"]", "sampel"),
        ("kind = \"rsm\"\ntables = [\"d\"]\nresponses = [\"z\"]", "z"),
        ("kind = \"envelope\"\ntable = \"d\"\nconfinement = \"p\"\nstrength = \"strength\"", "strength"),
        ("kind = \"agreement\"\nof = \"d\"\ncompare = \"d\"\nresponses = [\"z\"]", "z"),
        ("kind = \"table\"\nof = \"d\"\ncolumns = [\"a\", \"x\"]", "x"),
        ("kind = \"table\"\nof = \"d\"\nwhere = { x = \"1\" }", "x"),
        ("kind = \"table\"\nof = \"d\"\npivot = { down = \"a\", across = \"x\", value = \"y\" }", "x"),
        ("kind = \"figure\"\nshow = \"xy\"\nof = \"d\"\nx = \"a\"\ny = \"u\"", "u"),
        ("kind = \"figure\"\nshow = \"box\"\nof = \"d\"\ny = \"y\"\nby = \"u\"", "u"),
        ("kind = \"figure\"\nshow = \"histogram\"\nof = \"d\"\nx = \"y\"\nwhere = { u = \"1\" }", "u"),
        ("kind = \"figure\"\nshow = \"points\"\nof = \"d\"\nfactors = [\"a\", \"b\"]", "b"),
    ] {
        let said = refused(stage, column, "d", "sample, a, y");
        assert!(said.contains("--> w.toml:"), "the line is named; {stage}: {said}");
    }
}

#[test]
fn the_columns_of_a_simulator_are_those_of_its_design_and_its_responses() {
    for (stage, column) in [
        ("kind = \"anova\"\ntable = \"sim\"\nfactors = [\"b\"]", "b"),
        ("kind = \"figure\"\nshow = \"xy\"\nof = \"sim\"\nx = \"a\"\ny = \"sample\"", "sample"),
        ("kind = \"table\"\nof = \"sim\"\ncolumns = [\"z\"]", "z"),
    ] {
        refused(stage, column, "sim", "a, y");
    }
    // A response that a simulator does not give is said once.
    let (_, twice) = said("kind = \"anova\"\ntable = \"sim\"\nresponses = [\"z\"]");
    assert_eq!(twice.matches("`z` is no").count(), 1, "{twice}");
}

#[test]
fn what_there_is_passes() {
    for stage in [
        "kind = \"anova\"\ntable = \"d\"",
        "kind = \"regression\"\ntable = \"d\"\nby = [\"sample\"]\nterms.y = [\"ln(a)\"]",
        "kind = \"table\"\nof = \"sim\"\ncolumns = [\"a\", \"y\", \"failure\"]",
        "kind = \"figure\"\nshow = \"xy\"\nof = \"sim\"\nx = \"a\"\ny = \"y\"",
        "kind = \"figure\"\nshow = \"box\"\nof = \"d\"\ny = \"y\"\nby = \"sample\"",
        "kind = \"table\"\nof = \"s2\"\ncolumns = [\"source\", \"f\"]\n[stage.s2]\nkind = \"anova\"\ntable = \"d\"",
    ] {
        let (code, said) = said(stage);
        assert_eq!(code, Some(0), "{stage}: {said}");
    }
}

#[test]
fn a_table_in_which_nothing_can_be_analysed_is_refused() {
    for (csv, words) in [
        ("sample,a\nA1,1\nA2,2\n", "no column of `d` is a [response]"),
        ("sample,y\nA1,1\nA2,2\n", "no column of `d` is a [factor]"),
    ] {
        let space = Space::new();
        space.write("d.csv", csv);
        space.write("w.toml", &format!("{HEAD}kind = \"anova\"\ntable = \"d\"\n"));
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{}", told(&output));
        assert!(told(&output).contains(words), "{}", told(&output));
    }
}
