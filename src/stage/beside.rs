//! Files beside the workflow, checked before anything runs: missing files, and files outside every key.

use super::Complaint;
use std::fs::Metadata;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Largest file that a workflow may name, in bytes.
pub const LARGEST: u64 = 4 << 30;

/// What was found.
#[derive(Debug, Default)]
pub struct Beside {
    folder: PathBuf,
    /// Files that cannot be read, or not as what they are named for.
    pub faults: Vec<Complaint>,
    /// What makes a result stale, or a program fail, without being a fault for certain.
    pub warnings: Vec<Complaint>,
}

impl Beside {
    /// Looks from the folder of the workflow.
    pub fn of(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..Self::default() }
    }

    /// A file that is named under `key` must be there, and be a plain file.
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

    /// The bytes of a file that is named under `key`, where it is small enough to be looked into before anything runs. One
    /// that cannot be read now is reported when the stage runs.
    pub fn bytes(&mut self, key: &str, path: &str) -> Option<Vec<u8>> {
        let full = self.file(key, path)?;
        let small = plain(&full).is_ok_and(|meta| meta.len() <= READ_BEFORE);
        small.then(|| std::fs::read(full).ok()).flatten()
    }

    /// A file that may be named under `key`.
    pub fn optional(&mut self, key: &str, path: Option<&String>) {
        path.and_then(|path| self.file(key, path));
    }

    /// The plain file that a word of a command names from this folder, if it does.
    pub fn named(&self, word: &str) -> Option<PathBuf> {
        let path = self.folder.join(word);
        (!word.is_empty() && plain(&path).is_ok()).then_some(path)
    }
}

/// Largest file that is looked into before anything runs, in bytes.
const READ_BEFORE: u64 = 4 << 20;

/// Metadata of a plain file that is not too large; everything else (a folder, a pipe, a device) is refused before it
/// is opened, because opening a pipe waits for ever.
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
