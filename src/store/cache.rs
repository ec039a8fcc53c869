//! Artifacts that were read or written recently, so that a result with many readers is read once.

use crate::artifact::{Artifact, ContentHash};
use std::collections::HashMap;
use std::sync::Arc;

/// Memory for artifacts, bytes.
const ROOM: usize = 64 << 20;
/// What the names, units and tables of an artifact take beside its values, about, bytes.
const AROUND: usize = 2 << 10;

/// Two generations: an artifact that is used moves to the young one. When that is full it becomes the old one, and the
/// artifacts of the old one are dropped.
#[derive(Default)]
pub(super) struct Cache {
    young: HashMap<ContentHash, Arc<Artifact>>,
    old: HashMap<ContentHash, Arc<Artifact>>,
    young_bytes: usize,
}

impl Cache {
    pub(super) fn get(&mut self, content: &ContentHash) -> Option<Arc<Artifact>> {
        if let Some(found) = self.young.get(content) {
            return Some(found.clone());
        }
        let found = self.old.remove(content)?;
        self.put(*content, found.clone());
        Some(found)
    }

    pub(super) fn put(&mut self, content: ContentHash, artifact: Arc<Artifact>) {
        // An artifact larger than a generation would displace all others.
        let bytes = artifact.bytes() + AROUND;
        if bytes > ROOM / 2 {
            return;
        }
        if self.young_bytes + bytes > ROOM / 2 {
            self.old = std::mem::take(&mut self.young);
            self.young_bytes = 0;
        }
        if self.young.insert(content, artifact).is_none() {
            self.young_bytes += bytes;
        }
    }
}
