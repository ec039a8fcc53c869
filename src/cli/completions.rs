//! `flow completions`: what a shell needs to complete commands and options, and the names in a workflow.

use super::{Exit, complete};
use clap::Args;
use clap_complete::env::Shells;

/// Print the completions of a shell, to be sourced by it.
#[derive(Args)]
pub(super) struct Completions {
    /// The shell.
    #[arg(value_parser = ["bash", "elvish", "fish", "powershell", "zsh"])]
    shell: String,
}

impl Completions {
    pub(super) fn go(self) -> Exit {
        let shells = Shells::builtins();
        let mut script = Vec::new();
        let shell = shells.completer(&self.shell);
        let written = shell.map(|shell| shell.write_registration(complete::ASKED, "flow", "flow", "flow", &mut script));
        if !matches!(written, Some(Ok(()))) {
            err!("error: there are no completions for `{}`", self.shell);
            return Exit::System;
        }
        super::output::write(&String::from_utf8_lossy(&script));
        Exit::Done
    }
}
