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

use super::disk::{Disk, TEMPORARY};
use super::lock::Held;
use super::object::Seal;
use super::{Origin, Record, StoreError};
use crate::artifact::{ContentHash, FirstBytes, Key};
use std::collections::{HashMap, HashSet};
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::hash::BuildHasherDefault;
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

/// Length of a record, bytes.
pub(super) const RECORD: usize = 128;
/// Length of a segment's head, bytes.
pub(super) const HEAD: usize = 512;
/// So many objects with one content are tried.
const MOST_ALIKE: usize = 8;
/// Where the key and the content stand in a record.
const KEY: usize = 0;
const CONTENT: usize = 32;
const MAGIC: &str = "flow journal 1 ";
/// Longer than the step of any file system's times but the coarsest (FAT, 2 s).
const TIME_STEP: Duration = Duration::from_millis(100);

/// Folder of the segments.
pub(super) fn folder(disk: &Disk) -> PathBuf {
    disk.root.join("journal")
}

/// The journals as read so far. Records stay as the bytes they are; each is checked when it is asked for.
#[derive(Default)]
pub(super) struct Index {
    records: Vec<[u8; RECORD]>,
    /// The records from this number on have this origin.
    made: Vec<(usize, u32)>,
    origins: Vec<Arc<Origin>>,
    by_key: Numbers,
    by_content: Numbers,
    /// Segments read, so that none is read twice.
    seen: HashSet<OsString>,
    /// Segments whose writers were alive when they were first read: only these can grow.
    growing: Vec<Growing>,
    /// When the folder had last changed, as seen by the last look, and when that look was.
    looked: Option<(SystemTime, SystemTime)>,
}

/// What [`Index::faults`] finds in the journals.
#[derive(Default)]
pub(super) struct Faults {
    /// Records that are skipped because their checksum is wrong.
    pub(super) damaged: usize,
    /// Tasks for which two records give different contents.
    pub(super) contradictions: Vec<(Key, ContentHash, ContentHash)>,
}

/// Numbers of records by the first bytes of a hash in them.
#[derive(Default)]
struct Numbers {
    last: HashMap<u64, u32, BuildHasherDefault<FirstBytes>>,
    /// The record before each one that begins alike; itself when there is none.
    before: Vec<u32>,
}

impl Numbers {
    /// Takes in the records that are new; their hashes begin at byte `place`.
    fn update(&mut self, records: &[[u8; RECORD]], place: usize) {
        self.last.reserve(records.len() - self.before.len());
        for number in self.before.len()..records.len() {
            let number = number as u32;
            let before = self.last.insert(word(&records[number as usize], place), number);
            self.before.push(before.unwrap_or(number));
        }
    }

    /// Numbers of the records whose hash begins so, the last one first.
    fn of(&self, hash: &[u8; 32]) -> impl Iterator<Item = usize> {
        let mut next = self.last.get(&word(hash, 0)).copied();
        std::iter::from_fn(move || {
            let number = next?;
            next = Some(self.before[number as usize]).filter(|&before| before != number);
            Some(number as usize)
        })
    }
}

/// A segment of another live process; without locks on the file system, of any process.
struct Growing {
    file: File,
    /// How far it has been read.
    end: u64,
    origin: u32,
}

impl Index {
    /// Reads what is new in all segments; `own` is the segment of this process, whose records are added as they are made.
    pub(super) fn refresh(&mut self, disk: &Disk, own: Option<&OsStr>) -> Result<(), StoreError> {
        let folder = folder(disk);
        let fail = |error| disk.fail("read", &folder, error);
        for place in 0..self.growing.len() {
            let Growing { file, end, origin } = &mut self.growing[place];
            file.seek(SeekFrom::Start(*end)).map_err(fail)?;
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).map_err(fail)?;
            let origin = *origin;
            self.growing[place].end += self.take(&bytes, origin);
        }
        for name in self.new_segments(disk)? {
            match self.read_segment(&folder.join(&name), own == Some(&name)) {
                // A segment that gc has merged into another one in the meantime.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                other => other.map_err(|error| disk.fail("read", &folder.join(&name), error))?,
            }
            self.seen.insert(name);
        }
        Ok(())
    }

    /// Names of segments that have not been read; the folder is listed only when it has changed.
    fn new_segments(&mut self, disk: &Disk) -> Result<Vec<OsString>, StoreError> {
        let folder = folder(disk);
        let now = SystemTime::now();
        let changed = match std::fs::metadata(&folder).and_then(|folder| folder.modified()) {
            Ok(changed) => changed,
            Err(error) if error.kind() == ErrorKind::NotFound && disk.root.is_dir() => return Ok(Vec::new()),
            Err(error) => return Err(disk.fail("read", &folder, error)),
        };
        // Times of files move in steps, so a folder that had just changed may change again without showing it.
        if self.looked.is_some_and(|(before, when)| before == changed && when > changed + TIME_STEP) {
            return Ok(Vec::new());
        }
        self.looked = Some((changed, now));
        let entries = std::fs::read_dir(&folder).map_err(|error| disk.fail("list", &folder, error))?;
        let is_new =
            |name: &OsString| name.to_str().is_some_and(|name| name.ends_with(".journal")) && !self.seen.contains(name);
        let mut names: Vec<OsString> = entries.flatten().map(|entry| entry.file_name()).filter(is_new).collect();
        names.sort();
        Ok(names)
    }

    fn read_segment(&mut self, path: &Path, own: bool) -> std::io::Result<()> {
        let mut file = File::open(path)?;
        // Asked before reading: what a dead process has written is all there is.
        let alive = file.try_lock_shared().is_err();
        let mut head = [0; HEAD];
        match file.read_exact(&mut head) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(()),
            other => other?,
        }
        self.origins.push(Arc::new(read_head(&head)));
        let origin = (self.origins.len() - 1) as u32;
        let end = HEAD as u64 + self.read_records(&mut file, origin)?;
        if alive && !own {
            self.growing.push(Growing { file, end, origin });
        }
        Ok(())
    }

    /// Takes in the whole records that follow in a file, at once into their place; returns their length.
    fn read_records(&mut self, file: &mut File, origin: u32) -> std::io::Result<u64> {
        self.push(&[], origin);
        let (first, length) = (self.records.len(), file.metadata()?.len().saturating_sub(HEAD as u64));
        self.records.resize(first + (length / RECORD as u64) as usize, [0; RECORD]);
        let place = self.records[first..].as_flattened_mut();
        let mut read = 0;
        while read < place.len() {
            match file.read(&mut place[read..]) {
                Ok(0) => break,
                Ok(count) => read += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    self.records.truncate(first);
                    return Err(error);
                }
            }
        }
        self.records.truncate(first + read / RECORD);
        Ok((read / RECORD * RECORD) as u64)
    }

    /// Takes in the whole records at the start of `bytes`; returns their length.
    fn take(&mut self, bytes: &[u8], origin: u32) -> u64 {
        let records = bytes.as_chunks::<RECORD>().0;
        self.push(records, origin);
        (records.len() * RECORD) as u64
    }

    fn push(&mut self, records: &[[u8; RECORD]], origin: u32) {
        if self.made.last().is_none_or(|(_, last)| *last != origin) {
            self.made.push((self.records.len(), origin));
        }
        self.records.extend_from_slice(records);
    }

    /// Adds a record that this process has appended.
    pub(super) fn add(&mut self, record: &Record) {
        let known = self.origins.iter().position(|origin| *origin == record.origin);
        let origin = known.unwrap_or_else(|| {
            self.origins.push(record.origin.clone());
            self.origins.len() - 1
        }) as u32;
        self.push(&[pack(record)], origin);
    }

    /// The record of a task that counts.
    pub(super) fn find(&mut self, key: &Key) -> Option<Record> {
        self.by_key.update(&self.records, KEY);
        self.found(key)
    }

    fn found(&self, key: &Key) -> Option<Record> {
        let same = self.by_key.of(&key.0).filter_map(|number| self.record(number)).filter(|record| record.key == *key);
        same.reduce(later)
    }

    /// Records that count and whose result is `content`: a few, when many tasks came to it.
    pub(super) fn with_content(&mut self, content: &ContentHash) -> Vec<Record> {
        self.by_key.update(&self.records, KEY);
        self.by_content.update(&self.records, CONTENT);
        let mut found: Vec<Record> = Vec::new();
        for record in self.by_content.of(&content.0).filter_map(|number| self.record(number)) {
            let counts = |record: &Record| self.found(&record.key).is_some_and(|counts| counts.content == *content);
            if record.content == *content && !found.iter().any(|known| known.key == record.key) && counts(&record) {
                found.extend(self.found(&record.key));
            }
            if found.len() == MOST_ALIKE {
                break;
            }
        }
        found
    }

    /// All records that count, in the order of their keys.
    pub(super) fn records(&self) -> Vec<Record> {
        let mut records: Vec<Record> = (0..self.records.len()).filter_map(|number| self.record(number)).collect();
        records.sort_by(|a, b| a.key.cmp(&b.key).then_with(|| counting(b).cmp(&counting(a))));
        records.dedup_by_key(|record| record.key);
        records
    }

    /// Damaged and contradicting records.
    pub(super) fn faults(&self) -> Faults {
        let mut records: Vec<Record> = (0..self.records.len()).filter_map(|number| self.record(number)).collect();
        let damaged = self.records.len() - records.len();
        records.sort_by_key(|record| record.key);
        let differ = |pair: &&[Record]| pair[0].key == pair[1].key && pair[0].content != pair[1].content;
        let tell = |pair: &[Record]| (pair[0].key, pair[0].content, pair[1].content);
        Faults { damaged, contradictions: records.windows(2).filter(differ).map(tell).collect() }
    }

    /// Names of the segments read so far.
    pub(super) fn segments(&self) -> Vec<OsString> {
        self.seen.iter().cloned().collect()
    }

    /// The record of this number, unless it is damaged.
    fn record(&self, number: usize) -> Option<Record> {
        let made = self.made.partition_point(|(from, _)| *from <= number) - 1;
        unpack(&self.records[number], &self.origins[self.made[made].1 as usize])
    }
}

/// Of two records of one task the later one counts; of two at the same moment the same one everywhere.
fn later(a: Record, b: Record) -> Record {
    if counting(&b) > counting(&a) { b } else { a }
}

fn counting(record: &Record) -> (i64, ContentHash) {
    (record.started, record.content)
}

/// The segment of this process; the file is made with the first record, and locked for as long as the process lives.
#[derive(Default)]
pub(super) struct Segment {
    open: Option<Open>,
}

struct Open {
    held: Held,
    path: PathBuf,
    end: u64,
    /// Whether its head and its name would survive a power cut; a record that must survive one sees to it.
    safe: bool,
}

impl Segment {
    /// Appends one record.
    pub(super) fn append(&mut self, disk: &Disk, record: &Record, durable: bool) -> Result<(), StoreError> {
        let open = match &mut self.open {
            Some(open) => open,
            none => none.insert(create(disk, &record.origin)?),
        };
        let mut file = &open.held.0;
        file.seek(SeekFrom::Start(open.end))
            .and_then(|_| file.write_all(&pack(record)))
            .and_then(|()| if durable { file.sync_data() } else { Ok(()) })
            .map_err(|error| disk.fail("write", &open.path, error))?;
        open.end += RECORD as u64;
        if durable && !open.safe {
            disk.sync_dir(&folder(disk))?;
            open.safe = true;
        }
        Ok(())
    }

    /// The name of its file, when there is one.
    pub(super) fn name(&self) -> Option<&OsStr> {
        self.open.as_ref().and_then(|open| open.path.file_name())
    }
}

/// A new segment: locked and with its head before it has its name, so that no reader takes it for a finished one.
fn create(disk: &Disk, origin: &Origin) -> Result<Open, StoreError> {
    let folder = folder(disk);
    disk.make_dir(&folder)?;
    let fail = |error| disk.fail("create a file in", &folder, error);
    let mut file = disk.temporary_in(&folder, 0o644)?;
    let _ = file.as_file().try_lock();
    file.write_all(&head(origin)).map_err(fail)?;
    let name = file.path().file_name().unwrap_or_default().to_string_lossy().replacen(TEMPORARY, "", 1);
    let path = folder.join(format!("{:013}-{}-{name}.journal", super::now_ms(), std::process::id()));
    let file = file.persist_noclobber(&path).map_err(|error| fail(error.error))?;
    Ok(Open { held: Held(file), path, end: HEAD as u64, safe: false })
}

/// Writes a finished segment with these records, which have one origin.
pub(super) fn write_segment(disk: &Disk, records: &[Record]) -> Result<(), StoreError> {
    let Some(first) = records.first() else { return Ok(()) };
    let open = create(disk, &first.origin)?;
    let mut file = &open.held.0;
    let bytes: Vec<u8> = records.iter().flat_map(pack).collect();
    let written = file.write_all(&bytes).and_then(|()| file.sync_all());
    written.map_err(|error| disk.fail("write", &open.path, error))?;
    disk.sync_dir(&folder(disk))
}

/// The head of a segment: one line of text, padded.
fn head(origin: &Origin) -> Vec<u8> {
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
fn pack(record: &Record) -> [u8; RECORD] {
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

/// The record of these bytes, when its checksum is right.
fn unpack(bytes: &[u8; RECORD], origin: &Arc<Origin>) -> Option<Record> {
    if blake3::hash(&bytes[..120]).as_bytes()[..8] != bytes[120..] {
        return None;
    }
    let hash = |from: usize| {
        let mut hash = [0; 32];
        hash.copy_from_slice(&bytes[from..from + 32]);
        hash
    };
    Some(Record {
        key: Key(hash(KEY)),
        content: ContentHash(hash(CONTENT)),
        seal: Seal { digest: hash(64), size: word(bytes, 96) },
        started: word(bytes, 104) as i64,
        seconds: f64::from_bits(word(bytes, 112)),
        origin: origin.clone(),
    })
}

/// The eight bytes from `place` on, as a number.
fn word(bytes: &[u8], place: usize) -> u64 {
    bytes[place..].first_chunk().map_or(0, |word| u64::from_le_bytes(*word))
}
