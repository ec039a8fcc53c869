//! Advisory locks: who computes a task, who uses the store.
//!
//! A claim is a locked file `locks/<key>.lock` with the process and the machine of its holder inside. The kernel
//! releases the lock when the process ends, however it ends, so there is no stale lock and nothing to unlock by hand.
//! The holder removes the name before it lets go. Whoever gets the lock of a file that somebody left behind removes it
//! and begins anew, and whoever gets the lock of a file that is no longer the one in the folder tries again.
//!
//! The result is written into this very file, which then gets its name among the objects as a second link: a task
//! costs one new file and not two. (ext4 does not hand out an inode again that was freed within the last seconds, and
//! searches past all of these for each new file, so ten thousand lock files that come and go cost seconds.)
//!
//! Locks only save work: without them (some network file systems have none) two runs may compute the same task, and
//! the store keeps one of the two equal results.

use super::StoreError;
use super::disk::Disk;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The process that computes a task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Process id; 0 while it is not yet known.
    pub process: u32,
    /// Machine.
    pub machine: String,
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.process {
            0 => f.write_str("another flow process"),
            process => write!(f, "flow process {process} on {}", self.machine),
        }
    }
}

/// An open file that may be locked; dropped, it is unlocked. To close it would not do: a child that another thread has
/// forked and that has not yet begun its program holds the same open file, and with it the lock.
#[derive(Debug)]
pub(super) struct Held(pub(super) File);

impl Drop for Held {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// The right to compute a task; dropped, it is free again.
#[derive(Debug)]
pub struct Guard {
    pub(super) path: PathBuf,
    pub(super) held: Held,
}

impl Drop for Guard {
    fn drop(&mut self) {
        // While the lock is still held, so that nobody takes a file that is about to vanish.
        let _ = fs::remove_file(&self.path);
    }
}

/// A task that another process computes.
#[derive(Debug)]
pub struct Waiting {
    path: PathBuf,
    file: File,
    /// Who computes it.
    pub holder: Holder,
}

impl Waiting {
    /// Whether the other process has let go of the task, finished or dead. Claim it again to know.
    pub fn is_over(&self) -> bool {
        match self.file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => false,
            Ok(()) | Err(TryLockError::Error(_)) => {
                let _ = self.file.unlock();
                true
            }
        }
    }

    /// Waits until the other process lets go or `stop` says so; returns whether it let go.
    pub fn wait(&self, stop: impl Fn() -> bool) -> bool {
        let mut pause = Duration::from_millis(1);
        while !self.is_over() {
            if stop() {
                return false;
            }
            std::thread::sleep(pause);
            pause = (pause * 2).min(Duration::from_millis(50));
        }
        true
    }

    /// Who computes it now, read again.
    pub fn holder_now(&self) -> Holder {
        File::open(&self.path).map_or(self.holder.clone(), |mut file| read_holder(&mut file))
    }
}

pub(super) enum Taken {
    Mine(Guard),
    Theirs(Waiting),
}

/// Takes the lock called `name`, or says who has it.
pub(super) fn take(disk: &Disk, name: &str, machine: &str) -> Result<Taken, StoreError> {
    let folder = disk.root.join("locks");
    let path = folder.join(format!("{name}.lock"));
    loop {
        match OpenOptions::new().create_new(true).read(true).write(true).open(&path) {
            Ok(mut file) => {
                // An error: a file system without locks, see the module's head.
                let taken = !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
                if taken && is_same_file(&path, &file) {
                    let written = file.write_all(format!("{} {machine}\n", std::process::id()).as_bytes());
                    let guard = Guard { path, held: Held(file) };
                    written.map_err(|error| disk.fail("write the lock", &guard.path, error))?;
                    return Ok(Taken::Mine(guard));
                }
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                if let Some(waiting) = held(disk, &path)? {
                    return Ok(Taken::Theirs(waiting));
                }
            }
            Err(error) if error.kind() == ErrorKind::NotFound => disk.make_dir(&folder)?,
            Err(error) => return Err(disk.fail("make the lock", &path, error)),
        }
    }
}

/// Who holds an existing lock; nobody when it was left behind, and it is removed.
fn held(disk: &Disk, path: &Path) -> Result<Option<Waiting>, StoreError> {
    let open = OpenOptions::new().read(true).write(true).open(path).or_else(|_| File::open(path));
    let mut file = match open {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        other => other.map_err(|error| disk.fail("open the lock", path, error))?,
    };
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        let holder = read_holder(&mut file);
        return Ok(Some(Waiting { path: path.to_owned(), file, holder }));
    }
    let left_behind = Held(file);
    if is_same_file(path, &left_behind.0) {
        disk.remove(path)?;
    }
    Ok(None)
}

/// Says that this process uses the store, until the lock is dropped; nothing is removed from a store in use. A store
/// that cannot be written, or a file system without locks, gives none.
pub(super) fn share(disk: &Disk) -> Option<Held> {
    let path = disk.root.join("in-use.lock");
    let file = File::open(&path).or_else(|_| File::create_new(&path)).or_else(|_| File::open(&path)).ok()?;
    file.lock_shared().ok()?;
    Some(Held(file))
}

fn read_holder(file: &mut File) -> Holder {
    let mut text = String::new();
    let _ = file.take(256).read_to_string(&mut text);
    let (process, machine) = text.trim_end().split_once(' ').unwrap_or_default();
    Holder { process: process.parse().unwrap_or(0), machine: machine.to_owned() }
}

/// Whether `path` still names the open file.
#[cfg(unix)]
fn is_same_file(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(path), file.metadata()) {
        (Ok(named), Ok(open)) => named.ino() == open.ino() && named.dev() == open.dev(),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_same_file(path: &Path, _: &File) -> bool {
    path.exists()
}
