//! A copy of a remote, with its signatures: the signers stay who they were.

use super::address::Address;
use super::place::Place;
use super::{RemoteError, segment};
use crate::store::Record;
use crate::store::object::Seal;
use std::collections::HashSet;

/// What became of a mirror.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mirrored {
    /// Segments that were copied.
    pub segments: usize,
    /// Objects that were copied.
    pub objects: usize,
}

/// Copies what one remote lists and the other does not, signatures with it, so that the signers stay who they were.
///
/// # Errors
/// One of them cannot be read or written, or holds something else than it lists.
pub fn mirror(from: &Address, to: &Address) -> Result<Mirrored, RemoteError> {
    let (from, to) = (Place::open(from)?, Place::make(to)?);
    let known: HashSet<&String> = to.segments.iter().collect();
    let mut mirrored = Mirrored::default();
    let damaged = |name: &str, why: &str| RemoteError::Damaged { name: name.to_owned(), why: why.to_owned() };
    let copy = |record: &Record| {
        let id = record.object();
        let image = from.object(&id, record.seal.size)?;
        let image = image.ok_or_else(|| damaged(&id.file_name(), "it is not there"))?;
        match record.seal.difference(&Seal::of(&image)) {
            Some(why) => Err(damaged(&id.file_name(), &why)),
            None => to.put_object(&id, &image),
        }
    };
    for name in from.segments.iter().filter(|name| !known.contains(name)) {
        let bytes = from.segment(name)?;
        let records = segment::read(name, &bytes).ok_or_else(|| damaged(name, "it is not what its name says"))?;
        let far = if to.is_far() { &to } else { &from };
        mirrored.objects += far.each(&records, copy)?.into_iter().filter(|new| *new).count();
        if let Some(signature) = from.signature(name)? {
            to.put_signature(name, &signature)?;
        }
        to.put_segment(name, &bytes)?;
        mirrored.segments += 1;
    }
    Ok(mirrored)
}
