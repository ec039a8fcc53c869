//! The user's guide: every file, command and quoted line of its pages, tried in the order of the page.
//!
//! In a page, a block for a file begins with `# NAME`, or `# added to NAME`, a line that is not written. A block for a shell
//! holds commands, `# exits with N` behind those that must fail. Each line of a plain `text` block must have been printed by
//! a command above it.

use crate::readme::words;
use crate::space::{Space, told};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("workflows/guide")
}

/// A block of a page: what is written behind the fence, and the text.
struct Block<'t> {
    info: &'t str,
    text: &'t str,
}

/// The fenced blocks of a page, in order.
fn blocks<'t>(page: &'t str) -> Vec<Block<'t>> {
    let parts: Vec<&str> = page.split("```").collect();
    assert!(parts.len() % 2 == 1, "a fence is not closed");
    let block = |part: &&'t str| part.split_once('\n').map(|(info, text)| Block { info, text });
    parts.iter().skip(1).step_by(2).map(|part| block(part).expect("a fence that opens a block")).collect()
}

/// Writes the file of a block, or adds to it.
fn write(space: &Space, block: &Block<'_>) {
    let (head, text) = block.text.split_once('\n').unwrap();
    let name = head.strip_prefix("# ").unwrap_or_else(|| panic!("a block without the name of its file: {head}"));
    match name.strip_prefix("added to ") {
        Some(name) => {
            let old = fs::read_to_string(space.path(name)).unwrap();
            space.write(name, &(old + text));
        }
        None => space.write(name, text),
    }
}

/// Runs a line of a shell block; gives what it printed.
fn run(space: &Space, line: &str) -> String {
    let wanted = line.split_once("# exits with ").map_or(0, |(_, code)| code.trim().parse().unwrap());
    let words = words(line);
    let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
    let output = match words[0].as_str() {
        "flow" => space.flow(&arguments),
        "ssh-keygen" => Command::new("ssh-keygen").args(&arguments).current_dir(space.path(".")).output().unwrap(),
        other => panic!("who tests `{other}`?"),
    };
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert_eq!(output.status.code(), Some(wanted), "{line}\n{printed}");
    printed
}

/// Runs the Python of the page on data, where pandas and h5py are installed.
fn python(space: &Space, text: &str) {
    let readers = Command::new("python3").args(["-c", "import pandas, h5py"]).output();
    let required = std::env::var("FLOW_TEST_READERS").is_ok();
    if !required && !readers.is_ok_and(|output| output.status.success()) {
        return;
    }
    let checks = "\nassert len(runs) == 6 and runs['q [MPa]'].max() == 149, runs\n\
                  assert {'series', 'kind', 'q [MPa]'} <= set(points), points.columns\n\
                  assert result['groups/estimate'].shape == (4,), list(result)\n";
    let binary = Path::new(env!("CARGO_BIN_EXE_flow")).parent().unwrap();
    let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap_or_default());
    let output = Command::new("python3")
        .args(["-c", &format!("{text}{checks}")])
        .env("PATH", path)
        .current_dir(space.path("."))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", told(&output));
}

/// Tries a page; gives how many commands it has.
fn tried(page: &str) -> usize {
    let text = fs::read_to_string(folder().join(page)).unwrap();
    let (space, mut printed, mut commands) = (Space::new(), String::new(), 0);
    for block in blocks(&text) {
        match block.info {
            "sh" => {
                for line in block.text.lines().filter(|line| !line.trim().is_empty()) {
                    printed += &run(&space, line);
                    commands += 1;
                }
            }
            "text" => {
                for line in block.text.lines().map(str::trim).filter(|line| !line.is_empty()) {
                    assert!(printed.contains(line), "{page}: no command printed `{line}`, but\n{printed}");
                }
            }
            "python" => python(&space, block.text),
            "toml" => write(&space, &block),
            other => {
                assert!(other.ends_with(" file"), "{page}: a block `{other}` that no test understands");
                write(&space, &block);
            }
        }
    }
    commands
}

#[test]
fn the_first_ten_minutes_are_as_the_guide_says() {
    assert!(tried("first-ten-minutes.md") >= 12);
}

#[test]
fn a_rock_of_ones_own_is_as_the_guide_says() {
    assert!(tried("your-rock.md") >= 6);
}

#[test]
fn data_of_ones_own_are_as_the_guide_says() {
    assert!(tried("your-data.md") >= 4);
}

#[test]
fn designs_are_as_the_guide_says() {
    assert!(tried("designs.md") >= 7);
}

#[test]
fn calibrations_are_as_the_guide_says() {
    assert!(tried("calibration.md") >= 10);
}

#[test]
fn machines_are_as_the_guide_says() {
    assert!(tried("machines.md") >= 3);
}

#[test]
fn other_engines_are_as_the_guide_says() {
    assert!(tried("engines.md") >= 4);
}

#[test]
fn the_store_is_as_the_guide_says() {
    assert!(tried("store.md") >= 14);
}

#[test]
fn messages_are_as_the_guide_says() {
    assert!(tried("messages.md") >= 2);
}

/// Every page is in the table of contents, and has a test above.
#[test]
fn the_contents_of_the_guide_are_complete() {
    let contents = fs::read_to_string(folder().join("SUMMARY.md")).unwrap();
    let named: BTreeSet<String> =
        contents.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned).collect();
    let names = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let pages: BTreeSet<String> = names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md").collect();
    assert_eq!(named, pages);
    let tests = include_str!("guide.rs");
    let untested: Vec<&String> =
        pages.iter().filter(|page| *page != "README.md" && !tests.contains(&format!("tried(\"{page}\")"))).collect();
    assert_eq!(untested, Vec::<&String>::new());
}
