//! Notes at the end of a run: what the statistics point out, and runs that gave no result or are not valid.

use super::common::Campaign;
use crate::artifact::validity::sentences;
use crate::artifact::{Artifact, Table};
use crate::run::{Report, StageStatus};
use crate::store::Store;

/// The notes on the stages that ran, one line each.
pub(super) fn notes(campaign: &Campaign, report: &Report, store: &Store) -> Vec<String> {
    let mut lines = Vec::new();
    for stage in report.stages.iter().filter(|stage| stage.tasks.ran > 0) {
        let StageStatus::Done(content) = &stage.status else { continue };
        // The stage that needs the result reports that it cannot be read.
        let Ok(artifact) = store.get(content) else { continue };
        lines.extend(sentences(&artifact).into_iter().map(|sentence| format!("note: {}: {sentence}", stage.name)));
        if let Some(count) = of_statistics(&artifact) {
            let show = campaign.command("show", &[&stage.name, "--table", "notes"]);
            lines.push(format!("note: {}: {count}; see {show}", stage.name));
        }
    }
    lines
}

/// How many notes the statistics of a result have.
fn of_statistics(artifact: &Artifact) -> Option<String> {
    match artifact.table("notes").map_or(0, Table::rows) {
        0 => None,
        1 => Some("1 note on what to look at before trusting the numbers".to_owned()),
        count => Some(format!("{count} notes on what to look at before trusting the numbers")),
    }
}
