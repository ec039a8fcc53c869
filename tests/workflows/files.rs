//! Files that are no workflow at all: a clear message, exit code 2, no panic.

use flow::plan::{Fault, Overrides, load, parse};
use std::fs;
use std::path::Path;

fn faults(path: &Path) -> Vec<Fault> {
    load(path, &Overrides::default()).err().unwrap_or_default()
}

fn told(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    faults(&path).iter().map(|fault| fault.message.replace(&format!("{}: ", path.display()), "") + "\n").collect()
}

#[test]
fn files_that_are_no_workflow_are_named_as_what_they_are() {
    assert!(told("empty.toml", b"").starts_with("the file is empty: the table [workflow] is missing\n"));
    assert!(
        told("binary.toml", b"a = 1\n\xff\xfe\x00").starts_with("not a text file: byte 6, in line 2, is not UTF-8")
    );
    let large = vec![b'#'; 50 << 20];
    assert!(told("large.toml", &large).starts_with("the file is larger than 1 MiB, which no workflow is"));
    let missing = faults(Path::new("no/such/file.toml"));
    assert!(missing[0].message.starts_with("no/such/file.toml: cannot be read") && missing[0].hint.is_some());
    assert!(faults(Path::new("/"))[0].message.starts_with("/: cannot be read"));
    if Path::new("/dev/zero").exists() {
        assert!(faults(Path::new("/dev/zero"))[0].message.contains("larger than 1 MiB"));
    }
}

/// Nested in every way: lists, tables in tables, long keys, and all of it at once, which asks most of the stack.
#[test]
fn deep_files_are_refused() {
    let key = |n: usize| format!("{}k", "k.".repeat(n));
    let nested = |n: usize, open: &str, close: &str| format!("a = {}1{}", open.repeat(n), close.repeat(n));
    let most = format!("{} = {{", key(78));
    let texts = [
        nested(100_000, "[", "]"),
        nested(100_000, "{ a = ", "}"),
        nested(70, "[", "]"),
        "a = ".to_owned() + &"[".repeat(1_000_000),
        format!("{} = 1", key(100_000)),
        format!("[{}]\na = 1", key(100_000)),
        format!("[{}]\n{}{}=1{}", key(78), most.repeat(78), key(78), "}".repeat(78)),
        format!("[[{}]]\n{}", key(78), "a = [[[[[[]]]]]]\n".repeat(10_000)),
    ];
    for text in texts {
        let faults = parse("deep.toml", &text, &Overrides::default()).err().unwrap_or_default();
        assert!(!faults.is_empty() && faults.len() < 30, "{} faults in {:.60}", faults.len(), text);
    }
}

/// The TOML reader does not say where a key of too many parts stands.
#[test]
fn a_key_that_is_nested_too_deeply_is_pointed_at() {
    let key = vec!["a"; 20_000].join(".");
    let quoted = vec!["\"a b\""; 200].join(" . ");
    let texts = [
        (format!("[workflow]\nseed = 1\n{key} = 1\n[stage.b]\n"), (3, 1), key.len()),
        (format!("[workflow]\nseed = 1\nx = {{ y = 1, {key} = 1 }}\n"), (3, 14), key.len()),
        (format!("about = \"{}\"\n[[{key}]]\n", ".".repeat(200)), (2, 3), key.len()),
        (format!("# {}\n\t{quoted} = 1\n", "a,".repeat(200)), (2, 2), quoted.len()),
    ];
    for (text, location, length) in texts {
        let faults = parse("deep.toml", &text, &Overrides::default()).err().unwrap_or_default();
        let deep = faults.iter().find(|fault| fault.message == "nested too deeply").unwrap();
        let found = deep.location.as_ref().unwrap();
        assert_eq!((found.line_column(), found.span.len()), (location, length), "{text:.90}");
    }
}

/// Large and wrong everywhere: the faults that are told are bounded.
#[test]
fn faults_are_bounded() {
    let head = "[workflow]\nseed = 1\n";
    let many = |n: usize, text: &dyn Fn(usize) -> String| head.to_owned() + &(0..n).map(text).collect::<String>();
    let texts = [
        many(100_000, &|_| "x y z\n".to_owned()),
        "=".repeat(1 << 20),
        many(100_000, &|_| "seed = 1\n".to_owned()),
        head.to_owned() + "[factor.a]\nlevels = [" + &"'a', ".repeat(200_000) + "]",
        many(90_000, &|i| format!("[a{i}]\n")),
        many(60_000, &|i| format!("[stage.a{i}]\n")),
        many(60_000, &|i| format!("[factor.a{i}]\n")),
        many(20_000, &|i| format!("[stage.a{i}]\nkind = 'formula'\ndesign = 'no'\nresponses = {{}}\n")),
        many(40_000, &|i| format!("[profile.p.stage.a{i}]\n")),
        head.to_owned()
            + "[stage.a]\nkind = 'data'\n"
            + &(0..60_000).map(|i| format!("k{i} = 1\n")).collect::<String>(),
    ];
    for text in texts {
        let faults = parse("w.toml", &text, &Overrides::default()).err().unwrap_or_default();
        assert!((1..=51).contains(&faults.len()), "{} faults in {:.90}", faults.len(), text);
    }
}
