//! `flow plan`: what `run` would do and why, by the same decisions.

use super::common::{Campaign, decided};
use super::{Exit, complete};
use crate::exec::cores;
use crate::report::duration;
use crate::run::{Past, Report, StageReport, StageStatus, TaskReport, TaskState, forecasts};
use crate::stage::forecast::{Forecast, TaskForecast};
use clap::Args;

/// Show what `run` would do, and why, without doing it.
#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    campaign: Campaign,
    /// Only these stages, with all they need.
    #[arg(add = complete::stages())]
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
    /// What it is expected to ask for when its inputs are there; none of a stage whose tasks are known.
    expected: Option<TaskForecast>,
    /// Whether nothing is known of its tasks.
    unknown: bool,
    seconds: Option<f64>,
    /// Whether `seconds` are estimated, for nothing of it has run here.
    estimated: bool,
}

impl Plan {
    pub(super) fn go(self) -> Exit {
        self.print().unwrap_or_else(|exit| exit)
    }

    fn print(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load_to_run(&self.stages)?;
        let store = self.campaign.common.read()?;
        let report = decided(&workflow, &store, &self.stages, true)?;
        let past = Past::of(&workflow, &store).map_err(|e| super::common::system(&e))?;
        let open: Vec<TaskReport> = report.tasks().filter(|task| task.state == TaskState::Open).collect();
        let of = |stage: &StageReport| -> Vec<&TaskReport> {
            let index = workflow.position(&stage.name);
            open.iter().filter(|task| Some(task.stage) == index).collect()
        };
        let forecasts = forecasts(&workflow);
        let ahead = |stage: &StageReport| workflow.position(&stage.name).map_or(Forecast::UNKNOWN, |i| forecasts[i]);
        let lines: Vec<Line> = report.stages.iter().map(|stage| line(stage, of(stage), ahead(stage), &past)).collect();
        if self.json {
            out!("{}", document(&workflow.name, &report, &lines));
        } else {
            print_lines(&lines);
        }
        Ok(Exit::Done)
    }
}

/// `open` are the tasks of the stage that would be run.
fn line(stage: &StageReport, open: Vec<&TaskReport>, ahead: Forecast, past: &Past<'_>) -> Line {
    let waits = matches!(stage.status, StageStatus::Open) && open.is_empty();
    let expected = ahead.tasks.filter(|_| waits);
    let state = match &stage.status {
        StageStatus::Done(_) => format!("done, {} cached", stage.tasks.cached),
        StageStatus::Failed(why) => format!("cannot run: {why}"),
        StageStatus::Skipped(cause) => format!("skipped, because `{cause}` cannot run"),
        StageStatus::Open if open.is_empty() => match expected {
            Some(TaskForecast::Exactly(tasks)) => format!("{tasks} to run, once its inputs are there"),
            Some(TaskForecast::AtMost(tasks)) => format!("at most {tasks} to run, once its inputs are there"),
            None => "not known yet: waits for its inputs".to_owned(),
        },
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
    let tasks = expected.map_or(open.len(), TaskForecast::count);
    let measured = past.seconds(&stage.name).map(|each| each * tasks as f64);
    let share = ahead.tasks.map_or(1.0, |all| tasks as f64 / all.count().max(1) as f64);
    let seconds = measured.or(ahead.seconds.map(|all| all * share.min(1.0))).filter(|_| tasks > 0);
    Line {
        name: stage.name.clone(),
        state,
        reasons,
        to_run: open.len(),
        expected,
        unknown: waits && expected.is_none(),
        seconds,
        estimated: measured.is_none() && seconds.is_some_and(|seconds| seconds > 0.0),
    }
}

fn print_lines(lines: &[Line]) {
    let width = lines.iter().map(|line| line.name.chars().count()).max().unwrap_or(0);
    for line in lines {
        let word = if line.estimated { "roughly" } else { "about" };
        let shown = line.seconds.filter(|seconds| !line.estimated && *seconds > 0.0 || *seconds >= 0.05);
        let about = shown.map_or_else(String::new, |s| format!(", {word} {}", duration(s / cores() as f64)));
        out!("{:width$}  {}{about}", line.name, line.state);
        for reason in &line.reasons {
            out!("{:width$}    {reason}", "");
        }
    }
    if let Some(total) = total(lines) {
        out!("{total}");
    }
}

/// The whole campaign in one line; none when nothing is left to do.
fn total(lines: &[Line]) -> Option<String> {
    let expected = || lines.iter().filter_map(|line| line.expected);
    let known: usize = lines.iter().map(|line| line.to_run).sum();
    let tasks = expected().fold(known, |tasks, more| tasks.saturating_add(more.count()));
    let bounded = expected().any(TaskForecast::is_bound);
    let busy: Vec<&Line> = lines.iter().filter(|line| line.to_run > 0 || line.expected.is_some()).collect();
    let unknown = lines.iter().filter(|line| line.unknown).count();
    if busy.is_empty() && unknown == 0 {
        return None;
    }
    let most = if bounded { "at most " } else { "" };
    let stages =
        if unknown > 0 { format!(", and those of {unknown} stages that are not known yet") } else { String::new() };
    let seconds: Option<f64> = busy.iter().map(|line| line.seconds).sum();
    let time = match seconds {
        Some(seconds) if busy.iter().any(|line| line.estimated) => format!(
            ", roughly {} (estimated from the numbers of balls and steps, right within a factor of three; measured times \
             take its place once stages have run here)",
            duration(seconds / cores() as f64)
        ),
        Some(seconds) => format!(", about {}", duration(seconds / cores() as f64)),
        None => "; how long they take is known for stages that ran here before".to_owned(),
    };
    let noun = if tasks == 1 { "task" } else { "tasks" };
    Some(format!("in all {most}{tasks} {noun} to run{stages}{time}"))
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
                "estimated": line.estimated,
                "expected": line.expected.map(|expected| {
                    serde_json::json!({ "tasks": expected.count(), "at_most": expected.is_bound() })
                }),
            })
        })
        .collect();
    serde_json::json!({ "workflow": name, "stages": stages })
}
