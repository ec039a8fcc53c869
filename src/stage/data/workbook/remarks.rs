//! What a sheet of Excel (xlsx) says of its cells besides their values: those that are shown in per cent hold a share, 0.05
//! for 5 %, and a formula that no spreadsheet program has computed has no value.
//!
//! Source: ECMA-376, part 1, sections 18.8.30 (numFmt; the numbers 9 and 10 are per cent), 18.8.10 (cellXfs), 18.3.1.4 (c),
//! 18.3.1.40 (f).

use super::super::super::StageError;
use super::archive::{Archive, attribute, broken};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeSet;

/// Row and column, from 0.
type Place = (u32, u32);

/// What is said of the cells of a sheet.
#[derive(Default)]
pub(super) struct Remarks {
    /// Cells that are shown in per cent.
    pub shares: BTreeSet<Place>,
    /// The first cell with a formula that was never computed.
    pub uncomputed: Option<Place>,
}

/// The remarks on the cells of this sheet.
///
/// # Errors
/// A part of the workbook is damaged.
pub(super) fn remarks(archive: &mut Archive, sheet: &str) -> Result<Remarks, StageError> {
    let styles = styles(archive)?;
    let mut found = Remarks::default();
    let Some(part) = part_of(archive, sheet)? else { return Ok(found) };
    let Some(part) = archive.part(&part)? else { return Ok(found) };
    let (mut reader, mut buffer) = (Reader::from_reader(part), Vec::new());
    reader.config_mut().expand_empty_elements = true;
    // Rows and cells need not say where they stand: each then follows the one before it.
    let (mut cell, mut next): (Place, Place) = ((0, 0), (0, 0));
    let (mut formula, mut value) = (false, false);
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer).map_err(broken)? {
            Event::Start(element) => match element.local_name().as_ref() {
                "row" => {
                    let stated = attribute(&element, "r").and_then(|row| row.parse::<u32>().ok()?.checked_sub(1));
                    next.0 = stated.unwrap_or(next.0);
                }
                "c" => {
                    let stated = attribute(&element, "r").as_deref().and_then(place);
                    (cell, formula, value) = (stated.unwrap_or(next), false, false);
                    next.1 = cell.1.saturating_add(1);
                    let style = attribute(&element, "s").and_then(|style| style.parse().ok());
                    if style.is_some_and(|style: usize| styles.contains(&style)) {
                        found.shares.insert(cell);
                    }
                }
                "f" => formula = true,
                "v" | "is" => value = true,
                _ => (),
            },
            Event::End(element) => match element.local_name().as_ref() {
                "c" if formula && !value => found.uncomputed = found.uncomputed.or(Some(cell)),
                "row" => next = (next.0.saturating_add(1), 0),
                _ => (),
            },
            Event::Eof => return Ok(found),
            _ => (),
        }
    }
}

/// Calls `each` for every element that starts in a part; a part that is not there has none.
fn elements(archive: &mut Archive, part: &str, mut each: impl FnMut(&BytesStart)) -> Result<(), StageError> {
    let Some(part) = archive.part(part)? else { return Ok(()) };
    let (mut reader, mut buffer) = (Reader::from_reader(part), Vec::new());
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer).map_err(broken)? {
            Event::Start(element) | Event::Empty(element) => each(&element),
            Event::Eof => return Ok(()),
            _ => (),
        }
    }
}

/// Numbers of the styles whose numbers are shown in per cent.
fn styles(archive: &mut Archive) -> Result<BTreeSet<usize>, StageError> {
    let mut formats: BTreeSet<u32> = BTreeSet::from([9, 10]);
    let (mut inside, mut number, mut found) = (false, 0, BTreeSet::new());
    elements(archive, "xl/styles.xml", |element| {
        let id = attribute(element, "numFmtId").and_then(|id| id.parse().ok());
        match element.local_name().as_ref() {
            "numFmt" if attribute(element, "formatCode").is_some_and(|code| is_share(&code)) => formats.extend(id),
            "cellXfs" => inside = true,
            // What follows the styles of cells has such elements, too.
            "cellStyles" | "dxfs" => inside = false,
            "xf" if inside => {
                if id.is_some_and(|id| formats.contains(&id)) {
                    found.insert(number);
                }
                number += 1;
            }
            _ => (),
        }
    })?;
    Ok(found)
}

/// Whether a format has a per cent sign that is no text.
fn is_share(code: &str) -> bool {
    let (mut quoted, mut escaped) = (false, false);
    code.chars().any(|c| {
        let sign = c == '%' && !quoted && !escaped;
        quoted ^= c == '"' && !escaped;
        // A blank as wide as the next character, and that character as often as it fits.
        escaped = matches!(c, '\\' | '_' | '*') && !escaped && !quoted;
        sign
    })
}

/// The part that holds a sheet.
fn part_of(archive: &mut Archive, sheet: &str) -> Result<Option<String>, StageError> {
    let mut id = None;
    elements(archive, "xl/workbook.xml", |element| {
        if element.local_name().as_ref() == "sheet" && attribute(element, "name").as_deref() == Some(sheet) {
            id = attribute(element, "r:id");
        }
    })?;
    id.map_or(Ok(None), |id| target(archive, "xl/_rels/workbook.xml.rels", &id))
}

/// The part that a list of relations names so.
pub(super) fn target(archive: &mut Archive, relations: &str, id: &str) -> Result<Option<String>, StageError> {
    let mut target = None;
    elements(archive, relations, |element| {
        if attribute(element, "Id").as_deref() == Some(id) {
            target = attribute(element, "Target");
        }
    })?;
    Ok(target.map(|target| target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned)))
}

/// Row and column, from 0, of a reference such as `AB12`.
fn place(reference: &str) -> Option<(u32, u32)> {
    let digits = reference.find(|c: char| c.is_ascii_digit())?;
    let (letters, row) = reference.split_at(digits);
    let step = |column: u32, letter: u8| {
        let own = letter.is_ascii_alphabetic().then(|| u32::from(letter.to_ascii_uppercase() - b'A') + 1)?;
        column.checked_mul(26)?.checked_add(own)
    };
    let column = letters.bytes().try_fold(0, step)?.checked_sub(1)?;
    Some((row.parse::<u32>().ok()?.checked_sub(1)?, column))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_and_formats_are_read() {
        assert_eq!(
            [place("A1"), place("ab12"), place("XFD1048576")],
            [Some((0, 0)), Some((11, 27)), Some((1_048_575, 16_383))]
        );
        assert_eq!([place("1"), place("A0"), place("é1"), place("ZZZZZZZZ1")], [None; 4]);
        assert!(is_share("0.0%") && is_share("[Red]0%;-0%"));
        assert!(is_share("\"a_\"0%") && is_share("0_)%") && is_share("* 0%"));
        assert!(!is_share("0.0\"%\"") && !is_share("0\\%") && !is_share("0.00"));
        assert!(!is_share("0.0_%") && !is_share("0*%"));
    }
}
