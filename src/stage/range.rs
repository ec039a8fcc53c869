//! `kind = "range"`: range analysis of an orthogonal table, per factor and response.
//!
//! The result has the table `range` (`response,factor,level_1,…,range,rank`: mean response at each level, in the unit of
//! the response), the table `levels` (the values of level 1, 2, …), and `notes`.

use super::columns::{Columns, Rows, Wanted, check_names, refused_without, runs};
use super::given::check_given;
use super::invalid::Invalid;
use super::notes::Notes;
use super::reads::Reads;
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::range::{LevelValues, Levels, Range as Stored, Ranges};
use crate::artifact::validity::NotValid;
use crate::artifact::{Accepts, Artifact, ArtifactKind, Numbered};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::range::{Range as Line, range_analysis};

/// Settings of a `range` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The stage whose runs are analysed.
    pub table: String,
    /// Factors to analyse; by default all that the table has.
    #[serde(default)]
    pub factors: Vec<String>,
    /// Responses to analyse; by default all that the table has.
    #[serde(default)]
    pub responses: Vec<String>,
    /// Column with the number of replicates of which each row is the mean.
    pub weights: Option<String>,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
}

impl Stage for Range {
    fn inputs(&self) -> Vec<Port> {
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts: Accepts::Only(&[ArtifactKind::RESULTS]) }]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::RANGE
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = check_names(context, &self.factors, &self.responses);
        found.extend(check_given(context, "responses", &[&self.table], &self.responses));
        found
    }

    fn reads(&self) -> Vec<Reads> {
        vec![
            Reads::of("factors", &self.table, &self.factors),
            Reads::of("responses", &self.table, &self.responses),
            Reads::of("weights", &self.table, &self.weights),
        ]
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("table")?;
        let artifact = known.load(input)?;
        let wanted = Wanted {
            factors: &self.factors,
            responses: &self.responses,
            weights: self.weights.as_deref(),
            levels: true,
            scales: false,
            invalid: self.invalid,
        };
        let columns = Columns::of(runs(&artifact)?, known.context, wanted)?;
        Ok(Step::Finish(Task::new("range", json!(columns)).input("table", input.content)))
    }
}

impl Kind for Range {
    const NAME: &'static str = "range";
    const ABOUT: &'static str = "range analysis: mean response per level, range and rank of every factor";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RANGE];
    const CLASS: Class = Class::Statistics;
    // 3: runs that are not valid are left out. 2: notes
    const WORKS: &'static [Work] = &[Work { name: "range", version: 3, run: analyse }];
}

fn analyse(job: &Job) -> Result<Artifact, Failure> {
    let columns: Columns = job.params()?;
    let table = runs(job.input("table")?)?;
    let (sample, not_valid) = (columns.sample(table)?, columns.not_valid(table)?);
    let lines = range_analysis(&sample).map_err(|faults| refused_without(faults, &not_valid))?;
    let most = lines.iter().map(|line| line.levels.len()).max().unwrap_or(0);
    let rows = Rows(&lines);
    let range = Ranges {
        response: rows.texts(|l| l.response.as_str()),
        factor: rows.texts(|l| l.factor.as_str()),
        level: Numbered((0..most).map(|level| rows.reals(|l| l.means.get(level).copied())).collect()),
        range: rows.reals(|l| Some(l.range)),
        rank: rows.ints(|l| l.rank),
        missing: rows.ints(|l| l.missing),
    };
    let levels = levels(&columns, &lines, most);
    let notes = notes(&lines, sample.rows(), &not_valid).table();
    Ok(Stored { range, levels, notes, not_valid: not_valid.some() }.to_artifact())
}

/// Notes on responses whose missing runs make the table unbalanced.
fn notes<'a>(lines: &[Line], rows: usize, not_valid: &'a NotValid) -> Notes<'a> {
    let mut notes = Notes::of(not_valid);
    for lines in lines.chunk_by(|a, b| a.response == b.response) {
        let (response, missing) = (lines[0].response.as_str(), lines[0].missing);
        notes.missing(response, rows - missing, missing);
        if missing > 0 {
            notes.add(response, "levels are met unequally often for it, so that a range holds some of other factors");
        }
    }
    notes
}

/// The values of level 1, 2, … of each factor.
fn levels(columns: &Columns, lines: &[Line], most: usize) -> LevelValues {
    let first = lines.first().map(|line| line.response.clone());
    let own: Vec<&Line> = lines.iter().filter(|line| Some(&line.response) == first.as_ref()).collect();
    let rows = Rows(&own);
    let named = columns.categories().next().is_some();
    let numbers = |level: usize| rows.reals(|l| l.levels.get(level).copied());
    let names = |level: usize| rows.texts(|l| l.names.get(level).cloned().unwrap_or_default());
    LevelValues {
        factor: rows.texts(|l| l.factor.as_str()),
        unit: rows.texts(|l| columns.unit_of(&l.factor)),
        level: if named {
            Levels::Names(Numbered((0..most).map(names).collect()))
        } else {
            Levels::Numbers(Numbered((0..most).map(numbers).collect()))
        },
    }
}
