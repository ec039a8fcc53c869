//! Solids of stones and the rigid clumps that represent them. Pure: values in, values out, the same bits every time.
//!
//! * [`mesh`]: closed surfaces of triangles; [`mend`]: from loose triangles to a closed, outward surface
//! * [`loft`]: the surface through sections along a stone's longest side; [`stl`]: STL files, text and binary
//! * [`moments`]: volume, centre, inertia and principal values, exact; [`statistics`]: shape measures, classes of Zingg
//! * [`voxels`]: the cells of a grid that lie in a solid; [`medial`] and [`transform`]: balls inside it, in two ways
//! * [`union`]: volume, inertia and surface of overlapping balls; [`clump`]: few balls within bounds on the errors
//! * [`lists`]: clumps in the formats of PFC, LAMMPS and YADE
//!
//! Lengths are of one unit throughout, which the caller chooses (metres in `flow`); densities are the caller's.
//!
//! ```
//! use shape::{clump::{Bound, Pebbles, fill}, loft::{Section, loft}, statistics::Measures};
//! // A flat stone 40 mm long, from three sections.
//! let section = |position, thickness, height| Section { position, thickness, height, exponent: 2.5 };
//! let stone = loft(&[section(0.0, 8e-3, 5e-3), section(20e-3, 30e-3, 15e-3), section(40e-3, 10e-3, 6e-3)], 32)?;
//! assert_eq!(Measures::of(&stone).zingg.name(), "disc");
//! let clump = fill(&stone, &Pebbles::default(), &Bound::default())?;
//! assert!(clump.errors.volume.abs() < 0.02 && clump.balls.len() <= 60);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod clump;
pub mod lists;
pub mod loft;
pub mod medial;
pub mod mend;
pub mod mesh;
pub mod moments;
pub mod statistics;
pub mod stl;
pub mod transform;
pub mod union;
mod vector;
pub mod voxels;

/// A ball: centre and radius.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ball {
    /// Centre.
    pub centre: [f64; 3],
    /// Radius.
    pub radius: f64,
}
