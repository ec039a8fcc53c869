//! Options that mean the same on every command that takes a workflow, and the two things each begins with.

use super::{Exit, message};
use crate::plan::{self, Overrides, Workflow};
use crate::store::Store;
use clap::{Args, ValueEnum};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Which campaign.
#[derive(Args, Clone, Debug)]
pub(super) struct Campaign {
    /// The workflow file.
    pub(super) workflow: PathBuf,
    /// Apply the overrides of `[profile.NAME]`.
    #[arg(long, value_name = "NAME")]
    pub(super) profile: Option<String>,
    /// Override one value: `stage.anova.alpha=0.01`. May be given more than once.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(super) sets: Vec<String>,
    /// The folder that keeps results.
    #[arg(long, value_name = "FOLDER", default_value = "store")]
    pub(super) store: PathBuf,
    /// Colours of messages; by default on a terminal, unless NO_COLOR is set.
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = Color::Auto)]
    pub(super) color: Color,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Color {
    /// On a terminal, unless NO_COLOR is set.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl Color {
    /// Whether messages on standard error are coloured.
    pub(super) fn on(self) -> bool {
        let wanted = || std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        match self {
            Self::Auto => std::io::stderr().is_terminal() && wanted(),
            Self::Always => true,
            Self::Never => false,
        }
    }
}

impl Campaign {
    /// The checked workflow, or all its faults printed; `stages` are names from the command line that must be in it.
    pub(super) fn load(&self, stages: &[String]) -> Result<Workflow, Exit> {
        let overrides = Overrides { profile: self.profile.clone(), sets: self.sets.clone() };
        let workflow = plan::load(&self.workflow, &overrides).map_err(|faults| {
            message::print(&faults, self.color);
            Exit::BadInput
        })?;
        let known: Vec<&str> = workflow.stages.iter().map(|stage| stage.name.as_str()).collect();
        let unknown: Vec<&String> = stages.iter().filter(|name| !known.contains(&name.as_str())).collect();
        for name in &unknown {
            let like = plan::nearest(name, known.iter().copied());
            let meant = like.map_or_else(String::new, |like| format!("; did you mean `{like}`?"));
            eprintln!("error: the workflow has no stage `{name}`{meant}\n  it has {}", known.join(", "));
        }
        if unknown.is_empty() { Ok(workflow) } else { Err(Exit::BadInput) }
    }

    /// The command that runs `stages` of this very campaign.
    pub(super) fn again(&self, stages: &[&str]) -> String {
        let mut parts = vec!["flow run".to_owned(), self.workflow.display().to_string()];
        parts.extend(stages.iter().map(|&stage| stage.to_owned()));
        parts.extend(self.profile.iter().map(|profile| format!("--profile {profile}")));
        parts.extend(self.sets.iter().map(|set| format!("--set '{set}'")));
        if self.store != Path::new("store") {
            parts.push(format!("--store {}", self.store.display()));
        }
        parts.join(" ")
    }

    /// The store.
    pub(super) fn open(&self) -> Result<Store, Exit> {
        Store::open(&self.store).map_err(|e| system(&e))
    }
}

/// Prints what is wrong with the store or the system.
pub(super) fn system(error: &dyn std::error::Error) -> Exit {
    eprintln!("error: {error}");
    Exit::System
}
