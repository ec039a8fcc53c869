//! Test pieces and materials for the loading tests: lattices and random packings.

use dem::genesis::groups::Share;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::specimen::Recipe;
use dem::loading::material::{BondKind, Contact, Material};
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
        let Self { modulus, ratio, strength, friction, bond, gap } = self;
        let contact = Contact { bond, ..Contact::bonded("rock", modulus, ratio, [strength; 2], friction) };
        Material { gap, ..Material::of_one(contact) }
    }
}

/// A piece of balls of one radius.
pub(crate) fn piece<S: Space>(outline: Outline, centres: Vec<Vector<S>>, radius: f64) -> Piece<S> {
    let count = centres.len();
    Piece {
        outline,
        centres,
        radii: vec![radius; count],
        groups: vec![Group(0); count],
        density: 2000.0,
        clumps: Vec::new(),
    }
}

/// A random packing of discs of mean radius `mean_radius`, ratio 1.66.
pub(crate) fn random(region: Region, mean_radius: f64, seed: u64) -> Piece<D2> {
    let packing = Packing::uniform(0.12, mean_radius, 1.66);
    let groups = vec![Share { name: "rock".to_owned(), share: 1.0 }];
    let recipe = Recipe { region, packing, density: 2000.0, groups, aggregate: None };
    Piece::from(&recipe.make::<D2>(seed, &|| Watch::Continue).unwrap().0)
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
