//! The first section: what was done, how far computed and published values agree, and what to beware of.

use super::paper::{Cost, Outcome, Paper, Part};
use super::tally::tally;
use super::time::{duration, moment};
use super::warning::warnings;
use super::{compared, symbol};
use crate::stage::Kind;
use crate::stage::figure::Figure as Picture;
use crate::stage::table::Table as PrintedTable;
use maud::{Markup, html};

pub(super) fn summary(paper: &Paper) -> Markup {
    let all: Vec<(&Part, Vec<String>)> =
        paper.parts.iter().map(|part| (part, warnings(part))).filter(|(_, found)| !found.is_empty()).collect();
    html! {
        section #summary aria-labelledby="summary-head" {
            h2 #summary-head { "Summary" }
            p.lead { (sentence(paper)) }
            (tally(paper))
            (incomplete(paper))
            (compared::section(paper))
            @if !all.is_empty() {
                h3 #warnings { "Warnings" }
                ul.warnings {
                    @for (part, found) in &all {
                        @for warning in found {
                            li { a href={ "#stage-" (part.name) } { (part.words()) } ": " (symbol::typeset(&paper.context, warning)) }
                        }
                    }
                }
            }
        }
    }
}

/// The campaign in two sentences.
fn sentence(paper: &Paper) -> Markup {
    let runs = Outcome::sum(paper.parts.iter().map(|part| &part.outcome)).runs;
    let cost = Cost::sum(paper.parts.iter().map(|part| &part.cost));
    let count = |kind: &str| paper.parts.iter().filter(|part| part.kind == kind && part.artifact().is_some()).count();
    let done = paper.parts.iter().filter(|part| part.artifact().is_some()).count();
    let some = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    html! {
        @if done == paper.parts.len() { "All " (some(done, "stage")) " have a result" }
        @else { (done) " of " (some(paper.parts.len(), "stage")) " have a result" }
        @if runs > 0 { ": " (some(runs, "run")) " of the model, " } @else { ": " }
        (some(count(PrintedTable::NAME), "table")) " and " (some(count(Picture::NAME), "figure")) ", from seed " (paper.context.seed) ". "
        @if let Some((first, last)) = cost.span {
            (some(cost.tasks, "task")) " took " (duration(cost.seconds)) " of computing "
            @if moment(first) == moment(last) { "at " (time(first)) } @else { "between " (time(first)) " and " (time(last)) }
            " UTC."
        }
    }
}

fn time(milliseconds: i64) -> Markup {
    let text = moment(milliseconds);
    html! { time datetime={ (text.replace(' ', "T")) "Z" } { (text) } }
}

fn incomplete(paper: &Paper) -> Markup {
    let missing = paper.missing();
    html! {
        @if !missing.is_empty() {
            div.missing role="note" {
                p {
                    b { "Incomplete. " } "No result yet of "
                    @for (i, name) in missing.iter().enumerate() {
                        @if i > 0 { ", " }
                        a href={ "#stage-" (name) } { (name) }
                    }
                    "."
                }
                p { code { (paper.command("run", "")) } }
            }
        }
    }
}
