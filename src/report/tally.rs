//! What is counted at the top of the page: runs as they were, those without a result, warnings, targets that are not met.

use super::paper::{Outcome, Paper};
use super::warning::{unmet, warnings};
use maud::{Markup, html};

/// One count.
struct Count {
    number: usize,
    /// Of which it is a part; nothing where it stands for itself.
    of: Option<usize>,
    words: &'static str,
    /// Where more is said of it; empty where nothing is.
    link: &'static str,
}

impl Count {
    fn markup(&self) -> Markup {
        let class = if self.of.is_some() && self.number > 0 { "count off" } else { "count" };
        let words = html! { (self.words) };
        html! {
            div class=(class) {
                dd { b { (self.number) } @if let Some(of) = self.of { " of " (of) } }
                dt { @if self.link.is_empty() || self.number == 0 { (words) } @else { a href=(self.link) { (words) } } }
            }
        }
    }
}

/// The counts of a campaign.
pub(super) fn tally(paper: &Paper) -> Markup {
    let Outcome { runs, failed, invalid, cautions, unmade, .. } =
        Outcome::sum(paper.parts.iter().map(|part| &part.outcome));
    let alarms: usize = paper.parts.iter().map(|part| warnings(part).len()).sum();
    let [out_of_reach, outside] =
        paper.parts.iter().map(unmet).fold([0, 0], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    let targets = targets(paper);
    let link = "#warnings";
    let mut counts = Vec::new();
    if runs > 0 {
        counts.push(Count { number: runs, of: None, words: "runs of the model", link: "" });
        counts.push(Count { number: failed, of: Some(runs), words: "without a result", link });
        counts.push(Count { number: invalid, of: Some(runs), words: "not valid", link });
        counts.push(Count { number: cautions, of: Some(runs), words: "to be read with caution", link });
    }
    if unmade > 0 {
        counts.push(Count { number: unmade, of: None, words: "specimens that could not be made", link });
    }
    if targets[0] > 0 {
        counts.push(Count { number: out_of_reach, of: Some(targets[0]), words: "targets out of reach", link });
    }
    if targets[1] > 0 {
        let words = "targets outside the interval of their verification";
        counts.push(Count { number: outside, of: Some(targets[1]), words, link });
    }
    counts.push(Count { number: alarms, of: None, words: "warnings", link });
    html! { dl.tally { @for count in &counts { (count.markup()) } } }
}

/// Targets of calibrations, and of verifications.
fn targets(paper: &Paper) -> [usize; 2] {
    let rows = |table: &str| -> usize {
        let tables = paper.parts.iter().filter_map(|part| part.artifact()?.table(table));
        tables
            .filter_map(|table| table.numbers("target", "").ok())
            .map(|all| all.iter().filter(|t| t.is_finite()).count())
            .sum()
    };
    [rows("prediction"), rows("summary")]
}
