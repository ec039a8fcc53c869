//! `kind = "data"`: a CSV file with units stands wherever a simulated table stands.
//!
//! How a file is written stands in `sheet.rs`: comments (`#`) above the line of names only, units in brackets after the
//! names, `sigma_c [MPa]`. A column whose cells are all numbers (or empty: missing) holds reals, any other holds texts. The
//! result is an artifact `results` with the table `runs`, as
//! `simulate` gives it.

use super::beside::Beside;
use super::sheet::Sheet;
use super::{Class, Complaint, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::results::Results;
use crate::artifact::{Artifact, ArtifactKind, Column, Table, Values};
use crate::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::HashSet;

/// Settings of a `data` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// The CSV file, relative to the workflow.
    pub file: String,
}

impl Stage for Data {
    fn inputs(&self) -> Vec<Port> {
        Vec::new()
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::RESULTS
    }

    fn check(&self, _context: &super::Context) -> Vec<Complaint> {
        let empty = Complaint::new("file", "the name of the file is empty").hint("name a CSV file beside the workflow");
        if self.file.trim().is_empty() { vec![empty] } else { Vec::new() }
    }

    fn beside(&self, _context: &super::Context, found: &mut Beside) {
        found.file("file", &self.file);
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut task = Task::new("data", json!({}));
        task.files.push(known.library.file("table", &self.file)?);
        Ok(Step::Finish(task))
    }
}

impl Kind for Data {
    const NAME: &'static str = "data";
    const ABOUT: &'static str = "a table from a CSV file with units";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS];
    const CLASS: Class = Class::Data;
    const WORKS: &'static [Work] = &[Work { name: "data", version: 1, run: read }];
}

fn read(job: &Job) -> Result<Artifact, Failure> {
    let table = parse(&job.file("table")?)?;
    Ok(Results { runs: table }.to_artifact())
}

/// Reads the whole table.
///
/// # Errors
/// What is wrong with it, and where.
pub fn parse(bytes: &[u8]) -> Result<Table, StageError> {
    let sheet = Sheet::read(bytes)?;
    if sheet.rows() == 0 {
        return Err(StageError::new("the file has no rows below its first line"));
    }
    let mut names = HashSet::new();
    let mut table = Table::default();
    for (head, cells) in sheet.heads.iter().zip(sheet.columns) {
        let (name, unit) = named(head)?;
        if name.is_empty() || !names.insert(name) {
            return Err(StageError::new(format!("column `{head}`: every column needs a name of its own")));
        }
        Unit::parse(unit).map_err(|e| StageError::new(format!("column `{head}`: {e}")))?;
        table.columns.push(column(name, unit, cells));
    }
    Ok(table)
}

/// Name and unit of a column.
fn named(head: &str) -> Result<(&str, &str), StageError> {
    let Some((name, rest)) = head.split_once('[') else { return Ok((head, "")) };
    match rest.trim_end().strip_suffix(']') {
        Some(unit) if !unit.contains(['[', ']']) => Ok((name.trim(), unit.trim())),
        Some(_) | None => {
            Err(StageError::new(format!("column `{head}`: the unit must stand alone in brackets at the end"))
                .hint("write for example `Ec [GPa]`"))
        }
    }
}

/// Numbers where every cell is one or empty, else texts.
fn column(name: &str, unit: &str, cells: Vec<String>) -> Column {
    let number = |cell: &String| {
        if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok().filter(|value: &f64| value.is_finite()) }
    };
    let numbers: Option<Vec<f64>> = cells.iter().map(number).collect();
    let (unit, values) = match numbers {
        Some(values) => (unit.to_owned(), Values::Reals(values)),
        None => (String::new(), Values::Texts(cells)),
    };
    Column { name: name.to_owned(), unit, about: String::new(), values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_numbers_and_missing_cells_are_read() {
        let table = parse(b"run,Ec [GPa],remark\n1,20,a\n2,,b\n").unwrap();
        assert_eq!(table.column("Ec").unwrap().unit, "GPa");
        let moduli = table.shown("Ec").unwrap().0;
        assert!(moduli[0] == 20.0 && moduli[1].is_nan());
        assert!(table.shown("remark").is_err());
    }

    #[test]
    fn faults_name_line_or_column() {
        let message = |text: &[u8]| parse(text).unwrap_err().message;
        assert!(message(b"a,b\n1\n").contains("line 2"), "{}", message(b"a,b\n1\n"));
        assert!(message(b"a [MPa\n1\n").contains("brackets"));
        assert!(message(b"a [MPa] x\n1\n").contains("brackets"));
        assert!(message(b"a [ell]\n1\n").contains("`a [ell]`"));
        assert!(message(b"a,a\n1,2\n").contains("name of its own"));
        assert!(message(b"a\n").contains("no rows"));
    }
}
