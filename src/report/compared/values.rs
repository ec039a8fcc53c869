//! Values without a scatter: settings, and single results.

use super::{Compared, Finding, Verdict, listed, rounded};
use crate::artifact::{ArtifactKind, Column, Values};
use figure::axis::fixed;
use maud::{Markup, html};

/// Values are equal within this share: published ones are rounded.
const EQUAL: f64 = 1e-3;
/// Values that differ and are written out.
const WRITTEN: usize = 3;

/// A pair of values.
struct Pair {
    name: Markup,
    ours: f64,
    theirs: f64,
}

impl Pair {
    fn equal(&self) -> bool {
        (self.ours - self.theirs).abs() <= EQUAL * self.ours.abs().max(self.theirs.abs())
    }
}

pub(super) fn findings(compared: &Compared) -> Vec<Finding> {
    let pairs: Vec<Pair> = compared.quantities().into_iter().flat_map(|name| pairs(compared, name)).collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let differ: Vec<&Pair> = pairs.iter().filter(|pair| !pair.equal()).collect();
    let stated = compared.maker.is_none();
    let verdict = match (differ.len(), stated) {
        (0, _) => Verdict::Agrees,
        (count, true) if count < pairs.len() => Verdict::InPart,
        (_, true) => Verdict::Differs,
        (_, false) => Verdict::Open,
    };
    let what = if stated { "what the workflow states" } else { "single results" };
    vec![Finding { verdict, what: html! { (what) }, words: words(pairs.len(), &differ, stated) }]
}

fn words(all: usize, differ: &[&Pair], stated: bool) -> Markup {
    let written: Vec<Markup> = differ.iter().take(WRITTEN).map(|pair| beside(pair, stated)).collect();
    html! {
        @match (all, differ.len()) {
            (1, 0) => { "the only value is as published" }
            (_, 0) => { "all " (all) " values are as published" }
            (all, count) => {
                @if stated { (all - count) " of " (all) " values are as published; others are " }
                (listed(&written))
                @if count > WRITTEN { " and " (count - WRITTEN) " more" }
            }
        }
    }
}

fn beside(pair: &Pair, stated: bool) -> Markup {
    html! {
        (pair.name) " " (rounded(pair.ours, 4)) " (published " (rounded(pair.theirs, 4))
        @if !stated && pair.theirs != 0.0 { ", ratio " (fixed(pair.ours / pair.theirs, 3)) }
        ")"
    }
}

/// The pairs of a column that have both values.
fn pairs(compared: &Compared, quantity: &str) -> Vec<Pair> {
    let Some((ours, theirs)) = compared.pair(quantity) else { return Vec::new() };
    let single = compared.made_from(ArtifactKind::RUN).is_some() || quantity == "value";
    let both = ours.into_iter().zip(theirs).enumerate();
    let whole = both.filter(|(_, (ours, theirs))| ours.is_finite() && theirs.is_finite());
    whole
        .map(|(row, (ours, theirs))| {
            let of = row_name(compared, row);
            let name = match of {
                Some(of) if single => of,
                Some(of) => html! { (compared.symbol(quantity)) " of " (of) },
                None => html! { (compared.symbol(quantity)) },
            };
            Pair { name, ours, theirs }
        })
        .collect()
}

/// The name of a row: the first column, when it holds names.
fn row_name(compared: &Compared, row: usize) -> Option<Markup> {
    let Column { values: Values::Texts(names), .. } = compared.table.columns.first()? else { return None };
    names.get(row).map(|name| compared.symbol(name))
}
