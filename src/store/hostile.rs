//! What holds for any bytes in a journal, an object or a memo: for the tests, and for `fuzz/`.
//!
//! Each reader gets bytes; an assertion fails if they make it panic, take memory on their word, or believe what was never
//! written.

use super::disk::Disk;
use super::{Mark, Memo, ObjectId, Store, Timing, hdf5, journal::Index, memo};
use crate::artifact::{Artifact, ContentHash, Group, Key, Node, Table};
use std::path::PathBuf;
use std::time::SystemTime;
use tempfile::TempDir;

/// A small artifact.
pub(super) fn result(value: f64) -> Artifact {
    let table = Table::default().reals_column("strength", "Pa", "peak stress", vec![value, -0.0, f64::NAN]);
    Artifact::new("table", 1, Group::new().with("table", Node::Table(table)))
}

fn mark() -> Mark {
    Mark::of(&[1; 32])
}

fn broken<T>(error: impl std::fmt::Display) -> T {
    panic!("BUG: a corpus that cannot be made: {error}")
}

/// Objects as the store writes them.
pub fn objects() -> Vec<Vec<u8>> {
    let image = |value| hdf5::encode(&result(f64::from(value)), "work = test".to_owned()).unwrap_or_else(broken);
    (0..4).map(image).collect()
}

/// An object is refused, or comes to a value that can be stored and comes back as it is.
pub fn object(bytes: &[u8]) {
    let Ok((artifact, text)) = hdf5::decode(bytes.to_vec()) else { return };
    let (content, bytes) = (artifact.content_hash(), artifact.bytes());
    assert!(bytes < 1 << 30);
    if let Ok(image) = hdf5::encode(&artifact.canonical(), text) {
        let (again, _) = hdf5::decode(image).unwrap_or_else(broken);
        assert_eq!(again.content_hash(), content);
    }
}

/// A store with one journal, whose bytes a test replaces.
pub struct Journal {
    disk: Disk,
    path: PathBuf,
    written: Vec<ObjectId>,
    bytes: Vec<u8>,
    _folder: TempDir,
}

impl Default for Journal {
    fn default() -> Self {
        let folder = tempfile::tempdir().unwrap_or_else(broken);
        let store = Store::open_as(folder.path(), mark()).unwrap_or_else(broken);
        let timing = Timing { started: SystemTime::now(), seconds: 0.0 };
        let put = |n: i32| store.put(&format!("t{n}"), result(f64::from(n)), &timing).unwrap_or_else(broken).0.object();
        let written = (0..3).map(put).collect();
        drop(store);
        let mut journals = std::fs::read_dir(folder.path().join("journal")).unwrap_or_else(broken).flatten();
        let path = journals.next().unwrap_or_else(|| broken("no journal")).path();
        let bytes = std::fs::read(&path).unwrap_or_else(broken);
        let disk = Disk { root: folder.path().to_owned(), read_only: false };
        Self { disk, path, written, bytes, _folder: folder }
    }
}

impl Journal {
    /// Journals as flow writes them, and one of an older version.
    pub fn corpus(&self) -> Vec<Vec<u8>> {
        let first = [b"flow journal 1 {}".to_vec(), self.bytes[17..].to_vec()].concat();
        vec![self.bytes.clone(), first, vec![b' '; 700]]
    }

    /// A journal gives no record under the user's mark that was not written.
    pub fn read(&self, bytes: &[u8]) {
        std::fs::write(&self.path, bytes).unwrap_or_else(broken);
        let mut index = Index::new(mark(), "here");
        index.refresh(&self.disk, &Default::default()).unwrap_or_else(broken);
        for record in index.records() {
            assert!(!record.own || self.written.contains(&record.object()));
            assert!(record.seconds.is_finite());
            index.of_task(&record.key);
            index.with_content(&record.content);
        }
        index.damaged();
        index.marked_records();
    }
}

const KEY: Key = Key([1; 32]);

fn written_memos() -> [Memo; 3] {
    let object = ObjectId { content: ContentHash([3; 32]), key: Key([4; 32]) };
    let memo = |note: &str, data: usize, objects: usize| Memo {
        note: note.to_owned(),
        data: vec![5; data],
        objects: vec![object; objects],
    };
    [memo("", 0, 0), memo("σ = 3", 40, 1), memo("{}", 300, 9)]
}

/// Memos as the store writes them.
pub fn memos() -> Vec<Vec<u8>> {
    let packed = |one: &Memo| {
        let mut bytes = Vec::new();
        let mut out = |part: &[u8]| std::io::Write::write_all(&mut bytes, part);
        memo::pack(&mark(), &KEY, one.into(), &mut out).unwrap_or_else(|error| panic!("BUG: no memory: {error}"));
        bytes
    };
    written_memos().iter().map(packed).collect()
}

/// A memo is none, or one that was written; one with a checksum that anybody can make is none.
pub fn memo(bytes: &[u8]) {
    if let Some(found) = memo::unpack(&mark(), &KEY, bytes) {
        assert!(written_memos().contains(&found));
    }
    let mut forged = bytes.to_vec();
    if let Some(end) = forged.len().checked_sub(32) {
        let check = blake3::hash(&forged[..end]);
        forged[end..].copy_from_slice(check.as_bytes());
        assert_eq!(memo::unpack(&mark(), &KEY, &forged), None);
    }
}
