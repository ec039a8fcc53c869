//! The journal: which task has which result. Append-only, one segment per writing process, merged on read.
//!
//! A segment is a head of [`HEAD`] bytes, readable with `head -1`, that says on what machine and by what version its
//! records were made, followed by records of [`RECORD`] bytes each:
//!
//! | bytes | field |
//! |---|---|
//! | 0–31 | key of the task |
//! | 32–63 | content hash of the result |
//! | 64–95 | blake3 of the object's file |
//! | 96–103 | size of the object's file, bytes |
//! | 104–111 | start of the task, milliseconds since 1970 UTC |
//! | 112–119 | duration of the task, seconds, as a real number |
//! | 120–127 | first bytes of the blake3 of bytes 0–119 |
//!
//! All numbers are little-endian. Records have one length, so the frame of a record is its place: a torn tail is
//! shorter than a record, a damaged record is skipped, and neither hides those behind it. A process writes only to
//! its own segment, at places it counts itself, so a write that failed halfway is overwritten by the next. Of two
//! records with the same key the later one counts.

use super::disk::Disk;
use super::object::Seal;
use super::{Origin, Record, StoreError};
use crate::artifact::{ContentHash, Key};
use std::collections::HashMap;
use std::ffi::OsString;
use std::fs::File;
use std::hash::{BuildHasherDefault, Hasher};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::Arc;

/// Length of a record, bytes.
pub(super) const RECORD: usize = 128;
/// Length of a segment's head, bytes.
pub(super) const HEAD: usize = 512;
const MAGIC: &str = "flow journal 1 ";

/// Folder of the segments.
pub(super) fn folder(disk: &Disk) -> PathBuf {
    disk.root.join("journal")
}

/// The journals as read so far.
#[derive(Default)]
pub(super) struct Index {
    tasks: HashMap<Key, Entry, BuildHasherDefault<FirstBytes>>,
    contents: HashMap<ContentHash, Key, BuildHasherDefault<FirstBytes>>,
    origins: Vec<Arc<Origin>>,
    /// How far each segment has been read, and the origin of its records.
    read: HashMap<OsString, (u64, u32)>,
    /// Records that were skipped because their checksum is wrong.
    pub(super) damaged: usize,
    /// Tasks for which two records give different contents.
    pub(super) contradictions: Vec<(Key, ContentHash, ContentHash)>,
}

#[derive(Clone, Copy)]
struct Entry {
    content: ContentHash,
    seal: Seal,
    started: i64,
    seconds: f64,
    origin: u32,
}

impl Index {
    /// Reads what is new in all segments.
    pub(super) fn refresh(&mut self, disk: &Disk) -> Result<(), StoreError> {
        let folder = folder(disk);
        let segments = match std::fs::read_dir(&folder) {
            Ok(segments) => segments,
            Err(error) if error.kind() == ErrorKind::NotFound && disk.root.is_dir() => return Ok(()),
            Err(error) => return Err(disk.fail("list", &folder, error)),
        };
        let mut names: Vec<OsString> = segments.flatten().map(|entry| entry.file_name()).collect();
        names.retain(|name| name.to_str().is_some_and(|name| name.ends_with(".journal")));
        names.sort();
        for name in names {
            let path = folder.join(&name);
            match self.read_segment(name, &path) {
                // A segment that gc has merged into another one in the meantime.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                other => other.map_err(|error| disk.fail("read", &path, error))?,
            }
        }
        Ok(())
    }

    fn read_segment(&mut self, name: OsString, path: &std::path::Path) -> std::io::Result<()> {
        let mut file = File::open(path)?;
        let known = self.read.get(&name).copied();
        let mut bytes = Vec::new();
        if let Some((end, _)) = known {
            file.seek(SeekFrom::Start(end))?;
        }
        file.read_to_end(&mut bytes)?;
        let (start, origin) = match known {
            Some((end, origin)) => (end, origin),
            None if bytes.len() < HEAD => return Ok(()),
            None => {
                self.origins.push(Arc::new(read_head(&bytes[..HEAD])));
                bytes.drain(..HEAD);
                (HEAD as u64, (self.origins.len() - 1) as u32)
            }
        };
        let records = bytes.as_chunks::<RECORD>().0;
        self.tasks.reserve(records.len());
        self.contents.reserve(records.len());
        for record in records {
            match unpack(record, origin) {
                Some((key, entry)) => self.insert(key, entry),
                None => self.damaged += 1,
            }
        }
        self.read.insert(name, (start + (records.len() * RECORD) as u64, origin));
        Ok(())
    }

    fn insert(&mut self, key: Key, entry: Entry) {
        if let Some(old) = self.tasks.get(&key) {
            if old.content != entry.content {
                self.contradictions.push((key, old.content, entry.content));
            }
            // The later record counts; of two at the same moment the same one everywhere.
            if (old.started, old.content) > (entry.started, entry.content) {
                return;
            }
        }
        self.contents.insert(entry.content, key);
        self.tasks.insert(key, entry);
    }

    /// Adds a record that this process has appended.
    pub(super) fn add(&mut self, record: &Record) {
        let known = self.origins.iter().position(|origin| *origin == record.origin);
        let origin = known.unwrap_or_else(|| {
            self.origins.push(record.origin.clone());
            self.origins.len() - 1
        }) as u32;
        let (seal, started, seconds) = (record.seal, record.started, record.seconds);
        self.insert(record.key, Entry { content: record.content, seal, started, seconds, origin });
    }

    pub(super) fn find(&self, key: &Key) -> Option<Record> {
        self.tasks.get(key).map(|entry| self.record(*key, entry))
    }

    /// The records whose result is `content`, the one a lookup finds at once first.
    pub(super) fn with_content(&self, content: &ContentHash) -> Vec<Record> {
        let Some(first) = self.contents.get(content) else { return Vec::new() };
        let mut found: Vec<Record> = self.find(first).filter(|record| record.content == *content).into_iter().collect();
        if found.is_empty() {
            found = self.records().into_iter().filter(|record| record.content == *content).collect();
        }
        found
    }

    /// All records, in the order of their keys.
    pub(super) fn records(&self) -> Vec<Record> {
        let mut records: Vec<Record> = self.tasks.iter().map(|(key, entry)| self.record(*key, entry)).collect();
        records.sort_by_key(|record| record.key);
        records
    }

    fn record(&self, key: Key, entry: &Entry) -> Record {
        let Entry { content, seal, started, seconds, origin } = *entry;
        Record { key, content, seal, started, seconds, origin: self.origins[origin as usize].clone() }
    }

    /// Names of the segments read so far.
    pub(super) fn segments(&self) -> Vec<OsString> {
        self.read.keys().cloned().collect()
    }
}

/// The segment of this process; the file is made with the first record.
#[derive(Default)]
pub(super) struct Segment {
    file: Option<(File, u64)>,
}

impl Segment {
    /// Appends one record.
    pub(super) fn append(&mut self, disk: &Disk, record: &Record, durable: bool) -> Result<(), StoreError> {
        let folder = folder(disk);
        if self.file.is_none() {
            self.file = Some((create(disk, &record.origin)?, HEAD as u64));
        }
        let Some((file, end)) = &mut self.file else { return Ok(()) };
        file.seek(SeekFrom::Start(*end))
            .and_then(|_| file.write_all(&pack(record)))
            .map_err(|error| disk.fail("write to", &folder, error))?;
        *end += RECORD as u64;
        if durable {
            file.sync_data().map_err(|error| disk.fail("sync", &folder, error))?;
        }
        Ok(())
    }
}

/// A new segment whose head is written.
pub(super) fn create(disk: &Disk, origin: &Origin) -> Result<File, StoreError> {
    let folder = folder(disk);
    disk.make_dir(&folder)?;
    let started = super::now_ms();
    let mut builder = tempfile::Builder::new();
    let prefix = format!("{started:013}-{}-", std::process::id());
    builder.prefix(&prefix).suffix(".journal");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    let fail = |error| disk.fail("create a segment in", &folder, error);
    let mut file = builder.tempfile_in(&folder).map_err(fail)?;
    file.write_all(&head(origin)).map_err(fail)?;
    let (file, _) = file.keep().map_err(|error| fail(error.error))?;
    Ok(file)
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

fn read_head(bytes: &[u8]) -> Origin {
    let line = str::from_utf8(bytes).ok().and_then(|text| text.strip_prefix(MAGIC));
    line.and_then(|json| serde_json::from_str(json.trim_end()).ok()).unwrap_or_default()
}

/// The bytes of a record.
pub(super) fn pack(record: &Record) -> [u8; RECORD] {
    let mut bytes = [0; RECORD];
    bytes[..32].copy_from_slice(&record.key.0);
    bytes[32..64].copy_from_slice(&record.content.0);
    bytes[64..96].copy_from_slice(&record.seal.digest);
    bytes[96..104].copy_from_slice(&record.seal.size.to_le_bytes());
    bytes[104..112].copy_from_slice(&record.started.to_le_bytes());
    bytes[112..120].copy_from_slice(&record.seconds.to_le_bytes());
    let check = blake3::hash(&bytes[..120]);
    bytes[120..].copy_from_slice(&check.as_bytes()[..8]);
    bytes
}

fn unpack(bytes: &[u8; RECORD], origin: u32) -> Option<(Key, Entry)> {
    if blake3::hash(&bytes[..120]).as_bytes()[..8] != bytes[120..] {
        return None;
    }
    let hash = |from: usize| {
        let mut hash = [0; 32];
        hash.copy_from_slice(&bytes[from..from + 32]);
        hash
    };
    let word = |from: usize| {
        let mut word = [0; 8];
        word.copy_from_slice(&bytes[from..from + 8]);
        word
    };
    let seal = Seal { digest: hash(64), size: u64::from_le_bytes(word(96)) };
    let (started, seconds) = (i64::from_le_bytes(word(104)), f64::from_le_bytes(word(112)));
    Some((Key(hash(0)), Entry { content: ContentHash(hash(32)), seal, started, seconds, origin }))
}

/// Hashes are evenly spread already: their first bytes serve as the hash of the map.
#[derive(Default)]
pub(super) struct FirstBytes(u64);

impl Hasher for FirstBytes {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        if let Some(first) = bytes.first_chunk::<8>() {
            self.0 = u64::from_le_bytes(*first);
        }
    }
    fn write_usize(&mut self, _: usize) {}
}
