//! Memos of stages: an unchanged stage is completed at once.
//!
//! `next` is a pure function of the stage's settings, what the workflow shares, its inputs, the files it looks at, and
//! the program. Their hash is the key of a [memo](crate::store::Memo) that holds the result of the stage and the objects that the result rests on.
//! When the memo is there, the files are as they were and the objects are in the store, the stage is done without a look
//! at its tasks: ten thousand of them cost one listing of folders. A memo is only a short cut: without it the tasks' own
//! keys give the same answer, later.

use super::board::{Board, NodeId, TaskCount};
use super::files::{Files, unchanged};
use crate::artifact::{ContentHash, Key};
use crate::plan::Workflow;
use crate::stage::Context;
use crate::store::{MemoDraft, ObjectId, Store};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::os::unix::fs::MetadataExt;

/// The result of a stage, from its memo.
pub(super) struct Recalled {
    pub(super) content: ContentHash,
    pub(super) objects: Vec<ObjectId>,
}

impl Recalled {
    /// Its tasks, with those that it shares with other stages.
    pub(super) fn count(&self) -> TaskCount {
        TaskCount { total: self.objects.len(), cached: self.objects.len(), ..TaskCount::default() }
    }
}

#[derive(Serialize, Deserialize)]
struct Note {
    content: String,
    /// Files that the stage looked at, with their digests.
    files: Files,
    /// Design row of each object; −1 for none.
    rows: Vec<i64>,
}

/// Hashes of what all stages of a workflow share, and of the program: every rebuild invalidates all memos.
#[derive(Clone, Copy)]
pub(super) struct Base {
    /// Hash of all that stages share.
    pub(super) whole: Key,
    /// The same without the levels of factors: what a single run depends on.
    pub(super) run: Key,
}

/// The hashes that the keys of all memos begin with.
pub(super) fn base(workflow: &Workflow) -> Base {
    let program = std::env::current_exe().and_then(std::fs::metadata).ok().map(|meta| {
        // The modification time alone can be set, and two builds may have the same one.
        (meta.len(), meta.ino(), meta.mtime(), meta.mtime_nsec(), meta.ctime(), meta.ctime_nsec())
    });
    let Context { seed, factors, responses, materials, sketches, templates, outline } = &workflow.context;
    let all = format!("{responses:?}\n{materials:?}\n{sketches:?}\n{templates:?}");
    let shared = format!("flow stages 3\nprogram {program:?}\nseed {seed}\n{all}\n");
    let bare = factors.iter().map(|(name, f)| (name, &f.sets, &f.unit, &f.symbol));
    let run = Key::of(&format!("run\n{shared}{:?}\n", bare.collect::<Vec<_>>()));
    let mut whole = format!("{shared}{outline:?}\n{run}").into_bytes();
    for factor in factors.values() {
        // Bits of numbers, because formatting ten thousand levels takes long.
        let numbers = factor.levels.iter().chain(factor.range.iter().flatten());
        whole.extend(numbers.flat_map(|number| number.to_bits().to_le_bytes()));
        whole.extend(
            [factor.levels.len() as u64, factor.range.is_some().into(), factor.scale as u64]
                .map(u64::to_le_bytes)
                .as_flattened(),
        );
    }
    Base { whole: Key(*blake3::hash(&whole).as_bytes()), run }
}

/// Key of the memo of a stage whose inputs are known: `inputs` holds their stage keys and contents.
pub(super) fn key(workflow: &Workflow, index: usize, base: &Key, inputs: &[(Key, ContentHash)]) -> Key {
    let node = &workflow.stages[index];
    let mut text = format!("{base}\nkind {}\nsettings {}\n", node.kind, node.stage.settings());
    for ((port, _), (stage, content)) in node.inputs.iter().zip(inputs) {
        // A String takes any text.
        let _ = writeln!(text, "input {port} {stage} {content}");
    }
    Key::of(&text)
}

/// Key of the memo of the runs of a stage: as [`key`], without the design whose rows they are.
pub(super) fn run_key(workflow: &Workflow, index: usize, base: &Key, inputs: &[(Key, ContentHash)]) -> Key {
    let node = &workflow.stages[index];
    let mut text = format!("{base}\nkind {}\nsettings {}\n", node.kind, node.stage.settings());
    for ((port, _), (stage, content)) in node.inputs.iter().zip(inputs).filter(|((port, _), _)| *port != "design") {
        let _ = writeln!(text, "input {port} {stage} {content}");
    }
    Key::of(&text)
}

/// The result of a stage from its memo; `None` when a file or an object that it rests on has changed or is gone.
pub(super) fn recall(workflow: &Workflow, store: &Store, key: &Key) -> Option<Recalled> {
    let memo = store.memo(key).ok()??;
    let note: Note = serde_json::from_str(&memo.note).ok()?;
    if !unchanged(workflow, &note.files) || !store.has_all(&memo.objects).ok()? {
        return None;
    }
    Some(Recalled { content: ContentHash::from_hex(&note.content)?, objects: memo.objects })
}

/// The tasks that the memo of a stage rests on: design row and key of each. For the reasons of a rerun.
pub fn remembered(store: &Store, key: &Key) -> Option<Vec<(Option<usize>, Key)>> {
    let memo = store.memo(key).ok()??;
    let note: Note = serde_json::from_str(&memo.note).ok()?;
    let rows = note.rows.into_iter().map(|row| usize::try_from(row).ok());
    Some(rows.zip(memo.objects.into_iter().map(|object| object.key)).collect())
}

/// Stores the memo of a stage: `nodes` are all the tasks that its result rests on.
pub(super) fn store(store: &Store, key: &Key, content: ContentHash, board: &Board, nodes: &[NodeId], files: Files) {
    let rows = board.results(nodes).map(|(_, row)| row.map_or(-1, |row| row as i64)).collect();
    let note = Note { content: content.to_string(), files, rows };
    let note = serde_json::to_string(&note).unwrap_or_else(|e| panic!("BUG: the note of a memo: {e}"));
    // A memo that cannot be written costs time only; the store says what is wrong when it matters.
    let objects = Box::new(board.results(nodes).map(|(object, _)| object));
    let _ = store.keep_memo(key, MemoDraft { note: &note, numbers: &[], data: &[], objects });
}
