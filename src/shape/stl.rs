//! STL files: triangles as text or as records of 50 bytes.
//!
//! A binary file has 80 arbitrary bytes, the number of facets (little endian), and for each facet a normal, three
//! corners (32-bit floats) and two bytes of attributes. A text file has `solid`, then `facet normal … outer loop`,
//! three times `vertex x y z`, `endloop endfacet`, and `endsolid`; several solids may follow one another. Many binary
//! files begin with the word `solid` too, so a file is binary when its length fits its number of facets.
//! The normals in the file are not used: the order of the corners gives them, and [`super::mend`] corrects it.

use super::mesh::{Mesh, area_vector};
use super::vector::{norm, times};
use std::fmt::Write as _;

/// Most facets that are read.
pub const MOST_FACETS: usize = 5_000_000;
/// Bytes before the facets of a binary file, and of each.
const HEAD: usize = 84;
const RECORD: usize = 50;

/// Why a file is not STL.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StlFault {
    /// Neither form.
    #[error(
        "{0} bytes that are no STL: a text file begins with `solid`, a binary one has 84 bytes and 50 for each facet"
    )]
    Neither(usize),
    /// Length and count do not fit.
    #[error("a binary STL of {count} facets has {wanted} bytes, and the file has {bytes}: it was cut off or is no STL")]
    Length {
        /// Facets that it says it has.
        count: u32,
        /// Length that this makes.
        wanted: u64,
        /// Length of the file.
        bytes: usize,
    },
    /// Too many.
    #[error("{0} facets are too many; at most {MOST_FACETS} are read: coarsen the surface")]
    Many(usize),
    /// A text line.
    #[error("line {line}: found `{found}`, expected {expected}")]
    Line {
        /// Its number from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// No text.
    #[error("line {0} is no UTF-8 text")]
    Text(usize),
}

/// The triangles of a file, with every coordinate times `unit`.
///
/// # Errors
/// The first fault in the file. Memory is allocated by the size of the file, never by numbers in it.
pub fn read(bytes: &[u8], unit: f64) -> Result<Vec<[[f64; 3]; 3]>, StlFault> {
    let count = bytes.get(80..HEAD).and_then(|four| four.try_into().ok()).map(u32::from_le_bytes);
    let wanted = count.map(|count| HEAD as u64 + RECORD as u64 * u64::from(count));
    if wanted == Some(bytes.len() as u64) {
        return binary(bytes, unit);
    }
    if bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return text(bytes, unit);
    }
    match (count, wanted) {
        (Some(count), Some(wanted)) => Err(StlFault::Length { count, wanted, bytes: bytes.len() }),
        _ => Err(StlFault::Neither(bytes.len())),
    }
}

fn binary(bytes: &[u8], unit: f64) -> Result<Vec<[[f64; 3]; 3]>, StlFault> {
    let records = bytes[HEAD..].chunks_exact(RECORD);
    if records.len() > MOST_FACETS {
        return Err(StlFault::Many(records.len()));
    }
    let number = |record: &[u8], k: usize| {
        let four: [u8; 4] = std::array::from_fn(|b| record[12 + 4 * k + b]);
        unit * f64::from(f32::from_le_bytes(four))
    };
    let corners = |record: &[u8]| std::array::from_fn(|v| std::array::from_fn(|axis| number(record, 3 * v + axis)));
    Ok(records.map(corners).collect())
}

/// The token that must follow in a text file.
enum Place {
    Outside,
    Solid,
    Facet,
    Loop(Vec<[f64; 3]>),
    Looped,
}

fn text(bytes: &[u8], unit: f64) -> Result<Vec<[[f64; 3]; 3]>, StlFault> {
    let mut triangles = Vec::new();
    let mut place = Place::Outside;
    let mut last = 0;
    for (k, line) in bytes.split(|&b| b == b'\n').enumerate() {
        last = k + 1;
        let line = std::str::from_utf8(line).or(Err(StlFault::Text(last)))?;
        let words: Vec<&str> = line.split_ascii_whitespace().take(8).collect();
        let Some(first) = words.first().map(|word| word.to_ascii_lowercase()) else { continue };
        let fault = |expected| Err(StlFault::Line { line: last, found: shown(line), expected });
        place = match (place, first.as_str()) {
            (Place::Outside, "solid") => Place::Solid,
            (Place::Solid, "facet") => Place::Facet,
            (Place::Solid, "endsolid") => Place::Outside,
            (Place::Facet, "outer") => Place::Loop(Vec::new()),
            (Place::Loop(mut corners), "vertex") if corners.len() < 3 => {
                let numbers: Vec<f64> = words[1..].iter().filter_map(|word| word.parse().ok()).collect();
                let (&[x, y, z], 4) = (numbers.as_slice(), words.len()) else {
                    return fault("`vertex` and three numbers");
                };
                corners.push([x, y, z].map(|value| unit * value));
                Place::Loop(corners)
            }
            (Place::Loop(corners), "endloop") if corners.len() == 3 => {
                if triangles.len() == MOST_FACETS {
                    return Err(StlFault::Many(MOST_FACETS + 1));
                }
                triangles.push([corners[0], corners[1], corners[2]]);
                Place::Looped
            }
            (Place::Looped, "endfacet") => Place::Solid,
            (Place::Outside, _) => return fault("`solid`"),
            (Place::Solid, _) => return fault("`facet` or `endsolid`"),
            (Place::Facet, _) => return fault("`outer loop`"),
            (Place::Loop(corners), _) if corners.len() < 3 => return fault("`vertex` and three numbers"),
            (Place::Loop(_), _) => return fault("`endloop` behind three corners (the facets are triangles)"),
            (Place::Looped, _) => return fault("`endfacet`"),
        };
    }
    match place {
        Place::Outside => Ok(triangles),
        _ => Err(StlFault::Line { line: last, found: "the end of the file".to_owned(), expected: "`endsolid`" }),
    }
}

/// A line as a message shows it.
fn shown(line: &str) -> String {
    line.trim().chars().take(40).collect()
}

/// A surface as a binary file, every coordinate times `unit`, rounded to 32 bits.
///
/// # Panics
/// More facets than the format can count, which [`MOST_FACETS`] excludes.
pub fn write(mesh: &Mesh, unit: f64) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    let title = b"a closed surface";
    bytes[..title.len()].copy_from_slice(title);
    let count = u32::try_from(mesh.facets().len()).unwrap_or_else(|_| panic!("BUG: more facets than 32 bits count"));
    bytes.extend(count.to_le_bytes());
    for corners in mesh.triangles() {
        let vector = area_vector(corners);
        let normal = times(vector, 1.0 / norm(vector));
        let points = corners.map(|corner| times(corner, unit));
        for value in normal.into_iter().chain(points.into_iter().flatten()) {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

/// A surface as a text file, every coordinate times `unit`, with all its digits.
pub fn write_text(mesh: &Mesh, name: &str, unit: f64) -> String {
    let mut text = format!("solid {name}\n");
    for corners in mesh.triangles() {
        let vector = area_vector(corners);
        let [x, y, z] = times(vector, 1.0 / norm(vector));
        let _ = writeln!(text, "facet normal {x:e} {y:e} {z:e}\n outer loop");
        for corner in corners {
            let [x, y, z] = times(corner, unit);
            let _ = writeln!(text, "  vertex {x:e} {y:e} {z:e}");
        }
        text.push_str(" endloop\nendfacet\n");
    }
    let _ = writeln!(text, "endsolid {name}");
    text
}

#[cfg(test)]
mod tests {
    use super::super::mend::mend;
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::super::moments::Moments;
    use super::*;
    use proptest::prelude::*;

    /// One facet as printed in the original description of the format (3D Systems, 1989).
    const PRINTED: &str = "solid cube\n facet normal 0 0 -1\n  outer loop\n   vertex 0.0 0.0 0.0\n   vertex 0.0 1.0 0.0\n   vertex 1.0e0 0 0\n  endloop\n endfacet\nendsolid cube\n";

    #[test]
    fn both_forms_come_back() {
        let mesh = ellipsoid([10.0, 20.0, 15.0], 16);
        let expected = Moments::of(&mesh).volume;
        for bytes in [write(&mesh, 2.0), write_text(&mesh, "stone", 2.0).into_bytes()] {
            let (found, mended) = mend(&read(&bytes, 0.5).unwrap()).unwrap();
            assert_eq!(found.facets().len(), mesh.facets().len());
            assert!(mended.words().is_empty());
            assert!((Moments::of(&found).volume / expected - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_unit_counts_and_a_binary_file_may_begin_with_solid() {
        let mut bytes = write(&cuboid([1.0, 2.0, 3.0]), 1.0);
        bytes[..6].copy_from_slice(b"solid ");
        let (found, _) = mend(&read(&bytes, 1e-3).unwrap()).unwrap();
        assert!((Moments::of(&found).volume / 6e-9 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn faults_name_their_line_and_counts() {
        assert_eq!(read(PRINTED.as_bytes(), 1.0).unwrap(), [[[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]);
        let line = |text: &str| match read(text.as_bytes(), 1.0) {
            Err(StlFault::Line { line, .. }) => line,
            other => panic!("{other:?}"),
        };
        assert_eq!(line(&PRINTED.replace("1.0e0 0 0", "1.0e0 0")), 6);
        assert_eq!(line(&PRINTED.replace("  endloop\n", "   vertex 1 1 0\n  endloop\n")), 7);
        assert_eq!(line(&PRINTED.replace("outer loop", "vertex 0 0 0")), 3);
        assert_eq!(line(&PRINTED.replace("endsolid cube\n", "")), 9);
        let bytes = write(&cuboid([1.0; 3]), 1.0);
        assert_eq!(read(&bytes[..bytes.len() - 7], 1.0), Err(StlFault::Length { count: 12, wanted: 684, bytes: 677 }));
        assert_eq!(read(b"", 1.0), Err(StlFault::Neither(0)));
        let mut boastful = vec![0_u8; 90];
        boastful[80..84].fill(0xff);
        assert!(matches!(read(&boastful, 1.0), Err(StlFault::Length { count: u32::MAX, .. })));
        assert_eq!(read(b"solid a\n\xff\xfe\n", 1.0), Err(StlFault::Text(2)));
    }

    proptest! {
        /// Whatever the bytes are, reading and mending end without a panic.
        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), cut in 0_usize..684, at in 0_usize..684) {
            let _ = read(&bytes, 1.0);
            let mut file = write(&cuboid([1.0; 3]), 1.0);
            file[at] ^= 0x55;
            if let Ok(triangles) = read(&file, 1.0) {
                let _ = mend(&triangles);
            }
            file.truncate(cut);
            let _ = read(&file, 1.0);
        }
    }
}
