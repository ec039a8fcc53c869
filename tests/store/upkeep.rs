//! gc, verify, sizes, memos and records of campaigns.

use crate::{found, objects, open, put, text};
use flow::artifact::Key;
use flow::store::{Campaign, Claim, Memo, StoreError};
use std::collections::HashSet;
use std::fs;

fn keys(numbers: impl IntoIterator<Item = u64>) -> HashSet<Key> {
    numbers.into_iter().map(|number| Key::of(&text(number))).collect()
}

#[test]
fn gc_removes_what_is_not_reachable_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let records: Vec<_> = (0..10).map(|number| put(&open(folder.path()), number)).collect();
    fs::create_dir_all(folder.path().join("aside")).unwrap();
    let aside = records[9].object();
    let aside = open(folder.path()).path(&aside).file_name().unwrap().to_str().unwrap().to_owned();
    fs::write(folder.path().join(format!("aside/{aside}.1")), b"rubbish").unwrap();
    let shard = open(folder.path()).path(&records[0].object()).parent().unwrap().to_owned();
    fs::write(shard.join(".flow-writing-0123456789abcdef"), b"half").unwrap();
    let store = open(folder.path());
    store.keep_memo(&Key::of("old"), &Memo { objects: vec![records[9].object()], ..Memo::default() }).unwrap();
    let kept_memo = Memo { note: "all well".to_owned(), data: vec![1, 2], objects: vec![records[1].object()] };
    store.keep_memo(&Key::of("new"), &kept_memo).unwrap();
    let before = objects(folder.path());

    let planned = store.sweep(&keys(0..5), false).unwrap();
    assert_eq!(objects(folder.path()), before, "a dry run removes nothing");
    assert_eq!((planned.kept.files, planned.removed.files, planned.rubbish.files), (5, 5, 2));
    assert_eq!(planned.memos.files, 1, "a memo that rests on a result that goes");
    assert_eq!(planned.segments, 10);

    assert_eq!(store.sweep(&keys(0..5), true).unwrap(), planned, "it removes what it said");
    for (number, record) in records.iter().enumerate() {
        let kept = (number < 5).then(|| record.clone());
        assert_eq!(found(&store, number as u64), kept);
        assert_eq!(found(&open(folder.path()), number as u64), kept);
    }
    assert_eq!(objects(folder.path()).len(), 5);
    assert_eq!(store.usage().unwrap().journal.files, 1, "segments are merged");
    assert_eq!(store.memo(&Key::of("old")).unwrap(), None);
    assert_eq!(store.memo(&Key::of("new")).unwrap(), Some(kept_memo));
    // The store goes on as before.
    let record = put(&store, 8);
    assert_eq!(found(&open(folder.path()), 8), Some(record));
    assert!(store.verify().unwrap().missing.is_empty());
}

#[test]
fn gc_keeps_off_a_store_in_use() {
    let folder = tempfile::tempdir().unwrap();
    let (store, other) = (open(folder.path()), open(folder.path()));
    put(&other, 1);
    assert!(matches!(store.sweep(&keys([]), true), Err(StoreError::InUse { .. })));
    assert!(found(&store, 1).is_some());
    drop(other);
    assert_eq!(store.sweep(&keys([]), true).unwrap().removed.files, 1);
    assert_eq!(found(&store, 1), None);
}

#[test]
fn verify_reads_everything() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let records: Vec<_> = (0..8).map(|number| put(&store, number)).collect();
    let path = |number: usize| store.path(&records[number].object());
    fs::remove_file(path(2)).unwrap();
    let mut bytes = fs::read(path(5)).unwrap();
    bytes[100] ^= 1;
    fs::remove_file(path(5)).unwrap();
    fs::write(path(5), bytes).unwrap();
    let verdict = open(folder.path()).verify().unwrap();
    assert_eq!(verdict.sound.files, 6);
    assert_eq!(verdict.missing, [records[2].key]);
    assert_eq!(verdict.damages.len(), 1);
    assert_eq!(verdict.damages[0].path, path(5));
}

#[test]
fn equal_results_of_two_tasks_are_two_files_that_do_not_depend_on_their_order() {
    let stores: Vec<_> = [[7, 70], [70, 7]]
        .map(|order| {
            let folder = tempfile::tempdir().unwrap();
            let store = open(folder.path());
            let contents = order.map(|number| put(&store, number).content);
            assert_eq!(contents[0], contents[1]);
            objects(folder.path())
        })
        .into();
    assert_eq!(stores[0], stores[1]);
    assert_eq!(stores[0].len(), 2);
}

#[test]
fn a_memo_comes_back_and_a_damaged_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let objects: Vec<_> = (0..3).map(|number| put(&store, number).object()).collect();
    let (key, memo) = (Key::of("stage"), Memo { note: "σ = 3".to_owned(), data: Vec::new(), objects });
    assert_eq!(store.memo(&key).unwrap(), None);
    store.keep_memo(&key, &memo).unwrap();
    store.keep_memo(&key, &memo).unwrap();
    assert_eq!(open(folder.path()).memo(&key).unwrap(), Some(memo.clone()));
    assert!(store.has_all(&memo.objects).unwrap());
    let shard = folder.path().join("memo").join(&key.to_string()[..2]);
    let path = fs::read_dir(shard).unwrap().flatten().next().unwrap().path();
    let bytes = fs::read(&path).unwrap();
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        fs::remove_file(&path).unwrap();
        fs::write(&path, &damaged).unwrap();
        assert_eq!(store.memo(&key).unwrap(), None, "a flip at {place}");
        fs::write(&path, &bytes[..place]).unwrap();
        assert_eq!(store.memo(&key).unwrap(), None, "cut at {place}");
    }
    fs::remove_file(store.path(&memo.objects[1])).unwrap();
    assert!(!open(folder.path()).has_all(&memo.objects).unwrap());
}

#[test]
fn has_all_gives_the_same_answer_for_few_and_for_many() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let objects: Vec<_> = (0..40).map(|number| put(&store, number).object()).collect();
    let many: Vec<_> = objects.iter().copied().cycle().take(2000).collect();
    assert!(open(folder.path()).has_all(&objects).unwrap());
    assert!(open(folder.path()).has_all(&many).unwrap());
    fs::remove_file(store.path(&objects[33])).unwrap();
    assert!(!open(folder.path()).has_all(&objects).unwrap());
    assert!(!open(folder.path()).has_all(&many).unwrap());
}

#[test]
fn campaigns_are_numbered_as_they_end() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    assert_eq!(store.campaigns().unwrap(), Vec::<u64>::new());
    let campaign = |workflow: &str| Campaign { workflow: workflow.to_owned(), seconds: 1.5, ..Campaign::default() };
    assert_eq!(store.record_campaign(&campaign("a.toml")).unwrap(), 1);
    assert_eq!(open(folder.path()).record_campaign(&campaign("b.toml")).unwrap(), 2);
    assert_eq!(store.campaigns().unwrap(), [1, 2]);
    let second = store.campaign(2).unwrap().unwrap();
    let expected = Campaign { number: 2, own: true, mark: second.mark.clone(), ..campaign("b.toml") };
    assert_eq!(second, expected);
    assert_eq!(store.campaign(3).unwrap(), None);
}

#[test]
fn a_claim_is_free_again_when_its_holder_gives_up() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (open(folder.path()), open(folder.path()));
    let key = Key::of(&text(1));
    let Claim::Mine(guard) = first.claim(&key).unwrap() else { panic!("it is free") };
    let Claim::Theirs(waiting) = second.claim(&key).unwrap() else { panic!("it is taken") };
    assert_eq!(waiting.holder.process, std::process::id());
    drop(guard);
    assert!(waiting.wait(|| false));
    assert!(matches!(second.claim(&key).unwrap(), Claim::Mine(_)));
}
