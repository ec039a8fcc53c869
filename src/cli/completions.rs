//! `flow completions`: what a shell needs to complete commands and options.

use super::{Arguments, Exit};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

/// Print the completions of a shell, to be sourced by it.
#[derive(Args)]
pub(super) struct Completions {
    /// The shell.
    shell: Shell,
}

impl Completions {
    pub(super) fn go(self) -> Exit {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "flow", &mut script);
        super::output::write(&String::from_utf8_lossy(&script));
        Exit::Done
    }
}
