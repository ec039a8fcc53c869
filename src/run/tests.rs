//! What the loop makes of a panic, and what it tells the person who watches it.

use super::*;
use crate::plan::{Overrides, load};
use std::sync::Mutex;

#[test]
fn a_panic_in_a_task_becomes_its_failure_with_what_was_said() {
    for panic in [catch_unwind(|| panic!("BUG: {}", 7)), catch_unwind(|| panic!("BUG: 7"))] {
        let Failure::Failed(error) = panicked(&*panic.unwrap_err()) else { panic!("not a failure") };
        assert!(error.message.ends_with("BUG: 7") && error.hint.is_some(), "{error:?}");
    }
}

const DESIGN: &str = r#"
[workflow]
seed = 1
[factor]
a = { levels = [1, 2, 3] }
[stage.other]
kind = "design"
method = "given"
file = "other.csv"
factors = ["a"]
[stage.design]
kind = "design"
method = "given"
file = "rows.csv"
factors = ["a"]
[stage.before]
kind = "formula"
design = "other"
responses.y = { value = "a^2" }
[stage.runs]
kind = "formula"
design = "design"
responses.z = { value = "a^3" }
"#;

/// Every [`Event::Counted`]: stage, tasks in all and in the store, and whether it asks for nothing more.
#[derive(Default)]
struct Counts(Mutex<Vec<(String, usize, usize, bool)>>);

impl Watch for Counts {
    fn event(&self, event: Event<'_>) {
        if let Event::Counted { stage, count, is_done } = event {
            self.0.lock().unwrap().push((stage.to_owned(), count.total, count.cached, is_done));
        }
    }
}

#[test]
fn what_the_store_holds_is_counted_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let store = Store::open(&folder.join("store")).unwrap();
    let (targets, again) = (Vec::new(), Vec::new());
    let settings = RunSettings { jobs: 1, keep_going: true, dry: false, targets, again, memos: true, cluster: None };
    let counts = |rows: &str| {
        std::fs::write(folder.join("w.toml"), DESIGN).unwrap();
        std::fs::write(folder.join("other.csv"), "a\n1\n2\n3\n").unwrap();
        std::fs::write(folder.join("rows.csv"), rows).unwrap();
        let workflow = load(&folder.join("w.toml"), &Overrides::default());
        let workflow = workflow.unwrap_or_else(|faults| panic!("{}", faults[0].message));
        let watch = Counts::default();
        run(&workflow, &store, &settings, &watch, &AtomicBool::new(false));
        let mut found = watch.0.into_inner().unwrap();
        found.retain(|(stage, ..)| stage == "before" || stage == "runs");
        found.sort();
        found
    };
    let (before, runs) = ("before".to_owned(), "runs".to_owned());
    // three runs, and the task that gathers them
    assert_eq!(counts("a\n1\n2\n"), [(before.clone(), 4, 0, false), (runs.clone(), 3, 0, false)]);
    // One stage is as it was, and of the other two of three runs are there.
    assert_eq!(counts("a\n1\n2\n3\n"), [(before, 4, 4, true), (runs, 4, 2, false)]);
}
