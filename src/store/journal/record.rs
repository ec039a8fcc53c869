//! The bytes of a record.
//!
//! | bytes | field |
//! |---|---|
//! | 0–31 | key of the task |
//! | 32–63 | content hash of the result |
//! | 64–79 | first bytes of the blake3 of the object's file |
//! | 80–87 | size of the object's file, bytes |
//! | 88–95 | start of the task, milliseconds since 1970 UTC, for readers only |
//! | 96–103 | duration of the task, seconds, as a real number |
//! | 104–111 | first bytes of the blake3 of bytes 0–103 |
//! | 112–127 | the mark of the user who wrote it over bytes 0–103, see `mark.rs`; zeros for none |
//!
//! All numbers are little-endian.

use crate::artifact::{ContentHash, Key};
use crate::store::mark::{self, Mark, SHORT};
use crate::store::object::Seal;
use crate::store::{Origin, Record};
use std::sync::Arc;

/// Length of a record, bytes.
pub(in crate::store) const RECORD: usize = 128;
/// Offsets of the key and the content in a record.
pub(super) const KEY: usize = 0;
pub(super) const CONTENT: usize = 32;
/// The bytes under the checksum and the mark.
const BODY: usize = 104;

/// The bytes of a record.
pub(in crate::store) fn pack(record: &Record) -> [u8; RECORD] {
    let mut bytes = [0; RECORD];
    bytes[..32].copy_from_slice(&record.key.0);
    bytes[32..64].copy_from_slice(&record.content.0);
    bytes[64..80].copy_from_slice(&record.seal.digest);
    bytes[80..88].copy_from_slice(&record.seal.size.to_le_bytes());
    bytes[88..96].copy_from_slice(&record.started.to_le_bytes());
    bytes[96..104].copy_from_slice(&record.seconds.to_le_bytes());
    bytes[112..].copy_from_slice(&record.mark);
    check(bytes)
}

fn check(mut bytes: [u8; RECORD]) -> [u8; RECORD] {
    let check = blake3::hash(&bytes[..BODY]);
    bytes[BODY..112].copy_from_slice(&check.as_bytes()[..8]);
    bytes
}

/// The record with the user's mark.
pub(in crate::store) fn seal(mark: &Mark, record: Record) -> Record {
    let bytes = pack(&record);
    Record { mark: mark.record(&bytes[..BODY]), own: true, ..record }
}

/// The record of these bytes, when its checksum is right.
pub(in crate::store) fn unpack(mark: &Mark, bytes: &[u8; RECORD], origin: &Arc<Origin>) -> Option<Record> {
    let own = mark::same(&mark.record(&bytes[..BODY]), &bytes[112..]);
    if !own && blake3::hash(&bytes[..BODY]).as_bytes()[..8] != bytes[BODY..112] {
        return None;
    }
    let mut marked = [0; SHORT];
    marked.copy_from_slice(&bytes[112..]);
    let mut digest = [0; 16];
    digest.copy_from_slice(&bytes[64..80]);
    let seconds = f64::from_bits(word(bytes, 96));
    Some(Record {
        key: Key(hash(bytes, KEY)),
        content: ContentHash(hash(bytes, CONTENT)),
        seal: Seal { digest, size: word(bytes, 80) },
        started: word(bytes, 88) as i64,
        seconds: if seconds.is_finite() { seconds.max(0.0) } else { 0.0 },
        origin: origin.clone(),
        mark: marked,
        own,
    })
}

/// Converts a record of version 1, which had the whole digest, into one of this version without a mark. A damaged record
/// stays damaged.
pub(super) fn from_version_1(old: &[u8; RECORD]) -> [u8; RECORD] {
    let sound = blake3::hash(&old[..120]).as_bytes()[..8] == old[120..];
    let mut bytes = [0; RECORD];
    bytes[..80].copy_from_slice(&old[..80]);
    bytes[80..104].copy_from_slice(&old[96..120]);
    if sound { check(bytes) } else { bytes }
}

fn hash(bytes: &[u8], from: usize) -> [u8; 32] {
    let mut hash = [0; 32];
    hash.copy_from_slice(&bytes[from..from + 32]);
    hash
}

/// The number in the eight bytes from `place` on.
pub(super) fn word(bytes: &[u8], place: usize) -> u64 {
    bytes[place..].first_chunk().map_or(0, |word| u64::from_le_bytes(*word))
}
