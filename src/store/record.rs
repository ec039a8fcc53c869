//! The record of a finished task.

use super::mark;
use super::object::Seal;
use super::{ObjectId, Origin};
use crate::artifact::{ContentHash, Key};
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// A line of the journal: a finished task and its result.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The task.
    pub key: Key,
    /// Its result.
    pub content: ContentHash,
    /// Start of the task, milliseconds since 1970 UTC.
    pub started: i64,
    /// Duration of the task, seconds.
    pub seconds: f64,
    /// Machine, version and commit that computed it.
    pub origin: Arc<Origin>,
    pub(super) seal: Seal,
    /// The mark of the user who wrote it.
    pub(super) mark: [u8; mark::SHORT],
    /// Whether this user wrote it.
    pub(super) own: bool,
}

impl Record {
    /// The object that holds the result.
    pub fn object(&self) -> ObjectId {
        ObjectId { content: self.content, key: self.key }
    }

    /// Size of the object's file, bytes.
    pub fn bytes(&self) -> u64 {
        self.seal.size
    }
}

/// When a task ran.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Its start.
    pub started: SystemTime,
    /// Its duration, seconds.
    pub seconds: f64,
}

pub(super) fn milliseconds(time: SystemTime) -> i64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis() as i64)
}

pub(super) fn moment(milliseconds: i64) -> SystemTime {
    UNIX_EPOCH + Duration::from_millis(u64::try_from(milliseconds).unwrap_or(0))
}
