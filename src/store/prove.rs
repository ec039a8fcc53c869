//! An object proves itself: the text of its task gives the key, its values give the content hash, and both give its name.
//!
//! With a record of the user's own, size and digest of the file are compared before a byte of it is decoded. Without one, or
//! with another user's, the file is read within a bound, decoded within bounds, and must give the name that it has. A file
//! that does not is moved to `aside/`, reported, and counts as missing. Nothing is deleted here.

use super::StoreError;
use super::disk::Disk;
use super::folder::Strange;
use super::hdf5::{self, Hdf5Error};
use super::object::{self, ObjectId, Seal};
use crate::artifact::{Artifact, ContentHash, Key};

/// The largest object that is opened without an own record of its size, bytes.
const MOST_UNRECORDED: u64 = 1 << 32;

/// An object whose content is that of its name.
pub(super) struct Proven {
    pub(super) id: ObjectId,
    pub(super) seal: Seal,
    pub(super) artifact: Artifact,
    pub(super) text: String,
}

/// Reads and proves an object; `seal` is what an own record says of its file.
///
/// # Errors
/// [`StoreError::Missing`] when there is none, [`StoreError::Damaged`] when its content was another and it was set aside.
pub(super) fn object(disk: &Disk, id: &ObjectId, seal: Option<&Seal>) -> Result<Proven, StoreError> {
    let (folder, name) = (id.folder(), id.file_name());
    let image = image(disk, (&folder, &name), &id.content, seal)?;
    let proven = judge(disk, (&folder, &name), image)?;
    match proven.id == *id {
        true => Ok(proven),
        // The name holds the first digits of a key only.
        false => Err(StoreError::Missing { content: id.content }),
    }
}

/// Reads and proves the object of this name in its folder, whose task is not known.
///
/// # Errors
/// As [`object`].
pub(super) fn named(disk: &Disk, name: &str) -> Result<Proven, StoreError> {
    let Some(content) = ContentHash::from_hex(&name[..64]) else { panic!("BUG: not the name of an object: {name}") };
    let folder = format!("objects/{}", &name[..2]);
    let image = image(disk, (&folder, name), &content, None)?;
    judge(disk, (&folder, name), image)
}

/// The bytes of an object, compared with what an own record says of its file.
///
/// # Errors
/// As [`object`].
pub(super) fn image_of(disk: &Disk, id: &ObjectId, seal: Option<&Seal>) -> Result<Vec<u8>, StoreError> {
    image(disk, (&id.folder(), &id.file_name()), &id.content, seal)
}

/// Proves an object that lies in no store yet; the error says in words what is wrong with it.
pub(super) fn bytes(id: &ObjectId, image: Vec<u8>) -> Result<(), String> {
    let (artifact, text) = hdf5::decode(image).map_err(|error| error.to_string())?;
    match (artifact.content_hash() == id.content, Key::of(&text) == id.key) {
        (true, true) => Ok(()),
        (false, _) => Err("its values are not those of its name".to_owned()),
        (true, false) => Err("it belongs to another task".to_owned()),
    }
}

/// The bytes under an object's name, compared with its seal.
fn image(
    disk: &Disk,
    (folder, name): (&str, &str),
    content: &ContentHash,
    seal: Option<&Seal>,
) -> Result<Vec<u8>, StoreError> {
    let damaged = |why: &str| Err(StoreError::Damaged { fault: object::set_aside(disk, folder, name, why)? });
    let missing = || StoreError::Missing { content: *content };
    let found = disk.find_folder(folder)?.ok_or_else(missing)?;
    let read = |most| match found.read(name, most) {
        Err(error) if disk.lacks(&error) => Err(missing()),
        Err(error) if Strange::is(&error) => damaged(&error.to_string()),
        other => other.map_err(|error| disk.fail("read", &disk.path(folder, name), error)),
    };
    let Some(seal) = seal else { return read(MOST_UNRECORDED) };
    // A file of another size is not read: it may be huge.
    if let Ok(super::folder::Entry::File(size)) = found.entry(name)
        && size != seal.size
    {
        return damaged(&seal.difference(&Seal { size, ..*seal }).unwrap_or_default());
    }
    let image = read(seal.size)?;
    match seal.difference(&Seal::of(&image)) {
        None => Ok(image),
        Some(why) => damaged(&why),
    }
}

/// Decodes an image and compares it with its name.
fn judge(disk: &Disk, (folder, name): (&str, &str), image: Vec<u8>) -> Result<Proven, StoreError> {
    let seal = Seal::of(&image);
    let why = match hdf5::decode(image) {
        Ok((artifact, text)) => {
            let id = ObjectId { content: artifact.content_hash(), key: Key::of(&text) };
            let found = id.file_name();
            match () {
                () if found == name => return Ok(Proven { id, seal, artifact, text }),
                () if found[..64] != name[..64] => "its values are not those of its name".to_owned(),
                () => "it belongs to another task".to_owned(),
            }
        }
        Err(why @ Hdf5Error::Newer { .. }) => {
            return Err(StoreError::Newer { path: disk.path(folder, name), why });
        }
        Err(why) => why.to_string(),
    };
    Err(StoreError::Damaged { fault: object::set_aside(disk, folder, name, &why)? })
}
