//! Test pieces and materials for the loading tests: lattices and random packings.

use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::specimen::Recipe;
use dem::loading::material::{BondKind, Bonded, Bonding, MORTAR, Material, Unbonded};
use dem::loading::piece::{Outline, Piece};
use dem::*;

/// Microparameters of a material of one group.
#[derive(Clone, Copy)]
pub(crate) struct Rock {
    pub(crate) modulus: f64,
    pub(crate) ratio: f64,
    pub(crate) strength: f64,
    pub(crate) friction: f64,
    pub(crate) bond: BondKind,
    /// Gap of installation over the mean radius.
    pub(crate) gap: f64,
}

impl Rock {
    pub(crate) fn material(self) -> Material {
        let Self { modulus, ratio: stiffness_ratio, strength, friction, bond: kind, gap } = self;
        let bonded =
            Bonded { modulus, stiffness_ratio, tensile_strength: strength, shear_strength: strength, friction };
        let aggregate = Unbonded { modulus, stiffness_ratio, friction };
        Material { mortar: bonded, aggregate, interface: bonded, bonding: Bonding { kind, gap, ..Bonding::default() } }
    }
}

/// A piece of balls of one radius.
pub(crate) fn piece<S: Space>(outline: Outline, centres: Vec<Vector<S>>, radius: f64) -> Piece<S> {
    let count = centres.len();
    Piece {
        outline,
        centres,
        radii: vec![radius; count],
        groups: vec![MORTAR; count],
        density: 2000.0,
        clumps: Vec::new(),
    }
}

/// A random packing of discs of mean radius `mean_radius`, ratio 1.66.
pub(crate) fn random(region: Region, mean_radius: f64, seed: u64) -> Piece<D2> {
    let packing = Packing { porosity: 0.12, mean_radius, ratio: 1.66, floaters: 0.0 };
    let recipe = Recipe { region, packing, density: 2000.0, aggregate: None };
    Piece::from(&recipe.make(seed, &|| Watch::Continue).unwrap().0)
}

/// Discs of radius `r` in hexagonal order, rows along x: `columns` to a row (one less in every other), centred.
pub(crate) fn hexagon(columns: usize, rows: usize, r: f64) -> Piece<D2> {
    let rise = 3.0_f64.sqrt() * r;
    let (width, height) = (2.0 * r * columns as f64, 2.0 * r + rise * (rows - 1) as f64);
    let place = |row: usize, column: usize| {
        let x = r * (1.0 + (row % 2) as f64) + 2.0 * r * column as f64 - 0.5 * width;
        [x, r + rise * row as f64 - 0.5 * height]
    };
    let row = |row: usize| (0..columns - row % 2).map(move |column| place(row, column));
    piece(Outline::Block { width, height, depth: 1.0 }, (0..rows).flat_map(row).collect(), r)
}

/// Spheres of radius `r` in face-centred cubic order: a cube of `n` cells to an edge, whole faces.
pub(crate) fn face_centred(n: usize, r: f64) -> Piece<D3> {
    let half = 2.0_f64.sqrt() * r;
    let mut centres = Vec::new();
    for i in 0..=2 * n {
        for j in 0..=2 * n {
            for k in (0..=2 * n).filter(|k| (i + j + k) % 2 == 0) {
                centres.push([i, j, k].map(|index| half * (index as f64 - n as f64)));
            }
        }
    }
    let edge = 2.0 * (half * n as f64 + r);
    piece(Outline::Block { width: edge, height: edge, depth: edge }, centres, r)
}
