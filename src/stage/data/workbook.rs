//! Workbooks of Excel and LibreOffice (xlsx, xlsb, xls, ods): one sheet as a table of text.

mod archive;
mod ods;
mod xls;

use super::super::StageError;
use super::super::sheet::Sheet;
use archive::{Archive, broken};
use calamine::{Data, Reader, Sheets, open_workbook_auto_from_rs};
use design::table::MOST_RUNS;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;

/// Whether these are the first bytes of a workbook: a zip archive, or the container of old Office files.
pub(super) fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1")
}

/// The cells of a sheet, the first row with the heads; rows without any cell are left out.
pub(super) fn sheet(bytes: &[u8], sheet: Option<&str>) -> Result<Sheet, StageError> {
    let mut lines = lines(bytes, sheet)?.into_iter();
    let heads: Vec<String> = lines.next().unwrap_or_default().iter().map(|head| head.trim().to_owned()).collect();
    let mut columns = vec![Vec::new(); heads.len()];
    for (row, line) in lines.enumerate() {
        if row == MOST_RUNS {
            return Err(StageError::new(format!("the table has more than {MOST_RUNS} rows")).hint("name a part of it"));
        }
        for (column, cell) in columns.iter_mut().zip(line) {
            column.push(cell);
        }
    }
    Ok(Sheet { heads, columns })
}

/// The lines of a sheet, all of one length.
fn lines(bytes: &[u8], sheet: Option<&str>) -> Result<Vec<Vec<String>>, StageError> {
    let mut archive = bytes.starts_with(b"PK").then(|| Archive::open(bytes)).transpose()?;
    let mut cells = Cells::default();
    let open = archive.as_mut().map(ods::is_ods).transpose()?.unwrap_or(false);
    if let Some(archive) = archive.as_mut().filter(|_| open) {
        let name = chosen(&ods::names(archive)?, sheet)?;
        ods::cells(archive, &name, |row, column, text| cells.take(&name, row, column, text.clone()))?;
    } else {
        // Old formats are full of counts and offsets, and a damaged file may send their reader beyond its end.
        let read = std::panic::AssertUnwindSafe(|| {
            let judged = if archive.is_some() { Cow::Borrowed(bytes) } else { Cow::Owned(xls::judged(bytes)?) };
            read_cells(&judged, sheet, &mut cells)
        });
        std::panic::catch_unwind(read).unwrap_or_else(|_| Err(broken("it is damaged")))?;
    }
    Ok(cells.lines())
}

/// The sheet of this name, or the only one.
fn chosen(names: &[String], sheet: Option<&str>) -> Result<String, StageError> {
    let message = match (sheet, names) {
        (Some(wanted), _) if names.iter().any(|name| name == wanted) => return Ok(wanted.to_owned()),
        (None, [only]) => return Ok(only.clone()),
        (_, []) => return Err(broken("it has no sheet")),
        (Some(wanted), _) => format!("the workbook has no sheet `{wanted}`"),
        (None, _) => "the workbook has several sheets".to_owned(),
    };
    Err(StageError::new(message).hint(format!("`sheet` is one of: {}", names.join(", "))))
}

/// Reads the cells of a workbook of Excel.
fn read_cells(bytes: &[u8], sheet: Option<&str>, cells: &mut Cells) -> Result<(), StageError> {
    let mut book = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(broken)?;
    let name = chosen(&book.sheet_names(), sheet)?;
    // Cell by cell where the format allows it: the size of a sheet is the position of its last cell, so one cell far away
    // would need more memory than there is.
    match &mut book {
        Sheets::Xlsx(book) => {
            let mut reader = book.worksheet_cells_reader(&name).map_err(broken)?;
            while let Some(cell) = reader.next_cell().map_err(broken)? {
                let ((row, column), value) = (cell.get_position(), Data::from(cell.get_value().clone()));
                cells.take(&name, row, column, text(&value))?;
            }
        }
        Sheets::Xlsb(book) => {
            let mut reader = book.worksheet_cells_reader(&name).map_err(broken)?;
            while let Some(cell) = reader.next_cell().map_err(broken)? {
                let ((row, column), value) = (cell.get_position(), Data::from(cell.get_value().clone()));
                cells.take(&name, row, column, text(&value))?;
            }
        }
        Sheets::Xls(_) | Sheets::Ods(_) => {
            let range = book.worksheet_range(&name).map_err(broken)?;
            let (row, column) = range.start().unwrap_or_default();
            for (i, j, cell) in range.used_cells() {
                cells.take(&name, row + i as u32, column + j as u32, text(cell))?;
            }
        }
    }
    Ok(())
}

/// Most columns of a sheet.
const MOST_COLUMNS: u32 = 1 << 14;

/// Most cells of the lines of a sheet, the empty ones between others included.
const MOST_CELLS: usize = 1 << 24;

/// The cells of a sheet that are not empty, by row and column.
#[derive(Default)]
struct Cells {
    rows: BTreeMap<u32, Vec<(u32, String)>>,
    /// The first column that is used, and the last.
    columns: Option<[u32; 2]>,
}

impl Cells {
    /// Takes a cell of a sheet, or the error that it holds.
    fn take(&mut self, sheet: &str, row: u32, column: u32, text: Result<String, String>) -> Result<(), StageError> {
        self.add(row, column, text.map_err(|error| at(sheet, row as usize + 1, &error))?)
    }

    fn add(&mut self, row: u32, column: u32, text: String) -> Result<(), StageError> {
        if text.is_empty() {
            return Ok(());
        }
        if column >= MOST_COLUMNS {
            let message = format!("the sheet has a cell in column {}", u64::from(column) + 1);
            return Err(StageError::new(message).hint(format!("at most {MOST_COLUMNS} columns are read")));
        }
        self.rows.entry(row).or_default().push((column, text));
        let [first, last] = self.columns.unwrap_or([column; 2]);
        let (first, last) = (first.min(column), last.max(column));
        self.columns = Some([first, last]);
        let cells = self.rows.len().saturating_mul((last - first) as usize + 1);
        // The line of names is not a row.
        if self.rows.len() > MOST_RUNS + 1 || cells > MOST_CELLS {
            let message = format!("the sheet has more than {MOST_RUNS} rows, or {MOST_CELLS} cells");
            return Err(StageError::new(message).hint("name a part of it, or delete what lies far from the table"));
        }
        Ok(())
    }

    /// The lines, all of one length, from the first column that is used to the last.
    fn lines(self) -> Vec<Vec<String>> {
        let Some([first, last]) = self.columns else { return Vec::new() };
        let width = (last - first) as usize + 1;
        let line = |cells: Vec<(u32, String)>| {
            let mut line = vec![String::new(); width];
            cells.into_iter().for_each(|(column, text)| line[(column - first) as usize] = text);
            line
        };
        self.rows.into_values().map(line).collect()
    }
}

fn at(sheet: &str, row: usize, error: &str) -> StageError {
    StageError::new(format!("sheet `{sheet}`, row {row}: a cell holds the error {error}"))
        .hint("mend the formula in the workbook, or empty the cell")
}

/// A cell as text: numbers with all digits, dates as year-month-day.
fn text(cell: &Data) -> Result<String, String> {
    Ok(match cell {
        Data::Empty => String::new(),
        Data::Float(value) => value.to_string(),
        Data::Int(value) => value.to_string(),
        Data::Bool(value) => value.to_string(),
        Data::Error(error) => return Err(error.to_string()),
        other => other.to_string().trim().to_owned(),
    })
}
