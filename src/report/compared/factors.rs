//! Factors of an analysis of variance: which of them either side calls significant.
//!
//! The published F is judged as ours is, at the level of the stage, on the degrees of freedom of the line and of our
//! residual: a table of the same design has the same.

use super::{Compared, Finding, Verdict, listed, rounded};
use crate::artifact::statistics::{Anova, Variances};
use crate::report::table::{Cell, Judged, Judgements};
use figure::axis::fixed;
use math::distribution::f_upper;
use maud::{Markup, html};

/// A line of the analysis that has an F on both sides.
struct Line<'a> {
    response: &'a str,
    source: &'a str,
    ours: Side,
    theirs: Side,
}

#[derive(Clone, Copy)]
struct Side {
    f: f64,
    significant: bool,
}

/// Where the degrees of freedom of the error stand.
const RESIDUAL: &str = "residual";

/// The lines of the printed table; none in a row without an F on both sides.
fn lines<'a>(compared: &Compared<'a>) -> Option<Vec<Option<Line<'a>>>> {
    let anova = Anova::from_artifact(compared.made_from(Anova::KIND)?).ok()?.anova;
    let level = compared.maker?.settings["alpha"].as_f64()?;
    let (responses, sources) = (compared.texts("response")?, compared.texts("source")?);
    let (_, theirs) = compared.pair("f")?;
    let line = |row: usize| {
        let (response, source) = (responses[row].as_str(), sources[row].as_str());
        let own = index(&anova, response, source)?;
        let error = anova.df[index(&anova, response, RESIDUAL)?] as f64;
        let side = |f: f64| Side { f, significant: f_upper(f, anova.df[own] as f64, error) <= level };
        let (ours, theirs) = (side(anova.f[own]), side(theirs[row]));
        (ours.f.is_finite() && theirs.f.is_finite()).then_some(Line { response, source, ours, theirs })
    };
    Some((0..compared.table.rows()).map(line).collect())
}

fn index(anova: &Variances, response: &str, source: &str) -> Option<usize> {
    (0..anova.source.len()).find(|&i| anova.response[i] == response && anova.source[i] == source)
}

pub(super) fn findings(compared: &Compared) -> Option<Vec<Finding>> {
    let lines: Vec<Line> = lines(compared)?.into_iter().flatten().collect();
    let groups = lines.chunk_by(|a, b| a.response == b.response);
    Some(groups.map(|own| finding(compared, own[0].response, own)).collect())
}

fn finding(compared: &Compared, response: &str, lines: &[Line]) -> Finding {
    let some = |ours: bool, theirs: bool| -> Vec<Markup> {
        let own = lines.iter().filter(|line| (line.ours.significant, line.theirs.significant) == (ours, theirs));
        own.map(|line| both(compared, line)).collect()
    };
    let (shared, here, print) = (some(true, true), some(true, false), some(false, true));
    let verdict = match (shared.is_empty(), here.is_empty() && print.is_empty()) {
        (_, true) => Verdict::Agrees,
        (false, false) => Verdict::InPart,
        (true, false) => Verdict::Differs,
    };
    let words = html! {
        @if shared.is_empty() { "no factor is significant on both sides" }
        @else { "both sides call " (listed(&shared)) " significant" }
        @if !here.is_empty() { "; only the computed runs " (listed(&here)) }
        @if !print.is_empty() { "; only the published ones " (listed(&print)) }
    };
    Finding { verdict, what: html! { "factors of " (compared.symbol(response)) }, words }
}

/// A factor with its F on both sides.
fn both(compared: &Compared, line: &Line) -> Markup {
    let f = |side: Side| {
        if side.f < 100.0 {
            html! { (fixed(side.f, 1)) }
        } else {
            rounded(side.f, 3)
        }
    };
    html! { (compared.symbol(line.source)) " (F " (f(line.ours)) ", published " (f(line.theirs)) ")" }
}

pub(super) fn judgements(compared: &Compared) -> Option<Judgements> {
    let cell = |line: Option<Line>| {
        let line = line?;
        let judged = match (line.ours.significant, line.theirs.significant) {
            (true, true) => Judged { class: "close", sign: "✓", word: "both" },
            (true, false) => Judged { class: "off", sign: "↑", word: "only here" },
            (false, true) => Judged { class: "off", sign: "↓", word: "only published" },
            (false, false) => Judged { class: "", sign: "", word: "neither" },
        };
        Some(Cell { number: None, judged })
    };
    let cells = lines(compared)?.into_iter().map(cell).collect();
    Some(Judgements { column: "f deviation".to_owned(), head: "called significant by", unit: "", cells })
}
