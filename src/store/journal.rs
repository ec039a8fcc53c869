//! The journal: which task has which result. It is append-only, has one segment per writing process, and is merged on
//! reading.
//!
//! A segment is a head of [`HEAD`] bytes, readable with `head -1`, that says on what machine and by what version its
//! records were made, followed by records of [`RECORD`] bytes each (`journal/record.rs`). Records have one length, so the
//! offset of a record follows from its index: a torn tail is shorter than a record, a damaged record is skipped, and neither
//! hides those after it. A process writes only to its own segment, at offsets that it counts itself, so a write that failed
//! halfway is overwritten by the next.
//!
//! Nothing here depends on the order of records or on a clock: all records of a task are returned, and the store decides by
//! their marks and by the objects.

mod index;
mod record;

pub(super) use index::Index;
pub(super) use record::{RECORD, pack, seal, unpack};

use super::disk::{Disk, Draft};
use super::folder::{self, Folder};
use super::lock::Held;
use super::{Origin, Record, StoreError};
use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Folder of the segments.
pub(super) const FOLDER: &str = "journal";
/// Length of a segment's head, bytes.
pub(super) const HEAD: usize = 512;
const MAGIC: &str = "flow journal 2 ";
/// Heads of the segments of earlier versions.
const MAGIC_1: &str = "flow journal 1 ";
/// The largest segment: more records than an index can number.
const MOST: u64 = 1 << 38;
/// Interval between syncs of a segment, so that other nodes see its records soon.
const SYNC_EACH: Duration = Duration::from_secs(1);

/// Whether a file among the segments is one that flow wrote.
pub(super) fn is_ours(folder: &Folder, name: &str) -> bool {
    is_name(name) && folder.begins_with(name, b"flow journal ")
}

fn is_name(name: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
    name.strip_suffix(".journal").is_some_and(|stem| stem.len() > 13 && stem.bytes().all(plain))
}

/// The process in the name of a segment.
fn writer_of(name: &str) -> Option<u32> {
    name.split('-').nth(1)?.parse().ok()
}

/// Whether the store has a segment.
pub(super) fn is_there(disk: &Disk) -> Result<bool, StoreError> {
    let Some(folder) = disk.find_folder(FOLDER)? else { return Ok(false) };
    let mut there = false;
    let listed = folder.list(|name, _| there |= is_ours(&folder, name));
    listed.map_err(|error| disk.fail("list", &disk.root.join(FOLDER), error))?;
    Ok(there)
}

/// The segments of this process, one for each origin of what it records; a file is made with its first record, and locked
/// for as long as the process lives.
#[derive(Default)]
pub(super) struct Segments(Vec<Segment>);

struct Segment {
    origin: Arc<Origin>,
    held: Held,
    name: String,
    path: PathBuf,
    end: u64,
    /// Whether its head and its name would survive a power cut; the first record that must survive one makes it so.
    safe: bool,
    synced: Instant,
}

impl Segments {
    /// Appends one record.
    pub(super) fn append(&mut self, disk: &Disk, record: &Record, durable: bool) -> Result<(), StoreError> {
        let known = self.0.iter().position(|segment| segment.origin == record.origin);
        let number = match known {
            Some(number) => number,
            None => {
                self.0.push(create(disk, &record.origin)?);
                self.0.len() - 1
            }
        };
        self.0[number].append(disk, record, durable)
    }

    /// Whether a segment is one of this process.
    pub(super) fn has(&self, name: &str) -> bool {
        self.0.iter().any(|segment| segment.name == name)
    }
}

impl Segment {
    fn append(&mut self, disk: &Disk, record: &Record, durable: bool) -> Result<(), StoreError> {
        let mut file = &self.held.0;
        let sync = durable || self.synced.elapsed() > SYNC_EACH;
        file.seek(SeekFrom::Start(self.end))
            .and_then(|_| folder::write(file, &pack(record)))
            .and_then(|()| if sync { folder::sync(file) } else { Ok(()) })
            .map_err(|error| disk.fail("write", &self.path, error))?;
        self.end += RECORD as u64;
        if sync {
            self.synced = Instant::now();
        }
        if durable && !self.safe {
            disk.sync_folder(FOLDER)?;
            self.safe = true;
        }
        Ok(())
    }
}

/// A new segment. It is locked and has its head before it has its name, so that no reader takes it for a finished one.
fn create(disk: &Disk, origin: &Arc<Origin>) -> Result<Segment, StoreError> {
    let mut draft = disk.draft(FOLDER, 0o644)?;
    let fail = |error| disk.fail("create a file in", &disk.root.join(FOLDER), error);
    let _ = draft.file.try_lock();
    folder::write(&draft.file, &head(origin)).map_err(fail)?;
    let unique = draft.name.rsplit('-').next().unwrap_or_default();
    // The time in the name is for persons who read the folder.
    let name = format!("{:013}-{}-{unique}.journal", super::now_ms(), std::process::id());
    draft.persist_new(&name).map_err(fail)?;
    let file: File = Draft::into_file(draft).map_err(fail)?;
    let path = disk.path(FOLDER, &name);
    let (origin, held) = (Arc::clone(origin), Held(file));
    Ok(Segment { origin, held, name, path, end: HEAD as u64, safe: false, synced: Instant::now() })
}

/// Writes a finished segment with these records, which have one origin.
pub(super) fn write_segment(disk: &Disk, records: &[Record]) -> Result<(), StoreError> {
    let Some(first) = records.first() else { return Ok(()) };
    let open = create(disk, &first.origin)?;
    let bytes: Vec<u8> = records.iter().flat_map(pack).collect();
    let written = folder::write(&open.held.0, &bytes).and_then(|()| folder::sync(&open.held.0));
    written.map_err(|error| disk.fail("write", &open.path, error))?;
    disk.sync_folder(FOLDER)
}

/// The head of a segment: one line of text, padded.
pub(super) fn head(origin: &Origin) -> Vec<u8> {
    let mut line = format!("{MAGIC}{}", serde_json::to_string(&origin.shortened()).unwrap_or_default());
    while line.len() < HEAD - 1 {
        line.push(' ');
    }
    line.push('\n');
    line.into_bytes()
}

/// The version of a segment and where its records were made.
pub(super) fn read_head(bytes: &[u8]) -> (u32, Origin) {
    let text = str::from_utf8(bytes).unwrap_or_default();
    let (version, json) = match (text.strip_prefix(MAGIC), text.strip_prefix(MAGIC_1)) {
        (None, Some(json)) => (1, json),
        (json, _) => (2, json.unwrap_or_default()),
    };
    (version, serde_json::from_str::<Origin>(json.trim_end()).unwrap_or_default().shortened())
}
