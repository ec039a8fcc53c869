//! The graph of the workflow itself: the stages that lead to those named.

use super::super::{Class, Context, Outline, kind};
use figure::dag::{Dag, Stage};

/// Names of the classes in the legend, in its order.
const CLASSES: [(&str, &[Class]); 5] = [
    ("specimens and runs", &[Class::Simulation, Class::Data]),
    ("designs", &[Class::Design]),
    ("statistics", &[Class::Statistics]),
    ("calibration", &[Class::Calibration]),
    ("tables and figures", &[Class::Presentation]),
];

/// The named stages and all stages that they need, renumbered, in the order of the workflow.
pub(super) fn outline(last: &[String], context: &Context) -> Vec<Outline> {
    let all = &context.outline;
    let mut wanted: Vec<bool> = all.iter().map(|stage| last.contains(&stage.name)).collect();
    // A stage comes after the stages that it needs.
    for place in (0..all.len()).rev().filter(|&place| all[place].inputs.iter().all(|&input| input < place)) {
        if wanted[place] {
            all[place].inputs.iter().for_each(|&input| wanted[input] = true);
        }
    }
    let kept: Vec<usize> = (0..all.len()).filter(|&place| wanted[place]).collect();
    let renumbered = |input: &usize| kept.binary_search(input).ok();
    let one = |&place: &usize| {
        let inputs = all[place].inputs.iter().filter_map(renumbered).collect();
        Outline { inputs, ..all[place].clone() }
    };
    kept.iter().map(one).collect()
}

/// The picture, with the classes that occur.
pub(super) fn dag(outline: &[Outline]) -> Dag {
    let class = |stage: &Outline| {
        let own = kind(&stage.kind)?.class;
        CLASSES.iter().position(|(_, classes)| classes.contains(&own))
    };
    let found: Vec<usize> = outline.iter().map(|stage| class(stage).unwrap_or(CLASSES.len() - 1)).collect();
    let used: Vec<usize> = (0..CLASSES.len()).filter(|class| found.contains(class)).collect();
    let place = |class: &usize| used.binary_search(class).unwrap_or(0);
    let stages = outline.iter().zip(&found);
    // A stage with the name of its kind needs no second line.
    let note = |stage: &Outline| if stage.kind == stage.name { String::new() } else { stage.kind.clone() };
    Dag {
        stages: stages
            .map(|(stage, own)| Stage { name: stage.name.clone(), note: note(stage), class: place(own) })
            .collect(),
        edges: outline
            .iter()
            .enumerate()
            .flat_map(|(to, stage)| stage.inputs.iter().map(move |&from| (from, to)))
            .collect(),
        classes: used.iter().map(|&class| CLASSES[class].0.to_owned()).collect(),
    }
}
