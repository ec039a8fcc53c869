//! Imports run one way: this reads every `crate::` path of the sources and fails on an upward one.

#![allow(clippy::unwrap_used)]

#[path = "layers/circles.rs"]
mod circles;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What each module of `flow` may import directly or further along. `exec` starts what it is given and imports nothing of
/// ours. The domains are crates of their own: Cargo holds them to their manifests.
const ORDER: &[(&str, &[&str])] = &[
    (
        "cli",
        &["report", "export", "run", "cluster", "exec", "plan", "store", "stage", "artifact", "expression", "unit"],
    ),
    // Files of results; told what to write, it knows neither workflow nor store.
    ("export", &["stage", "artifact", "expression", "unit"]),
    // A page is made of what a dry run finds and the store holds; it prints nothing, so the command line calls it.
    ("report", &["run", "cluster", "exec", "plan", "store", "stage", "artifact", "expression", "unit"]),
    ("run", &["cluster", "exec", "plan", "store", "stage", "artifact", "expression", "unit"]),
    // What goes to the workers of a cluster and comes back; it knows no graph of tasks.
    ("cluster", &["plan", "store", "stage", "artifact", "expression", "unit"]),
    ("exec", &[]),
    ("plan", &["stage", "artifact", "expression", "unit"]),
    ("store", &["artifact", "unit"]),
    ("stage", &["artifact", "expression", "unit"]),
    ("artifact", &["unit"]),
    ("expression", &["unit"]),
    ("unit", &[]),
];

/// Crates that only some layers may know outside their tests: the store alone knows HDF5, pure layers know no terminal and
/// no file format.
const KEEPERS: &[(&str, &[&str])] = &[
    ("dem", &["stage", "export", "run", "cli"]),
    ("design", &["stage"]),
    // A report judges what was published beside what was computed.
    ("stats", &["stage", "report"]),
    ("optim", &["stage"]),
    ("shape", &["stage", "export"]),
    ("figure", &["stage", "report", "cli"]),
    ("hdf5", &["store"]),
    ("toml", &["plan", "cluster"]),
    ("clap", &["cli"]),
    ("annotate_snippets", &["cli"]),
    ("indicatif", &["cli"]),
    ("signal_hook", &["cli"]),
    ("csv", &["stage", "export"]),
    ("maud", &["report"]),
    ("regex_lite", &["stage", "cluster"]),
];

/// The layer that a file of `src` belongs to; none for `lib.rs` and `main.rs`.
fn layer(path: &Path) -> Option<&'static str> {
    let first = path.iter().next()?.to_str()?;
    let name = first.strip_suffix(".rs").unwrap_or(first);
    ORDER.iter().map(|(layer, _)| *layer).find(|layer| *layer == name)
}

/// The code of a source text: comments and the contents of texts are blanked, lines stay.
fn code(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |at| at + 2)
        } else if let Some(length) = raw_text(rest) {
            length
        } else if c == '"' {
            plain_text(rest)
        } else if rest.starts_with("'\"'") {
            3
        } else {
            code.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        code.extend(rest[..skipped].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        rest = &rest[skipped..];
    }
    code
}

/// Length of the text in quotes that this begins with.
fn plain_text(text: &str) -> usize {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return i + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

/// Length of the raw text that this begins with.
fn raw_text(text: &str) -> Option<usize> {
    let hashes = text.strip_prefix('r')?.chars().take_while(|&c| c == '#').count();
    text[1 + hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let from = 2 + hashes;
    Some(text[from..].find(&end).map_or(text.len(), |at| from + at + end.len()))
}

/// Modules of ours and other crates that a line of code names, each with the line's number.
fn named(code: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut group: Option<usize> = None; // depth inside `use crate::{`
    for (number, line) in code.lines().enumerate() {
        let mut rest = line;
        if let Some(depth) = &mut group {
            rest = members(line, depth, number + 1, &mut found);
            if *depth > 0 {
                continue;
            }
            group = None;
        }
        while let Some(at) = rest.find("crate::") {
            let before = rest[..at].chars().next_back();
            rest = &rest[at + "crate::".len()..];
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
                continue;
            }
            if let Some(inner) = rest.strip_prefix('{') {
                let mut depth = 1;
                rest = members(inner, &mut depth, number + 1, &mut found);
                if depth > 0 {
                    group = Some(depth);
                    break;
                }
            } else {
                found.push((number + 1, word(rest)));
            }
        }
        for (name, _) in KEEPERS {
            if line.match_indices(&format!("{name}::")).any(|(at, _)| starts_a_path(&line[..at])) {
                found.push((number + 1, (*name).to_owned()));
            }
        }
    }
    found
}

/// Whether a name behind this text is the first of its path.
fn starts_a_path(before: &str) -> bool {
    let before = before.strip_suffix("::").unwrap_or(before);
    !before.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '>'))
}

/// The first words of the members of a group, as far as the line goes; gives what follows the group.
fn members<'l>(line: &'l str, depth: &mut usize, number: usize, found: &mut Vec<(usize, String)>) -> &'l str {
    let mut at_member = *depth == 1;
    for (i, c) in line.char_indices() {
        match c {
            '{' => *depth += 1,
            '}' => {
                *depth -= 1;
                if *depth == 0 {
                    return &line[i + 1..];
                }
            }
            ',' if *depth == 1 => at_member = true,
            c if at_member && (c.is_alphabetic() || c == '_') => {
                found.push((number, word(&line[i..])));
                at_member = false;
            }
            _ => {}
        }
    }
    ""
}

fn word(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Every import of a file that the order does not allow.
fn faults(path: &Path, text: &str) -> Vec<String> {
    let Some(own) = layer(path) else { return Vec::new() };
    let allowed = ORDER.iter().find(|(layer, _)| *layer == own).map_or(&[][..], |(_, allowed)| *allowed);
    let modules: Vec<&str> = ORDER.iter().map(|(layer, _)| *layer).collect();
    let keepers: BTreeMap<&str, &[&str]> = KEEPERS.iter().copied().collect();
    let mut faults = Vec::new();
    let code = code(text);
    let tests = code.lines().position(|line| line.trim() == "#[cfg(test)]").unwrap_or(usize::MAX);
    let is_test = |line: usize| line > tests || path.iter().any(|part| part == "tests.rs" || part == "tests");
    for (line, name) in named(&code) {
        let upward = modules.contains(&name.as_str()) && name != own && !allowed.contains(&name.as_str());
        let kept = !is_test(line) && keepers.get(name.as_str()).is_some_and(|keepers| !keepers.contains(&own));
        if upward || kept {
            faults.push(format!("src/{}:{line}: `{own}` must not know `{name}`", path.display()));
        }
    }
    faults.dedup();
    faults
}

/// The sources of this crate.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut all = Vec::new();
    every_source(folder, &mut all);
    let of_another =
        |path: &PathBuf| path.ancestors().take_while(|own| *own != folder).any(|own| own.join("Cargo.toml").is_file());
    found.extend(all.into_iter().filter(|path| !of_another(path)));
}

/// The sources of this crate and of those of the domains.
fn every_source(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            every_source(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn imports_run_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    sources(&root, &mut paths);
    assert!(paths.len() > 30, "the sources were not found");
    let mut found = Vec::new();
    for path in &paths {
        let inside = path.strip_prefix(&root).unwrap();
        let top = inside.iter().count() == 1 && (inside.ends_with("lib.rs") || inside.ends_with("main.rs"));
        assert!(top || layer(inside).is_some(), "src/{} is in no layer: add it to the order", inside.display());
        found.extend(faults(inside, &fs::read_to_string(path).unwrap()));
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// Macros of the language that print, and panic when nobody can read any more: the closed pipe, the full disk.
const PRINTERS: [&str; 5] = ["println!", "eprintln!", "print!", "eprint!", "dbg!"];

/// Lines of a source that print by such a macro, outside its tests.
fn printing(path: &Path, text: &str) -> Vec<String> {
    let code = code(text);
    let prints = |line: &str| {
        PRINTERS.iter().any(|printer| line.match_indices(printer).any(|(at, _)| starts_a_path(&line[..at])))
    };
    let lines = code.lines().take_while(|line| line.trim() != "#[cfg(test)]").enumerate();
    lines.filter(|(_, line)| prints(line)).map(|(at, _)| format!("src/{}:{}", path.display(), at + 1)).collect()
}

#[test]
fn only_the_command_line_prints_and_only_by_writes_that_may_fail() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    every_source(&root, &mut paths);
    let own = |path: &&PathBuf| {
        !path.iter().any(|part| ["benches", "examples", "tests", "tests.rs"].iter().any(|no| part == *no))
    };
    let told = |path: &PathBuf| printing(path.strip_prefix(&root).unwrap(), &fs::read_to_string(path).unwrap());
    let found: Vec<String> = paths.iter().filter(own).flat_map(told).collect();
    assert!(paths.len() > 300 && found.is_empty(), "print with `out!` and `err!`:\n{}", found.join("\n"));
    let one = |text: &str| printing(Path::new("a.rs"), text).len();
    assert_eq!(one("fn f() {\n    eprintln!(\n        \"x\"\n    );\n}"), 1);
    assert_eq!(one("// println!\nlet a = \"print!\";\n#[cfg(test)]\nprintln!();"), 0);
}

#[test]
fn the_order_has_no_circle_and_is_complete() {
    for (layer, allowed) in ORDER {
        for inner in *allowed {
            let further = ORDER.iter().find(|(name, _)| name == inner).map(|(_, allowed)| *allowed);
            let further = further.unwrap_or_else(|| panic!("`{inner}` is not in the order"));
            assert!(!further.contains(layer), "`{layer}` and `{inner}` may import each other");
            assert!(
                further.iter().all(|name| allowed.contains(name)),
                "`{layer}` may use `{inner}` but not all it uses"
            );
        }
    }
}

#[test]
fn an_upward_import_is_found_in_every_form() {
    let told = |file: &str, text: &str| faults(Path::new(file), text);
    assert_eq!(told("store/a.rs", "use crate::stage::rows;"), ["src/store/a.rs:1: `store` must not know `stage`"]);
    assert_eq!(told("unit.rs", "\nlet x = crate::plan::pi();"), ["src/unit.rs:2: `unit` must not know `plan`"]);
    assert_eq!(
        told("stage/a.rs", "use crate::{math, store::Store};"),
        ["src/stage/a.rs:1: `stage` must not know `store`"]
    );
    let group =
        "use crate::{\n    artifact::{Node, Table},\n    plan::{\n        key,\n        run,\n    },\n    unit,\n};";
    assert_eq!(told("stage/a.rs", group), ["src/stage/a.rs:3: `stage` must not know `plan`"]);
    assert_eq!(told("store/a.rs", "fn f(x: &::toml::Value) {}"), ["src/store/a.rs:1: `store` must not know `toml`"]);
    assert_eq!(
        told("store/a.rs", "#[cfg(test)]\nuse crate::stage;\nuse toml::Value;"),
        ["src/store/a.rs:2: `store` must not know `stage`"]
    );
    assert_eq!(told("run/a.rs", "use hdf5::File;"), ["src/run/a.rs:1: `run` must not know `hdf5`"]);
}

#[test]
fn texts_comments_and_allowed_imports_pass() {
    let text = "// crate::stats\nlet a = \"crate::stats \\\" crate::stats\"; /* crate::stats */\nlet b = r#\"crate::stats\"#;\n\
                use crate::artifact::Node;\nuse crate::unit::{Quantity, Unit};\nlet c = '\"'; my_crate::stats();";
    assert_eq!(faults(Path::new("stage/step.rs"), text), [""; 0]);
    assert_eq!(faults(Path::new("plan/a.rs"), "use toml::Value; use crate::stage::{Task, store};"), [""; 0]);
}
