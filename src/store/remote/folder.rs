//! A remote that is a folder: of a shared disk, or of one that is carried.
//!
//! It is reached as a store is: without links, plain files only, with bounds; what is new is written under another name, read
//! back, and renamed.

use super::RemoteError;
use super::access::{MARKER, Remote, SEGMENTS, TEXT};
use crate::store::disk::Disk;
use crate::store::{StoreError, root};
use std::io::ErrorKind;
use std::path::Path;

pub(super) struct RemoteFolder(Disk);

impl RemoteFolder {
    /// The remote at a path.
    pub(super) fn open(path: &Path) -> Result<Self, RemoteError> {
        let not = |why: &str| RemoteError::NotARemote { path: path.display().to_string(), why: why.to_owned() };
        if path.join(root::MARKER).is_file() {
            return Err(not("it is a store; `--store` uses it as it is, and `flow store push` copies one to a remote"));
        }
        if !path.is_dir() {
            return Err(not("there is no such folder; `flow store push` makes one"));
        }
        let folder = Self(Disk { root: path.to_owned(), read_only: false });
        match folder.read("", MARKER, 1 << 12)? {
            Some(text) if text.starts_with(b"flow remote 1\n") => Ok(folder),
            Some(text) if text.starts_with(b"flow remote ") => Err(not("a newer flow made it")),
            Some(_) => Err(not("its file `flow.remote` is not the one that flow writes")),
            None => Err(not("it has no file `flow.remote`, which flow makes with a remote")),
        }
    }

    /// The same, made when there is no folder or an empty one.
    pub(super) fn make(path: &Path) -> Result<Self, RemoteError> {
        let empty = match std::fs::read_dir(path) {
            Ok(mut entries) => entries.next().is_none(),
            Err(error) => error.kind() == ErrorKind::NotFound,
        };
        if empty {
            let disk = Disk { root: path.to_owned(), read_only: false };
            std::fs::create_dir_all(path).map_err(|error| disk.fail("make the folder", Path::new("/"), error))?;
            disk.write_new("", MARKER, TEXT.as_bytes(), true)?;
        }
        Self::open(path)
    }
}

impl Remote for RemoteFolder {
    fn list(&self) -> Result<Vec<String>, RemoteError> {
        let Some(folder) = self.0.find_folder(SEGMENTS)? else { return Ok(Vec::new()) };
        let mut names = Vec::new();
        let listed = folder.list(|name, _| names.push(name.to_owned()));
        listed.map_err(|error| self.0.fail("list", &self.0.path(SEGMENTS, ""), error))?;
        Ok(names)
    }

    fn read(&self, folder: &str, name: &str, most: u64) -> Result<Option<Vec<u8>>, RemoteError> {
        let Some(found) = self.0.find_folder(folder)? else { return Ok(None) };
        match found.read(name, most) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => match self.0.fail("read", &self.0.path(folder, name), error) {
                // Larger than the bound: not even read.
                StoreError::Strange { .. } => Ok(Some(Vec::new())),
                error => Err(error.into()),
            },
            Ok(bytes) => Ok(Some(bytes)),
        }
    }

    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<bool, RemoteError> {
        Ok(self.0.write_new(folder, name, bytes, false)?)
    }

    fn at_once(&self) -> usize {
        1
    }
}
