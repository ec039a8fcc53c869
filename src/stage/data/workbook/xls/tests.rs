use super::super::super::parse;
use super::*;
use crate::artifact::Values;

fn record(kind: u16, content: &[u8]) -> Vec<u8> {
    [&kind.to_le_bytes()[..], &(content.len() as u16).to_le_bytes(), content].concat()
}

fn begin(kind: u16) -> Vec<u8> {
    record(BEGIN, &[&0x0600_u16.to_le_bytes()[..], &kind.to_le_bytes(), &[0; 12]].concat())
}

fn label(row: u16, column: u16, text: &str) -> Vec<u8> {
    let head = [row, column, 0, text.len() as u16].map(u16::to_le_bytes).concat();
    record(0x0204, &[&head[..], &[0], text.as_bytes()].concat())
}

fn number(row: u16, column: u16, value: f64) -> Vec<u8> {
    let head = [row, column, 0].map(u16::to_le_bytes).concat();
    record(0x0203, &[&head[..], &value.to_le_bytes()].concat())
}

fn dimensions(rows: [u32; 2], columns: [u16; 2]) -> Vec<u8> {
    let content = [&rows.map(u32::to_le_bytes).concat()[..], &columns.map(u16::to_le_bytes).concat(), &[0; 2]];
    record(DIMENSIONS, &content.concat())
}

/// The records of a workbook with one sheet.
fn stream_of(cells: &[Vec<u8>]) -> Vec<u8> {
    let name = [&[0, 0][..], &[1, 0], b"a"].concat();
    let globals =
        |at: u32| [begin(5), record(SHEET, &[&at.to_le_bytes()[..], &name].concat()), record(END, &[])].concat();
    let at = globals(0).len() as u32;
    [globals(at), begin(0x10), cells.concat(), record(END, &[])].concat()
}

/// A file with this stream, its sectors between those of another one.
fn file_of(stream: &[u8]) -> Vec<u8> {
    let mut file = CompoundFile::create_with_version(Version::V3, Cursor::new(Vec::new())).unwrap();
    file.create_stream("/Other").unwrap().set_len(1 << 13).unwrap();
    file.create_stream(STREAMS[0]).unwrap().set_len(1 << 13).unwrap();
    for (part, piece) in stream.chunks(512).enumerate() {
        let at = std::io::SeekFrom::Start(512 * part as u64);
        for (name, bytes) in [(STREAMS[0], piece), ("/Other", &[7; 512][..])] {
            let mut open = file.open_stream(name).unwrap();
            std::io::Seek::seek(&mut open, at).unwrap();
            open.write_all(bytes).unwrap();
        }
    }
    file.open_stream(STREAMS[0]).unwrap().set_len(stream.len() as u64).unwrap();
    file.flush().unwrap();
    file.into_inner().into_inner()
}

fn book(cells: &[Vec<u8>]) -> Vec<u8> {
    file_of(&stream_of(cells))
}

fn heads() -> Vec<Vec<u8>> {
    vec![label(0, 0, "a"), label(0, 1, "y"), number(1, 0, 2.0), number(1, 1, 1.5)]
}

fn message(more: Vec<u8>) -> String {
    parse(&book(&[heads(), vec![more]].concat())).map_or_else(|error| error.message, |_| "read".to_owned())
}

#[test]
fn a_sheet_is_read_from_sectors_between_others() {
    let blank = record(0x0FFF, &[1; 8000]);
    for before in [vec![], vec![dimensions([0, 2], [0, 2])], vec![blank.clone(), blank]] {
        let table = parse(&book(&[before, heads()].concat())).unwrap();
        assert_eq!(table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["a", "y"]);
        assert_eq!(table.columns[1].values, Values::Reals(vec![1.5]));
    }
}

/// The styles of these workbooks are not read, so nobody knows whether a cell with 0.05 shows 5 %.
#[test]
fn numbers_in_per_cent_are_refused() {
    let read = |head: &str, cell| parse(&book(&[label(0, 0, "a"), label(0, 1, head), number(1, 0, 2.0), cell]));
    let fault = read("y [%]", number(1, 1, 0.05)).unwrap_err();
    assert_eq!(fault.message, "column `y [%]`: this format of workbook does not say whether 5 % is 5 or 0.05");
    assert_eq!(fault.hint.as_deref(), Some("save the workbook as xlsx, or the sheet as CSV"));
    assert_eq!(read("y", number(1, 1, 0.05)).unwrap().columns[1].values, Values::Reals(vec![0.05]));
    assert!(read("y [%]", label(1, 1, "NA")).is_ok(), "no number is in doubt");
}

/// Two cells in opposite corners span 4·10⁹, a last row before the first one wraps to as many.
#[test]
fn what_would_take_more_memory_than_there_is_is_refused() {
    for (cell, words) in [
        (number(u16::MAX, u16::MAX, 1.0), "it has a cell in column 65536"),
        (number(u16::MAX, 255, 1.0), "its cells span more than 4194304 cells"),
        (dimensions([0, u32::MAX], [0, 2]), "it says that a sheet has the rows 0 to 4294967295"),
        (dimensions([9, 3], [0, 2]), "it says that a sheet has the rows 9 to 3"),
        (dimensions([0, 9], [0, 999]), "columns 0 to 999"),
        (record(DIMENSIONS, &[9, 0, 3, 0, 0, 0, 2, 0, 0, 0]), "it says that a sheet has the rows 9 to 3"),
        (dimensions([0, 65_536], [0, 256]), "read"),
        (record(MANY_CELLS, &[2, 0, 0, 0, 255, 255]), "it has a cell in column 65536"),
    ] {
        assert!(message(cell.clone()).contains(words), "{words}: {}", message(cell));
    }
}

/// A record that lies in two sectors far apart is found all the same.
#[test]
fn a_record_that_is_split_over_sectors_is_judged() {
    let whole = dimensions([0, u32::MAX], [0, 2]);
    let holds = |bytes: &[u8]| bytes.windows(whole.len()).any(|own| own == whole);
    // Sectors alternate beyond the first 8192 bytes; one of so many lengths in front of it lets one end within the record.
    let split = (512..1024).step_by(8).find_map(|pad| {
        let before = [8000, pad].map(|length| record(0x0FFF, &vec![0; length]));
        let stream = stream_of(&[heads(), before.to_vec(), vec![whole.clone()]].concat());
        let bytes = file_of(&stream);
        (holds(&stream) && !holds(&bytes)).then_some(bytes)
    });
    assert!(parse(&split.expect("a split record")).unwrap_err().message.contains("4294967295"));
}

/// Every cut and many flips: an answer or a reason.
#[test]
fn damaged_ones_are_refused() {
    let bytes = book(&heads());
    for cut in (0..bytes.len()).step_by(101) {
        let _ = parse(&bytes[..cut]);
    }
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        let _ = parse(&flipped);
    }
}
