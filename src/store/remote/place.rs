//! A remote that was found or made: its segments, their signatures, and the objects that they list.

use super::access::{MARKER, Remote, SEGMENTS, TEXT};
use super::address::Address;
use super::bucket::Bucket;
use super::folder::RemoteFolder;
use super::{RemoteError, Trust};
use crate::store::object::ObjectId;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A remote that was found or made.
pub(in crate::store) struct Place {
    pub(in crate::store) address: Address,
    remote: Box<dyn Remote>,
    /// Names of its segments, in order.
    pub(in crate::store) segments: Vec<String>,
    /// Those of them that are signed.
    signed: HashSet<String>,
}

impl Place {
    /// The remote at an address, with what it lists.
    pub(in crate::store) fn open(address: &Address) -> Result<Self, RemoteError> {
        let place = Self::known(address)?.listed()?;
        // What lists segments is a remote; only an empty bucket has to say so.
        if place.is_unmarked()? {
            let why = "nothing was pushed to it; `flow store push` makes a remote".to_owned();
            return Err(RemoteError::NotARemote { path: address.to_string(), why });
        }
        Ok(place)
    }

    /// The same, made when there is nothing yet.
    pub(super) fn make(address: &Address) -> Result<Self, RemoteError> {
        if let Address::Folder(path) = address {
            return Self::of(address, RemoteFolder::make(path)?).listed();
        }
        let place = Self::known(address)?.listed()?;
        if place.is_unmarked()? {
            place.remote.write("", MARKER, TEXT.as_bytes())?;
        }
        Ok(place)
    }

    /// The same, without what it lists: a server is asked for nothing.
    pub(in crate::store) fn known(address: &Address) -> Result<Self, RemoteError> {
        match address {
            Address::Folder(path) => Ok(Self::of(address, RemoteFolder::open(path)?)),
            Address::Bucket { .. } => Ok(Self::of(address, Bucket::of(address)?)),
        }
    }

    fn of(address: &Address, remote: impl Remote + 'static) -> Self {
        let (segments, signed) = (Vec::new(), HashSet::new());
        Self { address: address.clone(), remote: Box::new(remote), segments, signed }
    }

    fn listed(mut self) -> Result<Self, RemoteError> {
        for name in self.remote.list()? {
            match name.rsplit_once('.') {
                Some((hash, "segment")) if is_hash(hash) => self.segments.push(hash.to_owned()),
                Some((hash, "sig")) => drop(self.signed.insert(hash.to_owned())),
                _ => {}
            }
        }
        self.segments.sort_unstable();
        Ok(self)
    }

    /// Whether it is a bucket without segments and without the file that says what it is.
    fn is_unmarked(&self) -> Result<bool, RemoteError> {
        if !matches!(self.address, Address::Bucket { .. }) || !self.segments.is_empty() {
            return Ok(false);
        }
        match self.remote.read("", MARKER, 1 << 12)? {
            None => Ok(true),
            Some(text) if text.starts_with(b"flow remote 1\n") => Ok(false),
            Some(_) => {
                let why = "a newer flow made it".to_owned();
                Err(RemoteError::NotARemote { path: self.address.to_string(), why })
            }
        }
    }

    /// Who has signed a segment (its name, its bytes, the number of its results), or why it is refused.
    pub(in crate::store) fn signer(
        &self,
        (name, bytes, results): (&str, &[u8], usize),
        trust: &Trust,
    ) -> Result<Result<String, String>, RemoteError> {
        let signer = trust.signer(bytes, self.signature(name)?.as_deref());
        Ok(signer.map_err(|why| format!("segment {name:.12} ({results} results): {why}")))
    }

    pub(super) fn segment(&self, name: &str) -> Result<Vec<u8>, RemoteError> {
        Ok(self.remote.read(SEGMENTS, &format!("{name}.segment"), MOST_SEGMENT)?.unwrap_or_default())
    }

    pub(super) fn put_segment(&self, name: &str, bytes: &[u8]) -> Result<(), RemoteError> {
        self.remote.write(SEGMENTS, &format!("{name}.segment"), bytes).map(|_| ())
    }

    pub(super) fn signature(&self, name: &str) -> Result<Option<Vec<u8>>, RemoteError> {
        if !self.signed.contains(name) {
            return Ok(None);
        }
        self.remote.read(SEGMENTS, &format!("{name}.sig"), MOST_SIGNATURE)
    }

    pub(super) fn put_signature(&self, name: &str, bytes: &[u8]) -> Result<(), RemoteError> {
        self.remote.write(SEGMENTS, &format!("{name}.sig"), bytes).map(|_| ())
    }

    /// An object of this size; none when there is none, an empty one when it is larger or no plain file.
    pub(super) fn object(&self, id: &ObjectId, size: u64) -> Result<Option<Vec<u8>>, RemoteError> {
        self.remote.read(&id.folder(), &id.file_name(), size)
    }

    /// Writes an object and returns true, or false if the remote has it already.
    pub(super) fn put_object(&self, id: &ObjectId, bytes: &[u8]) -> Result<bool, RemoteError> {
        self.remote.write(&id.folder(), &id.file_name(), bytes)
    }

    /// Whether asking it takes long.
    pub(super) fn is_far(&self) -> bool {
        self.remote.at_once() > 1
    }

    /// Does something for each of these, several at once where the remote is far; results in the order of the items.
    ///
    /// # Errors
    /// The first error that was met; nothing more is begun after it.
    pub(super) fn each<T: Sync, R: Send, E: Send>(
        &self,
        items: &[T],
        does: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E> {
        let threads = self.remote.at_once().min(items.len());
        if threads <= 1 {
            return items.iter().map(does).collect();
        }
        let (next, ends) = (AtomicUsize::new(0), AtomicBool::new(false));
        let work = || {
            let mut done = Vec::new();
            while !ends.load(Ordering::Relaxed) {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(index) else { break };
                let result = does(item);
                ends.fetch_or(result.is_err(), Ordering::Relaxed);
                done.push((index, result));
            }
            done
        };
        let mut done: Vec<(usize, Result<R, E>)> = std::thread::scope(|scope| {
            // Where the system grants fewer threads, those that there are do it all, this one at the least.
            let spawned = (1..threads).map_while(|_| std::thread::Builder::new().spawn_scoped(scope, work).ok());
            let spawned: Vec<_> = spawned.collect();
            let mut done = work();
            let joined = spawned.into_iter().map(|thread| thread.join());
            done.extend(joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))));
            done
        });
        done.sort_unstable_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, result)| result).collect()
    }
}

/// The largest segment that is read: one of ten million records.
const MOST_SEGMENT: u64 = 1 << 31;
/// The largest signature that is read.
const MOST_SIGNATURE: u64 = 1 << 16;

/// Whether a name is the digits of a blake3.
fn is_hash(name: &str) -> bool {
    name.len() == 64 && crate::store::object::is_hex(name)
}
