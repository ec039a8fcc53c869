//! Tasks on their way to the workers of a cluster, and what those report.
//!
//! ```text
//! queue/ID/tasks-0001.jsonl   a list of tasks, sealed                      written once by the submitter
//! queue/ID/round-0001.json   which job was submitted, sealed               written once by the submitter
//! queue/ID/begun/000017       somebody has begun task 17                   made once, by whoever begins it
//! queue/ID/worker-….jsonl     what a worker reports, locked while it lives  appended to by that worker
//! queue/ID/closed             nothing more is to be begun                  made once by the submitter
//! queue/ID/submitter.lock     locked by the process that looks after it
//! queue/ID/job-1.sh           what was submitted, for the user alone
//! queue/ID/log-….txt          what the workers print, written by the scheduler
//! ```
//!
//! **The right to begin a task** is a file that can be made only once, which every shared file system sees to, also
//! one whose locks do not reach other nodes. It stays, so nobody needs to read what others have done before beginning.
//!
//! **A list is sealed**: it begins with a keyed blake3 of itself under a secret that the submitter hands to its workers
//! inside the job script, and that the next submitter of the same user derives again. Whoever else can write to a shared
//! store cannot make a worker run a program. Reports carry no results, so a forged one costs time only.

mod report;

pub use report::{MOST_NEWS, ReportFile};

use super::disk::Disk;
use super::folder::{self, Folder};
use super::lock::Held;
use super::mark;
use super::{Store, StoreError};
use std::io::ErrorKind;
use std::path::PathBuf;

/// Folder of the queues.
pub(super) const FOLDER: &str = "queue";
const BEGUN: &str = "begun";
const CLOSED: &str = "closed";
const SUBMITTER: &str = "submitter.lock";
/// The largest list that is read.
const MOST_LIST: u64 = 1 << 32;

/// Whether flow makes a folder of this name in this folder of a store.
pub(super) fn is_folder(folder: &str, name: &str) -> bool {
    match folder.strip_prefix(FOLDER) {
        Some("") => is_name(name),
        Some(inside) => inside.strip_prefix('/').is_some_and(is_name) && name == BEGUN,
        None => false,
    }
}

/// Whether a file of this name in a folder of queues is one that flow, or a scheduler for it, writes.
pub(super) fn is_ours(inside: &str, name: &str) -> bool {
    match inside.split_once('/') {
        Some((queue, BEGUN)) => is_name(queue) && name.bytes().all(|byte| byte.is_ascii_digit()),
        Some(_) => false,
        None => {
            let kinds =
                [("tasks-", ".jsonl"), ("round-", ".json"), ("worker-", ".jsonl"), ("job-", ".sh"), ("log-", ".txt")];
            let like = |(start, end): &(&str, &str)| name.starts_with(start) && name.ends_with(end);
            is_name(inside) && (name == CLOSED || name == SUBMITTER || kinds.iter().any(like))
        }
    }
}

fn is_name(name: &str) -> bool {
    !name.is_empty() && name.len() < 80 && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-')
}

impl Store {
    /// Makes a queue.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn make_queue(&self, name: &str) -> Result<Queue, StoreError> {
        let inside = format!("{FOLDER}/{name}");
        self.disk.make_folder(&format!("{inside}/{BEGUN}"))?;
        Ok(Queue { disk: self.disk.clone(), inside, name: name.to_owned(), secret: self.mark.queue(name) })
    }

    /// The queue of this name; `secret` is what its submitter handed over, for another user's state folder or none.
    pub fn queue(&self, name: &str, secret: Option<[u8; 32]>) -> Queue {
        let secret = secret.unwrap_or_else(|| self.mark.queue(name));
        Queue { disk: self.disk.clone(), inside: format!("{FOLDER}/{name}"), name: name.to_owned(), secret }
    }

    /// Names of the queues, the oldest first.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn queues(&self) -> Result<Vec<String>, StoreError> {
        let Some(folder) = self.disk.find_folder(FOLDER)? else { return Ok(Vec::new()) };
        let mut names = Vec::new();
        let listed = folder.list(|name, inner| names.extend((inner && is_name(name)).then(|| name.to_owned())));
        listed.map_err(|error| self.disk.fail("list", &self.disk.root.join(FOLDER), error))?;
        names.sort_unstable();
        Ok(names)
    }

    /// Removes the folders of queues whose files are gone.
    pub(super) fn remove_empty_queues(&self) {
        let (Ok(Some(folder)), Ok(names)) = (self.disk.find_folder(FOLDER), self.queues()) else { return };
        for name in names {
            // What is not empty stays.
            let _ = folder.inner(&name).and_then(|queue| queue.remove_empty(BEGUN));
            let _ = folder.remove_empty(&name);
        }
    }
}

/// A queue of tasks in the store.
#[derive(Clone)]
pub struct Queue {
    disk: Disk,
    inside: String,
    name: String,
    secret: [u8; 32],
}

/// A lock that says that somebody looks after a queue.
pub struct LookedAfter(#[expect(dead_code, reason = "it is held, and let go when it is dropped")] Held);

impl Queue {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What its workers are handed, as hexadecimal digits.
    pub fn secret(&self) -> String {
        blake3::Hash::from_bytes(self.secret).to_hex().to_string()
    }

    /// Its folder.
    pub fn path(&self) -> PathBuf {
        let path = self.disk.root.join(&self.inside);
        std::path::absolute(&path).unwrap_or(path)
    }

    fn fail(&self, doing: &'static str, name: &str, error: std::io::Error) -> StoreError {
        self.disk.fail(doing, &self.disk.path(&self.inside, name), error)
    }

    fn folder(&self) -> Result<Folder, StoreError> {
        self.disk.folder(&self.inside).map_err(|error| self.fail("open the folder", "", error))
    }

    /// Writes list number `number`, which nobody has written before.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn put_list(&self, number: usize, text: &str) -> Result<(), StoreError> {
        self.put(list_name(number), text)
    }

    /// Notes submission number `number`, for whoever looks after the queue next.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn put_round(&self, number: usize, text: &str) -> Result<(), StoreError> {
        self.put(round_name(number), text)
    }

    fn put(&self, name: String, text: &str) -> Result<(), StoreError> {
        let sealed = format!("{}\n{text}", self.seal(&name, text));
        match self.disk.write_new(&self.inside, &name, sealed.as_bytes(), true)? {
            true => Ok(()),
            false => Err(self.fail("write", &name, ErrorKind::AlreadyExists.into())),
        }
    }

    /// List number `number`; none when there is none yet, an error when its seal is not that of this queue.
    ///
    /// # Errors
    /// The store cannot be read, or the list was not written by the submitter.
    pub fn list(&self, number: usize) -> Result<Option<String>, StoreError> {
        self.sealed(list_name(number))
    }

    /// The error that a list which was there is not, or has lost a line.
    pub fn lacks(&self, number: usize) -> StoreError {
        self.fail("read", &list_name(number), ErrorKind::NotFound.into())
    }

    /// The note on submission number `number`; none when there is none.
    ///
    /// # Errors
    /// As [`Queue::list`].
    pub fn round(&self, number: usize) -> Result<Option<String>, StoreError> {
        self.sealed(round_name(number))
    }

    fn sealed(&self, name: String) -> Result<Option<String>, StoreError> {
        let bytes = match self.folder()?.read(&name, MOST_LIST) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| self.fail("read", &name, error))?,
        };
        let text = String::from_utf8(bytes).unwrap_or_default();
        match text.split_once('\n') {
            Some((seal, text)) if mark::same(seal.as_bytes(), self.seal(&name, text).as_bytes()) => {
                Ok(Some(text.to_owned()))
            }
            _ => Err(StoreError::Strange {
                doing: "read",
                path: self.disk.path(&self.inside, &name),
                why: "it is not the list that was submitted; nothing in it is run".to_owned(),
            }),
        }
    }

    fn seal(&self, name: &str, text: &str) -> String {
        let mut hash = blake3::Hasher::new_keyed(&self.secret);
        hash.update(name.as_bytes()).update(b"\n").update(text.as_bytes());
        hash.finalize().to_hex().to_string()
    }

    /// Writes a job script that the user alone can read.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn put_script(&self, number: usize, text: &str) -> Result<PathBuf, StoreError> {
        let name = format!("job-{number}.sh");
        let folder = self.folder()?;
        let _ = folder.remove(&name);
        let made = folder.create(&name, 0o600).and_then(|file| folder::write(&file, text.as_bytes()));
        made.map_err(|error| self.fail("write", &name, error))?;
        Ok(self.path().join(name))
    }

    /// Begins a task, once and for all; whether nobody has begun it before.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn begin(&self, task: usize) -> Result<bool, StoreError> {
        let folder = self.begun_folder()?;
        match folder.create(&format!("{task:06}"), 0o644) {
            Ok(_) => Ok(true),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(self.fail("begin a task in", BEGUN, error)),
        }
    }

    fn begun_folder(&self) -> Result<Folder, StoreError> {
        let folder = self.disk.folder(&format!("{}/{BEGUN}", self.inside));
        folder.map_err(|error| self.fail("open the folder", BEGUN, error))
    }

    /// The tasks that have been begun.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn begun(&self) -> Result<Vec<usize>, StoreError> {
        let mut begun = Vec::new();
        let listed = self.begun_folder()?.list(|name, _| begun.extend(name.parse::<usize>()));
        listed.map_err(|error| self.fail("list", BEGUN, error))?;
        Ok(begun)
    }

    /// Says that nothing more is to be begun.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn close(&self) -> Result<(), StoreError> {
        self.disk.write_new(&self.inside, CLOSED, b"", false).map(|_| ())
    }

    /// Whether nothing more is to be begun; also when the queue is gone.
    pub fn is_closed(&self) -> bool {
        self.folder().is_ok_and(|folder| folder.entry(CLOSED).is_ok()) || !self.path().is_dir()
    }

    /// Looks after the queue, unless another process of the same node, or of all nodes where locks reach those, does.
    pub fn look_after(&self) -> Option<LookedAfter> {
        let folder = self.folder().ok()?;
        let file = folder.open(SUBMITTER, true).or_else(|_| folder.create(SUBMITTER, 0o600)).ok()?;
        match file.try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => None,
            Ok(()) | Err(std::fs::TryLockError::Error(_)) => Some(LookedAfter(Held(file))),
        }
    }
}

fn list_name(number: usize) -> String {
    format!("tasks-{number:04}.jsonl")
}

fn round_name(number: usize) -> String {
    format!("round-{number:04}.json")
}

#[cfg(test)]
mod tests;
