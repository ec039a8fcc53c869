//! Objects and journals that are not what was written.

use crate::{found, open, put, result, run, text};
use flow::artifact::Key;
use flow::store::{Aside, Store, StoreError};
use std::fs;
use std::path::{Path, PathBuf};

/// Puts `bytes` in place of a stored object, whatever its permissions are.
fn replace(path: &Path, bytes: &[u8]) {
    if path.exists() {
        fs::remove_file(path).unwrap();
    }
    fs::write(path, bytes).unwrap();
}

/// A store with one object; its file and its bytes.
fn one_object(root: &Path) -> (Store, PathBuf, Vec<u8>) {
    let store = open(root);
    let record = put(&store, 3);
    let path = store.path(&record.object());
    let bytes = fs::read(&path).unwrap();
    (store, path, bytes)
}

/// The object reads as damaged, is set aside, and counts as missing in this process and the next.
fn assert_noticed(root: &Path, path: &Path, damaged: &[u8]) {
    let store = open(root);
    let record = found(&store, 3).expect("the file is there");
    match store.get(&record.content) {
        Err(StoreError::Damaged { fault }) => {
            let Aside::Moved(aside) = fault.aside else { panic!("it is set aside: {fault}") };
            assert_eq!(fs::read(&aside).unwrap(), damaged);
            fs::remove_file(aside).unwrap();
        }
        other => panic!("damage went unnoticed: {other:?}"),
    }
    assert_eq!(store.take_damages().len(), 1);
    assert!(!path.exists());
    assert_eq!(found(&store, 3), None);
    assert_eq!(found(&open(root), 3), None);
}

#[test]
fn a_flip_of_any_byte_of_an_object_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (_, path, bytes) = one_object(folder.path());
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        replace(&path, &damaged);
        assert_noticed(folder.path(), &path, &damaged);
    }
    replace(&path, &bytes);
    assert_eq!(*open(folder.path()).get(&result(3).content_hash()).unwrap(), result(3));
}

#[test]
fn an_object_of_another_length_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (_, path, bytes) = one_object(folder.path());
    for length in (0..bytes.len()).step_by(7).chain([bytes.len() - 1]) {
        replace(&path, &bytes[..length]);
        assert_noticed(folder.path(), &path, &bytes[..length]);
    }
    let longer = [&bytes[..], b"\0"].concat();
    replace(&path, &longer);
    assert_noticed(folder.path(), &path, &longer);
}

#[test]
fn another_valid_hdf5_file_in_its_place_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (store, path, _) = one_object(folder.path());
    let other = fs::read(store.path(&put(&store, 5).object())).unwrap();
    replace(&path, &other);
    assert_noticed(folder.path(), &path, &other);
}

#[test]
fn a_folder_in_its_place_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (store, path, _) = one_object(folder.path());
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    let next = open(folder.path());
    assert_eq!(found(&next, 3), None);
    let error = next.get(&result(3).content_hash()).unwrap_err();
    assert!(error.is_missing(), "{error}");
    let record = put(&store, 3);
    assert_eq!(*open(folder.path()).get(&record.content).unwrap(), result(3));
}

#[test]
fn what_is_damaged_is_computed_again_and_the_file_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (store, path, bytes) = one_object(folder.path());
    drop(store);
    replace(&path, b"");
    let computed = std::cell::RefCell::new(Vec::new());
    run(&open(folder.path()), 10, |number| computed.borrow_mut().push(number));
    assert_eq!(
        computed.into_inner(),
        (0..10).collect::<Vec<_>>(),
        "3 was computed again, the others for the first time"
    );
    assert_eq!(fs::read(&path).unwrap(), bytes);
    let aside: Vec<_> = fs::read_dir(folder.path().join("aside")).unwrap().flatten().collect();
    assert_eq!(aside.len(), 1, "the damaged file was kept");
}

#[test]
fn a_result_put_where_rubbish_lies_sets_it_aside() {
    let folder = tempfile::tempdir().unwrap();
    let (store, path, bytes) = one_object(folder.path());
    replace(&path, b"rubbish");
    put(&store, 3);
    assert_eq!(fs::read(&path).unwrap(), bytes);
    assert_eq!(
        fs::read(fs::read_dir(folder.path().join("aside")).unwrap().flatten().next().unwrap().path()).unwrap(),
        b"rubbish"
    );
}

/// The only segment of a store.
fn segment(root: &Path) -> PathBuf {
    let mut segments: Vec<_> = fs::read_dir(root.join("journal")).unwrap().flatten().collect();
    assert_eq!(segments.len(), 1);
    segments.remove(0).path()
}

/// Leaves these bytes as the only segment of a store.
fn only_segment(root: &Path, bytes: &[u8]) {
    fs::remove_dir_all(root.join("journal")).unwrap();
    fs::create_dir(root.join("journal")).unwrap();
    fs::write(root.join("journal/0000000000000-1-0.journal"), bytes).unwrap();
}

/// A store with a few results, its only segment, and the objects by number.
fn with_segment(root: &Path, count: u64) -> (Vec<u8>, Vec<flow::store::ObjectId>) {
    let store = open(root);
    let objects = (0..count).map(|number| put(&store, number).object()).collect();
    drop(store);
    (fs::read(segment(root)).unwrap(), objects)
}

#[test]
fn a_torn_journal_gives_the_records_that_are_whole_and_the_others_are_found_by_their_objects() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, objects) = with_segment(folder.path(), 4);
    assert_eq!(bytes.len(), 512 + 4 * 128);
    for length in 0..=bytes.len() {
        only_segment(folder.path(), &bytes[..length]);
        let store = open(folder.path());
        let whole = length.saturating_sub(512) / 128;
        assert_eq!(store.records().unwrap().len(), whole, "cut to {length} bytes");
        for (number, object) in objects.iter().enumerate() {
            assert_eq!(found(&store, number as u64).map(|record| record.object()), Some(*object));
        }
        // What was found without a record has one now.
        assert_eq!(open(folder.path()).records().unwrap().len(), 4, "cut to {length} bytes");
    }
}

#[test]
fn a_flip_of_any_byte_of_a_journal_gives_no_wrong_result() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, objects) = with_segment(folder.path(), 3);
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        only_segment(folder.path(), &damaged);
        let store = open(folder.path());
        for (number, object) in objects.iter().enumerate() {
            let now = found(&store, number as u64);
            assert_eq!(now.map(|record| record.object()), Some(*object), "a flip at {place}");
        }
        assert!(store.take_damages().is_empty(), "a flip at {place}");
    }
}

#[test]
fn a_store_whose_journal_is_lost_is_found_again_from_its_objects() {
    let folder = tempfile::tempdir().unwrap();
    let (_, objects) = with_segment(folder.path(), 20);
    fs::remove_dir_all(folder.path().join("journal")).unwrap();
    let store = open(folder.path());
    assert_eq!(*store.get(&objects[2].content).unwrap(), result(2));
    assert_eq!(found(&store, 1).unwrap().object(), objects[1]);
    let verdict = store.verify().unwrap();
    assert_eq!(verdict.adopted.len(), 18);
    assert!(verdict.is_sound());
    for (number, object) in objects.iter().enumerate() {
        assert_eq!(found(&open(folder.path()), number as u64).unwrap().object(), *object);
    }
    assert_eq!(store.find(&Key::of(&text(99))).unwrap(), None);
}
