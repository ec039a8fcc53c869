//! Responses of runs: by the ratio of all rows and by their ranks.

use super::{Compared, Finding, Verdict};
use crate::artifact::ArtifactKind;
use crate::report::table::CLOSE;
use figure::axis::fixed;
use maud::{Markup, html};
use stats::agreement::{agreement, geometric_mean};

/// From this rank correlation on the rows stand in the same order, but for what scatters.
const SAME_ORDER: f64 = 0.9;
/// From this one on in a similar order.
const LIKE_ORDER: f64 = 0.5;
/// Fewer rows are no sample.
const SAMPLE: usize = 3;

pub(super) fn findings(compared: &Compared) -> Option<Vec<Finding>> {
    compared.made_from(ArtifactKind::RESULTS)?;
    let responses = compared.quantities().into_iter().filter(|name| compared.context.responses.contains_key(*name));
    let found: Vec<Finding> = responses.filter_map(|response| finding(compared, response)).collect();
    (!found.is_empty()).then_some(found)
}

fn finding(compared: &Compared, response: &str) -> Option<Finding> {
    let (ours, theirs) = compared.pair(response)?;
    let (verdict, words) = judge(&ours, &theirs)?;
    let rows = if ours.len() == 1 { "" } else { " of the runs" };
    Some(Finding { verdict, what: html! { (compared.symbol(response)) (rows) }, words })
}

/// The verdict on pairs of values, and why.
pub(super) fn judge(ours: &[f64], theirs: &[f64]) -> Option<(Verdict, Markup)> {
    let found = agreement(theirs, ours)?;
    let ratios = ours.iter().zip(theirs).map(|(a, b)| a / b).filter(|ratio| ratio.is_finite());
    let ratio = geometric_mean(&ratios.collect::<Vec<_>>());
    let Some([low, mean, high]) = ratio.filter(|[low, ..]| low.is_finite() && found.n >= SAMPLE) else {
        let ratio = fixed(found.quartiles[1], 3);
        return Some((Verdict::Open, html! { (found.n) " of them, computed over published " (ratio) }));
    };
    let within = low <= 1.0 && 1.0 <= high;
    let near = within || (mean - 1.0).abs() <= CLOSE / 100.0;
    let level = if within {
        html! { "no difference beyond the scatter (" (found.n) " pairs, ratio " (fixed(mean, 3)) ", 95 % interval " (fixed(low, 3)) " to " (fixed(high, 3)) ")" }
    } else {
        let word = if mean > 1.0 { "higher" } else { "lower" };
        html! {
            (fixed(100.0 * (mean - 1.0).abs(), 1)) " % " (word) " (" (found.n) " pairs, ratio " (fixed(mean, 3)) ", 95 % interval "
            (fixed(low, 3)) " to " (fixed(high, 3)) ")"
        }
    };
    let order = found.spearman.map(|rho| {
        let word = match rho {
            rho if rho >= SAME_ORDER => "in the same order",
            rho if rho >= LIKE_ORDER => "in a similar order",
            _ => "in another order",
        };
        html! { ", " (word) " (rank correlation " (fixed(rho, 3)) ")" }
    });
    let ordered = found.spearman.is_none_or(|rho| rho >= SAME_ORDER);
    // Rows in the opposite order scatter about any ratio.
    let opposed = found.spearman.is_some_and(|rho| rho <= -LIKE_ORDER);
    let verdict = match (near, ordered) {
        _ if opposed => Verdict::Differs,
        (true, true) => Verdict::Agrees,
        (false, false) => Verdict::Differs,
        (true, false) | (false, true) => Verdict::InPart,
    };
    Some((verdict, html! { (level) @if let Some(order) = order { (order) } }))
}
