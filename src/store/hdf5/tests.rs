use super::*;
use crate::artifact::{Array, Artifact, Group, Node, Table, Values};

fn sample() -> Artifact {
    let n = 600;
    let curve = Group::new()
        .with(
            "strain",
            Node::Array(Array {
                shape: vec![n],
                unit: String::new(),
                about: "axial".to_owned(),
                values: Values::Reals((0..n).map(|i| i as f64 * 1e-5).collect()),
            }),
        )
        .with(
            "none",
            Node::Array(Array {
                shape: vec![0, 2],
                unit: "m".to_owned(),
                about: String::new(),
                values: Values::Reals(vec![]),
            }),
        )
        .with(
            "names",
            Node::Array(Array {
                shape: vec![0],
                unit: String::new(),
                about: String::new(),
                values: Values::Texts(vec![]),
            }),
        )
        .with(
            "one",
            Node::Array(Array {
                shape: vec![],
                unit: "m".to_owned(),
                about: String::new(),
                values: Values::Ints(vec![7]),
            }),
        );
    let table = Table { about: "levels".to_owned(), columns: vec![] }
        .reals_column("σ_c", "Pa", "strength", vec![1.0, f64::NAN, -0.0])
        .ints_column("a/b", "row", vec![1, 2, 3])
        .texts_column("mode", "", vec!["shear".to_owned(), String::new(), "é".to_owned()]);
    let root = Group::new()
        .with("curve", Node::Group(curve))
        .with("table", Node::Table(table))
        .with("empty", Node::Group(Group::new()))
        .with("no rows", Node::Table(Table::default()))
        .with("note", Node::Text("two\nlines".to_owned()))
        .with("nothing", Node::Text(String::new()))
        .with("Ec", Node::Real { value: 3.1e10, unit: "Pa".to_owned() })
        .with("seed", Node::Int(-3))
        .with("broken", Node::Flag(true))
        .with("whole", Node::Flag(false))
        .with("100%", Node::Int(100))
        .with(".", Node::Int(1))
        .with("picture", Node::Bytes((0..=255).cycle().take(9000).collect()))
        .with("nil", Node::Bytes(vec![]));
    Artifact::new("sample", 3, root)
}

#[test]
fn round_trip() {
    let artifact = sample();
    let task = "kind = x\n".repeat(10_000);
    let image = encode(&artifact, &task).unwrap();
    assert_eq!(image, encode(&artifact, &task).unwrap());
    let (back, text) = decode(image).unwrap();
    assert_eq!(back, artifact);
    assert_eq!(back.content_hash(), artifact.content_hash());
    assert_eq!(text, task);
}
