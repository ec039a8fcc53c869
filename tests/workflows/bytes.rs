//! Surfaces (STL) and workbooks under mutated bytes: no panic that passes on, no memory on the word of a file, and what is
//! read is sound.
//!
//! As in [`super::texts`], inputs are a function of their number, and `FLOW_FUZZ` says how many. A workbook is mutated within
//! its parts and packed again, for its check sums would refuse the rest.

use super::properties::{surface, workbook};
use math::random::Stream;
use shape::mesh::Mesh;
use shape::stl;
use std::io::{Cursor, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const IN_EVERY_TEST_RUN: u64 = 2_000;

/// Words that a mutation may put in.
const PIECES: [&[u8]; 12] = [
    b"1e39",
    b"nan",
    b"-1",
    b"4294967295",
    b"\xff\xff\xff\x7f",
    b"\0\0\x80\x7f",
    b"<",
    b"/>",
    b"\"",
    b"solid",
    b"A1",
    b"\n",
];

fn mutated(corpus: &[Vec<u8>], random: &mut Stream) -> Vec<u8> {
    let mut bytes = corpus[random.below(corpus.len())].clone();
    for _ in 0..random.below(5) {
        let (a, b) = (random.below(bytes.len() + 1), random.below(bytes.len() + 1));
        let (from, to) = (a.min(b), a.max(b).min(a.min(b) + 64));
        match random.below(6) {
            0 if a < bytes.len() => bytes[a] ^= 1 << random.below(8),
            1 => bytes.truncate(from.max(bytes.len() / 2)),
            2 => drop(bytes.drain(from..to)),
            3 => {
                let piece = bytes[from..to].to_vec();
                bytes.splice(to..to, piece);
            }
            _ => drop(bytes.splice(from..to, PIECES[random.below(PIECES.len())].iter().copied())),
        }
    }
    bytes
}

/// Runs a target on as many inputs as were asked for.
fn fuzz(name: &str, corpus: &[Vec<u8>], target: fn(&[u8])) {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let only = number("FLOW_FUZZ_ONLY");
    let numbers = only.map_or(0..number("FLOW_FUZZ").unwrap_or(IN_EVERY_TEST_RUN), |only| only..only + 1);
    corpus.iter().for_each(|bytes| target(bytes));
    for number in numbers {
        let bytes = mutated(corpus, &mut Stream::new(number, name, 0));
        if catch_unwind(AssertUnwindSafe(|| target(&bytes))).is_err() {
            panic!("{name}, input {number} of {} bytes; see it alone with FLOW_FUZZ_ONLY={number}", bytes.len());
        }
    }
}

#[test]
fn surfaces() {
    let vertices = vec![[0.0; 3], [0.02, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.01]];
    let facets = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = Mesh::of(vertices, facets).unwrap();
    let corpus = [stl::write(&mesh, 1e-3), stl::write_text(&mesh, "stone", 1e-3).into_bytes()];
    fuzz("stl", &corpus, surface);
}

fn archive(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in parts {
        let how = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        archive.start_file(*name, how).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn sheets_of_libreoffice() {
    let rows = [
        "<table:table-row><table:table-cell office:value-type=\"string\"><text:p>y [MPa]</text:p></table:table-cell>\
         </table:table-row><table:table-row table:number-rows-repeated=\"3\"><table:table-cell office:value-type=\"float\" \
         office:value=\"1.5\"><text:p>1,5</text:p></table:table-cell><table:table-cell table:number-columns-repeated=\"9\"/>\
         </table:table-row><table:table-row table:number-rows-repeated=\"99\"><table:table-cell/></table:table-row>",
        "<table:table-row><table:table-cell office:value-type=\"string\"><office:annotation><text:p>&amp;</text:p>\
         </office:annotation><text:p>a<text:s text:c=\"2\"/>b</text:p></table:table-cell></table:table-row><table:table-row>\
         <table:table-cell office:value-type=\"date\" office:date-value=\"2024-05-01\"><text:p>x</text:p></table:table-cell>\
         <table:covered-table-cell calcext:value-type=\"error\"><text:p>#N/A</text:p></table:covered-table-cell>\
         </table:table-row>",
    ];
    let corpus = rows.map(|rows| {
        format!(
            "<office:document-content><office:body><office:spreadsheet><table:table table:name=\"a\">{rows}</table:table>\
             </office:spreadsheet></office:body></office:document-content>"
        )
        .into_bytes()
    });
    fuzz("ods", &corpus, |content| {
        let kind: &[u8] = b"application/vnd.oasis.opendocument.spreadsheet";
        workbook(&archive(&[("mimetype", kind), ("content.xml", content)]));
    });
}

#[test]
fn sheets_of_excel() {
    let corpus = [
        b"<worksheet><dimension ref=\"A1:B3\"/><sheetData><row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\" t=\"inlineStr\">\
          <is><t>y</t></is></c></row><row r=\"2\"><c r=\"A2\"><v>1.5</v></c><c r=\"B2\" t=\"e\"><v>#N/A</v></c></row></sheetData>\
          </worksheet>"
            .to_vec(),
        b"<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c></row><row r=\"2\"><c r=\"A2\"><f t=\"shared\" \
          ref=\"A2:A9\" si=\"0\">A1+1</f><v>2</v></c></row></sheetData><mergeCells count=\"1\"><mergeCell ref=\"A1:B1\"/>\
          </mergeCells></worksheet>"
            .to_vec(),
    ];
    fuzz("xlsx", &corpus, |sheet| {
        let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
        let relation = |id: &str, kind: &str, target: &str| {
            format!(
                "<Relationships><Relationship Id=\"{id}\" Type=\"{relations}/{kind}\" Target=\"{target}\"/></Relationships>"
            )
        };
        let book = format!(
            "<workbook xmlns:r=\"{relations}\"><sheets><sheet name=\"a\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>"
        );
        workbook(&archive(&[
            ("[Content_Types].xml", b"<Types/>"),
            ("_rels/.rels", relation("r1", "officeDocument", "xl/workbook.xml").as_bytes()),
            ("xl/workbook.xml", book.as_bytes()),
            ("xl/_rels/workbook.xml.rels", relation("r1", "worksheet", "worksheets/sheet1.xml").as_bytes()),
            ("xl/sharedStrings.xml", b"<sst uniqueCount=\"1\"><si><t>x</t></si></sst>"),
            ("xl/worksheets/sheet1.xml", sheet),
        ]));
    });
}
