//! Shapes of stones: surfaces as STL (binary, mm) and VTU (m), clumps as PFC, LAMMPS and YADE read them (m).
//!
//! | form | file | holds |
//! |---|---|---|
//! | `stl` | `NAME.SHAPE.stl` | the closed surface of a stone in mm |
//! | `vtu` | `NAME.SHAPE.vtu` | the same in m, as polygons |
//! | `particles` | `NAME.SHAPE.pfc.dat` | a `clump template` command |
//! | | `NAME.SHAPE.lammps.txt` | a `molecule` file; its masses are for a density of 1 kg/m³ |
//! | | `NAME.yade.txt` | all clumps, for `ymport.textClumps` |

use super::File;
use crate::stage::shapes::Shape;
use shape::{lists, stl};
use std::fmt::Write;

/// Millimetres in a metre.
const MM: f64 = 1e3;

/// The name of a shape as a part of the name of a file.
fn word(shape: &Shape) -> String {
    shape.name.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
}

/// Surfaces as STL.
pub fn stl(name: &str, shapes: &[Shape]) -> Vec<File> {
    shapes.iter().map(|shape| (format!("{name}.{}.stl", word(shape)), stl::write(&shape.mesh, MM))).collect()
}

/// Surfaces as VTU: triangles of an unstructured grid, as text (VTK User's Guide, "VTK XML formats").
pub fn vtu(name: &str, shapes: &[Shape]) -> Vec<File> {
    shapes.iter().map(|shape| (format!("{name}.{}.vtu", word(shape)), grid(shape).into_bytes())).collect()
}

fn grid(shape: &Shape) -> String {
    let (points, facets) = (shape.mesh.vertices(), shape.mesh.facets());
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n",
    );
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>", points.len(), facets.len());
    text.push_str("<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n");
    for [x, y, z] in points {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    text.push_str(
        "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n",
    );
    for [a, b, c] in facets {
        let _ = writeln!(text, "{a} {b} {c}");
    }
    text.push_str("</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n");
    for k in 1..=facets.len() {
        let _ = writeln!(text, "{}", 3 * k);
    }
    text.push_str("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n");
    for _ in facets {
        text.push_str("5\n");
    }
    text.push_str("</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    text
}

/// Clumps as lists of pebbles.
pub fn particles(name: &str, shapes: &[Shape]) -> Vec<File> {
    let mut files = Vec::new();
    for shape in shapes {
        let word = word(shape);
        files.push((format!("{name}.{word}.pfc.dat"), lists::pfc(&word, &shape.clump).into_bytes()));
        files.push((format!("{name}.{word}.lammps.txt"), lists::lammps(&word, &shape.clump, 1.0).into_bytes()));
    }
    let clumps: Vec<_> = shapes.iter().map(|shape| &shape.clump).collect();
    files.push((format!("{name}.yade.txt"), lists::yade(&clumps).into_bytes()));
    files
}
