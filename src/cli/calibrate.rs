//! `flow calibrate`: parameters for other targets, at once, from the surfaces of a finished campaign.
//!
//! It is the workflow's own calibration with `targets` laid over it as `--set` would: the same code, keys and cache, so
//! that the same question twice computes nothing. The surfaces and all that they rest on must be in the store; this command
//! never runs them. With
//! `--verify` the solution is run on fresh specimens as the workflow's own verification says, and nothing else is run.

mod answer;
mod page;

use super::common::{Campaign, decided, system, tell_damages, workers};
use super::progress::Progress;
use super::run::{ahead, interruption};
use super::{Exit, complete};
use crate::artifact::calibration::{Solution, Verification};
use crate::artifact::{self, Artifact};
use crate::exec::cores;
use crate::export::csv_text;
use crate::plan::{Workflow, nearest};
use crate::run::{Report, RunSettings, Silent, StageStatus, Watch, run};
use crate::stage::Kind;
use crate::stage::calibrate::{Calibrate as Calibration, Wanted};
use crate::stage::verify::Verify;
use crate::store::Store;
use clap::Args;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Find the parameters for other targets, on the surfaces of a finished campaign.
#[derive(Args)]
pub(super) struct Calibrate {
    #[command(flatten)]
    campaign: Campaign,
    /// A target for a response: `UCS="30 MPa"`, `nu=0.2`. May be given more than once.
    #[arg(long = "target", value_name = "RESPONSE=VALUE", required_unless_present = "page", add = complete::responses())]
    targets: Vec<String>,
    /// The calibration whose surfaces and settings are used; needed when several search on surfaces.
    #[arg(long, value_name = "NAME")]
    stage: Option<String>,
    /// Write the calibrator as a page of its own, for someone who has no `flow`; `-` for standard output.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["verify", "json", "csv"])]
    page: Option<PathBuf>,
    /// Run the solution on fresh specimens, as the workflow's verification does.
    #[arg(long)]
    verify: bool,
    /// Simulations at once with --verify; the number of cores when not given.
    #[arg(long, short, value_name = "N", value_parser = workers)]
    jobs: Option<usize>,
    /// As one JSON document.
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// The solution as CSV; with --verify the summary of the verification.
    #[arg(long)]
    csv: bool,
}

/// The campaign with the new targets laid over it.
struct Asked {
    workflow: Workflow,
    store: Store,
    stage: String,
    /// The verifications that are wanted too.
    checks: Vec<String>,
}

impl Calibrate {
    pub(super) fn go(self) -> Exit {
        self.answer().unwrap_or_else(|exit| exit)
    }

    fn answer(&self) -> Result<Exit, Exit> {
        let asked = self.asked()?;
        self.finished(&asked)?;
        if let Some(file) = &self.page {
            return page::write(&self.campaign, &asked, file);
        }
        let stop = Arc::new(AtomicBool::new(false));
        let report = asked.run(std::slice::from_ref(&asked.stage), 1, &Silent, &stop);
        let solution = asked.result(&report, &asked.stage)?;
        let solution = typed(Solution::from_artifact(&solution))?;
        if !(self.json || self.csv && self.verify) {
            let csv = || csv_text(&solution.solution.to_table());
            match self.csv {
                true => super::output::write(&csv()),
                false => super::output::lines(&answer::text(&asked, &solution)),
            }
        }
        let (verified, exit) = if self.verify { self.verified(&asked) } else { (Vec::new(), Exit::Done) };
        if self.json {
            out!("{}", answer::document(&asked, &solution, &verified));
        } else {
            for verification in &verified {
                let summary = verification.summary.to_table();
                match self.csv {
                    true => super::output::write(&csv_text(&summary)),
                    false => super::output::lines(&answer::verified(&summary)),
                }
            }
        }
        Ok(exit)
    }

    /// Sets the targets of the calibration; reports every fault of the command line.
    fn asked(&self) -> Result<Asked, Exit> {
        let plain = self.campaign.load(self.stage.as_slice())?;
        let stage = self.calibration(&plain);
        let targets = wanted(&plain, &self.targets);
        let checks = stage.as_ref().ok().filter(|_| self.verify).map(|stage| verifications(&plain, stage));
        let faults: Vec<String> = [
            stage.as_ref().err().map(std::slice::from_ref),
            targets.as_ref().err().map(Vec::as_slice),
            checks.as_ref().and_then(|checks| checks.as_ref().err()).map(std::slice::from_ref),
        ]
        .into_iter()
        .flatten()
        .flatten()
        .cloned()
        .collect();
        let (Ok(stage), Ok(targets), []) = (stage, targets, &faults[..]) else {
            faults.iter().for_each(|fault| err!("error: {fault}"));
            return Err(Exit::BadInput);
        };
        let mut campaign = self.campaign.clone();
        if !self.targets.is_empty() {
            campaign.sets.push(format!("stage.{stage}.targets=[{targets}]"));
        }
        let workflow = campaign.load(&[])?;
        let checks = checks.and_then(Result::ok).unwrap_or_default();
        // Only a verification runs something.
        let store = if self.verify { self.campaign.open()? } else { self.campaign.common.read()? };
        Ok(Asked { workflow, store, stage, checks })
    }

    /// The calibration to use: the named one, or the only one that searches on surfaces alone.
    fn calibration(&self, workflow: &Workflow) -> Result<String, String> {
        let takes = |index: usize, key: &str| workflow.stages[index].inputs.iter().any(|(port, _)| *port == key);
        let at_once = |&index: &usize| takes(index, "surfaces") && !takes(index, "simulator");
        let all = (0..workflow.stages.len()).filter(|&index| workflow.stages[index].kind == Calibration::NAME);
        let fit: Vec<usize> = all.clone().filter(at_once).collect();
        let names =
            |list: &[usize]| list.iter().map(|&i| workflow.stages[i].name.as_str()).collect::<Vec<_>>().join(", ");
        if let Some(name) = &self.stage {
            return match workflow.position(name) {
                Some(index) if fit.contains(&index) => Ok(name.clone()),
                Some(index) if workflow.stages[index].kind == Calibration::NAME => Err(format!(
                    "`{name}` calibrates by simulations, and an answer at once needs surfaces alone\n  \
                     name one with `surfaces` and without `simulator`, or run it: {}",
                    self.campaign.command("run", &[name])
                )),
                Some(index) => Err(format!("`{name}` is of kind {}, not calibrate", workflow.stages[index].kind)),
                None => panic!("BUG: a stage that was loaded is in the workflow"),
            };
        }
        match &fit[..] {
            [one] => Ok(workflow.stages[*one].name.clone()),
            [] if all.clone().next().is_some() => Err(format!(
                "no calibration of this workflow searches on surfaces alone: {}\n  \
                 an answer at once needs one with `surfaces` and without `simulator`",
                names(&all.collect::<Vec<_>>())
            )),
            [] => Err(
                "this workflow has no calibration\n  add [stage.calibrate] with kind = \"calibrate\" and surfaces = \
                       \"…\"; workflows/c30.toml has one"
                    .to_owned(),
            ),
            several => {
                Err(format!("several calibrations search on surfaces; name one with --stage: {}", names(several)))
            }
        }
    }

    /// Refuses to answer while something that the answer rests on is missing.
    fn finished(&self, asked: &Asked) -> Result<(), Exit> {
        let ours: Vec<String> = std::iter::once(asked.stage.clone()).chain(asked.checks.clone()).collect();
        let report = decided(&asked.workflow, &asked.store, &ours, true)?;
        let missing: Vec<&str> = report
            .stages
            .iter()
            .filter(|stage| !ours.contains(&stage.name) && !matches!(stage.status, StageStatus::Done(_)))
            .map(|stage| stage.name.as_str())
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        let inputs = ours.iter().filter_map(|name| asked.workflow.position(name)).flat_map(|index| {
            asked.workflow.stages[index].inputs.iter().map(|&(_, input)| asked.workflow.stages[input].name.as_str())
        });
        let mut first: Vec<&str> = inputs.filter(|name| missing.contains(name)).collect();
        first.dedup();
        err!(
            "error: the campaign is not finished: {} of what `{}` rests on {} missing\n  run first: {}",
            missing.join(", "),
            asked.stage,
            if missing.len() == 1 { "is" } else { "are" },
            self.campaign.command("run", &first)
        );
        Err(Exit::BadInput)
    }

    /// The results of the verifications, and how their runs ended.
    fn verified(&self, asked: &Asked) -> (Vec<Verification>, Exit) {
        let jobs = self.jobs.unwrap_or_else(cores);
        let watch: Box<dyn Watch> = match self.campaign.common.quiet {
            true => Box::new(Silent),
            false => Box::new(Progress::new(|| ahead(&asked.workflow, &asked.checks, &asked.store), jobs)),
        };
        let report = asked.run(&asked.checks, jobs, &*watch, &interruption(None));
        if report.interrupted {
            return (Vec::new(), Exit::Interrupted);
        }
        let mut found = Vec::new();
        let mut exit = Exit::Done;
        for check in &asked.checks {
            match asked.result(&report, check).and_then(|found| typed(Verification::from_artifact(&found))) {
                Ok(artifact) => found.push(artifact),
                Err(other) => exit = other,
            }
        }
        (found, exit)
    }
}

impl Asked {
    fn run(&self, stages: &[String], jobs: usize, watch: &dyn Watch, stop: &Arc<AtomicBool>) -> Report {
        let settings = RunSettings {
            jobs,
            keep_going: false,
            dry: false,
            targets: stages.to_vec(),
            again: Vec::new(),
            memos: true,
            cluster: None,
        };
        run(&self.workflow, &self.store, &settings, watch, stop)
    }

    /// The result of a stage, or why there is none.
    fn result(&self, report: &Report, stage: &str) -> Result<Arc<Artifact>, Exit> {
        tell_damages(&self.store);
        match report.stages.iter().find(|found| found.name == stage).map(|found| &found.status) {
            Some(StageStatus::Done(content)) => self.store.get(content).map_err(|e| system(&e)),
            Some(StageStatus::Failed(why)) => {
                err!("error: {stage}: {why}");
                Err(Exit::Failed)
            }
            Some(StageStatus::Open | StageStatus::Skipped(_)) | None => {
                err!("error: {}", report.broken.as_deref().unwrap_or("the calibration has no result"));
                Err(if report.broken.is_some() { Exit::System } else { Exit::Failed })
            }
        }
    }
}

/// A result in its type, or the fault of an artifact that another version wrote.
fn typed<T>(read: Result<T, artifact::Wanted>) -> Result<T, Exit> {
    read.map_err(|wanted| {
        err!("error: the result cannot be read: {wanted}");
        Exit::System
    })
}

/// The targets as a TOML table, or what is wrong with them.
fn wanted(workflow: &Workflow, targets: &[String]) -> Result<String, Vec<String>> {
    let (mut found, mut faults) = (BTreeMap::new(), Vec::new());
    for option in targets {
        let Some((name, value)) = option.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
            faults.push(format!("--target {option}: there is no `=`\n  write --target UCS=\"30 MPa\""));
            continue;
        };
        let Some(response) = workflow.context.responses.get(name) else {
            let known: Vec<&str> = workflow.context.responses.keys().map(String::as_str).collect();
            let meant = nearest(name, known.iter().copied()).map(|like| format!("; did you mean `{like}`?"));
            let meant = meant.unwrap_or_default();
            faults
                .push(format!("--target {option}: unknown response `{name}`{meant}\n  known are {}", known.join(", ")));
            continue;
        };
        // Quotes that the shell has left in place are removed.
        let value = value.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(value);
        let value = match value.parse::<f64>() {
            Ok(number) => Wanted::Number(number),
            Err(_) => Wanted::Text(value.to_owned()),
        };
        if let Err(fault) = value.value_in(&response.unit) {
            faults.push(format!("--target {option}: {fault}"));
        }
        if found.insert(name, value).is_some() {
            faults.push(format!("--target {option}: `{name}` is given twice"));
        }
    }
    let text = |(name, value): (&&str, &Wanted)| format!("{} = {}", serde_json::json!(name), serde_json::json!(value));
    if faults.is_empty() {
        Ok(format!("{{ {} }}", found.iter().map(text).collect::<Vec<_>>().join(", ")))
    } else {
        Err(faults)
    }
}

/// The stages that verify a calibration.
fn verifications(workflow: &Workflow, stage: &str) -> Result<Vec<String>, String> {
    let verifies = |(port, input): &(&str, usize)| *port == "solution" && workflow.stages[*input].name == stage;
    let all = workflow.stages.iter().filter(|node| node.kind == Verify::NAME && node.inputs.iter().any(verifies));
    let found: Vec<String> = all.map(|node| node.name.clone()).collect();
    if found.is_empty() {
        return Err(format!(
            "no stage verifies `{stage}`\n  add [stage.verify] with kind = \"verify\", solution = \"{stage}\" and a simulator"
        ));
    }
    Ok(found)
}
