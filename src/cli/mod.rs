//! What a person types and reads: the only place that prints.
//!
//! Results go to standard output, everything else to standard error. Exit codes: 0 done, 1 a task failed, 2 the input
//! is wrong, 3 the store or the system failed, 130 interrupted.

mod common;
mod diff;
mod plan;
mod progress;
mod run;
mod show;
mod store;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Numerical-experiment campaigns with bonded-particle models, from one TOML file.
#[derive(Parser)]
#[command(name = "flow", version, propagate_version = true, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run what is missing of a campaign.
    Run(run::Run),
    /// Show what `run` would do, and why, without doing it.
    Plan(plan::Plan),
    /// Show a result as a table.
    Show(show::Show),
    /// Compare two campaigns: what was set otherwise, what came out otherwise.
    Diff(diff::Diff),
    /// Look after the store: list, verify, sizes, remove what nothing reaches.
    Store(store::StoreCommand),
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All well.
    Done = 0,
    /// A task failed.
    Failed = 1,
    /// The input is wrong.
    BadInput = 2,
    /// The store or the system failed.
    System = 3,
    /// Stopped by the user.
    Interrupted = 130,
}

/// Reads the command line and does what it says.
pub fn main() -> ExitCode {
    let exit = match Arguments::parse().command {
        Command::Run(run) => run.go(),
        Command::Plan(plan) => plan.go(),
        Command::Show(show) => show.go(),
        Command::Diff(diff) => diff.go(),
        Command::Store(store) => store.go(),
    };
    ExitCode::from(exit as u8)
}
