//! The store under faults: damage, kills, full and vanished disks, many processes, other programs that read its files.

#![allow(clippy::unwrap_used)]

mod damage;
mod disk;
mod processes;
mod readers;
mod trust;
mod upkeep;

use flow::artifact::{Artifact, Group, Key, Node, Table};
use flow::store::{Claim, Record, Store, Timing};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The text of task `number`.
fn text(number: u64) -> String {
    format!("work = test 1\nparameters = {{\"x\": {number}}}\n")
}

/// The result of task `number`: a table whose length varies, so that some are compressed; tasks 7 and 70 agree.
fn result(number: u64) -> Artifact {
    let number = if number == 70 { 7 } else { number };
    let rows = 1 + (number * number) % 2000;
    let table = Table { about: "made up".to_owned(), columns: Vec::new() }
        .reals_column("x", "m", "abscissa", (0..rows).map(|row| row as f64 * 1e-3).collect())
        .ints_column("n", "count", (0..rows).map(|row| (row * number) as i64).collect());
    Artifact::new("test", 1, Group::new().with("table", Node::Table(table)).with("number", Node::Int(number as i64)))
}

fn timing() -> Timing {
    Timing { started: SystemTime::now(), seconds: 0.0 }
}

fn open(root: &Path) -> Store {
    Store::open(root).expect("the store opens")
}

fn put(store: &Store, number: u64) -> Record {
    store.put(&text(number), result(number), &timing()).expect("the result is stored").0
}

fn found(store: &Store, number: u64) -> Option<Record> {
    store.find(&Key::of(&text(number))).expect("the journals are readable")
}

/// Computes tasks `0..count` as a run does: what is found is kept, what somebody else computes is waited for.
/// `computing` is called with the number of each task that is really computed. Returns the records in order.
fn run(store: &Store, count: u64, computing: impl Fn(u64)) -> Vec<Record> {
    let one = |number: u64| loop {
        if let Some(record) = found(store, number) {
            match store.get(&record.content) {
                Ok(artifact) => {
                    assert_eq!(artifact.content_hash(), result(number).content_hash());
                    return record;
                }
                Err(error) => assert!(error.is_missing(), "{error}"),
            }
        }
        match store.claim(&Key::of(&text(number))).expect("the store can be locked") {
            Claim::Mine(claim) => {
                computing(number);
                return store.finish(claim, text(number), result(number), &timing()).expect("the result is stored").0;
            }
            Claim::Done(record) => return record,
            Claim::Theirs(waiting) => assert!(waiting.wait(|| false)),
        }
    };
    (0..count).map(one).collect()
}

/// All object files below a store with their bytes, by name.
fn objects(root: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    for shard in std::fs::read_dir(root.join("objects")).expect("objects").flatten() {
        for file in std::fs::read_dir(shard.path()).expect("a folder").flatten() {
            let bytes = std::fs::read(file.path()).expect("a file");
            files.push((PathBuf::from(file.file_name()), bytes));
        }
    }
    files.sort();
    files
}
