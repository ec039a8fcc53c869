//! What gathering takes from each run, noted when the run ends: a table of a hundred thousand runs is gathered without all
//! of their artifacts in memory, or read again, at once.

use crate::artifact::{Artifact, ContentHash, FirstBytes};
use crate::stage::ledger::{Brief, Briefs};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;

/// Briefs of the runs that this campaign has computed, by their results.
#[derive(Default)]
pub(super) struct Streamed {
    briefs: Briefs,
    places: HashMap<ContentHash, u32, BuildHasherDefault<FirstBytes>>,
}

/// The brief of a result, when it is a run.
pub(super) fn brief(artifact: &Artifact) -> Option<Briefs> {
    let mut briefs = Briefs::default();
    briefs.push_run(artifact).then_some(briefs)
}

impl Streamed {
    /// Notes a run.
    pub(super) fn put(&mut self, content: ContentHash, brief: &Briefs) {
        if let Some(brief) = brief.get(0)
            && !self.places.contains_key(&content)
        {
            self.places.insert(content, self.briefs.len() as u32);
            self.briefs.push(brief);
        }
    }

    /// The run with this result.
    pub(super) fn get(&self, content: &ContentHash) -> Option<Brief<'_>> {
        self.briefs.get(*self.places.get(content)? as usize)
    }
}
