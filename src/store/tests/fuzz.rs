//! Journals, objects, memos and listings under mutation: no panic, and nothing that carries the user's mark unless it was
//! written so.
//!
//! The inputs are a function of their number alone, made from a small corpus (`tests/reference/hostile` and what the store
//! writes). `FLOW_FUZZ=1000000 cargo test --release --lib store::tests::fuzz` runs as many as it says; a failure names the
//! number. The harness needs no nightly compiler, so it runs wherever the tests do.

use super::*;
use crate::artifact::ContentHash;
use crate::store::journal::Index;
use crate::store::{hdf5, memo};
use math::random::Stream;
use std::panic::{AssertUnwindSafe, catch_unwind};

const IN_EVERY_TEST_RUN: u64 = 300;

fn inputs() -> u64 {
    std::env::var("FLOW_FUZZ").ok().and_then(|count| count.parse().ok()).unwrap_or(IN_EVERY_TEST_RUN)
}

/// The input of this number: one of the corpus with a few bytes flipped, cut, doubled or put in from another one.
fn mutated(number: u64, corpus: &[Vec<u8>]) -> Vec<u8> {
    let mut stream = Stream::new(7, "store fuzz", number);
    let mut pick = |below: usize| (stream.uniform() * below.max(1) as f64) as usize;
    let mut bytes = corpus[pick(corpus.len())].clone();
    for _ in 0..=pick(6) {
        let (at, length) = (pick(bytes.len() + 1), pick(64));
        let end = (at + length).min(bytes.len());
        match pick(7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << pick(8),
            1 if at < bytes.len() => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][pick(5)],
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            5 => {
                let other = &corpus[pick(corpus.len())];
                let from = pick(other.len());
                bytes.splice(at..end, other[from..(from + length).min(other.len())].to_vec());
            }
            _ => bytes[at..end].fill(pick(256) as u8),
        }
    }
    bytes
}

/// Runs a target on every input.
fn fuzz(corpus: &[Vec<u8>], mut target: impl FnMut(&[u8])) {
    for number in 0..inputs() {
        let bytes = mutated(number, corpus);
        let outcome = catch_unwind(AssertUnwindSafe(|| target(&bytes)));
        assert!(outcome.is_ok(), "input {number} of {} bytes", bytes.len());
    }
}

fn hostile() -> Vec<Vec<u8>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/hostile");
    let files = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|end| end == "h5")).collect();
    files.sort();
    files.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

#[test]
fn mutated_objects_are_refused_or_come_to_a_value_that_can_be_stored() {
    let mut corpus = hostile();
    for value in 0..4 {
        corpus.push(hdf5::encode(&result(f64::from(value)), "work = test".to_owned()).unwrap());
    }
    fuzz(&corpus, |bytes| {
        if let Ok((artifact, text)) = hdf5::decode(bytes.to_vec()) {
            let (content, bytes) = (artifact.content_hash(), artifact.bytes());
            assert!(bytes < 1 << 30);
            if let Ok(image) = hdf5::encode(&artifact.canonical(), text) {
                assert_eq!(hdf5::decode(image).unwrap().0.content_hash(), content);
            }
        }
    });
}

#[test]
fn mutated_journals_give_no_own_record_that_was_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let mark = Mark::of(&[1; 32]);
    let store = Store::open_as(folder.path(), mark.clone()).unwrap();
    let written: Vec<_> =
        (0..3).map(|n| store.put(&format!("t{n}"), result(f64::from(n)), &timing(0.0)).unwrap().0.object()).collect();
    drop(store);
    let journal = folder.path().join("journal");
    let path = std::fs::read_dir(&journal).unwrap().flatten().next().unwrap().path();
    let bytes = std::fs::read(&path).unwrap();
    let first = [b"flow journal 1 {}".to_vec(), bytes[17..].to_vec()].concat();
    let disk = Disk { root: folder.path().to_owned(), read_only: false };
    fuzz(&[bytes, first, vec![b' '; 700]], |bytes| {
        std::fs::write(&path, bytes).unwrap();
        let mut index = Index::new(mark.clone(), "here");
        index.refresh(&disk, &Default::default()).unwrap();
        for record in index.records() {
            assert!(!record.own || written.contains(&record.object()));
            assert!(record.seconds.is_finite());
            index.of_task(&record.key);
            index.with_content(&record.content);
        }
        index.damaged();
        index.marked_records();
    });
}

#[test]
fn mutated_memos_are_none_or_what_was_kept() {
    let mark = Mark::of(&[1; 32]);
    let object = ObjectId { content: ContentHash([3; 32]), key: Key([4; 32]) };
    let memo = |note: &str, data: usize, objects: usize| Memo {
        note: note.to_owned(),
        data: vec![5; data],
        objects: vec![object; objects],
    };
    let kept = [memo("", 0, 0), memo("σ = 3", 40, 1), memo("{}", 300, 9)];
    let key = Key([1; 32]);
    let corpus: Vec<_> = kept.iter().map(|one| memo::pack(&mark, &key, one)).collect();
    fuzz(&corpus, |bytes| {
        if let Some(found) = memo::unpack(&mark, &key, bytes) {
            assert!(kept.contains(&found));
        }
        // With a right checksum, as anybody can make one.
        let mut forged = bytes.to_vec();
        if let Some(end) = forged.len().checked_sub(32) {
            let check = blake3::hash(&forged[..end]);
            forged[end..].copy_from_slice(check.as_bytes());
            assert_eq!(memo::unpack(&mark, &key, &forged), None);
        }
    });
}
