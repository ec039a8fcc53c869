use super::*;
use crate::artifact::{Array, Artifact, Group, Node, Table, Values};
use proptest::prelude::*;

fn array(shape: &[usize], unit: &str, values: Values) -> Node {
    Node::Array(Array { shape: shape.to_vec(), unit: unit.to_owned(), about: "an array".to_owned(), values })
}

/// A value of every type, and the odd ones of each.
fn sample() -> Artifact {
    let n = 600;
    let curve = Group::new()
        .with("strain", array(&[n], "", Values::Reals((0..n).map(|i| i as f64 * 1e-5).collect())))
        .with("none", array(&[0, 2], "m", Values::Reals(vec![])))
        .with("names", array(&[0], "", Values::Texts(vec![])))
        .with("grid", array(&[2, 1, 2], "", Values::Texts(["a", "", "ü", "d"].map(str::to_owned).to_vec())))
        .with("one", array(&[], "m", Values::Ints(vec![7])))
        .with("one text", array(&[], "", Values::Texts(vec!["x".to_owned()])));
    let table = Table { about: "levels".to_owned(), columns: vec![] }
        .reals_column("σ_c", "Pa", "strength", vec![1.0, f64::NAN, -0.0])
        .ints_column("a/b", "row", vec![1, 2, i64::MIN])
        .texts_column("mode", "", vec!["shear".to_owned(), String::new(), "é".to_owned()]);
    let root = Group::new()
        .with("curve", Node::Group(curve))
        .with("table", Node::Table(table))
        .with("empty", Node::Group(Group::new()))
        .with("no columns", Node::Table(Table::default()))
        .with("note", Node::Text("two\nlines ".to_owned()))
        .with("nothing", Node::Text(String::new()))
        .with("Ec", Node::Real { value: 3.1e10, unit: "Pa".to_owned() })
        .with("seed", Node::Int(-3))
        .with("broken", Node::Flag(true))
        .with("whole", Node::Flag(false))
        .with("100%", Node::Int(100))
        .with("%2F", Node::Int(2))
        .with(".", Node::Int(1))
        .with("picture", Node::Bytes((0..=255).cycle().take(9000).collect()))
        .with("nil", Node::Bytes(vec![]));
    Artifact::new("sample", 3, root)
}

fn assert_round_trip(artifact: &Artifact, task: &str) {
    let image = encode(artifact, task).unwrap();
    assert_eq!(image, encode(artifact, task).unwrap());
    let (back, text) = decode(image.clone()).unwrap();
    assert_eq!(&back, artifact);
    assert_eq!(back.content_hash(), artifact.content_hash());
    assert_eq!(text, task);
    assert_eq!(encode(&back, &text).unwrap(), image, "what was read is written as it was");
}

#[test]
fn every_type_comes_back() {
    assert_round_trip(&sample(), "kind = x");
}

#[test]
fn a_task_text_may_be_long() {
    assert_round_trip(&sample(), &"input = 0123456789abcdef\n".repeat(100_000));
    assert_round_trip(&sample(), "");
}

#[test]
fn long_descriptions_many_columns_and_uneven_texts_come_back() {
    let mut table = Table { about: "é".repeat(40_000), columns: vec![] };
    for column in 0..400 {
        table = table.reals_column(&format!("a column with quite a long name, number {column}"), "Pa", "", vec![0.5]);
    }
    let mut texts = vec![String::from("x"); 4000];
    texts[17] = "long".repeat(10_000);
    let root = Group::new()
        .with("wide", Node::Table(table))
        .with("uneven", Node::Table(Table::default().texts_column("log", &"b".repeat(9000), texts)));
    assert_round_trip(&Artifact::new("large", 1, root), "t");
}

#[test]
fn equal_artifacts_give_equal_bytes() {
    let real = |value| Artifact::new("a", 1, Group::new().with("x", array(&[1], "", Values::Reals(vec![value]))));
    assert_eq!(encode(&real(0.0), "t").unwrap(), encode(&real(-0.0), "t").unwrap());
    let other_nan = f64::from_bits(f64::NAN.to_bits() | 5 | 1 << 63);
    assert_eq!(encode(&real(f64::NAN), "t").unwrap(), encode(&real(other_nan), "t").unwrap());
}

#[test]
fn what_no_file_can_hold_is_refused_with_its_place() {
    let refused = |root: Group| encode(&Artifact::new("a", 1, root), "t").unwrap_err().to_string();
    let nul = Group::new().with("inner", Node::Group(Group::new().with("log", Node::Text("a\0b".to_owned()))));
    assert_eq!(
        refused(nul),
        "`inner/log` cannot be stored: it holds the character NUL, which no text in an HDF5 file can hold"
    );
    let shape = Group::new().with("x", array(&[2, 2], "", Values::Ints(vec![1])));
    assert_eq!(refused(shape), "`x` cannot be stored: its shape does not fit the number of its values");
    let mut deep = Group::new();
    for _ in 0..40 {
        deep = Group::new().with("g", Node::Group(deep));
    }
    assert!(refused(deep).contains("nested too deeply"));
}

#[test]
fn foreign_and_newer_files_are_refused() {
    let mut file = ::hdf5::FileBuilder::new();
    file.create_dataset("x").with_f64_data(&[1.0]);
    let foreign = decode(file.finish().unwrap()).unwrap_err();
    assert_eq!(foreign.to_string(), "`@layout`: wanted a whole number, found nothing");
    let mut file = ::hdf5::FileBuilder::new();
    file.set_attr("layout", ::hdf5::AttrValue::I64(9));
    assert_eq!(decode(file.finish().unwrap()), Err(Hdf5Error::Newer { found: 9 }));
    assert!(matches!(decode(b"no HDF5".to_vec()), Err(Hdf5Error::Library(_))));
    assert!(matches!(decode(vec![]), Err(Hdf5Error::Library(_))));
}

/// Valid files of another program that ask for more than there is: see tests/reference/hostile/make.py.
#[test]
fn files_that_ask_for_too_much_are_refused_before_anything_is_read() {
    let refused = |image: &[u8]| decode(image.to_vec()).expect_err("an error");
    let huge = [
        &include_bytes!("../../../tests/reference/hostile/contiguous.h5")[..],
        include_bytes!("../../../tests/reference/hostile/chunked.h5"),
        include_bytes!("../../../tests/reference/hostile/texts.h5"),
    ];
    for image in huge {
        assert!(matches!(refused(image), Hdf5Error::Oversized { bytes, .. } if bytes >= 1 << 47));
    }
    let cycle = refused(include_bytes!("../../../tests/reference/hostile/cycle.h5"));
    assert!(cycle.to_string().contains("nested too deeply"), "{cycle}");
    let paths = refused(include_bytes!("../../../tests/reference/hostile/many_paths.h5"));
    assert!(paths.to_string().contains("more values than the file has room for"), "{paths}");
}

/// Damage of every kind: whatever comes out, it comes out, and soon. (In the store the digest is checked before.)
#[test]
fn damaged_images_neither_panic_nor_hang() {
    let image = encode(&sample(), "kind = x").unwrap();
    let mut read = 0;
    for place in 0..image.len() {
        let mut damaged = image.clone();
        damaged[place] ^= 1 << (place % 8);
        read += usize::from(decode(damaged).is_ok());
        if place % 5 == 0 {
            assert!(decode(image[..place].to_vec()).is_err());
            let mut zeroed = image.clone();
            let end = (place + 64).min(zeroed.len());
            zeroed[place..end].fill(0);
            let _ = decode(zeroed);
            let mut filled = image.clone();
            filled[place..end].fill(0xff);
            let _ = decode(filled);
        }
    }
    assert!(read < image.len(), "not one flip was noticed by HDF5 itself");
}

fn node() -> impl Strategy<Value = Node> {
    let text = "[^\\x00]{0,12}";
    let values = prop_oneof![
        prop::collection::vec(any::<f64>(), 0..800).prop_map(Values::Reals),
        prop::collection::vec(any::<i64>(), 0..800).prop_map(Values::Ints),
        prop::collection::vec(text, 0..90).prop_map(Values::Texts),
    ];
    let leaf = prop_oneof![
        text.prop_map(Node::Text),
        (any::<f64>(), text).prop_map(|(value, unit)| Node::Real { value, unit }),
        any::<i64>().prop_map(Node::Int),
        any::<bool>().prop_map(Node::Flag),
        prop::collection::vec(any::<u8>(), 0..6000).prop_map(Node::Bytes),
        (values, text).prop_map(|(values, unit)| array(&[values.len(), 1], &unit, values)),
    ];
    let name = "[^\\x00/]{1,6}";
    leaf.prop_recursive(3, 12, 4, move |inner| {
        prop::collection::btree_map(name, inner, 0..4).prop_map(|nodes| {
            Node::Group(nodes.into_iter().fold(Group::new(), |group, (name, node)| group.with(&name, node)))
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_artifact_comes_back(node in node(), task in "[^\\x00]{0,40}") {
        let artifact = Artifact::new("any", 1, Group::new().with("node", node)).canonical();
        let (back, text) = decode(encode(&artifact, &task).unwrap()).unwrap();
        prop_assert_eq!(&back, &artifact);
        prop_assert_eq!(back.content_hash(), artifact.content_hash());
        prop_assert_eq!(text, task);
    }

    #[test]
    fn any_bytes_are_refused_without_a_panic(start in any::<bool>(), bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let magic = if start { &b"\x89HDF\r\n\x1a\n"[..] } else { &[] };
        prop_assert!(decode([magic, &bytes].concat()).is_err());
    }
}
