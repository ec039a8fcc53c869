//! A folder of the store as an open descriptor: the only way by which the store reaches a file.
//!
//! Others may write to a shared store, so every file is checked before it is used. Folders below the root are opened one by
//! one without following links, and files are opened relative to their folder, so no link leads out of the store, not even
//! one that is put there between check and use. A file is opened without blocking and is accepted only if it is a plain
//! file: no pipe, device or link. The number of bytes read has a bound ([`Folder::read`]).

use super::fault::{self, Step};
use rustix::fs::{AtFlags, Dir, FileType, Mode, OFlags, RenameFlags, Stat};
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::path::Path;

/// Files shorter than this may have holes: file systems that pack small files report odd sizes on the disk.
const SMALL: u64 = 1 << 20;
/// A compressing file system makes files smaller by this factor at most; a file that claims more is sparse.
const MOST_PACKED: u64 = 1 << 10;

/// The error of a name that is neither a plain file nor a folder.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Strange(&'static str);

impl Strange {
    fn error(what: &'static str) -> io::Error {
        io::Error::other(Self(what))
    }

    /// Whether an error says that neither a plain file nor a folder was found.
    pub(super) fn is(error: &io::Error) -> bool {
        error.get_ref().is_some_and(|inner| inner.is::<Self>())
    }
}

/// An open folder.
#[derive(Debug)]
pub(super) struct Folder(OwnedFd);

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entry {
    /// A plain file and its size, bytes.
    File(u64),
    /// A folder.
    Folder,
    /// A link, pipe, socket or device.
    Strange,
}

const INSIDE: OFlags = OFlags::NOFOLLOW.union(OFlags::CLOEXEC);

impl Folder {
    /// The folder at a path that the user gave; links in it are the user's own.
    pub(super) fn at(path: &Path) -> io::Result<Self> {
        fault::meet(Step::Open)?;
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        Ok(Self(rustix::fs::open(path, flags, Mode::empty())?))
    }

    /// A folder inside, which must not be a link.
    pub(super) fn inner(&self, name: &str) -> io::Result<Self> {
        fault::meet(Step::Open)?;
        match rustix::fs::openat(&self.0, name, INSIDE | OFlags::RDONLY | OFlags::DIRECTORY, Mode::empty()) {
            Ok(folder) => Ok(Self(folder)),
            Err(rustix::io::Errno::NOTDIR | rustix::io::Errno::LOOP) => {
                Err(Strange::error("it is a link or a file where flow makes a folder"))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Makes a folder inside, unless there is one.
    pub(super) fn make(&self, name: &str) -> io::Result<()> {
        fault::meet(Step::Make)?;
        match rustix::fs::mkdirat(&self.0, name, Mode::from_raw_mode(0o777)) {
            Ok(()) | Err(rustix::io::Errno::EXIST) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Opens a plain file; `write` also for writing.
    pub(super) fn open(&self, name: &str, write: bool) -> io::Result<File> {
        fault::meet(Step::Open)?;
        let access = if write { OFlags::RDWR } else { OFlags::RDONLY };
        // Non-blocking: opening a pipe would wait for a writer that never comes.
        let flags = INSIDE | access | OFlags::NONBLOCK | OFlags::NOCTTY;
        match rustix::fs::openat(&self.0, name, flags, Mode::empty()) {
            Ok(file) => plain(File::from(file)),
            Err(rustix::io::Errno::LOOP) => Err(Strange::error("it is a link, and flow follows none in a store")),
            Err(rustix::io::Errno::ISDIR) => Err(Strange::error(NOT_PLAIN)),
            Err(rustix::io::Errno::NXIO) => Err(Strange::error(NOT_PLAIN)),
            Err(error) => Err(error.into()),
        }
    }

    /// Makes a new file for reading and writing; an error of kind `AlreadyExists` when anything has the name.
    pub(super) fn create(&self, name: &str, mode: u32) -> io::Result<File> {
        fault::meet(Step::Make)?;
        let flags = INSIDE | OFlags::RDWR | OFlags::CREATE | OFlags::EXCL;
        Ok(rustix::fs::openat(&self.0, name, flags, Mode::from_raw_mode(mode))?.into())
    }

    /// The bytes of a plain file, at most `most`.
    pub(super) fn read(&self, name: &str, most: u64) -> io::Result<Vec<u8>> {
        let file = self.open(name, false)?;
        let size = bounded(&file, most)?;
        let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
        // Bytes that are appended meanwhile are not read.
        file.take(size).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Whether a plain file begins with these bytes.
    pub(super) fn begins_with(&self, name: &str, head: &[u8]) -> bool {
        let mut found = vec![0; head.len()];
        self.open(name, false).is_ok_and(|mut file| file.read_exact(&mut found).is_ok() && found == head)
    }

    /// What a name stands for; an error of kind `NotFound` when there is no such name.
    pub(super) fn entry(&self, name: &str) -> io::Result<Entry> {
        let stat = rustix::fs::statat(&self.0, name, AtFlags::SYMLINK_NOFOLLOW)?;
        Ok(match FileType::from_raw_mode(stat.st_mode) {
            FileType::RegularFile => Entry::File(u64::try_from(stat.st_size).unwrap_or(0)),
            FileType::Directory => Entry::Folder,
            _ => Entry::Strange,
        })
    }

    /// When a file was last written, seconds since 1970 by the clock of the file system.
    pub(super) fn modified(&self, name: &str) -> Option<i64> {
        rustix::fs::statat(&self.0, name, AtFlags::SYMLINK_NOFOLLOW).ok().map(|stat| stat.st_mtime)
    }

    /// Whether the name is still that of this open file.
    pub(super) fn names(&self, name: &str, file: &File) -> bool {
        let named = rustix::fs::statat(&self.0, name, AtFlags::SYMLINK_NOFOLLOW);
        let open = rustix::fs::fstat(file);
        matches!((named, open), (Ok(named), Ok(open)) if (named.st_ino, named.st_dev) == (open.st_ino, open.st_dev))
    }

    /// The state of a folder inside, which must not be a link.
    pub(super) fn stat_of(&self, name: &str) -> io::Result<Stat> {
        let stat = rustix::fs::statat(&self.0, name, AtFlags::SYMLINK_NOFOLLOW)?;
        match FileType::from_raw_mode(stat.st_mode) {
            FileType::Directory => Ok(stat),
            _ => Err(Strange::error("it is no folder")),
        }
    }

    /// The state of the folder itself; a network file system asks its server for it.
    pub(super) fn stat(&self) -> io::Result<Stat> {
        ask_anew(&self.0);
        Ok(rustix::fs::fstat(&self.0)?)
    }

    /// Every name inside that is text, and whether it is a folder.
    pub(super) fn list(&self, mut visit: impl FnMut(&str, bool)) -> io::Result<()> {
        fault::meet(Step::Open)?;
        let mut entries = Dir::read_from(&self.0)?;
        while let Some(entry) = entries.read() {
            let entry = entry?;
            if let Ok(name) = entry.file_name().to_str()
                && !matches!(name, "." | "..")
            {
                // Some file systems do not tell the type of an entry with its name.
                let folder = match entry.file_type() {
                    FileType::Unknown => matches!(self.entry(name), Ok(Entry::Folder)),
                    kind => kind == FileType::Directory,
                };
                visit(name, folder);
            }
        }
        Ok(())
    }

    /// Gives a file in this folder a second name in another one.
    pub(super) fn link(&self, name: &str, to: &Self, new: &str) -> io::Result<()> {
        fault::meet(Step::Name)?;
        Ok(rustix::fs::linkat(&self.0, name, &to.0, new, AtFlags::empty())?)
    }

    /// Moves a name into another folder and replaces a file of that name there.
    pub(super) fn rename(&self, name: &str, to: &Self, new: &str) -> io::Result<()> {
        fault::meet(Step::Name)?;
        Ok(rustix::fs::renameat(&self.0, name, &to.0, new)?)
    }

    /// Moves a name into another folder; an error of kind `AlreadyExists` when the name is taken there.
    pub(super) fn rename_new(&self, name: &str, to: &Self, new: &str) -> io::Result<()> {
        fault::meet(Step::Name)?;
        match rustix::fs::renameat_with(&self.0, name, &to.0, new, RenameFlags::NOREPLACE) {
            // A file system without this operation: check first, then rename.
            Err(rustix::io::Errno::INVAL | rustix::io::Errno::NOSYS) => match to.entry(new) {
                Ok(_) => Err(ErrorKind::AlreadyExists.into()),
                Err(_) => self.rename(name, to, new),
            },
            other => Ok(other?),
        }
    }

    /// Removes a file, if it is there; never a folder.
    pub(super) fn remove(&self, name: &str) -> io::Result<()> {
        fault::meet(Step::Name)?;
        match rustix::fs::unlinkat(&self.0, name, AtFlags::empty()) {
            Ok(()) | Err(rustix::io::Errno::NOENT) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Removes a folder inside that is empty.
    pub(super) fn remove_empty(&self, name: &str) -> io::Result<()> {
        Ok(rustix::fs::unlinkat(&self.0, name, AtFlags::REMOVEDIR)?)
    }

    /// Makes its names survive a power cut.
    pub(super) fn sync(&self) -> io::Result<()> {
        fault::sync(|| Ok(rustix::fs::fsync(&self.0)?))
    }
}

const NOT_PLAIN: &str = "it is not a plain file";

fn plain(file: File) -> io::Result<File> {
    match FileType::from_raw_mode(rustix::fs::fstat(&file)?.st_mode) {
        FileType::RegularFile => Ok(file),
        _ => Err(Strange::error(NOT_PLAIN)),
    }
}

/// The size of an open file that may be read into memory.
pub(super) fn bounded(file: &File, most: u64) -> io::Result<u64> {
    let stat = rustix::fs::fstat(file)?;
    let (size, disk) = (stat.st_size as u64, stat.st_blocks as u64 * 512);
    if size > most || (size > SMALL && disk.saturating_mul(MOST_PACKED) < size) {
        return Err(Strange::error("it is larger than anything that flow writes there"));
    }
    Ok(size)
}

/// Lets a network file system ask its server for the state of a file, which it may cache for seconds.
pub(super) fn ask_anew(file: impl std::os::fd::AsFd) {
    // Where the system does not support this, the cached state is taken.
    let flags = AtFlags::EMPTY_PATH | AtFlags::STATX_FORCE_SYNC;
    let _ = rustix::fs::statx(file, "", flags, rustix::fs::StatxFlags::BASIC_STATS);
}

/// Writes all bytes.
pub(super) fn write(mut file: &File, bytes: &[u8]) -> io::Result<()> {
    fault::write(bytes, |part| file.write_all(part))
}

/// Makes the bytes of a file survive a power cut.
pub(super) fn sync(file: &File) -> io::Result<()> {
    fault::sync(|| file.sync_all())
}
