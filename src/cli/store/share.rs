//! Sharing results: push, pull, mirror, audit.

use super::super::Exit;
use super::super::common::{Campaign, Common, decided, system};
use super::super::progress::task_name;
use super::super::run::interruption;
use crate::exec::cores;
use crate::run::{Audited, audit};
use crate::store::{Address, RemoteError, Signing, Trust, mirror};
use clap::Args;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Push {
    /// The remote: a folder that is empty or was pushed to before, or s3://BUCKET/PREFIX.
    remote: String,
    #[command(flatten)]
    server: Server,
    /// Sign with this SSH key, such as `~/.ssh/id_ed25519`.
    #[arg(long, value_name = "KEY", required_unless_present = "unsigned")]
    sign: Option<PathBuf>,
    /// Do not sign: people who pull must then use --unsigned too.
    #[arg(long, conflicts_with = "sign")]
    unsigned: bool,
}

#[derive(Args)]
pub(super) struct Pull {
    #[command(flatten)]
    source: Source,
}

#[derive(Args)]
pub(super) struct Attach {
    #[command(flatten)]
    source: Source,
}

/// A remote, and whose results are taken from it.
#[derive(Args)]
struct Source {
    /// The remote: a folder, or s3://BUCKET/PREFIX.
    remote: String,
    #[command(flatten)]
    server: Server,
    #[command(flatten)]
    whom: Whom,
}

impl Source {
    fn trusted(&self) -> Result<(Address, Trust), Exit> {
        Ok((self.server.address(&self.remote)?, self.whom.trust()?))
    }
}

/// Whose results are taken.
#[derive(Args)]
struct Whom {
    /// The people whose results are taken: a file of allowed signers as for ssh and git, one `NAME namespaces="flow-store" KEY` a line.
    #[arg(long, value_name = "FILE", default_value = "allowed_signers")]
    signers: PathBuf,
    /// Take results of anybody. It is proven that a result belongs to its task, not that its values are right.
    #[arg(long)]
    unsigned: bool,
}

impl Whom {
    fn trust(&self) -> Result<Trust, Exit> {
        if !self.unsigned && !self.signers.is_file() {
            err!(
                "error: there is no file {} of those whose results are taken\n  name one with `--signers`, or take \
                 anybody's with `--unsigned`",
                self.signers.display()
            );
            return Err(Exit::BadInput);
        }
        Ok(if self.unsigned { Trust::Anybody } else { Trust::Signers(self.signers.clone()) })
    }
}

#[derive(Args)]
pub(super) struct Mirror {
    /// The remote to copy: a folder, or s3://BUCKET/PREFIX.
    from: String,
    /// The remote to copy it to.
    to: String,
    #[command(flatten)]
    server: Server,
}

/// The server of a bucket.
#[derive(Args)]
struct Server {
    /// The server of an s3:// remote that is not Amazon's, such as `https://minio.uni.edu` [default: AWS_ENDPOINT_URL, or
    /// `endpoint_url` of the profile AWS_PROFILE].
    #[arg(long, value_name = "URL")]
    endpoint: Option<String>,
}

impl Server {
    fn address(&self, remote: &str) -> Result<Address, Exit> {
        Address::parse(remote, self.endpoint.as_deref()).map_err(wrong)
    }
}

fn wrong(why: String) -> Exit {
    err!("error: {why}");
    Exit::BadInput
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
        RemoteError::Server { .. } | RemoteError::Signing(_) | RemoteError::Damaged { .. } => system(error),
    }
}

impl Push {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        let signing = self.sign.clone().map_or(Signing::None, Signing::Key);
        let pushed =
            common.open()?.push(&self.server.address(&self.remote)?, &signing).map_err(|error| failed(&error))?;
        out!("{} results pushed, {} were there", pushed.pushed, pushed.there);
        Ok(Exit::Done)
    }
}

impl Pull {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        let (address, trust) = self.source.trusted()?;
        let pulled = common.open()?.pull(&address, &trust).map_err(|error| failed(&error))?;
        out!("{} results pulled, {} were here, {} refused", pulled.pulled, pulled.here, pulled.refused.len());
        Ok(taken(&pulled.signers, &pulled.refused))
    }
}

impl Attach {
    pub(super) fn go(&self, common: &Common) -> Result<Exit, Exit> {
        let (address, trust) = self.source.trusted()?;
        let attached = common.open()?.attach(&address, &trust).map_err(|error| failed(&error))?;
        out!(
            "{address} is attached: {} results can be read from it, each is fetched when it is needed",
            attached.results
        );
        Ok(taken(&attached.signers, &attached.refused))
    }
}

/// Says whose results were taken and what was refused.
fn taken(signers: &BTreeMap<String, usize>, refused: &[String]) -> Exit {
    signers.iter().for_each(|(signer, count)| out!("  {count} signed by {signer}"));
    refused.iter().for_each(|why| err!("refused: {why}"));
    if refused.is_empty() { Exit::Done } else { Exit::System }
}

impl Mirror {
    pub(super) fn go(&self) -> Result<Exit, Exit> {
        // The server is that of whichever is a bucket.
        let address = |remote: &str| match remote.contains("://") {
            true => self.server.address(remote),
            false => Address::parse(remote, None).map_err(wrong),
        };
        let mirrored = mirror(&address(&self.from)?, &address(&self.to)?).map_err(|error| failed(&error))?;
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
        let report = decided(&workflow, &store, &[], false)?;
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
