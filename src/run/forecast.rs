//! What the stages of a workflow are expected to ask for, before anything runs.

use super::files::path_of;
use super::stages::wanted;
use crate::plan::Workflow;
use crate::stage::beside::read;
use crate::stage::forecast::{Ahead, Forecast};

/// The forecast of every stage, in the order of the workflow.
pub fn forecasts(workflow: &Workflow) -> Vec<Forecast> {
    let file = |path: &str| {
        let path = path_of(workflow, path);
        read(&path).ok()
    };
    let mut all: Vec<Forecast> = Vec::with_capacity(workflow.stages.len());
    for node in &workflow.stages {
        let behind = |port: &str| {
            let stages = node.inputs.iter().filter(|(key, _)| *key == port);
            stages.filter_map(|(_, index)| all.get(*index).copied()).collect()
        };
        let forecast = node.stage.forecast(&Ahead { context: &workflow.context, behind: &behind, file: &file });
        all.push(forecast);
    }
    all
}

/// The forecasts of the targets and of all they need, by name; of all stages when no target is named.
pub fn forecasts_of<'a>(workflow: &'a Workflow, targets: &[String]) -> Vec<(&'a str, Forecast)> {
    let names = workflow.stages.iter().map(|node| node.name.as_str());
    let all = names.zip(forecasts(workflow)).zip(wanted(workflow, targets));
    all.filter_map(|(stage, wanted)| wanted.then_some(stage)).collect()
}
