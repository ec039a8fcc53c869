//! `flow site`: descriptions of clusters, and the script that would be submitted to one.

use super::common::system;
use super::{Exit, examples};
use crate::cluster::Site;
use crate::cluster::script::{Order, script};
use crate::cluster::site::{self, Needs};
use crate::plan::Workflow;
use crate::run::{TaskState, decide};
use crate::stage::is_far;
use crate::store::Store;
use clap::{Args, Subcommand};
use std::path::Path;

/// Describe a cluster for `flow run --executor slurm`.
#[derive(Args)]
pub(super) struct SiteCommand {
    #[command(subcommand)]
    command: What,
}

#[derive(Subcommand)]
enum What {
    /// List the site files.
    #[command(after_help = examples::SITE_LS)]
    Ls,
    /// Write a commented site file to fill in.
    #[command(after_help = examples::SITE_NEW)]
    New {
        /// Name of the site.
        name: String,
    },
    /// Read a site file and show the script that it makes.
    #[command(after_help = examples::SITE_CHECK)]
    Check {
        /// Name of the site, or a path to its file.
        name: Option<String>,
    },
    /// Print the JSON Schema of site files, for editors.
    #[command(after_help = examples::SITE_SCHEMA)]
    Schema,
}

const TEMPLATE: &str = include_str!("site/template.toml");

impl SiteCommand {
    pub(super) fn go(self) -> Exit {
        match self.command {
            What::Ls => {
                site::names().iter().for_each(|name| out!("{name}"));
                err!("site files lie in {}", site::folder().display());
                Exit::Done
            }
            What::New { name } => new(&name),
            What::Check { name } => check(name.as_deref()),
            What::Schema => {
                let schema = schemars::schema_for!(Site);
                out!("{}", serde_json::to_string_pretty(&schema).unwrap_or_default());
                Exit::Done
            }
        }
    }
}

fn new(name: &str) -> Exit {
    if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte)) {
        err!("error: `{name}` is no name of a site; use letters, digits, `-` and `_`");
        return Exit::BadInput;
    }
    let path = site::folder().join(format!("{name}.toml"));
    let made = std::fs::create_dir_all(site::folder()).and_then(|()| std::fs::File::create_new(&path));
    match made.and_then(|mut file| std::io::Write::write_all(&mut file, TEMPLATE.as_bytes())) {
        Ok(()) => {
            out!("{}", path.display());
            err!("fill it in, then `flow site check {name}`");
            Exit::Done
        }
        Err(error) => {
            err!("error: {}: {error}", path.display());
            Exit::System
        }
    }
}

fn check(name: Option<&str>) -> Exit {
    match Site::load(name) {
        Ok(site) => {
            let workers = site.workers;
            out!("{}", text(&site, &site.needs(""), Path::new("store"), workers).trim_end());
            Exit::Done
        }
        Err(error) => {
            err!("error: {error}");
            Exit::BadInput
        }
    }
}

/// The script of a first submission.
fn text(site: &Site, needs: &Needs, store: &Path, workers: usize) -> String {
    let store = std::path::absolute(store).unwrap_or_else(|_| store.to_owned());
    let program = std::env::current_exe().unwrap_or_else(|_| "flow".into());
    let folder = store.join("queue/ID");
    let (queue, secret) = ("ID", "SECRET");
    script(&Order { site, needs, queue, folder: &folder, store: &store, program: &program, secret, round: 1, workers })
}

/// Prints what `flow run` would submit first.
pub(super) fn show_submission(workflow: &Workflow, store: &Store, site: &Site, stages: &[String]) -> Exit {
    let report = match decide(workflow, store, stages, true) {
        Ok(report) => report,
        Err(unreadable) => return system(&unreadable),
    };
    let mut counts: Vec<(Needs, usize)> = Vec::new();
    for task in report.tasks().filter(|task| task.state == TaskState::Open) {
        let stage = &workflow.stages[task.stage].name;
        let name = task.text.as_deref().and_then(|text| text.lines().nth(1)?.split(' ').nth(1));
        if !name.is_some_and(|name| site.sends(stage, is_far(name))) {
            continue;
        }
        let needs = site.needs(stage);
        match counts.iter_mut().find(|(known, _)| *known == needs) {
            Some((_, count)) => *count += 1,
            None => counts.push((needs, 1)),
        }
    }
    for (needs, tasks) in &counts {
        let workers = needs.workers.min(tasks.div_ceil(needs.cpus));
        let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        err!("ready: {} for {}", plural(*tasks, "task"), plural(workers, "worker"));
        out!("{}", text(site, needs, store.root(), workers).trim_end());
    }
    if counts.is_empty() {
        err!(
            "no task for the cluster is ready yet: its inputs are computed here first. A submission would look like this:"
        );
        out!("{}", text(site, &site.needs(""), store.root(), site.workers).trim_end());
    } else {
        err!("tasks that need these results follow later");
    }
    Exit::Done
}
