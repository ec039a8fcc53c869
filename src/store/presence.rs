//! Which objects are on the disk, without asking for each of them.
//!
//! A few objects are looked up one by one. For many, the folders are listed, and the listing is stored in the file
//! `listing-…` under the user's mark: of each folder its state (inode, times of change), then the names found in it. A
//! folder whose state is still the same holds the same names, so ten thousand objects cost 256 look-ups. The time of
//! change of an inode cannot be set by hand, so it shows whatever is added, removed or restored. File times have a
//! resolution, so a folder that changed less than [`SETTLED`] before it was listed, by the clock of the file system itself,
//! is listed again. The file only saves time: when it is damaged, missing or another user's, the folders are listed.
//!
//! | bytes | field |
//! |---|---|
//! | 0–7 | `flowlst2` |
//! | … | per folder: inode, seconds and nanoseconds of its change, number n of names, all of 8 bytes; 16 bytes per name |
//! | last 32 | the mark |

use super::StoreError;
use super::disk::Disk;
use super::folder::Folder;
use super::mark::{self, Mark};
use super::object::{self, ObjectId, is_hex};
use crate::artifact::{FirstBytes, Key};
use rustix::fs::Stat;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::hash::BuildHasherDefault;
use std::ops::Range;

const MAGIC: &[u8; 8] = b"flowlst2";
/// The largest listing: one of ten million objects.
const MOST: u64 = 1 << 29;

/// Longer than the resolution of any file system's times, seconds.
const SETTLED: i64 = 2;

/// From this many look-ups on the folders are listed.
const LIST_FROM: usize = 500;

/// First bytes of content and key, which identify an object.
type Short = [u64; 2];

/// Which objects are known to be on the disk.
#[derive(Default)]
pub(super) struct Presence {
    asked: usize,
    listed: Option<Listed>,
    /// First bytes of the contents of a task's objects, by the first bytes of its key, as they were first listed.
    of_tasks: Option<HashMap<u64, Vec<u64>, BuildHasherDefault<FirstBytes>>>,
}

type Listed = HashSet<Short, BuildHasherDefault<FirstBytes>>;

impl Presence {
    /// Announces that `count` objects will be looked up.
    pub(super) fn expect(&mut self, disk: &Disk, mark: &Mark, count: usize) -> Result<(), StoreError> {
        self.asked += count;
        if self.asked >= LIST_FROM {
            self.listed(disk, mark)?;
        }
        Ok(())
    }

    fn listed(&mut self, disk: &Disk, mark: &Mark) -> Result<&mut Listed, StoreError> {
        let listed = match self.listed.take() {
            Some(listed) => listed,
            None => list(disk, mark)?,
        };
        Ok(self.listed.insert(listed))
    }

    /// Whether the object is there; call [`Presence::expect`] first. An object that another process added after the
    /// listing is found by looking up its file.
    pub(super) fn contains(&mut self, disk: &Disk, id: &ObjectId) -> bool {
        if self.listed.as_ref().is_some_and(|listed| listed.contains(&short(id))) {
            return true;
        }
        let found = object::is_there(disk, id);
        if found {
            self.add(id);
        }
        found
    }

    /// Names of the objects of a task that existed when this was first called for any task.
    pub(super) fn names_of_task(&mut self, disk: &Disk, mark: &Mark, key: &Key) -> Result<Vec<String>, StoreError> {
        if self.of_tasks.is_none() {
            let mut of_tasks: HashMap<u64, Vec<u64>, _> = HashMap::default();
            for &[content, key] in self.listed(disk, mark)?.iter() {
                of_tasks.entry(key).or_default().push(content);
            }
            self.of_tasks = Some(of_tasks);
        }
        let contents = self.of_tasks.as_ref().and_then(|tasks| tasks.get(&first_word(&key.0)));
        let mut shards: Vec<u8> = contents.into_iter().flatten().map(|content| content.to_be_bytes()[0]).collect();
        shards.sort_unstable();
        shards.dedup();
        Ok(shards.into_iter().flat_map(|shard| object::of_task(disk, shard, key)).collect())
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
    /// Inode, seconds and nanoseconds of its last change; `None` when that change is too recent.
    state: Option<[u64; 3]>,
    names: Cow<'a, [Short]>,
}

/// The content of an earlier listing: all names, and those of each folder whose state is still the same.
#[derive(Debug, Default, PartialEq)]
struct Known {
    names: Vec<Short>,
    folders: HashMap<[u64; 3], Range<usize>>,
}

/// Name of the listing of the user with this mark.
fn file_name(mark: &Mark) -> String {
    format!("listing-{}", mark.name())
}

/// Whether a name in the root is one of a listing.
pub(super) fn is_listing(name: &str) -> bool {
    name.strip_prefix("listing-").is_some_and(|user| user.len() == 8 && is_hex(user))
}

/// The objects of all folders; a new listing is stored for the next time.
fn list(disk: &Disk, mark: &Mark) -> Result<Listed, StoreError> {
    let Some((objects, names)) = object::shards(disk)? else { return Ok(Listed::default()) };
    let file = file_name(mark);
    let known = disk.folder("").and_then(|root| root.read(&file, MOST)).ok();
    let known = known.and_then(|bytes| unpack(mark, &bytes)).unwrap_or_default();
    let (mut shards, mut news, mut clock) = (Vec::new(), false, None);
    for name in names {
        let Ok(stat) = objects.stat_of(&name) else { continue };
        let old = known.folders.get(&state(&stat));
        let state = match old {
            Some(_) => Some(state(&stat)),
            // The time by the file system's own clock: that of a file made after the first folder was looked at.
            None => clock
                .get_or_insert_with(|| disk.draft("", 0o444).ok()?.file_time())
                .is_some_and(|now: i64| now - stat.st_ctime > SETTLED)
                .then(|| state(&stat)),
        };
        news |= old.is_none() && state.is_some();
        let names =
            old.map_or_else(|| Cow::from(short_names(&objects, &name)), |old| Cow::from(&known.names[old.clone()]));
        shards.push(Shard { state, names });
    }
    if news {
        // A store that cannot be written is listed each time.
        let _ = disk.replace("", &file, &pack(mark, &shards));
    }
    let mut listed = Listed::default();
    listed.reserve(shards.iter().map(|shard| shard.names.len()).sum());
    shards.iter().for_each(|shard| listed.extend(shard.names.iter()));
    Ok(listed)
}

/// The objects in a folder that are plain files as far as the file system tells.
fn short_names(objects: &Folder, shard: &str) -> Vec<Short> {
    let Ok(folder) = objects.inner(shard) else { return Vec::new() };
    object::names(&folder, shard).iter().filter_map(|name| short_of_name(name)).collect()
}

fn state(stat: &Stat) -> [u64; 3] {
    [stat.st_ino, stat.st_ctime as u64, stat.st_ctime_nsec]
}

fn pack(mark: &Mark, shards: &[Shard<'_>]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    for (state, names) in shards.iter().filter_map(|shard| Some((shard.state?, &shard.names))) {
        let words = state.into_iter().chain([names.len() as u64]).chain(names.iter().flatten().copied());
        words.for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
    }
    let check = mark.note(MAGIC, &bytes);
    bytes.extend_from_slice(&check);
    bytes
}

fn unpack(mark: &Mark, bytes: &[u8]) -> Option<Known> {
    let (body, check) = bytes.split_last_chunk::<32>()?;
    if !mark::same(&mark.note(MAGIC, body), check) {
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
        let mark = Mark::of(&[1; 32]);
        let bytes = pack(&mark, &shards);
        let folders = HashMap::from([([1, 2, 3], 0..2), ([9, 2, 3], 2..2)]);
        assert_eq!(unpack(&mark, &bytes), Some(Known { names: vec![[4, 5], [6, 7]], folders }));
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(unpack(&mark, &damaged), None);
            assert_eq!(unpack(&mark, &bytes[..place]), None);
        }
    }

    #[test]
    fn the_listing_of_another_user_says_nothing() {
        let shards = [Shard { state: Some([1, 2, 3]), names: vec![[4, 5]].into() }];
        assert_eq!(unpack(&Mark::of(&[2; 32]), &pack(&Mark::of(&[1; 32]), &shards)), None);
    }

    #[test]
    fn names_give_the_first_bytes_of_content_and_key() {
        let name = format!("{}{}-0123456789abcdef.h5", "00000000000000ff", "a".repeat(48));
        assert_eq!(short_of_name(&name), Some([0xff, 0x0123_4567_89ab_cdef]));
        assert_eq!(short_of_name(".writing-abc"), None);
    }
}
