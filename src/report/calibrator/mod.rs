//! The calibrator: parameters to responses and targets to parameters, on the surfaces of a campaign, in a page for someone
//! who has no `flow`.
//!
//! It is a section of the report and a page of its own. The numbers come from [`instrument`] as JSON; the scripts are
//! * `numeric.js`: least squares, least distance, rank;  `model.js`: surfaces and their intervals;
//! * `domain.js`: ranges and constraints;  `solve.js`: solutions, their extents, what can be had;
//! * `charts.js`: what-if curves;  `texts.js`: the solution as TOML and for PFC;  `form.js`: fields, sliders and words.

use super::Paper;
use super::paper::Part;
use super::symbol;
use crate::stage::calibrate::{Calibrate, Instrument, Parameter, Surface, instrument};
use crate::stage::{Context, Kind, StageError};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;
use serde_json::Value;

mod material;

/// The look, besides that of the report.
pub(super) const STYLE: &str = include_str!("form.css");
/// What computes and moves.
pub(super) const SCRIPT: &str = concat!(
    include_str!("numeric.js"),
    include_str!("model.js"),
    include_str!("domain.js"),
    include_str!("solve.js"),
    include_str!("charts.js"),
    include_str!("texts.js"),
    include_str!("form.js"),
);

/// Input of the page: the calibration, and where its parameters belong in the workflow.
#[derive(Serialize)]
struct Shown<'a> {
    #[serde(flatten)]
    instrument: &'a Instrument,
    title: &'a str,
    file: &'a str,
    stage: &'a str,
    materials: Vec<material::Values>,
}

/// The calibrator of a stage; none when it is no calibration on surfaces, or these have no result yet.
///
/// # Errors
/// The surfaces cannot be read.
pub(super) fn calibrator(paper: &Paper, part: &Part) -> Result<Option<Markup>, StageError> {
    if part.kind != Calibrate::NAME {
        return Ok(None);
    }
    let Some(&(_, index)) = part.inputs.iter().find(|(port, _)| port == "surfaces") else { return Ok(None) };
    let Some(surfaces) = paper.parts[index].artifact() else { return Ok(None) };
    let Some(found) = instrument(&part.settings, &paper.context, surfaces)? else { return Ok(None) };
    if found.parameters.is_empty() || found.responses.is_empty() {
        return Ok(None);
    }
    let materials = materials(paper, index);
    let shown = Shown {
        instrument: &found,
        title: &paper.title,
        file: &paper.file,
        stage: &part.name,
        materials: materials.iter().filter_map(|name| material::values(&paper.context, name)).collect(),
    };
    Ok(Some(markup(&shown, &paper.context)))
}

/// The materials of the runs that the surfaces were fitted to, each once.
fn materials(paper: &Paper, surfaces: usize) -> Vec<String> {
    let (mut open, mut seen, mut found) = (vec![surfaces], Vec::new(), Vec::new());
    while let Some(index) = open.pop() {
        if seen.contains(&index) {
            continue;
        }
        seen.push(index);
        let part = &paper.parts[index];
        match &part.settings["material"] {
            Value::String(name) if !found.contains(name) => found.push(name.clone()),
            _ => {}
        }
        open.extend(part.inputs.iter().map(|&(_, input)| input));
    }
    found.sort();
    found
}

fn markup(shown: &Shown, context: &Context) -> Markup {
    let id = |what: &str| format!("{what}-{}", shown.stage);
    // `<` cannot occur in it: no text ends the element.
    let data = serde_json::to_string(shown).unwrap_or_default().replace('<', "\\u003c");
    let Instrument { parameters, responses, sets, .. } = shown.instrument;
    html! {
        div.calibrator id=(id("calibrator")) {
            script type="application/json" class="instrument" { (PreEscaped(data)) }
            noscript { p.missing { "The calibrator computes with JavaScript, which is switched off here." } }
            div.panes {
                section.pane.aims aria-labelledby=(id("aims")) {
                    h3 id=(id("aims")) { "Targets" }
                    p.note { "What the material shall show. Leave a field empty for a response that does not matter." }
                    @if sets.len() > 1 {
                        p { label { "Set of the campaign " select.set {
                            @for (i, _) in sets.iter().enumerate() { option value=(i) { (i + 1) } }
                            option value="" { "own" }
                        } } }
                    }
                    @for (i, response) in responses.iter().enumerate() { (aim(shown, context, i, response)) }
                    p.actions {
                        button.solve type="button" { "Find parameters" }
                        button.other type="button" disabled { "Another equally good one" }
                    }
                    div.verdict role="status" aria-live="polite" {}
                }
                section.pane.knobs aria-labelledby=(id("knobs")) {
                    h3 id=(id("knobs")) { "Parameters" }
                    p.note { "Move them to see what the material would show. What is held stays as it is when parameters are sought." }
                    @for (i, parameter) in parameters.iter().enumerate() { (knob(shown, context, i, parameter)) }
                    p.said role="status" aria-live="polite" {}
                }
            }
            section aria-labelledby=(id("shown")) {
                h3 id=(id("shown")) { "Predicted responses" }
                div.cards { @for (i, response) in responses.iter().enumerate() { (card(context, i, response)) } }
            }
            section aria-labelledby=(id("known")) {
                h3 id=(id("known")) { "What the targets say of each parameter" }
                p.note { "Range of all solutions that no response tells apart by its 95 % interval, within the range of the parameter." }
                div.extents role="list" {}
            }
            section aria-labelledby=(id("curves")) {
                h3 id=(id("curves")) { "What if one parameter changes?" }
                p.note { "Each curve moves one parameter and leaves the others. Band: 95 % interval of the mean. Dashed: target. Press on a curve to move there." }
                div.charts {}
            }
            section aria-labelledby=(id("texts")) {
                h3 id=(id("texts")) { "Take the parameters along" }
                div.texts {
                    div {
                        h4 { "TOML for flow" }
                        pre.code.toml tabindex="0" aria-label="TOML for flow" {}
                    }
                    div {
                        h4 { "Text for PFC" }
                        pre.code.pfc tabindex="0" aria-label="Text for PFC" {}
                    }
                }
            }
        }
    }
}

/// The symbol of a factor or response with its name beside it, or the name alone.
fn name(context: &Context, name: &str) -> Markup {
    match symbol::of(context, name) {
        // A symbol that reads as the name needs it no more.
        Some(symbol) if symbol::raw(context, name) == Some(name) => html! { span.symbol { (symbol) } },
        Some(symbol) => html! { span.symbol { (symbol) } " " span.name { (name) } },
        None => html! { span.symbol { (name) } },
    }
}

fn unit(unit: &str) -> Markup {
    html! { span.unit { @if !unit.is_empty() { (symbol::unit(unit)) } } }
}

fn aim(shown: &Shown, context: &Context, index: usize, response: &Surface) -> Markup {
    let id = format!("aim-{}-{index}", shown.stage);
    html! {
        div.aim data-response=(index) {
            label.head for=(id) { (name(context, &response.name)) }
            select.mode aria-label={ (response.name) ": what is wanted" } {
                option value="exactly" { "=" } option value="at-least" { "≥" } option value="at-most" { "≤" } option value="between" { "from … to" }
            }
            input.low id=(id) type="text" inputmode="decimal" autocomplete="off";
            input.high type="text" inputmode="decimal" autocomplete="off" hidden aria-label={ (response.name) ": greatest value" };
            (unit(&response.unit))
            span.reach {}
        }
    }
}

fn knob(shown: &Shown, context: &Context, index: usize, parameter: &Parameter) -> Markup {
    let id = format!("knob-{}-{index}", shown.stage);
    let Parameter { low, high, unit: own, .. } = parameter;
    html! {
        div.knob data-parameter=(index) {
            label.head for=(id) { (name(context, &parameter.name)) }
            input.slide type="range" min="0" max="1" step="0.002" aria-label={ (parameter.name) " by slider" };
            input.value id=(id) type="text" inputmode="decimal" autocomplete="off";
            (unit(own))
            span.ends { (low) " … " (high) }
            label.hold { input type="checkbox" checked[parameter.held]; " hold" }
        }
    }
}

fn card(context: &Context, index: usize, response: &Surface) -> Markup {
    html! {
        div.card data-response=(index) role="group" aria-label=(response.name) {
            p.head { (name(context, &response.name)) }
            p.figure { b.value {} " " (unit(&response.unit)) }
            p.interval {}
            p.run {}
            p.mark {}
        }
    }
}
