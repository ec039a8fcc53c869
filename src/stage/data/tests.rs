//! Tables as laboratories and spreadsheets write them.

use super::*;

mod workbook;

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
    let Read { table, said, .. } = parse_as(bytes, how).unwrap();
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

/// One cell that is written otherwise would make words of a column of numbers.
#[test]
fn numbers_that_are_none_here_are_refused_and_not_taken_for_words() {
    for cell in ["inf", "-Infinity", "1e400", "1e-400", "0x10", "５", "5%", "\u{200f}5", &"9".repeat(400)] {
        let message = parse(format!("x,y\n{cell},2\n3,4\n").as_bytes()).unwrap_err().message;
        assert!(message.starts_with("row 1: `x` is `") && message.ends_with("`, which is no number here"), "{message}");
    }
    assert!(parse("x,y\n5%,2\n7%,4\n".as_bytes()).is_err());
    // Words among them are categories.
    for cells in ["A1,2\n3,4", "x10,2\n0x10,4", "CEM I,1\n5%,2", "1-May,2\n2-May,4", "30_1,2\n30_2,4"] {
        assert!(parse(format!("x,y\n{cells}\n").as_bytes()).unwrap().shown("x").is_err(), "{cells}");
    }
    assert_eq!(plain(b"x,y\n0e-400,2\n0.000,4\n").0.shown("x").unwrap().0, [0.0, 0.0]);
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
    let several = Dialect { missing: Some(vec!["x".into()]), ..Dialect::default() };
    let fault = parse_as(b"UCS [MPa]\n30\nbroken\nx\n-\nbroken\n", &several).unwrap_err();
    assert_eq!(fault.message, "rows 2, 4 and 5: `UCS` [MPa] is `broken` and `-`, which are no numbers");
    let hint = "correct the file, or say `missing = [\"x\", \"broken\", \"-\"]` if they stand for no value";
    assert_eq!(fault.hint.as_deref(), Some(hint));
    // categories stay words
    assert!(parse(b"cement\nCEM I\nslag\n").unwrap().shown("cement").is_err());
}

#[test]
fn names_and_units_stand_where_the_laboratory_put_them() {
    let german = b"sep=;\r\nPr\xfcfbericht 12;;\r\nProbe;UCS;nu\r\n;MPa;-\r\nA1;31,5;0,2\r\nA2;29,25;0,21\r\n";
    let third = Dialect { first_line: Some(3), ..Dialect::default() };
    let detected = "names of the columns in line 3, below titles";
    for (how, is_detected) in [(third, false), (Dialect::default(), true)] {
        let (table, said) = read(german, &how);
        assert_eq!(table.shown("UCS").unwrap(), (vec![31.5, 29.25], "MPa"));
        assert_eq!((table.rows(), table.column("nu").unwrap().unit.as_str()), (2, ""));
        assert_eq!(said.contains(detected) && said.contains("`first_line` fix it"), is_detected, "{said}");
        assert!(
            said.contains("windows-1252") && said.ends_with("detected: units in the row below the names"),
            "{said}"
        );
    }
    let message = |bytes: &[u8], how: &Dialect| parse_as(bytes, how).unwrap_err().message;
    let beyond = Dialect { first_line: Some(9), ..Dialect::default() };
    assert_eq!(message(b"a\n1\n", &beyond), "the file has no line 9, in which `first_line` looks for the names");
    let second = Dialect { first_line: Some(2), ..Dialect::default() };
    assert_eq!(message(b"t,,\na,b\n1,2\n3\n", &second), "line 4 has 1 cell where the first line has 2");
    assert_eq!(
        message(b"a,,c\n1,2,3\n", &Dialect::default()),
        "column 2 has no name: every column needs a name of its own"
    );
    let hint = parse_as(b"Labor\n;mix;grade\nP1;A;4\n", &Dialect::default()).unwrap_err().hint.unwrap();
    assert!(hint.ends_with("say in which line the names are: `first_line = 4`"), "{hint}");
    let sheet = Dialect { sheet: Some("a".into()), ..Dialect::default() };
    assert_eq!(message(b"a\n1\n", &sheet), "`sheet` has no effect on a text file");
}

/// Titles without the delimiters that would make them as wide as the table, with commas of their own.
#[test]
fn titles_above_the_names_are_left_out_and_said() {
    let text = "# export\n\nBaustofflabor, Musterstadt\nAuftrag;12\n\nProbe;w/z;fc (MPa)\nP1;0,45;31,2\nP2;0,5;k. A.\n";
    let how = Dialect { missing: Some(vec!["k. A.".into()]), ..Dialect::default() };
    let (table, said) = read(text.as_bytes(), &how);
    assert_eq!(table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["Probe", "w/z", "fc"]);
    assert_eq!(table.rows(), 2);
    assert!(said.contains("semicolons `;`, decimal commas, names of the columns in line 6, below titles"), "{said}");
}
