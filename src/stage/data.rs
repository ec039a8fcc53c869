//! `kind = "data"`: a CSV file with units stands wherever a simulated table stands.
//!
//! The first line names the columns, a unit in brackets after the name: `sigma_c [MPa]`. A column whose cells are all
//! numbers (or empty: missing) holds reals, any other holds texts. The result is an artifact `results` with the table `runs`, as
//! `simulate` gives it.

use super::{Class, Complaint, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::results::Results;
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::unit::Unit;
use design::table::MOST_RUNS;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

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

/// Reads the whole table, or says what is wrong with it.
pub(super) fn parse(bytes: &[u8]) -> Result<Table, StageError> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(bytes);
    let fail = |e: csv::Error| StageError::new(e.to_string()).hint("every line must have the cells of the first line");
    let heads: Vec<String> = reader.headers().map_err(fail)?.iter().map(str::to_owned).collect();
    let mut cells = vec![Vec::new(); heads.len()];
    for (row, record) in reader.records().enumerate() {
        if row == MOST_RUNS {
            return Err(StageError::new(format!("the table has more than {MOST_RUNS} rows")).hint("name a part of it"));
        }
        for (column, cell) in cells.iter_mut().zip(record.map_err(fail)?.iter()) {
            column.push(cell.to_owned());
        }
    }
    if cells.first().is_none_or(Vec::is_empty) {
        return Err(StageError::new("the file has no rows below its first line"));
    }
    let mut table = Table::default();
    for (head, cells) in heads.iter().zip(cells) {
        table = column(table, head, cells)?;
    }
    Ok(table)
}

fn column(table: Table, head: &str, cells: Vec<String>) -> Result<Table, StageError> {
    let (name, unit) = match head.split_once('[') {
        Some((name, unit)) => (name.trim(), unit.trim_end_matches(']').trim()),
        None => (head, ""),
    };
    if name.is_empty() || table.column(name).is_some() {
        return Err(StageError::new(format!("column `{head}`: every column needs a name of its own")));
    }
    Unit::parse(unit).map_err(|e| StageError::new(format!("column `{head}`: {e}")))?;
    let numbers: Option<Vec<f64>> = cells
        .iter()
        .map(|cell| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok().filter(|v: &f64| v.is_finite()) })
        .collect();
    Ok(match numbers {
        Some(values) => table.reals_column(name, unit, "", values),
        None => table.texts_column(name, "", cells),
    })
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
        assert!(message(b"a,b\n1\n").contains("line: 2"), "{}", message(b"a,b\n1\n"));
        assert!(message(b"a [ell]\n1\n").contains("`a [ell]`"));
        assert!(message(b"a,a\n1,2\n").contains("name of its own"));
        assert!(message(b"a\n").contains("no rows"));
    }
}
