//! What workers report: a file of lines each, locked while its worker lives.

use super::super::disk::Disk;
use super::super::folder::{self, Strange};
use super::super::lock::Held;
use super::Queue;
use crate::store::StoreError;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;

/// Bytes of a report that are read at once. A longer line is damage: workers write none.
pub const MOST_NEWS: u64 = 1 << 20;
/// The longest output of a job that is read for its last line, bytes.
const MOST_LOG: u64 = 1 << 22;
/// Room that a report has from the start, so that it can say that the disk is full.
const ROOM: u64 = 1 << 14;

/// The report of a worker.
pub struct ReportFile {
    pub(super) file: Held,
    path: PathBuf,
    disk: Arc<Disk>,
}

impl ReportFile {
    /// Appends one line.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn say(&mut self, line: &str) -> Result<(), StoreError> {
        let written = folder::write(&self.file.0, format!("{line}\n").as_bytes());
        written.map_err(|error| self.disk.fail("write", &self.path, error))
    }
}

impl Queue {
    /// A new report, locked while this process lives.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn report(&self, name: &str) -> Result<ReportFile, StoreError> {
        let name = format!("worker-{name}.jsonl");
        let file = self.folder()?.create(&name, 0o644).map_err(|error| self.fail("create", &name, error))?;
        // Readers hold it for a moment only. An error: a file system without locks.
        let _ = file.lock();
        // A file system that cannot sets nothing aside.
        let _ = rustix::fs::fallocate(&file, rustix::fs::FallocateFlags::KEEP_SIZE, 0, ROOM);
        Ok(ReportFile {
            file: Held(file),
            path: self.disk.path(&self.inside, &name),
            disk: Arc::new(self.disk.clone()),
        })
    }

    /// Names of the workers' reports.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn reports(&self) -> Result<Vec<String>, StoreError> {
        let mut names = Vec::new();
        let is_report = |name: &str| name.starts_with("worker-") && name.ends_with(".jsonl");
        let listed = self.folder()?.list(|name, _| names.extend(is_report(name).then(|| name.to_owned())));
        listed.map_err(|error| self.fail("list", "", error))?;
        names.sort_unstable();
        Ok(names)
    }

    /// The whole lines that a report has from byte `from` on, their length, and whether its worker holds its lock. Bytes
    /// that are too many for a line are taken for lines, so that what follows them is read.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn news(&self, report: &str, from: u64) -> Result<(String, u64, bool), StoreError> {
        let read = |file: &mut File| -> std::io::Result<(String, u64, bool)> {
            folder::ask_anew(&*file);
            // Asked before reading: what a dead worker has written is all there is.
            let held = matches!(file.try_lock_shared(), Err(std::fs::TryLockError::WouldBlock));
            if !held {
                let _ = file.unlock();
            }
            file.seek(SeekFrom::Start(from))?;
            let mut bytes = Vec::new();
            file.take(MOST_NEWS).read_to_end(&mut bytes)?;
            let none = if bytes.len() as u64 == MOST_NEWS { bytes.len() } else { 0 };
            let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(none, |last| last + 1);
            bytes.truncate(whole);
            Ok((String::from_utf8_lossy(&bytes).into_owned(), whole as u64, held))
        };
        match self.folder()?.open(report, false).and_then(|mut file| read(&mut file)) {
            Err(error) if Strange::is(&error) => Ok((String::new(), 0, false)),
            other => other.map_err(|error| self.fail("read", report, error)),
        }
    }

    /// The last line of what a job has printed, for the reader of an error.
    pub fn last_words(&self, log: &str) -> Option<String> {
        let text = self.folder().ok()?.read(log, MOST_LOG).ok()?;
        let text = String::from_utf8_lossy(&text);
        text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(|line| line.chars().take(300).collect())
    }
}
