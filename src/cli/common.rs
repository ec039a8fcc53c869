//! Options that mean the same on every command that takes a workflow, and the two things each begins with.

use super::color::Color;
use super::{Exit, complete, message};
use crate::plan::{self, Overrides, Workflow};
use crate::report::{duration, moment, quoted};
use crate::run::{Report, commit, decide};
use crate::store::{Mark, Origin, Store};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Once;

/// Which campaign.
#[derive(Args, Clone, Debug)]
pub(super) struct Campaign {
    /// The workflow file.
    pub(super) workflow: PathBuf,
    /// Apply the overrides of `[profile.NAME]`.
    #[arg(long, value_name = "NAME", add = complete::profiles())]
    pub(super) profile: Option<String>,
    /// Override one value of the workflow: `stage.anova.alpha=0.01`, `material.base.mortar.Ec='"20 GPa"'`. May be given
    /// more than once.
    #[arg(long = "set", value_name = "PATH=VALUE", add = complete::settings())]
    pub(super) sets: Vec<String>,
    #[command(flatten)]
    pub(super) common: Common,
}

/// Options of every command that opens a store.
#[derive(Args, Clone, Debug)]
pub(super) struct Common {
    /// The folder of stored results.
    #[arg(long, value_name = "FOLDER", default_value = "store", global = true)]
    pub(super) store: PathBuf,
    /// Colours of messages; by default on a terminal, unless NO_COLOR is set.
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = Color::Auto, global = true)]
    pub(super) color: Color,
    /// Print results and errors only: no progress, no summary, no notes.
    #[arg(long, global = true)]
    pub(super) quiet: bool,
}

impl Campaign {
    /// The checked workflow, or all its faults printed; `stages` are names from the command line that must be in it.
    pub(super) fn load(&self, stages: &[String]) -> Result<Workflow, Exit> {
        let overrides = Overrides { profile: self.profile.clone(), sets: self.sets.clone() };
        let workflow = plan::load(&self.workflow, &overrides).map_err(|faults| {
            message::print(&faults, self.common.color);
            Exit::BadInput
        })?;
        self.known(&workflow, stages)?;
        Ok(workflow)
    }

    /// Whether all these stages are in the workflow; prints those that are not.
    pub(super) fn known(&self, workflow: &Workflow, stages: &[String]) -> Result<(), Exit> {
        let known: Vec<&str> = workflow.stages.iter().map(|stage| stage.name.as_str()).collect();
        let unknown: Vec<&String> = stages.iter().filter(|name| !known.contains(&name.as_str())).collect();
        for name in &unknown {
            let like = plan::nearest(name, known.iter().copied());
            let meant = like.map_or_else(String::new, |like| format!("; did you mean `{like}`?"));
            err!("error: the workflow has no stage `{name}`{meant}\n  it has {}", known.join(", "));
        }
        if unknown.is_empty() { Ok(()) } else { Err(Exit::BadInput) }
    }

    /// As [`Campaign::load`], for commands that run or plan: the files that the workflow names must be there, unless only
    /// some stages are asked for, which may not need them.
    pub(super) fn load_to_run(&self, stages: &[String]) -> Result<Workflow, Exit> {
        let workflow = self.load(stages)?;
        if stages.is_empty() && !workflow.absent.is_empty() {
            message::print(&workflow.absent, self.common.color);
            return Err(Exit::BadInput);
        }
        if !self.common.quiet {
            message::warnings(&workflow.warnings, self.common.color);
        }
        Ok(workflow)
    }

    /// The campaign of a workflow file, without overrides of single values.
    pub(super) fn of(workflow: PathBuf, profile: Option<String>, common: &Common) -> Self {
        Self { workflow, profile, sets: Vec::new(), common: common.clone() }
    }

    /// A command on this very campaign as it is typed into a shell: `flow WORD FILE … --profile …`.
    pub(super) fn command(&self, word: &str, rest: &[&str]) -> String {
        let (file, store) = (self.workflow.display().to_string(), self.common.store.display().to_string());
        let mut parts = vec!["flow", word, &file];
        parts.extend(rest);
        parts.extend(self.profile.iter().flat_map(|profile| ["--profile", profile]));
        parts.extend(self.sets.iter().flat_map(|set| ["--set", set]));
        if self.common.store != Path::new("store") {
            parts.extend(["--store", &store]);
        }
        parts.into_iter().map(quoted).collect::<Vec<_>>().join(" ")
    }

    /// The store; new results are recorded with the git commit of the workflow's folder.
    pub(super) fn open(&self) -> Result<Store, Exit> {
        let folder = self.workflow.parent().unwrap_or(Path::new("")).to_owned();
        Ok(self.common.open()?.with_origin(move || Origin { commit: commit(&folder), ..Origin::here() }))
    }
}

impl Common {
    /// The store.
    pub(super) fn open(&self) -> Result<Store, Exit> {
        self.tell_of_mark();
        Store::open(&self.store).map_err(|e| system(&e))
    }

    /// The store for a command that only reads: nothing is written into it, and none is made.
    pub(super) fn read(&self) -> Result<Store, Exit> {
        self.tell_of_mark();
        Store::open_to_read(&self.store).map_err(|e| system(&e))
    }

    /// Says once why this user's own results are proven again and again.
    fn tell_of_mark(&self) {
        static SAID: Once = Once::new();
        if let Some(fault) = Mark::fault_of_user() {
            SAID.call_once(|| self.note(&format!("warning: {fault}\n  {}", fault.hint)));
        }
    }

    /// Prints a note, which is no result.
    pub(super) fn note(&self, text: &str) {
        if !self.quiet {
            err!("{text}");
        }
    }
}

/// When, by what version, where and of which commit something was computed.
pub(super) fn provenance(started: i64, seconds: f64, origin: &Origin) -> String {
    let Origin { machine, version, commit } = origin;
    if !origin.is_known() {
        return "nobody knows when and where: its record was lost, and the result was found again".to_owned();
    }
    let commit = if commit.is_empty() { String::new() } else { format!(", git commit {commit}") };
    format!("{} UTC, took {}, by flow {version} on {machine}{commit}", moment(started), duration(seconds))
}

/// The number of `--jobs`.
pub(super) fn workers(text: &str) -> Result<usize, String> {
    const MOST: usize = 1024;
    let wanted = || format!("wanted a whole number of 1 or more, at most {MOST}");
    text.parse().ok().filter(|jobs| (1..=MOST).contains(jobs)).ok_or_else(wanted)
}

/// What was read from the attached remote since the last call.
pub(super) fn fetched(store: &Store) -> Option<String> {
    let (count, remote) = store.take_fetched()?;
    Some(format!("{count} {} fetched from {remote}", if count == 1 { "result was" } else { "results were" }))
}

/// What stands in the store of a workflow; prints what of it was found damaged.
pub(super) fn decided(workflow: &Workflow, store: &Store, stages: &[String], memos: bool) -> Result<Report, Exit> {
    let report = decide(workflow, store, stages, memos).map_err(|e| system(&e))?;
    tell_damages(store);
    Ok(report)
}

/// Prints the files of the store that were found damaged since the last call.
pub(super) fn tell_damages(store: &Store) {
    let damages = store.take_damages();
    for damage in &damages {
        err!("warning: {damage}");
    }
    if !damages.is_empty() {
        err!("  `flow store verify` looks at all results");
    }
}

/// Prints what is wrong with the store or the system.
pub(super) fn system(error: &dyn std::error::Error) -> Exit {
    err!("error: {error}");
    Exit::System
}
