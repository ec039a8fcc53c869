//! Journals, objects, memos and listings under mutation: no panic, and nothing that carries the user's mark unless it was
//! written so.
//!
//! The inputs are a function of their number alone, made from a small corpus (`tests/reference/hostile` and what the store
//! writes). `FLOW_FUZZ=1000000 cargo test --release --lib store::tests::fuzz` runs as many as it says; a failure names the
//! number. What must hold for them is `store/hostile.rs`, which `fuzz/` runs with coverage as its guide.

use crate::store::hostile;
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

fn hostile_files() -> Vec<Vec<u8>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/hostile");
    let files = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|end| end == "h5")).collect();
    files.sort();
    files.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

#[test]
fn mutated_objects_are_refused_or_come_to_a_value_that_can_be_stored() {
    fuzz(&[hostile_files(), hostile::objects()].concat(), hostile::object);
}

#[test]
fn mutated_journals_give_no_own_record_that_was_not_written() {
    let journal = hostile::Journal::default();
    fuzz(&journal.corpus(), |bytes| journal.read(bytes));
}

#[test]
fn mutated_memos_are_none_or_what_was_written() {
    fuzz(&hostile::memos(), hostile::memo);
}

/// Writes what the store writes as the corpus of `fuzz/`: `cargo test --lib seeds -- --ignored`, after a change of a format.
#[test]
#[ignore = "writes into the repository"]
fn seeds() {
    let all =
        [("journal", hostile::Journal::default().corpus()), ("object", hostile::objects()), ("memo", hostile::memos())];
    for (name, corpus) in all {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(name);
        std::fs::create_dir_all(&folder).unwrap();
        for (number, bytes) in corpus.iter().enumerate() {
            std::fs::write(folder.join(number.to_string()), bytes).unwrap();
        }
    }
}
