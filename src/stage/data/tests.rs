//! Tables as laboratories and spreadsheets write them.

use super::*;

#[test]
fn units_numbers_and_missing_cells_are_read() {
    let table = parse(b"run,Ec [GPa],remark\n1,20,a\n2,,b\n").unwrap();
    assert_eq!(table.column("Ec").unwrap().unit, "GPa");
    let moduli = table.shown("Ec").unwrap().0;
    assert!(moduli[0] == 20.0 && moduli[1].is_nan());
    assert!(table.shown("remark").is_err());
}

#[test]
fn faults_name_line_or_column() {
    let message = |text: &[u8]| parse(text).unwrap_err().message;
    assert!(message(b"a,b\n1\n").contains("line 2"), "{}", message(b"a,b\n1\n"));
    assert!(message(b"a [MPa\n1\n").contains("brackets"));
    assert!(message(b"a [MPa] x\n1\n").contains("brackets"));
    assert!(message(b"a [ell]\n1\n").contains("`a [ell]`"));
    assert!(message(b"a,a\n1,2\n").contains("name of its own"));
    assert!(message(b"a\n").contains("no rows"));
}

fn read(bytes: &[u8], how: &Dialect) -> (Table, String) {
    let (table, said) = parse_as(bytes, how).unwrap();
    (table, said.unwrap_or_default())
}

fn plain(bytes: &[u8]) -> (Table, String) {
    read(bytes, &Dialect::default())
}

#[test]
fn a_german_file_is_read_and_says_so() {
    let text = "\u{feff}Probe;UCS (MPa);E/GPa;\u{3bd}\r\nA1;35,2;28,75;0,203\r\nA2;n/a;29;0,21\r\n";
    let (table, said) = plain(text.as_bytes());
    assert_eq!(table.column("UCS").unwrap().unit, "MPa");
    let strengths = table.shown("UCS").unwrap().0;
    assert!(strengths[0] == 35.2 && strengths[1].is_nan());
    assert_eq!(table.shown("E").unwrap().0, [28.75, 29.0]);
    assert_eq!(table.shown("\u{3bd}").unwrap().0, [0.203, 0.21]);
    for word in ["UTF-8 (its mark", "semicolons `;`", "decimal commas", "`decimal`"] {
        assert!(said.contains(word), "{said}");
    }
    let how = Dialect { delimiter: Some(Delimiter::Semicolon), decimal: Some(Decimal::Comma), ..Dialect::default() };
    assert!(!read(text.as_bytes(), &how).1.contains("decimal commas"));
}

#[test]
fn plain_files_are_read_without_a_word() {
    assert_eq!(plain(b"a,b\n1,2.5\n3,-1e-3\n").1, "");
    // one column has no delimiter at all
    assert_eq!(plain(b"a\n1\n2\n").0.shown("a").unwrap().0, [1.0, 2.0]);
    // quoted commas are no delimiters of a semicolon file, nor the other way round
    assert_eq!(plain(b"a,b\n\"x; y\",2\n\"u; v\",3\n").0.shown("b").unwrap().0, [2.0, 3.0]);
}

#[test]
fn other_encodings_are_detected() {
    let (table, said) = plain(b"M\xFCller,b\n1,2\n");
    assert_eq!(table.shown("M\u{fc}ller").unwrap().0, [1.0]);
    assert!(said.contains("windows-1252"), "{said}");
    let wide: Vec<u8> =
        [0xFF, 0xFE].into_iter().chain("a\tb\n1\t2\n".encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let (table, said) = plain(&wide);
    assert_eq!(table.shown("b").unwrap().0, [2.0]);
    assert!(said.contains("UTF-16LE") && said.contains("tabulators"), "{said}");
    let fixed = Dialect { encoding: Some(Encoding::Utf8), ..Dialect::default() };
    assert!(parse_as(b"M\xFCller\n1\n", &fixed).unwrap_err().message.contains("not written in UTF-8"));
}

#[test]
fn thousands_separators_are_refused_with_a_reason() {
    let message = |text: &str| parse(text.as_bytes()).unwrap_err().message;
    for text in ["a;b\n1.234,5;1\n", "a;b\n1 234;1\n", "a;b\n1'234;1\n", "a,b\n\"1,234.5\",1\n"] {
        assert!(message(text).contains("thousands separator"), "{text}: {}", message(text));
    }
    // 1,234 alone may be either
    assert!(message("a;b\n1,234;1\n").contains("no cell settles it"));
    assert!(message("a;b\n1,5;2.5\n").contains("decimal comma and `2.5`"));
    let how = Dialect { decimal: Some(Decimal::Comma), ..Dialect::default() };
    assert_eq!(read(b"a;b\n1,234;1\n", &how).0.shown("a").unwrap().0, [1.234]);
}

#[test]
fn missing_values_have_words() {
    let column = |how: &Dialect| read(b"a,b\n1,x\n-,x\nNA,x\n", how).0.shown("a").unwrap().0;
    let usual = column(&Dialect::default());
    assert!(usual[0] == 1.0 && usual[1].is_nan() && usual[2].is_nan());
    let own = Dialect { missing: Some(vec!["failed".into()]), ..Dialect::default() };
    assert!(read(b"a\nfailed\n2\n", &own).0.shown("a").unwrap().0[0].is_nan());
    assert!(read(b"a\n-\n2\n", &own).0.shown("a").is_err());
    let message = parse(b"UCS [MPa]\n30\nbroken\n").unwrap_err().message;
    assert_eq!(message, "row 2: `UCS` [MPa] is `broken`, which is no number");
    // categories stay words
    assert!(parse(b"cement\nCEM I\nslag\n").unwrap().shown("cement").is_err());
}

#[test]
fn workbooks_are_read_by_sheet() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/data/");
    for file in ["runs.xlsx", "runs.ods"] {
        let bytes = std::fs::read(format!("{folder}{file}")).unwrap();
        let fault = parse(&bytes).unwrap_err();
        assert!(fault.message.contains("several sheets"), "{}", fault.message);
        let how = Dialect { sheet: Some("cylinders".into()), ..Dialect::default() };
        let (table, said) = read(&bytes, &how);
        assert_eq!(said, "");
        assert_eq!(table.shown("UCS").unwrap().0[..2], [35.25, 30.125], "{file}");
        assert!(table.shown("UCS").unwrap().0[2].is_nan());
        assert_eq!(table.column("E").unwrap().unit, "GPa");
        let wrong = Dialect { sheet: Some("cubes".into()), ..Dialect::default() };
        assert!(parse_as(&bytes, &wrong).unwrap_err().message.contains("no sheet `cubes`"));
    }
}

/// The check sum of archives (CRC-32, ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| bit(crc)))
}

/// A workbook with one sheet of these cells, as an archive without compression.
fn workbook_of(sheet: &str) -> Vec<u8> {
    let types = "application/vnd.openxmlformats-officedocument.spreadsheetml";
    let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let package = "http://schemas.openxmlformats.org/package/2006";
    let files = [
        (
            "[Content_Types].xml",
            format!(
                "<Types xmlns=\"{package}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
                 <Override PartName=\"/xl/workbook.xml\" ContentType=\"{types}.sheet.main+xml\"/>\
                 <Override PartName=\"/xl/worksheets/sheet1.xml\" ContentType=\"{types}.worksheet+xml\"/></Types>"
            ),
        ),
        (
            "_rels/.rels",
            format!(
                "<Relationships xmlns=\"{package}/relationships\"><Relationship Id=\"r1\" Type=\"{relations}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml",
            format!(
                "<workbook xmlns=\"{main}\" xmlns:r=\"{relations}\"><sheets><sheet name=\"a\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            format!(
                "<Relationships xmlns=\"{package}/relationships\"><Relationship Id=\"r1\" Type=\"{relations}/worksheet\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
            ),
        ),
        ("xl/worksheets/sheet1.xml", format!("<worksheet xmlns=\"{main}\"><sheetData>{sheet}</sheetData></worksheet>")),
    ];
    let (mut bytes, mut list, count) = (Vec::new(), Vec::new(), files.len() as u16);
    for (name, text) in files {
        let at = bytes.len() as u32;
        let sizes = [crc(text.as_bytes()), text.len() as u32, text.len() as u32];
        let mut common = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        sizes.iter().for_each(|size| common.extend(size.to_le_bytes()));
        common.extend((name.len() as u32).to_le_bytes());
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&common);
        bytes.extend(name.bytes().chain(text.bytes()));
        list.extend(b"PK\x01\x02\x14\0");
        list.extend(&common);
        list.extend([0; 10]);
        list.extend(at.to_le_bytes());
        list.extend(name.bytes());
    }
    let (start, length) = (bytes.len() as u32, list.len() as u32);
    bytes.extend(list);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    [count, count].iter().for_each(|count| bytes.extend(count.to_le_bytes()));
    [length, start].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes.extend([0, 0]);
    bytes
}

/// A sheet is as large as the place of its last cell says: one in the last corner would take 512 GB.
#[test]
fn a_cell_far_out_costs_no_memory() {
    let text = |place: &str, text: &str| format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>");
    let number = |place: &str| format!("<c r=\"{place}\"><v>1.5</v></c>");
    let head = format!("<row r=\"1\">{}{}</row>", text("A1", "a"), text("B1", "y"));
    let line = format!("<row r=\"2\">{}{}</row>", number("A2"), number("B2"));
    let table = parse(&workbook_of(&format!("{head}{line}"))).unwrap();
    assert_eq!(table.columns[1].values, Values::Reals(vec![1.5]));
    let far = format!("{head}{line}<row r=\"1048576\">{}</row>", number("XFD1048576"));
    assert!(parse(&workbook_of(&far)).unwrap_err().message.contains("every column needs a name of its own"));
    let beyond = format!("{head}<row r=\"2\">{}</row>", number("ZZZZZ2"));
    assert!(parse(&workbook_of(&beyond)).unwrap_err().message.contains("has a cell in column"));
    let below = format!("{head}{line}<row r=\"4000000\">{}</row>", number("A4000000"));
    assert_eq!(parse(&workbook_of(&below)).unwrap().rows(), 2);
}
