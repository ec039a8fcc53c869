//! `flow graph`: the stages of a workflow, their inputs, and their progress.

use super::Exit;
use super::common::{Campaign, decided};
use crate::plan::{StageNode, Workflow};
use crate::run::StageStatus;
use clap::{Args, ValueEnum};
use figure::dag::{Dag, Stage};
use figure::{DOUBLE, Figure, Style, svg::svg};

/// Show the stages of a workflow, their inputs, and their progress.
#[derive(Args)]
pub(super) struct Graph {
    #[command(flatten)]
    campaign: Campaign,
    /// How to show it.
    #[arg(long, value_enum, default_value_t = Form::Text)]
    format: Form,
}

#[derive(Clone, Copy, ValueEnum)]
enum Form {
    /// A line for each stage.
    Text,
    /// A picture.
    Svg,
    /// For Mermaid, as in Markdown files.
    Mermaid,
    /// For Graphviz.
    Dot,
}

/// Progress of a stage.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Done,
    ToRun,
    Failed,
}

impl State {
    const ALL: [Self; 3] = [Self::Done, Self::ToRun, Self::Failed];

    fn words(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::ToRun => "to run",
            Self::Failed => "cannot run",
        }
    }

    fn colour(self) -> &'static str {
        match self {
            Self::Done => "#c7e3d4",
            Self::ToRun => "#f6e3b4",
            Self::Failed => "#f2c4bc",
        }
    }
}

impl Graph {
    pub(super) fn go(self) -> Exit {
        self.print().unwrap_or_else(|exit| exit)
    }

    fn print(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load(&[])?;
        // A command that only reads makes no store.
        let reports = match self.campaign.common.store.exists() {
            true => {
                let store = self.campaign.common.read()?;
                decided(&workflow, &store, &[], true)?.stages
            }
            false => Vec::new(),
        };
        let state = |stage: &StageNode| {
            let found = reports.iter().find(|report| report.name == stage.name);
            found.map_or(State::ToRun, |report| match report.status {
                StageStatus::Done(_) => State::Done,
                StageStatus::Open => State::ToRun,
                StageStatus::Failed(_) | StageStatus::Skipped(_) => State::Failed,
            })
        };
        let states: Vec<State> = workflow.stages.iter().map(state).collect();
        let drawn = match self.format {
            Form::Text => text(&workflow, &states),
            Form::Svg => svg(&dag(&workflow, &states).scene(&Style::wide(DOUBLE))),
            Form::Mermaid => mermaid(&workflow, &states),
            Form::Dot => dot(&workflow, &states),
        };
        out!("{}", drawn.trim_end());
        Ok(Exit::Done)
    }
}

/// Arrows by index of stage, each once: from the stage that gives to the one that takes.
fn arrows(workflow: &Workflow) -> Vec<(usize, usize)> {
    let stages = workflow.stages.iter().enumerate();
    let mut arrows: Vec<_> = stages.flat_map(|(i, stage)| stage.inputs.iter().map(move |input| (input.1, i))).collect();
    arrows.sort_unstable();
    arrows.dedup();
    arrows
}

fn text(workflow: &Workflow, states: &[State]) -> String {
    let widest = |column: &dyn Fn(&StageNode) -> usize| workflow.stages.iter().map(column).max().unwrap_or(0);
    let (names, kinds) = (widest(&|stage| stage.name.len()), widest(&|stage| stage.kind.len()));
    let mut text = String::new();
    for (i, stage) in workflow.stages.iter().enumerate() {
        let from = arrows(workflow).into_iter().filter(|arrow| arrow.1 == i);
        let from: Vec<&str> = from.map(|arrow| workflow.stages[arrow.0].name.as_str()).collect();
        let from = if from.is_empty() { String::new() } else { format!("  ← {}", from.join(", ")) };
        line(&mut text, &format!("{:names$}  {:kinds$}  {:10}{from}", stage.name, stage.kind, states[i].words()));
    }
    text
}

fn dag(workflow: &Workflow, states: &[State]) -> Dag {
    let class = |state: State| State::ALL.iter().position(|other| *other == state).unwrap_or(0);
    let stages = workflow.stages.iter().zip(states);
    Dag {
        stages: stages
            .map(|(stage, &state)| Stage { name: stage.name.clone(), note: stage.kind.to_owned(), class: class(state) })
            .collect(),
        edges: arrows(workflow),
        classes: State::ALL.iter().map(|state| state.words().to_owned()).collect(),
    }
}

fn mermaid(workflow: &Workflow, states: &[State]) -> String {
    let mut text = String::from("flowchart LR\n");
    for (i, (stage, state)) in workflow.stages.iter().zip(states).enumerate() {
        line(&mut text, &format!("  s{i}[\"{}<br><i>{}</i>\"]", mermaid_text(&stage.name), mermaid_text(stage.kind)));
        line(&mut text, &format!("  style s{i} fill:{}", state.colour()));
    }
    for (from, to) in arrows(workflow) {
        line(&mut text, &format!("  s{from} --> s{to}"));
    }
    text
}

fn dot(workflow: &Workflow, states: &[State]) -> String {
    let mut text = String::from("digraph workflow {\n  rankdir=LR\n  node [shape=box, style=\"rounded,filled\"]\n");
    for (stage, state) in workflow.stages.iter().zip(states) {
        let colour = state.colour();
        let (name, kind) = (dot_text(&stage.name), dot_text(stage.kind));
        line(&mut text, &format!("  \"{name}\" [label=\"{name}\\n{kind}\", fillcolor=\"{colour}\"]"));
    }
    for (from, to) in arrows(workflow) {
        line(
            &mut text,
            &format!("  \"{}\" -> \"{}\"", dot_text(&workflow.stages[from].name), dot_text(&workflow.stages[to].name)),
        );
    }
    text.push_str("}\n");
    text
}

/// For a text in double quotes of Mermaid: signs with a meaning as entities.
fn mermaid_text(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || " _-.".contains(c);
    text.chars().map(|c| if plain(c) { c.to_string() } else { format!("#{};", u32::from(c)) }).collect()
}

/// For a text in double quotes of DOT.
fn dot_text(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace(char::is_control, " ")
}

fn line(text: &mut String, line: &str) {
    text.push_str(line);
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stay_texts_in_graphs() {
        assert_eq!(dot_text("a\"] b\\\n"), r#"a\"] b\\ "#);
        assert_eq!(mermaid_text("a\"]<b>#1"), "a#34;#93;#60;b#62;#35;1");
        assert_eq!(mermaid_text("c30_run-2.é"), "c30_run-2.é");
    }
}
