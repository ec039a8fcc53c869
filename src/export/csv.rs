//! Tables as CSV.

use crate::artifact::{Column, Table, Values};
use math::text::typed;

/// The first cell of a row without any value: an empty line may be none at all to a reader.
const MISSING: &str = "NA";

/// A table as CSV, with units in the first line and all digits.
pub fn csv_text(table: &Table) -> String {
    let columns: Vec<Vec<String>> = table.columns.iter().map(|column| cells(&column.values)).collect();
    let heads: Vec<String> = table.columns.iter().map(head).collect();
    // A reader that looks for the delimiter must not take one inside a head for it; where the head has none, it is none.
    // With signs that steer, a head may begin as a workbook does.
    // Cells of a single column would make a table of several below a title.
    let like_delimiter = |text: &String| text.contains([';', '\t', '|']) || text.contains(char::is_control);
    let single = if let [only] = columns.as_slice() { only.as_slice() } else { &[] };
    let is_unclear = heads.iter().chain(single).any(like_delimiter);
    let quotes = if is_unclear { csv::QuoteStyle::Always } else { csv::QuoteStyle::Necessary };
    let mut out = csv::WriterBuilder::new().comment(Some(b'#')).quote_style(quotes).from_writer(Vec::new());
    let written = out.write_record(&heads).and_then(|()| {
        (0..table.rows()).try_for_each(|row| {
            let mut record: Vec<&str> = columns.iter().map(|column| column[row].as_str()).collect();
            if record.iter().all(|cell| cell.is_empty())
                && let Some(first) = record.first_mut()
            {
                *first = MISSING;
            }
            out.write_record(record)
        })
    });
    match (written, out.into_inner()) {
        (Ok(()), Ok(bytes)) => String::from_utf8_lossy(&bytes).into_owned(),
        (Err(_), _) | (_, Err(_)) => panic!("BUG: writing a table to memory failed"),
    }
}

/// The head of a column: its name, and its unit in brackets.
pub fn head(column: &Column) -> String {
    match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// The values as texts with all digits; empty where one is missing.
pub fn cells(values: &Values) -> Vec<String> {
    match values {
        Values::Reals(values) => values.iter().map(|v| if v.is_nan() { String::new() } else { typed(*v) }).collect(),
        Values::Ints(values) => values.iter().map(i64::to_string).collect(),
        Values::Texts(values) => values.clone(),
    }
}
