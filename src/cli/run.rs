//! `flow run` and `flow plan`: the same decisions, with and without doing.

use super::Exit;
use super::common::Campaign;
use super::progress::Lines;
use crate::exec::cores;
use crate::run::{Report, Settings, StageStatus, run};
use clap::Args;
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Run what is missing of a campaign.
#[derive(Args)]
pub(super) struct Run {
    #[command(flatten)]
    campaign: Campaign,
    /// Only these stages, with all they need.
    stages: Vec<String>,
    /// Tasks at once; the number of cores when not given.
    #[arg(long, short, value_name = "N")]
    jobs: Option<usize>,
    /// Go on with what does not depend on a failed task.
    #[arg(long)]
    keep_going: bool,
    /// Print one JSON document at the end.
    #[arg(long)]
    json: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Show what `run` would do, and why, without doing it.
#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    campaign: Campaign,
    /// Only these stages, with all they need.
    stages: Vec<String>,
}

impl Run {
    pub(super) fn go(self) -> Exit {
        self.report().unwrap_or_else(|exit| exit)
    }

    fn report(&self) -> Result<Exit, Exit> {
        let started = Instant::now();
        let workflow = self.campaign.load()?;
        let store = self.campaign.open()?;
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let handler = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
        if let Err(e) = handler {
            eprintln!("warning: Ctrl-C will not stop cleanly: {e}");
        }
        let settings = Settings {
            jobs: self.jobs.unwrap_or_else(cores),
            keep_going: self.keep_going,
            dry: false,
            targets: self.stages.clone(),
        };
        let report = run(&workflow, &store, &settings, &Lines::new(self.quiet), &stop);
        let seconds = started.elapsed().as_secs_f64();
        if self.json {
            println!("{}", document(&workflow.name, &report, seconds));
        } else if !self.quiet {
            let count = report.tasks();
            println!(
                "{} tasks: {} ran, {} cached, {} failed, {} skipped in {seconds:.1} s",
                count.total, count.ran, count.cached, count.failed, count.skipped
            );
        }
        Ok(exit(&report))
    }
}

impl Plan {
    pub(super) fn go(self) -> Exit {
        self.report().unwrap_or_else(|exit| exit)
    }

    fn report(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load()?;
        let store = self.campaign.open()?;
        let settings = Settings { jobs: 0, keep_going: true, dry: true, targets: self.stages.clone() };
        let report = run(&workflow, &store, &settings, &Lines::new(true), &AtomicBool::new(false));
        for stage in &report.stages {
            let open = stage.tasks.total - stage.tasks.cached;
            println!("{:16} {:12} {} cached, {open} to run", stage.name, state(&stage.status), stage.tasks.cached);
        }
        Ok(Exit::Done)
    }
}

fn exit(report: &Report) -> Exit {
    if let Some(why) = &report.broken {
        eprintln!("error: {why}");
        Exit::System
    } else if report.interrupted {
        Exit::Interrupted
    } else if report.stages.iter().all(|stage| matches!(stage.status, StageStatus::Done(_))) {
        Exit::Done
    } else {
        Exit::Failed
    }
}

fn state(status: &StageStatus) -> &'static str {
    match status {
        StageStatus::Open => "open",
        StageStatus::Done(_) => "done",
        StageStatus::Failed(_) => "failed",
        StageStatus::Skipped(_) => "skipped",
    }
}

fn document(workflow: &str, report: &Report, seconds: f64) -> Value {
    let count = report.tasks();
    let stages: Vec<Value> = report
        .stages
        .iter()
        .map(|stage| {
            let object = match stage.status {
                StageStatus::Done(content) => json!(content.to_string()),
                StageStatus::Open | StageStatus::Failed(_) | StageStatus::Skipped(_) => Value::Null,
            };
            json!({
                "name": stage.name, "kind": stage.kind, "state": state(&stage.status),
                "tasks": stage.tasks.total, "ran": stage.tasks.ran, "object": object,
            })
        })
        .collect();
    json!({
        "workflow": workflow,
        "tasks": {
            "total": count.total, "ran": count.ran, "cached": count.cached, "failed": count.failed,
            "skipped": count.skipped,
        },
        "seconds": seconds,
        "stages": stages,
    })
}
