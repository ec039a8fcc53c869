//! A store that others can write to: what they put there is proven, refused or not touched.

use crate::{objects, put, result, text, timing};
use flow::artifact::{ContentHash, Key};
use flow::store::{Mark, Memo, ObjectId, Store, StoreError, Timing};
use std::collections::HashSet;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime};

fn open_as(root: &Path, user: u8) -> Store {
    Store::open_as(root, Mark::of(&[user; 32])).expect("the store opens")
}

fn found(store: &Store, number: u64) -> Option<ObjectId> {
    store.find(&Key::of(&text(number))).unwrap().map(|record| record.object())
}

/// A record with a right checksum and no mark: what anybody can write.
fn record(key: &Key, content: &ContentHash, file: &[u8], started: i64) -> Vec<u8> {
    let mut bytes = [&key.0[..], &content.0, &blake3::hash(file).as_bytes()[..16]].concat();
    bytes.extend((file.len() as u64).to_le_bytes());
    bytes.extend(started.to_le_bytes());
    bytes.extend(0.5_f64.to_le_bytes());
    let check = blake3::hash(&bytes);
    bytes.extend(&check.as_bytes()[..8]);
    bytes.extend([0; 16]);
    bytes
}

fn write_segment(root: &Path, version: u8, records: &[u8]) {
    let mut head =
        format!("flow journal {version} {{\"machine\":\"m\",\"version\":\"v\",\"commit\":\"\"}}").into_bytes();
    head.resize(511, b' ');
    head.push(b'\n');
    fs::create_dir_all(root.join("journal")).unwrap();
    fs::write(root.join("journal/9999999999999-1-0.journal"), [head, records.to_vec()].concat()).unwrap();
}

/// The file of an object that another task's name was put on.
fn forged_object(root: &Path, content: &ContentHash, key: &Key, bytes: &[u8]) -> PathBuf {
    let content = content.to_string();
    let folder = root.join("objects").join(&content[..2]);
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{content}-{}.h5", &key.to_string()[..16]));
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn a_record_that_gives_a_task_the_result_of_another_is_not_believed() {
    for user in [1, 2] {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let store = open_as(root, 1);
        let (mine, other) = (put(&store, 3), put(&store, 5));
        let bytes = fs::read(store.path(&other.object())).unwrap();
        drop(store);
        let path = forged_object(root, &other.content, &mine.key, &bytes);
        write_segment(root, 2, &record(&mine.key, &other.content, &bytes, i64::MAX));
        let store = open_as(root, user);
        assert_eq!(found(&store, 3), Some(mine.object()), "user {user}");
        assert_eq!(*store.get(&mine.content).unwrap(), result(3));
        let verdict = open_as(root, user).verify().unwrap();
        assert!(!path.exists(), "it was set aside");
        assert_eq!(verdict.damages.len() + store.take_damages().len(), 1, "user {user}");
        assert!(verdict.contradictions.is_empty());
    }
}

#[test]
fn a_record_without_its_object_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let store = open_as(folder.path(), 1);
    let other = put(&store, 5);
    let bytes = fs::read(store.path(&other.object())).unwrap();
    write_segment(folder.path(), 2, &record(&Key::of(&text(3)), &other.content, &bytes, i64::MAX));
    assert_eq!(found(&open_as(folder.path(), 1), 3), None);
    assert_eq!(found(&open_as(folder.path(), 2), 3), None);
}

#[test]
fn of_two_results_of_a_task_none_is_believed_until_it_is_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (open_as(folder.path(), 1), open_as(folder.path(), 2));
    let (right, wrong) =
        (first.put("t", result(1), &timing()).unwrap().0, second.put("t", result(2), &timing()).unwrap().0);
    drop((first, second));
    let find = |user| open_as(folder.path(), user).find(&Key::of("t")).unwrap().map(|record| record.content);
    assert_eq!(find(1), Some(right.content), "each user believes the own record");
    assert_eq!(find(2), Some(wrong.content));
    assert_eq!(find(3), None);
    let verdict = open_as(folder.path(), 3).verify().unwrap();
    assert_eq!(verdict.contradictions.len(), 1);
    assert!(!verdict.is_sound());
    let third = open_as(folder.path(), 3);
    assert_eq!(third.find(&Key::of("t")).unwrap(), None);
    third.put("t", result(1), &timing()).unwrap();
    assert_eq!(third.take_damages().len(), 1, "the other result goes aside");
    for user in [1, 2, 3] {
        assert_eq!(find(user), Some(right.content), "user {user}");
    }
    assert!(open_as(folder.path(), 4).verify().unwrap().is_sound());
}

#[test]
fn a_clock_that_was_ahead_decides_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let store = open_as(folder.path(), 1);
    let ahead = Timing { started: SystemTime::now() + Duration::from_secs(4_000_000_000), seconds: 1.0 };
    let old = store.put(&text(1), result(1), &ahead).unwrap().0;
    fs::remove_file(store.path(&old.object())).unwrap();
    let store = open_as(folder.path(), 1);
    assert_eq!(found(&store, 1), None);
    // A program that depends on more than its key gives another result now.
    let new = store.put(&text(1), result(2), &timing()).unwrap().0;
    for user in [1, 2] {
        assert_eq!(found(&open_as(folder.path(), user), 1), Some(new.object()));
    }
}

#[test]
fn results_of_others_are_proven_once_and_then_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let first = open_as(folder.path(), 1);
    let objects: Vec<_> = (0..5).map(|number| put(&first, number)).collect();
    drop(first);
    let second = open_as(folder.path(), 2);
    for (number, record) in objects.iter().enumerate() {
        assert_eq!(found(&second, number as u64), Some(record.object()));
    }
    drop(second);
    let verdict = open_as(folder.path(), 2).verify().unwrap();
    assert!(verdict.proven.is_empty() && verdict.is_sound());
    let found = open_as(folder.path(), 2).find(&objects[1].key).unwrap().unwrap();
    assert_eq!((found.started, &found.origin), (objects[1].started, &objects[1].origin), "where it was made stays");
    assert_eq!(open_as(folder.path(), 3).verify().unwrap().proven.len(), 5);
}

#[test]
fn journals_of_the_first_version_are_read_and_proven() {
    let folder = tempfile::tempdir().unwrap();
    let store = open_as(folder.path(), 1);
    let record = put(&store, 3);
    let file = fs::read(store.path(&record.object())).unwrap();
    drop(store);
    fs::remove_dir_all(folder.path().join("journal")).unwrap();
    let mut bytes = [&record.key.0[..], &record.content.0, blake3::hash(&file).as_bytes()].concat();
    bytes.extend((file.len() as u64).to_le_bytes());
    bytes.extend(77_i64.to_le_bytes());
    bytes.extend(1.5_f64.to_le_bytes());
    let check = blake3::hash(&bytes);
    bytes.extend(&check.as_bytes()[..8]);
    write_segment(folder.path(), 1, &bytes);
    fs::remove_file(folder.path().join("flow.store")).unwrap();
    let refused = Store::open(folder.path()).err().expect("it has no marker").to_string();
    assert!(refused.contains("flow store adopt"), "{refused}");
    Store::adopt(folder.path()).unwrap();
    let old = open_as(folder.path(), 1).find(&record.key).unwrap().unwrap();
    assert_eq!((old.object(), old.started, old.seconds), (record.object(), 77, 1.5));
}

#[test]
fn a_memo_of_another_key_or_user_or_with_other_numbers_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let store = open_as(folder.path(), 1);
    let memo = |number: u64| Memo { note: format!("{number}"), data: vec![7; 40], objects: Vec::new() };
    let (a, b) = (Key::of("a"), Key::of("b"));
    store.keep_memo(&a, &memo(1)).unwrap();
    store.keep_memo(&b, &memo(2)).unwrap();
    assert_eq!(open_as(folder.path(), 2).memo(&a).unwrap(), None);
    let file = |key: &Key| {
        let shard = folder.path().join("memo").join(&key.to_string()[..2]);
        let files: Vec<_> = fs::read_dir(shard).unwrap().flatten().map(|file| file.path()).collect();
        files.into_iter().find(|path| path.display().to_string().contains(&key.to_string())).unwrap()
    };
    let (bytes, other) = (fs::read(file(&a)).unwrap(), fs::read(file(&b)).unwrap());
    let replace = |bytes: &[u8]| {
        fs::remove_file(file(&a)).unwrap();
        fs::write(folder.path().join("memo").join(&a.to_string()[..2]).join(format!("{a}-{}", user(&file(&b)))), bytes)
            .unwrap();
    };
    replace(&other);
    assert_eq!(store.memo(&a).unwrap(), None);
    let mut forged = bytes.clone();
    forged[30] ^= 1;
    let end = forged.len() - 32;
    let check = blake3::hash(&forged[..end]);
    forged[end..].copy_from_slice(check.as_bytes());
    replace(&forged);
    assert_eq!(store.memo(&a).unwrap(), None);
    assert_eq!(open_as(folder.path(), 1).verify().unwrap().not_own, 1);
    replace(&bytes);
    assert_eq!(store.memo(&a).unwrap(), Some(memo(1)));
}

/// The user in the name of a memo.
fn user(memo: &Path) -> String {
    memo.to_str().unwrap().rsplit('-').next().unwrap().to_owned()
}

/// All files below a folder with their bytes, links as what they point to.
fn tree(root: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in fs::read_dir(root).unwrap().flatten() {
        match entry.file_type().unwrap() {
            kind if kind.is_dir() => files.extend(tree(&entry.path())),
            kind if kind.is_symlink() => {
                files.push((entry.path(), fs::read_link(entry.path()).unwrap().display().to_string().into()))
            }
            _ => files.push((entry.path(), fs::read(entry.path()).unwrap())),
        }
    }
    files.sort();
    files
}

#[test]
fn links_in_a_store_lead_nowhere() {
    for folder in ["objects", "objects/zz", "objects/ab", "aside", "journal", "memo", "memo/ab", "locks", "runs"] {
        let space = tempfile::tempdir().unwrap();
        let (root, victim) = (space.path().join("store"), space.path().join("victim"));
        fs::create_dir_all(victim.join("ab")).unwrap();
        let (name, key) = (format!("{}-0123456789abcdef.h5", "ab".repeat(32)), "ab".repeat(32));
        for path in
            ["thesis.tex", &name, &format!("ab/{name}"), &key, &format!("{key}.lock"), &format!("{name}.1"), "1.json"]
        {
            fs::write(victim.join(path), "precious").unwrap();
        }
        fs::write(victim.join("0000000000000-1-0.journal"), "flow journal 1 precious").unwrap();
        let before = tree(&victim);
        drop(open_as(&root, 1));
        fs::create_dir_all(root.join(folder).parent().unwrap()).unwrap();
        symlink(&victim, root.join(folder)).unwrap();
        let store = open_as(&root, 1);
        // Some of these fail, with a word; none reaches out of the store.
        let _ = (store.put(&text(1), result(1), &timing()), store.find(&Key::of(&text(1))), store.claim(&Key::of("x")));
        let _ = (store.keep_memo(&Key::of("m"), &Memo::default()), store.record_campaign(&Default::default()));
        if let Ok(verdict) = store.verify() {
            assert!(verdict.strangers.iter().any(|path| path.ends_with(folder)), "{folder}: {verdict:?}");
        }
        let _ = (store.sweep(&HashSet::new(), false), store.sweep(&HashSet::new(), true), store.usage());
        assert_eq!(tree(&victim), before, "{folder}");
        assert!(root.join(folder).is_symlink(), "{folder}: the link itself stays");
    }
}

/// Puts something in place of a file and says whether that could be done.
fn in_place(path: &Path, what: &str) {
    let _ = fs::remove_file(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    match what {
        "pipe" => assert!(Command::new("mkfifo").arg(path).status().unwrap().success()),
        "link" => symlink("/dev/zero", path).unwrap(),
        "giant" => fs::File::create(path).unwrap().set_len(1 << 42).unwrap(),
        _ => fs::create_dir(path).unwrap(),
    }
}

#[test]
fn pipes_links_and_giants_neither_hang_nor_fill_the_memory() {
    for what in ["pipe", "link", "giant", "folder"] {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("store");
        let store = open_as(&root, 1);
        let records: Vec<_> = (0..4).map(|number| put(&store, number)).collect();
        store.keep_memo(&Key::of("m"), &Memo::default()).unwrap();
        store.record_campaign(&Default::default()).unwrap();
        let many = vec![records[0].object(); 1000];
        assert!(store.has_all(&many).unwrap());
        let object = store.path(&records[1].object());
        drop(store);
        let memo = fs::read_dir(root.join("memo")).unwrap().flatten().next().unwrap().path();
        let memo = fs::read_dir(memo).unwrap().flatten().next().unwrap().path();
        let user = user(&memo);
        let listing = root.join(format!("listing-{user}"));
        let lock = root.join("locks").join(format!("{}.lock", Key::of("free")));
        let strays =
            [root.join("journal/0000000000000-1-0.journal"), root.join("runs/7.json"), root.join("in-use.lock")];
        for path in [&object, &memo, &listing, &lock].into_iter().chain(&strays) {
            in_place(path, what);
        }
        for user in [1, 2] {
            let store = open_as(&root, user);
            // Its size is looked at when it is read.
            assert!(found(&store, 1).is_none() || (what, user) == ("giant", 1), "{what}");
            assert_eq!(found(&store, 2), Some(records[2].object()), "{what}");
            assert!(store.get(&records[1].content).unwrap_err().is_missing(), "{what}");
            assert!(store.has_all(&many).unwrap(), "{what}");
            assert_eq!((store.memo(&Key::of("m")).unwrap(), store.campaign(7).unwrap()), (None, None), "{what}");
            drop(store.claim(&Key::of("free")).unwrap());
            store.usage().unwrap();
        }
        let store = open_as(&root, 1);
        store.put(&text(1), result(1), &timing()).unwrap();
        assert_eq!(found(&store, 1), Some(records[1].object()), "{what}");
        store.keep_memo(&Key::of("m"), &Memo::default()).unwrap_or_else(|error| assert_eq!(what, "folder", "{error}"));
        store.verify().unwrap();
        drop(store);
        open_as(&root, 1).sweep(&records.iter().map(|record| record.key).collect(), true).unwrap();
        assert_eq!(objects(&root).len(), 4, "{what}");
    }
}

#[test]
fn a_folder_that_flow_has_not_made_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("project");
    fs::create_dir_all(root.join("objects/parts")).unwrap();
    fs::create_dir_all(root.join("aside")).unwrap();
    fs::write(root.join("objects/parts/mesh.stl"), "mesh").unwrap();
    fs::write(root.join("aside/note.txt"), "note").unwrap();
    let before = tree(&root);
    let refused = |error: Option<StoreError>| {
        let error = error.expect("no store");
        assert!(matches!(error, StoreError::NotAStore { .. }), "{error}");
    };
    refused(Store::open(&root).err());
    refused(Store::adopt(&root).err());
    assert_eq!(tree(&root), before);
    // Also when somebody has put a marker there: what has not the names and heads of flow's own files stays.
    fs::write(root.join("flow.store"), "flow store 1\n").unwrap();
    fs::create_dir_all(root.join("objects/ab")).unwrap();
    let mesh = root.join("objects/ab").join(format!("{}-0123456789abcdef.h5", "ab".repeat(32)));
    fs::write(&mesh, "not an object").unwrap();
    fs::write(root.join("objects/ab/.writing-a-letter"), "letter").unwrap();
    let store = open_as(&root, 1);
    store.sweep(&HashSet::new(), true).unwrap();
    assert_eq!(store.usage().unwrap().objects.files, 0);
    let left: Vec<_> = tree(&root).into_iter().map(|(path, _)| path).collect();
    for (path, _) in &before {
        assert!(left.contains(path), "{} is gone", path.display());
    }
    assert!(mesh.exists() && left.iter().any(|path| path.ends_with(".writing-a-letter")));
    fs::write(root.join("flow.store"), "my notes").unwrap();
    refused(Store::open(&root).err());
    fs::write(root.join("flow.store"), "flow store 2\n").unwrap();
    refused(Store::open(&root).err());
}

#[test]
fn an_empty_folder_and_one_with_notes_become_stores() {
    for notes in [&[][..], &[".gitignore", "README.md"]] {
        let folder = tempfile::tempdir().unwrap();
        notes.iter().for_each(|note| fs::write(folder.path().join(note), "a note").unwrap());
        put(&Store::open(folder.path()).unwrap(), 1);
        assert!(folder.path().join("flow.store").is_file());
        notes.iter().for_each(|note| assert_eq!(fs::read_to_string(folder.path().join(note)).unwrap(), "a note"));
    }
}
