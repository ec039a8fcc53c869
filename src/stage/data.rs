//! `kind = "data"`: a table from a CSV file or a workbook, wherever a simulated table can stand.
//!
//! The first line names the columns, a unit in brackets after the name: `sigma_c [MPa]`, `sigma_c (MPa)` or
//! `sigma_c/MPa`. Units may also stand in the row below the names. A column whose cells are all numbers (or missing) holds
//! reals, any other holds texts. Comments (`#`) and titles stand above the line of names only. The result is an artifact `results`
//! with the table `runs`, as `simulate` gives it, and the table `notes`, which says how the file was read where that was
//! detected and is not the default (UTF-8, commas between cells, decimal points).

mod below;
mod cells;
mod dialect;
mod head;
mod rename;
mod workbook;

use super::beside::Beside;
use super::notes::Notes;
use super::sheet::Sheet;
use super::{Class, Complaint, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::results::Results;
use crate::artifact::{Artifact, ArtifactKind, Table, Values};
use crate::unit::Unit;
use cells::{Cells, Words};
use dialect::Dialect;
pub use dialect::{Decimal, Delimiter, Encoding};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::{BTreeMap, HashSet};

/// Settings of a `data` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// The file, relative to the workflow: CSV, or a workbook of Excel or LibreOffice (xlsx, xls, ods).
    pub file: String,
    /// Separator of the cells; detected by default.
    pub delimiter: Option<Delimiter>,
    /// Decimal sign; detected by default.
    pub decimal: Option<Decimal>,
    /// Encoding of the text; detected by default.
    pub encoding: Option<Encoding>,
    /// Words for missing values; by default `NA`, `N/A`, `n/a`, `NaN`, `nan`, `null`, `-` and `–`.
    pub missing: Option<Vec<String>>,
    /// The sheet of a workbook; needed if it has several.
    pub sheet: Option<String>,
    /// The line of the file, or row of the sheet, that names the columns, counted from 1; by default the first that is
    /// neither empty nor a comment nor a title.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_line: Option<usize>,
    /// New names of columns, by their names in the file: `{ "w/z" = "wc", "Festigkeit" = "UCS" }`. A unit may be given where
    /// the file has none: `{ "Zeit" = "age [d]" }`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rename: BTreeMap<String, String>,
}

impl Data {
    fn dialect(&self) -> Dialect {
        Dialect {
            delimiter: self.delimiter,
            decimal: self.decimal,
            encoding: self.encoding,
            missing: self.missing.clone(),
            sheet: self.sheet.clone(),
            first_line: self.first_line,
            rename: self.rename.clone(),
        }
    }
}

impl Data {
    /// Words where the workflow declares numbers.
    fn words(&self, columns: &[Words], context: &super::Context, found: &mut Beside) {
        for words in columns {
            let name = &words.name;
            let error = if context.factors.get(name).is_some_and(|factor| factor.names.is_empty()) {
                let message = format!("{}, and the levels of [factor.{name}] are numbers", words.found());
                let levels = format!("name the levels: `levels = [{:?}, …]`", words.first());
                StageError::new(message).hint(format!("correct the file, {levels}, or {}", words.as_missing()))
            } else if context.responses.contains_key(name) {
                words.fault()
            } else {
                continue;
            };
            let complaint = Complaint::new("file", format!("{}: {}", self.file, error.message));
            found.faults.push(Complaint { hint: error.hint, ..complaint });
        }
    }

    /// Columns whose numbers cannot be read in the unit that the workflow declares for their name.
    fn units(&self, table: &Table, context: &super::Context, found: &mut Beside) {
        let declared = |name: &str| {
            let factor = context.factors.get(name).map(|factor| &factor.unit);
            factor.or_else(|| context.responses.get(name).map(|response| &response.unit))
        };
        for column in table.columns.iter().filter(|column| !matches!(column.values, Values::Texts(_))) {
            let Some(unit) = declared(&column.name) else { continue };
            let differ = |given: &Unit| Unit::parse(unit).is_ok_and(|wanted| wanted.dimension != given.dimension);
            if !Unit::parse(&column.unit).is_ok_and(|given| differ(&given)) {
                continue;
            }
            let (file, name) = (&self.file, &column.name);
            let words = |unit: &str| if unit.is_empty() { "no unit".to_owned() } else { format!("`{unit}`") };
            let (given, wanted) = (words(&column.unit), words(unit));
            let message = format!("{file}: column `{name}` is in {given} and `{name}` of the workflow in {wanted}");
            let complaint = Complaint::new("file", message).hint("give the unit in the head of the column: `Ec [GPa]`");
            // A column without a unit may be one that no stage reads.
            if column.unit.is_empty() { found.warnings.push(complaint) } else { found.faults.push(complaint) }
        }
    }
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
        let zero = Complaint::new("first_line", "there is no line 0").hint("lines and rows are counted from 1");
        let faults = [(empty, self.file.trim().is_empty()), (zero, self.first_line == Some(0))];
        faults.into_iter().filter(|(_, is_one)| *is_one).map(|(complaint, _)| complaint).collect()
    }

    fn beside(&self, context: &super::Context, found: &mut Beside) {
        let Some(bytes) = found.bytes("file", &self.file) else { return };
        match parse_as(&bytes, &self.dialect()) {
            Err(StageError { message, hint }) => {
                let complaint = Complaint::new("file", format!("{}: {message}", self.file));
                found.faults.push(Complaint { hint, ..complaint });
            }
            Ok(Read { table, words, .. }) => {
                self.units(&table, context, found);
                self.words(&words, context, found);
                found.columns = Some(table.columns.into_iter().map(|column| column.name).collect());
            }
        }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut task = Task::new("data", json!(self.dialect()));
        task.files.push(known.library.file("table", &self.file)?);
        Ok(Step::Finish(task))
    }
}

impl Kind for Data {
    const NAME: &'static str = "data";
    const ABOUT: &'static str = "a table from a CSV file or a workbook, with units";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS];
    const CLASS: Class = Class::Data;
    // 4: merged cells, lines without any value, and columns in per cent of old workbooks are refused; cells that are
    // shown in per cent; units in the row below the names; decimal commas in text cells of workbooks; dates and times of
    // Excel as text.
    // 3: cells of LibreOffice that hold an error are refused.
    // 2: delimiter, decimal sign and encoding are detected; workbooks; words for missing values.
    const WORKS: &'static [Work] = &[Work { name: "data", version: 4, run: read }];
}

fn read(job: &Job) -> Result<Artifact, Failure> {
    let Read { table, said, .. } = parse_as(&job.file("table")?, &job.params()?)?;
    let notes = said.map(|said| {
        let mut notes = Notes::default();
        notes.add("", said);
        notes.table()
    });
    Ok(Results { runs: table, notes }.to_artifact())
}

/// Reads the whole table in any dialect, or returns its faults.
///
/// # Errors
/// A fault of it, and where.
pub fn parse(bytes: &[u8]) -> Result<Table, StageError> {
    parse_as(bytes, &Dialect::default()).map(|read| read.table)
}

/// A file that was read.
#[derive(Debug)]
struct Read {
    table: Table,
    /// What was detected, where that is not plain CSV.
    said: Option<String>,
    /// What is no number in columns that are read as words.
    words: Vec<Words>,
}

/// Reads the table by the settings `how`.
fn parse_as(bytes: &[u8], how: &Dialect) -> Result<Read, StageError> {
    let is_workbook = workbook::is_workbook(bytes);
    how.check(is_workbook)?;
    let (mut sheet, decimal, mut said, shares) = if is_workbook {
        let workbook::Book { sheet, said, shares } = workbook::sheet(bytes, how)?;
        (sheet, Decimal::Point, said, shares)
    } else {
        let (sheet, decimal, said) = text(bytes, how)?;
        (sheet, decimal, said, Some(Vec::new()))
    };
    let cells = Cells { decimal, missing: how.missing.as_deref() };
    let raised = below::raise(&mut sheet, &cells);
    rename::rename(&mut sheet, &how.rename)?;
    match shares {
        Some(shares) => in_per_cent(&mut sheet, &shares, usize::from(raised))?,
        None => check_per_cent(&sheet, &cells)?,
    }
    if raised {
        let units = "detected: units in the row below the names";
        said = Some(said.map_or_else(|| units.to_owned(), |said| format!("{said}; {units}")));
    }
    if sheet.rows() == 0 {
        return Err(StageError::new("the file has no rows below its first line"));
    }
    let mut names = HashSet::new();
    // A table that looks for the name of each new column among all others would cost the square of their number.
    let mut words = Vec::new();
    let column = |(head, texts): (&String, _)| cells::column((head, texts), &cells, &mut names, &mut words);
    let columns = sheet.heads.iter().zip(sheet.columns).map(column).collect::<Result<_, StageError>>()?;
    Ok(Read { table: Table { about: String::new(), columns }, said, words })
}

/// The unit of columns whose cells a spreadsheet may show in per cent.
const PER_CENT: &str = "%";

/// Refuses numbers in a column in per cent where the format of the workbook does not tell whether 5 % is 5 or 0.05.
fn check_per_cent(sheet: &Sheet, how: &Cells) -> Result<(), StageError> {
    for (head, column) in sheet.heads.iter().zip(&sheet.columns) {
        let is_number = |cell: &String| how.number(cell).is_some_and(f64::is_finite);
        if cells::name_and_unit(head)?.1 == PER_CENT && column.iter().any(is_number) {
            let message = format!("column `{head}`: this format of workbook does not say whether 5 % is 5 or 0.05");
            return Err(StageError::new(message).hint("save the workbook as xlsx, or the sheet as CSV"));
        }
    }
    Ok(())
}

/// Writes shares that a workbook shows in per cent as numbers of per cent, where the head of their column has that unit.
/// The first `rows` rows of the sheet are not rows of the table.
fn in_per_cent(sheet: &mut Sheet, shares: &[(usize, usize)], rows: usize) -> Result<(), StageError> {
    for &(column, row) in shares {
        if cells::name_and_unit(&sheet.heads[column])?.1 != PER_CENT {
            continue;
        }
        let Some(cell) = row.checked_sub(rows).and_then(|row| sheet.columns[column].get_mut(row)) else { continue };
        // Moving the point keeps the digits: 0.07 is 7 %, not 7.000000000000001 %.
        if let Ok(value) = format!("{cell}e2").parse::<f64>() {
            *cell = value.to_string();
        }
    }
    Ok(())
}

/// The cells of a text file, its decimal sign, and what was detected.
fn text(bytes: &[u8], how: &Dialect) -> Result<(Sheet, Decimal, Option<String>), StageError> {
    let (mut text, encoding) = dialect::decode(bytes, how.encoding)?;
    let stated = dialect::stated(&text).map(|(delimiter, rest)| (delimiter, format!("\n{rest}")));
    if let Some((_, rest)) = &stated {
        rest.clone_into(&mut text);
    }
    let stated = how.delimiter.or(stated.map(|(delimiter, _)| delimiter));
    let stated_line = how.first_line.filter(|line| *line > 1);
    if let Some(line) = stated_line {
        text = dialect::from_line(&text, line)?;
    }
    let dialect::Layout { delimiter, line, is_even } = dialect::layout(&text, stated, how.first_line);
    let detected_line = line.filter(|_| how.first_line.is_none());
    if let Some(line) = detected_line {
        text = dialect::from_line(&text, line)?;
    }
    let sheet = Sheet::of(&text, delimiter.byte(), |_| Ok(())).map_err(|error| match is_even {
        false => error.or("if titles stand above the names, say in which line the names are: `first_line = 4`"),
        true => error,
    })?;
    let cells = sheet.columns.iter().flatten().map(String::as_str);
    let decimal = how.decimal.map_or_else(|| dialect::decimal(cells), Ok)?;
    let said = dialect::said(
        encoding,
        Some(delimiter).filter(|_| how.delimiter.is_none()),
        Some(decimal).filter(|_| how.decimal.is_none()),
        detected_line,
    );
    Ok((sheet, decimal, said))
}

#[cfg(test)]
mod tests;
