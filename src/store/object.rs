//! Objects: one immutable HDF5 file per task, named by its content.
//!
//! **Name.** `objects/ab/abcd…-0123456789abcdef.h5`: the content hash of the artifact and the first 16 digits of the
//! task's key. The content comes first, so equal results lie side by side; the key makes a file belong to one task, so
//! the task text inside it does not depend on which of two tasks with equal results ended first, and two runs on two
//! empty stores leave the same files. The name is a claim that the file itself proves: see `prove.rs`.
//!
//! **Writing.** The image is made in memory, written under another name, read back, and only then given its name,
//! without replacing. If the name exists, the file there is kept when it is sound, and set aside when not.
//!
//! **Durability.** A result that took [`SYNC_FROM`] seconds or longer is synced before it is recorded; a shorter one
//! is left to the kernel (30 s on Linux), because three syncs of about 0.4 ms each would cost more than the task. A
//! power cut therefore loses at most the last half minute of tasks that each took less than that; what it leaves
//! half-written is noticed by its digest.

use super::disk::Disk;
use super::folder::{Entry, Folder};
use super::{Damage, Guard, StoreError, prove};
use crate::artifact::{ContentHash, Key};
use std::io::ErrorKind;
use std::path::PathBuf;

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

/// Folder of damaged files.
pub(super) const ASIDE: &str = "aside";
/// How the file of an object begins.
pub(super) const HEAD: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Length of the name of an object's file.
const NAME: usize = 64 + 1 + KEY_DIGITS + 3;
const KEY_DIGITS: usize = 16;

impl ObjectId {
    /// The name of its file.
    pub(super) fn file_name(&self) -> String {
        format!("{}-{}.h5", self.content, &self.key.to_string()[..KEY_DIGITS])
    }

    /// The folder of its file.
    pub(super) fn folder(&self) -> String {
        shard(&self.content.to_string())
    }
}

/// The folder of objects whose names begin like this.
fn shard(name: &str) -> String {
    format!("objects/{}", &name[..2])
}

/// Whether a folder among the objects is one that flow makes.
pub(super) fn is_shard(name: &str) -> bool {
    name.len() == 2 && is_hex(name)
}

/// Whether a name is one that flow gives to an object in this folder.
pub(super) fn is_name(shard: &str, name: &str) -> bool {
    name.len() == NAME
        && name.starts_with(shard)
        && name.is_char_boundary(64)
        && is_hex(&name[..64])
        && name[64..].strip_prefix('-').and_then(|rest| rest.strip_suffix(".h5")).is_some_and(is_hex)
}

/// Whether a file in a folder of objects is one that flow wrote.
pub(super) fn is_ours(at: &Folder, shard: &str, name: &str) -> bool {
    is_name(shard, name) && super::memo::begins_with(at, name, HEAD)
}

/// Lower-case hexadecimal digits.
pub(super) fn is_hex(text: &str) -> bool {
    text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// Digest and size of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seal {
    /// First bytes of the blake3 of the file: it finds damage before the file is decoded; what a file proves is its
    /// content hash.
    pub(super) digest: [u8; 16],
    pub(super) size: u64,
}

impl Seal {
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut digest = [0; 16];
        digest.copy_from_slice(&blake3::hash(bytes).as_bytes()[..16]);
        Self { digest, size: bytes.len() as u64 }
    }

    /// What differs between this seal and the file found.
    pub(super) fn difference(&self, found: &Self) -> Option<String> {
        if self.size != found.size {
            return Some(format!("it has {} bytes instead of {}", found.size, self.size));
        }
        (self.digest != found.digest).then(|| "its bytes are not those that were written".to_owned())
    }
}

/// Where an object lies, or would lie.
pub(super) fn path(disk: &Disk, id: &ObjectId) -> PathBuf {
    disk.path(&id.folder(), &id.file_name())
}

/// Whether something stands under the object's name.
pub(super) fn is_there(disk: &Disk, id: &ObjectId) -> bool {
    disk.folder(&id.folder()).is_ok_and(|folder| matches!(folder.entry(&id.file_name()), Ok(Entry::File(_))))
}

/// Writes an object, into the file of its claim if there is one; returns the seal of the file that now has its name.
pub(super) fn write(
    disk: &Disk,
    id: &ObjectId,
    image: &[u8],
    durable: bool,
    mut claim: Option<&mut Guard>,
) -> Result<Seal, StoreError> {
    let (folder, name) = (id.folder(), id.file_name());
    let seal = Seal::of(image);
    for _ in 0..3 {
        let linked = match claim.as_mut().and_then(|claim| claim.draft()) {
            Some(draft) => disk.link_new(draft, (&folder, &name), image, durable)?,
            None => None,
        };
        let written = match linked {
            Some(written) => written,
            // The claim's file is not ours any more, or was none.
            None => {
                claim = None;
                disk.write_new(&folder, &name, image, durable)?
            }
        };
        if written {
            return Ok(seal);
        }
        match prove::object(disk, id, None) {
            // Another version of flow may describe the same values differently.
            Ok(proven) => return Ok(proven.seal),
            Err(error) if error.is_missing() => {}
            Err(error) => return Err(error),
        }
    }
    Err(disk.fail("write", &disk.path(&folder, &name), ErrorKind::AlreadyExists.into()))
}

/// Moves what stands under an object's name to `aside/`, under a name of its own. A link is moved as a link.
pub(super) fn set_aside(disk: &Disk, folder: &str, name: &str, why: &str) -> Result<Damage, StoreError> {
    let path = disk.path(folder, name);
    let damage = |aside| Damage { path: path.clone(), why: why.to_owned(), aside };
    if disk.read_only {
        return Ok(damage(None));
    }
    let (Ok(from), Ok(aside)) = (disk.folder(folder), disk.make_folder(ASIDE)) else { return Ok(damage(None)) };
    for number in 1..10_000 {
        let target = format!("{name}.{number}");
        match from.rename_new(name, &aside, &target) {
            Ok(()) => return Ok(damage(Some(disk.path(ASIDE, &target)))),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            // Somebody else was faster.
            Err(error) if error.kind() == ErrorKind::NotFound => break,
            Err(_) => break,
        }
    }
    Ok(damage(None))
}

/// Whether a name in `aside/` is one that [`set_aside`] gives.
pub(super) fn is_aside(name: &str) -> bool {
    let Some((object, number)) = name.rsplit_once('.') else { return false };
    object.len() == NAME && is_name(&object[..2], object) && number.parse::<u32>().is_ok()
}

/// Calls `visit` with each folder of objects, its name, and the name and size of every object in it that is a plain file.
pub(super) fn list(disk: &Disk, mut visit: impl FnMut(&Folder, &str, &str, u64)) -> Result<(), StoreError> {
    let Some((objects, shards)) = shards(disk)? else { return Ok(()) };
    for shard in shards {
        let Ok(folder) = objects.inner(&shard) else { continue };
        for name in names(&folder, &shard) {
            if let Ok(Entry::File(bytes)) = folder.entry(&name) {
                visit(&folder, &shard, &name, bytes);
            }
        }
    }
    Ok(())
}

/// The folder of objects, and the names of the folders in it that they lie in.
pub(super) fn shards(disk: &Disk) -> Result<Option<(Folder, Vec<String>)>, StoreError> {
    let Some(objects) = disk.find_folder("objects")? else { return Ok(None) };
    let mut names = Vec::new();
    let listed = objects.list(|name, folder| names.extend((folder && is_shard(name)).then(|| name.to_owned())));
    listed.map_err(|error| disk.fail("list", &disk.root.join("objects"), error))?;
    names.sort_unstable();
    Ok(Some((objects, names)))
}

/// Names of objects in one of these folders.
pub(super) fn names(folder: &Folder, shard: &str) -> Vec<String> {
    let mut names = Vec::new();
    // A folder that cannot be listed holds nothing that can be used.
    let _ = folder.list(|name, _| names.extend(is_name(shard, name).then(|| name.to_owned())));
    names
}

/// Names of the objects with this content.
pub(super) fn with_content(disk: &Disk, content: &ContentHash) -> Vec<String> {
    let content = content.to_string();
    let Ok(folder) = disk.folder(&shard(&content)) else { return Vec::new() };
    let mut names = names(&folder, &content[..2]);
    names.retain(|name| name.starts_with(&content));
    names.sort_unstable();
    names
}

/// Names of the objects in a folder that belong to a task.
pub(super) fn of_task(disk: &Disk, shard: u8, key: &Key) -> Vec<String> {
    let shard = format!("{shard:02x}");
    let Ok(folder) = disk.folder(&format!("objects/{shard}")) else { return Vec::new() };
    let end = format!("-{}.h5", &key.to_string()[..KEY_DIGITS]);
    let mut names = names(&folder, &shard);
    names.retain(|name| name.ends_with(&end));
    names
}
