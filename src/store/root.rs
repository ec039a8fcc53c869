//! The root of a store: a folder with the file `flow.store`, which flow wrote when it made the store.
//!
//! A folder that does not exist, or holds nothing but notes for its readers, becomes a store when it is first opened. Any
//! other folder without the marker is refused, so that no other files are taken for results, and read, moved or removed.
//! A store of an earlier flow has no marker; [`adopt`] makes one when nothing but what flow makes lies in the folder.

use super::StoreError;
use super::disk::{Disk, is_temporary};
use super::folder::{Folder, Strange};
use super::journal;
use super::presence::is_listing;
use std::io::ErrorKind;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::time::{Duration, Instant};

/// Name of the marker.
pub(super) const MARKER: &str = "flow.store";
const FIRST_LINE: &str = "flow store 1\n";
const TEXT: &str = "flow store 1\n\
    flow keeps results in this folder and made this file with it. Without this file flow does not touch the folder.\n";
/// Files that stand beside a store and are not flow's to touch.
const NOTES: &[&str] = &[".gitignore", "README.md"];
/// Folders that flow makes in a store.
const FOLDERS: &[&str] = &["objects", "journal", "memo", "runs", "locks", "aside", "queue", "remote"];
/// Files that flow makes in the root of a store.
const FILES: &[&str] = &[MARKER, super::lock::IN_USE, "listing"];

/// How long another node's marker may be listed before it can be read: shared file systems cache for up to ten seconds that
/// a file does not exist.
const LATE: Duration = Duration::from_secs(15);
const PAUSE: Duration = Duration::from_millis(100);

/// Opens the folder of a store, and makes it when there is none.
pub(super) fn open(disk: &Disk) -> Result<(), StoreError> {
    let asked = Instant::now();
    while !opened(disk)? {
        if asked.elapsed() > LATE {
            return Err(refuse(&disk.root, format!("its file `{MARKER}` is listed and cannot be read; try again")));
        }
        std::thread::sleep(PAUSE);
    }
    Ok(())
}

/// Opens the folder of a store; false when its marker has just been written and cannot be read yet.
fn opened(disk: &Disk) -> Result<bool, StoreError> {
    let root = &disk.root;
    if !root.is_dir() {
        if disk.read_only && !root.exists() {
            return Ok(true);
        }
        create(disk)?;
    }
    let folder = Folder::at(root).map_err(|error| disk.fail("open the folder", root, error))?;
    match folder.read(MARKER, 1 << 12) {
        Ok(text) if text.starts_with(FIRST_LINE.as_bytes()) => return Ok(true),
        Ok(text) if text.starts_with(b"flow store ") => {
            return Err(refuse(root, "a newer flow made it; use that one".to_owned()));
        }
        Ok(_) => return Err(refuse(root, format!("its file `{MARKER}` is not the one that flow writes"))),
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) if Strange::is(&error) => return Err(refuse(root, format!("`{MARKER}`: {error}"))),
        Err(error) => return Err(disk.fail("read", &root.join(MARKER), error)),
    }
    match other_names(disk, &folder)?.as_slice() {
        [] if disk.read_only => Ok(true),
        [] => mark(disk).map(|()| true),
        // Another process has made it in the meantime.
        names if names.iter().any(|name| name == MARKER) => Ok(false),
        names if names.iter().all(|name| is_ours(name)) => Err(refuse(
            root,
            format!(
                "it has no file `{MARKER}`; if an earlier flow made it, adopt it with `flow store adopt --store {}`",
                root.display()
            ),
        )),
        [first, ..] => Err(refuse(
            root,
            format!("it has no file `{MARKER}`, which flow makes with a store, and holds other files (`{first}`)"),
        )),
    }
}

/// Makes the marker in a store of an earlier flow.
///
/// # Errors
/// The folder holds what flow does not make, or no journal of flow.
pub(super) fn adopt(disk: &Disk) -> Result<(), StoreError> {
    let folder = Folder::at(&disk.root).map_err(|error| disk.fail("open the folder", &disk.root, error))?;
    let names = other_names(disk, &folder)?;
    if let Some(other) = names.iter().find(|name| !is_ours(name)) {
        return Err(refuse(&disk.root, format!("it holds `{other}`, which flow does not make; move that away first")));
    }
    if !journal::is_there(disk)? {
        return Err(refuse(&disk.root, "it holds no journal that flow has written".to_owned()));
    }
    mark(disk)
}

/// The first entry of the root that is neither a note nor a file that is being written.
fn other_names(disk: &Disk, folder: &Folder) -> Result<Vec<String>, StoreError> {
    let mut names = Vec::new();
    let passing = |name: &str| is_note(name) || is_temporary(name) || is_unlinked(name);
    let listed = folder.list(|name, _| names.extend((!passing(name)).then(|| name.to_owned())));
    listed.map_err(|error| disk.fail("list", &disk.root, error))?;
    names.sort_unstable();
    Ok(names)
}

/// Whether a network file system left this in place of a file that was removed while it was open.
fn is_unlinked(name: &str) -> bool {
    [".nfs", ".fuse_hidden"].iter().any(|prefix| name.starts_with(prefix))
}

/// Whether a store is the user's own: its folder and its marker belong to the user, who may write into the folder.
pub(super) fn is_own(root: &Path) -> bool {
    let user = rustix::process::geteuid().as_raw();
    let owned = |path: &Path| std::fs::metadata(path).map(|data| data.uid() == user);
    // A folder without a marker becomes a store when it is opened.
    let marked = match owned(&root.join(MARKER)) {
        Err(error) if error.kind() == ErrorKind::NotFound => true,
        other => other.unwrap_or(false),
    };
    owned(root).unwrap_or(false) && marked && rustix::fs::access(root, rustix::fs::Access::WRITE_OK).is_ok()
}

/// Whether flow makes something of this name in the root of a store.
pub(super) fn is_ours(name: &str) -> bool {
    FOLDERS.contains(&name) || FILES.contains(&name) || is_listing(name) || is_temporary(name)
}

/// Whether this is a note for readers of the folder.
pub(super) fn is_note(name: &str) -> bool {
    NOTES.contains(&name)
}

/// Whether flow makes a folder of this name in this folder of a store.
pub(super) fn is_folder(folder: &str, name: &str) -> bool {
    match folder {
        "" => FOLDERS.contains(&name),
        "objects" | super::memo::FOLDER => super::object::is_shard(name),
        _ => super::queue::is_folder(folder, name),
    }
}

fn mark(disk: &Disk) -> Result<(), StoreError> {
    // Of two processes that make it, both write the same.
    disk.write_new("", MARKER, TEXT.as_bytes(), true)?;
    Ok(())
}

/// Makes the folder of a new store, with a note that keeps its files out of version control.
fn create(disk: &Disk) -> Result<(), StoreError> {
    let root = &disk.root;
    std::fs::create_dir_all(root).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => refuse(root, "it is not a folder".to_owned()),
        ErrorKind::NotADirectory => refuse(root, "a part of the path is a file".to_owned()),
        // A folder that is missing is made here, so it has not vanished.
        _ => StoreError::io("make the folder", root, Path::new("/"), error),
    })?;
    disk.write_new("", ".gitignore", b"*\n", false)?;
    Ok(())
}

fn refuse(root: &Path, why: String) -> StoreError {
    StoreError::NotAStore { path: root.to_owned(), why }
}
