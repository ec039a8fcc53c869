//! `flow run`: computes what is missing.

use super::common::{Campaign, fetched, system, tell_damages, workers};
use super::notes::notes;
use super::progress::{Ahead, Progress, task_name};
use super::site;
use super::{Exit, complete};
use crate::cluster::{Site, scheduler};
use crate::exec::cores;
use crate::plan::Workflow;
use crate::report::duration;
use crate::run::{
    Cluster, Past, Report, RunSettings, Silent, StageReport, StageStatus, TaskState, Watch, forecasts_of, record, run,
};
use crate::stage::command::leftover;
use crate::store::Store;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// Compute the missing results of a campaign.
#[derive(Args)]
pub(super) struct Run {
    #[command(flatten)]
    campaign: Campaign,
    /// Only these stages, with all they need.
    #[arg(add = complete::stages())]
    stages: Vec<String>,
    /// Tasks at once; the number of cores when not given.
    #[arg(long, short, value_name = "N", value_parser = workers)]
    jobs: Option<usize>,
    /// Where tasks run.
    #[arg(long, value_enum, value_name = "NAME", default_value = "threads")]
    executor: Executor,
    /// The cluster: the name of a site file (see `flow site`), or a path to one. The site `default` when not given.
    #[arg(long, value_name = "NAME")]
    site: Option<String>,
    /// Show what would be submitted to the cluster, and submit nothing.
    #[arg(long)]
    dry_run: bool,
    /// After a failure, continue with tasks that do not depend on it.
    #[arg(long)]
    keep_going: bool,
    /// Compute this stage again although its results are stored, because a program or file outside its key has changed: all of
    /// its tasks, however long they take, and with a simulator every simulation. What follows runs again only where a result
    /// differs. May be given more than once.
    #[arg(long, value_name = "STAGE")]
    again: Vec<String>,
    /// Print one JSON document at the end.
    #[arg(long)]
    json: bool,
}

/// What can run tasks.
#[derive(Clone, Copy, ValueEnum)]
enum Executor {
    /// Threads of this process.
    Threads,
    /// Workers that a scheduler starts on other machines: Slurm, or the scheduler of the site file.
    #[value(alias = "cluster")]
    Slurm,
}

impl Run {
    pub(super) fn go(self) -> Exit {
        self.report().unwrap_or_else(|exit| exit)
    }

    fn report(&self) -> Result<Exit, Exit> {
        let started = SystemTime::now();
        let workflow = self.campaign.load_to_run(&self.stages)?;
        self.campaign.known(&workflow, &self.again)?;
        let cluster = self.cluster()?;
        let store = self.campaign.open()?;
        if let Some(cluster) = cluster.as_ref().filter(|_| self.dry_run) {
            return Ok(site::show_submission(&workflow, &store, &cluster.site, &self.stages));
        }
        let stop = interruption(cluster.as_ref().map(|cluster| &cluster.leave));
        leftover::sweep().iter().for_each(|line| err!("warning: {line}"));
        let jobs = self.jobs.unwrap_or_else(cores);
        let settings = RunSettings {
            jobs,
            keep_going: self.keep_going,
            dry: false,
            targets: self.stages.clone(),
            again: self.again.clone(),
            memos: self.again.is_empty(),
            cluster,
        };
        let watch: Box<dyn Watch> = match self.campaign.common.quiet {
            true => Box::new(Silent),
            false => Box::new(Progress::new(|| ahead(&workflow, &self.stages, &store), jobs)),
        };
        let report = run(&workflow, &store, &settings, &*watch, &stop);
        drop(watch);
        tell_damages(&store);
        if let Some(line) = fetched(&store).filter(|_| !self.campaign.common.quiet) {
            err!("{line}");
        }
        let did = report.count().ran + report.count().failed > 0;
        let recorded = did.then(|| record(&workflow, &self.campaign.sets, &report, started, &store));
        let number = recorded.transpose().map_err(|e| system(&e))?;
        let seconds = started.elapsed().unwrap_or_default().as_secs_f64();
        let missed = unmet(&workflow, &report, &store);
        if self.json {
            out!("{}", document(&workflow.name, &report, &missed, seconds));
        } else if !self.campaign.common.quiet {
            out!("{}", summary(&report, seconds, number));
        }
        self.failures(&workflow, &report);
        if !self.campaign.common.quiet {
            notes(&self.campaign, &report, &store).iter().for_each(|line| err!("{line}"));
        }
        missed.iter().for_each(|(stage, why)| err!("unmet: {stage}: {why}"));
        let exit = match exit(&report) {
            Exit::Done if !missed.is_empty() => Exit::Failed,
            exit => exit,
        };
        // The process ends now; the system frees its memory faster than this process can piece by piece.
        std::mem::forget((workflow, store, report));
        Ok(exit)
    }

    /// The cluster that runs the tasks, when one does.
    fn cluster(&self) -> Result<Option<Cluster>, Exit> {
        match self.executor {
            Executor::Threads if self.site.is_some() || self.dry_run => {
                let option = if self.dry_run { "--dry-run" } else { "--site" };
                err!("error: `{option}` needs `--executor slurm`\n  `flow plan` shows what a run would do here");
                Err(Exit::BadInput)
            }
            Executor::Threads => Ok(None),
            Executor::Slurm => {
                let site = Site::load(self.site.as_deref()).map_err(|error| {
                    err!("error: {error}");
                    Exit::BadInput
                })?;
                let missing = scheduler::missing(&site);
                if !missing.is_empty() && !self.dry_run {
                    err!(
                        "error: `--executor slurm` needs {}, which this machine has not\n  run it on a login node of the \
                         cluster, see that the commands are in PATH, or leave the option out to compute here",
                        missing.iter().map(|program| format!("`{program}`")).collect::<Vec<_>>().join(", ")
                    );
                    return Err(Exit::BadInput);
                }
                Ok(Some(Cluster { site, leave: Arc::default() }))
            }
        }
    }

    /// Every task that failed, and every stage that did so by itself, with the command that runs them again.
    fn failures(&self, workflow: &Workflow, report: &Report) {
        let mut by_stage: Vec<Vec<String>> = vec![Vec::new(); workflow.stages.len()];
        for task in report.tasks() {
            if let TaskState::Failed(why) = &task.state {
                let name = workflow.stages[task.stage].name.as_str();
                by_stage[task.stage].push(format!("failed: {}: {why}", task_name(name, task.row)));
            }
        }
        for stage in &report.stages {
            let Some(lines) = workflow.position(&stage.name).map(|index| &mut by_stage[index]) else { continue };
            if let (StageStatus::Failed(why), true) = (&stage.status, lines.is_empty()) {
                lines.push(format!("failed: {}: {why}", stage.name));
            }
            lines.iter().for_each(|line| err!("{line}"));
            if !lines.is_empty() {
                err!("  again: {}", self.campaign.command("run", &[&stage.name]));
            }
        }
    }
}

/// A flag that Ctrl-C, a termination request or the end of the terminal sets; a second one, or tasks that do not end within
/// a second, end the process at once. Of workers on other machines only Ctrl-C is the end: at the others `leave` is set.
pub(super) fn interruption(leave: Option<&Arc<AtomicBool>>) -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let (interrupted, leave) = (Arc::clone(&stop), leave.map(Arc::clone));
    let patience = if leave.is_some() { PATIENCE_FAR } else { PATIENCE };
    let wanted: &[i32] = if hangup_is_ignored() { &[SIGINT, SIGTERM] } else { &[SIGINT, SIGTERM, SIGHUP] };
    let heard = match Signals::new(wanted) {
        Ok(mut signals) => listen(move || {
            for signal in signals.forever() {
                if let Some(leave) = leave.as_ref().filter(|_| signal != SIGINT) {
                    leave.store(true, Ordering::Relaxed);
                }
                if interrupted.swap(true, Ordering::Relaxed) {
                    at_once();
                }
                err!("stopping: finished tasks are stored; press Ctrl-C again to stop at once");
                listen(move || {
                    std::thread::sleep(patience);
                    err!("interrupted; run again to continue: the tasks that ran were ended and will start again");
                    at_once();
                });
            }
        }),
        Err(e) => {
            err!("warning: Ctrl-C will not stop cleanly: {e}");
            false
        }
    };
    if !heard {
        // These need no thread: the first signal sets the flag, the second one ends the process.
        for &signal in wanted {
            let _ = flag::register_conditional_shutdown(signal, Exit::Interrupted as i32, Arc::clone(&stop));
            let _ = flag::register(signal, Arc::clone(&stop));
        }
    }
    stop
}

/// Runs this beside everything else. Warns and returns `false` where no thread can be started.
fn listen(work: impl FnOnce() + Send + 'static) -> bool {
    let started = std::thread::Builder::new().spawn(work);
    if let Err(error) = &started {
        err!("warning: Ctrl-C will not stop cleanly: no thread can be started: {error}");
    }
    started.is_ok()
}

/// How long tasks may take to end by themselves. Statistics and packings look at the flag only now and then, and a store is
/// sound whenever a campaign is killed.
const PATIENCE: Duration = Duration::from_millis(850);

/// The same, when the scheduler must cancel jobs meanwhile.
const PATIENCE_FAR: Duration = Duration::from_secs(20);

/// Ends this process and the programs that it runs.
fn at_once() -> ! {
    leftover::end_own();
    std::process::exit(Exit::Interrupted as i32)
}

/// Whether `nohup` (or the like) started this process: then the end of the terminal must not end the campaign.
fn hangup_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 << (SIGHUP - 1)) != 0
}

/// What is expected of a campaign of these stages, or of all when none is named.
pub(super) fn ahead<'a>(workflow: &'a Workflow, stages: &[String], store: &Store) -> Ahead<'a> {
    let past = Past::of(workflow, store).ok();
    let seconds = |name: &String| Some((name.clone(), past.as_ref()?.seconds(name)?));
    let seconds = workflow.stages.iter().filter_map(|stage| seconds(&stage.name)).collect();
    Ahead { forecasts: forecasts_of(workflow, stages), seconds }
}

fn summary(report: &Report, seconds: f64, number: Option<u64>) -> String {
    let count = report.count();
    let mut parts = vec![format!("{} ran", count.ran), format!("{} cached", count.cached)];
    for (n, word) in [(count.failed, "failed"), (count.skipped, "skipped")] {
        if n > 0 {
            parts.push(format!("{n} {word}"));
        }
    }
    if report.interrupted {
        parts.push("interrupted; run again to continue".to_owned());
    }
    let recorded = number.map_or_else(String::new, |number| format!("; run #{number}"));
    let tasks = if count.total == 1 { "task" } else { "tasks" };
    format!("{} {tasks}: {} in {}{recorded}", count.total, parts.join(", "), duration(seconds))
}

fn exit(report: &Report) -> Exit {
    if let Some(why) = &report.broken {
        err!("error: {why}");
        Exit::System
    } else if report.interrupted {
        Exit::Interrupted
    } else if report.stages.iter().all(|stage| matches!(stage.status, StageStatus::Done(_))) {
        Exit::Done
    } else {
        Exit::Failed
    }
}

/// What finished stages do not give though the workflow asks it of them, by stage.
fn unmet(workflow: &Workflow, report: &Report, store: &Store) -> Vec<(String, String)> {
    let why = |stage: &StageReport| {
        let StageStatus::Done(content) = &stage.status else { return None };
        let index = workflow.position(&stage.name)?;
        let why = workflow.stages[index].stage.demands()?.unmet(&*store.get(content).ok()?)?;
        Some((stage.name.clone(), why))
    };
    report.stages.iter().filter_map(why).collect()
}

fn document(workflow: &str, report: &Report, missed: &[(String, String)], seconds: f64) -> Value {
    let count = report.count();
    let stages: Vec<Value> = report
        .stages
        .iter()
        .map(|stage| {
            let object = match &stage.status {
                StageStatus::Done(content) => json!(content.to_string()),
                StageStatus::Open | StageStatus::Failed(_) | StageStatus::Skipped(_) => Value::Null,
            };
            let unmet = missed.iter().find(|(name, _)| *name == stage.name).map(|(_, why)| why);
            json!({
                "name": stage.name, "kind": stage.kind, "state": stage.status.word(),
                "tasks": stage.tasks.total, "ran": stage.tasks.ran, "object": object, "unmet": unmet,
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
