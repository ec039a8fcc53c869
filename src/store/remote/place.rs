//! A remote that is a folder: of a shared disk, or of one that is carried.
//!
//! It is read and written as a store is: no links, plain files only, with bounds; a new file is written under another name,
//! read back, and renamed.

use super::{MOST_SEGMENT, RemoteError};
use crate::store::disk::Disk;
use crate::store::object::ObjectId;
use crate::store::{StoreError, root};
use std::io::ErrorKind;
use std::path::Path;

const MARKER: &str = "flow.remote";
const TEXT: &str = "flow remote 1\nflow keeps pushed results in this folder and made this file with it.\n";
const SEGMENTS: &str = "segments";
/// The largest signature that is read.
const MOST_SIGNATURE: u64 = 1 << 16;

pub(super) struct Place(Disk);

impl Place {
    /// The remote at a path.
    pub(super) fn open(path: &Path) -> Result<Self, RemoteError> {
        let not = |why: &str| RemoteError::NotARemote { path: path.display().to_string(), why: why.to_owned() };
        if path.join(root::MARKER).is_file() {
            return Err(not("it is a store; `--store` uses it as it is, and `flow store push` copies one to a remote"));
        }
        if !path.is_dir() {
            return Err(not("there is no such folder; `flow store push` makes one"));
        }
        let place = Self(Disk { root: path.to_owned(), read_only: false });
        match place.read("", MARKER, 1 << 12)? {
            Some(text) if text.starts_with(b"flow remote 1\n") => Ok(place),
            Some(_) => Err(not("a newer flow made it")),
            None => Err(not("it has no file `flow.remote`, which flow makes with a remote")),
        }
    }

    /// As [`Place::open`], but makes the remote when there is no folder or an empty one.
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

    fn read(&self, folder: &str, name: &str, most: u64) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(found) = self.0.find_folder(folder)? else { return Ok(None) };
        match found.read(name, most) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            other => other.map(Some).map_err(|error| self.0.fail("read", &self.0.path(folder, name), error)),
        }
    }

    /// Names of the segments, in order.
    pub(super) fn segments(&self) -> Result<Vec<String>, StoreError> {
        let Some(folder) = self.0.find_folder(SEGMENTS)? else { return Ok(Vec::new()) };
        let mut names = Vec::new();
        let listed = folder.list(|name, _| names.extend(name.strip_suffix(".segment").map(str::to_owned)));
        listed.map_err(|error| self.0.fail("list", &self.0.path(SEGMENTS, ""), error))?;
        names.sort_unstable();
        Ok(names)
    }

    pub(super) fn segment(&self, name: &str) -> Result<Vec<u8>, StoreError> {
        Ok(self.read(SEGMENTS, &format!("{name}.segment"), MOST_SEGMENT)?.unwrap_or_default())
    }

    pub(super) fn put_segment(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        self.put(SEGMENTS, &format!("{name}.segment"), bytes).map(|_| ())
    }

    pub(super) fn signature(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.read(SEGMENTS, &format!("{name}.sig"), MOST_SIGNATURE)
    }

    pub(super) fn put_signature(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        self.put(SEGMENTS, &format!("{name}.sig"), bytes).map(|_| ())
    }

    /// An object of this size; `None` when there is none. Of a larger one, one byte more than the size is read.
    pub(super) fn object(&self, id: &ObjectId, size: u64) -> Result<Option<Vec<u8>>, StoreError> {
        match self.read(&id.folder(), &id.file_name(), size) {
            // Larger than recorded: it is not read.
            Err(StoreError::Strange { .. }) => Ok(Some(Vec::new())),
            other => other,
        }
    }

    /// Writes a new file; false when the name is taken.
    pub(super) fn put(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        self.0.write_new(folder, name, bytes, false)
    }
}
