//! The few file operations of the store, with its rules: unique temporary name, check, rename; errors with their path.

use super::StoreError;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Folder of a store on disk.
#[derive(Clone, Debug)]
pub(super) struct Disk {
    pub(super) root: PathBuf,
}

impl Disk {
    /// An error of the operating system, sorted by its remedy.
    pub(super) fn fail(&self, doing: &'static str, path: &Path, source: std::io::Error) -> StoreError {
        StoreError::io(doing, path, &self.root, source)
    }

    /// Makes a folder and those above it inside the store; a store that has vanished is not made anew.
    pub(super) fn make_dir(&self, path: &Path) -> Result<(), StoreError> {
        match (fs::create_dir(path), path.parent()) {
            (Ok(()), _) => Ok(()),
            (Err(error), _) if error.kind() == ErrorKind::AlreadyExists => Ok(()),
            (Err(error), Some(parent)) if error.kind() == ErrorKind::NotFound && parent != self.root => {
                self.make_dir(parent)?;
                fs::create_dir(path).or_else(|error| match error.kind() {
                    ErrorKind::AlreadyExists => Ok(()),
                    _ => Err(self.fail("make the folder", path, error)),
                })
            }
            (Err(error), _) => Err(self.fail("make the folder", path, error)),
        }
    }

    /// The bytes of a file, or nothing when there is no such file.
    pub(super) fn read(&self, path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
        match fs::read(path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound && self.root.is_dir() => Ok(None),
            Err(error) => Err(self.fail("read", path, error)),
        }
    }

    /// Writes a new file under a temporary name beside `path`, reads it back, and renames it. Returns false, and
    /// leaves everything as it is, when `path` exists already.
    pub(super) fn write_new(&self, path: &Path, bytes: &[u8], durable: bool) -> Result<bool, StoreError> {
        let temporary = self.write_temporary(path, bytes, durable)?;
        match temporary.persist_noclobber(path) {
            Ok(()) => {}
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => return Ok(false),
            Err(error) => return Err(self.fail("rename to", path, error.error)),
        }
        if durable && let Some(parent) = path.parent() {
            self.sync_dir(parent)?;
        }
        Ok(true)
    }

    /// As [`Disk::write_new`], but into a file that is open and has the name `draft`; `path` becomes its second name.
    pub(super) fn link_new(
        &self,
        draft: &Path,
        file: &mut File,
        path: &Path,
        bytes: &[u8],
        durable: bool,
    ) -> Result<bool, StoreError> {
        // What stands there is shorter than any image as a rule, and cutting a file costs more than asking for its size.
        let size = bytes.len() as u64;
        let longer = file.metadata().is_ok_and(|data| data.len() > size);
        let cut = if longer { file.set_len(0) } else { Ok(()) };
        let written = cut.and_then(|()| file.rewind()).and_then(|()| file.write_all(bytes));
        written
            .and_then(|()| if durable { file.sync_all() } else { Ok(()) })
            .map_err(|e| self.fail("write", path, e))?;
        self.read_back(draft, path, bytes)?;
        let mut linked = fs::hard_link(draft, path);
        if linked.as_ref().is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            self.make_dir(path.parent().unwrap_or(&self.root))?;
            linked = fs::hard_link(draft, path);
        }
        match linked {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return Ok(false),
            // A file system without links.
            Err(_) => return self.write_new(path, bytes, durable),
        }
        if let Ok(mut permissions) = file.metadata().map(|data| data.permissions()) {
            permissions.set_readonly(true);
            let _ = file.set_permissions(permissions);
        }
        if durable && let Some(parent) = path.parent() {
            self.sync_dir(parent)?;
        }
        Ok(true)
    }

    /// As [`Disk::write_new`], but puts the file in place of an older one: for notes that can be made anew, not objects.
    pub(super) fn replace(&self, path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
        let temporary = self.write_temporary(path, bytes, false)?;
        temporary.persist(path).map_err(|error| self.fail("rename to", path, error.error))
    }

    /// A new file under a temporary name; its readers are those whom the user's umask admits.
    pub(super) fn temporary_in(&self, folder: &Path, mode: u32) -> Result<tempfile::NamedTempFile, StoreError> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(TEMPORARY);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
        let file = match builder.tempfile_in(folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                self.make_dir(folder)?;
                builder.tempfile_in(folder)
            }
            other => other,
        };
        file.map_err(|error| self.fail("create a file in", folder, error))
    }

    fn write_temporary(&self, path: &Path, bytes: &[u8], durable: bool) -> Result<tempfile::TempPath, StoreError> {
        let mut file = self.temporary_in(path.parent().unwrap_or(&self.root), 0o444)?;
        file.write_all(bytes).map_err(|error| self.fail("write", path, error))?;
        if durable {
            file.as_file().sync_all().map_err(|error| self.fail("write", path, error))?;
        }
        let temporary = file.into_temp_path();
        // The file is closed: what a network file system refuses only then is noticed here, before it has a name.
        self.read_back(&temporary, path, bytes)?;
        Ok(temporary)
    }

    /// Reads a file that was just written, `path` to be, and compares.
    fn read_back(&self, written: &Path, path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
        let same = File::open(written).and_then(|file| holds(file, bytes));
        match same.map_err(|error| self.fail("read back", path, error))? {
            true => Ok(()),
            false => Err(self.fail("write", path, ErrorKind::StorageFull.into())),
        }
    }

    /// Removes a file, if it is there.
    pub(super) fn remove(&self, path: &Path) -> Result<(), StoreError> {
        match fs::remove_file(path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(self.fail("remove", path, error)),
            _ => Ok(()),
        }
    }

    /// Makes the names in a folder survive a power cut.
    pub(super) fn sync_dir(&self, path: &Path) -> Result<(), StoreError> {
        File::open(path).and_then(|dir| dir.sync_all()).map_err(|error| self.fail("sync", path, error))
    }
}

/// Whether a file holds these bytes and no more.
fn holds(mut file: File, mut bytes: &[u8]) -> std::io::Result<bool> {
    let mut block = vec![0; (bytes.len() + 1).min(1 << 16)];
    loop {
        match file.read(&mut block) {
            Ok(0) => return Ok(bytes.is_empty()),
            Ok(count) => match bytes.strip_prefix(&block[..count]) {
                Some(rest) => bytes = rest,
                None => return Ok(false),
            },
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// How temporary names begin; what a killed process leaves behind is removed by gc.
pub(super) const TEMPORARY: &str = ".writing-";
