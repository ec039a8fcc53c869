//! The only reader of CSV files, as laboratories and papers write them.
//!
//! UTF-8 text, with or without a byte order mark. Lines that begin with `#` are comments *above* the line of names only:
//! below it a `#` is a character like any other, because specimens have names such as `#2`. The first line names the columns,
//! a unit in brackets after the name: `sigma_c [MPa]`. Cells are separated by commas and may have double quotes; every line
//! has as many cells as the first. Lines without any character are skipped; in a file of one column they are refused, because
//! an empty line could be a missing value.

use super::StageError;
use design::table::MOST_RUNS;

/// The cells of a file, column by column.
pub(super) struct Sheet {
    /// Names and units of the columns, as in the file.
    pub(super) heads: Vec<String>,
    /// The cells of each column.
    pub(super) columns: Vec<Vec<String>>,
}

/// Most columns of a table.
const MOST_COLUMNS: usize = 1 << 15;

/// White space, and the byte order mark, which inside a file is a blank without width.
fn blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

impl Sheet {
    /// Reads a whole file, or returns its fault.
    ///
    /// # Errors
    /// It is not text, has other separators, or a line has more or fewer cells than the first.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, StageError> {
        let text = std::str::from_utf8(bytes).map_err(|e| not_text(bytes, e.valid_up_to()))?;
        Self::of(text, b',', separated_by_commas)
    }

    /// The cells of a text with this separator; `check` may refuse the names of its columns.
    ///
    /// # Errors
    /// The names are refused, or a line has more or fewer cells than the first.
    pub(super) fn of(
        text: &str,
        separator: u8,
        check: impl Fn(&[String]) -> Result<(), StageError>,
    ) -> Result<Self, StageError> {
        // A program that adds a mark may have added a second one.
        let (body, skipped) = below_comments(text.trim_start_matches('\u{feff}'));
        if let Some(at) = body.find('\0') {
            let line = skipped + body[..at].matches('\n').count() + 1;
            return Err(StageError::new(format!("line {line} holds the character NUL, which no text has"))
                .hint("is it UTF-16 without a mark at its start? save it in UTF-8, or say `encoding = \"utf-16\"`"));
        }
        if let Some(line) = open_quote(body) {
            let message = format!("line {}: a double quote has no partner", skipped + line);
            return Err(
                StageError::new(message).hint("all below it would be one cell; write a quote within quotes twice")
            );
        }
        let mut reader =
            csv::ReaderBuilder::new().delimiter(separator).trim(csv::Trim::All).from_reader(body.as_bytes());
        let fail = |e: &csv::Error| unequal(e, body, skipped);
        let heads: Vec<String> =
            reader.headers().map_err(|e| fail(&e))?.iter().map(|head| head.trim_matches(blank).to_owned()).collect();
        if heads.len() > MOST_COLUMNS {
            let message = format!("the first line has {} cells; at most {MOST_COLUMNS} columns are read", heads.len());
            return Err(StageError::new(message).hint("write a row for each of what is now a column"));
        }
        check(&heads)?;
        let mut columns = vec![Vec::new(); heads.len()];
        for (row, record) in reader.records().enumerate() {
            if row == MOST_RUNS {
                let message = format!("the table has more than {MOST_RUNS} rows");
                return Err(StageError::new(message).hint("name a part of it"));
            }
            let record = record.map_err(|e| fail(&e))?;
            if heads.len() > 1 && record.iter().all(str::is_empty) {
                let line = record.position().map_or(0, |at| line_at(body, at.byte())) + skipped;
                return Err(StageError::new(format!("line {line} has no value in any cell"))
                    .hint("remove such lines; spreadsheets write them below a table"));
            }
            for (column, cell) in columns.iter_mut().zip(record.iter()) {
                column.push(cell.to_owned());
            }
        }
        if let ([_], Some(line)) = (&heads[..], empty_line(body)) {
            let message = format!("line {} is empty", skipped + line);
            return Err(StageError::new(message).hint("write \"\" for a missing value, or remove the line"));
        }
        Ok(Self { heads, columns })
    }

    /// Index of the column with this head.
    pub(super) fn place(&self, head: &str) -> Option<usize> {
        self.heads.iter().position(|own| own == head)
    }

    /// Number of rows below the first line.
    pub(super) fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// The text from the line of names on, and how many lines of comment stand above it.
pub(super) fn below_comments(text: &str) -> (&str, usize) {
    let mut rest = text;
    let mut skipped = 0;
    while rest.trim_start_matches([' ', '\t', '\r']).starts_with(['#', '\n']) {
        rest = rest.split_once('\n').map_or("", |(_, below)| below);
        skipped += 1;
    }
    (rest, skipped)
}

/// The first empty line that is followed by others, from 1.
fn empty_line(text: &str) -> Option<usize> {
    let filled = text.trim_end();
    // A line break within quotes belongs to a cell.
    let mut quoted = false;
    filled.lines().enumerate().find_map(|(at, line)| {
        let empty = line.trim().is_empty() && !quoted;
        quoted ^= line.matches('"').count() % 2 == 1;
        empty.then_some(at + 1)
    })
}

/// The first line, from 1, with an odd number of quotes, if the number in the whole text is odd.
fn open_quote(text: &str) -> Option<usize> {
    let odd = |text: &str| text.matches('"').count() % 2 == 1;
    if odd(text) { text.lines().position(odd).map(|at| at + 1) } else { None }
}

fn not_text(bytes: &[u8], valid: usize) -> StageError {
    let line = bytes[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
    StageError::new(format!("line {line} holds a byte that is not UTF-8 text"))
        .hint("save the file as CSV in UTF-8; spreadsheets offer it when a file is saved")
}

/// The line, from 1, of the record that begins at this byte: the reader takes the ends of lines above a record for a part of it.
pub(super) fn line_at(text: &str, byte: u64) -> usize {
    let byte = byte as usize;
    let ends = text[byte..].bytes().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    1 + text[..byte + ends].matches('\n').count()
}

fn unequal(error: &csv::Error, body: &str, skipped: usize) -> StageError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, |at| line_at(body, at.byte()) + skipped);
            let cells = if *len == 1 { "cell" } else { "cells" };
            StageError::new(format!("line {line} has {len} {cells} where the first line has {expected_len}"))
                .hint("every line must have the cells of the first line; put a cell that holds a comma in quotes")
        }
        _ => StageError::new(error.to_string()),
    }
}

/// Refuses tables with `;` or tabs, which would be read as one column.
fn separated_by_commas(heads: &[String]) -> Result<(), StageError> {
    let [head] = heads else { return Ok(()) };
    let Some(found) = [(';', "`;`"), ('\t', "tabs")].into_iter().find(|(sign, _)| head.contains(*sign)) else {
        return Ok(());
    };
    Err(StageError::new(format!("the cells of the first line are separated by {}", found.1))
        .hint("save the file with commas between the cells, and points in the numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Sheet {
        Sheet::read(text.as_bytes()).unwrap()
    }

    #[test]
    fn a_hash_below_the_names_is_a_character() {
        let sheet = read("# by hand\n  # twice\n\nsample,y\nA1,10\n#2,30\n# 3,5\n");
        assert_eq!(sheet.heads, ["sample", "y"]);
        assert_eq!(sheet.columns[0], ["A1", "#2", "# 3"]);
        assert_eq!(sheet.rows(), 3);
    }

    #[test]
    fn no_row_is_lost_without_a_word() {
        let message = |text: &[u8]| Sheet::read(text).err().unwrap().message;
        assert_eq!(message(b"# c\ny\n1\n\n3\n"), "line 4 is empty");
        assert_eq!(read("y\n1\n\"\"\n3\n\n\n").columns[0], ["1", "", "3"]);
        assert_eq!(read("a,y\n1,2\n\n3,4\n").rows(), 2);
        assert_eq!(message(b"# c\na,b\n1\n"), "line 3 has 1 cell where the first line has 2");
        assert_eq!(message(b"# c\na,b\n1,\0\n"), "line 3 holds the character NUL, which no text has");
        assert_eq!(message(b"# c\r\na,b\r\n1,2\r\n\r\n1\r\n"), "line 5 has 1 cell where the first line has 2");
        assert_eq!(message(b"# c\r\na,b\r\n1,2\r\n\r\n,\r\n"), "line 5 has no value in any cell");
        assert_eq!(message(b"a,b\n1,2,3\n"), "line 2 has 3 cells where the first line has 2");
        assert_eq!(message(b"a,b\n1,2\n\xf6,3\n"), "line 3 holds a byte that is not UTF-8 text");
        assert_eq!(message(b"# c\na,b\n1,\"2\n3,4\n"), "line 3: a double quote has no partner");
        assert_eq!(message(b"a;b\n1,5;2\n"), "the cells of the first line are separated by `;`");
        assert_eq!(message(b"a\tb\n1\t2\n"), "the cells of the first line are separated by tabs");
    }

    #[test]
    fn marks_quotes_and_line_ends_are_those_of_spreadsheets() {
        let sheet = read("\u{feff}a,\"b, c\"\r\n1,\"x \"\"y\"\"\r\nz\"\r\n");
        assert_eq!(sheet.heads, ["a", "b, c"]);
        assert_eq!(sheet.columns[1], ["x \"y\"\r\nz"]);
    }
}
