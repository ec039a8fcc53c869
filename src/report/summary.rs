//! The first section: what was done, how far computed and published values agree, and what to beware of.

use super::paper::{Cost, Paper, Part};
use super::symbol;
use super::table::{CLOSE, Mark, number};
use super::time::{duration, moment};
use super::warning::warnings;
use crate::artifact::{Column, Table};
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
            (incomplete(paper))
            (agreement(paper))
            @if !all.is_empty() {
                h3 #warnings { "Warnings" }
                ul.warnings {
                    @for (part, found) in &all {
                        @for warning in found {
                            li { a href={ "#stage-" (part.name) } { (part.words()) } ": " (warning) }
                        }
                    }
                }
            }
        }
    }
}

/// The campaign in two sentences.
fn sentence(paper: &Paper) -> Markup {
    let runs: usize = paper.parts.iter().filter_map(Part::runs).sum();
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
            (some(cost.tasks, "task")) " took " (duration(cost.seconds)) " of computing between "
            (time(first)) " and " (time(last)) " UTC."
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

/// One comparison of a column with the published one.
struct Compared<'a> {
    part: &'a Part,
    quantity: &'a str,
    deviations: Vec<f64>,
}

/// How far computed and published values agree, for every table that compares them.
fn agreement(paper: &Paper) -> Markup {
    let tables = paper.parts.iter().filter(|part| part.kind == PrintedTable::NAME);
    let all: Vec<Compared> = tables.flat_map(|part| compared(part).into_iter().flatten()).collect();
    html! {
        @if !all.is_empty() {
            h3 { "Computed beside published" }
            div.sheet {
                table {
                    caption { span { "Deviation of the computed values from the published ones, over all rows that both have" } }
                    thead { tr {
                        th.t scope="col" { "table" } th.t scope="col" { "quantity" } th scope="col" { "rows" }
                        th scope="col" { "mean " small { "%" } } th scope="col" { "median size " small { "%" } }
                        th scope="col" { "largest size " small { "%" } } th scope="col" { "rows within " (CLOSE) " % " small { "%" } }
                    } }
                    tbody { @for compared in &all { (compared.row(paper)) } }
                }
            }
        }
    }
}

fn compared(part: &Part) -> Option<Vec<Compared<'_>>> {
    let table: &Table = part.artifact()?.table("table")?;
    let column = |column: &'_ Column| {
        let (quantity, _) = column.name.rsplit_once(' ').filter(|_| Mark::of(column) == Some(Mark::Signed))?;
        let deviations: Vec<f64> =
            table.numbers(&column.name, "%").ok()?.into_iter().filter(|d| d.is_finite()).collect();
        (!deviations.is_empty()).then(|| (quantity.to_owned(), deviations))
    };
    let found = table.columns.iter().filter_map(column);
    let name = |quantity: &str| table.columns.iter().map(|c| c.name.as_str()).find(|name| *name == quantity);
    Some(
        found
            .filter_map(|(quantity, deviations)| Some(Compared { part, quantity: name(&quantity)?, deviations }))
            .collect(),
    )
}

impl Compared<'_> {
    fn row(&self, paper: &Paper) -> Markup {
        let n = self.deviations.len();
        let mean = self.deviations.iter().sum::<f64>() / n as f64;
        let mut sizes: Vec<f64> = self.deviations.iter().map(|d| d.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let median = (sizes[(n - 1) / 2] + sizes[n / 2]) / 2.0;
        let within = 100.0 * sizes.iter().filter(|size| **size <= CLOSE).count() as f64 / n as f64;
        let judged = Mark::Signed.judge(mean);
        html! {
            tr {
                th.t scope="row" { a href={ "#stage-" (self.part.name) } { (self.part.words()) } }
                td.t data-v=(self.quantity) { @match symbol::of(&paper.context, self.quantity) { Some(s) => (s), None => (self.quantity) } }
                td { (n) }
                td class=(judged.class) data-v=(format!("{mean:.1}")) {
                    @if mean > 0.0 { "+" } (number(&format!("{mean:.1}"))) " " em { (judged.sign) " " (judged.word) }
                }
                td { (format!("{median:.1}")) }
                td { (format!("{:.1}", sizes[n - 1])) }
                td { (format!("{within:.0}")) }
            }
        }
    }
}
