//! Merged cells of binary workbooks (xlsb), which the reader of their cells passes over.
//!
//! A part is a row of records: a type, the number of its bytes, the bytes. Type and number are written in groups of seven
//! bits, the lowest first; the eighth bit says that another group follows.
//!
//! Source: \[MS-XLSB\], section 2.1.4 (Record), BrtBundleSh (name and part of a sheet), BrtMergeCell.

use super::super::super::StageError;
use super::archive::{Archive, broken};
use super::remarks::target;
use calamine::Dimensions;
use std::io::Read;

const BUNDLE_SHEET: u64 = 156;
const MERGE_CELL: u64 = 176;

/// The merged cells of this sheet; none in a workbook of another format.
///
/// # Errors
/// A part of the workbook is damaged.
pub(super) fn merged(archive: &mut Archive, sheet: &str) -> Result<Vec<Dimensions>, StageError> {
    let mut part = None;
    records(archive, "xl/workbook.bin", |kind, bytes| {
        if kind == BUNDLE_SHEET && name_and_part(bytes).is_some_and(|[_, name]| name == sheet) {
            part = name_and_part(bytes).map(|[part, _]| part);
        }
    })?;
    let Some(part) = part.map(|id| target(archive, "xl/_rels/workbook.bin.rels", &id)).transpose()?.flatten() else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    records(archive, &part, |kind, bytes| {
        if let (MERGE_CELL, [first_row, last_row, first, last]) = (kind, [0, 4, 8, 12].map(|from| number(bytes, from)))
            && let (Some(first_row), Some(last_row), Some(first), Some(last)) = (first_row, last_row, first, last)
        {
            found.push(Dimensions { start: (first_row, first), end: (last_row, last) });
        }
    })?;
    Ok(found)
}

/// Name of the relation of a sheet, and name of the sheet.
fn name_and_part(bytes: &[u8]) -> Option<[String; 2]> {
    let (part, rest) = text(bytes.get(8..)?)?;
    Some([part, text(rest)?.0])
}

/// A text of two bytes a letter, with the number of letters before it, and what follows.
fn text(bytes: &[u8]) -> Option<(String, &[u8])> {
    let (letters, rest) = bytes.get(4..)?.split_at_checked(usize::try_from(number(bytes, 0)?).ok()?.checked_mul(2)?)?;
    let letters: Vec<u16> = letters.as_chunks::<2>().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect();
    Some((String::from_utf16_lossy(&letters), rest))
}

fn number(bytes: &[u8], from: usize) -> Option<u32> {
    bytes.get(from..)?.first_chunk::<4>().map(|bytes| u32::from_le_bytes(*bytes))
}

/// Calls `each` with the type and the bytes of every record of a part; a part that is not there has none.
fn records(archive: &mut Archive, part: &str, mut each: impl FnMut(u64, &[u8])) -> Result<(), StageError> {
    let Some(mut part) = archive.part(part)? else { return Ok(()) };
    let mut bytes = Vec::new();
    part.read_to_end(&mut bytes).map_err(broken)?;
    let mut rest = bytes.as_slice();
    while !rest.is_empty() {
        let record = groups(&mut rest, 2).zip(groups(&mut rest, 4));
        let record = record.and_then(|(kind, length)| Some((kind, rest.split_off(..usize::try_from(length).ok()?)?)));
        let (kind, own) = record.ok_or_else(|| broken("a record of its sheet is longer than the sheet"))?;
        each(kind, own);
    }
    Ok(())
}

/// A number in groups of seven bits, at most so many.
fn groups(bytes: &mut &[u8], most: u32) -> Option<u64> {
    let mut number = 0;
    for group in 0..most {
        let byte = bytes.split_off_first()?;
        number |= u64::from(byte & 0x7f) << (7 * group);
        if byte & 0x80 == 0 {
            break;
        }
    }
    Some(number)
}
