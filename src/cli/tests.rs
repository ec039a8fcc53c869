//! The commands on a workflow with a kind of stage that was added as the head of `stage` says.

use super::{Exit, execute};
use std::fs::read_to_string;
use std::path::Path;

const WORKFLOW: &str = r#"
[workflow]
seed = 1
[factor]
a = { levels = [1, 2, 3] }
[response]
y = { unit = "MPa" }
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.runs]
kind = "formula"
design = "grid"
responses.y = { value = "1/(a - 2)", unit = "MPa" }
[stage.endings]
kind = "census"
table = "runs"
[stage.printed]
kind = "table"
of = "endings"
[stage.flow]
kind = "figure"
show = "dag"
of = "endings"
"#;

fn flow(folder: &Path, arguments: &[&str]) -> Exit {
    let file = folder.join("new.toml").display().to_string();
    let store = folder.join("store").display().to_string();
    let filled = |argument: &&str| match *argument {
        "W" => file.clone(),
        "S" => store.clone(),
        other => other.replace("F/", &format!("{}/", folder.display())),
    };
    execute(std::iter::once("flow".to_owned()).chain(arguments.iter().map(filled)))
}

#[test]
fn a_new_kind_works_in_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("new.toml"), WORKFLOW).unwrap();
    for arguments in [
        &["check", "W"][..],
        &["plan", "W", "--store", "S"],
        &["run", "W", "--store", "S", "--quiet"],
        &["plan", "W", "--store", "S", "endings"],
        &["graph", "W", "--store", "S"],
        &["show", "W", "endings", "--store", "S"],
        &["show", "W", "endings", "--store", "S", "--json"],
        &["report", "W", "--store", "S", "--output", "F/report.html"],
        &["export", "W", "--store", "S", "--folder", "F/files", "--quiet"],
        &["diff", "F/new.toml", "F/new.toml", "--store", "S"],
    ] {
        assert_eq!(flow(folder, arguments), Exit::Done, "{arguments:?}");
    }
    let file = |name: &str| read_to_string(folder.join(name)).unwrap();
    assert_eq!(file("files/endings.endings.csv"), "ending,runs\n`y` is inf,1\ndone,2\n");
    assert_eq!(file("files/printed.csv"), "ending,runs\n`y` is inf,1\ndone,2\n");
    // The picture of the workflow has the kind among the statistics.
    let picture = file("files/flow.svg");
    assert!(picture.contains("census") && picture.contains("statistics"), "{picture}");
    let page = file("report.html");
    assert!(page.contains("id=\"stage-endings\"") && page.contains("How many runs of a table ended in which way"));
    let schema = crate::plan::schema::schema().to_string();
    assert!(schema.contains("How many runs") || schema.contains("how many runs of a table ended in which way"));
}

#[test]
fn a_wrong_input_of_a_new_kind_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = WORKFLOW.replace("table = \"runs\"", "table = \"grid\"");
    std::fs::write(folder.path().join("new.toml"), wrong).unwrap();
    assert_eq!(flow(folder.path(), &["check", "W"]), Exit::BadInput);
}
