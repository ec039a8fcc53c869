//! Every command of the README, run in order, on a campaign that has the names of c30.toml and takes seconds.

use crate::space::{Space, told};
use std::path::Path;

const README: &str = include_str!("../../README.md");

/// The words of a command line: quotes hold words together, a `#` between blanks begins a remark.
fn words(line: &str) -> Vec<String> {
    let line = line.split(" # ").next().unwrap_or(line);
    let mut words = vec![String::new()];
    let mut quote = None;
    for c in line.trim().chars() {
        match (c, quote) {
            ('\'' | '"', None) => quote = Some(c),
            (c, Some(q)) if c == q => quote = None,
            (' ', None) => words.push(String::new()),
            (c, _) => words.last_mut().unwrap().push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The commands in the blocks of the README that are for a shell.
fn commands() -> Vec<Vec<String>> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in README.lines() {
        match line {
            "```sh" => inside = true,
            "```" => inside = false,
            line if inside && !line.trim().is_empty() && !line.starts_with('#') => found.push(words(line)),
            _ => {}
        }
    }
    found
}

#[test]
fn the_first_two_commands_build_run_and_test() {
    let all = commands();
    assert_eq!(all[0][..6], ["cargo", "run", "--release", "--locked", "--", "run"]);
    assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(&all[0][6]).exists());
    assert_eq!(all[1], ["cargo", "test", "--release", "--locked"]);
}

#[test]
fn every_command_of_the_tour_works() {
    let space = Space::new();
    std::fs::create_dir(space.path("workflows")).unwrap();
    space.write("workflows/c30.toml", include_str!("small.toml"));
    let mut ran = 0;
    for command in commands().into_iter().skip(2) {
        if command[0] != "flow" {
            assert!(["cargo"].contains(&command[0].as_str()), "who tests {command:?}?");
            continue;
        }
        let arguments: Vec<&str> = command[1..].iter().map(String::as_str).collect();
        let output = space.flow(&arguments);
        assert!(output.status.success(), "flow {}\n{}", arguments.join(" "), told(&output));
        names_are_those_of_the_shipped_workflow(&arguments);
        ran += 1;
    }
    assert!(ran >= 12, "only {ran} commands");
}

/// Stages, profiles and settings that the README names are in the real workflow too: it is planned with them.
fn names_are_those_of_the_shipped_workflow(arguments: &[&str]) {
    let takes = ["run", "plan", "show", "export", "check", "graph"];
    let Some(["workflows/c30.toml", rest @ ..]) = arguments.get(1..).filter(|_| takes.contains(&arguments[0])) else {
        return;
    };
    let workflow = concat!(env!("CARGO_MANIFEST_DIR"), "/workflows/c30.toml");
    let mut plan = vec!["plan".to_owned(), workflow.to_owned()];
    let mut rest = rest.iter();
    while let Some(word) = rest.next() {
        match *word {
            "--profile" | "--set" => plan.extend([(*word).to_owned(), rest.next().unwrap().to_string()]),
            "--to" | "--folder" | "--table" | "--format" => drop(rest.next()),
            option if option.starts_with("--") => {}
            stage => plan.push(stage.split('[').next().unwrap().to_owned()),
        }
    }
    let space = Space::new();
    space.stdout(&plan.iter().map(String::as_str).collect::<Vec<_>>());
}
