//! What is remembered of the runs of a fan-out between campaigns: see [`crate::stage::ledger`].
//!
//! It is kept as a [`Memo`] whose key is the hash of all that the rows of a stage share: its settings, its inputs but the
//! design, what the workflow shares but the levels of factors, and the program. The files that a run looked at must be as
//! they were, and the objects in the store. Of a kept run nothing is opened: what is taken from it stands in the memo.

use super::board::{Board, NodeId, TaskState};
use super::files::{Files, unchanged};
use crate::artifact::Key;
use crate::plan::Workflow;
use crate::stage::ledger::{Briefs, Kept, KeptRuns};
use crate::stage::rows::{RUN, Rows};
use crate::store::{Memo, ObjectId, Store};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;

/// The runs that earlier campaigns made.
pub(super) struct Ledger {
    rows: Rows,
    /// Where the next row is expected: designs keep their order, with a few rows changed, added or left out.
    next: Cell<usize>,
    /// Places of the rows in the order of their names, for a row that is elsewhere.
    ascending: OnceCell<Vec<u32>>,
    objects: Vec<ObjectId>,
    briefs: Briefs,
    pub(super) files: Files,
}

#[derive(Serialize, Deserialize)]
struct Note {
    files: Files,
    factors: Vec<String>,
}

impl Ledger {
    /// Reads the ledger of a stage, when all it rests on is still so.
    pub(super) fn read(workflow: &Workflow, store: &Store, key: &Key) -> Option<Self> {
        let memo = store.memo(key).ok()??;
        let Note { files, factors } = serde_json::from_str(&memo.note).ok()?;
        let (words, briefs) = memo.data.split_at_checked(8 * (factors.len() + 1) * memo.objects.len())?;
        let briefs = Briefs::from_bytes(briefs).filter(|briefs| briefs.len() == memo.objects.len())?;
        if !unchanged(workflow, &files) || !store.has_all(&memo.objects).ok()? {
            return None;
        }
        let words = words.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word)).collect();
        let rows = Rows::from_parts(factors, words)?;
        Some(Self { rows, next: Cell::default(), ascending: OnceCell::new(), objects: memo.objects, briefs, files })
    }

    /// The run of a row of a design.
    pub(super) fn kept(&self, rows: &Rows, index: usize) -> Option<Kept<'_>> {
        if rows.factors() != self.rows.factors() {
            return None;
        }
        let place = self.place(rows.name(index))?;
        self.next.set(place + 1);
        let ObjectId { content, key } = self.objects[place];
        Some(Kept { key, content, brief: self.briefs.get(place)? })
    }

    fn place(&self, name: &[u64]) -> Option<usize> {
        let next = self.next.get();
        // Where it was, or behind a row that is no more.
        if let Some(place) = (next..self.rows.len().min(next + 2)).find(|&place| self.rows.name(place) == name) {
            return Some(place);
        }
        let ascending = self.ascending.get_or_init(|| {
            let mut places: Vec<u32> = (0..self.rows.len() as u32).collect();
            places.sort_by(|&a, &b| self.rows.name(a as usize).cmp(self.rows.name(b as usize)));
            places
        });
        let found = ascending.binary_search_by(|&place| self.rows.name(place as usize).cmp(name)).ok()?;
        Some(ascending[found] as usize)
    }

    /// Keeps the runs of a gathering task for the next campaign: `rows` are those of its design, `files` what they looked
    /// at. When nearly all of them came from the ledger, it is good enough as it is; and when nothing was gathered now, the
    /// runs would have to be read for it.
    pub(super) fn keep(store: &Store, key: &Key, board: &Board, gather: NodeId, rows: &Rows, files: &Files) {
        if !matches!(board.state(gather), TaskState::Done { cached: false, .. }) {
            return;
        }
        let task = board.task(gather);
        let runs: Vec<usize> = (0..task.inputs.len()).filter(|&place| task.inputs[place].0 == RUN).collect();
        let new = runs.len() - task.kept.as_ref().map_or(0, |kept| kept.runs.len());
        if runs.len() != rows.len() || new * FEW <= runs.len() {
            return;
        }
        let Some((objects, briefs)) = objects(store, board, gather, &runs) else { return };
        let mut data: Vec<u8> = rows.words().iter().flat_map(|word| word.to_le_bytes()).collect();
        data.extend(briefs.to_bytes());
        // Without it the next campaign makes every task anew, and comes to the same.
        let note = Note { files: files.clone(), factors: rows.factors().to_vec() };
        let note = serde_json::to_string(&note).unwrap_or_default();
        let _ = store.keep_memo(key, &Memo { note, data, objects });
    }
}

/// Part of the rows, one in so many, that is not worth a new ledger.
const FEW: usize = 20;

/// Objects and briefs of the runs at these places among the inputs of a node that is done.
fn objects(store: &Store, board: &Board, gather: NodeId, places: &[usize]) -> Option<(Vec<ObjectId>, Briefs)> {
    let task = board.task(gather);
    let nothing = KeptRuns::default();
    let kept = task.kept.as_deref().unwrap_or(&nothing);
    let kept_at: BTreeMap<usize, usize> = kept.runs.iter().map(|(place, ..)| *place).zip(0..).collect();
    let (contents, mut briefs) = (board.inputs(gather)?, Briefs::default());
    let mut objects = Vec::with_capacity(places.len());
    for place in places {
        let content = contents[*place];
        let key = match kept_at.get(place) {
            Some(&run) => {
                briefs.push(kept.briefs.get(run)?);
                kept.runs[run].2
            }
            None => {
                if !briefs.push_run(&*store.get(&content).ok()?) {
                    return None;
                }
                board.input_key(gather, *place)?
            }
        };
        objects.push(ObjectId { content, key });
    }
    Some((objects, briefs))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::ContentHash;
    use crate::artifact::run::{Responses, Run};

    fn rows(values: &[f64]) -> Rows {
        let words = values.iter().flat_map(|value| [value.to_bits(), 1]).collect();
        Rows::from_parts(vec!["a".to_owned()], words).unwrap()
    }

    /// Places at which a ledger of the rows 1, 2, … 6 finds those of a later design.
    fn places(new: &Rows) -> Vec<Option<usize>> {
        let old = rows(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let mut briefs = Briefs::default();
        let run = Run::plain("", Responses::default()).to_artifact();
        assert!((0..6).all(|_| briefs.push_run(&run)));
        let object = |place: u8| ObjectId { content: ContentHash([place; 32]), key: Key([place; 32]) };
        let ledger = Ledger {
            rows: old,
            next: Cell::default(),
            ascending: OnceCell::new(),
            objects: (0..6).map(object).collect(),
            briefs,
            files: Vec::new(),
        };
        (0..new.len()).map(|row| ledger.kept(new, row).map(|kept| usize::from(kept.key.0[0]))).collect()
    }

    #[test]
    fn rows_are_found_wherever_they_stand() {
        let found = |values: &[f64]| places(&rows(values));
        assert_eq!(found(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [0, 1, 2, 3, 4, 5].map(Some));
        assert_eq!(found(&[1.0, 3.0, 4.0, 6.0]), [0, 2, 3, 5].map(Some));
        assert_eq!(found(&[6.0, 5.0, 4.0, 4.0, 1.0]), [5, 4, 3, 3, 0].map(Some));
        assert_eq!(found(&[1.0, 2.5, 3.0]), [Some(0), None, Some(2)]);
        assert_eq!(found(&[0.5, 1.0, 1.5, 2.0, 7.0]), [None, Some(0), None, Some(1), None]);
        let other = Rows::from_parts(vec!["b".to_owned()], vec![1_f64.to_bits(), 1]).unwrap();
        assert_eq!(places(&other), [None], "another factor");
    }
}
