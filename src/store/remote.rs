//! Remotes: folders through which users share results. A remote holds objects and lists of them, and nothing in it is
//! believed unchecked.
//!
//! ```text
//! REMOTE/flow.remote                 says that flow made this folder
//! REMOTE/objects/ab/abcd….h5         the objects of stores, byte by byte
//! REMOTE/segments/HASH.segment       an immutable list of records, named by its own blake3        segment.rs
//! REMOTE/segments/HASH.sig           who pushed it: an SSH signature of it                         sign.rs
//! ```
//!
//! **Pushing** writes the objects that no segment lists, then one segment: an interrupted push leaves objects that no segment
//! lists. Nothing is replaced or deleted. **Pulling** lists the segments alone, never the objects.
//!
//! **What is checked, in this order**: the segment against its name; its signature against those whom the user allows; the
//! object's size and digest against its record, before a byte of it is decoded; its values and the text of its task against
//! content hash and key. So an object proves which task and which values it holds. That the task gives these values is the
//! signer's claim; `flow store audit` computes some of them again, and equal bits prove it.

mod place;
mod segment;
mod sign;

pub use sign::{Signing, Trust};

use super::object::{self, Seal};
use super::record::moment;
use super::{ObjectId, Record, Store, StoreError, Timing, locked};
use super::{finish, prove};
use crate::artifact::Key;
use place::Place;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// The largest segment that is read: one of ten million records.
const MOST_SEGMENT: u64 = 1 << 31;

/// The outcome of a push.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pushed {
    /// Results that were copied and listed.
    pub pushed: usize,
    /// Results that the remote lists already.
    pub there: usize,
    /// The new segment; `None` when nothing was new.
    pub segment: Option<String>,
}

/// The outcome of a pull.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pulled {
    /// Results that are new here.
    pub pulled: usize,
    /// Results that were here before.
    pub here: usize,
    /// The segments and results that were refused, each with the reason.
    pub refused: Vec<String>,
    /// The signers of the results that were taken, and the number of results of each.
    pub signers: BTreeMap<String, usize>,
}

/// The outcome of a mirror.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mirrored {
    /// Segments that were copied.
    pub segments: usize,
    /// Objects that were copied.
    pub objects: usize,
}

/// Errors of a remote as a whole.
#[derive(Debug, thiserror::Error)]
pub enum RemoteError {
    /// The remote or the store cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The folder is something else.
    #[error("{path} is not a remote of flow: {why}")]
    NotARemote {
        /// The folder.
        path: String,
        /// What stands in the way.
        why: String,
    },
    /// Signing failed.
    #[error("the push cannot be signed: {0}")]
    Signing(String),
    /// A file of the remote is damaged.
    #[error("{name} of the remote is damaged: {why}; nothing more was copied")]
    Damaged {
        /// The file.
        name: String,
        /// How it differs.
        why: String,
    },
}

impl Store {
    /// Copies all sound results that the remote at `path` does not list, and lists them in one signed segment.
    ///
    /// # Errors
    /// The remote cannot be written, or the segment cannot be signed.
    pub fn push(&self, path: &Path, signing: &Signing) -> Result<Pushed, RemoteError> {
        let remote = Place::make(path)?;
        let mut listed: HashSet<ObjectId> = HashSet::new();
        for name in remote.segments()? {
            let bytes = remote.segment(&name)?;
            listed.extend(segment::read(&name, &bytes).into_iter().flatten().map(|record| record.object()));
        }
        let mut pushed = Pushed::default();
        let mut new = Vec::new();
        for record in self.records()? {
            let id = record.object();
            if listed.contains(&id) {
                pushed.there += 1;
                continue;
            }
            // Another user's record does not prove the file, and a damaged object is not passed on.
            let Some(record) = self.find(&record.key)?.filter(|found| found.object() == id) else { continue };
            let Ok(image) = prove::image_of(&self.disk, &id, Some(&record.seal)) else { continue };
            remote.put(&id.folder(), &id.file_name(), &image)?;
            new.push(record);
        }
        if !new.is_empty() {
            let bytes = segment::write(new.clone());
            let name = blake3::hash(&bytes).to_hex().to_string();
            let signature = signing.sign(&bytes).map_err(RemoteError::Signing)?;
            // The signature first, so that no reader finds the segment unsigned.
            if let Some(signature) = signature {
                remote.put_signature(&name, &signature)?;
            }
            remote.put_segment(&name, &bytes)?;
            pushed.segment = Some(name);
        }
        pushed.pushed = new.len();
        Ok(pushed)
    }

    /// Takes the results that the remote at `path` lists and this store lacks, if their signers are trusted.
    ///
    /// # Errors
    /// The remote cannot be read or the store cannot be written.
    pub fn pull(&self, path: &Path, trust: &Trust) -> Result<Pulled, RemoteError> {
        let remote = Place::open(path)?;
        let mut pulled = Pulled::default();
        // The contents that this store has of each task, to find contradictions.
        let mut here: HashMap<Key, ObjectId> = HashMap::new();
        for record in self.records()? {
            if object::is_there(&self.disk, &record.object()) {
                here.insert(record.key, record.object());
            }
        }
        for name in remote.segments()? {
            let short = &name[..name.len().min(12)];
            let bytes = remote.segment(&name)?;
            let Some(records) = segment::read(&name, &bytes) else {
                pulled.refused.push(format!("segment {short} is not what its name says: damaged, or not by flow"));
                continue;
            };
            let signer = match trust.signer(&bytes, remote.signature(&name)?.as_deref()) {
                Ok(signer) => signer,
                Err(why) => {
                    pulled.refused.push(format!("segment {short} ({} results): {why}", records.len()));
                    continue;
                }
            };
            for record in records {
                match self.take(&remote, &record, &here) {
                    Ok(true) => {
                        here.insert(record.key, record.object());
                        pulled.pulled += 1;
                        *pulled.signers.entry(signer.clone()).or_default() += 1;
                    }
                    Ok(false) => pulled.here += 1,
                    Err(Untaken::Refused(why)) => {
                        pulled.refused.push(format!("task {:.16}: {why}", record.key.to_string()))
                    }
                    Err(Untaken::Store(error)) => return Err(error.into()),
                }
            }
        }
        Ok(pulled)
    }

    /// Takes one result, unless it is here.
    fn take(&self, remote: &Place, record: &Record, here: &HashMap<Key, ObjectId>) -> Result<bool, Untaken> {
        let id = record.object();
        match here.get(&record.key) {
            Some(known) if *known == id => return Ok(false),
            Some(known) => {
                return Err(Untaken::Refused(format!(
                    "its result there ({:.16}) is not the one here ({:.16}): one of the two is wrong; `flow store audit` \
                     computes it again",
                    id.content.to_string(),
                    known.content.to_string()
                )));
            }
            None => {}
        }
        let refused = |why: String| Untaken::Refused(why);
        let image = remote.object(&id, record.seal.size).map_err(Untaken::Store)?;
        let image = image.ok_or_else(|| refused("its object is not there".to_owned()))?;
        if let Some(why) = record.seal.difference(&Seal::of(&image)) {
            // A larger file, a link, a pipe and a device are not read.
            let why = if image.is_empty() { "it is no plain file of the recorded size".to_owned() } else { why };
            return Err(refused(format!("{why}; it is computed again when it is needed")));
        }
        prove::bytes(&id, image.clone()).map_err(refused)?;
        let seal = finish::write(&self.disk, &id, &image, false, None).map_err(Untaken::Store)?;
        let timing = Timing { started: moment(record.started), seconds: record.seconds };
        let own = self.marked(&id, seal, &timing, Arc::clone(&record.origin));
        locked(&self.segments).append(&self.disk, &own, false).map_err(Untaken::Store)?;
        if let Some(index) = self.index.get() {
            locked(index).add(&own);
        }
        locked(&self.presence).add(&id);
        Ok(true)
    }
}

/// Why a result was not taken.
enum Untaken {
    Refused(String),
    Store(StoreError),
}

/// Copies the segments and objects that one remote lists and the other does not, with their signatures, so that the signers
/// stay the same.
///
/// # Errors
/// One of them cannot be read or written, or holds other objects than it lists.
pub fn mirror(from: &Path, to: &Path) -> Result<Mirrored, RemoteError> {
    let (from, to) = (Place::open(from)?, Place::make(to)?);
    let known: HashSet<String> = to.segments()?.into_iter().collect();
    let mut mirrored = Mirrored::default();
    for name in from.segments()?.into_iter().filter(|name| !known.contains(name)) {
        let damaged = |name: &str, why: &str| RemoteError::Damaged { name: name.to_owned(), why: why.to_owned() };
        let bytes = from.segment(&name)?;
        let records = segment::read(&name, &bytes).ok_or_else(|| damaged(&name, "it is not what its name says"))?;
        for record in records {
            let id = record.object();
            let image = from.object(&id, record.seal.size)?;
            let image = image.ok_or_else(|| damaged(&id.file_name(), "it is not there"))?;
            if let Some(why) = record.seal.difference(&Seal::of(&image)) {
                return Err(damaged(&id.file_name(), &why));
            }
            mirrored.objects += usize::from(to.put(&id.folder(), &id.file_name(), &image)?);
        }
        if let Some(signature) = from.signature(&name)? {
            to.put_signature(&name, &signature)?;
        }
        to.put_segment(&name, &bytes)?;
        mirrored.segments += 1;
    }
    Ok(mirrored)
}

#[cfg(test)]
mod tests;
