//! What a reader must not miss at the end of a run: notes of the statistics, and runs that gave no result.

use super::common::Campaign;
use crate::artifact::results::Results;
use crate::artifact::{Artifact, Node, Table};
use crate::run::{Report, StageStatus};
use crate::store::Store;

/// A line for each table that holds remarks, with the command that shows it; of the stages that ran.
pub(super) fn remarks(campaign: &Campaign, report: &Report, store: &Store) -> Vec<String> {
    let mut lines = Vec::new();
    for stage in report.stages.iter().filter(|stage| stage.tasks.ran > 0) {
        let StageStatus::Done(content) = &stage.status else { continue };
        // A result that cannot be read is told by whoever needs it.
        let Ok(artifact) = store.get(content) else { continue };
        if let Some(why) = failure(&artifact) {
            lines.push(format!("note: {}: the run gave no result: {why}", stage.name));
        }
        for (table, count) in [("notes", notes(&artifact)), ("runs", failures(&artifact))] {
            if let Some(told) = count {
                let show = campaign.command("show", &[&stage.name, "--table", table]);
                lines.push(format!("note: {}: {told}; see {show}", stage.name));
            }
        }
    }
    lines
}

/// Why a single run gave no result.
pub(super) fn failure(artifact: &Artifact) -> Option<&str> {
    match artifact.root.get("failure") {
        Some(Node::Text(why)) if !why.is_empty() => Some(why),
        Some(_) | None => None,
    }
}

fn notes(artifact: &Artifact) -> Option<String> {
    match artifact.table("notes").map_or(0, Table::rows) {
        0 => None,
        1 => Some("1 note on what to look at before trusting the numbers".to_owned()),
        count => Some(format!("{count} notes on what to look at before trusting the numbers")),
    }
}

fn failures(artifact: &Artifact) -> Option<String> {
    let failures = Results::failures(Results::table(artifact).ok()?);
    let count = failures.iter().filter(|why| !why.is_empty()).count();
    (count > 0).then(|| format!("{count} of {} runs gave no result", failures.len()))
}
