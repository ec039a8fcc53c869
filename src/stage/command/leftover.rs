//! Leftovers of programs: processes that outlive their run, and folders of campaigns that were killed.
//!
//! A program may start others that leave its process group (`setsid`), and a campaign that is killed (`kill -9`, no memory)
//! ends nothing itself. So every run is registered before its program starts, in a folder that only this user can enter
//! and that is the same for every `TMPDIR`; and its processes are recognised by a variable of their environment,
//! [`VARIABLE`], by their working folder, or by the mark of their campaign (`lineage.rs`). The next campaign on this machine,
//! and `flow store gc`, find the runs whose campaign has ended, end their processes and remove their folders. While a campaign
//! lives, orphans become its children. A process of another user (`sudo`) is not found, nor what a program has another one
//! start that is none of its own (`at`, `systemd-run`, a container's daemon).

use super::lineage::{is_marked, mark_of, mark_own};
use rustix::process::{Pid, Signal, WaitOptions, getpgrp, getpid, getuid, kill_process, set_child_subreaper, waitpid};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, DirBuilder};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::time::Duration;

/// The variable with the folder of the run, by which its processes are recognised.
pub(super) const VARIABLE: &str = "FLOW_RUN_FOLDER";

/// Prefix of the folders of runs.
pub(super) const PREFIX: &str = "flow-run-";

/// Largest record that is read.
const LARGEST: u64 = 1 << 14;

/// The record of a run; it is removed with the run.
pub(super) struct Record(Option<PathBuf>);

impl Record {
    /// Registers a run. A run that cannot be registered continues, but is not found after a kill.
    pub(super) fn of(folder: &Path) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let write = || {
            let name = format!("{}-{}", std::process::id(), NUMBER.fetch_add(1, Ordering::Relaxed));
            let path = registry(true)?.join(name);
            let mut file = fs::File::create_new(&path).ok()?;
            let text = [machine()?.as_bytes(), b"\n", owner(std::process::id())?.as_bytes(), b"\n"].concat();
            file.write_all(&[&text, folder.as_os_str().as_bytes()].concat()).ok()?;
            Some(path)
        };
        Self(write())
    }
}

impl Drop for Record {
    fn drop(&mut self) {
        self.0.iter().for_each(|path| drop(fs::remove_file(path)));
    }
}

/// Ends the processes of runs whose campaign has ended and removes their folders; returns a line on each.
pub fn sweep() -> Vec<String> {
    all_abandoned().into_iter().map(Abandoned::clear).collect()
}

/// How many runs [`sweep`] would clear.
pub fn count() -> usize {
    all_abandoned().len()
}

fn all_abandoned() -> Vec<Abandoned> {
    let Some(records) = registry(false).and_then(|folder| fs::read_dir(folder).ok()) else { return Vec::new() };
    records.flatten().filter_map(|entry| abandoned(&entry.path())).collect()
}

/// Ends the programs of this campaign before it ends itself, and removes their folders.
pub fn end_own() {
    let Some(records) = registry(false).and_then(|folder| fs::read_dir(folder).ok()) else { return };
    let own = format!("{}-", std::process::id());
    let is_own = |entry: &fs::DirEntry| entry.file_name().as_bytes().starts_with(own.as_bytes());
    for entry in records.flatten().filter(is_own) {
        // A record of this number that is older than this process is that of another one.
        if let Some((folder, _)) = read(&entry.path()).filter(|(_, by)| owner(std::process::id()).as_ref() == Some(by))
        {
            Abandoned { record: entry.path(), folder, mark: None }.clear();
        }
    }
    running().clear();
    for pid in orphans() {
        let _ = kill_process(pid, Signal::KILL);
    }
}

/// A run whose campaign has ended.
struct Abandoned {
    record: PathBuf,
    folder: PathBuf,
    /// The mark of its campaign, which no living process of another one has.
    mark: Option<u64>,
}

impl Abandoned {
    fn clear(self) -> String {
        let ended = end(|| [strays(&self.folder, self.mark), orphans()].concat());
        let own = |meta: &fs::Metadata| meta.is_dir() && meta.uid() == getuid().as_raw();
        let there = fs::symlink_metadata(&self.folder).is_ok_and(|meta| own(&meta));
        let removed = there && fs::remove_dir_all(&self.folder).is_ok();
        if removed || !there {
            let _ = fs::remove_file(&self.record);
        }
        let processes = match ended {
            0 => String::new(),
            1 => "a process of a program, which was ended; ".to_owned(),
            many => format!("{many} processes of a program, which were ended; "),
        };
        let folder = match (there, removed) {
            (false, _) => "the record of a program, whose folder is gone".to_owned(),
            (true, true) => format!("the folder {} of a program, which was removed", self.folder.display()),
            (true, false) => format!("the folder {} of a program, which cannot be removed", self.folder.display()),
        };
        format!("a campaign that was killed left {processes}{folder}")
    }
}

/// The run of a record, if its campaign no longer lives.
fn abandoned(record: &Path) -> Option<Abandoned> {
    let (folder, by) = read(record)?;
    let pid = by.split_once(' ')?.0.parse().ok()?;
    let mark = Some(mark_of(&by));
    (owner(pid) != Some(by)).then(|| Abandoned { record: record.to_owned(), folder, mark })
}

/// Folder and campaign of a record whose processes could be seen from here.
fn read(record: &Path) -> Option<(PathBuf, String)> {
    let meta = fs::symlink_metadata(record).ok().filter(|meta| meta.is_file() && meta.len() <= LARGEST)?;
    let bytes = fs::read(record).ok().filter(|bytes| bytes.len() as u64 == meta.len())?;
    let mut parts = bytes.splitn(3, |byte| *byte == b'\n');
    let (on, by, folder) = (parts.next()?, parts.next()?, parts.next()?);
    let folder = PathBuf::from(OsStr::from_bytes(folder));
    let named = folder.file_name().is_some_and(|name| name.as_bytes().starts_with(PREFIX.as_bytes()));
    let (here, there) = (machine()?, std::str::from_utf8(on).ok()?);
    let ((boot, space), (other_boot, other_space)) = (here.split_once(' ')?, there.split_once(' ')?);
    // Processes of another container are invisible; those from before the last start of the machine have ended.
    let by = if boot == other_boot { std::str::from_utf8(by).ok()?.to_owned() } else { "0 0".to_owned() };
    let seen = boot != other_boot || space == other_space;
    (named && folder.is_absolute() && seen).then_some((folder, by))
}

/// The folder of records: this user's own, which nobody else can write to.
fn registry(make: bool) -> Option<PathBuf> {
    let user = getuid().as_raw();
    let session = PathBuf::from(format!("/run/user/{user}"));
    let base = if session.is_dir() { session } else { PathBuf::from("/tmp") };
    let folder = base.join(format!("flow-runs-{user}"));
    if make {
        // It may be there already.
        let _ = DirBuilder::new().mode(0o700).create(&folder);
    }
    let meta = fs::symlink_metadata(&folder).ok()?;
    (meta.is_dir() && meta.uid() == user && meta.mode() & 0o077 == 0).then_some(folder)
}

/// Identifies the machine, its last start, and the namespace of visible processes.
fn machine() -> Option<String> {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    let space = fs::read_link("/proc/self/ns/pid").ok()?;
    Some(format!("{} {}", boot.trim(), space.display()))
}

/// A process: its id, and when it started, because ids are reused.
fn owner(pid: u32) -> Option<String> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name of the program, in brackets, may hold any character.
    let started = stat.rsplit_once(')')?.1.split_whitespace().nth(19)?.to_owned();
    Some(format!("{pid} {started}"))
}

/// The programs that run.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

fn running() -> MutexGuard<'static, Vec<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts a program in a process group of its own.
pub(super) fn start(command: &mut Command) -> std::io::Result<Child> {
    static ADOPT: Once = Once::new();
    // Whatever a process does with its group, session, folder and environment: without parent it becomes a child of this one,
    // and it has its mark.
    ADOPT.call_once(|| {
        let _ = set_child_subreaper(Some(getpid()));
        owner(std::process::id()).iter().for_each(|own| mark_own(own));
    });
    let mut running = running();
    let child = command.spawn()?;
    running.push(child.id());
    Ok(child)
}

/// Says that a program has ended and was waited for.
pub(super) fn ended(program: u32) {
    running().retain(|own| *own != program);
}

/// Orphans that this process adopted and that no running program can have left; those that have ended are buried.
fn orphans() -> Vec<Pid> {
    let running = running();
    let found = processes().filter(|process| {
        let (own, group) = (getpid().as_raw_pid(), getpgrp().as_raw_pid());
        // What this process starts besides programs of runs stays in its group.
        process.parent == own && process.group != group && !running.contains(&(process.pid.as_raw_pid() as u32))
    });
    let (over, alive): (Vec<Process>, Vec<Process>) = found.partition(|process| process.over);
    for process in over {
        let _ = waitpid(Some(process.pid), WaitOptions::NOHANG);
    }
    if running.is_empty() { alive.into_iter().map(|process| process.pid).collect() } else { Vec::new() }
}

/// A process as the system lists it.
struct Process {
    pid: Pid,
    parent: i32,
    group: i32,
    /// Whether it has ended, and nobody has waited for it.
    over: bool,
}

fn processes() -> impl Iterator<Item = Process> {
    let read = |entry: fs::DirEntry| {
        let pid = Pid::from_raw(entry.file_name().to_str()?.parse().ok()?)?;
        let stat = fs::read_to_string(entry.path().join("stat")).ok()?;
        // The name of the program, in brackets, may hold any character.
        let mut fields = stat.rsplit_once(')')?.1.split_whitespace();
        let (state, parent, group) = (fields.next()?, fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
        Some(Process { pid, parent, group, over: state == "Z" })
    };
    fs::read_dir("/proc").into_iter().flatten().flatten().filter_map(read)
}

/// Ends every process that a run of this campaign left.
pub(super) fn end_strays(folder: &Path) {
    end(|| [strays(folder, None), orphans()].concat());
}

/// Ends processes until none is found, for one may start another while it is ended; returns their number.
fn end(find: impl Fn() -> Vec<Pid>) -> usize {
    const ROUNDS: usize = 20;
    let mut ended = BTreeSet::new();
    for _ in 0..ROUNDS {
        let found = find();
        if found.is_empty() {
            break;
        }
        let killed = found.into_iter().filter(|pid| kill_process(*pid, Signal::KILL).is_ok());
        ended.extend(killed.map(Pid::as_raw_pid));
        std::thread::sleep(Duration::from_millis(2));
    }
    ended.len()
}

/// Processes of this user that were started in a run of this folder, work in it, or have the mark.
fn strays(folder: &Path, mark: Option<u64>) -> Vec<Pid> {
    let entry = [VARIABLE.as_bytes(), b"=", folder.as_os_str().as_bytes()].concat();
    let user = getuid().as_raw();
    let stray = |path: &Path| {
        let environment = fs::read(path.join("environ")).unwrap_or_default();
        let told = environment.split(|byte| *byte == 0).any(|variable| variable == entry);
        told || fs::read_link(path.join("cwd")).is_ok_and(|cwd| cwd.starts_with(folder))
            || mark.is_some_and(|mark| is_marked(path, mark))
    };
    // One that has ended, and that nobody has waited for, still has its limits.
    let alive = processes().filter(|process| !process.over && process.pid != getpid());
    let all = alive.map(|process| (process.pid, PathBuf::from(format!("/proc/{}", process.pid.as_raw_pid()))));
    let mine = all.filter(|(_, path)| fs::metadata(path).is_ok_and(|meta| meta.uid() == user));
    mine.filter(|(_, path)| stray(path)).map(|(pid, _)| pid).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::{Command, Stdio};

    /// A program that leaves its group and ignores requests to end.
    #[test]
    fn a_process_that_left_its_group_is_found_by_its_environment_and_ended() {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir().unwrap();
        let script = "trap '' TERM HUP; sleep 600 & sleep 600";
        let mut child = Command::new("setsid")
            .args(["sh", "-c", script])
            .env(VARIABLE, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let left = || strays(folder.path(), None);
        while left().len() < 2 {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(end(left) >= 2);
        // It was waited for when it was ended; a second wait would find no child.
        let _ = child.wait();
        assert_eq!(left(), []);
    }

    #[test]
    fn a_record_of_a_living_campaign_is_left_alone_and_that_of_a_dead_one_is_not() {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir().unwrap();
        let record = Record::of(folder.path());
        let path = record.0.clone().expect("a place for records");
        assert!(abandoned(&path).is_none());
        let text = fs::read_to_string(&path).unwrap();
        let mut lines: Vec<&str> = text.split('\n').collect();
        // The same number, started at another time: another process.
        let other = format!("{} 1", std::process::id());
        lines[1] = &other;
        let dead = folder.path().join("record");
        fs::write(&dead, lines.join("\n")).unwrap();
        assert_eq!(abandoned(&dead).unwrap().folder, folder.path());
        for folder in ["/", "/home", "relative/flow-run-1", "/tmp/flow-run-1/.."] {
            lines[2] = folder;
            fs::write(&dead, lines.join("\n")).unwrap();
            assert!(abandoned(&dead).is_none(), "{folder}");
        }
        drop(record);
        assert!(!path.exists());
    }
}
