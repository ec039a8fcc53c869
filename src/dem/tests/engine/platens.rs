//! Cubic lattices between frictionless platens, with free sides: the elastic constants of their middle.
//!
//! The constants are those of the table in [`crate::lattice`]. A free face has fewer neighbours, so a whole block is not homogeneous;
//! balls three layers from every face nearly are. Their stress is ½ Σ f ⊗ l over their contacts, divided by their volume; their strain is
//! the slope of their neighbours' displacements by least squares. From σ_y = C₁₁ε_y + 2C₁₂ε_x and σ_x = (C₁₁ + C₁₂)ε_x + C₁₂ε_y, where x
//! stands for both free directions, follow C₁₁ and C₁₂.

use crate::block::{GRAIN, PLATEN};
use crate::case::{Case, Family, Near};
use crate::lattice::{KN, KS, Lattice, along_edge, lattices};
use dem::*;
use std::sync::LazyLock;

/// Radius of a ball, m; the distance of neighbours is 1 m.
const RADIUS: f64 = 0.5;
const STRAIN: f64 = 1e-6;
/// Planes of balls along an edge of the block.
const PLANES: f64 = 14.0;
/// Steps in which the platens come nearer, and in which the block comes to rest.
const LOADING: u64 = 2000;
const RESTING: u64 = 4000;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Blocks of 14 planes of balls a side between frictionless platens that approach by a strain of 1e-6, sides free, k_n 1e6, k_s 4e5 N/m, \
        contact bonds that hold; stress and strain of the balls three layers and more from every face.";
    Family { title: "Lattices between platens", about, cases: &CASES }
}

#[test]
fn lattices_between_platens_have_their_closed_forms() {
    family().check();
}

fn cases() -> Vec<Case> {
    lattices().iter().filter(|lattice| lattice.name.starts_with("3D")).flat_map(rows).collect()
}

fn rows(lattice: &Lattice) -> [Case; 2] {
    let [c11, c12, _] = lattice.constants;
    let [young, poisson] = along_edge(c11, c12);
    let [stress, strain] = squeezed(lattice);
    // Two equations in two unknowns, [ε_y 2ε_x; ε_x ε_x + ε_y] [C₁₁; C₁₂] = [σ_y; σ_x].
    let [[a, b], [c, d]] = [[strain[1], 2.0 * strain[0]], [strain[0], strain[0] + strain[1]]];
    let determinant = a * d - b * c;
    let found11 = (d * stress[1] - b * stress[0]) / determinant;
    let found12 = (a * stress[0] - c * stress[1]) / determinant;
    let [e, nu] = along_edge(found11, found12);
    let near = if poisson == 0.0 { Near::Absolute(1e-3) } else { Near::Relative(5e-3) };
    [
        Case::new(format!("{}: E, Pa", lattice.name), "affine, exact", young, e, Near::Relative(5e-3)),
        Case::new(format!("{}: ν", lattice.name), "affine, exact", poisson, nu, near),
    ]
}

/// Stress and strain of the middle along a free direction and along the load, compression positive.
fn squeezed(lattice: &Lattice) -> [[f64; 2]; 2] {
    let start = places(lattice);
    let [low, high] = [f64::min, f64::max].map(|pick| {
        let end = |k: usize| start.iter().map(|x| x[k]).reduce(pick).unwrap();
        [end(0), end(1), end(2)]
    });
    let engine = loaded(&start, low[1] - RADIUS, high[1] + RADIUS);
    let depth = 2.5 * layer(lattice);
    let deep = |x: &[f64; 3]| (0..3).all(|k| x[k] > low[k] + depth && x[k] < high[k] - depth);
    let inside: Vec<bool> = start.iter().map(deep).collect();
    assert!(inside.iter().filter(|&&i| i).count() > 20, "{}: too few balls inside", lattice.name);
    let volume = lattice.repeat.iter().product::<f64>() / lattice.basis.len() as f64;
    means(&engine, &start, &inside, volume)
}

/// Places of the balls of a block.
fn places(lattice: &Lattice) -> Vec<[f64; 3]> {
    let n = (PLANES * layer(lattice) / lattice.repeat[0]).round() as usize;
    let cells = (0..n.pow(3)).map(move |i| [i % n, i / n % n, i / n / n]);
    let at =
        |cell: [usize; 3], place: &[f64; 3]| std::array::from_fn(|k| place[k] + lattice.repeat[k] * cell[k] as f64);
    cells.flat_map(|cell| lattice.basis.iter().map(move |place| at(cell, place))).collect()
}

/// Distance of the planes of balls along an edge.
fn layer(lattice: &Lattice) -> f64 {
    let heights = lattice.basis.iter().map(|place| place[0]).filter(|&h| h > 0.0);
    heights.fold(lattice.repeat[0], f64::min)
}

/// The block at rest after its platens have come nearer.
fn loaded(places: &[[f64; 3]], bottom: f64, top: f64) -> Engine<D3> {
    let endless = f64::INFINITY;
    let spring = |mu| Linear::direct(KN, KS, mu);
    let bonded = Interaction { linear: spring(0.0), bond: Bond::Contact(ContactBond::new(endless, endless)) };
    let contacts =
        ContactTable::new().with(GRAIN, GRAIN, bonded).with(GRAIN, PLATEN, Interaction::unbonded(spring(0.0)));
    let platen = |y: f64, up: f64| Wall {
        point: [0.0, y, 0.0],
        normal: [0.0, up, 0.0],
        motion: Motion::Velocity([0.0; 3]),
        group: PLATEN,
    };
    let particles = places.iter().map(|&x| Particle::ball(x, RADIUS, 2000.0, GRAIN)).collect();
    let walls = vec![platen(bottom, 1.0), platen(top, -1.0)];
    let model = Model::<D3> { particles, clumps: vec![], walls, contacts, settings: Settings::default() };
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-6, 1).unwrap();
    let height = top - bottom;
    let rate = STRAIN / (LOADING as f64 * engine.time_step());
    for (wall, up) in [(0, 1.0), (1, -1.0)] {
        engine.move_wall(wall, Motion::Velocity([0.0, 0.5 * up * rate * height, 0.0])).unwrap();
    }
    for (i, x) in places.iter().enumerate() {
        engine.set_motion(i, [0.0, -rate * (x[1] - 0.5 * (bottom + top)), 0.0], [0.0; 3]).unwrap();
    }
    engine.advance(LOADING).unwrap();
    for wall in [0, 1] {
        engine.move_wall(wall, Motion::Velocity([0.0; 3])).unwrap();
    }
    engine.advance(RESTING).unwrap();
    assert!(measure::unbalanced_ratio(&engine) < 1e-6, "the block is not at rest");
    engine
}

/// Stress and strain of the balls inside along the first two axes, compression positive. Both are taken over the same contacts: the
/// neighbours of a ball lie opposite each other, so what varies from place to place cancels.
fn means(engine: &Engine<D3>, start: &[[f64; 3]], inside: &[bool], volume: f64) -> [[f64; 2]; 2] {
    let (mut virial, mut moment, mut square) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    for contact in engine.contacts() {
        let Other::Particle(second) = contact.other else { continue };
        let first = contact.particle;
        // Half of a contact belongs to each of its ends.
        let ends = 0.5 * f64::from(u8::from(inside[first]) + u8::from(inside[second]));
        for k in 0..2 {
            let apart = start[second][k] - start[first][k];
            let moved = engine.position(second)[k] - engine.position(first)[k] - apart;
            virial[k] -= ends * contact.force()[k] * contact.branch[k];
            moment[k] -= ends * apart * moved;
            square[k] += ends * apart * apart;
        }
    }
    let balls = inside.iter().filter(|&&i| i).count() as f64;
    [virial.map(|v| v / volume / balls), [0, 1].map(|k| moment[k] / square[k])]
}
