//! The section of a stage: what it is, what it cost, its tables and figures, and those that show it.

use super::calibrator::calibrator;
use super::figure::{Glyphs, figure, missing};
use super::paper::{Paper, Part, State, capital};
use super::table::Sheet;
use super::time::{duration, moment};
use super::warning::warnings;
use super::{compared, symbol};
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::stage::calibrate::parameters_in_words;
use crate::stage::data::Data;
use crate::stage::figure::Figure as Picture;
use crate::stage::table::Table as PrintedTable;
use crate::stage::{Kind, artifact_kind};
use maud::{Markup, html};
use serde_json::Value;

/// The section of a stage that computes; `members` are the tables and figures that show it.
pub(super) fn section(paper: &Paper, index: usize, members: &[usize], glyphs: &mut Glyphs) -> Markup {
    let part = &paper.parts[index];
    if part.is_shown_elsewhere() {
        // A table or figure that shows no earlier stage.
        return html! { section { h2 { (part.words()) } (member(paper, index, glyphs)) } };
    }
    let head = format!("head-{}", part.name);
    let found = warnings(part);
    html! {
        section.stage id={ "stage-" (part.name) } aria-labelledby=(head) {
            h2 id=(head) { (part.words()) " " span.kind title={ "kind = \"" (part.kind) "\", [stage." (part.name) "]" } { (part.kind_in_words()) } }
            p.about { (capital(&part.about)) "." @if part.title.is_some() { " Stage " code { (part.name) } "." } }
            @match &part.state {
                State::Done { .. } => (facts(paper, part)),
                State::Missing | State::Broken(_) => (missing(paper, part)),
            }
            @if !found.is_empty() {
                ul.warnings aria-label="Warnings" { @for warning in &found { li { (symbol::typeset(&paper.context, warning)) } } }
            }
            (own(paper, index, members))
            (interactive(paper, part))
            div.members { @for &member_index in members { (member(paper, member_index, glyphs)) } }
            (settings(part))
        }
    }
}

/// The calibrator of a calibration on surfaces.
fn interactive(paper: &Paper, part: &Part) -> Markup {
    match calibrator(paper, part) {
        Ok(found) => found.unwrap_or_else(|| html! {}),
        Err(fault) => html! { p.missing { "The calibrator cannot be shown: " (fault.message) } },
    }
}

fn facts(paper: &Paper, part: &Part) -> Markup {
    let State::Done { content, .. } = &part.state else { return html! {} };
    let content = content.to_string();
    let run = paper.run_of(part);
    html! {
        dl.facts.line {
            @if !part.inputs.is_empty() {
                div { dt { "From" } dd {
                    @for (i, input) in inputs(part).into_iter().enumerate() {
                        @if i > 0 { ", " }
                        @let maker = &paper.parts[input];
                        a href={ "#stage-" (maker.name) } { (maker.words()) }
                    }
                } }
            }
            @if part.outcome.runs > 0 { div { dt { "Runs" } dd { (part.outcome.runs) } } }
            @if part.cost.tasks > 0 {
                div { dt { "Cost" } dd { (duration(part.cost.seconds)) " in " (part.cost.tasks) @if part.cost.tasks == 1 { " task" } @else { " tasks" } } }
            } @else {
                div { dt { "Cost" } dd { "none of its own: shares tasks of others" } }
            }
            div { dt { "Computed" } dd {
                @match (run, part.cost.span) {
                    (Some(run), _) => { "in run " (run.number) ", " (moment(run.started)) },
                    (None, Some((_, last))) => { "earlier, " (moment(last)) "; taken from the store" },
                    (None, None) => "taken from the store",
                }
            } }
            div { dt { "Object" } dd { code.hash title=(content) { (&content[..12]) } } }
        }
    }
}

fn inputs(part: &Part) -> Vec<usize> {
    let mut inputs: Vec<usize> = part.inputs.iter().map(|&(_, input)| input).collect();
    inputs.sort_unstable();
    inputs.dedup();
    inputs
}

/// Tables of the stage's own result. Those that a `table` stage prints whole are left to it; one of the others is open.
fn own(paper: &Paper, index: usize, members: &[usize]) -> Markup {
    let part = &paper.parts[index];
    let Some(artifact) = part.artifact() else { return html! {} };
    let all: Vec<(String, &Table)> = artifact.tables().into_iter().filter(|(_, table)| table.rows() > 0).collect();
    let main = main_of(artifact);
    let printed = |name: &str| members.iter().any(|&member| prints(&paper.parts[member], index, name, main));
    let rest: Vec<&(String, &Table)> = all.iter().filter(|(name, _)| !printed(name) && !name.contains('/')).collect();
    let is_open =
        |name: &str| name == main && !members.iter().any(|&m| prints_some(&paper.parts[m], index, name, main));
    let sheet = |name: &str, table| {
        let command = paper.command("show", &format!("{} --table {name}", part.name));
        // What a laboratory measured was no run of a simulator.
        let called = if part.kind == Data::NAME && name == main { "rows" } else { name };
        let about = artifact_about(called, table);
        Sheet::new(table, &paper.context, about, command).markup()
    };
    let closed: Vec<_> = rest.iter().filter(|(name, _)| !is_open(name)).collect();
    html! {
        @for (name, table) in rest.iter().filter(|(name, _)| is_open(name)) { (sheet(name, table)) }
        @for line in parameters_in_words(artifact) { p.note { "Parameters " (symbol::typeset(&paper.context, &line)) } }
        @if !closed.is_empty() {
            details.more {
                summary { "More of its numbers" span.soft { " " (names(&closed)) } }
                @for (name, table) in &closed { (sheet(name, table)) }
                p.note { "In the terminal: " code { (paper.command("show", &part.name)) } }
            }
        }
    }
}

/// The name of the table of an artifact that people look at first; empty where there is none.
fn main_of(artifact: &Artifact) -> &'static str {
    artifact_kind(artifact).and_then(ArtifactKind::main_table).unwrap_or_default()
}

fn names(tables: &[&&(String, &Table)]) -> String {
    tables.iter().map(|(name, _)| name.replace('_', " ")).collect::<Vec<_>>().join(", ")
}

fn artifact_about(name: &str, table: &Table) -> Markup {
    let name = name.replace('_', " ");
    // "quality: quality of the specimen" says a word twice.
    let about = match table.about.strip_prefix(&name) {
        Some(rest) if rest.starts_with([' ', ',', ';']) => rest.trim_start(),
        _ => &table.about,
    };
    let gap = if about.is_empty() || about.starts_with([',', ';']) { "" } else { " " };
    html! { b { (name) } (gap) (about) }
}

/// Whether a `table` stage prints this table of that stage, whole.
fn prints(part: &Part, index: usize, name: &str, main: &str) -> bool {
    let free = |key: &str| match &part.settings[key] {
        Value::Array(list) => list.is_empty(),
        Value::Object(map) => map.is_empty(),
        _ => true,
    };
    prints_some(part, index, name, main) && free("columns") && free("where")
}

/// Whether a `table` stage prints something of this table of that stage.
fn prints_some(part: &Part, index: usize, name: &str, main: &str) -> bool {
    let of: Vec<usize> = part.inputs.iter().filter(|(port, _)| port == "of").map(|&(_, input)| input).collect();
    part.kind == PrintedTable::NAME && of == [index] && part.settings["table"].as_str().unwrap_or(main) == name
}

/// A table or figure that shows the stage.
fn member(paper: &Paper, index: usize, glyphs: &mut Glyphs) -> Markup {
    let part = &paper.parts[index];
    match part.kind.as_str() {
        Picture::NAME => figure(paper, part, glyphs),
        _ => printed(paper, part),
    }
}

fn printed(paper: &Paper, part: &Part) -> Markup {
    let Some(table) = part.artifact().and_then(|artifact| artifact.table(main_of(artifact))) else {
        return missing(paper, part);
    };
    let caption = part.settings["caption"].as_str().unwrap_or_default();
    let caption = html! { b { (part.words()) } " " (caption) };
    let command = paper.command("show", &format!("{} --table table", part.name));
    let sheet = Sheet::new(table, &paper.context, caption, command).printed(&part.settings);
    let sheet = sheet.judged(compared::judgements(paper, part));
    html! {
        div.printed id={ "stage-" (part.name) } { (sheet.markup()) }
    }
}

/// The settings of a stage, in SI units.
fn settings(part: &Part) -> Markup {
    let mut lines = Vec::new();
    flatten("", &part.settings, &mut lines);
    html! {
        @if !lines.is_empty() {
            details {
                summary { "Settings" span.soft { " in SI units" } }
                dl.settings { @for (path, value) in &lines { div { dt { (path) } dd { (value) } } } }
            }
        }
    }
}

/// Paths and values of what is set.
fn flatten(path: &str, value: &Value, lines: &mut Vec<(String, String)>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Null => {}
        Value::Object(map) => map.iter().for_each(|(key, value)| flatten(&below(key), value, lines)),
        Value::Array(list) if list.iter().any(Value::is_object) => {
            list.iter().enumerate().for_each(|(i, value)| flatten(&below(&(i + 1).to_string()), value, lines));
        }
        Value::Array(list) if list.is_empty() => {}
        Value::Array(list) => lines.push((path.to_owned(), list.iter().map(plain).collect::<Vec<_>>().join(", "))),
        Value::String(text) if text.is_empty() => {}
        Value::String(_) | Value::Number(_) | Value::Bool(_) => lines.push((path.to_owned(), plain(value))),
    }
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number
            .as_f64()
            .filter(|_| !number.is_i64() && !number.is_u64())
            .map_or_else(|| number.to_string(), super::table::nine),
        Value::Bool(flag) => if *flag { "yes" } else { "no" }.to_owned(),
        Value::Null => "–".to_owned(),
        Value::Array(_) | Value::Object(_) => value.to_string(),
    }
}
