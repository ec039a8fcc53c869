//! The folder of one run: it is filled before the program starts, watched while it runs, and removed afterwards.

use super::leftover::{self, Record};
use super::{Params, template};
use crate::stage::{Failure, Job, StageError};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, kill_process_group, pidfd_open};
use std::fs::File;
use std::io::ErrorKind;
use std::os::fd::OwnedFd;
use std::os::unix::process::CommandExt;
use std::path::{Component, Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Largest text file that is read back, bytes.
const LARGEST: u64 = 64 << 20;

/// Most bytes that a program may print, so that one that prints without end does not fill the disk.
const MOST_PRINTED: u64 = 1 << 30;

/// Longest time between two looks at the clock, the stop and what the program has printed.
const LONGEST_PAUSE: Duration = Duration::from_millis(50);

/// Longest part of a path between two slashes, bytes.
const LONGEST_NAME: usize = 255;

/// Whether a name stays inside its folder and can be the name of a file.
pub(super) fn is_plain(name: &str) -> bool {
    let part = |part: Component| matches!(part, Component::Normal(name) if name.len() <= LONGEST_NAME);
    !name.is_empty() && !name.contains('\0') && Path::new(name).components().all(part)
}

/// Waits for the end of a program, but at most for this time. Kernels before 5.3 have no descriptor of a process: there
/// it waits for all of it.
fn wait_for(end: Option<&OwnedFd>, most: Duration) {
    let Some(end) = end else { return std::thread::sleep(most) };
    let most = Timespec { tv_sec: 0, tv_nsec: most.subsec_nanos().into() };
    // A signal only makes it return earlier.
    let _ = poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&most));
}

/// A run's own temporary folder; `stdout` and `stderr` lie beside what the program writes.
pub(super) struct Folder {
    root: TempDir,
    /// Marks the folder as in use, with its process; it is dropped after the folder.
    _record: Record,
}

impl Folder {
    /// Makes the folder with its files and filled templates.
    pub(super) fn fill(job: &Job, params: &Params) -> Result<Self, Failure> {
        let root = tempfile::Builder::new().prefix(leftover::PREFIX).tempdir().map_err(|e| io("make a folder", e))?;
        let record = Record::of(root.path());
        let folder = Self { root, _record: record };
        for file in job.files {
            let bytes = job.file(&file.name)?;
            let (bytes, name) = match file.name.split_once(':') {
                Some(("template", name)) => (filled(&bytes, name, job, params)?, name),
                Some((_, name)) => (bytes, name),
                None => panic!("BUG: a file of a command without a kind"),
            };
            let path = folder.path(name);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent).map_err(|e| io("make a folder", e))?;
            }
            std::fs::write(&path, bytes).map_err(|e| io("write the input", e))?;
        }
        Ok(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    /// Runs the program; the inner error is a failure of the program, the outer one of the machine or an interruption.
    pub(super) fn run(&self, job: &Job, params: &Params) -> Result<Result<(), String>, Failure> {
        let mut command = match params.shell {
            true => Command::new("sh"),
            false => Command::new(&params.run[0]),
        };
        match params.shell {
            true => command.arg("-c").arg(&params.run[0]),
            false => command.args(&params.run[1..]),
        };
        let output = |name: &str| File::create(self.path(name)).map_err(|e| io("write its output", e));
        command.current_dir(self.root.path()).stdin(Stdio::null()).process_group(0);
        command.stdout(output("stdout")?).stderr(output("stderr")?);
        command.env_clear().envs(std::env::var_os("PATH").map(|path| ("PATH", path))).envs(&params.environment);
        command.env(leftover::VARIABLE, self.root.path());
        let child = leftover::start(&mut command).map_err(|e| not_started(&params.run[0], &e))?;
        let program = child.id();
        let status = self.wait(child, job);
        leftover::ended(program);
        leftover::end_strays(self.root.path());
        let status = status?;
        Ok(if status.success() { Ok(()) } else { Err(format!("`{}` ended with {status}", params.run.join(" "))) })
    }

    /// Waits until the program ends, the time limit is reached or the run is interrupted; then ends its process group.
    fn wait(&self, mut child: Child, job: &Job) -> Result<ExitStatus, Failure> {
        let (started, mut pause) = (Instant::now(), Duration::from_micros(200));
        let group = Pid::from_child(&child);
        let end = pidfd_open(group, PidfdFlags::empty()).ok();
        loop {
            if let Some(status) = child.try_wait().map_err(|e| io("wait for the program", e))? {
                // Processes that it started and left running are ended too.
                let _ = kill_process_group(group, Signal::KILL);
                return Ok(status);
            }
            if let Some(name) = ["stdout", "stderr"].into_iter().find(|name| self.printed(name) > MOST_PRINTED) {
                let _ = kill_process_group(group, Signal::KILL);
                let _ = child.wait();
                let gigabytes = MOST_PRINTED >> 30;
                return Err(StageError::new(format!(
                    "the program wrote more than {gigabytes} GiB to {name} and was ended"
                ))
                .hint("let it print less, or to a file of its own")
                .into());
            }
            let late = job.time_limit.is_some_and(|limit| started.elapsed().as_secs_f64() > limit);
            if late || job.stopped() {
                let _ = kill_process_group(group, Signal::KILL);
                let _ = child.wait();
                return Err(match job.time_limit {
                    Some(limit) if late => {
                        StageError::new(format!("the program ran longer than its limit of {limit} s"))
                            .hint("raise `time_limit`, or find out why it hangs")
                            .into()
                    }
                    Some(_) | None => Failure::Stopped,
                });
            }
            wait_for(end.as_ref(), pause);
            pause = (pause * 2).min(LONGEST_PAUSE);
        }
    }

    /// Number of bytes that the program has printed so far.
    fn printed(&self, name: &str) -> u64 {
        std::fs::symlink_metadata(self.path(name)).map_or(0, |meta| meta.len())
    }

    /// A text file that the program left. Programs write logs in any encoding: bytes that are no UTF-8 are shown as `\xE9`,
    /// and the numbers between them are read.
    pub(super) fn text(&self, name: &str) -> Result<String, String> {
        let path = self.path(name);
        let found = std::fs::symlink_metadata(&path).map_err(|_| format!("the program left no file `{name}`"))?;
        if !found.is_file() {
            return Err(format!("`{name}` is no plain file but a folder, a link, a pipe or a device"));
        }
        if found.len() > LARGEST {
            return Err(format!("`{name}` has {} bytes; at most {LARGEST} are read", found.len()));
        }
        let bytes = std::fs::read(&path).map_err(|e| format!("`{name}` cannot be read: {e}"))?;
        Ok(readable(&bytes))
    }

    /// The end of the program's log, for the message of a failure.
    pub(super) fn last_words(&self) -> String {
        let said =
            ["stderr", "stdout"].iter().filter_map(|name| self.text(name).ok()).find(|text| !text.trim().is_empty());
        said.map_or_else(
            || "it printed nothing".to_owned(),
            |text| {
                let lines: Vec<String> = text.trim_end().lines().rev().take(5).map(shown).collect();
                format!("it said: {}", lines.into_iter().rev().collect::<Vec<_>>().join(" | "))
            },
        )
    }
}

/// Fills `{{name}}` with the values of the run.
fn filled(template: &[u8], file: &str, job: &Job, params: &Params) -> Result<Vec<u8>, StageError> {
    let fail = |why: &dyn std::fmt::Display| StageError::new(format!("template `{file}`: {why}"));
    let text = std::str::from_utf8(template).map_err(|e| fail(&e))?;
    let value = |name: &str| match name {
        "seed" => Some(job.seed.unwrap_or(0).to_string()),
        "replicate" => Some(params.replicate.to_string()),
        name => params.values.get(name).map(ToString::to_string),
    };
    template::filled(text, value)
        .map(String::into_bytes)
        .map_err(|error| StageError { hint: error.hint, ..fail(&error.message) })
}

/// Bytes as text: UTF-16 by its mark, as shells of Windows write logs; otherwise UTF-8, with other bytes as `\xE9`.
fn readable(bytes: &[u8]) -> String {
    if let Some((encoding, mark)) = encoding_rs::Encoding::for_bom(bytes).filter(|(own, _)| *own != encoding_rs::UTF_8)
    {
        return encoding.decode_without_bom_handling(&bytes[mark..]).0.into_owned();
    }
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        chunk.invalid().iter().for_each(|byte| text.push_str(&format!("\\x{byte:02X}")));
    }
    text
}

/// A line of a message: no control characters, which would steer the terminal, and no more than fits a message.
pub(super) fn shown(line: &str) -> String {
    const LONGEST: usize = 400;
    let line = line.rsplit('\r').find(|part| !part.trim().is_empty()).unwrap_or("");
    let plain: String = line.chars().filter(|c| !c.is_control() || *c == '\t').collect();
    match plain.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &plain[..end]),
        None => plain,
    }
}

/// The failure of a program that cannot be started, with what helps there.
fn not_started(program: &str, error: &std::io::Error) -> StageError {
    let hint = match error.kind() {
        ErrorKind::NotFound => "is it installed and on the PATH?",
        ErrorKind::PermissionDenied => "is it a program, and may you run it?",
        ErrorKind::ArgumentListTooLong => "give long texts in a file: `templates`",
        _ => "the system grants no more processes, files or memory: see `ulimit -a`, and try fewer with `--jobs`",
    };
    StageError::new(format!("`{program}` cannot be started: {error}")).hint(hint)
}

fn io(doing: &str, error: std::io::Error) -> Failure {
    StageError::new(format!("cannot {doing}: {error}")).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_bytes_are_shown_and_cost_nothing_else() {
        assert_eq!(readable(b"Gr\xf6\xdfe fertig\nUCS = 35.5"), "Gr\\xF6\\xDFe fertig\nUCS = 35.5");
        assert_eq!(readable("Größe".as_bytes()), "Größe");
        let wide: Vec<u8> = "\u{feff}UCS = 35.5 °\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(readable(&wide), "UCS = 35.5 °\n");
        assert_eq!(shown("10 %\r20 %\r\u{1b}[31mred\u{7}"), "[31mred");
        assert_eq!(shown(&"é".repeat(1000)).chars().count(), 401);
    }
}
