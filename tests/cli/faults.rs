//! Faults that a campaign must survive.

use crate::space::{Space, told};

const CAMPAIGN: &str = r#"
[workflow]
seed = 1
[stage.first]
kind = "command"
run = ["sh", "-c", "echo 1"]
read.y = { file = "stdout", pattern = '(\d+)' }
"#;

#[test]
fn a_damaged_object_is_set_aside_told_and_computed_again() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let first = space.run(&[]);
    let path = space.objects().remove(0);
    for damage in ["", "nonsense"] {
        std::fs::write(&path, damage).expect("damaging an object");
        let shown = space.flow(&["show", "w.toml", "first"]);
        assert!(!shown.status.success(), "{}", told(&shown));
        let again = space.run(&[]);
        again.expect(&[("first", 1)]);
        assert_eq!(again.objects, first.objects);
    }
}

#[test]
fn a_folder_that_is_no_store_is_told_with_exit_code_3() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.write("store", "a file");
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(3), "{}", told(&output));
}

/// Rows by a formula on a design of three levels.
fn fan_out(levels: &str, value: &str) -> String {
    format!(
        r#"
[workflow]
seed = 1
[factor]
a = {{ sets = "mortar.a", levels = {levels} }}
[response]
y = {{ unit = "MPa" }}
[material.base]
mortar = {{ a = 1 }}
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.rows]
kind = "formula"
design = "grid"
material = "base"
responses.y = {{ value = "{value}", unit = "Pa" }}
"#
    )
}

/// The file of the object whose task names this work.
fn object_of(space: &Space, work: &str) -> std::path::PathBuf {
    let line = format!("work {work} ");
    let holds = |path: &std::path::PathBuf| {
        let bytes = std::fs::read(path).expect("an object");
        bytes.windows(line.len()).any(|window| window == line.as_bytes())
    };
    space.objects().into_iter().find(holds).expect("an object of this work")
}

#[test]
fn a_result_that_a_stage_must_see_is_computed_again_in_the_same_run() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    let first = space.run(&[]);
    std::fs::write(object_of(&space, "design"), "nonsense").expect("damaging an object");
    space.write("w.toml", &fan_out("[1, 2, 3]", "4*a"));
    let again = space.run(&[]);
    again.expect(&[("grid", 1), ("rows", 4)]);
    assert_eq!(again.objects[0], first.objects[0]);
    assert!(space.stdout(&["store", "verify"]).contains("are sound"));
}

#[test]
fn a_task_input_that_is_lost_is_computed_again_in_the_same_run() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    space.run(&[]);
    std::fs::write(object_of(&space, "formula"), "").expect("damaging an object");
    // Another unit of the table: only gathering is new, and it reads all runs.
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a").replace("y = { unit = \"MPa\" }", "y = { unit = \"kPa\" }"));
    space.run(&[]).expect(&[("rows", 2)]);
}

#[test]
fn remembered_runs_give_the_table_that_all_runs_give() {
    let (space, fresh) = (Space::new(), Space::new());
    let changed = fan_out("[1, 2.5, 3, 4]", "if_large");
    let formula = "1/max(0, a - 2)"; // No value at a = 1 and 2: these runs fail.
    let changed = changed.replace("if_large", formula);
    space.write("w.toml", &fan_out("[1, 2, 3, 4]", formula));
    space.run(&[]);
    space.write("w.toml", &changed);
    fresh.write("w.toml", &changed);
    let (ran, all) = (space.run(&[]), fresh.run(&[]));
    ran.expect(&[("grid", 1), ("rows", 2)]);
    assert_eq!(ran.objects, all.objects);
    let files =
        |space: &Space| space.objects().iter().map(|p| p.file_name().map(ToOwned::to_owned)).collect::<Vec<_>>();
    assert!(files(&fresh).iter().all(|name| files(&space).contains(name)));
}
