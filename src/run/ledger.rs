//! What is remembered of the runs of a fan-out between campaigns: see [`crate::stage::ledger`].
//!
//! It is kept as a [`Memo`] whose key is the hash of all that the rows of a stage share: its settings, its inputs but the
//! design, what the workflow shares but the levels of factors, and the program. The files that a run looked at must be as
//! they were, and the objects in the store. Of a kept run nothing is opened: what is taken from it stands in the memo.

use super::board::{Board, NodeId, TaskState};
use super::memo;
use crate::artifact::{ContentHash, FirstBytes, Key};
use crate::plan::Workflow;
use crate::stage::ledger::{Briefs, Kept, KeptRuns, RowName};
use crate::stage::rows::RUN;
use crate::store::{Memo, ObjectId, Store};
use std::collections::{BTreeMap, HashMap};
use std::hash::BuildHasherDefault;

/// Files that were looked at, with their digests.
pub(super) type Files = Vec<(String, String)>;

/// The runs that earlier campaigns made.
pub(super) struct Ledger {
    places: HashMap<RowName, usize, BuildHasherDefault<FirstBytes>>,
    objects: Vec<ObjectId>,
    briefs: Briefs,
    pub(super) files: Files,
}

impl Ledger {
    /// Reads the ledger of a stage, when all it rests on is still so.
    pub(super) fn read(workflow: &Workflow, store: &Store, key: &Key) -> Option<Self> {
        let memo = store.memo(key).ok()??;
        let files: Files = serde_json::from_str(&memo.note).ok()?;
        let (names, briefs) = memo.data.split_at_checked(16 * memo.objects.len())?;
        let briefs = Briefs::from_bytes(briefs).filter(|briefs| briefs.len() == memo.objects.len())?;
        if !memo::unchanged(workflow, &files) || !store.has_all(&memo.objects).ok()? {
            return None;
        }
        let places = names.as_chunks::<16>().0.iter().copied().zip(0..).collect();
        Some(Self { places, objects: memo.objects, briefs, files })
    }

    /// The run of a row.
    pub(super) fn kept(&self, name: &RowName) -> Option<Kept<'_>> {
        let place = *self.places.get(name)?;
        let ObjectId { content, key } = self.objects[place];
        Some(Kept { key, content, brief: self.briefs.get(place)? })
    }

    /// Keeps the runs of a gathering task for the next campaign: `rows` are their names in order, `files` what they looked
    /// at. When nearly all of them came from the ledger, it is good enough as it is; and when nothing was gathered now, the
    /// runs would have to be read for it.
    pub(super) fn keep(store: &Store, key: &Key, board: &Board, gather: NodeId, rows: &[RowName], files: &Files) {
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
        let mut data = rows.concat();
        data.extend(briefs.to_bytes());
        // Without it the next campaign makes every task anew, and comes to the same.
        let note = serde_json::to_string(files).unwrap_or_default();
        let _ = store.keep_memo(key, &Memo { note, data, objects });
    }
}

/// Part of the rows, one in so many, that is not worth a new ledger.
const FEW: usize = 20;

/// Objects and briefs of the runs at these places among the inputs of a node that is done.
fn objects(store: &Store, board: &Board, gather: NodeId, places: &[usize]) -> Option<(Vec<ObjectId>, Briefs)> {
    let nothing = KeptRuns::default();
    let kept = board.task(gather).kept.as_deref().unwrap_or(&nothing);
    let kept_at: BTreeMap<usize, usize> = kept.runs.iter().map(|(place, ..)| *place).zip(0..).collect();
    let (contents, mut briefs) = (board.inputs(gather)?, Briefs::default());
    let mut objects = Vec::with_capacity(places.len());
    for place in places {
        let content: ContentHash = contents[*place];
        objects.push(ObjectId { content, key: board.input_key(gather, *place)? });
        match kept_at.get(place) {
            Some(&run) => briefs.push(kept.briefs.get(run)?),
            None if !briefs.push_run(&*store.get(&content).ok()?) => return None,
            None => {}
        }
    }
    Some((objects, briefs))
}
