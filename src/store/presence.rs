//! Which objects are on the disk, without asking for each of them.
//!
//! A few objects are asked for one by one. When many are, the folders are listed, and the listing is kept in the file
//! `listing`: of each folder its state (inode, times of change), then the names found in it. A folder whose state is
//! still the same holds the same names, so ten thousand objects cost 256 questions. The time of change of an inode cannot
//! be set by hand: whatever is added, removed or restored shows. Times move in steps, so what changed less than
//! [`SETTLED`] before it was listed is listed again. The file is a short cut: damaged or missing, the folders are listed.
//!
//! | bytes | field |
//! |---|---|
//! | 0–7 | `flowlst1` |
//! | … | per folder: inode, seconds and nanoseconds of its change, number n of names, all of 8 bytes; 16 bytes per name |
//! | last 32 | blake3 of all before |

use super::StoreError;
use super::disk::Disk;
use super::object::{self, ObjectId};
use crate::artifact::FirstBytes;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fs;
use std::hash::BuildHasherDefault;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, SystemTime};

const MAGIC: &[u8; 8] = b"flowlst1";

/// Longer than the step of any file system's times.
const SETTLED: Duration = Duration::from_secs(2);

/// From this many questions on the folders are listed.
const LIST_FROM: usize = 500;

/// First bytes of content and key, which tell all objects apart.
type Short = [u64; 2];

/// What is known about the objects on the disk.
#[derive(Default)]
pub(super) struct Presence {
    asked: usize,
    listed: Option<Listed>,
}

type Listed = HashSet<Short, BuildHasherDefault<FirstBytes>>;

impl Presence {
    /// Announces that `count` objects will be asked for.
    pub(super) fn expect(&mut self, disk: &Disk, count: usize) -> Result<(), StoreError> {
        self.asked += count;
        if self.asked < LIST_FROM || self.listed.is_some() {
            return Ok(());
        }
        self.listed = Some(list(disk)?);
        Ok(())
    }

    /// Whether the object is there; call [`Presence::expect`] first. Objects of other processes that came after the
    /// listing are found by asking for the very file.
    pub(super) fn contains(&mut self, disk: &Disk, id: &ObjectId) -> bool {
        if self.listed.as_ref().is_some_and(|listed| listed.contains(&short(id))) {
            return true;
        }
        let found = fs::metadata(object::path(disk, id)).is_ok_and(|metadata| metadata.is_file());
        if found {
            self.add(id);
        }
        found
    }

    pub(super) fn add(&mut self, id: &ObjectId) {
        if let Some(listed) = &mut self.listed {
            listed.insert(short(id));
        }
    }

    pub(super) fn remove(&mut self, id: &ObjectId) {
        if let Some(listed) = &mut self.listed {
            listed.remove(&short(id));
        }
    }
}

/// A folder of objects as it was listed.
struct Shard<'a> {
    /// Inode, seconds and nanoseconds of its last change; nothing when they say nothing.
    state: Option<[u64; 3]>,
    names: Cow<'a, [Short]>,
}

/// What an earlier listing says: all names, and which of them each folder holds that is still in the same state.
#[derive(Debug, Default, PartialEq)]
struct Known {
    names: Vec<Short>,
    folders: HashMap<[u64; 3], Range<usize>>,
}

/// The objects of all folders; what is new in the listing is kept for the next time.
fn list(disk: &Disk) -> Result<Listed, StoreError> {
    let file = disk.root.join("listing");
    let known = fs::read(&file).ok().and_then(|bytes| unpack(&bytes)).unwrap_or_default();
    let (mut shards, mut news) = (Vec::new(), false);
    for folder in object::shards(disk)? {
        let state = state(&folder);
        let old = state.and_then(|state| known.folders.get(&state));
        news |= old.is_none() && state.is_some();
        let names = old.map_or_else(|| Cow::from(names(&folder)), |old| Cow::from(&known.names[old.clone()]));
        shards.push(Shard { state, names });
    }
    if news {
        // A store that cannot be written is listed each time.
        let _ = disk.replace(&file, &pack(&shards));
    }
    let mut listed = Listed::default();
    listed.reserve(shards.iter().map(|shard| shard.names.len()).sum());
    shards.iter().for_each(|shard| listed.extend(shard.names.iter()));
    Ok(listed)
}

fn names(folder: &Path) -> Vec<Short> {
    let mut names = Vec::new();
    object::list_shard(folder, |name| names.extend(short_of_name(name)));
    names
}

/// The state of a folder, unless it changed so lately that it may change again without showing it.
#[cfg(unix)]
fn state(folder: &Path) -> Option<[u64; 3]> {
    use std::os::unix::fs::MetadataExt;
    let data = fs::metadata(folder).ok()?;
    let (seconds, nanoseconds) = (u64::try_from(data.ctime()).ok()?, u32::try_from(data.ctime_nsec()).ok()?);
    let changed = SystemTime::UNIX_EPOCH + Duration::new(seconds, nanoseconds);
    let settled = SystemTime::now().duration_since(changed).is_ok_and(|age| age > SETTLED);
    settled.then_some([data.ino(), seconds, u64::from(nanoseconds)])
}

#[cfg(not(unix))]
fn state(_: &Path) -> Option<[u64; 3]> {
    None
}

fn pack(shards: &[Shard<'_>]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    for (state, names) in shards.iter().filter_map(|shard| Some((shard.state?, &shard.names))) {
        let words = state.into_iter().chain([names.len() as u64]).chain(names.iter().flatten().copied());
        words.for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
    }
    bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
    bytes
}

fn unpack(bytes: &[u8]) -> Option<Known> {
    let (body, check) = bytes.split_last_chunk::<32>()?;
    if blake3::hash(body).as_bytes() != check {
        return None;
    }
    let (words, []) = body.strip_prefix(MAGIC)?.as_chunks::<8>() else { return None };
    let mut words = words.iter().map(|word| u64::from_le_bytes(*word));
    let mut known = Known { names: Vec::with_capacity(bytes.len() / size_of::<Short>()), folders: HashMap::new() };
    while let Some(inode) = words.next() {
        let state = [inode, words.next()?, words.next()?];
        let count = usize::try_from(words.next()?).ok()?;
        let first = known.names.len();
        for _ in 0..count {
            known.names.push([words.next()?, words.next()?]);
        }
        known.folders.insert(state, first..first + count);
    }
    Some(known)
}

fn short(id: &ObjectId) -> Short {
    [first_word(&id.content.0), first_word(&id.key.0)]
}

/// The first bytes of a hash, as names show them.
pub(super) fn first_word(hash: &[u8; 32]) -> u64 {
    hash.iter().take(8).fold(0, |word, &byte| word << 8 | u64::from(byte))
}

/// First bytes of content and key, from the name of a file.
pub(super) fn short_of_name(name: &str) -> Option<Short> {
    let (content, key) = (name.get(..16)?, name.get(65..81)?);
    if name.len() != 84 {
        return None;
    }
    Some([u64::from_str_radix(content, 16).ok()?, u64::from_str_radix(key, 16).ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_listing_is_read_as_it_was_written_or_not_at_all() {
        let shards = [
            Shard { state: Some([1, 2, 3]), names: vec![[4, 5], [6, 7]].into() },
            Shard { state: None, names: vec![[8, 9]].into() },
            Shard { state: Some([9, 2, 3]), names: Vec::new().into() },
        ];
        let bytes = pack(&shards);
        let folders = HashMap::from([([1, 2, 3], 0..2), ([9, 2, 3], 2..2)]);
        assert_eq!(unpack(&bytes), Some(Known { names: vec![[4, 5], [6, 7]], folders }));
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(unpack(&damaged), None);
            assert_eq!(unpack(&bytes[..place]), None);
        }
    }

    #[test]
    fn names_give_the_first_bytes_of_content_and_key() {
        let name = format!("{}{}-0123456789abcdef.h5", "00000000000000ff", "a".repeat(48));
        assert_eq!(short_of_name(&name), Some([0xff, 0x0123_4567_89ab_cdef]));
        assert_eq!(short_of_name(".writing-abc"), None);
    }
}
