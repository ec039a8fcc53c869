//! Binary workbooks (xlsb).

use super::*;

/// A binary workbook with one sheet: the name `y` in its first row, 2.5 in the second, and these merged cells (first row, last
/// row, first column, last column). Records are written as \[MS-XLSB\] describes them.
fn xlsb_of(merged: &[[u32; 4]]) -> Vec<u8> {
    let numbers = |numbers: &[u32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let text = |text: &str| {
        let letters: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        [numbers(&[text.len() as u32]), letters].concat()
    };
    // Types above 127 take two bytes; all records here are short.
    let record = |kind: u16, bytes: &[u8]| {
        let low = (kind & 0x7f) as u8;
        let kind = if kind < 0x80 { vec![low] } else { vec![low | 0x80, (kind >> 7) as u8] };
        [kind, vec![bytes.len() as u8], bytes.to_vec()].concat()
    };
    let sheet_name = [numbers(&[0, 1]), text("rId1"), text("data")].concat();
    let book = [record(143, &[]), record(156, &sheet_name), record(144, &[]), record(132, &[])].concat();
    let mut sheet = [record(129, &[]), record(148, &numbers(&[0, 1, 0, 0])), record(145, &[])].concat();
    sheet.extend(record(0, &numbers(&[0])));
    sheet.extend(record(6, &[numbers(&[0, 0]), text("y")].concat()));
    sheet.extend(record(0, &numbers(&[1])));
    sheet.extend(record(5, &[numbers(&[0, 0]), 2.5_f64.to_le_bytes().to_vec()].concat()));
    sheet.extend(record(146, &[]));
    sheet.extend(record(177, &numbers(&[merged.len() as u32])));
    merged.iter().for_each(|cells| sheet.extend(record(176, &numbers(cells))));
    sheet.extend([record(178, &[]), record(130, &[])].concat());
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    let worksheet = "http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet";
    let relations = format!(
        "<?xml version=\"1.0\"?><Relationships xmlns=\"{package}\"><Relationship Id=\"rId1\" Type=\"{worksheet}\" \
         Target=\"worksheets/sheet1.bin\"/></Relationships>"
    );
    archive_of(&[
        ("xl/_rels/workbook.bin.rels", relations.into_bytes()),
        ("xl/workbook.bin", book),
        ("xl/worksheets/sheet1.bin", sheet),
    ])
}

#[test]
fn merged_cells_of_binary_workbooks_are_refused() {
    let read = |merged: &[[u32; 4]]| parse(&xlsb_of(merged)).map(|table| table.shown("y").unwrap().0.to_vec());
    assert_eq!(read(&[]), Ok(vec![2.5]));
    assert_eq!(read(&[[5, 6, 0, 0]]), Ok(vec![2.5]), "below the table");
    assert_eq!(
        read(&[[5, 6, 0, 0], [1, 2, 0, 0]]).unwrap_err().message,
        "row 2: cells are merged, and only the first of them holds the value"
    );
    let damaged = |from: usize| {
        let bytes = xlsb_of(&[[1, 2, 0, 0]]);
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
        let mut part = |name: &'static str| {
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut archive.by_name(name).unwrap(), &mut bytes).unwrap();
            (name, bytes)
        };
        let mut parts = ["xl/_rels/workbook.bin.rels", "xl/workbook.bin", "xl/worksheets/sheet1.bin"].map(&mut part);
        let length = parts[2].1.len();
        parts[2].1.truncate(length - from);
        parse(&archive_of(&parts)).map(|table| table.rows()).map_err(|fault| fault.message)
    };
    assert!(damaged(10).unwrap_err().contains("a record of its sheet is longer than the sheet"));
}
