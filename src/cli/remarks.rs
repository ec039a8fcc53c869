//! What a reader must not miss at the end of a run: notes of the statistics, and runs that gave no result or are not valid.

use super::common::Campaign;
use crate::artifact::validity::said;
use crate::artifact::{Artifact, Table};
use crate::run::{Report, StageStatus};
use crate::store::Store;

/// What is said of the runs and of the analyses of the stages that ran, a line each.
pub(super) fn remarks(campaign: &Campaign, report: &Report, store: &Store) -> Vec<String> {
    let mut lines = Vec::new();
    for stage in report.stages.iter().filter(|stage| stage.tasks.ran > 0) {
        let StageStatus::Done(content) = &stage.status else { continue };
        // A result that cannot be read is told by whoever needs it.
        let Ok(artifact) = store.get(content) else { continue };
        lines.extend(said(&artifact).into_iter().map(|said| format!("note: {}: {said}", stage.name)));
        if let Some(told) = notes(&artifact) {
            let show = campaign.command("show", &[&stage.name, "--table", "notes"]);
            lines.push(format!("note: {}: {told}; see {show}", stage.name));
        }
    }
    lines
}

fn notes(artifact: &Artifact) -> Option<String> {
    match artifact.table("notes").map_or(0, Table::rows) {
        0 => None,
        1 => Some("1 note on what to look at before trusting the numbers".to_owned()),
        count => Some(format!("{count} notes on what to look at before trusting the numbers")),
    }
}
