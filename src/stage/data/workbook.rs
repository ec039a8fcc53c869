//! Workbooks of Excel and LibreOffice (xlsx, xlsb, xls, ods): one sheet as a table of text.

use super::super::StageError;
use super::super::sheet::Sheet;
use calamine::{Data, Reader, open_workbook_auto_from_rs};
use design::table::MOST_RUNS;
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
    let fault = |e: calamine::Error| StageError::new(format!("the workbook cannot be read: {e}"));
    let mut book = open_workbook_auto_from_rs(Cursor::new(bytes.to_vec())).map_err(fault)?;
    let names = book.sheet_names();
    let name = match (sheet, names.as_slice()) {
        (Some(wanted), _) if names.iter().any(|name| name == wanted) => wanted.to_owned(),
        (None, [only]) => only.clone(),
        (wanted, _) => {
            let message = match wanted {
                Some(wanted) => format!("the workbook has no sheet `{wanted}`"),
                None => "the workbook has several sheets".to_owned(),
            };
            return Err(StageError::new(message).hint(format!("`sheet` is one of: {}", names.join(", "))));
        }
    };
    let range = book.worksheet_range(&name).map_err(fault)?;
    let first = range.start().map_or(0, |(row, _)| row as usize);
    let mut lines = Vec::new();
    for (row, cells) in range.rows().enumerate() {
        let read = cells.iter().map(|cell| text(cell).map_err(|e| at(&name, first + row + 1, &e)));
        let line = read.collect::<Result<Vec<String>, StageError>>()?;
        if line.iter().any(|cell| !cell.is_empty()) {
            lines.push(line);
        }
    }
    Ok(lines)
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
