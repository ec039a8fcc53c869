//! Other programs read what the store writes: h5py and h5dump, when they are installed (the checks install both).

use crate::{open, put};
use flow::artifact::{Array, Artifact, Group, Node, Table, Values};
use std::process::Command;

/// One value of every type.
fn everything() -> Artifact {
    let array = |shape: &[usize], values| {
        let (unit, about) = ("Pa".to_owned(), "an array".to_owned());
        Node::Array(Array { shape: shape.to_vec(), unit, about, values })
    };
    let table = Table { about: "levels".to_owned(), columns: Vec::new() }
        .reals_column("σ_c", "Pa", "strength", vec![1.5, f64::NAN, -3e300])
        .ints_column("row", "number", vec![1, 2, i64::MIN])
        .texts_column("mode", "how it failed", vec!["shear".to_owned(), String::new(), "déchirure".to_owned()]);
    let curve = Group::new()
        .with("strain", array(&[3000], Values::Reals((0..3000).map(|i| f64::from(i) * 1e-6).collect())))
        .with("long", array(&[200_000], Values::Ints((0..200_000).collect())))
        .with("cracks", array(&[2, 3], Values::Ints(vec![1, 2, 3, 4, 5, 6])));
    let root = Group::new()
        .with("levels", Node::Table(table))
        .with("curve", Node::Group(curve))
        .with("Ec", Node::Real { value: 3.1e10, unit: "Pa".to_owned() })
        .with("steps", Node::Int(-7))
        .with("failed", Node::Flag(true))
        .with("reason", Node::Text("no peak: σ fell\nbelow".to_owned()))
        .with("picture", Node::Bytes((0..=255).cycle().take(10_000).collect()));
    Artifact::new("everything", 4, root)
}

#[test]
fn h5py_and_h5dump_read_every_type() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    put(&store, 1);
    let task = "work = everything 1\n".repeat(5000);
    let (record, _) = store.put(&task, everything(), &crate::timing()).unwrap();
    let file = store.path(&record.object());
    let required = std::env::var("FLOW_TEST_READERS").is_ok();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/read_with_h5py.py");
    let python = Command::new("python3").args(["-c", "import h5py"]).output();
    if required || python.is_ok_and(|output| output.status.success()) {
        let output = Command::new("python3").arg(script).arg(&file).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    }
    if required || Command::new("h5dump").arg("--version").output().is_ok() {
        let output = Command::new("h5dump").arg(&file).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        for part in ["\"levels\"", "\"unit\"", "3.1e+10", "chirure\"", "no peak: ", "TRUE"] {
            assert!(said.contains(part), "h5dump does not show {part}");
        }
    }
}
