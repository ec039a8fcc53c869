//! Objects: one immutable HDF5 file per task, named by its content.
//!
//! **Name.** `objects/ab/abcd…-0123456789abcdef.h5`: the content hash of the artifact and the first 16 digits of the
//! task's key. The content comes first, so equal results lie side by side; the key makes a file belong to one task, so
//! the task text inside it does not depend on which of two tasks with equal results ended first, and two runs on two
//! empty stores leave the same files. The name is a claim that the file itself proves: see `prove.rs`.
//!
//! **Writing.** The image is made in memory, written under another name, read back, and only then gets its name; it replaces
//! nothing. If the name is taken, the file there stays when it is sound, and is set aside when it is not.
//!
//! **Durability.** A result that took [`SYNC_FROM`] seconds or longer is synced before it is recorded; a shorter one
//! is left to the kernel (30 s on Linux), because three syncs of about 0.4 ms each would cost more than the task. A
//! power cut therefore loses at most the last half minute of tasks that each took less than that; what it leaves
//! half-written is noticed by its digest.

use super::disk::Disk;
use super::folder::{Entry, Folder};
use super::{Aside, Damage, StoreError};
use crate::artifact::{ContentHash, Key};
use std::io::ErrorKind;
use std::path::PathBuf;

/// Results of tasks that took this many seconds or more are synced to the disk.
pub(super) const SYNC_FROM: f64 = 0.1;

/// Identifies one object, the result of one task. As text it is written as in file names, content first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId {
    /// The content.
    pub content: ContentHash,
    /// The task.
    pub key: Key,
}

/// Folder of damaged files.
pub(super) const ASIDE: &str = "aside";
/// The first bytes of an object's file.
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

/// The folder of the objects whose names begin with these digits.
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
    is_name(shard, name) && at.begins_with(name, HEAD)
}

/// Lower-case hexadecimal digits.
pub(super) fn is_hex(text: &str) -> bool {
    text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// Digest and size of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seal {
    /// First bytes of the blake3 of the file. It shows damage before the file is decoded; the content hash is what proves
    /// the result.
    pub(super) digest: [u8; 16],
    pub(super) size: u64,
}

impl Seal {
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut digest = [0; 16];
        digest.copy_from_slice(&blake3::hash(bytes).as_bytes()[..16]);
        Self { digest, size: bytes.len() as u64 }
    }

    /// How the file that was found differs from this seal; `None` when it does not.
    pub(super) fn difference(&self, found: &Self) -> Option<String> {
        if self.size != found.size {
            return Some(format!("it has {} bytes instead of {}", found.size, self.size));
        }
        (self.digest != found.digest).then(|| "its bytes are not those that were written".to_owned())
    }
}

/// The path of an object, which need not exist.
pub(super) fn path(disk: &Disk, id: &ObjectId) -> PathBuf {
    disk.path(&id.folder(), &id.file_name())
}

/// Whether the object's name is taken, by a file or anything else.
pub(super) fn is_there(disk: &Disk, id: &ObjectId) -> bool {
    disk.folder(&id.folder()).is_ok_and(|folder| matches!(folder.entry(&id.file_name()), Ok(Entry::File(_))))
}

/// Moves the file under an object's name to `aside/`, under a unique name. A link is moved as a link.
pub(super) fn set_aside(disk: &Disk, folder: &str, name: &str, why: &str) -> Result<Damage, StoreError> {
    let path = disk.path(folder, name);
    let damage = |aside| Damage { path: path.clone(), why: why.to_owned(), aside };
    if disk.read_only {
        return Ok(damage(Aside::Stays));
    }
    let (Ok(from), Ok(aside)) = (disk.folder(folder), disk.make_folder(ASIDE)) else { return Ok(damage(Aside::Stays)) };
    for number in 1..10_000 {
        let target = format!("{name}.{number}");
        match from.rename_new(name, &aside, &target) {
            Ok(()) => return Ok(damage(Aside::Moved(disk.path(ASIDE, &target)))),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            // Another process was faster.
            Err(error) if error.kind() == ErrorKind::NotFound => break,
            Err(_) => break,
        }
    }
    Ok(damage(Aside::Stays))
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

/// The folders of objects, each opened, by their names: what cannot be seen is not gone.
///
/// # Errors
/// One that cannot be opened, or that is no folder.
pub(super) fn open_shards(disk: &Disk) -> Result<Vec<(String, Folder)>, StoreError> {
    let Some(objects) = disk.find_folder("objects")? else { return Ok(Vec::new()) };
    let mut names = Vec::new();
    let listed = objects.list(|name, _| names.extend(is_shard(name).then(|| format!("objects/{name}"))));
    listed.map_err(|error| disk.fail("list", &disk.root.join("objects"), error))?;
    names.sort_unstable();
    let open = |name: String| Ok(disk.find_folder(&name)?.map(|folder| (name, folder)));
    names.into_iter().filter_map(|name| open(name).transpose()).collect()
}

/// The folder of objects, and the names of the folders inside it.
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
    // Nothing can be used from a folder that cannot be listed.
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
