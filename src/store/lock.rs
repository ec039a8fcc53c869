//! Advisory locks: who computes a task, who uses the store.
//!
//! A claim is a locked file `locks/<key>.lock` with the process and the machine of its holder inside. The kernel
//! releases the lock when the process ends, however it ends, so there is no stale lock and nothing to unlock by hand.
//! The holder removes the file before it releases the lock. A process that gets the lock of an abandoned file removes the
//! file and tries again, as does one that gets the lock of a file that is no longer the one in the folder.
//!
//! The result is written into this very file, which then gets its name among the objects as a second link: a task
//! costs one new file and not two. (ext4 does not reuse an inode that was freed within the last seconds, and
//! searches past all of these for each new file, so ten thousand lock files that come and go cost seconds.)
//!
//! **Locks that do not reach all nodes** (on some network file systems a lock holds on one node only) make a file look
//! abandoned whose holder is at work. So a file whose lock is free counts as held while its holder may be alive: a process
//! of this machine that exists, or one of another machine. Other processes take other tasks meanwhile. After [`PATIENCE`] by
//! their own clock, in which a result would have become visible, the file counts as abandoned.
//!
//! Locks only save work. Without them two runs may compute the same task, and each may find that the other took its file
//! for an abandoned one and removed it: it then writes its result anew, and the store holds one of the two equal results.

use super::disk::Disk;
use super::folder::{Folder, Strange};
use super::object::is_hex;
use super::{StoreError, object};
use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// Longer than network file systems show old names, and longer than most short tasks take.
const PATIENCE: Duration = Duration::from_secs(12);
/// A claim's file of this size or more already holds a result, and its lock is about to be released.
const WRITING: Duration = Duration::from_secs(1);

/// Folder of the claims.
pub(super) const FOLDER: &str = "locks";
/// The file on which every process with an open store holds a shared lock.
pub(super) const IN_USE: &str = "in-use.lock";

/// The process that computes a task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Process id; 0 while it is not yet known.
    pub process: u32,
    /// Machine.
    pub machine: String,
    /// Whether that is this machine.
    here: bool,
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.process {
            0 => f.write_str("another flow process"),
            process => write!(f, "flow process {process} on {}", self.machine),
        }
    }
}

/// An open file that may be locked; dropping it unlocks it. Closing it is not enough: a child that another thread has forked
/// and that has not yet started its program shares the open file, and with it the lock.
#[derive(Debug)]
pub(super) struct Held(pub(super) File);

impl Drop for Held {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// The right to compute a task; dropping it releases the task.
#[derive(Debug)]
pub struct Guard(Option<Claimed>);

#[derive(Debug)]
struct Claimed {
    folder: Folder,
    name: String,
    held: Held,
}

impl Guard {
    /// The claim's file, to write the result into: its folder, its name, the file. `None` where there is no such file.
    pub(super) fn draft(&mut self) -> Option<(&Folder, &str, &mut File)> {
        let Claimed { folder, name, held } = self.0.as_mut()?;
        Some((folder, name, &mut held.0))
    }
}

impl Drop for Claimed {
    fn drop(&mut self) {
        // While the lock is still held, so that no process claims a file that is about to be removed. Where locks do not
        // reach all nodes, another node may have taken the name meanwhile, and its file stays.
        if self.folder.names(&self.name, &self.held.0) {
            let _ = self.folder.remove(&self.name);
        }
    }
}

/// A task that another process computes.
#[derive(Debug)]
pub struct Waiting {
    folder: Folder,
    name: String,
    file: File,
    /// Since when its lock is known to be free although its holder may be alive.
    unsure: Option<(Instant, Duration)>,
    /// Who computes it.
    pub holder: Holder,
}

impl Waiting {
    /// Whether the other process has released the task, because it finished it or ended. Claim the task again to find out.
    pub fn is_over(&self) -> bool {
        if let Some((since, patience)) = self.unsure {
            let gone = !self.folder.names(&self.name, &self.file);
            let over = gone || since.elapsed() > patience || is_dead(&self.holder);
            if over && !gone {
                let _ = self.folder.remove(&self.name);
            }
            return over;
        }
        match self.file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => false,
            Ok(()) | Err(TryLockError::Error(_)) => {
                let _ = self.file.unlock();
                true
            }
        }
    }

    /// Waits until the other process releases the task (true) or `stop` returns true (false).
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
}

pub(super) enum Taken {
    Mine(Guard),
    Theirs(Waiting),
}

/// Takes the lock of the task `key`, or returns its holder.
pub(super) fn take(disk: &Disk, key: &str, machine: &str) -> Result<Taken, StoreError> {
    let name = format!("{key}.lock");
    let path = disk.path(FOLDER, &name);
    if disk.read_only {
        // What is computed stays in this process.
        return Ok(Taken::Mine(Guard(None)));
    }
    let folder = disk.make_folder(FOLDER)?;
    loop {
        match folder.create(&name, 0o666) {
            Ok(mut file) => {
                // An error: a file system without locks, see the module's head.
                let taken = !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
                if taken && folder.names(&name, &file) {
                    let written = file.write_all(format!("{} {machine}\n", std::process::id()).as_bytes());
                    let claimed = Claimed { folder, name, held: Held(file) };
                    written.map_err(|error| disk.fail("write the lock", &path, error))?;
                    return Ok(Taken::Mine(Guard(Some(claimed))));
                }
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => match held(&folder, &name, machine) {
                Ok(Some((file, unsure, holder))) => {
                    return Ok(Taken::Theirs(Waiting { folder, name, file, unsure, holder }));
                }
                Ok(None) => {}
                // Where files are known by their names alone, one that was removed meanwhile has no state any more.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                // A link or a pipe of that name says nothing about the task: compute it without a lock.
                Err(error) if Strange::is(&error) => return Ok(Taken::Mine(Guard(None))),
                Err(error) => return Err(disk.fail("open the lock", &path, error)),
            },
            Err(error) => return Err(disk.fail("make the lock", &path, error)),
        }
    }
}

/// A lock that may be held: its file, since when that is uncertain, and its holder.
type Found = (File, Option<(Instant, Duration)>, Holder);

/// The holder of an existing lock; `None` when the file was abandoned, and it is removed.
fn held(folder: &Folder, name: &str, machine: &str) -> std::io::Result<Option<Found>> {
    let mut file = match folder.open(name, true).or_else(|_| folder.open(name, false)) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        other => other?,
    };
    let free = !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
    let mut holder = read_holder(&mut file, machine);
    for _ in 0..5 {
        // Its maker may be about to write who it is.
        if !free || holder.process != 0 || file.metadata()?.len() > 0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
        holder = read_holder(&mut file, machine);
    }
    if !free {
        return Ok(Some((file, None, holder)));
    }
    let patience = match holder.process {
        0 if folder.begins_with(name, object::HEAD) => Some(WRITING),
        _ => may_live(&holder).then_some(PATIENCE),
    };
    if let Some(patience) = patience.filter(|_| folder.names(name, &file)) {
        file.unlock()?;
        return Ok(Some((file, Some((Instant::now(), patience)), holder)));
    }
    let left_behind = Held(file);
    if folder.names(name, &left_behind.0) {
        folder.remove(name)?;
    }
    Ok(None)
}

/// Whether the holder of a file whose lock is free may be at work on a node that the lock does not reach.
fn may_live(holder: &Holder) -> bool {
    match holder.process {
        // Not yet written, or overwritten by the result.
        0 => false,
        process if holder.here => is_alive(process),
        _ => true,
    }
}

/// Whether the holder is known to have ended.
fn is_dead(holder: &Holder) -> bool {
    holder.process != 0 && !may_live(holder)
}

/// Whether another process of this machine has this process id.
pub(super) fn is_alive(process: u32) -> bool {
    let pid = i32::try_from(process).ok().and_then(rustix::process::Pid::from_raw);
    let there = |pid| !matches!(rustix::process::test_kill_process(pid), Err(rustix::io::Errno::SRCH));
    process != std::process::id() && pid.is_some_and(there)
}

/// Whether a name in the folder of locks is one of a claim.
pub(super) fn is_name(name: &str) -> bool {
    name.strip_suffix(".lock").is_some_and(|key| key.len() == 64 && is_hex(key))
}

/// Marks the store as in use until the lock is dropped; nothing is removed from a store in use. `None` where the store
/// cannot be written or the file system has no locks.
pub(super) fn share(disk: &Disk) -> Option<Held> {
    let root = disk.folder("").ok()?;
    // Open for writing: some file systems give the lock that gc needs for such files only.
    let open = || root.open(IN_USE, true).or_else(|_| root.create(IN_USE, 0o666)).or_else(|_| root.open(IN_USE, true));
    let written = if disk.read_only { Err(ErrorKind::PermissionDenied.into()) } else { open() };
    let file = written.or_else(|_| root.open(IN_USE, false)).ok()?;
    file.lock_shared().ok()?;
    Some(Held(file))
}

fn read_holder(file: &mut File, here: &str) -> Holder {
    let mut text = Vec::new();
    let _ = file.take(256).read_to_end(&mut text);
    let text = String::from_utf8_lossy(&text);
    let (process, machine) = text.lines().next().and_then(|line| line.split_once(' ')).unwrap_or_default();
    // The file may hold half of a result by now.
    let machine: String = machine.chars().filter(|c| c.is_ascii_graphic()).take(100).collect();
    Holder { process: process.parse().unwrap_or(0), here: machine == here, machine }
}
