//! `flow export`: results as files for people and other programs.

use super::Exit;
use super::common::{Campaign, system};
use super::output::replace;
use super::progress::Silent;
use super::show::csv_text;
use crate::artifact::{Artifact, Node};
use crate::run::{Settings, StageStatus, run};
use clap::Args;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Write results as files: pictures as SVG, PDF and PNG, printed tables as CSV, LaTeX and Markdown, all others as CSV.
#[derive(Args)]
pub(super) struct Export {
    #[command(flatten)]
    campaign: Campaign,
    /// The stages; all that have a result when not given.
    stages: Vec<String>,
    /// The folder that the files are written to.
    #[arg(long, value_name = "FOLDER", default_value = "export")]
    to: PathBuf,
}

impl Export {
    pub(super) fn go(self) -> Exit {
        self.write().unwrap_or_else(|exit| exit)
    }

    fn write(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load(&self.stages)?;
        let store = self.campaign.open()?;
        let settings = Settings { jobs: 0, keep_going: true, dry: true, targets: self.stages.clone(), memos: true };
        let report = run(&workflow, &store, &settings, &Silent, &AtomicBool::new(false));
        std::fs::create_dir_all(&self.to).map_err(|e| system(&e))?;
        let mut missing = Vec::new();
        let asked = |name: &String| self.stages.is_empty() || self.stages.contains(name);
        for stage in report.stages.iter().filter(|stage| asked(&stage.name)) {
            let StageStatus::Done(content) = &stage.status else {
                missing.push(stage.name.as_str());
                continue;
            };
            let artifact = store.get(content).map_err(|e| system(&e))?;
            for (name, bytes) in files(&stage.name, &artifact) {
                replace(&self.to.join(&name), &bytes).map_err(|e| system(&e))?;
                out!("{}", self.to.join(name).display());
            }
        }
        if missing.is_empty() {
            return Ok(Exit::Done);
        }
        eprintln!("error: no result yet of {}; run them first", missing.join(", "));
        Ok(Exit::Failed)
    }
}

/// The files of a result: name and bytes. Texts and bytes whose names are file formats are written as they are, and
/// take the place of the tables they were made from.
fn files(stage: &str, artifact: &Artifact) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for (name, node) in artifact.root.iter() {
        let ending = if name == "latex" {
            "tex"
        } else if name == "markdown" {
            "md"
        } else {
            name
        };
        let known = ["svg", "pdf", "png", "csv", "tex", "md"].contains(&ending);
        match node {
            Node::Bytes(bytes) if known => files.push((format!("{stage}.{ending}"), bytes.clone())),
            Node::Text(text) if known => files.push((format!("{stage}.{ending}"), text.clone().into_bytes())),
            Node::Bytes(_) | Node::Text(_) | Node::Group(_) | Node::Table(_) | Node::Array(_) => {}
            Node::Real { .. } | Node::Int(_) | Node::Flag(_) => {}
        }
    }
    let whole = format!("{stage}.csv");
    if !files.iter().any(|(name, _)| *name == whole) {
        for (name, table) in artifact.tables() {
            files.push((format!("{stage}.{}.csv", name.replace('/', ".")), csv_text(table).into_bytes()));
        }
    }
    files
}
