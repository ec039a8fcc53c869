//! Computing results again, to see whether they are what their tasks give: equal bits are a proof.

use super::board::NodeId;
use super::{Report, TaskState, panicked, stages, task};
use crate::artifact::ContentHash;
use crate::exec::with_threads;
use crate::stage::{Failure, is_far};
use crate::store::{Store, StoreError};
use std::hash::{BuildHasher, RandomState};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::channel;

/// A result that was computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Audited {
    /// Index of its stage in the workflow.
    pub stage: usize,
    /// Its design row.
    pub row: Option<usize>,
    /// What is stored.
    pub stored: ContentHash,
    /// What was computed, or why nothing could be.
    pub computed: Result<ContentHash, String>,
}

/// Computes `sample` of the stored results of a campaign again, drawn at random of those that take long: specimens,
/// simulations, external programs. Nothing is stored.
///
/// The report is that of a decision (`decided`), which keeps every task; a run lets go what it computed.
///
/// # Errors
/// An input cannot be read, or the system grants no threads; in words.
pub fn audit(
    report: &Report,
    store: &Store,
    sample: usize,
    jobs: usize,
    stop: &AtomicBool,
) -> Result<Vec<Audited>, String> {
    let board = &report.board;
    let done = |node: &NodeId| matches!(board.state(*node), TaskState::Done { .. });
    let mut nodes: Vec<NodeId> = (0..board.len()).filter(done).filter(|node| is_far(board.task(*node).work)).collect();
    // Whoever forged a result must not know which are drawn.
    let draw = RandomState::new();
    nodes.sort_by_key(|node| draw.hash_one(node));
    nodes.truncate(sample);
    nodes.sort_unstable();
    let mut orders = Vec::with_capacity(nodes.len());
    for node in nodes {
        let inputs = board.task(node).inputs.iter().zip(board.inputs(node).unwrap_or_default());
        let loaded = inputs.map(|((name, _), content)| Ok((name.to_string(), store.get(&content)?)));
        let loaded = loaded.collect::<Result<Vec<_>, StoreError>>().map_err(|error| error.to_string())?;
        orders.push((node, loaded));
    }
    let (answers, inbox) = channel();
    let ran = with_threads(jobs, |pool| {
        for (node, inputs) in orders {
            let (task, answers) = (board.task(node).clone(), answers.clone());
            pool.give(move |share| {
                let computed = catch_unwind(AssertUnwindSafe(|| task::compute(&task, &inputs, share, &|_| (), stop)));
                let computed = computed.unwrap_or_else(|panic| Err(panicked(&*panic)));
                // The other end stays until all have answered.
                let _ = answers.send((node, computed.map(|(artifact, _)| artifact.canonical().content_hash())));
            });
        }
    });
    ran.map_err(|error| format!("the system grants no {jobs} threads ({error})"))?;
    drop(answers);
    let mut found: Vec<(NodeId, Result<ContentHash, Failure>)> = inbox.iter().collect();
    found.sort_by_key(|(node, _)| *node);
    let words = |failure| match failure {
        Failure::Stopped => "interrupted".to_owned(),
        Failure::Failed(error) => stages::in_words(error),
    };
    let audited = found.into_iter().filter_map(|(node, computed)| {
        let TaskState::Done { content, .. } = board.state(node) else { return None };
        let (stage, row) = (board.stage(node), board.row(node));
        Some(Audited { stage, row, stored: content, computed: computed.map_err(words) })
    });
    Ok(audited.collect())
}
