//! `tests/good` runs; a file of `tests/bad` states its faults in comments at its end, `# fault LINE:COLUMN MESSAGE` (`-` where a fault
//! has no location), and `# profile: NAME` when it is read with a profile. Those that a schema cannot see lie in
//! `beyond-schema`.

use flow::plan::{Fault, Overrides, parse};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The workflow files of a folder of the repository, not those of folders inside it.
pub(crate) fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    found.sort();
    assert!(!found.is_empty(), "{} holds no workflow", folder.display());
    found
}

/// The faults of a file as its comments state them.
fn told(text: &str) -> Vec<String> {
    let profile = text.lines().find_map(|line| line.strip_prefix("# profile: ")).map(str::to_owned);
    let line = |fault: &Fault| {
        let location = fault.location.as_ref().map(|location| {
            let (line, column) = location.line_column();
            let option = if location.source.name.starts_with("--") { location.source.name.as_str() } else { "" };
            format!("{option}{line}:{column}")
        });
        let words = [Some(&fault.message), fault.label.as_ref()].into_iter().flatten();
        let words: Vec<&str> = words.map(String::as_str).collect();
        format!("# fault {} {}", location.as_deref().unwrap_or("-"), words.join("; ").replace('\n', " "))
    };
    let faults = parse("bad.toml", text, &Overrides { profile, sets: Vec::new() }).err().unwrap_or_default();
    faults.iter().map(line).collect()
}

#[test]
fn bad_files_say_what_is_wrong() {
    let mut wrong = String::new();
    for path in [files("tests/bad"), files("tests/bad/beyond-schema")].concat() {
        let text = fs::read_to_string(&path).unwrap();
        let stated: Vec<&str> = text.lines().filter(|line| line.starts_with("# fault ")).collect();
        let told = told(&text);
        if told.is_empty() || told != stated {
            wrong.push_str(&format!("\n{}\n{}\n", path.display(), told.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "these files have other faults than they state:\n{wrong}");
}

#[test]
fn good_files_run() {
    for path in files("tests/good") {
        let store = tempfile::tempdir().unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_flow"))
            .args(["run", "--quiet", "--store"])
            .args([store.path(), &path])
            .output()
            .unwrap();
        assert!(run.status.success(), "{}\n{}", path.display(), String::from_utf8_lossy(&run.stderr));
    }
}

#[test]
fn shipped_files_and_all_their_profiles_have_no_fault() {
    for path in [files("workflows"), files("tests/good")].concat() {
        let check = Command::new(env!("CARGO_BIN_EXE_flow")).arg("check").arg(&path).output().unwrap();
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stderr));
    }
}
