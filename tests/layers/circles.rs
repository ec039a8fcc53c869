//! Modules of one folder import one another in one direction: there is an order in which each uses only earlier ones.

use super::{code, sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A path or a module as its names.
type Names = Vec<String>;

/// The paths from `crate`, `super` or `self` in a text, with groups expanded.
fn paths(code: &str) -> Vec<Names> {
    let mut found = Vec::new();
    for root in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(root) {
            if !code[..at].ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | ':')) {
                read(&code[at..], Vec::new(), &mut found);
            }
        }
    }
    found
}

/// Reads one path, which may end in a group, and returns the rest of the text.
fn read<'t>(text: &'t str, mut path: Names, found: &mut Vec<Names>) -> &'t str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = read(rest, path.clone(), found);
            let Some(end) = rest.find([',', '}']) else { return "" };
            let last = rest[end..].starts_with('}');
            rest = &rest[end + 1..];
            if last {
                return rest;
            }
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    path.extend((end > 0).then(|| text[..end].to_owned()));
    match text[end..].strip_prefix("::") {
        Some(rest) => read(rest, path, found),
        None => {
            found.push(path);
            &text[end..]
        }
    }
}

/// The module of a file, from the root of its crate; empty for the root itself.
fn module(file: &Path) -> Names {
    let names = file.with_extension("");
    let mut names: Names = names.iter().map(|name| name.to_str().unwrap().to_owned()).collect();
    if names.last().is_some_and(|name| name == "mod" || names.len() == 1 && (name == "lib" || name == "main")) {
        names.pop();
    }
    names
}

/// The module that a path in `own` names: the longest part of it that is one.
fn named(path: &[String], own: &Names, modules: &BTreeSet<Names>) -> Option<Names> {
    let mut full = match path[0].as_str() {
        "crate" => Vec::new(),
        _ => own.clone(),
    };
    for name in path {
        match name.as_str() {
            "crate" | "self" => {}
            "super" => drop(full.pop()),
            name => full.push(name.to_owned()),
        }
    }
    while !full.is_empty() && !modules.contains(&full) {
        full.pop();
    }
    (!full.is_empty()).then_some(full)
}

/// The imports among modules of one folder, as pairs of modules that have one parent.
fn imports(files: &[(Names, String)]) -> BTreeSet<(Names, Names)> {
    let modules: BTreeSet<Names> = files.iter().map(|(module, _)| module.clone()).collect();
    let mut found = BTreeSet::new();
    for (own, text) in files {
        let code = code(text);
        let code = code.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        for other in paths(code).iter().filter_map(|path| named(path, own, &modules)) {
            let shared = own.iter().zip(&other).take_while(|(a, b)| a == b).count();
            if own.len() > shared && other.len() > shared {
                found.insert((own[..=shared].to_vec(), other[..=shared].to_vec()));
            }
        }
    }
    found
}

/// The imports that are part of a circle, or lead into one.
fn circles(mut imports: BTreeSet<(Names, Names)>) -> Vec<String> {
    loop {
        let importing: BTreeSet<Names> = imports.iter().map(|(own, _)| own.clone()).collect();
        let before = imports.len();
        imports.retain(|(_, other)| importing.contains(other));
        if imports.len() == before {
            return imports.iter().map(|(own, other)| format!("{} → {}", own.join("::"), other.join("::"))).collect();
        }
    }
}

#[test]
fn modules_of_a_folder_import_one_another_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let is_test = |path: &Path| path.iter().any(|part| part == "tests.rs" || part == "tests" || part == "pins.rs");
    let inside = files.iter().map(|path| (path, path.strip_prefix(&root).unwrap()));
    let texts: Vec<(Names, String)> = inside
        .filter(|(_, inside)| !is_test(inside))
        .map(|(path, inside)| (module(inside), fs::read_to_string(path).unwrap()))
        .collect();
    assert!(texts.len() > 100, "the sources were not found");
    let found = circles(imports(&texts));
    assert!(found.is_empty(), "modules that import each other:\n{}", found.join("\n"));
}

#[test]
fn a_circle_is_found_through_groups_and_inner_modules() {
    let file = |name: &str, text: &str| (module(Path::new(name)), text.to_owned());
    let files = [
        file("lib.rs", "pub mod a; pub mod b;"),
        file("a/mod.rs", "use super::c;"),
        file("a/inner.rs", "use crate::{c::C, b::{self, B as Other}};"),
        file("b.rs", "fn f() { crate::a::g(); }\n#[cfg(test)]\nmod tests { use crate::c; }"),
        file("c.rs", "// crate::a"),
    ];
    assert_eq!(circles(imports(&files)), ["a → b", "b → a"]);
    assert_eq!(circles(imports(&files[..3])), [""; 0]);
}
