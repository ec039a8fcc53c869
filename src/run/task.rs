//! One task, from its text to its stored result: the same for every way of starting it.
//!
//! A task that another process computes is handed back, so that this one takes another meanwhile.

use super::board::{Board, NodeId};
use super::streamed::{self, Streamed};
use crate::artifact::{Artifact, ContentHash, Key};
use crate::exec::Share;
use crate::stage::cached::{CachedRuns, RunSummaries};
use crate::stage::rows::{GATHER, RUN};
use crate::stage::{Failure, Job, Progress, StageError, Task, work};
use crate::store::{Claim, Guard, Store, StoreError, Timing, Waiting};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Instant, SystemTime};

/// A task whose inputs are loaded.
pub(super) struct Order {
    pub(super) node: NodeId,
    task: Arc<Task>,
    key: Key,
    text: String,
    inputs: Vec<(String, Arc<Artifact>)>,
    /// Whether the task is computed although a result is stored.
    again: bool,
}

/// A result that cannot be read.
pub(super) struct Lost {
    pub(super) content: ContentHash,
    pub(super) error: StoreError,
}

/// A stored result.
pub(super) struct Finished {
    pub(super) content: ContentHash,
    /// Whether another process computed it meanwhile.
    pub(super) shared: bool,
    /// How long it took here, seconds.
    pub(super) seconds: f64,
    /// Its summary, when it is a run that was computed here.
    pub(super) summary: Option<RunSummaries>,
}

/// The outcome of a task that was started.
pub(super) enum Outcome {
    /// Its result is stored.
    Finished(Finished),
    /// Another process computes it.
    Elsewhere(Waiting),
}

impl Order {
    /// Loads the inputs of an open node, or says which of them is lost.
    pub(super) fn new(
        board: &mut Board,
        node: NodeId,
        store: &Store,
        streamed: &mut Streamed,
        again: bool,
    ) -> Result<Self, Box<Lost>> {
        let known = (board.take_text(node), board.inputs(node), board.key_of(node));
        let (Some(text), Some(contents), Some(key)) = known else {
            panic!("BUG: a task was started before its inputs were known");
        };
        let task = Arc::clone(board.task(node));
        let nothing = CachedRuns::default();
        let old = task.cached.as_deref().unwrap_or(&nothing);
        let mut cached = old.runs.iter().enumerate().map(|(run, (index, ..))| (run, *index)).peekable();
        // A gathering task needs only a summary of each run.
        let gathers = task.work == GATHER.name;
        let (mut inputs, mut indices, mut summaries) = (Vec::new(), Vec::new(), RunSummaries::default());
        for (index, ((name, _), content)) in task.inputs.iter().zip(&contents).enumerate() {
            let lost = |error| Box::new(Lost { content: *content, error });
            let known = match cached.next_if(|(_, cached)| *cached == index) {
                Some((run, _)) => old.summaries.get(run),
                None if gathers && name == RUN => streamed.run(content, store).map_err(lost)?,
                None => None,
            };
            if let Some(summary) = known {
                summaries.push(summary);
                indices.push(index);
                continue;
            }
            inputs.push((name.to_string(), store.get(content).map_err(lost)?));
        }
        if !indices.is_empty() {
            inputs.push(("cached".to_owned(), Arc::new(summaries.artifact(&indices))));
        }
        Ok(Self { node, task, key, text, inputs, again })
    }

    /// Computes and stores the result, unless another process does; `begins` is called before the work.
    pub(super) fn execute(
        self,
        store: &Store,
        share: &Share,
        say: &(dyn Fn(Progress) + Sync),
        stop: &AtomicBool,
        begins: &dyn Fn(),
    ) -> Result<Outcome, Failure> {
        let claim = if self.again { store.claim_again(&self.key) } else { store.claim(&self.key) };
        match claim.map_err(failure)? {
            Claim::Done(record) => {
                Ok(Outcome::Finished(Finished { content: record.content, shared: true, seconds: 0.0, summary: None }))
            }
            Claim::Theirs(waiting) => Ok(Outcome::Elsewhere(waiting)),
            Claim::Mine(claim) => {
                begins();
                self.compute(claim, store, share, say, stop).map(Outcome::Finished)
            }
        }
    }

    fn compute(
        self,
        claim: Guard,
        store: &Store,
        share: &Share,
        say: &(dyn Fn(Progress) + Sync),
        stop: &AtomicBool,
    ) -> Result<Finished, Failure> {
        let (artifact, timing) = compute(&self.task, &self.inputs, share, say, stop)?;
        // Of a gathering task they take as much room as the result, and so does the file that is made of it.
        drop(self.inputs);
        let (record, artifact) = store.finish(claim, self.text, artifact, &timing).map_err(failure)?;
        let summary = streamed::summary(&artifact);
        Ok(Finished { content: record.content, shared: false, seconds: timing.seconds, summary })
    }
}

/// Computes the result of a task whose inputs are there, and how long that took.
pub(super) fn compute(
    task: &Task,
    inputs: &[(String, Arc<Artifact>)],
    share: &Share,
    say: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<(Artifact, Timing), Failure> {
    let Some(work) = work(task.work) else { panic!("BUG: no work is called `{}`", task.work) };
    let job = Job {
        params: &task.params.value(),
        seed: task.seed,
        inputs,
        files: &task.files,
        threads: &|| share.threads(),
        time_limit: task.time_limit,
        say,
        stop,
    };
    let (started, clock) = (SystemTime::now(), Instant::now());
    let artifact = (work.run)(&job)?;
    Ok((artifact, Timing { started, seconds: clock.elapsed().as_secs_f64() }))
}

pub(super) fn failure(error: impl std::fmt::Display) -> Failure {
    StageError::new(error.to_string()).into()
}
