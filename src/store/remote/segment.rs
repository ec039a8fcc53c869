//! The bytes of a segment: for each origin the head of a journal, the number of its records in eight bytes, and the records,
//! as in a journal but without marks. Its name is the blake3 of all of its bytes.

use crate::store::journal::{HEAD, RECORD, head, pack, read_head, unpack};
use crate::store::{Mark, Record};
use std::sync::Arc;

/// The segment of these records.
pub(super) fn write(mut records: Vec<Record>) -> Vec<u8> {
    records.sort_by(|a, b| (&a.origin, a.object()).cmp(&(&b.origin, b.object())));
    let mut bytes = Vec::with_capacity(records.len() * RECORD + HEAD + 8);
    for same in records.chunk_by(|a, b| a.origin == b.origin) {
        bytes.extend(head(&same[0].origin));
        bytes.extend((same.len() as u64).to_le_bytes());
        bytes.extend(same.iter().flat_map(|record| pack(&Record { mark: Default::default(), ..record.clone() })));
    }
    bytes
}

/// The records of a segment of this name; `None` when its bytes do not give its name or are not records.
pub(super) fn read(name: &str, bytes: &[u8]) -> Option<Vec<Record>> {
    if blake3::hash(bytes).to_hex().as_str() != name {
        return None;
    }
    // Without a mark: another user's record is never taken for an own one.
    let mark = Mark::of(&[0; 32]);
    let (mut records, mut rest) = (Vec::new(), bytes);
    while !rest.is_empty() {
        let (first, more) = rest.split_at_checked(HEAD)?;
        let (count, more) = more.split_first_chunk::<8>()?;
        let length = usize::try_from(u64::from_le_bytes(*count)).ok()?.checked_mul(RECORD)?;
        let (part, more) = more.split_at_checked(length)?;
        let origin = Arc::new(read_head(first).1);
        for record in part.as_chunks::<RECORD>().0 {
            records.push(unpack(&mark, record, &origin)?);
        }
        rest = more;
    }
    Some(records)
}
