//! Workbooks of Excel and LibreOffice.

use super::*;
use std::io::Write;

mod binary;

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

#[test]
fn numbers_that_a_sheet_holds_as_text_have_one_decimal_sign() {
    let sheet = |cells: &[&str]| {
        let cell = |n: usize, text: &str| {
            format!(
                "<row r=\"{n}\"><c r=\"A{n}\" t=\"inlineStr\"><is><t>{text}</t></is></c><c r=\"B{n}\"><v>1.5</v></c></row>"
            )
        };
        let head = "<row r=\"1\"><c r=\"A1\" t=\"inlineStr\"><is><t>y</t></is></c><c r=\"B1\" t=\"inlineStr\"><is><t>z</t></is></c></row>";
        let rows: String = cells.iter().enumerate().map(|(i, text)| cell(i + 2, text)).collect();
        workbook_of(&format!("{head}{rows}"), None)
    };
    let (table, said) = read(&sheet(&["12,5", "13"]), &Dialect::default());
    assert_eq!((table.shown("y").unwrap().0, table.shown("z").unwrap().0), (vec![12.5, 13.0], vec![1.5, 1.5]));
    assert_eq!(said, "detected: decimal commas in cells that hold text; the key `decimal` fixes it");
    let message = |cells: &[&str], how: &Dialect| parse_as(&sheet(cells), how).unwrap_err().message;
    assert!(message(&["12,5", "13.5"], &Dialect::default()).contains("decimal comma and `13.5` a decimal point"));
    assert!(message(&["1,234"], &Dialect::default()).contains("no cell settles it"));
    let comma = Dialect { decimal: Some(Decimal::Comma), ..Dialect::default() };
    assert!(message(&["1.234"], &comma).contains("a text with a point"));
    assert_eq!(read(&sheet(&["1,234"]), &comma).0.shown("y").unwrap().0, [1.234]);
    let tab = Dialect { delimiter: Some(Delimiter::Tab), ..Dialect::default() };
    assert_eq!(message(&["1"], &tab), "`delimiter` has no effect on a workbook");
}

/// An archive of these parts.
fn archive_of<T: AsRef<[u8]>>(parts: &[(&str, T)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in parts {
        let how = if *name == "mimetype" { zip::CompressionMethod::Stored } else { zip::CompressionMethod::Deflated };
        archive.start_file(*name, zip::write::SimpleFileOptions::default().compression_method(how)).unwrap();
        archive.write_all(text.as_ref()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A workbook of Excel with one sheet of these rows, and the list of texts where there is one; the style 1 is per cent.
fn workbook_of(sheet: &str, texts: Option<&str>) -> Vec<u8> {
    let types = "application/vnd.openxmlformats-officedocument.spreadsheetml";
    let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let package = "http://schemas.openxmlformats.org/package/2006";
    let mut files = vec![
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
    let styles = "<cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"9\"/></cellXfs>";
    files.push(("xl/styles.xml", format!("<styleSheet xmlns=\"{main}\">{styles}</styleSheet>")));
    files.extend(texts.map(|texts| ("xl/sharedStrings.xml", texts.to_owned())));
    let parts: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    archive_of(&parts)
}

fn excel_text(place: &str, text: &str) -> String {
    format!("<c{place} t=\"inlineStr\"><is><t>{text}</t></is></c>")
}

/// A title stands in A1, and the table in B3:C4.
#[test]
fn a_title_beside_the_columns_is_no_column() {
    let head = [(" r=\"B3\"", "x"), (" r=\"C3\"", "y")].map(|(place, name)| excel_text(place, name)).concat();
    let bytes = workbook_of(
        &format!(
            "<row r=\"1\">{}</row><row r=\"3\">{head}</row>\
             <row r=\"4\"><c r=\"B4\"><v>1</v></c><c r=\"C4\"><v>2</v></c></row>",
            excel_text(" r=\"A1\"", "Report 12")
        ),
        None,
    );
    let from = |line| parse_as(&bytes, &Dialect { first_line: line, ..Dialect::default() });
    for (line, said) in [(Some(3), None), (None, Some("line 3, below titles; the key `first_line` fixes it"))] {
        let Read { table, said: detected, .. } = from(line).unwrap();
        assert_eq!((table.shown("x").unwrap().0, table.shown("y").unwrap().0), (vec![1.0], vec![2.0]));
        assert_eq!(table.columns.len(), 2);
        assert!(said.is_none_or(|said| detected.is_some_and(|detected| detected.ends_with(said))));
    }
    for line in [5, (1 << 32) + 1, usize::MAX] {
        let message = format!("the file has no line {line}, in which `first_line` looks for the names");
        assert_eq!(from(Some(line)).unwrap_err().message, message);
    }
}

/// Rows and cells of Excel may leave out where they stand; some programs write none of it.
#[test]
fn cells_without_a_reference_follow_one_another() {
    let sheet = |[head, x, y]: [&str; 3], inside: &str| {
        let heads = [excel_text(head, "x [%]"), excel_text("", "y")].concat();
        workbook_of(
            &format!("<row>{heads}</row><row/><row><c{x} s=\"1\"><v>0.07</v></c><c{y}>{inside}</c></row>"),
            None,
        )
    };
    for places in [["", "", ""], [" r=\"C1\"", " r=\"C3\"", ""], ["", " r=\"A3\"", " r=\"B3\""], ["", " r=\"a3\"", ""]]
    {
        let table = parse(&sheet(places, "<v>0.5</v>")).unwrap();
        assert_eq!((table.shown("x").unwrap().0, table.shown("y").unwrap().0), (vec![7.0], vec![0.5]), "{places:?}");
        let fault = parse(&sheet(places, "<f>1+1</f>")).unwrap_err();
        assert_eq!(fault.message, "sheet `a`, row 3: a cell holds a formula that was never computed", "{places:?}");
    }
}

/// A sheet is as large as the place of its last cell says: one in the last corner would take 512 GB.
#[test]
fn a_cell_far_out_costs_no_memory() {
    let text = |place: &str, text: &str| format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>");
    let number = |place: &str| format!("<c r=\"{place}\"><v>1.5</v></c>");
    let head = format!("<row r=\"1\">{}{}</row>", text("A1", "a"), text("B1", "y"));
    let line = format!("<row r=\"2\">{}{}</row>", number("A2"), number("B2"));
    let table = parse(&workbook_of(&format!("{head}{line}"), None)).unwrap();
    assert_eq!(table.columns[1].values, Values::Reals(vec![1.5]));
    let far = format!("{head}{line}<row r=\"1048576\">{}</row>", number("XFD1048576"));
    assert!(parse(&workbook_of(&far, None)).unwrap_err().message.contains("every column needs a name of its own"));
    let beyond = format!("{head}<row r=\"2\">{}</row>", number("ZZZZZ2"));
    assert!(parse(&workbook_of(&beyond, None)).unwrap_err().message.contains("has a cell in column"));
    let below = format!("{head}{line}<row r=\"4000000\">{}</row>", number("A4000000"));
    assert_eq!(parse(&workbook_of(&below, None)).unwrap().rows(), 2);
}

/// A workbook of LibreOffice with one sheet of these rows.
fn ods_of(rows: &str) -> Vec<u8> {
    let content = format!(
        "<office:document-content><office:body><office:spreadsheet><table:table table:name=\"a\">{rows}</table:table>\
         </office:spreadsheet></office:body></office:document-content>"
    );
    archive_of(&[("mimetype", "application/vnd.oasis.opendocument.spreadsheet"), ("content.xml", &content)])
}

const HEAD: &str = "<table:table-row><table:table-cell office:value-type=\"string\"><text:p>y</text:p></table:table-cell></table:table-row>";

fn ods_cell(attributes: &str, inside: &str) -> String {
    format!("<table:table-cell {attributes}>{inside}</table:table-cell>")
}

/// What LibreOffice writes below and beside a table that was formatted to the last corner, and repeated cells that hold
/// something.
#[test]
fn repeated_cells_cost_what_they_hold() {
    let number = ods_cell("office:value-type=\"float\" office:value=\"1.5\"", "<text:p>1,50</text:p>");
    let row = |attributes: &str, cells: &str| format!("<table:table-row {attributes}>{cells}</table:table-row>");
    let empty = "<table:table-cell table:number-columns-repeated=\"16384\"/>";
    let thrice = row("table:number-rows-repeated=\"3\"", &format!("{number}{empty}"));
    let below = row("table:number-rows-repeated=\"1048571\"", empty);
    let table = parse(&ods_of(&format!("{HEAD}{thrice}{below}"))).unwrap();
    assert_eq!(table.columns[0].values, Values::Reals(vec![1.5; 3]));

    let message = |rows: String| parse(&ods_of(&rows)).unwrap_err().message;
    for count in ["2000000", "4294967295", "99999999999999999999"] {
        let many = row(&format!("table:number-rows-repeated=\"{count}\""), &number);
        assert!(message(format!("{HEAD}{many}")).contains("the sheet has more than"), "{count}");
        let wide = number.replace("table-cell ", &format!("table-cell table:number-columns-repeated=\"{count}\" "));
        assert!(message(format!("{HEAD}{}", row("", &wide))).contains("has a cell in column"), "{count}");
        let blanks =
            ods_cell("office:value-type=\"string\"", &format!("<text:p>a<text:s text:c=\"{count}\"/></text:p>"));
        assert!(message(format!("{HEAD}{}", row("", &blanks))).contains("more than 32768 characters"), "{count}");
    }
    assert!(message(format!("{HEAD}{}", row("table:number-rows-repeated=\"-1\"", &number))).contains("is `-1`"));
    // far below and far to the right
    let far = format!("{HEAD}{thrice}{below}{}", row("", &format!("{empty}{number}")));
    assert!(message(far).contains("has a cell in column"));
}

#[test]
fn cells_of_libreoffice_are_read_as_they_stand() {
    let cells = [
        ods_cell("office:value-type=\"percentage\" office:value=\"0.125\"", "<text:p>12,5 %</text:p>"),
        ods_cell("office:value-type=\"date\" office:date-value=\"2024-05-01\"", "<text:p>1. Mai</text:p>"),
        ods_cell("office:value-type=\"boolean\" office:boolean-value=\"true\"", "<text:p>WAHR</text:p>"),
        ods_cell("office:value-type=\"string\"", "<text:p>a &amp; <text:span>b</text:span></text:p><text:p>c</text:p>"),
        ods_cell(
            "office:value-type=\"float\" office:value=\"7\"",
            "<office:annotation><text:p>remark</text:p></office:annotation><text:p>7</text:p>",
        ),
    ];
    let heads: String =
        (0..5).map(|n| ods_cell("office:value-type=\"string\"", &format!("<text:p>c{n}</text:p>"))).collect();
    let rows = format!(
        "<table:table-header-rows><table:table-row>{heads}</table:table-row></table:table-header-rows>\
         <table:table-row>{}</table:table-row>",
        cells.concat()
    );
    let table = parse(&ods_of(&rows)).unwrap();
    let texts = |index: usize| match &table.columns[index].values {
        Values::Texts(texts) => texts[0].clone(),
        other => format!("{other:?}"),
    };
    assert_eq!([texts(1), texts(2), texts(3)], ["2024-05-01", "true", "a & b\nc"]);
    assert_eq!([table.shown("c0").unwrap().0, table.shown("c4").unwrap().0], [[0.125], [7.0]]);
    let error = ods_cell("office:value-type=\"string\" calcext:value-type=\"error\"", "<text:p>#DIV/0!</text:p>");
    let fault = parse(&ods_of(&format!("{HEAD}<table:table-row>{error}</table:table-row>"))).unwrap_err();
    assert_eq!(fault.message, "sheet `a`, row 2: a cell holds the error #DIV/0!");
}

#[test]
fn a_formula_that_was_never_computed_is_refused() {
    let sheet = |cell: &str| {
        let head = "<row r=\"1\"><c r=\"A1\" t=\"inlineStr\"><is><t>y</t></is></c></row>";
        workbook_of(&format!("{head}<row r=\"2\"><c r=\"A2\">{cell}</c></row>"), None)
    };
    assert_eq!(parse(&sheet("<f>1+1</f><v>2</v>")).unwrap().shown("y").unwrap().0, [2.0]);
    for never in ["<f>1+1</f>", "<f/>"] {
        let fault = parse(&sheet(never)).unwrap_err();
        assert_eq!(fault.message, "sheet `a`, row 2: a cell holds a formula that was never computed");
    }
}

/// A cell that shows 7 % holds 0.07.
#[test]
fn shares_are_per_cent_where_their_column_is() {
    let head = |text: &str| ods_cell("office:value-type=\"string\"", &format!("<text:p>{text}</text:p>"));
    let share = ods_cell("office:value-type=\"percentage\" office:value=\"0.07\"", "<text:p>7 %</text:p>");
    let number = ods_cell("office:value-type=\"float\" office:value=\"7\"", "<text:p>7</text:p>");
    let row = |cells: &[&String]| {
        let cells: String = cells.iter().map(|cell| cell.as_str()).collect();
        format!("<table:table-row>{cells}</table:table-row>")
    };
    let read = |heads: [&str; 3], units: &str| {
        let [a, b, c] = heads.map(head);
        let rows = [row(&[&a, &b, &c]), units.to_owned(), row(&[&share, &share, &number])].concat();
        let table = parse(&ods_of(&rows)).unwrap();
        ["x", "y", "z"].map(|name| table.column(name).unwrap().clone().values)
    };
    let wanted = [7.0, 0.07, 7.0].map(|value| Values::Reals(vec![value]));
    assert_eq!(read(["x [%]", "y", "z [%]"], ""), wanted);
    let units = row(&[&head("%"), &head("-"), &head("%")]);
    assert_eq!(read(["x", "y", "z"], &units), wanted, "with the units in the row below the names");
}

#[test]
fn merged_cells_of_libreoffice_are_refused_below_the_first_line() {
    let row = |cells: &str| format!("<table:table-row>{cells}</table:table-row>");
    let value = |spans: &str| ods_cell(&format!("{spans} office:value-type=\"float\" office:value=\"2\""), "");
    let covered = "<table:covered-table-cell/>";
    let columns = "table:number-columns-spanned=\"2\" table:number-rows-spanned=\"1\"";
    let rows = "table:number-columns-spanned=\"1\" table:number-rows-spanned=\"2\"";
    for (below, is_merged) in [
        (row(&value("")), false),
        (row(&value("table:number-columns-spanned=\"1\"")), false),
        (row(&(value(columns) + covered)), true),
        (row(&value(rows)) + &row(covered), true),
        (row(&value("")) + &row(&ods_cell(columns, "")), false),
    ] {
        let read = parse(&ods_of(&format!("{HEAD}{below}"))).map(|table| table.rows());
        let message = "row 2: cells are merged, and only the first of them holds the value";
        assert_eq!(read.map_err(|fault| fault.message), if is_merged { Err(message.to_owned()) } else { Ok(1) });
    }
    let title = row(&(ods_cell(&format!("{columns} office:value-type=\"string\""), "<text:p>t</text:p>") + covered));
    let second = Dialect { first_line: Some(2), ..Dialect::default() };
    let (table, _) = read(&ods_of(&format!("{title}{HEAD}{}", row(&value("")))), &second);
    assert_eq!(table.shown("y").unwrap().0, [2.0]);
}

/// Files that unpack to more than there is memory, announce more than they hold, or end too early.
#[test]
fn workbooks_are_judged_before_they_are_read() {
    let blank = " ".repeat(300 << 20);
    let bomb = archive_of(&[("mimetype", "application/vnd.oasis.opendocument.spreadsheet"), ("content.xml", &blank)]);
    assert!(bomb.len() < 1 << 20);
    let message = |bytes: &[u8]| parse(bytes).unwrap_err().message;
    assert!(message(&bomb).contains("unpacks to more than 256 MiB"), "{}", message(&bomb));
    for count in ["18446744073709551615", "1000000000000"] {
        let texts = format!("<sst uniqueCount=\"{count}\"><si><t>y</t></si></sst>");
        let book = workbook_of("<row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c></row>", Some(&texts));
        assert!(message(&book).contains(&format!("says that it holds {count} texts")), "{}", message(&book));
    }
    let cut = archive_of(&[
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet"),
        ("content.xml", &format!("<office:spreadsheet><table:table table:name=\"a\">{HEAD}")),
    ]);
    assert!(message(&cut).contains("cannot be read"), "{}", message(&cut));
    let locked = archive_of(&[
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet"),
        ("META-INF/manifest.xml", "<manifest:encryption-data/>"),
        ("content.xml", "x"),
    ]);
    assert!(message(&locked).contains("locked with a password"));
}

/// Every cut and many flips of real workbooks: an answer or a reason, never a panic that passes on.
#[test]
fn damaged_workbooks_are_refused() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/data/");
    let how = Dialect { sheet: Some("cylinders".into()), ..Dialect::default() };
    for file in ["runs.xlsx", "runs.ods"] {
        let bytes = std::fs::read(format!("{folder}{file}")).unwrap();
        let whole = read(&bytes, &how).0;
        for cut in (0..bytes.len()).step_by(97) {
            assert!(parse_as(&bytes[..cut], &how).is_err(), "{file} cut at {cut}");
        }
        for at in (0..bytes.len()).step_by(61) {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1 << (at % 8);
            // The check sums of an archive leave a flip in its headers alone.
            assert!(parse_as(&flipped, &how).map_or(true, |read| read.table == whole), "{file} flipped at {at}");
        }
    }
}
