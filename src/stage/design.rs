//! `kind = "design"`: the runs of an experiment, and what they can tell.
//!
//! `method` picks the design; the other keys are its options, and an option of another method is refused. The factors
//! are those of the workflow, in the order named. Orthogonal, factorial designs take a factor's levels (its range if it
//! has none); two-level and sampled designs its range (the extreme levels if it has none); central composite and
//! Box–Behnken designs its range, or up to three levels. Rows come from the workflow (`rows`) or a CSV file beside it
//! (`file`) with `method = "given"`.
//!
//! The result has the tables `design` (run, standard order, point type, factors in their units), `coded` and `report`.

mod config;
mod tables;
#[cfg(test)]
mod tests;

pub use config::Design;

use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Port, Sketch, Stage, StageError, Step, Task, Work, data,
};
use crate::artifact::{Artifact, ArtifactKind, Table};
use design::report::power::Question;
use design::{Factor, Fault, Layout, Method, Order, build, check, report};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Parameters of the task: all that decides the table.
#[derive(Serialize, Deserialize)]
struct Params {
    design: Method,
    factors: Vec<Factor>,
    #[serde(default, skip_serializing_if = "is_default")]
    layout: Layout,
    #[serde(default, skip_serializing_if = "is_default")]
    power: Question,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Stage for Design {
    fn inputs(&self) -> Vec<Port> {
        Vec::new()
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::DESIGN
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = self.option_complaints();
        found.extend(self.factor_complaints(context));
        if !found.is_empty() {
            return found;
        }
        match self.method() {
            // rows of a file are checked when it is read
            Ok(Method::Given(_)) if self.file.is_some() => found,
            Ok(method) => {
                let faults = check(&method, &self.factors(context), self.layout());
                faults.iter().map(complaint).collect()
            }
            Err(complaint) => vec![complaint],
        }
    }

    fn sketch(&self) -> Sketch {
        Sketch { factors: Some(self.factors.clone()), ..Sketch::default() }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let design = self.method().map_err(|c| StageError { message: c.message, hint: c.hint })?;
        let layout = self.layout();
        let draws = design.draws() || layout.order == Order::Random;
        let factors = self.factors(known.context);
        let params = Params { design, factors, layout, power: self.power };
        let mut task = Task::new("design", json!(params));
        if draws {
            task = task.seed(known.context.seed);
        }
        if let Some(file) = &self.file {
            task.files.push(known.library.file("rows", file)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Design {
    const NAME: &'static str = "design";
    const ABOUT: &'static str =
        "the runs of an experiment: factorial, orthogonal, screening, surface or sampled designs";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::DESIGN];
    const CLASS: Class = Class::Design;
    // 2: tables of 12, 20, 24, 40 and 48 runs more, among which the smallest is looked for
    const WORKS: &'static [Work] = &[Work { name: "design", version: 2, run }];
}

/// A fault of the design, at the key it concerns.
fn complaint(fault: &Fault) -> Complaint {
    let path = match fault {
        Fault::BadOption { option, .. } => option.split(',').next().unwrap_or(""),
        Fault::BadRow { .. } => "rows",
        Fault::NoConstruction { .. } => "method",
        Fault::NoFactors
        | Fault::NoName { .. }
        | Fault::DuplicateName { .. }
        | Fault::TooFewLevels { .. }
        | Fault::DuplicateLevel { .. }
        | Fault::NotFinite { .. }
        | Fault::EmptyRange { .. }
        | Fault::WrongLevels { .. }
        | Fault::UnevenLevels { .. } => "factors",
    };
    let text = fault.to_string();
    // what was found; what to do
    match text.rsplit_once("; ") {
        Some((found, remedy)) => Complaint::new(path, found).hint(remedy),
        None => Complaint::new(path, text),
    }
}

fn run(job: &Job) -> Result<Artifact, Failure> {
    let mut params: Params = job.params()?;
    if let (Method::Given(given), Some(_)) = (&mut params.design, job.files.first()) {
        given.rows = rows(&data::parse(&job.file("rows")?)?, &params.factors, given.by_level)?;
    }
    let table = build(&params.design, &params.factors, params.layout, job.seed.unwrap_or(0))
        .map_err(|error| StageError::new(error.to_string()))?;
    let report = report(&table, params.power);
    Ok(tables::artifact(&table, &report))
}

/// The columns of a file that are the factors, converted to the factors' units unless they are numbers of levels.
fn rows(table: &Table, factors: &[Factor], by_level: bool) -> Result<Vec<Vec<f64>>, StageError> {
    let columns = factors.iter().map(|factor| {
        let column = table.find(&factor.name)?;
        Ok(column.numbers(if by_level { &column.unit } else { &factor.unit })?)
    });
    let columns: Vec<Vec<f64>> = columns.collect::<Result<_, StageError>>()?;
    Ok((0..table.rows()).map(|i| columns.iter().map(|c| c[i]).collect()).collect())
}
