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
