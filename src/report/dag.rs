//! The picture of the workflow: which stage takes what from which.

use super::figure::Glyphs;
use super::paper::{Paper, State};
use figure::dag::{Dag, Stage};
use figure::{DOUBLE, Figure, SINGLE, Style, svg::svg};
use maud::{Markup, html};

/// Widest picture of the workflow, in mm, that stands in half the page.
const NARROW: f64 = 120.0;

/// The stages that compute, as boxes. Tables and figures stand with what they show and are left out, and so is what
/// only they read.
pub(super) fn picture(paper: &Paper, glyphs: &mut Glyphs) -> Markup {
    let own: Vec<usize> = (0..paper.parts.len()).filter(|&i| paper.home(i) == i).collect();
    let reads = |reader: usize, maker: usize| paper.parts[reader].inputs.iter().any(|&(_, input)| input == maker);
    let is_read = |i: &usize| own.iter().any(|&reader| reads(reader, *i));
    // Lists of what the workflow says, and data that only tables read, compute nothing.
    let computes = |i: &usize| paper.parts[*i].class.computes();
    let shown: Vec<usize> = own.iter().copied().filter(|i| computes(i) || own.len() == 1 || is_read(i)).collect();
    let position = |index: usize| shown.iter().position(|&i| i == index);
    let stages = shown.iter().map(|&i| {
        let part = &paper.parts[i];
        let runs = Some(part.outcome.runs).filter(|&runs| runs > 1).map(|runs| format!(" · {runs} runs"));
        Stage {
            name: part.name.clone(),
            note: format!("{}{}", part.kind, runs.unwrap_or_default()),
            class: match part.state {
                State::Done { .. } => 0,
                State::Missing => 1,
                State::Broken(_) => 2,
            },
        }
    });
    let inputs = shown.iter().flat_map(|&i| paper.parts[i].inputs.iter().map(move |&(_, input)| (input, i)));
    let mut edges: Vec<(usize, usize)> = inputs.filter_map(|(a, b)| Some((position(a)?, position(b)?))).collect();
    edges.sort_unstable();
    edges.dedup();
    let classes = ["done", "to run", "cannot run"].map(str::to_owned).to_vec();
    let dag = Dag { stages: stages.collect(), edges, classes };
    // A few stages stay as narrow as a telephone.
    let narrow = dag.scene(&Style::wide(SINGLE));
    let is_narrow = narrow.width <= NARROW;
    let scene = if is_narrow { narrow } else { dag.scene(&Style::wide(DOUBLE)) };
    let label = format!("{}. {}", scene.title, scene.description);
    let left = paper.parts.len() - shown.len();
    let Some((drawn, _)) = glyphs.inline(&svg(&scene), &label) else { return html! {} };
    html! {
        figure #dag class=(if is_narrow { "single" } else { "double" }) {
            div.plot.ink { (drawn) }
            figcaption {
                b { "The workflow." } " Results flow along the arrows."
                @if left > 0 { " " (left) " tables, figures and what only they read are left out; they stand in the sections of what they show." }
            }
        }
    }
}
