//! Memos: the outcome of a stage, so that an unchanged campaign is recognised without looking at each of its tasks.
//!
//! A memo is a file `memo/ab/<key of the stage>-<user>`: a text in the caller's format, and the objects that it names. It
//! can always be made anew from the objects, so a damaged one counts as missing and a later one replaces it. It carries
//! the user's mark over its own key and all of its bytes: a memo that another user made, or that was changed or put under
//! another key, counts as missing too.
//!
//! | bytes | field |
//! |---|---|
//! | 0–7 | `flowmem3` |
//! | 8–15, 16–23 | length of the text, length of the data, little-endian |
//! | … | the text, UTF-8; the data |
//! | … | 64 bytes per object: content hash, key |
//! | last 32 | the mark |

use super::disk::Disk;
use super::folder::Strange;
use super::mark::{self, Mark};
use super::object::{ObjectId, is_hex};
use super::{StoreError, folder};
use crate::artifact::{ContentHash, Key};

/// Folder of the memos.
pub(super) const FOLDER: &str = "memo";
const MAGIC: &[u8; 8] = b"flowmem3";
/// The first bytes of memos of all versions.
const HEAD: &[u8] = b"flowmem";
/// The largest memo: one of ten million tasks.
pub(super) const MOST: u64 = 1 << 30;

/// The outcome of a stage.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Memo {
    /// A text in the caller's format.
    pub note: String,
    /// Numbers in the caller's format.
    pub data: Vec<u8>,
    /// The objects that it names; none of them is removed while the memo is reachable, and without them it is invalid.
    pub objects: Vec<ObjectId>,
}

/// A memo to be written: its bytes are never in memory as a whole, for there may be a million objects.
pub struct MemoDraft<'a> {
    /// A text in the caller's format.
    pub note: &'a str,
    /// Numbers in the caller's format; the data of the memo begins with them, little-endian.
    pub numbers: &'a [u64],
    /// The data after the numbers.
    pub data: &'a [u8],
    /// The objects that it names.
    pub objects: Box<dyn Iterator<Item = ObjectId> + 'a>,
}

impl<'a> From<&'a Memo> for MemoDraft<'a> {
    fn from(memo: &'a Memo) -> Self {
        let objects = Box::new(memo.objects.iter().copied());
        Self { note: &memo.note, numbers: &[], data: &memo.data, objects }
    }
}

fn place(mark: &Mark, key: &Key) -> (String, String) {
    let name = format!("{key}-{}", mark.name());
    (format!("{FOLDER}/{}", &name[..2]), name)
}

/// The key in the name of a memo.
pub(super) fn key_of(name: &str) -> Option<Key> {
    Key::from_hex(name.get(..64)?)
}

pub(super) fn read(disk: &Disk, mark: &Mark, key: &Key) -> Result<Option<Memo>, StoreError> {
    let (folder, name) = place(mark, key);
    match disk.folder(&folder).and_then(|folder| folder.read(&name, MOST)) {
        Ok(bytes) => Ok(unpack(mark, key, &bytes)),
        Err(error) if disk.lacks(&error) => Ok(None),
        Err(error) if Strange::is(&error) => Ok(None),
        Err(error) => Err(disk.fail("read", &disk.path(&folder, &name), error)),
    }
}

pub(super) fn write(disk: &Disk, mark: &Mark, key: &Key, memo: MemoDraft<'_>) -> Result<(), StoreError> {
    let (folder, name) = place(mark, key);
    disk.replace_in_parts(&folder, &name, |file| pack(mark, key, memo, &mut |bytes| file.add(bytes)))
}

/// Whether a file below the folder of memos is one that flow wrote: by its folder, its name and its first bytes.
pub(super) fn is_ours(at: &folder::Folder, shard: &str, name: &str) -> bool {
    // Earlier versions had no user in the name.
    let (key, user) = name.split_once('-').unwrap_or((name, "00000000"));
    let named = key.len() == 64 && is_hex(key) && user.len() == 8 && is_hex(user) && key.starts_with(shard);
    named && at.begins_with(name, HEAD)
}

/// Gives out the bytes of a memo in parts.
pub(super) fn pack(
    mark: &Mark,
    key: &Key,
    memo: MemoDraft<'_>,
    out: &mut dyn FnMut(&[u8]) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let MemoDraft { note, numbers, data, objects } = memo;
    let mut hash = mark.note_hasher(&key.0);
    let mut add = |bytes: &[u8]| {
        hash.update(bytes);
        out(bytes)
    };
    add(MAGIC)?;
    add(&(note.len() as u64).to_le_bytes())?;
    add(&((8 * numbers.len() + data.len()) as u64).to_le_bytes())?;
    add(note.as_bytes())?;
    for number in numbers {
        add(&number.to_le_bytes())?;
    }
    add(data)?;
    for object in objects {
        add(&object.content.0)?;
        add(&object.key.0)?;
    }
    out(hash.finalize().as_bytes())
}

pub(super) fn unpack(mark: &Mark, key: &Key, bytes: &[u8]) -> Option<Memo> {
    let (body, check) = bytes.split_last_chunk::<32>()?;
    if !mark::same(&mark.note(&key.0, body), check) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Store;

    /// The bytes of the table above, written in parts larger and smaller than a block, and what is read of them.
    #[test]
    fn a_memo_is_the_bytes_of_the_table_however_it_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let mark = Mark::of(&[1; 32]);
        let store = Store::open_as(folder.path(), mark.clone()).unwrap();
        let numbers: Vec<u64> = (0..20_000).map(|number| number << 33).collect();
        let objects: Vec<_> = (0..3000_u32)
            .map(|number| ObjectId { content: ContentHash([number as u8; 32]), key: Key([7; 32]) })
            .collect();
        let key = Key([9; 32]);
        let each = Box::new(objects.iter().copied());
        store.keep_memo(&key, MemoDraft { note: "σ", numbers: &numbers, data: &[1, 2, 3], objects: each }).unwrap();
        let mut body = b"flowmem3".to_vec();
        body.extend([2_u64, 160_003].iter().flat_map(|length| length.to_le_bytes()));
        body.extend("σ".as_bytes());
        body.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        body.extend([1, 2, 3]);
        body.extend(objects.iter().flat_map(|object| [object.content.0, object.key.0].concat()));
        let (shard, name) = place(&mark, &key);
        let written = std::fs::read(folder.path().join(shard).join(name)).unwrap();
        assert_eq!(written, [body.as_slice(), &mark.note(&key.0, &body)].concat());
        let memo = store.memo(&key).unwrap().unwrap();
        assert_eq!((memo.note.as_str(), memo.data.len(), memo.objects), ("σ", 160_003, objects));
    }
}
