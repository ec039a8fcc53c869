//! `flow check`: syntax, names, units, types and the graph of a workflow, with every profile of it.

use super::Exit;
use super::common::Campaign;
use super::message;
use crate::plan::{Fault, Overrides, Workflow, load};
use clap::Args;
use serde_json::{Value, json};

/// Find every fault of a workflow without running anything.
#[derive(Args)]
pub(super) struct Check {
    #[command(flatten)]
    campaign: Campaign,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

impl Check {
    pub(super) fn go(self) -> Exit {
        let (workflow, faults) = self.faults();
        let warnings = workflow.as_ref().map_or(&[][..], |workflow| &workflow.warnings);
        if !self.json && !self.campaign.common.quiet {
            message::warnings(warnings, self.campaign.common.color);
        }
        if self.json {
            out!("{}", document(&self.campaign.workflow.display().to_string(), &faults, warnings));
        } else if let (Some(workflow), []) = (&workflow, &faults[..]) {
            if !self.campaign.common.quiet {
                out!("{}", summary(workflow));
            }
        } else {
            message::print(&faults, self.campaign.common.color);
        }
        if faults.is_empty() { Exit::Done } else { Exit::BadInput }
    }

    /// The workflow as the options make it; and its faults, those of each profile when none was named.
    fn faults(&self) -> (Option<Workflow>, Vec<Fault>) {
        let campaign = &self.campaign;
        let with =
            |profile: Option<String>| load(&campaign.workflow, &Overrides { profile, sets: campaign.sets.clone() });
        let workflow = match with(campaign.profile.clone()) {
            Ok(workflow) => workflow,
            Err(faults) => return (None, faults),
        };
        let mut faults: Vec<Fault> = workflow.absent.clone();
        let others = workflow.profiles.iter().filter(|_| campaign.profile.is_none());
        let found = |name: &String| with(Some(name.clone())).map_or_else(|faults| faults, |workflow| workflow.absent);
        for fault in others.flat_map(found) {
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
        (Some(workflow), faults)
    }
}

fn summary(workflow: &Workflow) -> String {
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let context = &workflow.context;
    let mut parts = vec![count(workflow.stages.len(), "stage")];
    parts.extend(
        [(context.factors.len(), "factor"), (context.responses.len(), "response")].map(|(n, what)| count(n, what)),
    );
    parts.push(count(workflow.profiles.len(), "profile"));
    format!("{}: {}: no fault", workflow.path.display(), parts.join(", "))
}

fn document(name: &str, faults: &[Fault], warnings: &[Fault]) -> Value {
    let one = |fault: &Fault| {
        let location = fault.location.as_ref();
        let (line, column) = location.map(|location| location.line_column()).unzip();
        json!({
            "file": location.map(|location| location.source.name.as_str()), "line": line, "column": column,
            "message": fault.message, "label": fault.label, "hint": fault.hint,
        })
    };
    let all = |list: &[Fault]| list.iter().map(one).collect::<Vec<Value>>();
    json!({ "workflow": name, "faults": all(faults), "warnings": all(warnings) })
}
