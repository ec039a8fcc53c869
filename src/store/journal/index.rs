//! The journals as read so far.

mod numbers;
mod records;

use super::record::{CONTENT, KEY, RECORD, from_version_1, pack, unpack};
use super::{FOLDER, HEAD, MOST, Segments, is_name, read_head, writer_of};
use crate::artifact::{ContentHash, Key};
use crate::store::disk::Disk;
use crate::store::folder::{self, Folder, Strange};
use crate::store::lock::is_alive;
use crate::store::mark::Mark;
use crate::store::{Origin, Record, StoreError};
use numbers::Numbers;
use records::Records;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// So many objects with one content are tried.
const MOST_ALIKE: usize = 8;
/// Longer than the step of any file system's times.
const TIME_STEP: Duration = Duration::from_secs(2);
/// Segments whose writers may be alive where locks do not reach are looked at as often.
const LOOK_EACH: Duration = Duration::from_millis(500);
/// A segment that has grown so lately is looked at each time.
const BUSY: Duration = Duration::from_secs(12);
/// Bytes of a segment that are read at once.
const BLOCK: usize = RECORD << 13;

/// The journals as read so far. Records stay as the bytes they are; each is checked when it is asked for.
pub(in crate::store) struct Index {
    mark: Mark,
    records: Records,
    /// The records from this number on have this origin.
    made: Vec<(usize, u32)>,
    origins: Vec<Arc<Origin>>,
    by_key: Numbers,
    by_content: Numbers,
    /// Segments read so far.
    segments: HashMap<String, Seen>,
    /// State of the folder at the last look, and since when it has been seen like that.
    looked: Option<([u64; 5], Instant)>,
    /// When segments of other machines were last looked at.
    far: Option<Instant>,
    /// This machine.
    machine: String,
}

/// How far a segment has been read.
#[derive(Clone, Copy)]
struct Seen {
    end: u64,
    origin: u32,
    version: u32,
    writer: Writer,
    /// When it was last seen to have grown.
    grew: Option<Instant>,
}

/// Who may still append to a segment.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writer {
    /// Nobody, or this process, whose records are added as they are made.
    Ended,
    /// It holds the lock, so it is alive.
    Near,
    /// Its lock is free, which says nothing where locks do not reach all nodes: its writer may be alive.
    Far,
}

impl Index {
    /// Nothing read yet; `machine` is this one.
    pub(in crate::store) fn new(mark: Mark, machine: &str) -> Self {
        Self {
            mark,
            records: Records::default(),
            made: Vec::new(),
            origins: Vec::new(),
            by_key: Numbers::default(),
            by_content: Numbers::default(),
            segments: HashMap::new(),
            looked: None,
            far: None,
            machine: machine.to_owned(),
        }
    }

    /// Reads what is new in all segments; `own` are the segments of this process, whose records are added as they are made.
    /// Folder and segments are opened anew each time, so that a network file system asks its server.
    pub(in crate::store) fn refresh(&mut self, disk: &Disk, own: &Segments) -> Result<(), StoreError> {
        let Some(folder) = disk.find_folder(FOLDER)? else { return Ok(()) };
        let far = self.far.is_none_or(|last| last.elapsed() > LOOK_EACH);
        if far {
            self.far = Some(Instant::now());
        }
        let looks = |seen: &Seen| match seen.writer {
            Writer::Near => true,
            Writer::Far => far || seen.grew.is_some_and(|when| when.elapsed() < BUSY),
            Writer::Ended => false,
        };
        let growing: Vec<String> =
            self.segments.iter().filter(|(_, seen)| looks(seen)).map(|(name, _)| name.clone()).collect();
        for name in growing.into_iter().chain(self.new_segments(disk, &folder)?) {
            match self.read_on(&folder, &name, own.has(&name)) {
                // A segment that gc has merged into another one in the meantime, or that nobody of flow has written.
                Err(error) if error.kind() == ErrorKind::NotFound || Strange::is(&error) => {}
                other => other.map_err(|error| disk.fail("read", &disk.path(FOLDER, &name), error))?,
            }
        }
        Ok(())
    }

    /// Names of segments that have not been read; the folder is listed only when it may have changed.
    fn new_segments(&mut self, disk: &Disk, folder: &Folder) -> Result<Vec<String>, StoreError> {
        let fail = |error| disk.fail("list", &disk.root.join(FOLDER), error);
        let stat = folder.stat().map_err(fail)?;
        let state = [stat.st_ino, stat.st_mtime as u64, stat.st_mtime_nsec, stat.st_ctime as u64, stat.st_ctime_nsec];
        // Times of files move in steps, so what has not been seen for a while may change again without showing it.
        let since = self.looked.filter(|(before, _)| *before == state).map(|(_, since)| since);
        if since.is_some_and(|since| since.elapsed() > TIME_STEP) {
            return Ok(Vec::new());
        }
        self.looked = Some((state, since.unwrap_or_else(Instant::now)));
        let mut names = Vec::new();
        let is_new = |name: &str| is_name(name) && !self.segments.contains_key(name);
        folder.list(|name, _| names.extend(is_new(name).then(|| name.to_owned()))).map_err(fail)?;
        names.sort_unstable();
        Ok(names)
    }

    /// Reads a segment from where it was left.
    fn read_on(&mut self, folder: &Folder, name: &str, own: bool) -> io::Result<()> {
        let mut file = folder.open(name, false)?;
        folder::ask_anew(&file);
        folder::bounded(&file, MOST)?;
        let known = self.segments.get(name).copied();
        let mut seen = match known {
            Some(seen) => seen,
            None => match self.begin(&mut file, name, own)? {
                Some(seen) => seen,
                // Its head is not there yet.
                None => return Ok(()),
            },
        };
        if file.metadata()?.len() >= seen.end + RECORD as u64 {
            file.seek(SeekFrom::Start(seen.end))?;
            seen.end += self.read_records(&mut file, &seen)?;
            seen.grew = known.map(|_| Instant::now());
        }
        self.segments.insert(name.to_owned(), seen);
        Ok(())
    }

    /// Reads the head of a new segment.
    fn begin(&mut self, file: &mut File, name: &str, own: bool) -> io::Result<Option<Seen>> {
        // Asked before reading: what a dead process has written is all there is.
        let alive = file.try_lock_shared().is_err();
        let mut head = [0; HEAD];
        match file.read_exact(&mut head) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
            other => other?,
        }
        let (version, origin) = read_head(&head);
        let writer = match () {
            () if own => Writer::Ended,
            () if alive => Writer::Near,
            () if origin.machine != self.machine || writer_of(name).is_some_and(is_alive) => Writer::Far,
            () => Writer::Ended,
        };
        self.origins.push(Arc::new(origin));
        Ok(Some(Seen { end: HEAD as u64, origin: (self.origins.len() - 1) as u32, version, writer, grew: None }))
    }

    /// Takes in the whole records that follow in a file; returns their length.
    fn read_records(&mut self, file: &mut File, seen: &Seen) -> io::Result<u64> {
        let first = self.records.len();
        let (mut rest, mut block) = (0, vec![0; BLOCK]);
        loop {
            let count = match file.read(&mut block[rest..]) {
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => {
                    self.records.truncate(first);
                    return Err(error);
                }
            };
            let filled = rest + count;
            let (whole, torn) = block[..filled].as_chunks::<RECORD>();
            match seen.version {
                1 => whole.iter().for_each(|record| self.records.extend(&[from_version_1(record)])),
                _ => self.records.extend(whole),
            }
            rest = torn.len();
            block.copy_within(filled - rest..filled, 0);
            if count == 0 {
                break;
            }
        }
        self.note_origin(first, seen.origin);
        Ok(((self.records.len() - first) * RECORD) as u64)
    }

    fn note_origin(&mut self, first: usize, origin: u32) {
        if first < self.records.len() && self.made.last().is_none_or(|(_, last)| *last != origin) {
            self.made.push((first, origin));
        }
    }

    /// Adds a record that this process has appended.
    pub(in crate::store) fn add(&mut self, record: &Record) {
        let known = self.origins.iter().position(|origin| *origin == record.origin);
        let origin = known.unwrap_or_else(|| {
            self.origins.push(record.origin.clone());
            self.origins.len() - 1
        }) as u32;
        let first = self.records.len();
        self.records.extend(&[pack(record)]);
        self.note_origin(first, origin);
    }

    /// The records of a task: of several with one content one, an own one when there is.
    pub(in crate::store) fn of_task(&mut self, key: &Key) -> Vec<Record> {
        self.by_key.update(&self.records, KEY);
        let records = self.by_key.of(&key.0).filter_map(|number| self.record(number));
        distinct(records.filter(|record| record.key == *key).collect())
    }

    /// Records whose result is `content`: a few, when many tasks came to it; own ones first.
    pub(in crate::store) fn with_content(&mut self, content: &ContentHash) -> Vec<Record> {
        self.by_content.update(&self.records, CONTENT);
        let records = self.by_content.of(&content.0).filter_map(|number| self.record(number));
        let alike = records.filter(|record| record.content == *content).take(16 * MOST_ALIKE);
        let mut found = distinct(alike.collect());
        found.sort_by_key(|record| !record.own);
        found.truncate(MOST_ALIKE);
        found
    }

    /// All records by key and content, of equal ones an own one when there is.
    pub(in crate::store) fn records(&self) -> Vec<Record> {
        distinct((0..self.records.len()).filter_map(|number| self.record(number)).collect())
    }

    /// All records that differ in anything but their time, as gc keeps them: other users' marks stay.
    pub(in crate::store) fn marked_records(&self) -> Vec<Record> {
        let mut records: Vec<Record> = (0..self.records.len()).filter_map(|number| self.record(number)).collect();
        records.sort_by(|a, b| (&a.origin, a.object(), a.mark).cmp(&(&b.origin, b.object(), b.mark)));
        records.dedup_by(|a, b| a.object() == b.object() && a.mark == b.mark);
        records
    }

    /// Records that are skipped because their checksum is wrong.
    pub(in crate::store) fn damaged(&self) -> usize {
        (0..self.records.len()).filter(|&number| self.record(number).is_none()).count()
    }

    /// Names of the segments read so far.
    pub(in crate::store) fn segments(&self) -> Vec<String> {
        self.segments.keys().cloned().collect()
    }

    /// The record of this number, unless it is damaged.
    fn record(&self, number: usize) -> Option<Record> {
        let made = self.made.partition_point(|(from, _)| *from <= number) - 1;
        unpack(&self.mark, self.records.get(number), &self.origins[self.made[made].1 as usize])
    }
}

/// One record of each task and content, an own one when there is, in their order.
fn distinct(mut records: Vec<Record>) -> Vec<Record> {
    records.sort_by_key(|record| (record.key, record.content, !record.own));
    records.dedup_by_key(|record| (record.key, record.content));
    records
}
