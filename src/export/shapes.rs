//! Shapes of stones: surfaces as STL (binary, mm) and VTU (m), clumps as PFC, LAMMPS and YADE read them (m).
//!
//! | form | file | holds |
//! |---|---|---|
//! | `stl` | `NAME.SHAPE.stl` | the closed surface of a stone in mm |
//! | `vtu` | `NAME.SHAPE.vtu` | the same in m, as triangles |
//! | `particles` | `NAME.SHAPE.pfc.dat` | a `clump template` command |
//! | | `NAME.SHAPE.lammps.txt` | a `molecule` file; its masses are for a density of 1 kg/m³ |
//! | | `NAME.yade.txt` | all clumps, for `ymport.textClumps` |

use super::File;
use super::vtu::{Cells, Grid};
use crate::stage::shapes::Shape;
use shape::{lists, stl};

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

/// Surfaces as VTU: triangles of an unstructured grid.
pub fn vtu(name: &str, shapes: &[Shape]) -> Vec<File> {
    let grid = |shape: &Shape| Grid {
        points: shape.mesh.vertices().to_vec(),
        cells: Cells::Triangles(shape.mesh.facets().iter().map(|facet| facet.map(|corner| corner as usize)).collect()),
        on_points: Vec::new(),
        on_cells: Vec::new(),
    };
    shapes.iter().map(|shape| (format!("{name}.{}.vtu", word(shape)), grid(shape).vtu().into_bytes())).collect()
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
