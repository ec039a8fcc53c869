//! Read-through: results that an attached remote lists stand in for those that this store lacks.
//!
//! Attaching reads the segments of a remote, verifies their signatures, and notes which were accepted, under the user's mark
//! (`remote/attached-…`). From then on a task without a result here has the one that is listed, and its object is fetched,
//! proven and stored when it is first read. What is not what it should be is refused, reported, and computed again. What the
//! remote has got since is seen when it is attached again.

use super::mark::{self, Mark};
use super::remote::{self, Address, Place, RemoteError, Trust, Untaken};
use super::{Aside, Damage, ObjectId, Record, Store, StoreError, locked};
use crate::artifact::{ContentHash, Key};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::{Arc, Mutex};

/// The largest note that is read.
const MOST: u64 = 1 << 26;

/// What became of attaching a remote.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attachment {
    /// Results that it lists.
    pub results: usize,
    /// Segments that were refused, and why.
    pub refused: Vec<String>,
    /// Who signed what was accepted, and how many results each.
    pub signers: BTreeMap<String, usize>,
}

/// What is noted of an attached remote.
#[derive(Serialize, Deserialize)]
struct Note {
    address: String,
    endpoint: Option<String>,
    /// Names of the segments that were accepted.
    segments: Vec<String>,
}

/// The results of an attached remote.
pub(super) struct Attached {
    place: Arc<Place>,
    /// By task; none where two segments contradict each other, or an object was refused.
    by_key: HashMap<Key, Option<Record>>,
    by_content: HashMap<ContentHash, Vec<Key>>,
    fetched: usize,
}

fn file_name(mark: &Mark) -> String {
    format!("attached-{}", mark.name())
}

/// Whether a file of this name in the folder of remotes is one that flow writes.
pub(super) fn is_ours(name: &str) -> bool {
    let note = name.strip_prefix("attached-").is_some_and(|user| user.len() == 8 && super::object::is_hex(user));
    note || remote::is_segment(name)
}

impl Store {
    /// Attaches a remote in place of an earlier one: results of those who are trusted are read from it from now on.
    ///
    /// # Errors
    /// The remote cannot be read or the store cannot be written.
    pub fn attach(&self, address: &Address, trust: &Trust) -> Result<Attachment, RemoteError> {
        let place = Place::open(address)?;
        let mut attachment = Attachment::default();
        let mut segments = Vec::new();
        for name in &place.segments {
            let (bytes, records) = match self.segment(&place, name)? {
                Ok(read) => read,
                Err(why) => {
                    attachment.refused.push(why);
                    continue;
                }
            };
            match place.signer((name, &bytes, records.len()), trust)? {
                Ok(signer) => {
                    attachment.results += records.len();
                    *attachment.signers.entry(signer).or_default() += records.len();
                    segments.push(name.clone());
                }
                Err(why) => attachment.refused.push(why),
            }
        }
        let (address, endpoint) = address.parts();
        let note = Note { address, endpoint, segments };
        let text = serde_json::to_string(&note).unwrap_or_else(|error| panic!("BUG: a note of a remote: {error}"));
        let mark = blake3::Hash::from_bytes(self.mark.note(b"attached", text.as_bytes())).to_hex();
        self.detach()?;
        self.disk.write_new(remote::FOLDER, &file_name(&self.mark), format!("{mark}\n{text}").as_bytes(), false)?;
        Ok(attachment)
    }

    /// Detaches the remote and returns true if there was one. Results that were fetched stay in the store.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn detach(&self) -> Result<bool, StoreError> {
        let name = file_name(&self.mark);
        let there = self.disk.find_folder(remote::FOLDER)?.is_some_and(|folder| folder.entry(&name).is_ok());
        if there {
            self.disk.remove(remote::FOLDER, &name)?;
        }
        Ok(there)
    }

    /// How many results were fetched from the attached remote since the last call, and its address.
    pub fn take_fetched(&self) -> Option<(usize, String)> {
        let mut attached = locked(self.attached.get()?.as_ref()?);
        let count = std::mem::take(&mut attached.fetched);
        (count > 0).then(|| (count, attached.place.address.to_string()))
    }

    /// The record of a task that the attached remote lists.
    pub(super) fn listed(&self, key: &Key) -> Result<Option<Record>, StoreError> {
        let Some(attached) = self.attached()? else { return Ok(None) };
        Ok(locked(attached).by_key.get(key).cloned().flatten())
    }

    /// Whether the attached remote lists an object.
    pub(super) fn is_listed(&self, id: &ObjectId) -> Result<bool, StoreError> {
        Ok(self.listed(&id.key)?.is_some_and(|record| record.object() == *id))
    }

    /// Fetches an object with this content if the attached remote lists one. Returns true if the store has it now.
    pub(super) fn fetch(&self, content: &ContentHash) -> Result<bool, StoreError> {
        let Some(attached) = self.attached()? else { return Ok(false) };
        let (place, record) = {
            let attached = locked(attached);
            let keys = attached.by_content.get(content).into_iter().flatten();
            let record =
                keys.filter_map(|key| attached.by_key.get(key)?.clone()).find(|record| record.content == *content);
            (Arc::clone(&attached.place), record)
        };
        let Some(record) = record else { return Ok(false) };
        match self.take(&place, &record) {
            Ok(()) => {
                locked(attached).fetched += 1;
                Ok(true)
            }
            Err(Untaken::Refused(why)) => {
                locked(attached).by_key.insert(record.key, None);
                let id = record.object();
                let path = format!("{}/{}/{}", place.address, id.folder(), id.file_name());
                locked(&self.damages).push(Damage { path: path.into(), why, aside: Aside::NotTaken });
                Ok(false)
            }
            Err(Untaken::Remote(RemoteError::Store(error))) => Err(error),
            Err(Untaken::Remote(error)) => Err(StoreError::Far { why: error.to_string() }),
        }
    }

    /// The attached remote, read when it is first asked for. Its server is asked for nothing yet.
    fn attached(&self) -> Result<Option<&Mutex<Attached>>, StoreError> {
        if let Some(attached) = self.attached.get() {
            return Ok(attached.as_ref());
        }
        let read = self.read_attached()?.map(Mutex::new);
        Ok(self.attached.get_or_init(|| read).as_ref())
    }

    fn read_attached(&self) -> Result<Option<Attached>, StoreError> {
        // Into a store that is only read nothing can be fetched.
        if self.disk.read_only {
            return Ok(None);
        }
        let Some(folder) = self.disk.find_folder(remote::FOLDER)? else { return Ok(None) };
        // A note that cannot be read, or that somebody else has written, attaches nothing.
        let Ok(bytes) = folder.read(&file_name(&self.mark), MOST) else { return Ok(None) };
        let text = String::from_utf8(bytes).unwrap_or_default();
        let Some((mark, text)) = text.split_once('\n') else { return Ok(None) };
        let own = blake3::Hash::from_bytes(self.mark.note(b"attached", text.as_bytes())).to_hex();
        if !mark::same(mark.as_bytes(), own.as_bytes()) {
            return Ok(None);
        }
        let far = |why: String| StoreError::Far { why };
        let note: Note = serde_json::from_str(text).map_err(|error| far(error.to_string()))?;
        let address = Address::parse(&note.address, note.endpoint.as_deref()).map_err(far)?;
        let place = Place::known(&address).map_err(|error| far(error.to_string()))?;
        let mut by_key = HashMap::new();
        let mut by_content: HashMap<ContentHash, Vec<Key>> = HashMap::new();
        let mut twice = HashSet::new();
        for name in &note.segments {
            let (_, records) = self.segment(&place, name).map_err(|error| far(error.to_string()))?.map_err(far)?;
            for record in records {
                by_content.entry(record.content).or_default().push(record.key);
                let (key, content) = (record.key, record.content);
                if by_key.insert(key, Some(record)).flatten().is_some_and(|other: Record| other.content != content) {
                    twice.insert(key);
                }
            }
        }
        // Of two different results of one task none is believed.
        twice.into_iter().for_each(|key| drop(by_key.insert(key, None)));
        Ok(Some(Attached { place: Arc::new(place), by_key, by_content, fetched: 0 }))
    }
}
