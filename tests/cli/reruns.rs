//! Which edit runs what again: each line of the README's table.

use crate::space::Space;

/// A campaign of formulas: a table of runs and what is made of it.
const CAMPAIGN: &str = r#"
[workflow]
seed = 1
[factor]
a = { levels = [1, 2, 3], sets = "mortar.a" }
[material.base]
mortar = { a = 1, b = 2 }
[stage.table]
kind = "formula"
material = "base"
responses.y = { value = "mortar_a * mortar_b" }
"#;

#[test]
fn nothing_changed_runs_nothing_and_a_comment_is_nothing() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let first = space.run(&[]);
    first.expect(&[("table", 1)]);
    space.run(&[]).expect(&[]);
    space.write("w.toml", &CAMPAIGN.replace("[workflow]", "# a remark\n\n[workflow]   # another"));
    let again = space.run(&[]);
    again.expect(&[]);
    assert_eq!(again.objects, first.objects);
}

#[test]
fn a_value_changed_back_costs_nothing() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]).expect(&[("table", 1)]);
    space.run(&["--set", "material.base.mortar.b=3"]).expect(&[("table", 1)]);
    space.run(&[]).expect(&[]);
}

#[test]
fn two_empty_stores_give_the_same_objects_byte_for_byte() {
    let bytes = || {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        space.run(&[]);
        let files = space.objects();
        assert!(!files.is_empty());
        let name = |path: &std::path::Path| path.file_name().map(std::ffi::OsStr::to_owned);
        files.iter().map(|path| (name(path), std::fs::read(path).expect("an object"))).collect::<Vec<_>>()
    };
    assert_eq!(bytes(), bytes());
}
