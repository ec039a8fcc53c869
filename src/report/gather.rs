//! Reading a campaign from the store.

use super::paper::{Cost, Outcome, Paper, Part, State};
use crate::artifact::run::Run;
use crate::artifact::validity::Tally;
use crate::artifact::{Artifact, ContentHash, Node};
use crate::plan::{StageNode, Workflow};
use crate::run::{Report, StageStatus, decide};
use crate::stage::units::presented;
use crate::stage::{Class, Context, kind};
use crate::store::{Campaign, Store, StoreError};
use std::collections::HashSet;
use std::error::Error;
use std::sync::Arc;

/// What was asked for on the command line, besides the workflow.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Text of the workflow file.
    pub text: String,
    /// Overrides as they were typed.
    pub sets: Vec<String>,
    /// The store as it was named; empty for the default.
    pub store: String,
}

/// Reads what the store has of a workflow. Computes nothing; damaged objects are set aside and count as missing.
///
/// # Errors
/// The store cannot be read.
pub fn gather(workflow: &Workflow, asked: Asked, store: &Store) -> Result<Paper, Box<dyn Error>> {
    // Without memos every task is seen, whichever program ran it, so that the page depends on the results alone.
    let report = decide(workflow, store, &[], false)?;
    let mut parts = Vec::with_capacity(workflow.stages.len());
    for (node, (cost, outcome)) in workflow.stages.iter().zip(tasks(workflow, &report, store)?) {
        let status = report.stages.iter().find(|stage| stage.name == node.name).map(|stage| &stage.status);
        parts.push(part(node, state(status, store, &workflow.context)?, cost, outcome));
    }
    Ok(Paper {
        title: if workflow.title.is_empty() { workflow.name.clone() } else { workflow.title.clone() },
        about: workflow.about.clone(),
        file: workflow.path.display().to_string(),
        runs: runs(workflow, &asked.sets, store)?,
        text: asked.text,
        profile: workflow.profile.clone(),
        sets: asked.sets,
        store: asked.store,
        context: workflow.context.clone(),
        parts,
    })
}

fn part(node: &StageNode, state: State, cost: Cost, outcome: Outcome) -> Part {
    let entry = kind(node.kind);
    Part {
        title: node.title.clone(),
        name: node.name.clone(),
        kind: node.kind.to_owned(),
        class: entry.map_or(Class::Statistics, |entry| entry.class),
        about: entry.map_or("", |entry| entry.about).to_owned(),
        inputs: node.inputs.iter().map(|&(port, input)| (port.to_owned(), input)).collect(),
        settings: node.stage.settings(),
        state,
        cost,
        outcome,
    }
}

fn state(status: Option<&StageStatus>, store: &Store, context: &Context) -> Result<State, StoreError> {
    let done = |content: &ContentHash| match store.get(content) {
        Ok(artifact) => Ok(State::Done { content: *content, artifact: Arc::new(presented(&artifact, context)) }),
        Err(error) if error.is_missing() => Ok(State::Broken(error.to_string())),
        Err(error) => Err(error),
    };
    match status {
        Some(StageStatus::Done(content)) => done(content),
        Some(StageStatus::Failed(why)) => Ok(State::Broken(why.clone())),
        Some(StageStatus::Skipped(cause)) => Ok(State::Broken(format!("it needs `{cause}`, which cannot run"))),
        Some(StageStatus::Open) | None => Ok(State::Missing),
    }
}

/// What the tasks of each stage cost and came to.
fn tasks(workflow: &Workflow, report: &Report, store: &Store) -> Result<Vec<(Cost, Outcome)>, StoreError> {
    let mut all = vec![(Cost::default(), Outcome::default(), Vec::new()); workflow.stages.len()];
    let mut seen = HashSet::new();
    for task in report.tasks() {
        let Some(object) = task.object.filter(|object| seen.insert(object.key)) else { continue };
        let Some(record) = store.find(&object.key)? else { continue };
        let (cost, outcome, warnings) = &mut all[task.stage];
        cost.add(record.started, record.seconds, &record.origin);
        let presented = workflow.stages[task.stage].kind;
        if kind(presented).is_some_and(|kind| kind.class == Class::Presentation) {
            continue;
        }
        match store.get(&object.content) {
            Ok(artifact) => {
                outcome.add(&artifact);
                warnings.extend(own_warnings(&artifact));
            }
            Err(error) if error.is_missing() => {}
            Err(error) => return Err(error),
        }
    }
    let counted = |(cost, mut outcome, warnings): (Cost, Outcome, Vec<String>)| {
        outcome.warnings = Tally::of(warnings.len(), warnings.iter().map(String::as_str)).reasons();
        (cost, outcome)
    };
    Ok(all.into_iter().map(counted).collect())
}

/// The warnings in a result. Why a run is not valid is told by its verdict.
fn own_warnings(artifact: &Artifact) -> Vec<String> {
    let all = artifact.root.get("warnings").and_then(Node::texts).unwrap_or_default();
    all.iter().filter(|text| !text.starts_with(Run::NOT_VALID)).cloned().collect()
}

/// This user's recorded runs of this workflow with these overrides.
fn runs(workflow: &Workflow, sets: &[String], store: &Store) -> Result<Vec<Campaign>, StoreError> {
    let path = workflow.path.display().to_string();
    let profile = workflow.profile.clone().unwrap_or_default();
    let mut runs = Vec::new();
    for number in store.campaigns()? {
        let same = |run: &Campaign| run.own && run.workflow == path && run.profile == profile && run.set == sets;
        runs.extend(store.campaign(number)?.filter(same));
    }
    Ok(runs)
}
