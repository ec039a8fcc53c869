//! Files beside the workflow, checked before anything runs: missing files, and files outside every key.

use super::Complaint;
use rustix::fs::OFlags;
use std::fs::{Metadata, OpenOptions};
use std::io::{ErrorKind, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// Largest file that a workflow may name, in bytes.
pub const LARGEST: u64 = 4 << 30;

/// The faults and warnings that were found.
#[derive(Debug, Default)]
pub struct Beside {
    folder: PathBuf,
    /// Files that cannot be read, or do not hold what their key asks for.
    pub faults: Vec<Complaint>,
    /// Warnings: what may make a result stale or a program fail.
    pub warnings: Vec<Complaint>,
    /// The columns of the file that is the stage's result, where it was read.
    pub columns: Option<Vec<String>>,
}

impl Beside {
    /// A check that looks for files from the folder of the workflow.
    pub fn of(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..Self::default() }
    }

    /// Checks that the file under `key` exists and is a plain file.
    pub fn file(&mut self, key: &str, path: &str) -> Option<PathBuf> {
        let full = self.folder.join(path);
        match plain(&full) {
            Ok(_) => return Some(full),
            Err(why) => {
                let complaint = Complaint::new(key, format!("{}: {why}", full.display()));
                self.faults.push(complaint.hint("paths are relative to the folder of the workflow"));
            }
        }
        None
    }

    /// The bytes of a file that is named under `key`, where it is small enough to be looked into before anything runs.
    pub fn bytes(&mut self, key: &str, path: &str) -> Option<Vec<u8>> {
        let full = self.file(key, path)?;
        let small = plain(&full).is_ok_and(|meta| meta.len() <= READ_BEFORE);
        if !small {
            return None;
        }
        let unread = |why: &String| Complaint::new(key, format!("{}: {why}", full.display()));
        read(&full).inspect_err(|why| self.faults.push(unread(why))).ok()
    }

    /// As [`Beside::file`], for a key that need not be set.
    pub fn optional(&mut self, key: &str, path: Option<&String>) {
        path.and_then(|path| self.file(key, path));
    }

    /// The plain file in this folder that a word of a command names, if there is one.
    pub fn named(&self, word: &str) -> Option<PathBuf> {
        let path = self.folder.join(word);
        (!word.is_empty() && plain(&path).is_ok()).then_some(path)
    }
}

/// Largest file that is read by the check before anything runs, bytes.
const READ_BEFORE: u64 = 4 << 20;

/// The bytes of a plain file.
///
/// A file of the system may call itself plain and empty, and have a reader wait for ever or read without end: it is opened so
/// that nothing waits, and read no further than [`LARGEST`].
///
/// # Errors
/// Why it cannot be read, in a few words.
pub fn read(path: &Path) -> Result<Vec<u8>, String> {
    plain(path)?;
    let fail = |e: std::io::Error| match e.kind() {
        ErrorKind::WouldBlock => "is no plain file: it has a reader wait".to_owned(),
        _ => format!("cannot be read: {e}"),
    };
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let file = OpenOptions::new().read(true).custom_flags(flags.bits() as i32).open(path).map_err(fail)?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(fail)?;
    match bytes.len() as u64 > LARGEST {
        true => Err(format!("has more than {LARGEST} bytes")),
        false => Ok(bytes),
    }
}

/// Metadata of a plain file that is not too large. A folder, a pipe and a device are refused before they are opened,
/// because opening a pipe waits for ever.
///
/// # Errors
/// Why it cannot be read, in a few words.
pub fn plain(path: &Path) -> Result<Metadata, String> {
    let meta = std::fs::metadata(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => format!("cannot be read: {e}"),
    })?;
    if meta.is_dir() {
        Err("is a folder, not a file".to_owned())
    } else if !meta.is_file() {
        Err("is no plain file but a pipe or a device".to_owned())
    } else if meta.len() > LARGEST {
        Err(format!("has {} bytes; at most {LARGEST} are read", meta.len()))
    } else {
        Ok(meta)
    }
}
