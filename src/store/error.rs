//! What can go wrong with a store, each fault with its path and its remedy.

use super::folder::Strange;
use super::hdf5::Hdf5Error;
use crate::artifact::ContentHash;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// A fault of the store or of the disk it lies on.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// No space left, or the quota is used up.
    #[error(
        "the disk is full: could not {doing} {}; make room (`flow store gc` removes what no workflow needs) and run \
         again, what is finished is kept", path.display()
    )]
    Full {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// A file does not hold what was just written to it, though no write failed.
    #[error(
        "{bytes} bytes were written to {}, and others were read back: the disk is failing, or is full and does not say so; \
         check it and run again, what is finished is kept", path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
        /// The number of bytes that were written.
        bytes: usize,
    },
    /// The file is larger than this user may write.
    #[error(
        "could not {doing} {}: the file is larger than the limit on the size of files; raise it (`ulimit -f`) and run \
         again, what is finished is kept", path.display()
    )]
    Limited {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// The file system is mounted read-only.
    #[error(
        "the store is read-only: could not {doing} {}; results in it can be read, for new ones name another store \
         with `--store`", path.display()
    )]
    ReadOnly {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// The user may not do that here.
    #[error(
        "no permission to {doing} {}; ask its owner for it, or name another store with `--store`", path.display()
    )]
    Denied {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// The folder is not there any more.
    #[error("the store {} has vanished; bring it back (is its disk still mounted?) and run again", root.display())]
    Vanished {
        /// The store.
        root: PathBuf,
    },
    /// The path given as a store is something else.
    #[error("{} is not a store: {why}; name a folder with `--store`", path.display())]
    NotAStore {
        /// The path.
        path: PathBuf,
        /// What stands in the way.
        why: String,
    },
    /// Another process uses the store, so nothing may be removed from it.
    #[error("the store {} is in use by another flow process; wait until it has ended and run again", root.display())]
    InUse {
        /// The store.
        root: PathBuf,
    },
    /// Something in the store that flow has not made: a link, a pipe, a device, a file larger than any of its own.
    #[error("could not {doing} {}: {why}; move it out of the store and run again", path.display())]
    Strange {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// What it is.
        why: String,
    },
    /// The attached remote cannot be read.
    #[error("{why}; `flow store detach` goes on without this remote")]
    Far {
        /// Which one, and why.
        why: String,
    },
    /// Any other fault of the operating system.
    #[error("could not {doing} {}: {source}", path.display())]
    Io {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// An object is not what was written; it counts as missing from now on.
    #[error("{fault}")]
    Damaged {
        /// What was found.
        fault: Damage,
    },
    /// The store has no object of this content.
    #[error("the store has no object {content}; run again to compute it")]
    Missing {
        /// The content asked for.
        content: ContentHash,
    },
    /// A result that no file can hold.
    #[error("the result cannot be stored: {0}")]
    Unstorable(Hdf5Error),
    /// An object of a later version of flow.
    #[error("{} was written by a newer flow: {why}", path.display())]
    Newer {
        /// The object.
        path: PathBuf,
        /// What the reader says.
        why: Hdf5Error,
    },
}

/// A file of the store that is not what was written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} is damaged: {why}; {aside}; the next run computes it again", path.display())]
pub struct Damage {
    /// The object.
    pub path: PathBuf,
    /// How it differs from what was written.
    pub why: String,
    /// Where it is now.
    pub aside: Aside,
}

/// What became of a damaged file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Aside {
    /// It was moved to this path.
    Moved(PathBuf),
    /// It is where it was: the store cannot be written.
    Stays,
    /// It is in a remote, and was not taken from there.
    NotTaken,
}

impl std::fmt::Display for Aside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Moved(path) => write!(f, "it was set aside as {}", path.display()),
            Self::Stays => write!(f, "it could not be set aside"),
            Self::NotTaken => write!(f, "it was not taken"),
        }
    }
}

impl StoreError {
    /// Sorts an error of the operating system by its remedy; `root` is the store's folder.
    pub(super) fn io(doing: &'static str, path: &Path, root: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        if Strange::is(&source) {
            return Self::Strange { doing, path, why: source.to_string() };
        }
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full { doing, path },
            ErrorKind::FileTooLarge => Self::Limited { doing, path },
            ErrorKind::ReadOnlyFilesystem => Self::ReadOnly { doing, path },
            ErrorKind::PermissionDenied => Self::Denied { doing, path },
            ErrorKind::NotFound | ErrorKind::NotADirectory if !root.is_dir() => {
                Self::Vanished { root: root.to_owned() }
            }
            _ => Self::Io { doing, path, source },
        }
    }

    /// Whether the result asked for has to be computed again, rather than the store mended.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Missing { .. } | Self::Damaged { .. })
    }
}
