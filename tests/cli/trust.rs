//! A store that was lost in part, or that others have written to: never two truths, nothing wrong, nothing outside touched.

use crate::space::{Space, told};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;

const CAMPAIGN: &str = r#"
[workflow]
seed = 1
[factor]
a = { sets = "m.a", levels = [1, 2, 3] }
[response]
y = {}
[material.base]
m = { a = 1 }
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.sim]
kind = "formula"
design = "grid"
material = "base"
responses.y = { value = "a" }
[stage.mean]
kind = "range"
table = "sim"
"#;

fn campaign() -> Space {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]);
    space
}

/// Files two folders below one of the store's.
fn files(space: &Space, folder: &str) -> Vec<PathBuf> {
    let below = |path: PathBuf| fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = below(space.path(&format!("store/{folder}"))).collect();
    if files.iter().any(|path| path.is_dir()) {
        files = files.into_iter().flat_map(below).collect();
    }
    files.sort();
    files
}

/// All commands that read results agree that they are there.
fn all_agree(space: &Space, wanted: &str) {
    space.run(&[]).expect(&[]);
    let shown = space.stdout(&["show", "w.toml", "sim", "--table", "runs", "--csv", "--quiet"]);
    assert_eq!(shown, wanted);
    space.stdout(&["report", "w.toml", "--output", "page.html"]);
    space.stdout(&["export", "w.toml", "sim", "--to", "csv", "--quiet"]);
}

#[test]
fn a_lost_journal_is_found_again_by_every_command() {
    let space = campaign();
    let wanted = space.stdout(&["show", "w.toml", "sim", "--table", "runs", "--csv", "--quiet"]);
    for command in
        [&["show", "w.toml", "sim"][..], &["run", "w.toml", "sim"], &["report", "w.toml", "--output", "p.html"]]
    {
        fs::remove_dir_all(space.path("store/journal")).expect("the journal");
        space.stdout(command);
        all_agree(&space, &wanted);
    }
    fs::remove_dir_all(space.path("store/journal")).expect("the journal");
    let said = space.stdout(&["store", "verify"]);
    assert!(said.contains("6 results are sound") && said.contains("had no record"), "{said}");
    assert!(!space.stdout(&["store", "verify"]).contains("had no record"));
    fs::remove_dir_all(space.path("store/journal")).expect("the journal");
    let kept = space.stdout(&["store", "gc", "w.toml", "--yes"]);
    assert!(kept.contains("6 results remain"), "{kept}");
    all_agree(&space, &wanted);
}

#[test]
fn a_lost_object_is_computed_again_whatever_memos_and_journal_say() {
    let count = files(&campaign(), "objects").len();
    for number in 0..count {
        let space = campaign();
        let wanted = space.stdout(&["show", "w.toml", "sim", "--table", "runs", "--csv", "--quiet"]);
        fs::remove_file(&files(&space, "objects")[number]).expect("an object");
        space.run(&[]);
        all_agree(&space, &wanted);
    }
}

/// Changes the last 2.0 in the data of every memo, with the checksum that anybody can make.
fn forge_memos(space: &Space) -> usize {
    let mut changed = 0;
    for path in files(space, "memo") {
        let mut bytes = fs::read(&path).expect("a memo");
        let end = bytes.len() - 32;
        let two = 2.0_f64.to_le_bytes();
        let Some(at) = bytes[..end].windows(8).rposition(|window| window == two) else { continue };
        bytes[at..at + 8].copy_from_slice(&1e6_f64.to_le_bytes());
        let check = blake3::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(check.as_bytes());
        fs::remove_file(&path).expect("a memo");
        fs::write(&path, bytes).expect("a memo");
        changed += 1;
    }
    changed
}

#[test]
fn a_forged_memo_reaches_no_table_and_verify_says_so() {
    let (space, fresh) = (campaign(), Space::new());
    assert!(forge_memos(&space) > 0, "there was nothing to forge");
    let said = space.stdout(&["store", "verify"]);
    assert!(said.contains("were not written by you"), "{said}");
    let more = CAMPAIGN.replace("[1, 2, 3]", "[1, 2, 3, 4]");
    space.write("w.toml", &more);
    fresh.write("w.toml", &more);
    assert_eq!(space.run(&[]).objects, fresh.run(&[]).objects);
}

#[test]
fn swapped_memos_change_nothing() {
    let space = campaign();
    let memos = files(&space, "memo");
    let bytes: Vec<Vec<u8>> = memos.iter().map(|path| fs::read(path).expect("a memo")).collect();
    for (place, path) in memos.iter().enumerate() {
        fs::remove_file(path).expect("a memo");
        fs::write(path, &bytes[(place + 1) % bytes.len()]).expect("a memo");
    }
    let fresh = campaign();
    assert_eq!(space.run(&[]).objects, fresh.run(&[]).objects);
}

#[test]
fn another_user_of_a_store_gets_the_same_and_proves_it_first() {
    let space = campaign();
    let fresh = campaign();
    let other = |arguments: &[&str]| {
        let state = space.path("other");
        let output = space.command(arguments).env("XDG_STATE_HOME", state).output().expect("running flow");
        assert!(output.status.success(), "{}", told(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let forged = forge_memos(&space);
    assert!(forged > 0);
    let document: serde_json::Value =
        serde_json::from_str(other(&["run", "w.toml", "--json", "--quiet"]).lines().last().unwrap_or_default())
            .expect("JSON");
    assert_eq!((&document["tasks"]["ran"], &document["tasks"]["cached"]), (&0.into(), &6.into()));
    let said = other(&["store", "verify"]);
    assert!(!said.contains("recorded by others") && said.contains("6 results are sound"), "{said}");
    assert_eq!(space.run(&[]).objects, fresh.run(&[]).objects);
}

#[test]
fn a_damaged_mark_is_said_once_with_a_remedy_that_works() {
    let space = campaign();
    let (state, mark) = (space.path("state"), space.path("state/flow/mark"));
    let run = |arguments: &[&str]| {
        let output = space.command(arguments).env("XDG_STATE_HOME", &state).output().expect("running flow");
        assert!(output.status.success(), "{}", told(&output));
        told(&output)
    };
    assert!(!run(&["run", "w.toml"]).contains("warning: your mark"));
    fs::write(&mark, "short").expect("a mark");
    let said = run(&["run", "w.toml"]);
    let (why, hint) =
        ("flow/mark is damaged: it has not 32 bytes: nothing in a store", "\n  delete it, and flow makes another\n");
    assert!(said.matches(why).count() == 1 && said.contains(hint), "{said}");
    assert!(!run(&["run", "w.toml", "--quiet"]).contains(why));
    fs::remove_file(&mark).expect("a mark");
    run(&["run", "w.toml"]);
    assert!(!run(&["show", "w.toml"]).contains("your mark"));
    let nowhere = space
        .command(&["run", "w.toml"])
        .env_remove("XDG_STATE_HOME")
        .env_remove("HOME")
        .output()
        .expect("running flow");
    assert!(told(&nowhere).contains("neither HOME nor XDG_STATE_HOME names a folder"), "{}", told(&nowhere));
}

#[test]
fn a_changed_record_of_a_run_is_refused() {
    let space = campaign();
    let path = space.path("store/runs/1.json");
    let text = fs::read_to_string(&path).expect("a record");
    let document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let object = |stage: usize| document["stages"][stage]["object"].as_str().expect("an object").to_owned();
    space.stdout(&["diff", "#1", "w.toml"]);
    fs::remove_file(&path).expect("a record");
    fs::write(&path, text.replace(&object(2), &object(1))).expect("a record");
    let output = space.flow(&["diff", "#1", "w.toml"]);
    assert_eq!(output.status.code(), Some(3), "{}", told(&output));
    assert!(told(&output).contains("was not recorded by you"));
    assert!(space.stdout(&["store", "verify"]).contains("1 memos and records of runs were not written by you"));
}

#[test]
fn gc_and_verify_leave_alone_what_lies_outside_and_what_flow_did_not_write() {
    let space = campaign();
    fs::create_dir_all(space.path("victim/deep")).expect("a folder");
    space.write("victim/thesis.tex", "precious");
    space.write("victim/deep/b", "precious");
    for link in ["store/aside", "store/objects/zz"] {
        symlink(space.path("victim"), space.path(link)).expect("a link");
    }
    let said = space.stdout(&["store", "verify"]);
    assert!(said.contains("not written by flow, not touched: "), "{said}");
    space.stdout(&["store", "gc", "w.toml"]);
    space.stdout(&["store", "gc", "w.toml", "--yes"]);
    assert!(space.path("victim/thesis.tex").exists() && space.path("victim/deep/b").exists());
    fs::create_dir_all(space.path("project/objects/parts")).expect("a folder");
    space.write("project/objects/parts/mesh.stl", "mesh");
    for command in
        [&["store", "verify"][..], &["store", "gc", "w.toml", "--yes"], &["run", "w.toml"], &["store", "adopt"]]
    {
        let output = space.flow(&[command, &["--store", "project"]].concat());
        assert_eq!(output.status.code(), Some(3), "{}", told(&output));
        assert!(told(&output).contains("is not a store"), "{}", told(&output));
    }
    assert_eq!(fs::read_dir(space.path("project")).expect("a folder").count(), 1);
    assert!(space.path("project/objects/parts/mesh.stl").exists());
}

/// All files of a store, sorted.
fn everything(folder: &std::path::Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() { files.extend(everything(&path)) } else { files.push(path) }
    }
    files.sort();
    files
}

/// As many flips as `FLOW_TEST_FLIPS` says, each of one byte of one file of a finished campaign's store. Whatever it hits, the
/// next run comes to the right results, all commands agree on them, and after that nothing is left to say.
#[test]
fn flips_of_any_byte_of_a_store_end_in_the_right_results() {
    let flips: u64 = std::env::var("FLOW_TEST_FLIPS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let first = campaign();
    let wanted = first.run(&[]).objects;
    let shown = first.stdout(&["show", "w.toml", "sim", "--table", "runs", "--csv", "--quiet"]);
    let (mut number, mut refused) = (0x9e37_79b9_7f4a_7c15_u64, 0);
    for _ in 0..flips {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        copy(&first.path("store"), &space.path("store"));
        let mut next = |below: usize| {
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (number >> 33) as usize % below
        };
        // In-use locks and notes are empty or not read.
        let files: Vec<PathBuf> = everything(&space.path("store"))
            .into_iter()
            .filter(|path| fs::read(path).is_ok_and(|b| !b.is_empty()))
            .collect();
        let path = &files[next(files.len())];
        let mut bytes = fs::read(path).expect("a file");
        let (place, bit) = (next(bytes.len()), next(8));
        bytes[place] ^= 1 << bit;
        fs::remove_file(path).expect("a file");
        fs::write(path, bytes).expect("a file");
        let output = space.flow(&["run", "w.toml", "--json", "--quiet"]);
        if path.ends_with("flow.store") {
            // What makes it a store: refused, or a letter of the note was hit.
            refused += i32::from(output.status.code() == Some(3));
            continue;
        }
        assert!(output.status.success(), "{}, byte {place}: {}", path.display(), told(&output));
        assert_eq!(crate::space::Ran::read(&output).objects, wanted, "{}, byte {place}", path.display());
        // A result that no stage had to read is found when it is read, and the next run computes it.
        space.flow(&["store", "verify"]);
        space.run(&[]);
        assert!(!space.stdout(&["store", "verify"]).contains("damaged"), "{}, byte {place}", path.display());
        all_agree(&space, &shown);
    }
    eprintln!("{flips} flips, {refused} of them refused the store");
}

fn copy(from: &std::path::Path, to: &std::path::Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder").flatten() {
        let target = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &target),
            false => assert!(fs::copy(entry.path(), target).is_ok(), "{}", entry.path().display()),
        }
    }
}

/// A folder of the store that cannot be read is not an empty one: nothing that a workflow needs is removed, no command says
/// that results are missing, and each says what is wrong.
#[test]
fn a_store_that_cannot_be_read_is_not_taken_for_an_empty_one() {
    for (broken, by_link) in [("journal", false), ("objects/FIRST", false), ("objects/FIRST", true)] {
        let space = Space::new();
        space.write("w.toml", include_str!("campaign.toml"));
        space.run(&[]);
        let objects = space.objects();
        let first = objects[0].parent().and_then(|folder| folder.file_name()).expect("a folder").to_owned();
        let broken = space.path("store").join(broken.replace("FIRST", first.to_str().expect("a name")));
        if by_link {
            std::fs::rename(&broken, space.path("elsewhere")).expect("moving a folder");
            symlink(space.path("elsewhere"), &broken).expect("a link");
        } else {
            std::fs::remove_dir_all(&broken).expect("removing a folder");
            std::fs::write(&broken, "a file").expect("writing a file");
        }
        let left = space.objects();
        for command in ["gc w.toml --yes", "gc w.toml", "verify"] {
            let words: Vec<&str> = std::iter::once("store").chain(command.split(' ')).collect();
            let output = space.flow(&words);
            assert!(!output.status.success(), "{command}: {}", told(&output));
            assert!(told(&output).contains("it is a link or a file where flow makes a folder"), "{}", told(&output));
        }
        assert_eq!(space.objects(), left, "{}", broken.display());
        for command in ["show w.toml table", "show w.toml range"] {
            let output = space.flow(&command.split(' ').collect::<Vec<_>>());
            assert!(!told(&output).contains("has no result yet"), "{command}: {}", told(&output));
        }
        std::fs::remove_file(&broken).expect("removing a file");
        space.run(&[]);
        assert!(space.stdout(&["store", "verify"]).contains("are sound"));
    }
}

/// While a data file is away, what rests on it is needed all the same.
#[test]
fn nothing_is_collected_while_a_file_of_the_workflow_is_away() {
    let space = Space::new();
    space.write(
        "w.toml",
        "[workflow]\nseed = 1\n[factor]\na = { levels = [1, 2] }\n[response]\ny = {}\n[stage.d]\nkind = \"data\"\n\
         file = \"d.csv\"\n[stage.s]\nkind = \"range\"\ntable = \"d\"\nfactors = [\"a\"]\n",
    );
    space.write("d.csv", "a,y\n1,2\n2,3\n1,4\n2,6\n");
    space.run(&[]);
    let objects = space.objects();
    std::fs::rename(space.path("d.csv"), space.path("away.csv")).expect("moving a file");
    let output = space.flow(&["store", "gc", "w.toml", "--yes"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains("d.csv") && told(&output).contains("nothing was removed"), "{}", told(&output));
    assert_eq!(space.objects(), objects);
    std::fs::rename(space.path("away.csv"), space.path("d.csv")).expect("moving a file");
    space.stdout(&["store", "gc", "w.toml", "--yes"]);
    assert_eq!(space.objects(), objects);
}

/// A result that was found again without its record has no time: not 1970.
#[test]
fn what_is_not_known_of_a_result_is_said_to_be_unknown() {
    let space = Space::new();
    space.write("w.toml", include_str!("campaign.toml"));
    space.run(&[]);
    std::fs::remove_dir_all(space.path("store/journal")).expect("removing the journal");
    let shown = told(&space.flow(&["show", "w.toml", "table"]));
    assert!(shown.contains("its record was lost") && !shown.contains("1970"), "{shown}");
    space.stdout(&["report", "w.toml"]);
    let page = std::fs::read_to_string(space.path("report.html")).expect("the page");
    assert!(!page.contains("1970-"), "the page dates a result");
}

/// `run` took the results for stored, and `show` said to run first, without a word on why.
#[test]
fn a_damaged_result_is_said_by_the_command_that_shows_it() {
    let space = campaign();
    let objects = files(&space, "objects");
    for object in &objects[1..] {
        fs::remove_file(object).expect("an object");
        fs::hard_link(&objects[0], object).expect("a link");
    }
    let said = told(&space.flow(&["show", "w.toml", "mean"]));
    assert!(said.contains("warning: store/objects/") && said.contains("was set aside as store/aside/"), "{said}");
    assert!(said.contains("`flow store verify` looks at all results"), "{said}");
    space.flow(&["store", "verify"]);
    let fresh = campaign();
    assert_eq!(space.run(&[]).objects, fresh.run(&[]).objects);
    assert!(!told(&space.flow(&["show", "w.toml", "mean"])).contains("warning"));
}
