//! Old workbooks of Excel (xls): records in a stream of a compound file, judged before they are read.
//!
//! The reader of these files makes room for the rectangle that the cells of a sheet span, and for the one that the sheet
//! announces: two cells in opposite corners, or a last row before the first, would take more memory than there is. So the
//! stream is taken out of its sectors, its records are walked as that reader walks them, and it is given a file that holds
//! this stream and nothing else.
//!
//! Source of the records: Microsoft, \[MS-XLS\], sections 2.4.21 (BOF), 2.4.28 (BoundSheet8), 2.4.90 (Dimensions), 2.4.103 (EOF).

use super::super::super::StageError;
use super::archive::broken;
use cfb::{CompoundFile, Version};
use std::io::{Cursor, Read, Write};

/// Names of the stream that holds the records.
const STREAMS: [&str; 2] = ["/Workbook", "/Book"];

const BEGIN: u16 = 0x0809;
const END: u16 = 0x000A;
const SHEET: u16 = 0x0085;
const DIMENSIONS: u16 = 0x0200;
/// Cells of one column: number, label, rich label, truth or error, RK number, text of the list, formula.
const ONE_CELL: [u16; 7] = [0x0203, 0x0204, 0x00D6, 0x0205, 0x027E, 0x00FD, 0x0006];
/// Cells of several columns.
const MANY_CELLS: u16 = 0x00BD;

/// Rows and columns of such a sheet.
const MOST: [u64; 2] = [1 << 16, 1 << 8];
/// Most cells of all rectangles together.
const MOST_CELLS: u64 = 1 << 22;
const MOST_SHEETS: usize = 1000;
/// Most records that are walked: sheets may lie on one another.
const MOST_RECORDS: usize = 1 << 23;

/// A workbook of the same records whose size was found to be one that can be read.
///
/// # Errors
/// It is damaged, or its cells or what it says of them would need more memory than a table does.
pub(super) fn judged(bytes: &[u8]) -> Result<Vec<u8>, StageError> {
    let mut file = CompoundFile::open(Cursor::new(bytes)).map_err(broken)?;
    let name = STREAMS.into_iter().find(|name| file.is_stream(name)).ok_or_else(|| broken("it holds no sheets"))?;
    let mut records = Vec::new();
    let stream = file.open_stream(name).map_err(broken)?;
    stream.take(bytes.len() as u64).read_to_end(&mut records).map_err(broken)?;
    judge(&records)?;
    let mut made = CompoundFile::create_with_version(Version::V3, Cursor::new(Vec::new())).map_err(broken)?;
    made.create_stream(name).and_then(|mut stream| stream.write_all(&records)).map_err(broken)?;
    made.flush().map_err(broken)?;
    Ok(made.into_inner().into_inner())
}

/// Kind and content of the records that are whole.
fn records(mut rest: &[u8]) -> impl Iterator<Item = (u16, &[u8])> {
    std::iter::from_fn(move || {
        let kind = short(rest, 0)?;
        let length = usize::from(short(rest, 2)?);
        let content = rest.get(4..4 + length)?;
        rest = &rest[4 + length..];
        Some((kind, content))
    })
}

fn short(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn judge(stream: &[u8]) -> Result<(), StageError> {
    let globals = records(stream).take_while(|(kind, _)| *kind != END);
    let sheets: Vec<usize> = globals
        .filter(|(kind, _)| *kind == SHEET)
        .filter_map(|(_, content)| Some(long(content, 0)? as usize))
        .collect();
    if sheets.len() > MOST_SHEETS {
        return Err(broken(format!("it has {} sheets", sheets.len())));
    }
    let (mut walked, mut cells) = (0, 0);
    for at in sheets {
        let sheet = stream.get(at..).ok_or_else(|| broken("a sheet lies beyond its end"))?;
        cells += rectangle(sheet, &mut walked)?;
        if cells > MOST_CELLS {
            return Err(broken(format!("its cells span more than {MOST_CELLS} cells")));
        }
    }
    Ok(())
}

/// Cells of the rectangle that those of a sheet span.
fn rectangle(sheet: &[u8], walked: &mut usize) -> Result<u64, StageError> {
    let mut span: Option<[[u64; 2]; 2]> = None;
    // Charts within the sheet have cells of their own, which are not read.
    let (mut begun, mut within) = (false, 0_usize);
    for (kind, content) in records(sheet) {
        *walked += 1;
        if *walked > MOST_RECORDS {
            return Err(broken(format!("it has more than {MOST_RECORDS} records")));
        }
        match kind {
            BEGIN if begun => within += 1,
            BEGIN => begun = true,
            END if within > 0 => within -= 1,
            END => break,
            _ if within > 0 => {}
            DIMENSIONS => announced(content)?,
            _ => {
                let Some([row, first, last]) = cells(kind, content) else { continue };
                if last >= MOST[1] {
                    return Err(broken(format!("it has a cell in column {}", last + 1)));
                }
                let [rows, columns] = span.unwrap_or([[row; 2], [first, last]]);
                span = Some([[rows[0].min(row), rows[1].max(row)], [columns[0].min(first), columns[1].max(last)]]);
            }
        }
    }
    Ok(span.map_or(0, |[rows, columns]| (rows[1] - rows[0] + 1) * (columns[1] - columns[0] + 1)))
}

/// Row, first and last column of a record of cells.
fn cells(kind: u16, content: &[u8]) -> Option<[u64; 3]> {
    let (row, first) = (u64::from(short(content, 0)?), u64::from(short(content, 2)?));
    if ONE_CELL.contains(&kind) {
        return Some([row, first, first]);
    }
    // Row, first column, six bytes for each cell, last column.
    let count = content.len().saturating_sub(6) as u64 / 6;
    let said = u64::from(short(content, content.len() - 2)?);
    (kind == MANY_CELLS).then(|| [row, first, said.max(first + count)])
}

/// The rectangle that a sheet announces, as the reader takes it: the ends are those after the last row and column.
fn announced(content: &[u8]) -> Result<(), StageError> {
    let wide = content.len() != 10;
    let row =
        |at: usize| if wide { long(content, 4 * at).map(u64::from) } else { short(content, 2 * at).map(u64::from) };
    let column = |at: usize| short(content, if wide { 8 } else { 4 } + 2 * at).map(u64::from);
    let (Some(top), Some(bottom), Some(left), Some(right)) = (row(0), row(1), column(0), column(1)) else {
        return Ok(());
    };
    let left = if left >= MOST[1] || right < left { 0 } else { left };
    if bottom == 0 || right == 0 {
        return Ok(());
    }
    let (rows, columns) = (bottom.checked_sub(top), right.checked_sub(left));
    match (rows, columns) {
        (Some(rows), Some(columns)) if rows <= MOST[0] && columns <= MOST[1] => Ok(()),
        _ => Err(broken(format!(
            "it says that a sheet has the rows {top} to {bottom} and the columns {left} to {right}"
        ))),
    }
}

#[cfg(test)]
mod tests;
