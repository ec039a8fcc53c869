//! The memo of the runs of a stage, by which a later campaign recognises them: see [`crate::stage::cached`].
//!
//! It is a [memo](crate::store::Memo). Its key is the hash of all that the rows of a stage share: the settings of the stage, its inputs without
//! the design, what the workflow shares without the levels of factors, and the program. The memo counts only while the files
//! that the runs read are unchanged and the objects are in the store. No object of a cached run is opened: the memo holds a
//! summary of each.

use super::board::{Board, NodeId, TaskState};
use super::files::{Files, unchanged};
use super::streamed::Streamed;
use crate::artifact::Key;
use crate::plan::Workflow;
use crate::stage::Task;
use crate::stage::cached::{CachedRun, CachedRuns, RunSummaries, RunSummary};
use crate::stage::rows::{DesignRows, RUN};
use crate::store::{MemoDraft, ObjectId, Store};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;

/// The runs that earlier campaigns made, found by the content of their rows.
pub(super) struct RunMemo {
    rows: DesignRows,
    /// Index at which the next row is expected: an edited design keeps the order of most of its rows.
    next: Cell<usize>,
    /// Indices of the rows in the order of their names, for a row at another index.
    ascending: OnceCell<Vec<u32>>,
    objects: Vec<ObjectId>,
    summaries: RunSummaries,
    pub(super) files: Files,
}

#[derive(Serialize, Deserialize)]
struct Note {
    files: Files,
    factors: Vec<String>,
}

impl RunMemo {
    /// Reads the memo of the runs of a stage; `None` when a file or an object that it rests on has changed or is gone.
    pub(super) fn read(workflow: &Workflow, store: &Store, key: &Key) -> Option<Self> {
        let memo = store.memo(key).ok()??;
        let Note { files, factors } = serde_json::from_str(&memo.note).ok()?;
        let (words, summaries) = memo.data.split_at_checked(8 * (factors.len() + 1) * memo.objects.len())?;
        let summaries =
            RunSummaries::from_bytes(summaries).filter(|summaries| summaries.len() == memo.objects.len())?;
        if !unchanged(workflow, &files) || !store.has_all(&memo.objects).ok()? {
            return None;
        }
        let words = words.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word)).collect();
        let rows = DesignRows::from_parts(factors, words)?;
        Some(Self { rows, next: Cell::default(), ascending: OnceCell::new(), objects: memo.objects, summaries, files })
    }

    /// The cached run of a row of a design.
    pub(super) fn cached(&self, rows: &DesignRows, index: usize) -> Option<CachedRun<'_>> {
        if rows.factors() != self.rows.factors() {
            return None;
        }
        let index = self.index(rows.name(index))?;
        self.next.set(index + 1);
        let ObjectId { content, key } = self.objects[index];
        Some(CachedRun { key, content, summary: self.summaries.get(index)? })
    }

    fn index(&self, name: &[u64]) -> Option<usize> {
        let next = self.next.get();
        // At the expected index, or one further when a row was removed.
        if let Some(index) = (next..self.rows.len().min(next + 2)).find(|&index| self.rows.name(index) == name) {
            return Some(index);
        }
        let ascending = self.ascending.get_or_init(|| {
            let mut indices: Vec<u32> = (0..self.rows.len() as u32).collect();
            indices.sort_by(|&a, &b| self.rows.name(a as usize).cmp(self.rows.name(b as usize)));
            indices
        });
        let found = ascending.binary_search_by(|&index| self.rows.name(index as usize).cmp(name)).ok()?;
        Some(ascending[found] as usize)
    }

    /// Stores a memo of the runs of a gathering task for the next campaign. `rows` are the rows of its design, `files` the
    /// files that the runs read. Nothing is written when nearly all runs came from the old memo, which then serves again, or
    /// when nothing was gathered now, because all runs would have to be read for it.
    pub(super) fn store(
        store: &Store,
        streamed: &mut Streamed,
        key: &Key,
        board: &Board,
        gather: NodeId,
        rows: &DesignRows,
        files: &Files,
    ) {
        if !matches!(board.state(gather), TaskState::Done { cached: false, .. }) {
            return;
        }
        let task = board.task(gather);
        let runs: Vec<usize> = (0..task.inputs.len()).filter(|&index| task.inputs[index].0 == RUN).collect();
        let new = runs.len() - task.cached.as_ref().map_or(0, |cached| cached.runs.len());
        if runs.len() != rows.len() || new * FEW <= runs.len() {
            return;
        }
        let cached = CachedAt::of(task);
        let Some(summaries) = summaries(store, streamed, board, gather, &cached, &runs) else { return };
        let summaries = summaries.to_bytes();
        // Without a memo the next campaign looks at every task, and gets the same result.
        let note = Note { files: files.clone(), factors: rows.factors().to_vec() };
        let note = serde_json::to_string(&note).unwrap_or_default();
        let objects = Box::new(runs.iter().filter_map(|&index| cached.object(board, gather, index)));
        let _ = store.keep_memo(key, MemoDraft { note: &note, numbers: rows.words(), data: &summaries, objects });
    }
}

/// A memo is written anew when more than one row in `FEW` is new.
const FEW: usize = 20;

/// The cached runs of a gathering task, by their indices among its inputs.
struct CachedAt<'a> {
    cached: Option<&'a CachedRuns>,
    runs: BTreeMap<usize, usize>,
}

impl<'a> CachedAt<'a> {
    fn of(task: &'a Task) -> Self {
        let cached = task.cached.as_deref();
        let runs = cached.into_iter().flat_map(|cached| cached.runs.iter().map(|(index, ..)| *index).zip(0..));
        Self { cached, runs: runs.collect() }
    }

    /// The summary of a cached run.
    fn summary(&self, index: usize) -> Option<RunSummary<'a>> {
        self.cached?.summaries.get(*self.runs.get(&index)?)
    }

    /// The object of any run.
    fn object(&self, board: &Board, gather: NodeId, index: usize) -> Option<ObjectId> {
        match (self.cached, self.runs.get(&index)) {
            (Some(cached), Some(&run)) => {
                let (_, _, key, content) = cached.runs[run];
                Some(ObjectId { content, key })
            }
            _ => board.input(gather, index),
        }
    }
}

/// Summaries of the runs at these indices among the inputs of a node that is done; `None` when one is not to be had.
fn summaries(
    store: &Store,
    streamed: &mut Streamed,
    board: &Board,
    gather: NodeId,
    cached: &CachedAt<'_>,
    indices: &[usize],
) -> Option<RunSummaries> {
    let mut summaries = RunSummaries::with_room(indices.len());
    for &index in indices {
        let object = cached.object(board, gather, index)?;
        match cached.summary(index) {
            Some(summary) => summaries.push(summary),
            None => summaries.push(streamed.run(&object.content, store).ok()??),
        }
    }
    Some(summaries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::ContentHash;
    use crate::artifact::run::{Responses, Run};

    fn rows(values: &[f64]) -> DesignRows {
        let words = values.iter().flat_map(|value| [value.to_bits(), 1]).collect();
        DesignRows::from_parts(vec!["a".to_owned()], words).unwrap()
    }

    /// Indices at which the memo of the rows 1, 2, … 6 finds those of a later design.
    fn indices(new: &DesignRows) -> Vec<Option<usize>> {
        let old = rows(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let mut summaries = RunSummaries::default();
        let run = Run::plain("", Responses::default()).to_artifact();
        assert!((0..6).all(|_| summaries.push_run(&run)));
        let object = |index: u8| ObjectId { content: ContentHash([index; 32]), key: Key([index; 32]) };
        let run_memo = RunMemo {
            rows: old,
            next: Cell::default(),
            ascending: OnceCell::new(),
            objects: (0..6).map(object).collect(),
            summaries,
            files: Vec::new(),
        };
        (0..new.len()).map(|row| run_memo.cached(new, row).map(|cached| usize::from(cached.key.0[0]))).collect()
    }

    #[test]
    fn rows_are_found_at_any_index() {
        let found = |values: &[f64]| indices(&rows(values));
        assert_eq!(found(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [0, 1, 2, 3, 4, 5].map(Some));
        assert_eq!(found(&[1.0, 3.0, 4.0, 6.0]), [0, 2, 3, 5].map(Some));
        assert_eq!(found(&[6.0, 5.0, 4.0, 4.0, 1.0]), [5, 4, 3, 3, 0].map(Some));
        assert_eq!(found(&[1.0, 2.5, 3.0]), [Some(0), None, Some(2)]);
        assert_eq!(found(&[0.5, 1.0, 1.5, 2.0, 7.0]), [None, Some(0), None, Some(1), None]);
        let other = DesignRows::from_parts(vec!["b".to_owned()], vec![1_f64.to_bits(), 1]).unwrap();
        assert_eq!(indices(&other), [None], "another factor");
    }
}
