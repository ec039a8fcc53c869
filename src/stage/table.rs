//! `kind = "table"`: a table of other stages' results for people: CSV, LaTeX (booktabs) and Markdown.
//!
//! `table` names the table inside the artifact (its first one when not given), `columns` which of its columns are
//! printed and in which order, `where` which rows. Several stages are stacked, with a column `stage` in front. With
//! `compare` the numbers of another stage stand beside ours, row by row with equal values in the columns `by`, and the
//! deviation in per cent after them. Columns that are factors or responses get their symbols.
//!
//! The CSV has all digits; `digits` and `decimals` are for the two that people read.

use super::figure::{Names, stored};
use super::{Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::{self, Artifact, Group, Node};
use crate::figure::column::{Column, Digits, Values};
use crate::figure::table::Table as Printed;
use crate::figure::text;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Settings of a `table` stage.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The stages whose tables are printed.
    pub of: Names,
    /// Which table of the artifact; its first one when not given.
    pub table: Option<String>,
    /// Columns in the order of print; all when not given.
    #[serde(default)]
    pub columns: Vec<String>,
    /// Rows in which these columns have these values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, String>,
    /// A stage whose numbers stand beside ours.
    pub compare: Option<String>,
    /// Columns by which rows of the two are matched.
    #[serde(default)]
    pub by: Vec<String>,
    /// Words above the table.
    #[serde(default)]
    pub caption: String,
    /// Label for references in LaTeX.
    #[serde(default)]
    pub label: String,
    /// Remarks below the table.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Significant digits of numbers; 4 when not given.
    pub digits: Option<usize>,
    /// Decimals of single columns, instead of significant digits.
    #[serde(default)]
    pub decimals: BTreeMap<String, usize>,
    /// Symbols of single columns in LaTeX notation.
    #[serde(default)]
    pub symbols: BTreeMap<String, String>,
}

/// Everything that decides a printed table besides the data.
#[derive(Debug, Serialize, Deserialize)]
struct Params {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    table: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    columns: Vec<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    only: BTreeMap<String, String>,
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
    /// Symbols of the columns that are printed.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    symbols: BTreeMap<String, String>,
    /// Names of the stages when several are stacked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    stages: Vec<String>,
}

impl Stage for Table {
    fn inputs(&self) -> Vec<Port> {
        let mut ports = vec![Port { key: "of", stages: self.of.list(), accepts: ANY }];
        ports.extend(self.compare.iter().map(|c| Port { key: "compare", stages: vec![c.clone()], accepts: ANY }));
        ports
    }

    fn gives(&self) -> &'static str {
        "table"
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        if self.of.list().is_empty() {
            found.push(Complaint::new("of", "no stage is named"));
        }
        if self.compare.is_some() && self.by.is_empty() {
            let hint = "name the columns that tell a row, such as by = [\"source\"]";
            found.push(Complaint::new("compare", "`by` is needed to match the rows of the two tables").hint(hint));
        }
        if self.compare.is_none() && !self.by.is_empty() {
            found.push(Complaint::new("by", "`by` has no effect without `compare`").hint("leave out `by`"));
        }
        if self.digits.is_some_and(|d| d == 0 || d > 17) {
            found.push(Complaint::new("digits", "a number has 1 to 17 significant digits"));
        }
        for (column, symbol) in &self.symbols {
            if let Err(fault) = text::check(&format!("${symbol}$")) {
                found.push(Complaint::new(&format!("symbols.{column}"), fault.to_string()));
            }
        }
        found
    }

    fn settings(&self) -> Value {
        json!({
            "of": self.of.list(), "table": self.table, "columns": self.columns, "where": self.only,
            "compare": self.compare, "by": self.by, "caption": self.caption, "label": self.label, "notes": self.notes,
            "digits": self.digits, "decimals": self.decimals, "symbols": self.symbols,
        })
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let artifact = known.load(known.one("of")?)?;
        let table = find(&artifact, self.table.as_deref())?;
        let all = table.columns.iter().map(|c| c.name.clone());
        let columns: Vec<String> = if self.columns.is_empty() { all.collect() } else { self.columns.clone() };
        let stages = self.of.list();
        let params = Params {
            table: self.table.clone(),
            columns: self.columns.clone(),
            only: self.only.clone(),
            by: self.by.clone(),
            caption: self.caption.clone(),
            label: self.label.clone(),
            notes: self.notes.clone(),
            digits: self.digits.unwrap_or(4),
            decimals: self.decimals.clone(),
            symbols: columns.iter().filter_map(|c| Some((c.clone(), self.symbol(c, known.context)?))).collect(),
            stages: if stages.len() > 1 { stages } else { Vec::new() },
        };
        let mut task = Task::new(Self::WORKS[0].name, json!(params));
        for port in ["of", "compare"] {
            for input in known.port(port) {
                task = task.input(port, input.content);
            }
        }
        Ok(Step::Finish(task))
    }
}

/// Everything that holds a table.
const ANY: &[&str] = &[
    "results",
    "design",
    "run",
    "specimen",
    "range",
    "anova",
    "screening",
    "regression",
    "surfaces",
    "solution",
    "verification",
    "agreement",
    "picture",
    "table",
];

impl Table {
    fn symbol(&self, column: &str, context: &Context) -> Option<String> {
        let factor = || context.factors.get(column).map(|f| f.symbol.clone());
        let response = || context.responses.get(column).map(|r| r.symbol.clone());
        self.symbols.get(column).cloned().or_else(factor).or_else(response).filter(|s| !s.is_empty())
    }
}

impl Kind for Table {
    const NAME: &'static str = "table";
    const ABOUT: &'static str = "a table of other stages' results for people";
    const WORKS: &'static [Work] = &[Work { name: "table", version: 1, run: print }];
}

/// The table of that name, or the first.
fn find<'a>(artifact: &'a Artifact, name: Option<&str>) -> Result<&'a artifact::Table, StageError> {
    let tables = artifact.tables();
    let found = match name {
        Some(name) => tables.iter().find(|(n, _)| n == name),
        None => tables.first(),
    };
    found.map(|(_, table)| *table).ok_or_else(|| {
        let there: Vec<&str> = tables.iter().map(|(n, _)| n.as_str()).collect();
        StageError::new(format!("the artifact `{}` holds no table `{}`", artifact.kind, name.unwrap_or("…")))
            .hint(format!("it holds {}", if there.is_empty() { "no table".into() } else { there.join(", ") }))
    })
}

fn print(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let inputs = job.inputs.iter().filter(|(name, _)| name == "of");
    let mut columns: Vec<Column> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for (k, (_, artifact)) in inputs.enumerate() {
        let part = chosen(find(artifact, params.table.as_deref())?, &params)?;
        let rows = part.first().map_or(0, Column::len);
        names.extend(params.stages.get(k).map(|stage| vec![stage.clone(); rows]).unwrap_or_default());
        if k == 0 {
            columns = part;
        } else {
            stack(&mut columns, part)?;
        }
    }
    if let Some((_, other)) = job.inputs.iter().find(|(name, _)| name == "compare") {
        let other = find(other, params.table.as_deref()).or_else(|_| find(other, None))?;
        columns = beside(columns, other, &params.by)?;
    }
    if !params.stages.is_empty() {
        columns.insert(0, Column::words("stage", names));
    }
    let printed = Printed { caption: params.caption, label: params.label, columns, notes: params.notes };
    let root = Group::new()
        .with("csv", Node::Text(printed.csv()))
        .with("latex", Node::Text(printed.latex()))
        .with("markdown", Node::Text(printed.markdown()))
        .with("table", Node::Table(stored(printed.columns)));
    Ok(Artifact::new("table", 1, root))
}

/// The chosen columns of the chosen rows.
fn chosen(table: &artifact::Table, params: &Params) -> Result<Vec<Column>, StageError> {
    let mut rows: Vec<usize> = (0..table.rows()).collect();
    for (name, wanted) in &params.only {
        let column = column_of(table, name)?;
        let number = wanted.parse::<f64>().ok();
        rows.retain(|&i| match &column.values {
            artifact::Values::Texts(v) => v[i] == *wanted,
            artifact::Values::Ints(v) => number == Some(v[i] as f64),
            artifact::Values::Reals(v) => number == Some(v[i]),
        });
    }
    let all: Vec<String> = table.columns.iter().map(|c| c.name.clone()).collect();
    let names = if params.columns.is_empty() { &all } else { &params.columns };
    names.iter().map(|name| Ok(shown(column_of(table, name)?, &rows, params))).collect()
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
        digits: if is_exact(column) && !params.decimals.contains_key(&column.name) { Digits::Shortest } else { digits },
    }
}

/// Levels and counts: numbers that are short as they are need no rounding.
fn is_exact(column: &artifact::Column) -> bool {
    match &column.values {
        artifact::Values::Reals(v) => v.iter().all(|x| !x.is_finite() || format!("{x}").len() <= 6),
        artifact::Values::Ints(_) | artifact::Values::Texts(_) => true,
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

/// After each column of numbers that the other table has too: its value, and the deviation of ours in per cent.
fn beside(columns: Vec<Column>, other: &artifact::Table, by: &[String]) -> Result<Vec<Column>, StageError> {
    let keys = by.iter().map(|name| {
        let ours = columns.iter().find(|c| c.key == *name);
        let ours =
            ours.ok_or_else(|| StageError::new(format!("`by` names `{name}`, which is not among the columns")))?;
        Ok((&ours.values, &column_of(other, name)?.values))
    });
    let keys = keys.collect::<Result<Vec<_>, StageError>>()?;
    let rows = columns.first().map_or(0, Column::len);
    let mut used = vec![false; other.rows()];
    let partner: Vec<Option<usize>> = (0..rows)
        .map(|i| {
            let hit = (0..other.rows()).find(|&j| !used[j] && keys.iter().all(|(a, b)| equal(a, i, b, j)))?;
            used[hit] = true;
            Some(hit)
        })
        .collect();
    let mut out = Vec::new();
    for column in columns {
        let printed = if by.contains(&column.key) { None } else { other.reals(&column.key) };
        let (Some(printed), Values::Reals(ours)) = (printed, &column.values) else {
            out.push(column);
            continue;
        };
        let theirs: Vec<f64> = partner.iter().map(|p| p.map_or(f64::NAN, |j| printed[j])).collect();
        let deviation = ours.iter().zip(&theirs).map(|(a, b)| 100.0 * (a / b - 1.0)).collect();
        let (key, digits, unit) = (column.key.clone(), column.digits, column.unit.clone());
        out.push(column);
        out.push(Column::reals(&format!("{key} published"), theirs).with_unit(&unit).with_digits(digits));
        out.push(Column::reals(&format!("{key} deviation"), deviation).with_unit("%").with_digits(Digits::Fixed(1)));
    }
    Ok(out)
}

/// Whether two cells tell the same row; numbers within a thousandth, because printed ones are rounded.
fn equal(ours: &Values, i: usize, theirs: &artifact::Values, j: usize) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a.abs().max(b.abs()).max(1e-12);
    let number = match theirs {
        artifact::Values::Reals(v) => Some(v[j]),
        artifact::Values::Ints(v) => Some(v[j] as f64),
        artifact::Values::Texts(_) => None,
    };
    match (ours, number, theirs) {
        (Values::Reals(a), Some(b), _) => near(a[i], b),
        (Values::Whole(a), Some(b), _) => near(a[i] as f64, b),
        (Values::Words(a), None, artifact::Values::Texts(b)) => a[i] == b[j],
        _ => false,
    }
}

#[cfg(test)]
mod tests;
