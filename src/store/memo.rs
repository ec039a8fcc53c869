//! Memos: what a stage came to, so that an unchanged campaign is recognised without looking at each of its tasks.
//!
//! A memo is a file `memo/ab/<key of the stage>`: a note in the caller's words, and the objects it speaks of. It can
//! always be made anew from the journal, so a damaged one counts as missing and a later one takes its place.
//!
//! | bytes | field |
//! |---|---|
//! | 0–7 | `flowmem2` |
//! | 8–15, 16–23 | length of the note, length of the data, little-endian |
//! | … | the note, UTF-8; the data |
//! | … | 64 bytes per object: content hash, key |
//! | last 32 | blake3 of all before |

use super::StoreError;
use super::disk::Disk;
use super::object::ObjectId;
use crate::artifact::{ContentHash, Key};
use std::path::PathBuf;

const MAGIC: &[u8; 8] = b"flowmem2";

/// What a stage came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Memo {
    /// Whatever the caller needs to know again.
    pub note: String,
    /// Numbers in the caller's form.
    pub data: Vec<u8>,
    /// The objects it rests on; none of them is removed while the memo is reachable, and it is void without them.
    pub objects: Vec<ObjectId>,
}

pub(super) fn folder(disk: &Disk) -> PathBuf {
    disk.root.join("memo")
}

fn path(disk: &Disk, key: &Key) -> PathBuf {
    let name = key.to_string();
    folder(disk).join(&name[..2]).join(name)
}

pub(super) fn read(disk: &Disk, key: &Key) -> Result<Option<Memo>, StoreError> {
    Ok(disk.read(&path(disk, key))?.and_then(|bytes| unpack(&bytes)))
}

pub(super) fn write(disk: &Disk, key: &Key, memo: &Memo) -> Result<(), StoreError> {
    disk.replace(&path(disk, key), &pack(memo))
}

pub(super) fn pack(memo: &Memo) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(56 + memo.note.len() + memo.data.len() + 64 * memo.objects.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&(memo.note.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&(memo.data.len() as u64).to_le_bytes());
    bytes.extend_from_slice(memo.note.as_bytes());
    bytes.extend_from_slice(&memo.data);
    for object in &memo.objects {
        bytes.extend_from_slice(&object.content.0);
        bytes.extend_from_slice(&object.key.0);
    }
    bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
    bytes
}

pub(super) fn unpack(bytes: &[u8]) -> Option<Memo> {
    let (body, check) = bytes.split_last_chunk::<32>()?;
    if blake3::hash(body).as_bytes() != check {
        return None;
    }
    let rest = body.strip_prefix(MAGIC)?;
    let (lengths, mut rest) = rest.split_first_chunk::<16>()?;
    let mut parts = lengths.as_chunks::<8>().0.iter().map(|length| {
        let (part, after) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        rest = after;
        Some(part)
    });
    let (note, data) = (parts.next()??, parts.next()??);
    drop(parts);
    let (hashes, []) = rest.as_chunks::<32>() else { return None };
    let (pairs, []) = hashes.as_chunks::<2>() else { return None };
    let objects = pairs.iter().map(|[content, key]| ObjectId { content: ContentHash(*content), key: Key(*key) });
    let note = String::from_utf8(note.to_vec()).ok()?;
    Some(Memo { note, data: data.to_vec(), objects: objects.collect() })
}
