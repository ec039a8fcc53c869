//! The report: what it says of a campaign, whole or in part, and that it is the same each time.

use super::space::{Space, told};

const CAMPAIGN: &str = include_str!("campaign.toml");

#[test]
fn a_campaign_in_part_is_reported_as_such_and_a_whole_one_as_whole() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let none = space.flow(&["report", "w.toml"]);
    assert_eq!(none.status.code(), Some(1), "{}", told(&none));
    let said = String::from_utf8_lossy(&none.stderr).into_owned();
    assert!(said.contains("11 of 11 stages have no result") && said.contains("flow run w.toml"), "{said}");

    space.run(&[]);
    assert!(space.stdout(&["report", "w.toml", "-o", "a.html"]).starts_with("a.html"));
    let page = std::fs::read_to_string(space.path("a.html")).expect("the page");
    assert!(page.contains("All 11 stages have a result") && !page.contains("Incomplete"));
    for stage in ["grid", "table", "range", "anova", "surfaces", "calibrate", "verify", "effects", "means"] {
        assert!(page.contains(&format!("id=\"stage-{stage}\"")), "{stage}");
    }

    // Times are those of the records: later is the same.
    space.stdout(&["report", "w.toml", "-o", "b.html"]);
    assert!(std::fs::read_to_string(space.path("b.html")).expect("the page") == page);
    assert!(space.stdout(&["report", "w.toml", "-o", "-"]) == page);
}

#[test]
fn a_damaged_result_is_missing_and_never_shown() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]);
    let picture = space.stdout(&["show", "w.toml", "effects", "--path"]);
    let path = space.path(picture.trim());
    let mut bytes = std::fs::read(&path).expect("the object");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::remove_file(&path).expect("an object of our own");
    std::fs::write(&path, bytes).expect("the damaged object");
    let output = space.flow(&["report", "w.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains("no result: effects"), "{}", told(&output));
}
