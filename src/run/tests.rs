//! What the loop makes of a panic.

use super::*;

#[test]
fn a_panic_in_a_task_becomes_its_failure_with_what_was_said() {
    for panic in [catch_unwind(|| panic!("BUG: {}", 7)), catch_unwind(|| panic!("BUG: 7"))] {
        let Failure::Failed(error) = panicked(&*panic.unwrap_err()) else { panic!("not a failure") };
        assert!(error.message.ends_with("BUG: 7") && error.hint.is_some(), "{error:?}");
    }
}
