//! Workbooks of Excel and LibreOffice (xlsx, xlsb, xls, ods): one sheet as a table of text.

mod archive;
mod ods;
mod xls;

use super::super::StageError;
use super::super::sheet::Sheet;
use archive::{Archive, broken};
use calamine::{Data, Dimensions, Reader, Sheets, open_workbook_auto_from_rs};
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
            while let Some(cell) = reader.next_cell_with_formula().map_err(broken)? {
                let ((row, column), value) = (cell.pos, Data::from(cell.value));
                if value == Data::Empty && cell.formula.is_some() {
                    return Err(not_computed(&in_row(&name, row)));
                }
                cells.take(&name, row, column, text(&value))?;
            }
            drop(reader);
            cells.check_merged(&name, &book.merge_cells_by_sheet_name(&name).map_err(broken)?)?;
        }
        Sheets::Xlsb(book) => {
            let mut reader = book.worksheet_cells_reader(&name).map_err(broken)?;
            while let Some(cell) = reader.next_cell().map_err(broken)? {
                let ((row, column), value) = (cell.get_position(), Data::from(cell.get_value().clone()));
                cells.take(&name, row, column, text(&value))?;
            }
        }
        Sheets::Xls(_) | Sheets::Ods(_) => {
            let merged = match &book {
                Sheets::Xls(book) => book.merge_cells_by_sheet_name(&name).map_err(broken)?,
                Sheets::Xlsx(_) | Sheets::Xlsb(_) | Sheets::Ods(_) => Vec::new(),
            };
            let range = book.worksheet_range(&name).map_err(broken)?;
            let (row, column) = range.start().unwrap_or_default();
            for (i, j, cell) in range.used_cells() {
                cells.take(&name, row + i as u32, column + j as u32, text(cell))?;
            }
            cells.check_merged(&name, &merged)?;
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

    /// Refuses merged cells, of which only the first holds the value that people see in all of them.
    fn check_merged(&self, sheet: &str, merged: &[Dimensions]) -> Result<(), StageError> {
        let filled = |(row, column): (u32, u32)| {
            self.rows.get(&row).is_some_and(|cells| cells.iter().any(|(own, _)| *own == column))
        };
        match merged.iter().find(|cells| cells.start != cells.end && filled(cells.start)) {
            Some(cells) => Err(is_merged(&in_row(sheet, cells.start.0))),
            None => Ok(()),
        }
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

/// Merged cells; `place` says where, with a colon, if that is known.
fn is_merged(place: &str) -> StageError {
    StageError::new(format!("{place}cells are merged, and only the first of them holds the value"))
        .hint("split them, and write the value into each cell that it is for")
}

/// A formula that was never computed.
fn not_computed(place: &str) -> StageError {
    StageError::new(format!("{place}a formula has no value"))
        .hint("the program that wrote the workbook did not compute it: open it in a spreadsheet and save it")
}

fn in_row(sheet: &str, row: u32) -> String {
    format!("sheet `{sheet}`, row {}: ", u64::from(row) + 1)
}

fn at(sheet: &str, row: usize, error: &str) -> StageError {
    StageError::new(format!("sheet `{sheet}`, row {row}: a cell holds the error {error}"))
        .hint("mend the formula in the workbook, or empty the cell")
}

/// A cell as text: numbers with all digits, dates as year-month-day, durations as hours:minutes:seconds.
fn text(cell: &Data) -> Result<String, String> {
    Ok(match cell {
        Data::Empty => String::new(),
        Data::Float(value) => value.to_string(),
        Data::Int(value) => value.to_string(),
        Data::Bool(value) => value.to_string(),
        // As a number of days it would be taken for a value: spreadsheets make a date of 1-3.
        Data::DateTime(time) if time.is_duration() => {
            let seconds = (time.as_f64() * 86_400.0).round();
            format!("{:02}:{:02}:{:02}", (seconds / 3600.0).floor(), (seconds / 60.0).floor() % 60.0, seconds % 60.0)
        }
        Data::DateTime(time) => match time.to_ymd_hms_milli() {
            (year, month, day, 0, 0, 0, 0) => format!("{year}-{month:02}-{day:02}"),
            (year, month, day, hour, minute, second, _) => {
                format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}")
            }
        },
        Data::Error(error) => return Err(error.to_string()),
        other => other.to_string().trim().to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use calamine::{ExcelDateTime, ExcelDateTimeType};

    /// A spreadsheet makes a date of `1-3`; as a number of days it was taken for a value.
    #[test]
    fn dates_and_durations_are_words() {
        let cell = |value, kind| text(&Data::DateTime(ExcelDateTime::new(value, kind, false))).unwrap();
        assert_eq!(cell(43831.0, ExcelDateTimeType::DateTime), "2020-01-01");
        assert_eq!(cell(45943.5, ExcelDateTimeType::DateTime), "2025-10-13 12:00:00");
        assert_eq!(cell(1.5, ExcelDateTimeType::TimeDelta), "36:00:00");
    }

    #[test]
    fn merged_cells_are_refused_where_they_hold_a_value() {
        let mut cells = Cells::default();
        cells.add(1, 0, "1".to_owned()).unwrap();
        let merged = |start, end| cells.check_merged("a", &[Dimensions { start, end }]);
        let error = merged((1, 0), (2, 0)).unwrap_err();
        assert_eq!(error.message, "sheet `a`, row 2: cells are merged, and only the first of them holds the value");
        assert_eq!(merged((1, 0), (1, 0)), Ok(()));
        assert_eq!(merged((5, 5), (9, 9)), Ok(()), "only their frame is merged");
    }
}
