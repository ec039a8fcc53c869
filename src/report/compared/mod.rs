//! Computed values beside published ones, judged by what they scatter.
//!
//! Two campaigns never give the same numbers: their specimens differ. So responses are judged by the ratio of all rows
//! and its interval and by their ranks, factors by which of them either side calls significant, estimates by their
//! standard errors. A per cent of a coefficient that is all noise, or of an F that nobody calls significant, says nothing
//! and is not shown.

mod estimates;
mod factors;
mod responses;
mod values;

use super::paper::{Paper, Part};
use super::symbol;
use super::table::Judgements;
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::stage::table::Table as PrintedTable;
use crate::stage::{Context, Kind};
use maud::{Markup, html};

/// What a comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Agrees,
    InPart,
    Differs,
    /// There is no scatter to judge by.
    Open,
}

impl Verdict {
    const ALL: [Self; 4] = [Self::Agrees, Self::InPart, Self::Differs, Self::Open];

    /// The head of the list of such comparisons, and its class.
    fn head(self) -> (&'static str, &'static str) {
        match self {
            Self::Agrees => ("Agrees", "close"),
            Self::InPart => ("Agrees in part", "off"),
            Self::Differs => ("Does not agree", "far"),
            Self::Open => ("Not judged: there is no scatter to judge by", "open"),
        }
    }
}

/// A sentence on one quantity of a table.
struct Finding {
    verdict: Verdict,
    /// The quantity; empty where the sentence is on the whole table.
    what: Markup,
    words: Markup,
}

/// A printed table with published values, and the stage that computed the others.
#[derive(Clone, Copy)]
struct Compared<'a> {
    context: &'a Context,
    part: &'a Part,
    maker: Option<&'a Part>,
    table: &'a Table,
}

impl<'a> Compared<'a> {
    /// The comparison of a `table` stage; none where nothing stands beside the computed values.
    fn of(paper: &'a Paper, part: &'a Part) -> Option<Self> {
        let table = part.artifact().filter(|_| part.kind == PrintedTable::NAME)?.table("table")?;
        let of: Vec<usize> = part.inputs.iter().filter(|(port, _)| port == "of").map(|&(_, input)| input).collect();
        let listed = part.settings["list"].is_string();
        let maker = of.first().map(|&input| &paper.parts[input]).filter(|_| of.len() == 1 && !listed);
        let found = Self { context: &paper.context, part, maker, table };
        (!found.quantities().is_empty()).then_some(found)
    }

    /// Names of the columns with published values beside them.
    fn quantities(&self) -> Vec<&'a str> {
        let names = self.table.columns.iter().map(|column| column.name.as_str());
        names.filter(|name| self.table.column(&beside(name)).is_some()).collect()
    }

    /// Computed and published numbers of a quantity, row by row, in one unit.
    fn pair(&self, quantity: &str) -> Option<(Vec<f64>, Vec<f64>)> {
        let (ours, unit) = self.table.shown(quantity).ok()?;
        Some((ours, self.table.numbers(&beside(quantity), unit).ok()?))
    }

    /// The texts of a column of the table.
    fn texts(&self, name: &str) -> Option<&'a [String]> {
        self.table.texts(name).ok()
    }

    /// The result that the table is made from, when it is of this kind.
    fn made_from(&self, kind: ArtifactKind) -> Option<&'a Artifact> {
        self.maker?.artifact().filter(|artifact| artifact.is(kind))
    }

    fn findings(&self) -> Vec<Finding> {
        let judged = [factors::findings, estimates::findings, responses::findings];
        judged.iter().find_map(|judge| judge(self)).unwrap_or_else(|| values::findings(self))
    }

    fn symbol(&self, name: &str) -> Markup {
        symbol::term(self.context, name).unwrap_or_else(|| html! { (name) })
    }
}

/// The column with the published values of a quantity.
fn beside(quantity: &str) -> String {
    format!("{quantity} published")
}

/// What the deviations of a printed table come to, where they are not to be read as per cent.
pub(super) fn judgements(paper: &Paper, part: &Part) -> Option<Judgements> {
    let compared = Compared::of(paper, part)?;
    factors::judgements(&compared).or_else(|| estimates::judgements(&compared))
}

/// A number with so many significant digits.
fn rounded(value: f64, digits: usize) -> Markup {
    symbol::label(&figure::axis::significant(value, digits))
}

/// Parts of a sentence with commas and an `and`.
fn listed(parts: &[Markup]) -> Markup {
    html! {
        @for (i, part) in parts.iter().enumerate() {
            @if i > 0 { @if i + 1 == parts.len() { " and " } @else { ", " } }
            (part)
        }
    }
}

/// The section of the summary; nothing where no table has published values.
pub(super) fn section(paper: &Paper) -> Markup {
    let tables: Vec<Compared> = paper.parts.iter().filter_map(|part| Compared::of(paper, part)).collect();
    let all: Vec<(&Part, Finding)> =
        tables.iter().flat_map(|table| table.findings().into_iter().map(|finding| (table.part, finding))).collect();
    html! {
        @if !all.is_empty() {
            h3 #compared { "Computed beside published" }
            p.note {
                "Two campaigns have specimens of their own, so their numbers scatter. Responses are judged by the geometric mean of all "
                "ratios, its 95 % interval, and their ranks; factors by which of them either side calls significant; estimates by their errors."
            }
            @for verdict in Verdict::ALL {
                @let own: Vec<&(&Part, Finding)> = all.iter().filter(|(_, finding)| finding.verdict == verdict).collect();
                @if !own.is_empty() {
                    @let (head, class) = verdict.head();
                    div class={ "findings " (class) } {
                        h4 { (head) " " span.soft { (own.len()) } }
                        ul { @for (part, finding) in &own {
                            li {
                                a href={ "#stage-" (part.name) } { (part.words()) } ", "
                                (finding.what) ": " (finding.words) "."
                            }
                        } }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
