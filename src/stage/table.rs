//! `kind = "table"`: a table of other stages' results for people: CSV, LaTeX (booktabs) and Markdown.
//!
//! `table` names the table inside the artifact (by default its main one), `columns` its columns in the order of print, and
//! `where` selects rows. Several stages are stacked, with a column `stage` in front. With `compare` the numbers of another
//! stage follow ours in each row, matched by equal values in the columns `by`, and then the deviation in per cent; with
//! `published` those of a CSV file do. Columns that are factors or responses get their symbols. `pivot` spreads one column
//! over two others.
//!
//! `list` prints declarations of the workflow instead of a table of a result: `factors` (the values that each sets, range and
//! levels), `materials` (microparameters of the named materials, in the units of the factors), `aggregate` (polygons of a
//! specimen by size classes), `ranges` (of the named factors, and of the responses that surfaces were fitted to).
//!
//! The CSV has all digits; `digits` and `decimals` are for LaTeX and Markdown.

mod beside;
mod list;
mod pivot;
mod units;
mod validity;

use super::beside::Beside;
use super::figure::{Names, stored};
use super::invalid::{Invalid, note};
use super::reads::Reads;
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, NAMING_COLUMNS, Port, Stage, StageError, Step, Task, Work,
};
use crate::artifact::presentation::Printed as Stored;
use crate::artifact::{self, Accepts, Artifact, ArtifactKind};
use crate::unit::Length;
use beside::beside;
use figure::column::{Column, Digits, Values};
use figure::table::{Symbols, Table as Printed};
use list::Given;
pub use list::List;
pub use pivot::Pivot;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;

/// Settings of a `table` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The stages whose tables are printed.
    #[serde(default)]
    pub of: Names,
    /// A list of declarations of the workflow, instead of a table of a result.
    pub list: Option<List>,
    /// The factors of a list; all by default.
    #[serde(default)]
    pub factors: Vec<String>,
    /// The materials of a list.
    #[serde(default)]
    pub materials: Vec<String>,
    /// Bounds of the size classes of a list of aggregate.
    #[serde(default)]
    pub classes: Vec<Length>,
    /// The table of the artifact; by default its main one.
    pub table: Option<String>,
    /// Columns in the order of print; all by default.
    #[serde(default)]
    pub columns: Vec<String>,
    /// Prints only rows in which these columns have these values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, String>,
    /// One column spread over two others, instead of `columns`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pivot: Option<Pivot>,
    /// A stage whose numbers are printed beside ours.
    pub compare: Option<String>,
    /// A CSV file, beside the workflow, whose numbers are printed beside ours.
    pub published: Option<String>,
    /// Columns by which rows of the two tables are matched.
    #[serde(default)]
    pub by: Vec<String>,
    /// Caption above the table.
    #[serde(default)]
    pub caption: String,
    /// Label for references in LaTeX.
    #[serde(default)]
    pub label: String,
    /// Note below the table.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Significant digits of numbers; 4 by default.
    pub digits: Option<usize>,
    /// Decimals of single columns, instead of significant digits.
    #[serde(default)]
    pub decimals: BTreeMap<String, usize>,
    /// Symbols of single columns in LaTeX notation.
    #[serde(default)]
    pub symbols: BTreeMap<String, String>,
    /// What to do with runs that are not valid; by default they are shown and marked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub invalid: Option<Invalid>,
}

/// Parameters of the task: everything that decides a printed table besides the data.
#[derive(Debug, Serialize, Deserialize)]
struct Params {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    table: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    columns: Vec<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    only: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pivot: Option<Pivot>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    by: Vec<String>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    caption: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    label: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    digits: usize,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    decimals: BTreeMap<String, usize>,
    /// Symbols of the columns.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    symbols: BTreeMap<String, String>,
    /// Symbols of the names in cells, and in the notes on runs.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    signs: BTreeMap<String, String>,
    /// The rows of a list.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    given: Option<Given>,
    /// Names of the stages when several are stacked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    stages: Vec<String>,
    /// Units of responses, for tables that list quantities row by row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    units: Option<BTreeMap<String, String>>,
    /// The columns whose unit the workflow declares.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    declared: Vec<String>,
    #[serde(default = "keep", skip_serializing_if = "is_kept")]
    invalid: Invalid,
}

fn keep() -> Invalid {
    Invalid::Keep
}

fn is_kept(invalid: &Invalid) -> bool {
    *invalid == Invalid::Keep
}

impl Stage for Table {
    fn inputs(&self) -> Vec<Port> {
        let mut ports = vec![Port { key: "of", stages: self.of.list(), accepts: Accepts::Tables }];
        ports.extend(self.compare.iter().map(|c| Port {
            key: "compare",
            stages: vec![c.clone()],
            accepts: Accepts::Tables,
        }));
        ports
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::TABLE
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        found.extend(self.list_faults(context));
        if self.compare.is_some() && self.published.is_some() {
            found.push(Complaint::new(
                "published",
                "`compare` and `published` both name what stands beside our numbers",
            ));
        }
        let beside = if self.published.is_some() { "published" } else { "compare" };
        if (self.compare.is_some() || self.published.is_some()) && self.by.is_empty() {
            let hint = "name the columns that tell a row, such as by = [\"source\"]";
            found.push(Complaint::new(beside, "`by` is needed to match the rows of the two tables").hint(hint));
        }
        if self.compare.is_none() && self.published.is_none() && !self.by.is_empty() {
            let message = "`by` has no effect without `compare` or `published`";
            found.push(Complaint::new("by", message).hint("leave out `by`"));
        }
        if self.pivot.is_some() && !self.columns.is_empty() {
            let complaint = Complaint::new("columns", "`columns` has no effect with `pivot`");
            found.push(complaint.hint("leave out `columns`: `pivot` says what is printed"));
        }
        if self.digits.is_some_and(|d| d == 0 || d > 17) {
            found.push(Complaint::new("digits", "a number has 1 to 17 significant digits"));
        }
        for (column, decimals) in self.decimals.iter().filter(|(_, decimals)| **decimals > 17) {
            let message = format!("{decimals} decimals are asked for; a number has at most 17");
            found.push(Complaint::new(&format!("decimals.{column}"), message));
        }
        if figure::escape::latex_label(&self.label) != self.label {
            let message = format!("`{}` cannot be a label", self.label);
            found.push(Complaint::new("label", message).hint("letters, digits and `: . _ -` only"));
        }
        for (column, symbol) in &self.symbols {
            if let Some(fault) = super::symbol_fault(symbol) {
                found.push(Complaint::new(&format!("symbols.{column}"), fault));
            }
        }
        found
    }

    fn reads(&self) -> Vec<Reads> {
        if self.table.as_deref().is_some_and(|name| Some(name) != ArtifactKind::RESULTS.main_table()) {
            return Vec::new();
        }
        let read = |path: &str, columns: Vec<&String>| Reads {
            path: path.to_owned(),
            stages: self.of.list(),
            columns: columns.into_iter().cloned().collect(),
        };
        vec![
            read("columns", self.columns.iter().collect()),
            read("where", self.only.keys().collect()),
            read("by", self.by.iter().collect()),
            read("pivot", self.pivot.iter().flat_map(Pivot::names).collect()),
        ]
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        found.optional("published", self.published.as_ref());
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let given = self.given(known)?;
        let columns = match &given {
            _ if !self.columns.is_empty() => self.columns.clone(),
            None if self.pivot.is_some() => self.pivot.iter().flat_map(Pivot::names).cloned().collect(),
            Some(given) => given.names(),
            None => {
                let artifact = known.load(known.one("of")?)?;
                let table = find(&artifact, self.table.as_deref())?;
                table.columns.iter().map(|c| c.name.clone()).collect()
            }
        };
        let stages = self.of.list();
        let names = columns.iter().any(|column| NAMING_COLUMNS.contains(&column.as_str()));
        let rowwise = units::ROWWISE.iter().all(|name| columns.iter().any(|column| column == name));
        let units = || known.context.responses.iter().map(|(name, r)| (name.clone(), r.unit.clone())).collect();
        let is_declared = |column: &&String| {
            known.context.responses.contains_key(*column) || known.context.factors.contains_key(*column)
        };
        let params = Params {
            table: self.table.clone(),
            columns: self.columns.clone(),
            only: self.only.clone(),
            pivot: self.pivot.clone(),
            by: self.by.clone(),
            caption: self.caption.clone(),
            label: self.label.clone(),
            notes: self.notes.clone(),
            digits: self.digits.unwrap_or(4),
            decimals: self.decimals.clone(),
            symbols: columns.iter().filter_map(|c| Some((c.clone(), self.symbol(c, known.context)?))).collect(),
            signs: self.signs(known.context, names),
            stages: if stages.len() > 1 && given.is_none() { stages } else { Vec::new() },
            given,
            units: rowwise.then(units),
            declared: columns.iter().filter(|column| is_declared(column)).cloned().collect(),
            invalid: self.invalid.unwrap_or(Invalid::Keep),
        };
        let mut task = Task::new(Self::WORKS[0].name, json!(params));
        // The list itself is in the parameters, so a change elsewhere in the workflow does not print it anew.
        let ports: &[&str] = if self.list.is_some() { &["compare"] } else { &["of", "compare"] };
        for port in ports {
            for input in known.port(port) {
                task = task.input(*port, input.content);
            }
        }
        if let Some(path) = &self.published {
            task.files.push(known.library.file("published", path)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Table {
    fn symbol(&self, column: &str, context: &Context) -> Option<String> {
        let factor = || context.factors.get(column).map(|f| f.symbol.clone());
        let response = || context.responses.get(column).map(|r| r.symbol.clone());
        self.symbols.get(column).cloned().or_else(factor).or_else(response).filter(|s| !s.is_empty())
    }

    /// The symbols of this table before those of the workflow: of all names where cells hold names, else of the responses,
    /// which notes on runs name.
    fn signs(&self, context: &Context, in_cells: bool) -> BTreeMap<String, String> {
        let mut signs = context.symbols();
        signs.retain(|name, _| in_cells || self.list.is_none() && context.responses.contains_key(name));
        signs.extend(self.symbols.iter().map(|(name, symbol)| (name.clone(), symbol.clone())));
        signs.retain(|_, symbol| !symbol.is_empty());
        signs
    }
}

impl Kind for Table {
    const NAME: &'static str = "table";
    const ABOUT: &'static str = "a table of other stages' results for people";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::TABLE];
    const CLASS: Class = Class::Presentation;
    /// 9: rows without a cell of a pivot table are counted. 8: names in cells and notes are printed by their symbols; quantities that the workflow does not declare are in the units of the field. 7: the notes of a published table stand in the last column. 6: names in what is stated below the table keep their letters. 5: runs that are not valid are marked, which is stated below the table. 4: text stays text in LaTeX and Markdown; why a single run gave no result. 3: the main table of a result when none is named, and not the first by its name; one arithmetic of conversion: last digits of values told row by row. 2: lengths told row by row in millimetres, whole numbers among them without decimals.
    const WORKS: &'static [Work] = &[Work { name: "table", version: 9, run: print }];
}

/// The table of this name, or the artifact's main one.
fn find<'a>(artifact: &'a Artifact, name: Option<&str>) -> Result<&'a artifact::Table, StageError> {
    let tables = artifact.tables();
    let wanted = name.or_else(|| super::artifact_kind(artifact)?.main_table());
    let found = tables.iter().find(|(n, _)| Some(n.as_str()) == wanted);
    found.map(|(_, table)| *table).ok_or_else(|| {
        let there: Vec<&str> = tables.iter().map(|(n, _)| n.as_str()).collect();
        StageError::new(format!("the artifact `{}` holds no table `{}`", artifact.kind, wanted.unwrap_or("…")))
            .hint(format!("it holds {}", if there.is_empty() { "no table".into() } else { there.join(", ") }))
    })
}

fn print(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let inputs = job.inputs.iter().filter(|(name, _)| name == "of");
    let mut columns: Vec<Column> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    let mut notes = params.notes.clone();
    for (k, (_, artifact)) in inputs.enumerate() {
        let (part, said) = validity::printed(artifact, &params)?;
        for said in said {
            notes.push(note(params.stages.get(k).map_or("", String::as_str), &said, &params.signs));
        }
        let rows = part.first().map_or(0, Column::len);
        names.extend(params.stages.get(k).map(|stage| vec![stage.clone(); rows]).unwrap_or_default());
        if columns.is_empty() {
            columns = part;
        } else if !part.is_empty() {
            stack(&mut columns, part)?;
        }
    }
    if let Some(given) = &params.given {
        columns = chosen(&given.table(), &params, &|_| true)?;
    }
    if params.pivot.is_none() && params.given.is_none() {
        units::of_the_field(&mut columns, &params.declared);
    }
    if job.files.iter().any(|file| file.name == "published") {
        let other = super::data::parse(&job.file("published")?)?;
        columns = beside(columns, &other, &params.by)?;
    } else if let Some((_, other)) = job.inputs.iter().find(|(name, _)| name == "compare") {
        let other = find(other, params.table.as_deref()).or_else(|_| find(other, None))?;
        columns = beside(columns, other, &params.by)?;
    }
    if let Some(units) = &params.units {
        units::readable(&mut columns, units);
    }
    if !params.stages.is_empty() {
        columns.insert(0, Column::words("stage", names));
    }
    let symbols = Symbols { of: params.signs, columns: &NAMING_COLUMNS };
    let printed = Printed { caption: params.caption, label: params.label, columns, notes, symbols };
    let stored = Stored {
        csv: printed.csv(),
        latex: printed.latex(),
        markdown: printed.markdown(),
        table: stored(printed.columns),
    };
    Ok(stored.to_artifact())
}

/// The columns of the settings, in the rows of the settings among the allowed ones.
fn chosen(
    table: &artifact::Table,
    params: &Params,
    allowed: &dyn Fn(usize) -> bool,
) -> Result<Vec<Column>, StageError> {
    if let Some(pivot) = &params.pivot {
        return pivot::spread(table, params, pivot, allowed);
    }
    let rows = chosen_rows(table, params, allowed)?;
    if params.columns.is_empty() {
        return Ok(table.columns.iter().map(|column| shown(column, &rows, params)).collect());
    }
    named(table, &params.columns, params, &rows)
}

/// The rows of the settings among the allowed ones.
fn chosen_rows(
    table: &artifact::Table,
    params: &Params,
    allowed: &dyn Fn(usize) -> bool,
) -> Result<Vec<usize>, StageError> {
    let mut rows: Vec<usize> = (0..table.rows()).filter(|&row| allowed(row)).collect();
    for (name, wanted) in &params.only {
        let column = column_of(table, name)?;
        let number = wanted.parse::<f64>().ok();
        rows.retain(|&i| match &column.values {
            artifact::Values::Texts(v) => v[i] == *wanted,
            artifact::Values::Ints(v) => number == Some(v[i] as f64),
            artifact::Values::Reals(v) => number == Some(v[i]),
        });
    }
    Ok(rows)
}

/// These columns of these rows.
fn named(
    table: &artifact::Table,
    names: &[String],
    params: &Params,
    rows: &[usize],
) -> Result<Vec<Column>, StageError> {
    names.iter().map(|name| Ok(shown(column_of(table, name)?, rows, params))).collect()
}

fn column_of<'a>(table: &'a artifact::Table, name: &str) -> Result<&'a artifact::Column, StageError> {
    table.column(name).ok_or_else(|| {
        let there: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        StageError::new(format!("the table has no column `{name}`")).hint(format!("it has {}", there.join(", ")))
    })
}

fn shown(column: &artifact::Column, rows: &[usize], params: &Params) -> Column {
    let values = match &column.values {
        artifact::Values::Texts(v) => Values::Words(rows.iter().map(|&i| v[i].clone()).collect()),
        artifact::Values::Ints(v) => Values::Whole(rows.iter().map(|&i| v[i]).collect()),
        artifact::Values::Reals(v) => Values::Reals(rows.iter().map(|&i| v[i]).collect()),
    };
    let digits = params.decimals.get(&column.name).map_or(Digits::Significant(params.digits), |&d| Digits::Fixed(d));
    Column {
        key: column.name.clone(),
        symbol: params.symbols.get(&column.name).cloned().unwrap_or_default(),
        unit: column.unit.clone(),
        values,
        digits: if column.values.are_short() && !params.decimals.contains_key(&column.name) {
            Digits::Shortest
        } else {
            digits
        },
    }
}

/// Adds the rows of another part with the same columns.
fn stack(columns: &mut [Column], part: Vec<Column>) -> Result<(), StageError> {
    for (column, more) in columns.iter_mut().zip(part) {
        let differ = || {
            let message = format!("column `{}` differs in type or unit between the stages", column.key);
            StageError::new(message).hint("print them as two tables")
        };
        if column.key != more.key || column.unit != more.unit {
            return Err(differ());
        }
        match (&mut column.values, more.values) {
            (Values::Reals(a), Values::Reals(b)) => a.extend(b),
            (Values::Whole(a), Values::Whole(b)) => a.extend(b),
            (Values::Words(a), Values::Words(b)) => a.extend(b),
            _ => return Err(differ()),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
