//! The dialect of a text file: encoding, delimiter and decimal sign, detected from the bytes or set in the workflow.

use super::super::StageError;
use super::super::sheet::{below_comments, line_at};
use super::head;
use crate::unit::vanishes;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The delimiter between two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Delimiter {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator.
    Tab,
    /// `|`
    Bar,
}

/// The decimal sign of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Decimal {
    /// `1.5`
    #[default]
    Point,
    /// `1,5`
    Comma,
}

/// The encoding of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Encoding {
    /// Unicode in one to four bytes.
    #[serde(rename = "utf-8")]
    Utf8,
    /// Unicode in pairs of bytes, the lower one first.
    #[serde(rename = "utf-16")]
    Utf16,
    /// The Windows code page of western Europe, which holds ISO 8859-1.
    #[serde(rename = "windows-1252")]
    Windows1252,
}

/// The dialect of a file; a field that is `None` is detected.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Dialect {
    /// The delimiter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<Delimiter>,
    /// The decimal sign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decimal: Option<Decimal>,
    /// The encoding.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoding: Option<Encoding>,
    /// Words for missing values, besides an empty cell; `None` for the default ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<Vec<String>>,
    /// The sheet of a workbook.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<String>,
    /// The line or row with the names of the columns, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_line: Option<usize>,
    /// New names of columns, by their names in the file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rename: BTreeMap<String, String>,
}

impl Dialect {
    /// Refuses settings that have no effect on a file of this kind.
    pub(super) fn check(&self, is_workbook: bool) -> Result<(), StageError> {
        let of_texts = [("delimiter", self.delimiter.is_some()), ("encoding", self.encoding.is_some())];
        let of_workbooks = [("sheet", self.sheet.is_some())];
        let (idle, what) = if is_workbook { (&of_texts[..], "a workbook") } else { (&of_workbooks[..], "a text file") };
        match idle.iter().find(|(_, given)| *given) {
            Some((key, _)) => {
                let error = StageError::new(format!("`{key}` has no effect on {what}"));
                Err(error.hint(format!("leave out `{key}`")))
            }
            None => Ok(()),
        }
    }
}

impl Delimiter {
    const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Bar];

    /// The byte.
    pub fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Bar => b'|',
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Comma => "comma",
            Self::Semicolon => "semicolon",
            Self::Tab => "tab",
            Self::Bar => "bar",
        }
    }
}

/// The text of a file, and its encoding in words if it is not plain UTF-8.
pub(super) fn decode(bytes: &[u8], fixed: Option<Encoding>) -> Result<(String, Option<String>), StageError> {
    let marked = |mark: &[u8]| bytes.strip_prefix(mark);
    let (encoding, body, mark) = match (marked(b"\xEF\xBB\xBF"), marked(b"\xFF\xFE"), marked(b"\xFE\xFF")) {
        (Some(body), ..) => (encoding_rs::UTF_8, body, true),
        (_, Some(body), _) => (encoding_rs::UTF_16LE, body, true),
        (.., Some(body)) => (encoding_rs::UTF_16BE, body, true),
        _ if fixed.is_none() && std::str::from_utf8(bytes).is_err() => (encoding_rs::WINDOWS_1252, bytes, false),
        _ => (encoding_rs::UTF_8, bytes, false),
    };
    let asked = match fixed {
        None => encoding,
        Some(Encoding::Utf8) => encoding_rs::UTF_8,
        Some(Encoding::Utf16) if encoding == encoding_rs::UTF_16BE => encoding,
        Some(Encoding::Utf16) => encoding_rs::UTF_16LE,
        Some(Encoding::Windows1252) => encoding_rs::WINDOWS_1252,
    };
    // the mark of another encoding than the setting is read as part of the text, whose letters show the mistake
    let body = if asked == encoding { body } else { bytes };
    let text = asked.decode_without_bom_handling_and_without_replacement(body).ok_or_else(|| {
        StageError::new(format!("the file is not written in {}", asked.name()))
            .hint("encoding = \"utf-8\", \"utf-16\" or \"windows-1252\"; leave the key out to have it detected")
    })?;
    let detected = (fixed.is_none() && (encoding != encoding_rs::UTF_8 || mark))
        .then(|| format!("encoding {}{}", encoding.name(), if mark { " (its mark stands at the start)" } else { "" }));
    Ok((text.into_owned(), detected))
}

/// The lines of a text that are looked at before it is read.
pub(super) const LOOKED_AT: usize = 200;

/// How the lines of a text make a table.
pub(super) struct Layout {
    pub delimiter: Delimiter,
    /// The line of the names, from 1, where it is stated or not the first.
    pub line: Option<usize>,
    /// Whether all lines from that of the names on have the same number of cells, as far as they were looked at.
    pub is_even: bool,
}

/// The delimiter under which all lines from that of the names on have the same number of cells, the greatest such number, and
/// the line of the names; not one under which a quote swallows all lines, or closes before the end of its cell. A delimiter
/// or a line that is stated stays.
pub(super) fn layout(text: &str, fixed: Option<Delimiter>, line: Option<usize>) -> Layout {
    let (body, skipped) = below_comments(text.trim_start_matches('\u{feff}'));
    let score = |delimiter: Delimiter| {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter.byte())
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(body.as_bytes());
        let records: Vec<csv::StringRecord> = reader.records().take(LOOKED_AT).flatten().collect();
        let lines: Vec<Vec<&str>> = records.iter().map(|record| record.iter().collect()).collect();
        let head = if line.is_some() { Some(0) } else { head::find(&lines, is_any_number) };
        let widths: Vec<usize> = lines[head.unwrap_or(0)..].iter().map(Vec::len).collect();
        let first = widths.first().copied().unwrap_or(1);
        let rows = widths.len() > 1 && quotes_fit(body, delimiter.byte());
        let even = first > 1 && rows && widths.iter().all(|w| *w == first);
        let at = head.filter(|head| even && *head > 0).and_then(|head| records[head].position());
        let at = at.map(|at| skipped + line_at(body, at.byte()));
        // where no delimiter gives lines of equal length, the one with most cells in the first line is reported, or that of
        // most lines: a file below a title is no table of one column
        let parted = widths.iter().filter(|width| **width > 1).count() * 2 > widths.len();
        let last = widths.last().filter(|_| parted).copied().unwrap_or(1);
        ((even, even && head == Some(0), first, last), Layout { delimiter, line: line.or(at), is_even: even })
    };
    let all = Delimiter::ALL.into_iter().filter(|delimiter| fixed.is_none_or(|fixed| fixed == *delimiter));
    let best = all.map(score).reduce(|a, b| if b.0 > a.0 { b } else { a });
    best.map_or(Layout { delimiter: Delimiter::Comma, line, is_even: false }, |(_, layout)| layout)
}

/// Whether every quote that opens a cell has a partner, and the cell ends there.
fn quotes_fit(text: &str, delimiter: u8) -> bool {
    let bytes = text.as_bytes();
    let ends = |byte: &u8| *byte == delimiter || matches!(byte, b'\n' | b'\r');
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at] == b'"' {
            // the partner: a quote that is not doubled
            let mut close = at + 1;
            while bytes.get(close..close + 2) == Some(b"\"\"") || bytes.get(close).is_some_and(|byte| *byte != b'"') {
                close += if bytes[close] == b'"' { 2 } else { 1 };
            }
            let Some(rest) = bytes.get(close + 1..) else { return false };
            let blanks = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t') && !ends(byte)).count();
            at = close + 1 + blanks;
            if bytes.get(at).is_some_and(|byte| !ends(byte)) {
                return false;
            }
        }
        at += bytes[at..].iter().position(ends).map_or(bytes.len() - at, |end| end + 1);
    }
    true
}

/// The decimal sign that the cells use.
pub(super) fn decimal<'a>(cells: impl Iterator<Item = &'a str> + Clone) -> Result<Decimal, StageError> {
    let with = |sign: char, other: char| {
        let number = move |cell: &&str| {
            let body = cell.strip_prefix(['-', '+']).unwrap_or(cell);
            !body.contains(other) && body.contains(sign) && is_number(&body.replacen(sign, ".", 1))
        };
        cells.clone().filter(number).collect::<Vec<_>>()
    };
    let (commas, points) = (with(',', '.'), with('.', ','));
    match (commas.first(), points.first()) {
        (None, _) => Ok(Decimal::Point),
        (Some(comma), Some(point)) => Err(StageError::new(format!(
            "`{comma}` has a decimal comma and `{point}` a decimal point; one of them may be a thousands separator"
        ))
        .hint("write all numbers in one way, or say `decimal = \"comma\"` or `decimal = \"point\"`")),
        (Some(first), None) if commas.iter().all(|cell| could_be_thousands(cell)) => Err(StageError::new(format!(
            "`{first}` may be a number with three decimals or one with a thousands separator, and no cell settles it"
        ))
        .hint("say `decimal = \"comma\"` if the comma stands before decimals, and remove thousands separators")),
        (Some(_), None) => Ok(Decimal::Comma),
    }
}

/// Matches `1,234` and `12,345`: one to three digits without a leading zero, then three.
fn could_be_thousands(cell: &str) -> bool {
    let body = cell.strip_prefix(['-', '+']).unwrap_or(cell);
    let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    body.split_once(',').is_some_and(|(before, after)| {
        (1..=3).contains(&before.len())
            && !before.starts_with('0')
            && after.len() == 3
            && digits(before)
            && digits(after)
    })
}

/// Whether a text is a finite number in plain notation.
pub(super) fn is_number(text: &str) -> bool {
    let sane = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    sane && text.parse::<f64>().is_ok_and(|value| value.is_finite() && !vanishes(text, value))
}

/// Whether a text is a number with either decimal sign.
pub(super) fn is_any_number(text: &str) -> bool {
    is_number(&text.replacen(',', ".", 1).replacen('−', "-", 1))
}

/// Whether a text that is no number here is one elsewhere: `inf`, `1e400`, `0x10`, `5%`, digits of other scripts,
/// marks without width.
pub(super) fn is_meant_as_number(text: &str) -> bool {
    let plain: String =
        text.chars().filter(|c| !matches!(c, '\u{200b}'..='\u{200f}' | '\u{2060}' | '\u{feff}')).collect();
    let plain = plain.trim_end_matches(['%', '‰']).trim();
    let wide = |c: char| char::from_u32((c as u32).wrapping_sub(0xff00).wrapping_add(0x20)).filter(char::is_ascii);
    let narrow: String =
        plain.chars().map(|c| if ('！'..='～').contains(&c) { wide(c).unwrap_or(c) } else { c }).collect();
    let hexadecimal = narrow.strip_prefix("0x").or(narrow.strip_prefix("0X"));
    let starts = narrow.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        || narrow.to_lowercase().starts_with("inf");
    starts
        && (narrow.parse::<f64>().is_ok() || hexadecimal.is_some_and(|digits| u64::from_str_radix(digits, 16).is_ok()))
}

/// A text whose first line that is not empty is this one, from 1; the lines keep their numbers.
pub(super) fn from_line(text: &str, line: usize) -> Result<String, StageError> {
    let mut lines = text.split_inclusive('\n').skip(line - 1).peekable();
    if lines.peek().is_none() {
        return Err(no_line(line));
    }
    Ok("\n".repeat(line - 1) + &lines.collect::<String>())
}

/// The fault of a file that ends above the line, from 1, that should name its columns.
pub(super) fn no_line(line: usize) -> StageError {
    StageError::new(format!("the file has no line {line}, in which `first_line` looks for the names"))
        .hint("count the lines from 1")
}

/// The delimiter that a first line `sep=;` states, as Excel writes and reads it, and the lines below it.
pub(super) fn stated(text: &str) -> Option<(Delimiter, &str)> {
    let (first, rest) = text.trim_start_matches('\u{feff}').split_once('\n')?;
    let sign = first.trim_end_matches('\r').strip_prefix("sep=")?;
    let delimiter = Delimiter::ALL.into_iter().find(|delimiter| sign.as_bytes() == [delimiter.byte()])?;
    Some((delimiter, rest))
}

/// The note on how a table was read; `None` for the default. `line` is that of the names, where it is not the first.
pub(super) fn said(
    encoding: Option<String>,
    delimiter: Option<Delimiter>,
    decimal: Option<Decimal>,
    line: Option<usize>,
) -> Option<String> {
    let cells = delimiter.filter(|d| *d != Delimiter::Comma).map(|d| {
        format!(
            "cells parted by {}",
            match d {
                Delimiter::Tab => "tabulators".to_owned(),
                d => format!("{}s `{}`", d.word(), char::from(d.byte())),
            }
        )
    });
    let comma = decimal.filter(|d| *d == Decimal::Comma).map(|_| "decimal commas".to_owned());
    let all: Vec<String> = [encoding, cells, comma, line.map(names_in)].into_iter().flatten().collect();
    let keys = match line {
        Some(_) => "the keys `encoding`, `delimiter`, `decimal` and `first_line` fix it",
        None => "the keys `encoding`, `delimiter` and `decimal` fix it",
    };
    (!all.is_empty()).then(|| format!("detected: {}; {keys}", all.join(", ")))
}

/// The words for a line of names that is not the first.
pub(super) fn names_in(line: usize) -> String {
    format!("names of the columns in line {line}, below titles")
}
