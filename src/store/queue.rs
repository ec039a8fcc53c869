//! Queues: tasks for the workers of a cluster, and the workers' reports.
//!
//! ```text
//! queue/ID/tasks-0001.jsonl   a list of tasks, sealed                      written once by the submitter
//! queue/ID/round-0001.json   which job was submitted, sealed               written once by the submitter
//! queue/ID/begun/000017       somebody has begun task 17                   made once, by whoever begins it
//! queue/ID/worker-….jsonl     the report of a worker, locked while it lives  appended to by that worker
//! queue/ID/closed             no more tasks are to be begun                 made once by the submitter
//! queue/ID/submitter.lock     locked by the process that looks after it
//! queue/ID/job-1.sh           what was submitted, for the user alone
//! queue/ID/log-….txt          what the workers print, written by the scheduler
//! ```
//!
//! **The right to begin a task** is a file that can be made only once; every shared file system guarantees that, also
//! one whose locks do not reach other nodes. The file stays, so a worker need not read the reports of others before it begins.
//!
//! **A list is sealed**: it begins with a keyed blake3 of itself under a secret that the submitter hands to its workers
//! inside the job script, and that the next submitter of the same user derives again. So another person who can write to the
//! store cannot make a worker run a program. Reports carry no results, so a forged one costs time only.

use super::disk::Disk;
use super::folder::{self, Folder, Strange};
use super::lock::Held;
use super::{Store, StoreError};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;

/// Folder of the queues.
pub(super) const FOLDER: &str = "queue";
const BEGUN: &str = "begun";
const CLOSED: &str = "closed";
const SUBMITTER: &str = "submitter.lock";
/// The largest list that is read.
const MOST_LIST: u64 = 1 << 32;
/// Bytes of a report that are read at once.
const MOST_NEWS: u64 = 1 << 22;
/// Room that a report reserves at the start, so that it can report a full disk, bytes.
const ROOM: u64 = 1 << 14;

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

    /// The queue of this name. `secret` is the one in the job script, for a worker that cannot read its submitter's state folder.
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

/// The lock of the process that looks after a queue.
pub struct LookedAfter(#[expect(dead_code, reason = "it is held, and let go when it is dropped")] Held);

impl Queue {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The secret for its workers, as hexadecimal digits.
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

    /// Writes list number `number`, which must be new.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn put_list(&self, number: usize, text: &str) -> Result<(), StoreError> {
        self.put(list_name(number), text)
    }

    /// Writes the note on submission number `number`, for the process that looks after the queue next.
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

    /// List number `number`; `None` when there is none yet, an error when its seal is not that of this queue.
    ///
    /// # Errors
    /// The store cannot be read, or the list was not written by the submitter.
    pub fn list(&self, number: usize) -> Result<Option<String>, StoreError> {
        self.sealed(list_name(number))
    }

    /// The note on submission number `number`; `None` when there is none.
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
            Some((seal, text)) if seal == self.seal(&name, text) => Ok(Some(text.to_owned())),
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

    /// Begins a task; false when it has been begun before.
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

    /// Closes the queue: no more tasks are to be begun.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn close(&self) -> Result<(), StoreError> {
        self.disk.write_new(&self.inside, CLOSED, b"", false).map(|_| ())
    }

    /// Whether the queue is closed or removed.
    pub fn is_closed(&self) -> bool {
        self.folder().is_ok_and(|folder| folder.entry(CLOSED).is_ok()) || !self.path().is_dir()
    }

    /// Takes the lock of the process that looks after the queue; `None` while another process holds it.
    pub fn look_after(&self) -> Option<LookedAfter> {
        let folder = self.folder().ok()?;
        let file = folder.open(SUBMITTER, true).or_else(|_| folder.create(SUBMITTER, 0o600)).ok()?;
        match file.try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => None,
            Ok(()) | Err(std::fs::TryLockError::Error(_)) => Some(LookedAfter(Held(file))),
        }
    }

    /// A new report, locked while this process lives.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn report(&self, name: &str) -> Result<ReportFile, StoreError> {
        let name = format!("worker-{name}.jsonl");
        let file = self.folder()?.create(&name, 0o644).map_err(|error| self.fail("create", &name, error))?;
        // Readers hold the lock for a moment only. It fails on a file system without locks.
        let _ = file.lock();
        // Some file systems cannot reserve room.
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

    /// The complete lines of a report from byte `from` on, their length in bytes, and whether its worker holds its lock.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn news(&self, report: &str, from: u64) -> Result<(String, u64, bool), StoreError> {
        let read = |file: &mut File| -> std::io::Result<(String, u64, bool)> {
            folder::ask_anew(&*file);
            // Asked before reading: a worker that has ended writes no more.
            let held = matches!(file.try_lock_shared(), Err(std::fs::TryLockError::WouldBlock));
            if !held {
                let _ = file.unlock();
            }
            file.seek(SeekFrom::Start(from))?;
            let mut bytes = Vec::new();
            file.take(MOST_NEWS).read_to_end(&mut bytes)?;
            let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
            bytes.truncate(whole);
            Ok((String::from_utf8_lossy(&bytes).into_owned(), whole as u64, held))
        };
        match self.folder()?.open(report, false).and_then(|mut file| read(&mut file)) {
            Err(error) if Strange::is(&error) => Ok((String::new(), 0, false)),
            other => other.map_err(|error| self.fail("read", report, error)),
        }
    }

    /// The last line that a job has printed, for the reader of an error.
    pub fn last_words(&self, log: &str) -> Option<String> {
        let text = self.folder().ok()?.read(log, MOST_NEWS).ok()?;
        let text = String::from_utf8_lossy(&text);
        text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(|line| line.chars().take(300).collect())
    }
}

fn list_name(number: usize) -> String {
    format!("tasks-{number:04}.jsonl")
}

fn round_name(number: usize) -> String {
    format!("round-{number:04}.json")
}

/// The report of a worker.
pub struct ReportFile {
    file: Held,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Mark;

    fn store(folder: &std::path::Path) -> Store {
        Store::open_as(&folder.join("store"), Mark::of(&[1; 32])).unwrap()
    }

    #[test]
    fn a_task_is_begun_once() {
        let folder = tempfile::tempdir().unwrap();
        let queue = store(folder.path()).make_queue("q-1").unwrap();
        assert!(queue.begin(3).unwrap());
        assert!(!queue.begin(3).unwrap());
        assert_eq!(queue.begun().unwrap(), [3]);
    }

    #[test]
    fn a_list_of_anybody_else_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let store = store(folder.path());
        let queue = store.make_queue("q-1").unwrap();
        assert_eq!(queue.list(1).unwrap(), None);
        queue.put_list(1, "a\nb\n").unwrap();
        assert_eq!(queue.list(1).unwrap().as_deref(), Some("a\nb\n"));
        assert!(queue.put_list(1, "c\n").is_err(), "a list is written once");
        let other = store.queue("q-1", Some([7; 32])).list(1).unwrap_err().to_string();
        assert!(other.contains("not the list that was submitted"), "{other}");
        // The list of one number does not stand in for that of another.
        std::fs::copy(queue.path().join("tasks-0001.jsonl"), queue.path().join("tasks-0002.jsonl")).unwrap();
        assert!(queue.list(2).is_err());
    }

    #[test]
    fn reports_are_read_line_by_line_and_tell_whether_their_worker_lives() {
        let folder = tempfile::tempdir().unwrap();
        let queue = store(folder.path()).make_queue("q-1").unwrap();
        let mut report = queue.report("a").unwrap();
        report.say("one").unwrap();
        let names = queue.reports().unwrap();
        assert_eq!(queue.news(&names[0], 0).unwrap(), ("one\n".to_owned(), 4, true));
        assert_eq!(queue.news(&names[0], 4).unwrap(), (String::new(), 0, true));
        folder::write(&report.file.0, b"torn").unwrap();
        drop(report);
        assert_eq!(queue.news(&names[0], 4).unwrap(), (String::new(), 0, false));
    }

    #[test]
    fn what_lies_in_a_queue_is_known_and_goes_with_gc() {
        let folder = tempfile::tempdir().unwrap();
        let store = store(folder.path());
        let queue = store.make_queue("q-1").unwrap();
        queue.put_list(1, "a\n").unwrap();
        queue.begin(0).unwrap();
        queue.put_script(1, "x").unwrap();
        queue.close().unwrap();
        drop(queue.report("w").unwrap());
        assert!(store.verify().unwrap().strangers.is_empty());
        std::fs::write(queue.path().join("mine.txt"), "x").unwrap();
        assert_eq!(store.verify().unwrap().strangers.len(), 1);
        store.sweep(&Default::default(), true).unwrap();
        assert!(queue.path().join("mine.txt").is_file());
        std::fs::remove_file(queue.path().join("mine.txt")).unwrap();
        store.sweep(&Default::default(), true).unwrap();
        assert!(!queue.path().exists() && queue.is_closed());
    }
}
