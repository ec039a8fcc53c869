//! Estimates of fitted models: by their standard errors.
//!
//! A published estimate comes from runs of its own and has an error as ours has. Two estimates of one quantity with
//! standard error s each differ by less than t s √2 in 95 of 100 cases, t being Student's on the residual degrees of freedom.

use super::{Compared, Finding, Verdict, listed, rounded};
use crate::artifact::statistics::Fits;
use crate::artifact::surfaces::{Coefficients, Surfaces};
use crate::report::table::{Cell, Judged, Judgements};
use math::distribution::t_for_coverage;
use maud::{Markup, html};

/// Estimates that differ and are written out.
const WRITTEN: usize = 4;

struct Line<'a> {
    response: &'a str,
    term: &'a str,
    ours: f64,
    theirs: f64,
    /// Of ours.
    error: f64,
    /// Most that two such estimates differ by in 95 of 100 cases.
    bound: f64,
    /// What the file of the published values says of it.
    note: &'a str,
}

impl Line<'_> {
    fn within(&self) -> bool {
        (self.ours - self.theirs).abs() <= self.bound
    }
}

/// The lines of the printed table; none in a row without an estimate on both sides, or without an error.
fn lines<'a>(compared: &Compared<'a>) -> Option<Vec<Option<Line<'a>>>> {
    let Surfaces { coefficients, coded, fit, .. } =
        Surfaces::from_artifact(compared.made_from(Surfaces::KIND)?).ok()?;
    let of = if compared.part.settings["table"] == "coded" { coded } else { coefficients };
    let (responses, terms) = (compared.texts("response")?, compared.texts("term")?);
    let (ours, theirs) = compared.pair("estimate")?;
    let notes = compared.texts("note");
    let line = |row: usize| {
        let (response, term) = (responses[row].as_str(), terms[row].as_str());
        let error = error(&of, response, term)?;
        let bound = t_for_coverage(0.95, freedom(&fit, response)?) * 2.0_f64.sqrt() * error;
        let note = notes.map_or("", |notes| notes[row].as_str());
        let found = Line { response, term, ours: ours[row], theirs: theirs[row], error, bound, note };
        (found.ours.is_finite() && found.theirs.is_finite() && bound > 0.0 && bound.is_finite()).then_some(found)
    };
    Some((0..compared.table.rows()).map(line).collect())
}

fn error(of: &Coefficients, response: &str, term: &str) -> Option<f64> {
    let own = (0..of.term.len()).find(|&i| of.response[i] == response && of.term[i] == term)?;
    of.std_error.get(own).copied()
}

fn freedom(fit: &Fits, response: &str) -> Option<f64> {
    let own = fit.response.iter().position(|name| name == response)?;
    fit.df_residual.get(own).map(|df| *df as f64)
}

pub(super) fn findings(compared: &Compared) -> Option<Vec<Finding>> {
    let lines: Vec<Line> = lines(compared)?.into_iter().flatten().collect();
    let groups = lines.chunk_by(|a, b| a.response == b.response);
    Some(groups.map(|own| finding(compared, own[0].response, own)).collect())
}

fn finding(compared: &Compared, response: &str, lines: &[Line]) -> Finding {
    let differ: Vec<&Line> = lines.iter().filter(|line| !line.within()).collect();
    let (all, count) = (lines.len(), differ.len());
    let written: Vec<Markup> = differ.iter().take(WRITTEN).map(|line| off(compared, line)).collect();
    // Of twenty true matches one lies outside by chance.
    let verdict = match count {
        0 => Verdict::Agrees,
        count if 20 * count <= all => Verdict::Agrees,
        count if count < all => Verdict::InPart,
        _ => Verdict::Differs,
    };
    let words = html! {
        @if count == 0 { @if all == 1 { "the only estimate lies" } @else { "all " (all) " estimates lie" } " within the errors of two such fits" }
        @else {
            (all - count) " of " (all) " estimates lie within the errors of two such fits; beyond them " (listed(&written))
            @if count > WRITTEN { " and " (count - WRITTEN) " more" }
        }
    };
    Finding { verdict, what: html! { "model of " (compared.symbol(response)) }, words }
}

fn off(compared: &Compared, line: &Line) -> Markup {
    let term = if line.term == "const" {
        html! { "the constant" }
    } else {
        compared.symbol(line.term)
    };
    html! {
        (term) " (" (rounded(line.ours, 3)) " ± " (rounded(line.error, 2)) ", published " (rounded(line.theirs, 3))
        @if !line.note.is_empty() { "; " (line.note) }
        ")"
    }
}

pub(super) fn judgements(compared: &Compared) -> Option<Judgements> {
    let cell = |line: Option<Line>| {
        let line = line?;
        let judged = if line.within() {
            Judged { class: "close", sign: "≈", word: "within error" }
        } else {
            Judged { class: "far", sign: "≠", word: "beyond error" }
        };
        Some(Cell { number: Some(format!("{:.1}", (line.ours - line.theirs) / line.error)), judged })
    };
    let cells = lines(compared)?.into_iter().map(cell).collect();
    Some(Judgements { column: "estimate deviation".to_owned(), head: "difference", unit: "standard errors", cells })
}
