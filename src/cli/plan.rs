//! `flow plan`: what `run` would do and why, by the same decisions.

use super::Exit;
use super::common::Campaign;
use crate::exec::cores;
use crate::report::duration;
use crate::run::{Past, Report, StageReport, StageStatus, TaskReport, TaskState, decide};
use clap::Args;

/// Show what `run` would do, and why, without doing it.
#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    campaign: Campaign,
    /// Only these stages, with all they need.
    stages: Vec<String>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// Most reasons that are shown of a stage.
const MOST_REASONS: usize = 4;

struct Line {
    name: String,
    state: String,
    reasons: Vec<String>,
    to_run: usize,
    seconds: Option<f64>,
}

impl Plan {
    pub(super) fn go(self) -> Exit {
        self.print().unwrap_or_else(|exit| exit)
    }

    fn print(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load_to_run(&self.stages)?;
        let store = self.campaign.open()?;
        let report = decide(&workflow, &store, &self.stages, true);
        let past = Past::of(&workflow, &store).map_err(|e| super::common::system(&e))?;
        let open: Vec<TaskReport> = report.tasks().filter(|task| task.state == TaskState::Open).collect();
        let of = |stage: &StageReport| -> Vec<&TaskReport> {
            let index = workflow.position(&stage.name);
            open.iter().filter(|task| Some(task.stage) == index).collect()
        };
        let lines: Vec<Line> = report.stages.iter().map(|stage| line(stage, of(stage), &past)).collect();
        if self.json {
            out!("{}", document(&workflow.name, &report, &lines));
        } else {
            print_lines(&lines);
        }
        Ok(Exit::Done)
    }
}

/// `open` are the tasks of the stage that would be run.
fn line(stage: &StageReport, open: Vec<&TaskReport>, past: &Past<'_>) -> Line {
    let state = match &stage.status {
        StageStatus::Done(_) => format!("done, {} cached", stage.tasks.cached),
        StageStatus::Failed(why) => format!("cannot run: {why}"),
        StageStatus::Skipped(cause) => format!("skipped, because `{cause}` cannot run"),
        StageStatus::Open if open.is_empty() => "not known yet: waits for its inputs".to_owned(),
        StageStatus::Open => format!("{} to run, {} cached", open.len(), stage.tasks.cached),
    };
    let mut reasons = past.reasons(&stage.name, &open);
    reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let more = reasons.len().saturating_sub(MOST_REASONS);
    let mut reasons: Vec<String> = reasons
        .iter()
        .take(MOST_REASONS)
        .map(|(reason, count)| if *count == 1 { reason.to_string() } else { format!("{reason} ({count} tasks)") })
        .collect();
    if more > 0 {
        reasons.push(format!("… and {more} more reasons"));
    }
    let seconds = past.seconds(&stage.name).map(|each| each * open.len() as f64).filter(|_| !open.is_empty());
    Line { name: stage.name.clone(), state, reasons, to_run: open.len(), seconds }
}

fn print_lines(lines: &[Line]) {
    let width = lines.iter().map(|line| line.name.chars().count()).max().unwrap_or(0);
    for line in lines {
        let about = line.seconds.map_or_else(String::new, |s| format!(", about {}", duration(s / cores() as f64)));
        out!("{:width$}  {}{about}", line.name, line.state);
        for reason in &line.reasons {
            out!("{:width$}    {reason}", "");
        }
    }
}

fn document(name: &str, report: &Report, lines: &[Line]) -> serde_json::Value {
    let stages: Vec<serde_json::Value> = report
        .stages
        .iter()
        .zip(lines)
        .map(|(stage, line)| {
            serde_json::json!({
                "name": stage.name, "kind": stage.kind, "state": stage.status.word(),
                "cached": stage.tasks.cached, "to_run": line.to_run, "reasons": line.reasons, "seconds": line.seconds,
            })
        })
        .collect();
    serde_json::json!({ "workflow": name, "stages": stages })
}
