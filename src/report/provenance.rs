//! Where the results come from: the workflow file, its hash and text, seed, versions, machines, runs.

use super::figure::Glyphs;
use super::paper::{Cost, Paper};
use super::time::{duration, moment};
use maud::{Markup, html};
use std::collections::BTreeSet;

/// So many of the recorded runs are listed.
const RUNS: usize = 10;

pub(super) fn provenance(paper: &Paper, glyphs: &mut Glyphs) -> Markup {
    html! {
        section #provenance aria-labelledby="provenance-head" {
            h2 #provenance-head { "Workflow and provenance" }
            (super::dag::picture(paper, glyphs))
            (facts(paper))
            (runs(paper))
            details {
                summary { "The workflow file" span.soft { " " (paper.text.lines().count()) " lines" } }
                pre.code tabindex="0" role="region" aria-label="Text of the workflow file" { code { (paper.text) } }
            }
        }
    }
}

fn facts(paper: &Paper) -> Markup {
    let cost = Cost::sum(paper.parts.iter().map(|part| &part.cost));
    let list = |of: fn(&crate::store::Origin) -> &str| {
        let names: BTreeSet<&str> = cost.origins.iter().map(of).filter(|name| !name.is_empty()).collect();
        names.into_iter().collect::<Vec<_>>().join(", ")
    };
    let versions = list(|origin| &origin.version);
    let commits = list(|origin| &origin.commit);
    let machines = list(|origin| &origin.machine);
    let hash = blake3::hash(paper.text.as_bytes()).to_hex();
    html! {
        dl.facts {
            (fact("Workflow", html! { code { (paper.file) } }))
            (fact("blake3 of the file", html! { code.hash { (hash.as_str()) } }))
            @if let Some(profile) = &paper.profile { (fact("Profile", html! { code { (profile) } })) }
            @if !paper.sets.is_empty() {
                (fact("Overrides", html! { @for set in &paper.sets { code { (set) } " " } }))
            }
            (fact("Seed", html! { (paper.context.seed) }))
            @if !versions.is_empty() { (fact("Computed by flow", html! { (versions) })) }
            @if !commits.is_empty() { (fact("Git commit", html! { code.hash { (commits) } })) }
            @if !machines.is_empty() { (fact("Machine", html! { (machines) })) }
            @if let Some((first, last)) = cost.span {
                (fact("Computed", html! { (moment(first)) " to " (moment(last)) " UTC, " (duration(cost.seconds)) " of computing" }))
            }
            (fact("Again", html! { code { (paper.command("run", "")) } }))
        }
    }
}

fn fact(name: &str, value: Markup) -> Markup {
    html! { div { dt { (name) } dd { (value) } } }
}

fn runs(paper: &Paper) -> Markup {
    let first = paper.runs.len().saturating_sub(RUNS);
    html! {
        @if paper.runs.is_empty() {
            p.note { "No run of this workflow with these overrides is recorded; the results were computed for others that share them." }
        } @else {
            div.sheet {
                table {
                    caption { span { "Recorded runs of this campaign" } }
                    thead { tr {
                        th scope="col" { "run" } th.t scope="col" { "began, UTC" } th scope="col" { "took" }
                        th scope="col" { "tasks computed" } th scope="col" { "from the store" } th scope="col" { "failed" }
                        th.t scope="col" { "machine" } th.t scope="col" { "flow" }
                    } }
                    tbody {
                        @for run in &paper.runs[first..] {
                            @let sum = |of: fn(&crate::store::StageRun) -> u64| run.stages.iter().map(of).sum::<u64>();
                            tr {
                                td { (run.number) }
                                td.t { (moment(run.started)) }
                                td data-v=(format!("{:.1}", run.seconds)) { (duration(run.seconds)) }
                                td { (sum(|stage| stage.ran)) } td { (sum(|stage| stage.cached)) } td { (sum(|stage| stage.failed)) }
                                td.t { (run.origin.machine) } td.t { (run.origin.version) }
                            }
                        }
                    }
                }
            }
            @if first > 0 { p.note { "The last " (RUNS) " of " (paper.runs.len()) " runs." } }
        }
    }
}
