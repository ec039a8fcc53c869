//! Summaries of runs, made when each run ends: a table of a hundred thousand runs is gathered without reading their
//! artifacts again.

use crate::artifact::{Artifact, ContentHash, FirstBytes};
use crate::stage::cached::{RunSummaries, RunSummary};
use crate::store::{Store, StoreError};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;

/// Summaries of the runs that this campaign has computed or read, by the content of their results.
#[derive(Default)]
pub(super) struct Streamed {
    summaries: RunSummaries,
    indices: HashMap<ContentHash, u32, BuildHasherDefault<FirstBytes>>,
}

/// The summary of a result, when it is a run.
pub(super) fn summary(artifact: &Artifact) -> Option<RunSummaries> {
    let mut summaries = RunSummaries::default();
    summaries.push_run(artifact).then_some(summaries)
}

impl Streamed {
    /// Adds a run.
    pub(super) fn put(&mut self, content: ContentHash, summary: &RunSummaries) {
        if let Some(summary) = summary.get(0)
            && !self.indices.contains_key(&content)
        {
            self.indices.insert(content, self.summaries.len() as u32);
            self.summaries.push(summary);
        }
    }

    /// The run with this result, none when the result is no run. It is read when its summary is not there yet: another
    /// process or a worker on another machine computed it, or an earlier campaign.
    ///
    /// # Errors
    /// Those of [`Store::get`].
    pub(super) fn run(&mut self, content: &ContentHash, store: &Store) -> Result<Option<RunSummary<'_>>, StoreError> {
        if !self.indices.contains_key(content)
            && let Some(summary) = summary(&*store.get_once(content)?)
        {
            self.put(*content, &summary);
        }
        Ok(self.indices.get(content).and_then(|&index| self.summaries.get(index as usize)))
    }
}
