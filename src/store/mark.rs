//! The user's mark: how the store tells what this user's own `flow` has written from what others have.
//!
//! Anybody who can write to a shared store can write a record or a memo with a right checksum. So each record, memo and
//! listing carries a mark: a keyed blake3 under a secret of 32 bytes that lies outside of every store, in
//! the user's own state folder (`$XDG_STATE_HOME/flow/mark`, else `~/.local/state/flow/mark`), readable by the user
//! alone. A file with the user's own mark is believed. Any other is proven from the objects (`prove.rs`) or counts as
//! missing. Without a home folder, or with a damaged file, the secret lasts as long as the process: the next one believes
//! nothing and proves all objects again, which costs time only; [`Mark::fault_of_user`] says so.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Length of the mark in a record, bytes.
pub(super) const SHORT: usize = 16;

/// Why a user has no mark that lasts.
#[derive(Debug, thiserror::Error)]
#[error(
    "{why}: nothing in a store counts as written by you, so each command proves again what it reads, which takes time"
)]
pub struct MarkFault {
    /// What was found.
    pub why: String,
    /// What to do.
    pub hint: &'static str,
}

/// The keys with which marks are made.
#[derive(Clone)]
pub struct Mark {
    record: [u8; 32],
    note: [u8; 32],
    name: [u8; 4],
}

impl Mark {
    /// The mark of the user who runs this process.
    pub fn of_user() -> Self {
        Self::of(of_user().as_ref().unwrap_or_else(|_| {
            static PASSING: OnceLock<[u8; 32]> = OnceLock::new();
            PASSING.get_or_init(fresh)
        }))
    }

    /// Why the user has no mark that lasts, and what to do.
    pub fn fault_of_user() -> Option<&'static MarkFault> {
        of_user().as_ref().err()
    }

    /// The mark that a secret makes.
    pub fn of(secret: &[u8; 32]) -> Self {
        let [a, b, c, d, ..] = blake3::derive_key("flow store 1 name", secret);
        Self {
            record: blake3::derive_key("flow store 1 record", secret),
            note: blake3::derive_key("flow store 1 note", secret),
            name: [a, b, c, d],
        }
    }

    /// Eight digits in the names of this user's memos and listings, which tell them from those of others.
    pub(super) fn name(&self) -> String {
        format!("{:08x}", u32::from_be_bytes(self.name))
    }

    /// The mark of a record.
    pub(super) fn record(&self, bytes: &[u8]) -> [u8; SHORT] {
        let mut mark = [0; SHORT];
        mark.copy_from_slice(&blake3::keyed_hash(&self.record, bytes).as_bytes()[..SHORT]);
        mark
    }

    /// The secret of a queue. Who has it can write lists that the workers of this queue believe.
    pub(super) fn queue(&self, name: &str) -> [u8; 32] {
        self.note(b"queue", name.as_bytes())
    }

    /// The mark of a memo, listing or campaign called `name`, so that none can replace another.
    pub(super) fn note(&self, name: &[u8], bytes: &[u8]) -> [u8; 32] {
        *self.note_hasher(name).update(bytes).finalize().as_bytes()
    }

    /// What makes the mark of [`Mark::note`] from bytes that come in parts.
    pub(super) fn note_hasher(&self, name: &[u8]) -> blake3::Hasher {
        let mut hash = blake3::Hasher::new_keyed(&self.note);
        hash.update(&(name.len() as u64).to_le_bytes()).update(name);
        hash
    }
}

/// Whether two marks are equal, after as much time for any two: how long a comparison takes would tell how much of a forged
/// mark is right.
pub(super) fn same(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).fold(0, |unlike, (a, b)| unlike | (a ^ b)) == 0
}

/// The secret of the user who runs this process.
fn of_user() -> &'static Result<[u8; 32], MarkFault> {
    static SECRET: OnceLock<Result<[u8; 32], MarkFault>> = OnceLock::new();
    SECRET.get_or_init(|| {
        let Some(folder) = folder() else {
            let why = "neither HOME nor XDG_STATE_HOME names a folder for your mark".to_owned();
            return Err(MarkFault { why, hint: "set one of them to a folder that lasts" });
        };
        secret(&folder).map_err(|error| {
            let path = folder.join("mark");
            let (what, hint) = match error.kind() {
                ErrorKind::InvalidData => (error.to_string(), "delete it, and flow makes another"),
                _ => (
                    format!("cannot be read or made: {error}"),
                    "make it readable, or set XDG_STATE_HOME to another folder",
                ),
            };
            MarkFault { why: format!("your mark {} {what}", path.display()), hint }
        })
    })
}

/// The folder of the user's state.
fn folder() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = absolute("XDG_STATE_HOME").or_else(|| Some(absolute("HOME")?.join(".local/state")))?;
    Some(state.join("flow"))
}

/// The secret in a folder, made when there is none.
fn secret(folder: &Path) -> io::Result<[u8; 32]> {
    let path = folder.join("mark");
    match read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        other => return other,
    }
    fs::create_dir_all(folder)?;
    // It is complete before it has its name; of two processes that make one, both read that of the first.
    let mut file = tempfile::Builder::new().prefix(".mark-").tempfile_in(folder)?;
    file.write_all(&fresh())?;
    file.as_file().sync_all()?;
    match file.persist_noclobber(&path) {
        Err(error) if error.error.kind() != ErrorKind::AlreadyExists => Err(error.error),
        _ => read(&path),
    }
}

/// Whether nobody else can read or change the file of a secret.
fn read(path: &Path) -> io::Result<[u8; 32]> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let data = fs::symlink_metadata(path)?;
    let own = data.uid() == rustix::process::geteuid().as_raw();
    let fault = |what: &str| Err(io::Error::new(ErrorKind::InvalidData, what));
    match () {
        () if !data.is_file() => fault("is no plain file"),
        () if !own => fault("belongs to another user"),
        () if data.permissions().mode() & 0o077 != 0 => fault("can be read or changed by others"),
        () => fs::read(path)?.try_into().or_else(|_| fault("is damaged: it has not 32 bytes")),
    }
}

/// Bytes that nobody can guess: from the system's random source, or from the seeds of hash maps where that cannot be opened.
fn fresh() -> [u8; 32] {
    let mut bytes = [0; 32];
    let read = fs::File::open("/dev/urandom").and_then(|mut source| io::Read::read_exact(&mut source, &mut bytes));
    if read.is_err() {
        use std::hash::{BuildHasher, RandomState};
        for word in bytes.chunks_mut(8) {
            word.copy_from_slice(&RandomState::new().hash_one(word.len()).to_le_bytes());
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_secret_is_made_once_and_not_taken_from_a_file_that_others_can_read() {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path().join("flow");
        let first = secret(&state).unwrap();
        assert_eq!(secret(&state).unwrap(), first);
        assert_ne!(secret(&folder.path().join("other")).unwrap(), first);
        let path = state.join("mark");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        let fault = || secret(&state).unwrap_err().to_string();
        assert_eq!(fault(), "can be read or changed by others");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        fs::write(&path, &first[1..]).unwrap();
        assert_eq!(fault(), "is damaged: it has not 32 bytes");
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert_eq!(fault(), "is no plain file");
    }

    #[test]
    fn a_mark_depends_on_the_secret_the_name_and_the_bytes() {
        let (a, b) = (Mark::of(&[1; 32]), Mark::of(&[2; 32]));
        assert_ne!(a.record(b"x"), b.record(b"x"));
        assert_ne!(a.note(b"n", b"x"), b.note(b"n", b"x"));
        assert_ne!(a.note(b"n", b"x"), a.note(b"nx", b""));
        assert_ne!(a.record(b"x")[..], a.note(b"", b"x")[..SHORT]);
        assert!(same(&a.record(b"x"), &a.record(b"x")) && !same(&a.record(b"x"), &b.record(b"x")));
        assert!(!same(b"x", b"xy") && !same(b"xz", b"xy") && !same(b"zy", b"xy"));
    }
}
