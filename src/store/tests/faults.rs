//! A disk that fails: every operation of a piece of work in turn meets an error, a short write, or a write that lies.

use super::*;
use crate::store::fault::{Fault, met, plan};
use crate::store::{Campaign, Claim};

const EIO: i32 = 5;
const ENOSPC: i32 = 28;

fn text(number: u64) -> String {
    format!("work = test {number}")
}

/// What a run does with three tasks, a memo and its record; how far it came.
fn work(root: &std::path::Path) -> Result<(), StoreError> {
    let store = Store::open_as(root, Mark::of(&[1; 32]))?;
    for number in 0..3 {
        let key = Key::of(&text(number));
        if let Some(record) = store.find(&key)? {
            match store.get(&record.content) {
                Ok(artifact) => {
                    assert_eq!(artifact.content_hash(), result(number as f64).content_hash());
                    continue;
                }
                Err(error) if error.is_missing() => {}
                Err(error) => return Err(error),
            }
        }
        let claim = loop {
            match store.claim(&key)? {
                Claim::Mine(claim) => break claim,
                // A claim whose file could not be removed counts as held for a moment.
                Claim::Theirs(waiting) => assert!(waiting.wait(|| false)),
                Claim::Done(_) => panic!("it was not there"),
            }
        };
        // The second one is synced.
        store.finish(claim, text(number), result(number as f64), &timing(if number == 1 { 1.0 } else { 0.0 }))?;
    }
    let objects = (0..3).filter_map(|number| store.find(&Key::of(&text(number))).ok()?).map(|record| record.object());
    store
        .keep_memo(&Key::of("stage"), &Memo { note: "n".to_owned(), objects: objects.collect(), ..Memo::default() })?;
    store.record_campaign(&Campaign::default())?;
    Ok(())
}

/// Nothing that the store hands out is wrong, also to another user, and a run on a disk without faults completes it.
fn check(root: &std::path::Path, what: &str) {
    for user in [2, 1] {
        let store = Store::open_as(root, Mark::of(&[user; 32])).unwrap();
        for number in 0..3 {
            if let Some(record) = store.find(&Key::of(&text(number))).unwrap() {
                match store.get(&record.content) {
                    Ok(artifact) => assert_eq!(artifact.content_hash(), result(number as f64).content_hash(), "{what}"),
                    Err(error) => assert!(error.is_missing(), "{what}: {error}"),
                }
            }
        }
    }
    work(root).unwrap_or_else(|error| panic!("{what}: {error}"));
    work(root).unwrap_or_else(|error| panic!("{what}: {error}"));
    let store = Store::open_as(root, Mark::of(&[1; 32])).unwrap();
    let verdict = store.verify().unwrap();
    assert!(verdict.is_sound() && verdict.sound.files == 3, "{what}: {verdict:?}");
    assert_eq!(store.memo(&Key::of("stage")).unwrap().unwrap().objects.len(), 3, "{what}");
}

/// Lets each operation of the work meet the fault, in a new store or in one that holds the work already.
fn everywhere(fault: Fault, stays: bool, again: bool) {
    let mut operation = 0;
    loop {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("store");
        if again {
            work(&root).unwrap();
        }
        plan(Some(fault), operation, stays);
        let outcome = work(&root);
        let hit = met();
        plan(None, 0, false);
        if hit == 0 {
            assert!(operation > 10, "{fault:?}: there was nothing to meet");
            return outcome.unwrap();
        }
        check(&root, &format!("{fault:?} at operation {operation}, stays: {stays}, again: {again}"));
        operation += 1;
    }
}

#[test]
fn an_error_at_any_operation_costs_time_only() {
    for (error, stays) in [(EIO, false), (ENOSPC, true)] {
        everywhere(Fault::Error(error), stays, false);
    }
    everywhere(Fault::Error(EIO), false, true);
}

#[test]
fn a_short_write_anywhere_costs_time_only() {
    short_writes(Fault::Short);
}

#[test]
fn a_write_that_lies_anywhere_costs_time_only() {
    short_writes(Fault::Lie);
}

/// Writes are few: a store, its tasks, journal, memo, record.
fn short_writes(fault: Fault) {
    for operation in 0.. {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("store");
        plan(Some(fault), operation, false);
        let _ = work(&root);
        let hit = met();
        plan(None, 0, false);
        if hit == 0 {
            assert!(operation >= 8, "{fault:?}: only {operation} writes");
            return;
        }
        check(&root, &format!("{fault:?} at write {operation}"));
    }
}

/// On a network drive the name of a claim may already be that of another node's file, which only reading it back shows.
#[test]
fn a_result_whose_claim_holds_something_else_is_written_anew() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_as(folder.path(), Mark::of(&[1; 32])).unwrap();
    let Claim::Mine(claim) = store.claim(&Key::of(&text(0))).unwrap() else { panic!("nobody else computes it") };
    plan(Some(Fault::Lie), 0, false);
    let stored = store.finish(claim, text(0), result(0.0), &timing(0.0));
    assert_eq!(met(), 1);
    plan(None, 0, false);
    stored.unwrap();
    assert!(store.verify().unwrap().is_sound());
}

#[test]
fn a_disk_that_does_not_hold_what_it_is_given_is_not_called_full() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_as(folder.path(), Mark::of(&[1; 32])).unwrap();
    plan(Some(Fault::Lie), 0, true);
    let refused = store.put(&text(0), result(0.0), &timing(0.0)).map(|_| ());
    plan(None, 0, false);
    let error = refused.unwrap_err();
    assert!(matches!(error, StoreError::Changed { .. }), "{error}");
    assert!(error.to_string().contains("others were read back: the disk is failing"), "{error}");
}

/// After a power cut what was not synced may be there, in part, or not at all.
#[test]
fn what_a_power_cut_leaves_in_part_is_noticed_and_computed_again() {
    for cut in 0..40_u64 {
        let folder = tempfile::tempdir().unwrap();
        work(folder.path()).unwrap();
        let mut number = cut;
        let mut files = vec![folder.path().to_owned()];
        while let Some(path) = files.pop() {
            if path.is_dir() {
                files.extend(std::fs::read_dir(path).unwrap().flatten().map(|entry| entry.path()));
                files.sort();
                continue;
            }
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let bytes = std::fs::read(&path).unwrap();
            if number >> 62 == 0 && !path.ends_with("flow.store") {
                std::fs::remove_file(&path).unwrap();
                let mut left = bytes[..(number >> 33) as usize % (bytes.len() + 1)].to_vec();
                if number & 1 << 40 == 0 {
                    // Blocks that were given out and never written.
                    left.resize(bytes.len(), 0);
                }
                std::fs::write(&path, left).unwrap();
            }
        }
        check(folder.path(), &format!("cut {cut}"));
    }
}
