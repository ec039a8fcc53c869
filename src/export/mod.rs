//! Results as files for people and other programs.
//!
//! [`files`] and [`tables`] take any artifact; [`paraview`] and [`particles`] take specimens and runs, [`shapes`] shapes of stones.

mod bodies;
mod csv;
mod joints;
pub mod paraview;
pub mod particles;
pub mod pfc;
pub mod shapes;
mod vtu;

pub use csv::{cells, csv_text, head};

use crate::artifact::{Artifact, Node};

/// A file: its name and bytes.
pub type File = (String, Vec<u8>);

/// The files of a result. Texts and bytes whose names are file formats are written unchanged, in place of the tables that
/// they were made from.
pub fn files(stage: &str, artifact: &Artifact) -> Vec<File> {
    let mut files = Vec::new();
    for (name, node) in artifact.root.iter() {
        let ending = if name == "latex" {
            "tex"
        } else if name == "markdown" {
            "md"
        } else if name == "moving" {
            "moving.svg"
        } else {
            name
        };
        let known = ["svg", "pdf", "png", "csv", "tex", "md", "moving.svg"].contains(&ending);
        match node {
            Node::Bytes(bytes) if known => files.push((format!("{stage}.{ending}"), bytes.clone())),
            Node::Text(text) if known => files.push((format!("{stage}.{ending}"), text.clone().into_bytes())),
            Node::Bytes(_) | Node::Text(_) | Node::Group(_) | Node::Table(_) | Node::Array(_) => {}
            Node::Real { .. } | Node::Int(_) | Node::Flag(_) => {}
        }
    }
    let whole = format!("{stage}.csv");
    if !files.iter().any(|(name, _)| *name == whole) {
        files.extend(tables(stage, artifact));
    }
    files
}

/// Every table of a result as CSV.
pub fn tables(stage: &str, artifact: &Artifact) -> Vec<File> {
    let tables = artifact.tables().into_iter();
    tables
        .map(|(name, table)| (format!("{stage}.{}.csv", name.replace('/', ".")), csv_text(table).into_bytes()))
        .collect()
}
