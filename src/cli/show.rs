//! `flow show`: a result, or one row's run, as a readable table.

use super::common::{Campaign, decided, provenance, system};
use super::sheet::text;
use super::{Exit, complete};
use crate::artifact::validity::sentences;
use crate::artifact::{Artifact, Column, Node, Table, Values};
use crate::export::csv_text;
use crate::plan::Workflow;
use crate::run::{Report, StageReport, StageStatus};
use crate::stage::artifact_kind;
use crate::stage::units::presented;
use crate::store::{ObjectId, Store};
use clap::Args;
use serde_json::{Value, json};

/// Show a result as a table.
#[derive(Args)]
pub(super) struct Show {
    #[command(flatten)]
    campaign: Campaign,
    /// The stage, or one run of it: `orthogonal` or `orthogonal[12]` (rows are counted from 1); by default all stages
    /// and the names of their tables.
    #[arg(value_name = "STAGE[ROW]", add = complete::stages())]
    what: Option<String>,
    /// One table of it; by default all.
    #[arg(long, value_name = "NAME", requires = "what")]
    table: Option<String>,
    /// As CSV, with units in the first line: the main table, or the one of `--table`.
    #[arg(long, conflicts_with_all = ["json", "path"], requires = "what")]
    csv: bool,
    /// As JSON: all values, or the one table.
    #[arg(long, conflicts_with = "path")]
    json: bool,
    /// Only the path of its HDF5 file.
    #[arg(long, requires = "what")]
    path: bool,
}

impl Show {
    pub(super) fn go(self) -> Exit {
        match &self.what {
            Some(what) => self.print(what),
            None => self.list(),
        }
        .unwrap_or_else(|exit| exit)
    }

    /// Every stage with its tables.
    fn list(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load(&[])?;
        let store = self.campaign.common.read()?;
        let report = decided(&workflow, &store, &[], true)?;
        let tables_of = |status: &StageStatus| match status {
            StageStatus::Done(content) => {
                let artifact = store.get(content).map_err(|e| system(&e))?;
                Ok(artifact.tables().into_iter().map(|(name, _)| name).collect())
            }
            StageStatus::Open | StageStatus::Failed(_) | StageStatus::Skipped(_) => Ok(Vec::new()),
        };
        let tables: Vec<Vec<String>> =
            report.stages.iter().map(|stage| tables_of(&stage.status)).collect::<Result<_, Exit>>()?;
        let stages = report.stages.iter().zip(&tables);
        if self.json {
            let one = |(stage, tables): (&StageReport, &Vec<String>)| {
                let state = stage.status.word();
                json!({ "name": stage.name, "kind": stage.kind, "state": state, "tables": tables })
            };
            out!("{}", stages.map(one).collect::<Value>());
            return Ok(Exit::Done);
        }
        let width = report.stages.iter().map(|stage| stage.name.chars().count()).max().unwrap_or(0);
        for (stage, tables) in stages {
            let what = match &stage.status {
                StageStatus::Done(_) if tables.is_empty() => "no table".to_owned(),
                StageStatus::Done(_) => tables.join(", "),
                status => format!("no result yet ({})", status.word()),
            };
            let title = workflow.position(&stage.name).and_then(|index| workflow.stages[index].title.as_deref());
            let title = title.map_or_else(String::new, |title| format!("  ({title})"));
            out!("{:width$}  {:16}  {what}{title}", stage.name, stage.kind);
        }
        Ok(Exit::Done)
    }

    fn print(&self, what: &str) -> Result<Exit, Exit> {
        let (stage, row) = parts(what)?;
        let workflow = self.campaign.load(std::slice::from_ref(&stage))?;
        let store = self.campaign.common.read()?;
        // Single rows are known only when every task is looked up.
        let report = decided(&workflow, &store, std::slice::from_ref(&stage), false)?;
        let Some(object) = object(&workflow, &report, &stage, row) else {
            err!("error: {}", self.missing(what, &workflow, &report, (&stage, row)));
            return Err(Exit::BadInput);
        };
        if self.path {
            out!("{}", store.path(&object).display());
            return Ok(Exit::Done);
        }
        self.values(what, &store, &object, &workflow)
    }

    /// Why the result cannot be shown.
    fn missing(&self, what: &str, workflow: &Workflow, report: &Report, (stage, row): (&str, Option<usize>)) -> String {
        let index = workflow.position(stage);
        let status = |name: &str| report.stages.iter().find(|stage| stage.name == name).map(|stage| &stage.status);
        let why = match status(stage) {
            Some(StageStatus::Skipped(cause)) => status(cause),
            status => status,
        };
        if let Some(StageStatus::Failed(why)) = why {
            return format!("`{what}` has no result: {why}");
        }
        let rows: Vec<Option<usize>> =
            report.tasks().filter(|task| Some(task.stage) == index).map(|task| task.row).collect();
        match (row, rows.iter().flatten().max()) {
            (Some(_), None) if !rows.is_empty() => {
                let whole = self.campaign.command("show", &[stage]);
                format!("`{stage}` is one result and has no rows; see {whole}")
            }
            (Some(row), Some(last)) if row > *last => format!("`{stage}` has {} rows, no row {}", last + 1, row + 1),
            _ => {
                let first = self.campaign.command("run", &[stage]);
                format!("`{what}` has no result yet; run it first: {first}")
            }
        }
    }

    fn values(&self, what: &str, store: &Store, object: &ObjectId, workflow: &Workflow) -> Result<Exit, Exit> {
        let stored = store.get(&object.content).map_err(|e| system(&e))?;
        let artifact = presented(&stored, &workflow.context);
        let tables = self.chosen(what, &artifact)?;
        // Beside its numbers, in whatever form they are shown.
        for said in sentences(&artifact) {
            err!("warning: {what}: {said}");
        }
        if self.json {
            let value = match &self.table {
                Some(_) => tables.first().map_or(Value::Null, |(_, table)| table_json(table)),
                None => group_json(&artifact),
            };
            out!("{value}");
        } else if self.csv {
            tables.iter().for_each(|(_, table)| super::output::write(&csv_text(table)));
        } else {
            for (name, table) in tables {
                out!("{name}\n{}\n", text(table));
            }
            print_others(&artifact, self.table.is_some());
            if let Some(record) = store.find(&object.key).map_err(|e| system(&e))? {
                let made = provenance(record.started, record.seconds, &record.origin);
                self.campaign.common.note(&format!("computed {made}"));
            }
        }
        Ok(Exit::Done)
    }

    /// The tables to show, in order.
    fn chosen<'a>(&self, what: &str, artifact: &'a Artifact) -> Result<Vec<(String, &'a Table)>, Exit> {
        let mut tables = artifact.tables();
        let known = tables.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().join(", ");
        if let Some(wanted) = &self.table {
            tables.retain(|(name, _)| name == wanted);
            if tables.is_empty() {
                err!("error: `{what}` has no table `{wanted}`; it has {known}");
                return Err(Exit::BadInput);
            }
        }
        if self.csv && tables.len() > 1 {
            let main = artifact_kind(artifact).and_then(|kind| kind.main_table());
            if !tables.iter().any(|(name, _)| Some(name.as_str()) == main) {
                err!("error: `{what}` has several tables; choose one with --table: {known}");
                return Err(Exit::BadInput);
            }
            tables.retain(|(name, _)| Some(name.as_str()) == main);
            self.campaign
                .common
                .note(&format!("this is the table `{}`; --table shows another of {known}", tables[0].0));
        }
        Ok(tables)
    }
}

/// Stage and row (from 0) of `stage[row]`.
pub(super) fn parts(what: &str) -> Result<(String, Option<usize>), Exit> {
    let Some((stage, row)) = what.strip_suffix(']').and_then(|what| what.split_once('[')) else {
        return Ok((what.to_owned(), None));
    };
    match row.trim().parse::<usize>() {
        Ok(row) if row > 0 => Ok((stage.to_owned(), Some(row - 1))),
        Ok(_) | Err(_) => {
            err!("error: `{row}` is not a row; rows are counted from 1, as in orthogonal[12]");
            Err(Exit::BadInput)
        }
    }
}

/// The object of a stage's result (that of the last task with its content), or of one of its rows.
pub(super) fn object(workflow: &Workflow, report: &Report, stage: &str, row: Option<usize>) -> Option<ObjectId> {
    if row.is_some() {
        let index = workflow.position(stage);
        return report.tasks().find(|task| Some(task.stage) == index && task.row == row)?.object;
    }
    let status = report.stages.iter().find(|s| s.name == stage).map(|s| &s.status)?;
    let StageStatus::Done(content) = status else { return None };
    report.objects().rev().find(|object| object.content == *content)
}

/// Single values, texts, and the shapes of arrays.
fn print_others(artifact: &Artifact, only_table: bool) {
    if only_table {
        return;
    }
    for (name, node) in artifact.root.iter() {
        match node {
            Node::Text(text) if !text.is_empty() => out!("{name}: {text}"),
            Node::Real { value, unit } => out!("{name}: {value} {unit}"),
            Node::Int(value) => out!("{name}: {value}"),
            Node::Flag(value) => out!("{name}: {}", if *value { "yes" } else { "no" }),
            Node::Array(_) if name == "warnings" && node.texts().is_some() => {
                node.texts().into_iter().flatten().for_each(|text| out!("warning: {text}"));
            }
            Node::Array(array) => {
                let shape: Vec<String> = array.shape.iter().map(usize::to_string).collect();
                out!("{name}: {} {} {}", shape.join(" × "), array.values.type_name(), array.unit);
            }
            Node::Bytes(bytes) => out!("{name}: {} bytes", bytes.len()),
            Node::Group(_) | Node::Table(_) | Node::Text(_) => {}
        }
    }
}

fn values_json(values: &Values) -> Value {
    match values {
        Values::Reals(values) => values.iter().map(|v| if v.is_finite() { json!(v) } else { Value::Null }).collect(),
        Values::Ints(values) => json!(values),
        Values::Texts(values) => json!(values),
    }
}

fn table_json(table: &Table) -> Value {
    let column =
        |c: &Column| json!({ "name": c.name, "unit": c.unit, "about": c.about, "values": values_json(&c.values) });
    json!({ "about": table.about, "columns": table.columns.iter().map(column).collect::<Vec<_>>() })
}

/// A table as a list of rows, each an object by column.
pub(super) fn rows_json(table: &Table) -> Value {
    let columns: Vec<(&str, Value)> = table.columns.iter().map(|c| (c.name.as_str(), values_json(&c.values))).collect();
    let row = |i: usize| columns.iter().map(|(name, values)| ((*name).to_owned(), values[i].clone())).collect();
    (0..table.rows()).map(|i| Value::Object(row(i))).collect()
}

fn group_json(artifact: &Artifact) -> Value {
    let values: serde_json::Map<String, Value> =
        artifact.root.iter().map(|(name, node)| (name.to_owned(), node_json(node))).collect();
    json!({ "kind": artifact.kind, "version": artifact.version, "values": values })
}

fn node_json(node: &Node) -> Value {
    match node {
        Node::Group(group) => group
            .iter()
            .map(|(name, node)| (name.to_owned(), node_json(node)))
            .collect::<serde_json::Map<_, _>>()
            .into(),
        Node::Table(table) => table_json(table),
        Node::Array(array) => json!({ "shape": array.shape, "unit": array.unit, "values": values_json(&array.values) }),
        Node::Text(text) => json!(text),
        Node::Real { value, unit } => {
            json!({ "value": if value.is_finite() { json!(value) } else { Value::Null }, "unit": unit })
        }
        Node::Int(value) => json!(value),
        Node::Flag(value) => json!(value),
        Node::Bytes(bytes) => json!({ "bytes": bytes.len() }),
    }
}
