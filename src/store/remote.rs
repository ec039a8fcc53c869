//! Results on their way to others: a remote holds objects and lists of them, and nothing in it is believed unseen.
//!
//! ```text
//! REMOTE/flow.remote                 says that flow made this folder
//! REMOTE/objects/ab/abcd….h5         the objects of stores, byte by byte
//! REMOTE/segments/HASH.segment       an immutable list of records, named by its own blake3        segment.rs
//! REMOTE/segments/HASH.sig           who pushed it: an SSH signature of it                         sign.rs
//! ```
//!
//! **Pushing** writes the objects that no segment lists, then one segment: a push that is torn leaves objects that nobody
//! looks at. Nothing is replaced or deleted. **Pulling** lists the segments alone, never the objects.
//!
//! **What is checked, in this order**: the segment against its name; its signature against those whom the user allows; the
//! object's size and digest against its record, before a byte of it is decoded; its values and the text of its task against
//! content hash and key. So an object proves what it is; that its values are what the task gives is the word of the signer,
//! and `flow store audit` computes some of them again, which equal bits make a proof.

mod access;
mod address;
mod bucket;
mod credentials;
mod folder;
mod mirror;
mod place;
mod segment;
mod sign;

pub use address::Address;
pub use mirror::{Mirrored, mirror};

pub use sign::{Signing, Trust};

use super::object::{self, Seal};
use super::record::moment;
use super::{ObjectId, Record, Store, StoreError, Timing, locked};
use super::{finish, prove};
use crate::artifact::Key;
pub(super) use place::Place;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Folder of a store for the segments of far remotes that were read: they never change, so they are read once.
pub(super) const FOLDER: &str = "remote";
/// The largest of them.
const MOST_SEGMENT: u64 = 1 << 31;

/// Whether a file of this name in that folder is a segment.
pub(super) fn is_segment(name: &str) -> bool {
    name.strip_suffix(".segment").is_some_and(|hash| hash.len() == 64 && object::is_hex(hash))
}

/// What became of a push.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pushed {
    /// Results that were copied and listed.
    pub pushed: usize,
    /// Results that the remote lists already.
    pub there: usize,
    /// The new segment; none when nothing was new.
    pub segment: Option<String>,
}

/// What became of a pull.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pulled {
    /// Results that are new here.
    pub pulled: usize,
    /// Results that were here.
    pub here: usize,
    /// What was refused, and why.
    pub refused: Vec<String>,
    /// Who signed what was taken, and how many results each.
    pub signers: BTreeMap<String, usize>,
}

/// What can go wrong with a remote as a whole.
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
    /// The server of a bucket cannot be reached, or refuses.
    #[error("{remote}: {why}")]
    Server {
        /// The remote.
        remote: String,
        /// What the server says, or why it cannot be asked.
        why: String,
    },
    /// Signing failed.
    #[error("the push cannot be signed: {0}")]
    Signing(String),
    /// What a mirror copies is not what it should be.
    #[error("{name} of the remote is damaged: {why}; nothing more was copied")]
    Damaged {
        /// The file.
        name: String,
        /// How it differs.
        why: String,
    },
}

impl Store {
    /// Copies all sound results that the remote does not list, and lists them in one signed segment.
    ///
    /// # Errors
    /// The remote cannot be written, or the segment cannot be signed.
    pub fn push(&self, address: &Address, signing: &Signing) -> Result<Pushed, RemoteError> {
        let remote = Place::make(address)?;
        let mut there: HashSet<ObjectId> = HashSet::new();
        for name in &remote.segments {
            // A damaged one lists nothing.
            let records = self.segment(&remote, name)?.map(|(_, records)| records).unwrap_or_default();
            there.extend(records.iter().map(Record::object));
        }
        let (old, wanted): (Vec<Record>, Vec<Record>) =
            self.records()?.into_iter().partition(|record| there.contains(&record.object()));
        let given = remote.each(&wanted, |record| self.give(&remote, record))?;
        let new: Vec<Record> = given.into_iter().flatten().collect();
        let mut pushed = Pushed { pushed: new.len(), there: old.len(), segment: None };
        if !new.is_empty() {
            let bytes = segment::write(new);
            let name = blake3::hash(&bytes).to_hex().to_string();
            let signature = signing.sign(&bytes).map_err(RemoteError::Signing)?;
            // The signature first: nobody sees a segment that is to be signed and is not.
            if let Some(signature) = signature {
                remote.put_signature(&name, &signature)?;
            }
            remote.put_segment(&name, &bytes)?;
            self.remember_segment(&remote, &name, &bytes);
            pushed.segment = Some(name);
        }
        Ok(pushed)
    }

    /// Copies the object of a record to a remote; the record to list, or none when the object is not sound.
    fn give(&self, remote: &Place, record: &Record) -> Result<Option<Record>, RemoteError> {
        let id = record.object();
        // A record of somebody else says nothing about the file, and a damaged object is not passed on.
        let Some(record) = self.find(&record.key)?.filter(|found| found.object() == id) else { return Ok(None) };
        let Ok(image) = prove::image_of(&self.disk, &id, Some(&record.seal)) else { return Ok(None) };
        remote.put_object(&id, &image)?;
        Ok(Some(record))
    }

    /// Takes the results that the remote lists and this store has not, from those who are trusted.
    ///
    /// # Errors
    /// The remote cannot be read or the store cannot be written.
    pub fn pull(&self, address: &Address, trust: &Trust) -> Result<Pulled, RemoteError> {
        let remote = Place::open(address)?;
        let mut pulled = Pulled::default();
        // Which contents this store has of each task, to see contradictions.
        let mut here: HashMap<Key, ObjectId> = HashMap::new();
        for record in self.records()? {
            if object::is_there(&self.disk, &record.object()) {
                here.insert(record.key, record.object());
            }
        }
        for name in &remote.segments {
            let (bytes, records) = match self.segment(&remote, name)? {
                Ok(read) => read,
                Err(why) => {
                    pulled.refused.push(why);
                    continue;
                }
            };
            let all = records.len();
            let wanted: Vec<Record> =
                records.into_iter().filter(|record| here.get(&record.key) != Some(&record.object())).collect();
            pulled.here += all - wanted.len();
            // Nobody asks who has signed what is here already.
            if wanted.is_empty() {
                continue;
            }
            match remote.signer((name, &bytes, all), trust)? {
                Ok(signer) => self.take_all(&remote, wanted, &signer, &mut here, &mut pulled)?,
                Err(why) => pulled.refused.push(why),
            }
        }
        Ok(pulled)
    }

    /// Takes the results of one segment.
    fn take_all(
        &self,
        remote: &Place,
        wanted: Vec<Record>,
        signer: &str,
        here: &mut HashMap<Key, ObjectId>,
        pulled: &mut Pulled,
    ) -> Result<(), RemoteError> {
        let mut taken = Vec::with_capacity(wanted.len());
        let refused = |record: &Record, why: String| format!("task {:.16}: {why}", record.key.to_string());
        for record in wanted {
            match here.get(&record.key).copied() {
                Some(known) if known == record.object() => pulled.here += 1,
                Some(known) => pulled.refused.push(refused(&record, contradiction(&record, &known))),
                None => {
                    here.insert(record.key, record.object());
                    taken.push(record);
                }
            }
        }
        let take = |record: &Record| match self.take(remote, record) {
            Ok(()) => Ok(None),
            Err(Untaken::Refused(why)) => Ok(Some(why)),
            Err(Untaken::Remote(error)) => Err(error),
        };
        for (record, why) in taken.iter().zip(remote.each(&taken, take)?) {
            if let Some(why) = why {
                here.remove(&record.key);
                pulled.refused.push(refused(record, why));
                continue;
            }
            pulled.pulled += 1;
            *pulled.signers.entry(signer.to_owned()).or_default() += 1;
        }
        Ok(())
    }

    /// Takes one result that is not here.
    pub(super) fn take(&self, remote: &Place, record: &Record) -> Result<(), Untaken> {
        let id = record.object();
        let refused = |why: String| Untaken::Refused(why);
        let image = remote.object(&id, record.seal.size).map_err(Untaken::Remote)?;
        let image = image.ok_or_else(|| refused("its object is not there".to_owned()))?;
        if let Some(why) = record.seal.difference(&Seal::of(&image)) {
            // Nothing was read of what is larger, a link, a pipe or a device.
            let why = if image.is_empty() { "it is no plain file of the recorded size".to_owned() } else { why };
            return Err(refused(format!("{why}; it is computed again when it is needed")));
        }
        prove::bytes(&id, image.clone()).map_err(refused)?;
        let own = |error: StoreError| Untaken::Remote(error.into());
        let seal = finish::write(&self.disk, &id, &image, false, None).map_err(own)?;
        let timing = Timing { started: moment(record.started), seconds: record.seconds };
        let record = self.marked(&id, seal, &timing, Arc::clone(&record.origin));
        locked(&self.segments).append(&self.disk, &record, false).map_err(own)?;
        if let Some(index) = self.index.get() {
            locked(index).add(&record);
        }
        locked(&self.presence).add(&id);
        Ok(())
    }

    /// The bytes of a segment and its records, or what is wrong with it; that of a far remote is stored when it is first read.
    pub(super) fn segment(&self, remote: &Place, name: &str) -> Result<Result<Segment, String>, RemoteError> {
        let known = self.disk.find_folder(FOLDER)?;
        let known = known.and_then(|folder| folder.read(&format!("{name}.segment"), MOST_SEGMENT).ok());
        if let Some(bytes) = known
            && let Some(records) = segment::read(name, &bytes)
        {
            return Ok(Ok((bytes, records)));
        }
        let bytes = remote.segment(name)?;
        let Some(records) = segment::read(name, &bytes) else {
            return Ok(Err(format!("segment {name:.12} is not what its name says: damaged, or not by flow")));
        };
        self.remember_segment(remote, name, &bytes);
        Ok(Ok((bytes, records)))
    }

    fn remember_segment(&self, remote: &Place, name: &str, bytes: &[u8]) {
        if remote.is_far() {
            // Without it, it is read from the remote again.
            let _ = self.disk.write_new(FOLDER, &format!("{name}.segment"), bytes, false);
        }
    }
}

/// Bytes and records.
type Segment = (Vec<u8>, Vec<Record>);

fn contradiction(record: &Record, known: &ObjectId) -> String {
    format!(
        "its result there ({:.16}) is not the one here ({:.16}): one of the two is wrong; `flow store audit` computes it \
         again",
        record.content.to_string(),
        known.content.to_string()
    )
}

/// Why a result was not taken.
pub(super) enum Untaken {
    /// It is not what it should be; how.
    Refused(String),
    /// The remote or the store cannot be read or written.
    Remote(RemoteError),
}

#[cfg(test)]
mod tests;
