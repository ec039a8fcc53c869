//! The calibrator page: what it holds, and, in a browser, that it says what `flow calibrate` says.

use super::space::{Space, told};
use std::process::Command;

const CAMPAIGN: &str = include_str!("campaign.toml");

fn page(space: &Space, more: &[&str]) -> String {
    space.stdout(&[&["calibrate", "w.toml", "--page", "page.html"], more].concat());
    std::fs::read_to_string(space.path("page.html")).expect("the page")
}

#[test]
fn the_page_is_one_small_file_with_the_numbers_of_the_surfaces_and_computes_nothing() {
    let space = Space::new();
    // A name that would end the element that holds it.
    space.write("w.toml", &CAMPAIGN.replace("seed = 1", "seed = 1\ntitle = \"</script><script>alert(1)</script>\""));
    let early = space.flow(&["calibrate", "w.toml", "--page", "page.html"]);
    assert_eq!(early.status.code(), Some(2), "{}", told(&early));
    assert!(told(&early).contains("run first: flow run w.toml surfaces"), "{}", told(&early));
    space.run(&["surfaces"]);
    let before = space.objects();
    let text = page(&space, &[]);
    assert!(text.len() <= 300_000, "{} bytes", text.len());
    assert!(!text.contains("<script>alert") && !text.contains("src=\"http"));
    assert!(text.contains("\"targets\":[{\"response\":0,\"low\":16.0,\"high\":16.0"), "the workflow's targets");
    assert_eq!(page(&space, &[]), text, "the same each time");
    assert!(page(&space, &["--target", "y=18.5 MPa"]).contains("\"low\":18.5,"), "targets of the command line");
    assert_eq!(space.objects(), before, "nothing is computed");
    assert!(space.stdout(&["calibrate", "w.toml", "--page", "-"]).starts_with("<!DOCTYPE html>"));
}

/// Factors and responses may be called as what every object of the language of the page has.
#[test]
fn names_of_the_language_of_the_page_are_names_like_others() {
    let renamed = CAMPAIGN
        .replace("\na = {", "\nconstructor = {")
        .replace("\ny = {", "\ntoString = {")
        .replace("\"a\"", "\"constructor\"")
        .replace("\"y\"", "\"toString\"")
        .replace("{ y = \"16", "{ toString = \"16")
        .replace("responses.y", "responses.toString")
        .replace("3*a", "3*constructor");
    in_a_browser(&renamed);
}

#[test]
fn the_page_says_in_a_browser_what_flow_calibrate_says() {
    in_a_browser(CAMPAIGN);
}

/// Needs Chromium and playwright; CI installs both.
fn in_a_browser(campaign: &str) {
    let required = std::env::var("FLOW_TEST_READERS").is_ok();
    let there = Command::new("python3").args(["-c", "import playwright"]).output().is_ok_and(|o| o.status.success())
        && ["chromium", "chromium-browser", "google-chrome"]
            .iter()
            .any(|name| Command::new(name).arg("--version").output().is_ok());
    if !there {
        assert!(!required, "Chromium or playwright is missing");
        return;
    }
    let space = Space::new();
    space.write("w.toml", campaign);
    space.run(&["surfaces"]);
    page(&space, &[]);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/calibrator_check.py");
    let flow = format!("{} calibrate w.toml", env!("CARGO_BIN_EXE_flow"));
    let mut check = Command::new("python3");
    check.current_dir(space.path(".")).arg(script).arg(space.path("page.html")).args([
        "--flow",
        &flow,
        "--targets",
        "40",
    ]);
    let output = check.output().expect("running python3");
    assert!(output.status.success(), "{}", told(&output));
}
