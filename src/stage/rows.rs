//! A run for every row of a design, gathered into one table: shared by every simulator kind.
//!
//! Rows are identified by their content. Equal rows of one design are replicates, numbered from 1 by occurrence, so new
//! rows change nothing for the others, and the same row and replicate in two designs is one run.

mod points;

pub use points::DesignRows;

use super::cached::{CachedRuns, RunSummaries};
use super::material::{self, Material};
use super::{
    Complaint, Context, Failure, Input, Job, Known, Named, Parameter, Point, Source, Stage, StageError, Step, Task,
    Work, vary,
};
use crate::artifact::design::Design;
use crate::artifact::results::{Results, Verdicts};
use crate::artifact::run::{Outcome, Run};
use crate::artifact::{Artifact, Column, Table};
use crate::expression::Measure;
use crate::unit::{Conversion, Dimension, Unit};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The columns of a design that are factors, by name.
fn factor_columns<'a>(design: &'a Artifact, context: &Context) -> Result<Vec<&'a Column>, StageError> {
    let table = Design::table(design).or_else(|_| Results::table(design))?;
    Ok(table.columns.iter().filter(|column| context.factors.contains_key(&column.name)).collect())
}

/// Values of a material by path after a point of the factor space was applied to it, and its formulas evaluated.
///
/// # Errors
/// A factor of the point is unknown or sets a value that does not exist, or a formula needs a value that is not set.
pub fn apply(material: &Material, point: &Point, context: &Context) -> Result<material::Values, StageError> {
    let mut set = material::Values::new();
    let mut measures: BTreeMap<&str, Measure> = BTreeMap::new();
    for (name, value) in point {
        let factor = context.factors.get(name).ok_or_else(|| StageError::new(format!("`{name}` is not a factor")))?;
        let measure = factor.measure(*value);
        let measure = measure.ok_or_else(|| StageError::new(format!("factor `{name}`: unit `{}`", factor.unit)))?;
        measures.insert(name, measure);
        for path in factor.sets.iter().filter(|path| !context.sets_stage(path)) {
            if !material.takes(path) {
                let known: Vec<String> = material.paths().collect();
                let message = format!("factor `{name}` sets `{path}`, which the material does not have");
                return Err(StageError::new(message).hint(format!("the material has {}", known.join(", "))));
            }
            let dimension = measure.dimension.unwrap_or(Dimension::NONE);
            set.insert(path.clone(), Parameter { value: measure.value, dimension });
        }
    }
    let (values, faults) = material.resolve(&set, &|name| measures.get(name).copied());
    match faults.first() {
        Some(fault) => Err(StageError::new(&fault.why).hint("let the design vary it, or give the value itself")),
        None => Ok(values),
    }
}

/// All values that a run can name at a point: the material's values by path (SI) after the point was applied, and the
/// factors by name (in their units) that set something.
///
/// # Errors
/// As [`apply`].
pub fn values(
    material: Option<&String>,
    point: &Point,
    context: &Context,
) -> Result<BTreeMap<String, f64>, StageError> {
    let mut values = BTreeMap::new();
    if let Some(material) = material.and_then(|name| context.materials.get(name)) {
        values = apply(material, point, context)?.into_iter().map(|(path, found)| (path, found.value)).collect();
    }
    let sets = |name: &str| context.factors.get(name).is_none_or(|factor| !factor.sets.is_empty());
    values.extend(point.iter().filter(|(name, _)| sets(name)).map(|(name, value)| (name.clone(), *value)));
    Ok(values)
}

/// The complaint about a material that the workflow does not declare.
pub fn check_material(name: Option<&String>, context: &Context) -> Option<Complaint> {
    let name = name.filter(|name| !context.materials.contains_key(*name))?;
    let known: Vec<&str> = context.materials.keys().map(String::as_str).collect();
    let hint = if known.is_empty() { "there is none".to_owned() } else { format!("there is {}", known.join(", ")) };
    Some(Complaint::new("material", format!("there is no [material.{name}]")).missing(Named::Material, name).hint(hint))
}

/// The complaint about the unit of a simulator's response: it cannot be read, or not be converted to the unit that the
/// workflow declares.
pub fn check_response(path: &str, name: &str, unit: &str, context: &Context) -> Option<Complaint> {
    let given = match Unit::parse(unit) {
        Ok(given) => given,
        Err(e) => return Some(Complaint::new(path, e.to_string())),
    };
    // A fault of the declared unit is reported at its declaration.
    let declared = &context.responses.get(name)?.unit;
    Unit::parse(declared).ok().filter(|wanted| wanted.dimension != given.dimension)?;
    let words = |text: &str| if text.is_empty() { "as a pure number".to_owned() } else { format!("in `{text}`") };
    let message = format!("`{name}` comes {} and cannot be shown {}", words(unit), words(declared));
    Some(Complaint::new(path, message).hint(format!("mend this unit, or that of [response.{name}]")))
}

#[derive(Serialize, Deserialize)]
struct GatherParams {
    /// Names of the factor columns of the design.
    factors: Vec<String>,
    /// Unit of each response in the table; other responses have the unit of the runs.
    units: BTreeMap<String, String>,
}

/// The step of a simulator: a task for every row of its `design`, gathered into one table; one run without a design.
///
/// # Errors
/// The design cannot be read, or a row cannot be tried.
pub fn fan_out(simulator: &dyn Stage, known: &Known) -> Result<Step, StageError> {
    let Some(design) = known.port("design").next() else {
        return Ok(Step::Finish(vary::sample(simulator, known, &Point::new(), 1)?));
    };
    let artifact = known.load(design)?;
    let mut task = gather(known, design, &artifact)?;
    let rows = Arc::new(DesignRows::of(&artifact, known.context)?);
    task.inputs.reserve(rows.len());
    let mut cached_runs = CachedRuns::with_room(rows.len());
    for index in 0..rows.len() {
        let source = match known.library.cached(&rows, index) {
            Some(cached) => {
                cached_runs.push(task.inputs.len(), index, cached);
                Source::Content(cached.content)
            }
            None => {
                let run = vary::sample(simulator, known, &rows.point(index), rows.replicate(index))?;
                Source::Task(Arc::new(run.row(index)))
            }
        };
        task.inputs.push((RUN.into(), source));
    }
    task.cached = (!cached_runs.runs.is_empty()).then(|| Arc::new(cached_runs));
    Ok(Step::Finish(task))
}

/// The task that gathers runs, one per row of the design, into the table `runs` of a `results` artifact; it has no runs yet.
fn gather(known: &Known, design: &Input<'_>, artifact: &Artifact) -> Result<Task, StageError> {
    let factors = factor_columns(artifact, known.context)?.iter().map(|column| column.name.clone()).collect();
    let unit = |(name, response): (&String, &super::Response)| (name.clone(), response.unit.clone());
    let units = known.context.responses.iter().map(unit).collect();
    Ok(Task::new("gather", json!(GatherParams { factors, units })).input("design", design.content))
}

/// Name of the inputs of a gathering task that are runs.
pub const RUN: &str = "run";

/// Work that every simulator kind lists. 2: what the checks of the runs say.
pub const GATHER: Work = Work { name: "gather", version: 2, run: gathered };

/// Complaints about responses whose unit cannot be read; for [`super::Stage::check`] of simulator kinds.
pub fn check_units(context: &Context) -> Vec<Complaint> {
    let units = context.responses.iter().map(|(name, response)| (name, &response.unit));
    units
        .filter_map(|(name, unit)| {
            Unit::parse(unit).err().map(|e| Complaint::new("", format!("response `{name}`: {e}")))
        })
        .collect()
}

fn gathered(job: &Job) -> Result<Artifact, Failure> {
    let params: GatherParams = job.params()?;
    let design = job.input("design")?;
    let design = Design::table(design).map_err(StageError::from)?;
    let cached = job
        .inputs
        .iter()
        .find(|(name, _)| name == "cached")
        .map(|(_, cached)| RunSummaries::of_artifact(cached))
        .transpose()?;
    let mut table = Table { about: "one row per run".to_owned(), columns: Vec::new() };
    for name in &params.factors {
        let column = design.column(name).ok_or_else(|| StageError::new(format!("the design lost factor `{name}`")))?;
        table.columns.push(column.clone());
    }
    let mut found = Gathered::default();
    each_outcome(job, cached.as_ref(), &mut |outcome| found.add(outcome, &params.units))?;
    drop(cached);
    Ok(found.results(table).to_artifact())
}

/// Calls `add` with the outcome of every run, loaded or cached, in the order of the rows.
fn each_outcome(
    job: &Job,
    cached: Option<&(&[i64], RunSummaries)>,
    add: &mut dyn FnMut(Outcome<'_>) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let (indices, summaries) = cached.map_or((&[][..], None), |(indices, summaries)| (*indices, Some(summaries)));
    let mut old = indices.iter().enumerate().peekable();
    let mut new = job.inputs.iter().filter(|(name, _)| name == RUN);
    // The first input of a gathering task is the design.
    for index in 1.. {
        match old.next_if(|(_, cached)| **cached == index) {
            Some((run, _)) => {
                let summary = summaries.and_then(|summaries| summaries.get(run));
                add(summary.ok_or_else(|| StageError::new("a cached run has no summary"))?.responses())?;
            }
            None => match new.next() {
                Some((_, run)) => add(Run::outcome(run)?)?,
                None => break,
            },
        }
    }
    Ok(())
}

/// The columns of a table of runs, which grow run by run.
#[derive(Default)]
struct Gathered {
    rows: usize,
    /// Whether a run was checked.
    checked: bool,
    failures: Texts,
    validities: Texts,
    cautions: Texts,
    /// In the order of their first mention.
    responses: Vec<ResponseColumn>,
}

/// A text for each run, up to the last run that has one.
#[derive(Default)]
struct Texts(Vec<String>);

impl Texts {
    /// Adds the text of a row.
    fn add(&mut self, row: usize, text: &str) {
        if !text.is_empty() {
            self.0.resize(row, String::new());
            self.0.push(text.to_owned());
        }
    }

    /// The texts of all rows.
    fn all(mut self, rows: usize) -> Vec<String> {
        self.0.resize(rows, String::new());
        self.0
    }
}

/// A response of all runs so far.
struct ResponseColumn {
    name: String,
    /// The unit that it is shown in.
    unit: String,
    /// The last unit that it came in, and the conversion of that one: it is nearly always the same.
    last: Option<(String, Conversion)>,
    values: Vec<f64>,
}

impl Gathered {
    /// Adds a run. `units` are those in which responses are shown, where that is not the unit of the runs.
    fn add(&mut self, outcome: Outcome<'_>, units: &BTreeMap<String, String>) -> Result<(), StageError> {
        let Outcome { failure, validity, cautions, responses } = outcome;
        let row = self.rows;
        for (name, value, from) in responses {
            let column = match self.responses.iter().position(|column| column.name == name) {
                Some(number) => &mut self.responses[number],
                None => {
                    let unit = units.get(name).map_or(from, String::as_str);
                    self.responses.push(ResponseColumn::new(name, unit, row));
                    let last = self.responses.len() - 1;
                    &mut self.responses[last]
                }
            };
            // Of a response that a run names twice the first value counts.
            if column.values.len() == row {
                let value = if failure.is_empty() { column.shown(value, from)? } else { f64::NAN };
                column.values.push(value);
            }
        }
        self.responses.iter_mut().for_each(|column| column.values.resize(row + 1, f64::NAN));
        self.checked |= validity.is_some();
        self.failures.add(row, failure);
        self.validities.add(row, &validity.unwrap_or_default());
        self.cautions.add(row, &cautions);
        self.rows += 1;
        Ok(())
    }

    /// The table behind the columns of the factors.
    fn results(self, mut table: Table) -> Results {
        for ResponseColumn { name, unit, values, .. } in self.responses {
            table = table.reals_column(&name, &unit, "", values);
        }
        let checked = self.checked.then(|| (self.validities.all(self.rows), self.cautions.all(self.rows)));
        Results::of(table, Verdicts { failures: self.failures.all(self.rows), checked })
    }
}

impl ResponseColumn {
    /// A column without values in the first `rows` rows.
    fn new(name: &str, unit: &str, rows: usize) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned(), last: None, values: vec![f64::NAN; rows] }
    }

    /// A value in the unit of the column.
    fn shown(&mut self, value: f64, from: &str) -> Result<f64, StageError> {
        let known = self.last.as_ref().filter(|(unit, _)| unit == from).map(|(_, conversion)| *conversion);
        let conversion = match known {
            Some(conversion) => conversion,
            None => {
                let found = conversion(&self.name, from, &self.unit)?;
                self.last = Some((from.to_owned(), found));
                found
            }
        };
        Ok(conversion.of(value))
    }
}

fn conversion(name: &str, from: &str, unit: &str) -> Result<Conversion, StageError> {
    Conversion::between(from, unit).map_err(|e| {
        StageError::new(format!("response `{name}` comes in `{from}` and cannot be shown in `{unit}`: {e}"))
            .hint("mend the unit of [response] in the workflow")
    })
}

#[cfg(test)]
mod tests;
