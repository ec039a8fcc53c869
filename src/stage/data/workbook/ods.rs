//! Workbooks of LibreOffice (ods): the cells of one sheet, as they are read.
//!
//! A row or a cell may say that it repeats, a thousand times or 10⁹ times; sheets that were formatted to the last corner do.
//! So repeated cells that are empty are counted and not made, and those that hold something are added one by one to what
//! refuses a table beyond its bounds.
//!
//! Source: OASIS Open Document Format 1.3, part 3, sections 9.1 (tables), 19.385 (types of values).

use super::super::super::StageError;
use super::archive::{Archive, attribute, broken};
use super::{Cell, clock};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::{BufRead, Read};

/// Most characters of one cell.
const MOST_CHARACTERS: usize = 1 << 15;

/// Whether an archive says that it is such a workbook.
///
/// # Errors
/// The archive is damaged.
pub(super) fn is_ods(archive: &mut Archive) -> Result<bool, StageError> {
    let Some(mut part) = archive.part("mimetype")? else { return Ok(false) };
    let mut head = String::new();
    let read = part.by_ref().take(100).read_to_string(&mut head);
    Ok(read.is_ok() && head.starts_with("application/vnd.oasis.opendocument.spreadsheet"))
}

/// What is read of a cell, or the error that its formula came to.
type Value = Result<Cell, String>;

/// The names of the sheets, in their order.
///
/// # Errors
/// The workbook is damaged or locked with a password.
pub(super) fn names(archive: &mut Archive) -> Result<Vec<String>, StageError> {
    let mut names = Vec::new();
    let mut walk = Walk::open(archive)?;
    while let Some(name) = walk.next_sheet()? {
        names.push(name);
    }
    Ok(names)
}

/// Hands every cell of a sheet that holds something to `add`, with its row and column from 0.
///
/// # Errors
/// The workbook is damaged, a cell is larger than is read, or what `add` refuses.
pub(super) fn cells(
    archive: &mut Archive,
    sheet: &str,
    mut add: impl FnMut(u32, u32, &Value) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let mut walk = Walk::open(archive)?;
    while walk.next_sheet()?.is_some_and(|name| name != sheet) {}
    let mut row = 0_u32;
    while let Some(repeats) = walk.next_row()? {
        let cells = walk.row()?;
        let filled = cells.iter().any(|(_, _, value)| !is_empty(value));
        for copy in 0..if filled { repeats } else { 0 } {
            for (column, repeats, value) in cells.iter().filter(|(_, _, value)| !is_empty(value)) {
                for along in 0..*repeats {
                    add(row.saturating_add(copy), column.saturating_add(along), value)?;
                }
            }
        }
        row = row.saturating_add(repeats);
    }
    Ok(())
}

fn is_empty(value: &Value) -> bool {
    value.as_ref().is_ok_and(|cell| cell.text.trim().is_empty())
}

/// A walk through `content.xml`.
struct Walk<R> {
    reader: Reader<R>,
    buffer: Vec<u8>,
}

/// What a walk stops at.
enum At {
    /// The start of an element.
    Start(BytesStart<'static>),
    /// The end of an element of this name.
    End(String),
    /// Text.
    Text(String),
    /// The end of the file.
    Nothing,
}

impl<'a> Walk<Box<dyn BufRead + 'a>> {
    fn open(archive: &'a mut Archive) -> Result<Self, StageError> {
        let mut manifest = String::new();
        if let Some(mut part) = archive.part("META-INF/manifest.xml")? {
            part.read_to_string(&mut manifest).map_err(broken)?;
        }
        if manifest.contains("encryption-data") {
            return Err(StageError::new("the workbook is locked with a password").hint("save it without one"));
        }
        let content = archive.part("content.xml")?.ok_or_else(|| broken("it has no part content.xml"))?;
        let mut reader = Reader::from_reader(Box::new(content) as Box<dyn BufRead + 'a>);
        reader.config_mut().expand_empty_elements = true;
        Ok(Self { reader, buffer: Vec::new() })
    }
}

impl<R: BufRead> Walk<R> {
    fn step(&mut self) -> Result<At, StageError> {
        loop {
            self.buffer.clear();
            return Ok(match self.reader.read_event_into(&mut self.buffer).map_err(broken)? {
                Event::Start(e) => At::Start(e.into_owned()),
                Event::End(e) => At::End(e.name().as_ref().to_owned()),
                Event::Text(text) => At::Text(text.xml10_content().into_owned()),
                Event::CData(text) => At::Text(text.xml10_content().into_owned()),
                Event::GeneralRef(name) => {
                    let sign = name.resolve_char_ref().map_err(broken)?.map(String::from);
                    let named = || quick_xml::escape::resolve_xml_entity(name.as_ref()).map(str::to_owned);
                    At::Text(sign.or_else(named).ok_or_else(|| broken("it names a character that is unknown"))?)
                }
                Event::Eof => At::Nothing,
                _ => continue,
            });
        }
    }

    /// The same within an element, which a file that is cut off does not end.
    fn within(&mut self) -> Result<At, StageError> {
        match self.step()? {
            At::Nothing => Err(broken("its content ends within a sheet")),
            at => Ok(at),
        }
    }

    /// The name of the next sheet; the walk then stands in it.
    fn next_sheet(&mut self) -> Result<Option<String>, StageError> {
        // Tables in cells of a sheet are no sheets.
        let mut depth = 0_u32;
        loop {
            match self.step()? {
                At::Nothing => return Ok(None),
                At::Start(e) if is(&e, "table:table-cell") => depth += 1,
                At::End(name) if name == "table:table-cell" => depth = depth.saturating_sub(1),
                At::Start(e) if is(&e, "table:table") && depth == 0 => {
                    if let Some(name) = attribute(&e, "table:name") {
                        return Ok(Some(name));
                    }
                }
                _ => (),
            }
        }
    }

    /// How often the next row of this sheet stands there; `None` at the end of the sheet.
    fn next_row(&mut self) -> Result<Option<u32>, StageError> {
        loop {
            match self.within()? {
                At::Start(e) if is(&e, "table:table-row") => {
                    return number(&e, "table:number-rows-repeated").map(Some);
                }
                At::End(name) if name == "table:table" => return Ok(None),
                _ => (),
            }
        }
    }

    /// The cells of this row: column, how often it stands there, value.
    fn row(&mut self) -> Result<Vec<(u32, u32, Value)>, StageError> {
        let (mut cells, mut column) = (Vec::new(), 0_u32);
        loop {
            match self.within()? {
                At::Start(e) if is(&e, "table:table-cell") || is(&e, "table:covered-table-cell") => {
                    let count = number(&e, "table:number-columns-repeated")?;
                    let value = self.cell(&e)?;
                    if !is_empty(&value) {
                        cells.push((column, count, value));
                    }
                    column = column.saturating_add(count);
                }
                At::End(name) if name == "table:table-row" => return Ok(cells),
                _ => (),
            }
        }
    }

    /// The value of a cell; the walk then stands behind it.
    fn cell(&mut self, cell: &BytesStart) -> Result<Value, StageError> {
        let content = self.content(cell.name().as_ref())?;
        let kind = attribute(cell, "office:value-type").unwrap_or_default();
        let own = |name: &str| attribute(cell, name);
        if own("calcext:value-type").is_some_and(|kind| kind == "error") {
            return Ok(Err(content));
        }
        let text = match kind.as_str() {
            "float" | "percentage" | "currency" => {
                let value = own("office:value").unwrap_or(content);
                value.parse::<f64>().map(|value| value.to_string()).unwrap_or(value)
            }
            "boolean" => own("office:boolean-value").unwrap_or(content).to_ascii_lowercase(),
            "date" => own("office:date-value").unwrap_or(content),
            "time" => own("office:time-value").map(|time| seconds(&time).map(clock).unwrap_or(time)).unwrap_or(content),
            "string" => own("office:string-value").unwrap_or(content),
            _ => String::new(),
        };
        let spans = |name: &str| number(cell, name).map(|count| count > 1);
        Ok(Ok(Cell {
            text: text.trim().to_owned(),
            is_word: kind == "string",
            is_share: kind == "percentage",
            is_merged: spans("table:number-columns-spanned")? || spans("table:number-rows-spanned")?,
        }))
    }

    /// The paragraphs of a cell, without what is drawn in it or remarked on it.
    fn content(&mut self, name: &str) -> Result<String, StageError> {
        let (mut text, mut paragraphs) = (String::new(), 0);
        loop {
            match self.within()? {
                At::End(end) if end == name => return Ok(text),
                At::Start(e) if is(&e, "text:p") => {
                    text.push_str(if paragraphs > 0 { "\n" } else { "" });
                    paragraphs += 1;
                }
                At::Start(e) if is(&e, "text:s") => {
                    let count = number(&e, "text:c")? as usize;
                    text.extend(std::iter::repeat_n(' ', count.min(MOST_CHARACTERS + 1)));
                }
                At::Start(e) if is(&e, "text:tab") => text.push('\t'),
                At::Start(e) if is(&e, "text:line-break") => text.push('\n'),
                At::Start(e) if ["office:annotation", "table:table"].iter().any(|name| is(&e, name)) => {
                    self.skip(e.name().as_ref())?;
                }
                At::Start(e) if e.name().as_ref().starts_with("draw:") => self.skip(e.name().as_ref())?,
                At::Text(part) if paragraphs > 0 => text.push_str(&part),
                _ => (),
            }
            if text.len() > MOST_CHARACTERS {
                let message = format!("the workbook has a cell of more than {MOST_CHARACTERS} characters");
                return Err(StageError::new(message).hint("no table of values has one; empty the cell"));
            }
        }
    }

    /// Passes over an element and all in it.
    fn skip(&mut self, name: &str) -> Result<(), StageError> {
        let mut depth = 1_u32;
        while depth > 0 {
            match self.within()? {
                At::Start(e) if is(&e, name) => depth += 1,
                At::End(end) if end == name => depth -= 1,
                _ => (),
            }
        }
        Ok(())
    }
}

/// The seconds of a time such as `PT12H30M05.5S`.
fn seconds(time: &str) -> Option<f64> {
    let (sign, rest) = time.strip_prefix('-').map_or((1.0, time), |rest| (-1.0, rest));
    let mut rest = rest.strip_prefix("PT")?;
    let mut sum = 0.0;
    for (unit, seconds) in [('H', 3600.0), ('M', 60.0), ('S', 1.0)] {
        if let Some((number, behind)) = rest.split_once(unit) {
            sum += number.parse::<f64>().ok()? * seconds;
            rest = behind;
        }
    }
    rest.is_empty().then_some(sign * sum)
}

fn is(element: &BytesStart, name: &str) -> bool {
    element.name().as_ref() == name
}

/// A number that an element states, such as how often it stands there: 1 where it does not say.
fn number(element: &BytesStart, name: &str) -> Result<u32, StageError> {
    let Some(text) = attribute(element, name) else { return Ok(1) };
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    if !digits {
        return Err(broken(format!("{name} is `{text}`")));
    }
    // What is beyond any sheet is refused where it holds something.
    Ok(text.parse().unwrap_or(u32::MAX))
}
