//! The page around the sections: head, masthead, contents, script.

use super::figure::{Glyphs, base64};
use super::paper::{Cost, Paper, State};
use super::time::moment;
use super::values::in_script;
use super::{calibrator, provenance, stage, summary, symbol};
use crate::stage::StageError;
use figure::font::Face;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The look.
pub(super) const STYLE: &str = include_str!("page.css");
/// What every page needs: elements, themes, copying.
const BASE: &str = include_str!("base.js");
/// What moves in a report: sorting, copying, zooming, values under the pointer.
const SCRIPT: &str = include_str!("page.js");

/// The page of a campaign.
pub fn page(paper: &Paper) -> String {
    let mut glyphs = Glyphs::default();
    let sections: Vec<Markup> =
        homes(paper).iter().map(|(i, members)| stage::section(paper, *i, members, &mut glyphs)).collect();
    let provenance = provenance::provenance(paper, &mut glyphs);
    let body = html! {
        a.skip href="#main" { "Skip to the results" }
        (glyphs.markup())
        (masthead(paper, "flow report"))
        div.frame {
            (contents(paper))
            main #main tabindex="-1" {
                (summary::summary(paper))
                (provenance)
                @for section in &sections { (section) }
            }
        }
        footer { p { (made(paper)) } }
        dialog #zoom aria-label="Figure, enlarged" {}
        script #symbols type="application/json" { (PreEscaped(symbols(paper))) }
    };
    document(paper, &paper.title, &body, &[BASE, SCRIPT, calibrator::SCRIPT])
}

/// The calibrator of a stage as a page of its own; none when it is no calibration on surfaces, or these have no result.
///
/// # Errors
/// The surfaces cannot be read.
pub fn calibrator_page(paper: &Paper, stage: &str) -> Result<Option<String>, StageError> {
    let Some(part) = paper.parts.iter().find(|part| part.name == stage) else { return Ok(None) };
    let Some(calibrator) = calibrator::calibrator(paper, part)? else { return Ok(None) };
    let title = format!("Calibrator: {}", paper.title);
    let body = html! {
        a.skip href="#main" { "Skip to the calibrator" }
        (masthead(paper, "flow calibrator"))
        div.frame.alone {
            main.alone #main tabindex="-1" { section { h2 { "Calibrator" } (calibrator) } }
        }
        footer { p { (made(paper)) } }
    };
    Ok(Some(document(paper, &title, &body, &[BASE, calibrator::SCRIPT])))
}

/// The symbols of the workflow in plain words with their markup, for words that the script shows.
fn symbols(paper: &Paper) -> String {
    let known = symbol::known(&paper.context).into_iter();
    in_script(&known.map(|(plain, set)| serde_json::json!([plain, set.0])).collect())
}

/// A page that is complete in itself.
fn document(paper: &Paper, title: &str, body: &Markup, scripts: &[&str]) -> String {
    let nonce = nonce(paper);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy(&nonce));
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content={ "flow " (env!("CARGO_PKG_VERSION")) };
                title { (title) }
                style nonce=(nonce) { (PreEscaped(fonts())) (PreEscaped(STYLE)) (PreEscaped(calibrator::STYLE)) }
            }
            body { (body) script nonce=(nonce) { @for script in scripts { (PreEscaped(script)) } } }
        }
    };
    printable(page.into_string())
}

/// A page without control characters, which no parser of HTML takes: texts of a workflow may hold them.
fn printable(page: String) -> String {
    let control = |c: char| c.is_control() && !['\n', '\r', '\t'].contains(&c);
    if page.contains(control) { page.replace(control, "\u{fffd}") } else { page }
}

/// Nothing is loaded, and of scripts and styles only those with the page's own mark count: no handlers, no attributes.
fn policy(nonce: &str) -> String {
    format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; font-src data:; \
         base-uri 'none'; form-action 'none'"
    )
}

/// A mark that nobody who writes a workflow or a store can foresee, and that is the same for the same campaign: it
/// depends on all texts and results.
fn nonce(paper: &Paper) -> String {
    let mut hash = blake3::Hasher::new_derive_key("flow report 1");
    for text in [
        &paper.title,
        &paper.about,
        &paper.file,
        &paper.text,
        BASE,
        SCRIPT,
        STYLE,
        calibrator::SCRIPT,
        calibrator::STYLE,
    ] {
        hash.update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
    }
    for part in &paper.parts {
        if let State::Done { content, .. } = &part.state {
            hash.update(&content.0);
        }
    }
    base64(&hash.finalize().as_bytes()[..18])
}

/// The faces of the pictures, so that text and figures are of one kind.
fn fonts() -> String {
    let face = |face: Face, style: &str, weight: u32| {
        let data = base64(face.file());
        format!(
            "@font-face{{font-family:Flow;font-style:{style};font-weight:{weight};src:url(data:font/ttf;base64,{data})}}\n"
        )
    };
    [face(Face::Regular, "normal", 400), face(Face::Italic, "italic", 400), face(Face::Semibold, "normal", 600)]
        .concat()
}

/// The stages that have a section, with the tables and figures that stand in it.
fn homes(paper: &Paper) -> Vec<(usize, Vec<usize>)> {
    let all = 0..paper.parts.len();
    let members = |home: usize| all.clone().filter(|&i| i != home && paper.home(i) == home).collect();
    all.clone().filter(|&i| paper.home(i) == i).map(|i| (i, members(i))).collect()
}

fn masthead(paper: &Paper, mark: &str) -> Markup {
    let profile = paper.profile.as_ref().map(|profile| format!(", profile {profile}"));
    html! {
        header {
            div.bar-top {
                p.mark { (mark) }
                div #tools {}
            }
            h1 { (paper.title) }
            @if !paper.about.is_empty() { p.abstract { (paper.about) } }
            p.byline { code { (paper.file) } (profile.unwrap_or_default()) @for set in &paper.sets { ", " code { (set) } } }
        }
    }
}

fn contents(paper: &Paper) -> Markup {
    html! {
        nav aria-label="Contents" {
            details #contents {
                summary { "Contents" }
                ol {
                    li { a href="#summary" { "Summary" } }
                    li { a href="#provenance" { "Workflow and provenance" } }
                    @for (i, _) in homes(paper) {
                        @let part = &paper.parts[i];
                        li {
                            a href={ "#stage-" (part.name) } { (part.words()) }
                            @if part.artifact().is_none() { " " span.gap { "missing" } }
                        }
                    }
                }
            }
        }
    }
}

/// When and by what: of the records, never of the clock.
fn made(paper: &Paper) -> Markup {
    let cost = Cost::sum(paper.parts.iter().map(|part| &part.cost));
    html! {
        "Page by flow " (env!("CARGO_PKG_VERSION")) " from the records of the store"
        @if let Some((_, last)) = cost.span { ", the last of " (moment(last)) " UTC" }
        ". Type in Source Sans 3 (a subset, SIL Open Font License 1.1)."
    }
}
