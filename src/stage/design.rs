//! `kind = "design"`: the runs of an experiment, and a report on what they can estimate.
//!
//! `method` picks the design; the other keys are its options, and an option of another method is refused. The factors
//! are those of the workflow, in the order of `factors`. Orthogonal, factorial designs take a factor's levels (its range if it
//! has none); two-level and sampled designs its range (the extreme levels if it has none); central composite and
//! Box–Behnken designs its range, or up to three levels. Rows come from the workflow (`rows`) or a CSV file beside it
//! (`file`) with `method = "given"`.
//!
//! `valid` holds rules that the rows must obey, checked with units before anything runs. A row that breaks a rule is a fault
//! of the design; with `invalid_rows = "leave-out"` the row is left out and listed in the table `left_out`.
//!
//! The result has the tables `design` (run, standard order, point type, factors in their units), `coded` and `report`.

mod beyond;
mod config;
mod tables;
#[cfg(test)]
mod tests;
mod valid;

pub use config::Design;

use super::beside::Beside;
use super::forecast::{Ahead, Forecast};
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Port, Sketch, Stage, StageError, Step, Task, Work, data,
};
use crate::artifact::{Artifact, ArtifactKind, Table};
use design::report::power::Question;
use design::{DesignTable, Factor, Fault, Layout, Method, Order, build, check, report};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use valid::{Broken, InvalidRows, Rule};

/// Parameters of the task: everything that decides the table.
#[derive(Serialize, Deserialize)]
struct Params {
    design: Method,
    factors: Vec<Factor>,
    #[serde(default, skip_serializing_if = "is_default")]
    layout: Layout,
    #[serde(default, skip_serializing_if = "is_default")]
    power: Question,
    /// Names of the levels of factors that are categories.
    #[serde(default, skip_serializing_if = "is_default")]
    names: BTreeMap<String, Vec<String>>,
    #[serde(default, skip_serializing_if = "is_default")]
    valid: Vec<String>,
    #[serde(default, skip_serializing_if = "is_default")]
    invalid_rows: InvalidRows,
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
            // rows of a file are checked when the file is read
            Ok(Method::Given(_)) if self.file.is_some() => self.rule_complaints(),
            Ok(method) => {
                let faults = check(&method, &self.factors(context), self.layout());
                if faults.is_empty() {
                    self.broken_rules(&method, context)
                } else {
                    faults.iter().map(complaint).collect()
                }
            }
            Err(complaint) => vec![complaint],
        }
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        found.optional("file", self.file.as_ref());
    }

    fn sketch(&self) -> Sketch {
        Sketch { factors: Some(self.factors.clone()), ..Sketch::default() }
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        let Some(table) = self.table_ahead(ahead) else { return Forecast::ONE };
        let replicates = table.replicate().into_iter().max().unwrap_or(1) as usize;
        Forecast { rows: Some(table.runs()), replicates, ..Forecast::ONE }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let design = self.method().map_err(|c| StageError { message: c.message, hint: c.hint })?;
        let layout = self.layout();
        let draws = design.draws() || layout.order == Order::Random;
        let factors = self.factors(known.context);
        let (valid, invalid_rows, names) = (self.valid.clone(), self.invalid_rows, self.names(known.context));
        let params = Params { design, factors, layout, power: self.power, names, valid, invalid_rows };
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

impl Design {
    /// The design with all its settings.
    fn table_ahead(&self, ahead: &Ahead) -> Option<DesignTable> {
        let mut method = self.method().ok()?;
        let factors = self.factors(ahead.context);
        if let (Method::Given(given), Some(file)) = (&mut method, &self.file) {
            given.rows = rows(&data::parse(&(ahead.file)(file)?).ok()?, &factors, given.by_level).ok()?;
        }
        let table = build(&method, &factors, self.layout(), ahead.context.seed).ok()?;
        let broken = valid::broken(&self.valid, &table).ok()?;
        Some(valid::without(&table, &broken))
    }

    /// Names of the levels of the factors that are categories.
    fn names(&self, context: &Context) -> BTreeMap<String, Vec<String>> {
        let names = |name: &String| Some((name.clone(), context.factors.get(name)?.names.clone()));
        self.factors.iter().filter_map(names).filter(|(_, names)| !names.is_empty()).collect()
    }
}

impl Kind for Design {
    const NAME: &'static str = "design";
    const ABOUT: &'static str =
        "the runs of an experiment: factorial, orthogonal, screening, surface or sampled designs";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::DESIGN];
    const CLASS: Class = Class::Design;
    // 3: the left sides of broken rules have units. 2: tables of 12, 20, 24, 40 and 48 runs more, among which the smallest is looked for
    const WORKS: &'static [Work] = &[Work { name: "design", version: 3, run }];
}

/// A fault of the design, at its key.
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
        | Fault::NoLogarithm { .. }
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
    let broken = valid::broken(&params.valid, &table).map_err(StageError::new)?;
    if !broken.is_empty() && params.invalid_rows == InvalidRows::Refuse {
        let rows: Vec<String> = broken.iter().map(|broken| valid::told(broken, &table)).collect();
        return Err(StageError::new(rows.join("; ")).hint(LEAVE_OUT).into());
    }
    if broken.is_empty() {
        let stored = tables::stored(&table, &report(&table, params.power), &params.names)?;
        // A hundred thousand rows are not in memory three times.
        drop(table);
        return Ok(stored.to_artifact());
    }
    let left = valid::without(&table, &broken);
    if left.runs() == 0 {
        return Err(StageError::new("every row of the design breaks a rule").into());
    }
    let report = report(&left, params.power);
    Ok(tables::shortened(&left, &report, &params.names, (&table, &broken))?)
}

/// What to do about rows that break a rule.
const LEAVE_OUT: &str = "change the factors, or say `invalid_rows = \"leave-out\"`";

/// Most rows that break a rule and are listed one by one.
const MOST_TOLD: usize = 10;

impl Design {
    /// Rules that cannot be read or name something that is not a factor of the design.
    fn rule_complaints(&self) -> Vec<Complaint> {
        let mut found = Vec::new();
        for text in &self.valid {
            match Rule::parse(text) {
                Err(why) => found.push(Complaint::new("valid", why)),
                Ok(rule) => {
                    for name in rule.names().into_iter().filter(|name| !self.factors.contains(name)) {
                        let message = format!("`{text}`: `{name}` is not a factor of the design");
                        found.push(
                            Complaint::new("valid", message)
                                .hint(format!("its factors are {}", self.factors.join(", "))),
                        );
                    }
                }
            }
        }
        if self.valid.is_empty() && self.invalid_rows != InvalidRows::Refuse {
            found.push(
                Complaint::new("invalid_rows", "`invalid_rows` has no effect without rules").hint("give `valid`"),
            );
        }
        found
    }

    /// Rows that break a rule, or axial points without a meaning, where that is a fault of the design.
    fn broken_rules(&self, method: &Method, context: &Context) -> Vec<Complaint> {
        let mut found = self.rule_complaints();
        if !found.is_empty() {
            return found;
        }
        // A design that cannot be built is reported when it runs.
        let axial = matches!(method, Method::CentralComposite(_));
        if !axial && self.valid.is_empty() {
            return found;
        }
        let Ok(table) = build(method, &self.factors(context), self.layout(), context.seed) else { return found };
        match valid::broken(&self.valid, &table) {
            Err(why) => found.push(Complaint::new("valid", why)),
            Ok(broken) if self.invalid_rows == InvalidRows::Refuse && !broken.is_empty() => {
                let told = |broken: &Broken| Complaint::new("valid", valid::told(broken, &table)).hint(LEAVE_OUT);
                found.extend(broken.iter().take(MOST_TOLD).map(told));
                if broken.len() > MOST_TOLD {
                    let message = format!("{} more rows of {} break a rule", broken.len() - MOST_TOLD, table.runs());
                    found.push(Complaint::new("valid", message));
                }
            }
            Ok(broken) if valid::without(&table, &broken).runs() == 0 => {
                found.push(Complaint::new("valid", "every row of the design breaks a rule"));
            }
            Ok(broken) => return beyond::zero(&valid::without(&table, &broken), context),
        }
        found
    }
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
