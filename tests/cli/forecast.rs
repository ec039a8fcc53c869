//! What `flow plan` expects before anything ran.

use crate::space::Space;
use serde_json::Value;

/// What a plan says is what a run then does, stage by stage.
#[test]
fn a_plan_on_an_empty_store_counts_what_the_run_does() {
    let space = Space::new();
    space.write("w.toml", include_str!("small.toml"));
    let plan: Value = serde_json::from_str(&space.stdout(&["plan", "w.toml", "--json"])).unwrap();
    assert!(space.stdout(&["plan", "w.toml"]).contains("in all "));
    let ran = space.run(&[]).ran;
    for stage in plan["stages"].as_array().unwrap() {
        let name = stage["name"].as_str().unwrap();
        let did = ran.iter().find(|(own, _)| own == name).map_or(0, |(_, count)| *count);
        let expected = &stage["expected"];
        let tasks = expected["tasks"].as_u64().unwrap_or_else(|| stage["to_run"].as_u64().unwrap());
        if expected["at_most"] == true {
            assert!((1..=tasks).contains(&did), "{name}: at most {tasks} expected, {did} ran");
        } else {
            assert_eq!(tasks, did, "{name}");
        }
    }
}
