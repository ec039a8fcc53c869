//! What a person types and reads: the only place that prints.
//!
//! Results go to standard output, everything else to standard error. Exit codes: 0 done, 1 a task failed, 2 the input
//! is wrong, 3 the store or the system failed, 130 interrupted.

#[macro_use]
mod output;
mod calibrate;
mod check;
mod color;
mod common;
mod complete;
mod completions;
mod diff;
mod examples;
mod export;
mod files;
mod graph;
mod message;
mod new;
mod notes;
mod plan;
mod progress;
mod report;
mod run;
mod schema;
mod sheet;
mod show;
mod site;
mod store;
mod whole;
mod work;

use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::Arc;

/// Numerical-experiment campaigns with bonded-particle models, from one TOML file.
#[derive(Parser)]
#[command(name = "flow", version, propagate_version = true, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compute the missing results of a campaign.
    #[command(after_help = examples::RUN)]
    Run(run::Run),
    /// Show what `run` would do, and why, without doing it.
    #[command(after_help = examples::PLAN)]
    Plan(plan::Plan),
    /// Show a result as a table.
    #[command(after_help = examples::SHOW)]
    Show(show::Show),
    /// Find the parameters for other targets, on the surfaces of a finished campaign.
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(calibrate::Calibrate),
    /// Find every fault of a workflow without running anything.
    #[command(after_help = examples::CHECK)]
    Check(check::Check),
    /// Show the stages, their inputs, and their progress.
    #[command(after_help = examples::GRAPH)]
    Graph(graph::Graph),
    /// Write a page with every table and figure of a campaign.
    #[command(after_help = examples::REPORT)]
    Report(report::Report),
    /// Write results as files: pictures, printed tables, CSV.
    #[command(after_help = examples::EXPORT)]
    Export(export::Export),
    /// Compare two campaigns: settings that differ, results that differ.
    #[command(after_help = examples::DIFF)]
    Diff(diff::Diff),
    /// Manage the store: list, verify, sizes, remove unused results.
    #[command(after_help = examples::STORE)]
    Store(store::StoreCommand),
    /// Describe a cluster for `flow run --executor slurm`.
    #[command(after_help = examples::SITE)]
    Site(site::SiteCommand),
    /// Take tasks from a queue of a cluster (the jobs of `flow run --executor slurm` do this).
    #[command(hide = true)]
    Work(work::Work),
    /// Write a commented workflow to start from.
    #[command(after_help = examples::NEW)]
    New(new::New),
    /// Print the JSON Schema of workflow files, for editors.
    #[command(after_help = examples::SCHEMA)]
    Schema(schema::Schema),
    /// Print completions for a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(completions::Completions),
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success.
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

/// Reads the command line and executes it.
pub fn main() -> ExitCode {
    // A file beyond the limit of the user (`ulimit -f`) is an error of the write, which is reported, and not the end of the
    // process. Where the signal cannot be taken it ends it, as it would have.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    // Set by the script of `flow completions` alone, when a shell asks what may stand next on the line.
    clap_complete::CompleteEnv::with_factory(Arguments::command).var(complete::ASKED).complete();
    ExitCode::from(execute(std::env::args_os()) as u8)
}

/// Executes a command line; its first word is the program.
fn execute<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> Exit {
    let read = match Arguments::try_parse_from(arguments) {
        Ok(read) => read,
        Err(answer) => return answered(&answer),
    };
    match read.command {
        Command::Run(run) => run.go(),
        Command::Plan(plan) => plan.go(),
        Command::Show(show) => show.go(),
        Command::Report(report) => report.go(),
        Command::Export(export) => export.go(),
        Command::Calibrate(calibrate) => calibrate.go(),
        Command::Diff(diff) => diff.go(),
        Command::Store(store) => store.go(),
        Command::Site(site) => site.go(),
        Command::Work(work) => work.go(),
        Command::Check(check) => check.go(),
        Command::Graph(graph) => graph.go(),
        Command::New(new) => new.go(),
        Command::Schema(schema) => schema.go(),
        Command::Completions(completions) => completions.go(),
    }
}

/// Prints what the reader of the command line answers itself: what is wrong with it, or the help that it asks for.
fn answered(answer: &clap::Error) -> Exit {
    match answer.print() {
        _ if answer.use_stderr() => Exit::BadInput,
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Exit::System,
        _ => Exit::Done,
    }
}

#[cfg(test)]
mod tests;
