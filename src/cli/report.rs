//! `flow report`: a campaign as one page that can be sent to a colleague.

use super::Exit;
use super::common::{Campaign, fetched, system, tell_damages};
use super::files::Files;
use super::output;
use super::store::bytes;
use crate::report::{Asked, Paper, gather, page};
use clap::Args;
use std::path::{Path, PathBuf};

/// Write one HTML page with every table and figure of a campaign; it needs no network and computes nothing.
#[derive(Args)]
pub(super) struct Report {
    #[command(flatten)]
    campaign: Campaign,
    /// The file that is written; `-` for standard output.
    #[arg(long, short, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
}

impl Report {
    pub(super) fn go(self) -> Exit {
        self.write().unwrap_or_else(|exit| exit)
    }

    fn write(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load(&[])?;
        let text = std::fs::read_to_string(&self.campaign.workflow).map_err(|e| system(&e))?;
        let store = self.campaign.common.read()?;
        let named = self.campaign.common.store.display().to_string();
        let asked = Asked {
            text,
            sets: self.campaign.sets.clone(),
            store: if named == "store" { String::new() } else { named },
        };
        let paper = gather(&workflow, asked, &store).map_err(|e| system(&*e))?;
        tell_damages(&store);
        if let Some(line) = fetched(&store).filter(|_| !self.campaign.common.quiet) {
            err!("{line}");
        }
        let html = page(&paper);
        if self.output == Path::new("-") {
            output::write(&html);
        } else {
            Files::of(&workflow).put(&self.output, html.as_bytes())?;
            if !self.campaign.common.quiet {
                out!("{}  {}", self.output.display(), bytes(html.len() as u64));
            }
        }
        Ok(lacks(&paper))
    }
}

/// Prints what the page lacks.
fn lacks(paper: &Paper) -> Exit {
    let missing = paper.missing();
    if missing.is_empty() {
        return Exit::Done;
    }
    let (all, left) = (paper.parts.len(), missing.len());
    err!("incomplete: {left} of {all} stages have no result: {}", missing.join(", "));
    err!("  complete it: {}", paper.command("run", ""));
    Exit::Failed
}
