//! The runs whose curves are drawn together: single runs, or every row of a simulator's results.

use super::super::invalid::sentence;
use super::super::rows::DesignRows;
use super::super::{Input, Known, Source, StageError};
use super::{Figure, Params};
use crate::artifact::results::Results;
use crate::artifact::validity::of_runs;
use crate::artifact::{Artifact, ArtifactKind, Values};
use figure::text::plain_text;
use std::borrow::Cow;
use std::sync::Arc;

/// Inputs of the figure, each with its group.
#[derive(Default)]
pub(super) struct Runs {
    pub inputs: Vec<(Cow<'static, str>, Source)>,
    /// Number and name of the group, input by input; empty without groups.
    pub groups: Vec<(usize, String)>,
    /// Sentences, as labels, on runs that gave no result or are not valid.
    pub notes: Vec<String>,
}

/// Most curves in one figure.
const MOST: usize = 500;

/// The runs of the stages of the figure. The runs of a design are the tasks of the simulator for its rows, so nothing is
/// computed again.
pub(super) fn runs(figure: &Figure, known: &Known) -> Result<Runs, StageError> {
    let mut found = Runs::default();
    let mut keys: Vec<String> = Vec::new();
    let several = known.port("of").count() > 1;
    for input in known.port("of") {
        let artifact = known.load(input)?;
        let stage = figure.names.get(input.stage).cloned().unwrap_or_else(|| input.stage.replace('_', " "));
        if artifact.is(ArtifactKind::RUN) {
            let (drawn, said) = figure.choice().of_run(&artifact, &stage)?;
            found.notes.extend(said.map(|said| sentence("", &plain_text(&said))));
            if !drawn {
                continue;
            }
            found.inputs.push(("of".into(), Source::Content(input.content)));
            if several {
                found.groups.push((number(&mut keys, &stage), stage));
            }
            continue;
        }
        add_rows(figure, known, input, &artifact, (&stage, several), (&mut found, &mut keys))?;
    }
    if found.inputs.is_empty() {
        let message = format!("no run is left to draw. {}", found.notes.join(" "));
        return Err(StageError::new(message).hint("invalid = \"keep\" draws runs that are not valid"));
    }
    if found.inputs.len() > MOST {
        let message = format!("{} curves cannot be told apart in one figure", found.inputs.len());
        return Err(StageError::new(message).hint(format!("at most {MOST}; draw the results of a smaller design")));
    }
    Ok(found)
}

fn number(keys: &mut Vec<String>, key: &str) -> usize {
    keys.iter().position(|known| known == key).unwrap_or_else(|| {
        keys.push(key.to_owned());
        keys.len() - 1
    })
}

/// Adds the run of every row that gave a result.
fn add_rows(
    figure: &Figure,
    known: &Known,
    input: &Input,
    artifact: &Artifact,
    (stage, several): (&str, bool),
    (found, keys): (&mut Runs, &mut Vec<String>),
) -> Result<(), StageError> {
    let rows = DesignRows::of(artifact, known.context)?;
    let table = Results::table(artifact)?;
    let judged = figure.choice().judge(table)?;
    let about = if several { stage } else { "" };
    found.notes.extend(of_runs(table, judged.verdict()).iter().map(|said| sentence(about, &plain_text(said))));
    let failures = Results::failures(table);
    let failed = |row: usize| failures.get(row).is_some_and(|why| !why.is_empty()) || judged.leaves_out(row);
    let label = |row: usize| match &figure.by {
        None => Ok(stage.to_owned()),
        Some(by) => {
            let column = table.column(by);
            let column = column.ok_or_else(|| StageError::new(format!("the runs have no column `{by}`")))?;
            Ok::<String, StageError>(match &column.values {
                Values::Texts(texts) => texts[row].clone(),
                Values::Ints(values) => values[row].to_string(),
                Values::Reals(values) => values[row].to_string(),
            })
        }
    };
    for row in (0..rows.len()).filter(|&row| !failed(row)) {
        let task = (input.sample)(&rows.point(row), rows.replicate(row))?;
        found.inputs.push(("of".into(), Source::Task(Arc::new(task.row(row)))));
        if several || figure.by.is_some() {
            let label = label(row)?;
            found.groups.push((number(keys, &label), label));
        }
    }
    Ok(())
}

impl Params {
    /// Names of the groups in the order of their numbers, with the symbol of the quantity that defines them.
    pub(super) fn group_names(&self) -> Vec<String> {
        let most = self.groups.iter().map(|(group, _)| group + 1).max().unwrap_or(0);
        let sign = self.labels.get("by").map(super::Label::quantity);
        let unit = sign.as_ref().map(|q| figure::text::unit_markup(&q.unit)).unwrap_or_default();
        let name = |group: usize| {
            let own = self.groups.iter().find(|(number, _)| *number == group).map_or("", |(_, name)| name.as_str());
            match &sign {
                Some(quantity) => format!("{} = {own} {unit}", quantity.sign()).trim_end().to_owned(),
                None => own.to_owned(),
            }
        };
        (0..most).map(name).collect()
    }
}
