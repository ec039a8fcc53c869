//! Workbooks of Excel and LibreOffice (xlsx, xlsb, xls, ods): one sheet as a table of text.

mod archive;
mod ods;
mod remarks;
mod xls;
mod xlsb;

use super::super::StageError;
use super::super::sheet::Sheet;
use super::dialect::{self, Decimal, Dialect};
use super::head;
use archive::{Archive, broken};
use calamine::{Data, Dimensions, ExcelDateTime, Reader, Sheets, open_workbook_auto_from_rs};
use design::table::MOST_RUNS;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

/// Whether these are the first bytes of a workbook: a zip archive, or the container of old Office files.
pub(super) fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1")
}

/// A sheet as a table of text.
pub(super) struct Book {
    /// The first row with the heads; rows without any cell are left out.
    pub sheet: Sheet,
    /// What was detected.
    pub said: Option<String>,
    /// Column and row of the cells that are shown in per cent and hold a share; `None` where the format does not say.
    pub shares: Option<Vec<(usize, usize)>>,
}

/// The cells of a sheet.
pub(super) fn sheet(bytes: &[u8], how: &Dialect) -> Result<Book, StageError> {
    let mut cells = cells(bytes, how.sheet.as_deref())?;
    let detected_line = if how.first_line.is_none() { cells.head() } else { None };
    if let Some(line) = how.first_line.or(detected_line) {
        cells.begin(line)?;
    }
    cells.check_merged()?;
    let tells_shares = cells.tells_shares;
    let commas = cells.settle_decimals(how.decimal)?;
    let commas = commas.then(|| "decimal commas in cells that hold text; the key `decimal` fixes it".to_owned());
    let names = detected_line.map(|line| format!("{}; the key `first_line` fixes it", dialect::names_in(line)));
    let all: Vec<String> = [commas, names].into_iter().flatten().collect();
    let said = (!all.is_empty()).then(|| format!("detected: {}", all.join("; ")));
    let mut lines = cells.lines().into_iter();
    let heads: Vec<String> = lines.next().unwrap_or_default().iter().map(|head| head.text.trim().to_owned()).collect();
    let (mut columns, mut shares) = (vec![Vec::new(); heads.len()], Vec::new());
    for (row, line) in lines.enumerate() {
        if row == MOST_RUNS {
            return Err(StageError::new(format!("the table has more than {MOST_RUNS} rows")).hint("name a part of it"));
        }
        for (index, (column, cell)) in columns.iter_mut().zip(line).enumerate() {
            column.push(cell.text);
            if cell.is_share {
                shares.push((index, row));
            }
        }
    }
    Ok(Book { sheet: Sheet { heads, columns }, said, shares: tells_shares.then_some(shares) })
}

/// The cells of a sheet.
fn cells(bytes: &[u8], sheet: Option<&str>) -> Result<Cells, StageError> {
    let mut archive = bytes.starts_with(b"PK").then(|| Archive::open(bytes)).transpose()?;
    let mut cells = Cells::default();
    let open = archive.as_mut().map(ods::is_ods).transpose()?.unwrap_or(false);
    if let Some(archive) = archive.as_mut().filter(|_| open) {
        let name = chosen(&ods::names(archive)?, sheet)?;
        ods::cells(archive, &name, |row, column, value| cells.take(&name, row, column, value.clone()))?;
        cells.tells_shares = true;
    } else {
        // Old formats are full of counts and offsets, and a damaged file may send their reader beyond its end.
        let read = std::panic::AssertUnwindSafe(|| {
            let judged = if archive.is_some() { Cow::Borrowed(bytes) } else { Cow::Owned(xls::judged(bytes)?) };
            read_cells(&judged, sheet, &mut cells)
        });
        let name = std::panic::catch_unwind(read).unwrap_or_else(|_| Err(broken("it is damaged")))?;
        if let Some(archive) = &mut archive {
            let remarks = remarks::remarks(archive, &name)?;
            if let Some((row, _)) = remarks.uncomputed {
                let message =
                    format!("sheet `{name}`, row {}: a cell holds a formula that was never computed", row + 1);
                return Err(StageError::new(message).hint("open the workbook in a spreadsheet program and save it"));
            }
            cells.mark(&remarks.shares);
            cells.merge(&xlsb::merged(archive, &name)?);
        }
    }
    Ok(cells)
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

/// Reads the cells of a workbook of Excel; returns the name of their sheet.
fn read_cells(bytes: &[u8], sheet: Option<&str>, cells: &mut Cells) -> Result<String, StageError> {
    let mut book = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(broken)?;
    let name = chosen(&book.sheet_names(), sheet)?;
    // Cell by cell where the format allows it: the size of a sheet is the position of its last cell, so one cell far away
    // would need more memory than there is.
    match &mut book {
        Sheets::Xlsx(book) => {
            let mut reader = book.worksheet_cells_reader(&name).map_err(broken)?;
            while let Some(cell) = reader.next_cell().map_err(broken)? {
                let ((row, column), value) = (cell.get_position(), Data::from(cell.get_value().clone()));
                cells.take(&name, row, column, read(&value))?;
            }
            drop(reader);
            cells.merge(&book.merge_cells_by_sheet_name(&name).map_err(broken)?);
            cells.tells_shares = true;
        }
        Sheets::Xlsb(book) => {
            let mut reader = book.worksheet_cells_reader(&name).map_err(broken)?;
            while let Some(cell) = reader.next_cell().map_err(broken)? {
                let ((row, column), value) = (cell.get_position(), Data::from(cell.get_value().clone()));
                cells.take(&name, row, column, read(&value))?;
            }
        }
        Sheets::Xls(_) | Sheets::Ods(_) => {
            let range = book.worksheet_range(&name).map_err(broken)?;
            let (row, column) = range.start().unwrap_or_default();
            for (i, j, cell) in range.used_cells() {
                cells.take(&name, row + i as u32, column + j as u32, read(cell))?;
            }
            if let Sheets::Xls(book) = &book {
                cells.merge(&book.merge_cells_by_sheet_name(&name).map_err(broken)?);
            }
        }
    }
    Ok(name)
}

/// Most columns of a sheet.
const MOST_COLUMNS: u32 = 1 << 14;

/// Most cells of the lines of a sheet, the empty ones between others included.
const MOST_CELLS: usize = 1 << 24;

/// A cell as it is read.
#[derive(Clone, Debug, Default, PartialEq)]
struct Cell {
    text: String,
    /// Whether it holds text, not a number, a date or a truth value.
    is_word: bool,
    /// Whether it is shown in per cent.
    is_share: bool,
    /// Whether it is the first of cells that are merged.
    is_merged: bool,
}

impl Cell {
    fn word(text: String) -> Self {
        Self { text, is_word: true, ..Self::default() }
    }

    fn value(text: impl ToString) -> Self {
        Self { text: text.to_string(), ..Self::default() }
    }
}

/// The cells of a sheet that are not empty, by row and column.
#[derive(Default)]
struct Cells {
    rows: BTreeMap<u32, Vec<(u32, Cell)>>,
    /// The first column that is used, and the last.
    columns: Option<[u32; 2]>,
    /// Whether the format of the workbook tells which cells are shown in per cent.
    tells_shares: bool,
}

impl Cells {
    /// Takes a cell of a sheet, or the error that it holds.
    fn take(&mut self, sheet: &str, row: u32, column: u32, cell: Result<Cell, String>) -> Result<(), StageError> {
        self.add(row, column, cell.map_err(|error| at(sheet, row as usize + 1, &error))?)
    }

    /// The row that names the columns, counted from 1, where it is not the first one.
    fn head(&self) -> Option<usize> {
        let [first, last] = self.columns?;
        let mut lines = Vec::new();
        for cells in self.rows.values().take(dialect::LOOKED_AT) {
            let mut line = vec![""; (last - first) as usize + 1];
            cells.iter().for_each(|(column, cell)| line[(column - first) as usize] = &cell.text);
            lines.push(line);
        }
        let at = head::find(&lines, dialect::is_any_number).filter(|at| *at > 0)?;
        self.rows.keys().nth(at).map(|row| *row as usize + 1)
    }

    /// Leaves out what stands above a row, counted from 1.
    ///
    /// # Errors
    /// Nothing is left.
    fn begin(&mut self, line: usize) -> Result<(), StageError> {
        self.rows.retain(|row, _| *row as usize >= line.saturating_sub(1));
        let used = self.rows.values().flatten().map(|(column, _)| *column);
        self.columns = used.clone().min().zip(used.max()).map(|(first, last)| [first, last]);
        if self.rows.is_empty() { Err(dialect::no_line(line)) } else { Ok(()) }
    }

    /// Marks the first of merged cells, where it holds a value.
    fn merge(&mut self, merged: &[Dimensions]) {
        for Dimensions { start, .. } in merged.iter().filter(|cells| cells.start != cells.end) {
            let mut cells = self.rows.get_mut(&start.0).into_iter().flatten();
            if let Some((_, cell)) = cells.find(|(column, _)| *column == start.1) {
                cell.is_merged = true;
            }
        }
    }

    /// Marks the numbers that are shown in per cent, by row and column.
    fn mark(&mut self, shares: &BTreeSet<(u32, u32)>) {
        if shares.is_empty() {
            return;
        }
        for (row, cells) in &mut self.rows {
            for (column, cell) in cells.iter_mut().filter(|(_, cell)| !cell.is_word) {
                cell.is_share = shares.contains(&(*row, *column));
            }
        }
    }

    /// Writes numbers that stand as text with decimal commas as numbers are written; returns whether that was detected.
    ///
    /// # Errors
    /// The texts do not tell which sign stands before decimals, or one has another sign than the setting.
    fn settle_decimals(&mut self, fixed: Option<Decimal>) -> Result<bool, StageError> {
        let words = self.rows.values().flatten().filter(|(_, cell)| cell.is_word).map(|(_, cell)| cell.text.as_str());
        let decimal = fixed.map_or_else(|| dialect::decimal(words.clone()), Ok)?;
        if decimal == Decimal::Point {
            return Ok(false);
        }
        if let Some(other) = words.clone().find(|word| word.contains('.') && dialect::is_number(word)) {
            let message = format!("`{other}` is a text with a point in a sheet whose texts have decimal commas");
            return Err(StageError::new(message).hint("turn the texts of the sheet into numbers"));
        }
        for (_, cell) in self.rows.values_mut().flatten().filter(|(_, cell)| cell.is_word) {
            let number = cell.text.replacen(',', ".", 1);
            if dialect::is_number(&number.replacen('−', "-", 1)) {
                cell.text = number;
            }
        }
        Ok(fixed.is_none())
    }

    fn add(&mut self, row: u32, column: u32, cell: Cell) -> Result<(), StageError> {
        if cell.text.is_empty() {
            return Ok(());
        }
        if column >= MOST_COLUMNS {
            let message = format!("the sheet has a cell in column {}", u64::from(column) + 1);
            return Err(StageError::new(message).hint(format!("at most {MOST_COLUMNS} columns are read")));
        }
        self.rows.entry(row).or_default().push((column, cell));
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
    fn check_merged(&self) -> Result<(), StageError> {
        let is_merged = |cells: &[(u32, Cell)]| cells.iter().any(|(_, cell)| cell.is_merged);
        let Some((row, _)) = self.rows.iter().find(|(_, cells)| is_merged(cells)) else { return Ok(()) };
        let row = u64::from(*row) + 1;
        let message = format!("row {row}: cells are merged, and only the first of them holds the value");
        Err(StageError::new(message).hint("split them, and write the value into each cell that it is for"))
    }

    /// The lines, all of one length, from the first column that is used to the last.
    fn lines(self) -> Vec<Vec<Cell>> {
        let Some([first, last]) = self.columns else { return Vec::new() };
        let width = (last - first) as usize + 1;
        let line = |cells: Vec<(u32, Cell)>| {
            let mut line = vec![Cell::default(); width];
            cells.into_iter().for_each(|(column, cell)| line[(column - first) as usize] = cell);
            line
        };
        self.rows.into_values().map(line).collect()
    }
}

fn at(sheet: &str, row: usize, error: &str) -> StageError {
    StageError::new(format!("sheet `{sheet}`, row {row}: a cell holds the error {error}"))
        .hint("mend the formula in the workbook, or empty the cell")
}

/// A cell: numbers with all digits, dates as year-month-day, times as hours, minutes and seconds.
fn read(cell: &Data) -> Result<Cell, String> {
    Ok(match cell {
        Data::Empty => Cell::value(""),
        Data::Float(value) => Cell::value(value),
        Data::Int(value) => Cell::value(value),
        Data::Bool(value) => Cell::value(value),
        Data::DateTime(moment) => Cell::value(in_words(*moment)),
        Data::Error(error) => return Err(error.to_string()),
        other => Cell::word(other.to_string().trim().to_owned()),
    })
}

/// A date, a time of day or a duration of Excel, which are all stored as a number of days.
fn in_words(moment: ExcelDateTime) -> String {
    let days = moment.as_f64();
    if moment.is_duration() || days.abs() < 1.0 {
        return clock(days * 86_400.0);
    }
    let (year, month, day, hour, minute, second, _) = moment.to_ymd_hms_milli();
    let date = format!("{year:04}-{month:02}-{day:02}");
    match (hour, minute, second) {
        (0, 0, 0) => date,
        _ => format!("{date}T{hour:02}:{minute:02}:{second:02}"),
    }
}

/// Seconds as `36:05:00`.
fn clock(seconds: f64) -> String {
    let sign = if seconds < 0.0 { "-" } else { "" };
    let all = seconds.abs().round() as u64;
    format!("{sign}{}:{:02}:{:02}", all / 3600, all / 60 % 60, all % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use calamine::ExcelDateTimeType;

    #[test]
    fn dates_and_times_of_excel_are_no_numbers() {
        let date = |days| in_words(ExcelDateTime::new(days, ExcelDateTimeType::DateTime, false));
        // The serial numbers that Excel documents: 1 is 1 January 1900, 45943 is 13 October 2025.
        assert_eq!([date(45943.0), date(45943.541)], ["2025-10-13", "2025-10-13T12:59:02"]);
        assert_eq!([date(0.5), date(0.75 + 1.0 / 86_400.0)], ["12:00:00", "18:00:01"]);
        assert_eq!(in_words(ExcelDateTime::new(1.5, ExcelDateTimeType::TimeDelta, false)), "36:00:00");
        assert_eq!(clock(-90.0), "-0:01:30");
    }

    #[test]
    fn merged_cells_are_refused_where_they_hold_a_value() {
        let merged = |start, end| {
            let mut cells = Cells::default();
            cells.add(1, 0, Cell::value("1")).unwrap();
            cells.merge(&[Dimensions { start, end }]);
            cells.check_merged()
        };
        let error = merged((1, 0), (2, 0)).unwrap_err();
        assert_eq!(error.message, "row 2: cells are merged, and only the first of them holds the value");
        assert_eq!(merged((1, 0), (1, 0)), Ok(()));
        assert_eq!(merged((5, 5), (9, 9)), Ok(()), "only their frame is merged");
    }
}
