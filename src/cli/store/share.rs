//! Sharing results: push, pull, mirror, audit.

use super::super::Exit;
use super::super::common::{Campaign, Common, system};
use super::super::progress::task_name;
use super::super::run::interruption;
use crate::exec::cores;
use crate::run::{Audited, audit, decide};
use crate::store::{RemoteError, Signing, Trust, mirror};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Push {
    /// The remote: a folder that is empty or was pushed to before.
    remote: PathBuf,
    /// Sign with this SSH key, such as `~/.ssh/id_ed25519`.
    #[arg(long, value_name = "KEY", required_unless_present = "unsigned")]
    sign: Option<PathBuf>,
    /// Do not sign: people who pull must then use --unsigned too.
    #[arg(long, conflicts_with = "sign")]
    unsigned: bool,
}

#[derive(Args)]
pub(super) struct Pull {
    /// The remote.
    remote: PathBuf,
    /// The people whose results are taken: a file of allowed signers as for ssh and git, one `NAME namespaces="flow-store" KEY` a line.
    #[arg(long, value_name = "FILE", default_value = "allowed_signers")]
    signers: PathBuf,
    /// Take results of anybody. It is proven that a result belongs to its task, not that its values are right.
    #[arg(long)]
    unsigned: bool,
}

#[derive(Args)]
pub(super) struct Mirror {
    /// The remote to copy.
    from: PathBuf,
    /// The remote to copy it to.
    to: PathBuf,
}

#[derive(Args)]
pub(super) struct Audit {
    /// The workflow file.
    workflow: PathBuf,
    /// Its profile.
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,
    /// How many results, drawn at random.
    #[arg(long, value_name = "N", default_value = "3")]
    sample: usize,
}

/// Prints what is wrong with a remote.
fn failed(error: &RemoteError) -> Exit {
    match error {
        RemoteError::Store(error) => system(error),
        RemoteError::NotARemote { .. } => {
            err!("error: {error}");
            Exit::BadInput
        }
        RemoteError::Signing(_) | RemoteError::Damaged { .. } => system(error),
    }
}

impl Push {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        let signing = self.sign.clone().map_or(Signing::None, Signing::Key);
        let pushed = common.open()?.push(&self.remote, &signing).map_err(|error| failed(&error))?;
        out!("{} results pushed, {} were there", pushed.pushed, pushed.there);
        Ok(Exit::Done)
    }
}

impl Pull {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        if !self.unsigned && !self.signers.is_file() {
            err!(
                "error: there is no file {} of those whose results are taken\n  name one with `--signers`, or take \
                 anybody's with `--unsigned`",
                self.signers.display()
            );
            return Err(Exit::BadInput);
        }
        let trust = if self.unsigned { Trust::Anybody } else { Trust::Signers(self.signers.clone()) };
        let pulled = common.open()?.pull(&self.remote, &trust).map_err(|error| failed(&error))?;
        out!("{} results pulled, {} were here, {} refused", pulled.pulled, pulled.here, pulled.refused.len());
        pulled.signers.iter().for_each(|(signer, count)| out!("  {count} signed by {signer}"));
        pulled.refused.iter().for_each(|why| err!("refused: {why}"));
        Ok(if pulled.refused.is_empty() { Exit::Done } else { Exit::System })
    }
}

impl Mirror {
    pub(super) fn go(&self) -> Result<Exit, Exit> {
        let mirrored = mirror(&self.from, &self.to).map_err(|error| failed(&error))?;
        out!("{} lists and {} results copied", mirrored.segments, mirrored.objects);
        Ok(Exit::Done)
    }
}

impl Audit {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        let campaign = Campaign::of(self.workflow.clone(), self.profile.clone(), common);
        let workflow = campaign.load(&[])?;
        let store = campaign.open()?;
        let stop = interruption(None);
        let report = decide(&workflow, &store, &[], false);
        let mut exit = Exit::Done;
        let audited = audit(&report, &store, self.sample, cores(), &stop);
        let audited = audited.map_err(|why| system(&std::io::Error::other(why)))?;
        for Audited { stage, row, stored, computed } in &audited {
            let name = task_name(&workflow.stages[*stage].name, *row);
            match computed {
                Ok(content) if content == stored => out!("{name}: computed again, equal to the last bit"),
                Ok(content) => {
                    out!(
                        "{name}: computed again, and DIFFERENT: {:.16} is stored, {:.16} was computed; do not trust who \
                         made it, and run `flow run {} --again {}`",
                        stored.to_string(),
                        content.to_string(),
                        self.workflow.display(),
                        workflow.stages[*stage].name
                    );
                    exit = Exit::Failed;
                }
                Err(why) => {
                    out!("{name}: could not be computed again: {why}");
                    exit = Exit::Failed;
                }
            }
        }
        if audited.is_empty() {
            out!("no result of this workflow that takes long to compute is in the store");
        }
        Ok(exit)
    }
}
