//! Objects: one immutable HDF5 file per task, named by its content.
//!
//! **Name.** `objects/ab/abcd…-0123456789abcdef.h5`: the content hash of the artifact and the first 16 digits of the
//! task's key. The content comes first, so equal results lie side by side; the key makes a file belong to one task, so
//! the task text inside it does not depend on which of two tasks with equal results ended first, and two runs on two
//! empty stores leave the same files.
//!
//! **Writing.** The image is made in memory, written under another name, read back, and only then given its name,
//! without replacing. If the name exists, the file there is kept when it is sound, and set aside when not.
//!
//! **Reading.** Size and blake3 of the file are compared with the journal before the HDF5 library sees a byte. What
//! differs is moved to `aside/`, reported, and counts as missing. Nothing is deleted here.
//!
//! **Durability.** A result that took [`SYNC_FROM`] seconds or longer is synced before it is recorded; a shorter one
//! is left to the kernel (30 s on Linux), because three syncs of about 0.4 ms each would cost more than the task. A
//! power cut therefore loses at most the last half minute of tasks that each took less than that; what it leaves
//! half-written is noticed by its digest.

use super::disk::Disk;
use super::{Damage, Guard, StoreError, hdf5};
use crate::artifact::{ContentHash, Key};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Results of tasks that took this many seconds or more are synced to the disk.
pub(super) const SYNC_FROM: f64 = 0.1;

/// Names one object: the result of one task. Written as it is in file names, content first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId {
    /// The content.
    pub content: ContentHash,
    /// The task.
    pub key: Key,
}

impl ObjectId {
    /// The name of its file.
    fn file_name(&self) -> String {
        format!("{}-{}.h5", self.content, &self.key.to_string()[..16])
    }
}

/// Digest and size of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seal {
    pub(super) digest: [u8; 32],
    pub(super) size: u64,
}

impl Seal {
    pub(super) fn of(bytes: &[u8]) -> Self {
        Self { digest: *blake3::hash(bytes).as_bytes(), size: bytes.len() as u64 }
    }

    /// What differs between this seal and the file found.
    fn difference(&self, found: &Self) -> Option<String> {
        if self.size != found.size {
            return Some(format!("it has {} bytes instead of {}", found.size, self.size));
        }
        (self.digest != found.digest).then(|| "its bytes are not those that were written".to_owned())
    }
}

/// Where an object lies, or would lie.
pub(super) fn path(disk: &Disk, id: &ObjectId) -> PathBuf {
    let name = id.file_name();
    disk.root.join("objects").join(&name[..2]).join(name)
}

/// Writes an object, into the file of its claim if there is one; returns the seal of the file that now has its name.
pub(super) fn write(
    disk: &Disk,
    id: &ObjectId,
    image: &[u8],
    durable: bool,
    mut claim: Option<&mut Guard>,
) -> Result<Seal, StoreError> {
    let path = path(disk, id);
    let seal = Seal::of(image);
    for _ in 0..3 {
        let written = match &mut claim {
            Some(claim) => disk.link_new(&claim.path, &mut claim.held.0, &path, image, durable)?,
            None => disk.write_new(&path, image, durable)?,
        };
        if written {
            return Ok(seal);
        }
        let Some(found) = disk.read(&path)? else { continue };
        if found == image {
            return Ok(seal);
        }
        // Another version of flow may describe the same values differently; anything else is damage.
        let kept = Seal::of(&found);
        match hdf5::decode(found) {
            Ok((artifact, _)) if artifact.content_hash() == id.content => return Ok(kept),
            _ => set_aside(disk, &path, "it is not the object of its name")?,
        };
    }
    Err(disk.fail("write", &path, ErrorKind::AlreadyExists.into()))
}

/// The image of an object, compared with its seal.
pub(super) fn read(disk: &Disk, id: &ObjectId, seal: &Seal) -> Result<Vec<u8>, StoreError> {
    let path = path(disk, id);
    let size = match fs::metadata(&path) {
        Ok(metadata) => metadata.len(),
        Err(error) if error.kind() == ErrorKind::NotFound && disk.root.is_dir() => {
            return Err(StoreError::Missing { content: id.content });
        }
        Err(error) => return Err(disk.fail("read", &path, error)),
    };
    // A file of another size is not even read: it may be huge.
    let found = if size == seal.size {
        let image = disk.read(&path)?.ok_or(StoreError::Missing { content: id.content })?;
        let found = Seal::of(&image);
        if found == *seal {
            return Ok(image);
        }
        found
    } else {
        Seal { size, digest: [0; 32] }
    };
    let why = seal.difference(&found).unwrap_or_default();
    Err(StoreError::Damaged { fault: set_aside(disk, &path, &why)? })
}

/// Moves a damaged file to `aside/`, under a name of its own.
pub(super) fn set_aside(disk: &Disk, path: &Path, why: &str) -> Result<Damage, StoreError> {
    let damage = |aside| Damage { path: path.to_owned(), why: why.to_owned(), aside };
    let folder = disk.root.join("aside");
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if disk.make_dir(&folder).is_err() {
        return Ok(damage(None));
    }
    for number in 1..10_000 {
        let target = folder.join(format!("{name}.{number}"));
        match fs::hard_link(path, &target) {
            Ok(()) => {
                fs::remove_file(path).map_err(|error| disk.fail("set aside", path, error))?;
                return Ok(damage(Some(target)));
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(_) => break,
        }
    }
    // A file system without links, or one that cannot be written.
    let target = folder.join(format!("{name}.{}", std::process::id()));
    Ok(damage(fs::rename(path, &target).is_ok().then_some(target)))
}

/// Calls `visit` with the folder and the name of every file among the objects, temporary ones included.
pub(super) fn list(disk: &Disk, mut visit: impl FnMut(&Path, &str)) -> Result<(), StoreError> {
    for folder in shards(disk)? {
        list_shard(&folder, |name| visit(&folder, name));
    }
    Ok(())
}

/// The folders that objects lie in.
pub(super) fn shards(disk: &Disk) -> Result<Vec<PathBuf>, StoreError> {
    let objects = disk.root.join("objects");
    match fs::read_dir(&objects) {
        Ok(shards) => Ok(shards.flatten().map(|shard| shard.path()).collect()),
        Err(error) if error.kind() == ErrorKind::NotFound && disk.root.is_dir() => Ok(Vec::new()),
        Err(error) => Err(disk.fail("list", &objects, error)),
    }
}

/// Calls `visit` with the name of every file in one of these folders.
pub(super) fn list_shard(folder: &Path, mut visit: impl FnMut(&str)) {
    for file in fs::read_dir(folder).into_iter().flatten().flatten() {
        if let Some(name) = file.file_name().to_str() {
            visit(name);
        }
    }
}
