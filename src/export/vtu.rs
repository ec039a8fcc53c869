//! VTK unstructured grids (`.vtu`) and their series in time (`.pvd`), as ParaView and others read them.
//!
//! Numbers are written as text with the fewest digits that read back to the same number: about twice the size of the
//! binary forms, but exact, free of byte order, and a few dozen lines. The crate for the format (`vtkio`) brings
//! an XML parser, a parser for legacy files and three compressors for what is here one kind of cell per file.
//!
//! Format: VTK User's Guide, "VTK XML formats"; cell types 1 (vertex), 3 (line), 5 (triangle), 7 (polygon). Plane
//! points have z = 0.

use dem::space::Tuple;
use dem::{Space, Vector};
use std::fmt::{Display, Write};

/// Cells of one kind.
pub(super) enum Cells {
    /// Every point is one.
    Points,
    /// Pairs of points.
    Lines(Vec<[usize; 2]>),
    /// Corners of triangles.
    Triangles(Vec<[usize; 3]>),
    /// Points of each polygon, in order.
    Polygons(Vec<Vec<usize>>),
}

/// A named field on points or cells.
pub(super) enum Field {
    /// Numbers.
    Reals(&'static str, Vec<f64>),
    /// Whole numbers.
    Ints(&'static str, Vec<i64>),
    /// Vectors.
    Vectors(&'static str, Vec<[f64; 3]>),
}

/// Points, cells and fields on them.
pub(super) struct Grid {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) cells: Cells,
    pub(super) on_points: Vec<Field>,
    pub(super) on_cells: Vec<Field>,
}

impl Cells {
    fn count(&self, points: usize) -> usize {
        match self {
            Self::Points => points,
            Self::Lines(lines) => lines.len(),
            Self::Triangles(triangles) => triangles.len(),
            Self::Polygons(polygons) => polygons.len(),
        }
    }

    /// Points of each cell.
    fn corners(&self, points: usize) -> Vec<Vec<usize>> {
        match self {
            Self::Points => (0..points).map(|point| vec![point]).collect(),
            Self::Lines(lines) => lines.iter().map(|line| line.to_vec()).collect(),
            Self::Triangles(triangles) => triangles.iter().map(|triangle| triangle.to_vec()).collect(),
            Self::Polygons(polygons) => polygons.clone(),
        }
    }

    /// VTK's number of the kind.
    fn kind(&self) -> u8 {
        match self {
            Self::Points => 1,
            Self::Lines(_) => 3,
            Self::Triangles(_) => 5,
            Self::Polygons(_) => 7,
        }
    }
}

impl Grid {
    /// The file.
    pub(super) fn vtu(&self) -> String {
        let count = self.cells.count(self.points.len());
        let corners = self.cells.corners(self.points.len());
        let mut ends = Vec::with_capacity(count);
        corners.iter().fold(0, |end, corners| {
            ends.push(end + corners.len());
            end + corners.len()
        });
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n",
        );
        push(&mut text, format_args!("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{count}\">\n", self.points.len()));
        text.push_str("<Points>\n");
        array(&mut text, "Float64", "points", 3, self.points.iter().flatten());
        text.push_str("</Points>\n<Cells>\n");
        array(&mut text, "Int64", "connectivity", 1, corners.iter().flatten());
        array(&mut text, "Int64", "offsets", 1, &ends);
        array(&mut text, "UInt8", "types", 1, vec![self.cells.kind(); count]);
        text.push_str("</Cells>\n");
        for (what, fields) in [("PointData", &self.on_points), ("CellData", &self.on_cells)] {
            push(&mut text, format_args!("<{what}>\n"));
            fields.iter().for_each(|field| field.write(&mut text));
            push(&mut text, format_args!("</{what}>\n"));
        }
        text.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        text
    }
}

impl Field {
    fn write(&self, text: &mut String) {
        match self {
            Self::Reals(name, values) => array(text, "Float64", name, 1, values),
            Self::Ints(name, values) => array(text, "Int64", name, 1, values),
            Self::Vectors(name, values) => array(text, "Float64", name, 3, values.iter().flatten()),
        }
    }
}

/// A point or vector as VTK has it.
pub(super) fn spatial<S: Space>(vector: Vector<S>) -> [f64; 3] {
    std::array::from_fn(|axis| if axis < S::DIMENSION { vector.at(axis) } else { 0.0 })
}

fn array(text: &mut String, kind: &str, name: &str, parts: usize, values: impl IntoIterator<Item = impl Display>) {
    // One component is VTK's default; when it is stated, some readers make a matrix of one column of it.
    let parts_told = if parts > 1 { format!(" NumberOfComponents=\"{parts}\"") } else { String::new() };
    push(text, format_args!("<DataArray type=\"{kind}\" Name=\"{name}\"{parts_told} format=\"ascii\">\n"));
    for (i, value) in values.into_iter().enumerate() {
        push(text, format_args!("{value}{}", if (i + 1) % (4 * parts) == 0 { '\n' } else { ' ' }));
    }
    text.push_str("\n</DataArray>\n");
}

/// A series: time, part and file of each grid.
pub(super) fn pvd(parts: &[(f64, usize, String)]) -> String {
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
    for (time, part, file) in parts {
        push(&mut text, format_args!("<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>\n"));
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).unwrap_or_else(|_| panic!("BUG: a text takes any character"));
}
