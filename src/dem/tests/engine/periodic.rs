//! Moduli of contact-bonded discs in a periodic cell, where no platen takes part.
//!
//! Discs of a ratio of radii of 1.66 are laid into the cell without contact, the cell shrinks without friction to a porosity, and the
//! packing comes to rest. Bonds form up to a gap. The cell is strained along each of its edges; from the stress come
//! C₁₁ and C₁₂, and of their means over the two directions E = C₁₁ − C₁₂²/C₁₁ and ν = C₁₂/C₁₁.
//!
//! Independent statics of two packings of this kind at a porosity of 0.16 gave E/E_c 0.79, 0.726, 0.677, 0.638, 0.555 and ν 0.147,
//! 0.209, 0.257, 0.295, 0.378 for κ = k_n/k_s of 1, 1.5, 2, 2.5, 4. How many bonds a disc had there is not known, and it matters. Means
//! of five packings here (`campaign`):
//!
//! | bonds up to | bonds a disc | E/E_c | ν |
//! |---|---|---|---|
//! | a touch | 1.90 | 0.735, 0.670, 0.623, 0.585, 0.507 | 0.128, 0.192, 0.240, 0.279, 0.362 |
//! | 0.3 % of the mean radius | 1.98 | 0.770, 0.702, 0.652, 0.613, 0.533 | 0.115, 0.181, 0.230, 0.268, 0.350 |
//! | 1 % | 2.04 | 0.806, 0.735, 0.683, 0.643, 0.561 | 0.106, 0.172, 0.221, 0.259, 0.339 |
//!
//! With 1.98 bonds a disc E/E_c lies 2.6 to 4.0 % and ν 0.027 to 0.032 below the statics.

use crate::block::{GRAIN, model};
use crate::case::{Case, Family, Near};
use crate::lattice::of_sheet;
use dem::*;
use math::random::Stream;
use std::sync::LazyLock;

const MODULUS: f64 = 20e9;
/// Mean radius, m.
const RADIUS: f64 = 0.5e-3;
const RATIO: f64 = 1.66;
/// Share of the cell that the discs fill when they are laid.
const LOOSE: f64 = 0.45;

/// Discs of a packing.
const COUNT: usize = 1500;
/// Gap over the mean radius up to which bonds form.
const GAP: f64 = 0.003;
/// κ, E/E_c and ν of the independent statics.
const STATICS: [[f64; 3]; 5] =
    [[1.0, 0.79, 0.147], [1.5, 0.726, 0.209], [2.0, 0.677, 0.257], [2.5, 0.638, 0.295], [4.0, 0.555, 0.378]];

/// Edge of a square periodic cell, its discs with their places, and how many contacts a disc has.
struct Packed {
    edge: f64,
    discs: Vec<([f64; 2], f64)>,
    contacts: f64,
}

/// Discs laid one by one without contact.
fn laid(count: usize, seed: u64) -> Packed {
    let mut stream = Stream::new(seed, "periodic", 0);
    let low = 2.0 * RADIUS / (1.0 + RATIO);
    let radii: Vec<f64> = (0..count).map(|_| stream.uniform_in(low, RATIO * low)).collect();
    let area: f64 = radii.iter().map(|r| std::f64::consts::PI * r * r).sum();
    let edge = (area / LOOSE).sqrt();
    let mut discs: Vec<([f64; 2], f64)> = Vec::with_capacity(count);
    for r in radii {
        let free = |x: [f64; 2]| discs.iter().all(|&(y, s)| between(x, y, edge) > r + s);
        let place = loop {
            let x = [stream.uniform_in(0.0, edge), stream.uniform_in(0.0, edge)];
            if free(x) {
                break x;
            }
        };
        discs.push((place, r));
    }
    Packed { edge, discs, contacts: 0.0 }
}

/// Distance of the nearest images.
fn between(x: [f64; 2], y: [f64; 2], edge: f64) -> f64 {
    let [a, b] = [0, 1].map(|k| {
        let d = (x[k] - y[k]).abs() % edge;
        d.min(edge - d)
    });
    (a * a + b * b).sqrt()
}

fn engine(packed: &Packed, law: Interaction) -> Engine<D2> {
    let balls = packed.discs.iter().map(|&(x, r)| Particle::ball(x, r, 2650.0, GRAIN)).collect();
    let cell = Cell { low: [0.0; 2], edges: [packed.edge; 2], rate: [[0.0; 3]; 3] };
    Engine::new(&model::<D2>(balls, vec![], law, Settings { cell: Some(cell), ..Settings::default() })).unwrap()
}

/// The discs of an engine as they lie in its cell now.
fn taken(engine: &Engine<D2>, radii: impl Iterator<Item = f64>) -> Packed {
    let edge = engine.cell_volume().unwrap().sqrt();
    let place = |i: usize| engine.position(i).map(|x| x.rem_euclid(edge));
    let discs: Vec<_> = radii.enumerate().map(|(i, r)| (place(i), r)).collect();
    let touching = engine.contacts().filter(|c| c.active).count();
    Packed { edge, contacts: 2.0 * touching as f64 / discs.len() as f64, discs }
}

/// A packing of `count` discs at rest at a porosity.
fn packing(count: usize, porosity: f64, seed: u64) -> Packed {
    let loose = laid(count, seed);
    let mut engine = engine(&loose, Interaction::unbonded(Linear::modulus(MODULUS, 1.0, 0.0)));
    let area = LOOSE * loose.edge * loose.edge;
    let wanted = area / (1.0 - porosity);
    // The cell shrinks by 0.003 % of its edge while a wave runs through ten discs.
    let rate = 3e-5 / (20.0 * RADIUS / (MODULUS / 2650.0_f64).sqrt());
    engine.strain_cell([[-rate, 0.0, 0.0], [0.0, -rate, 0.0], [0.0; 3]]).unwrap();
    while engine.cell_volume().unwrap() > wanted {
        engine.advance(1).unwrap();
    }
    engine.strain_cell([[0.0; 3]; 3]).unwrap();
    for _ in 0..200 {
        engine.advance(500).unwrap();
        if measure::unbalanced_ratio(&engine) < 1e-5 {
            break;
        }
    }
    taken(&engine, loose.discs.iter().map(|d| d.1))
}

/// E/E_c, ν and bonds a disc.
fn moduli(packed: &Packed, bond: Bond, kappa: f64, gap: f64) -> [f64; 3] {
    let law = Interaction { linear: Linear::modulus(MODULUS, kappa, 0.5), bond };
    let mut bonds = 0;
    let mut stiffness = |axis: usize| {
        let mut engine = engine(packed, law);
        bonds = engine.install_bonds(gap * RADIUS, 1).unwrap();
        engine.absorb_overlaps();
        let (steps, strain) = (15_000_u64, 1e-5);
        let mut rate = [[0.0; 3]; 3];
        rate[axis][axis] = -strain / (steps as f64 * engine.time_step());
        engine.strain_cell(rate).unwrap();
        engine.advance(steps).unwrap();
        let stress = measure::cell_stress(&engine).unwrap();
        [stress[axis][axis] / strain, stress[1 - axis][1 - axis] / strain]
    };
    let [x, y] = [stiffness(0), stiffness(1)];
    let [c11, c12] = [0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1])];
    let [young, poisson] = of_sheet(c11, c12);
    [young / MODULUS, poisson, bonds as f64 / packed.discs.len() as f64]
}

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
        let packings: Vec<Packed> = (0..2).map(|seed| packing(COUNT, 0.16, seed)).collect();
        STATICS.iter().filter(|s| [1.0, 2.5].contains(&s[0])).flat_map(|&known| rows(&packings, known)).collect()
    });
    let about = "Mean of two packings of 1500 discs at a porosity of 0.16 in a periodic cell, ratio of radii 1.66; contact bonds up to a gap of \
        0.3 % of the mean radius. The values beside them are independent statics of two packings of that kind.";
    Family { title: "Moduli of contact-bonded packings in a periodic cell", about, cases: &CASES }
}

fn rows(packings: &[Packed], [kappa, known_e, known_nu]: [f64; 3]) -> [Case; 2] {
    let [e, nu, _] = means(packings, contact, kappa, GAP);
    [
        Case::new(format!("κ = {kappa}: E/E_c"), "independent statics", known_e, e, Near::Relative(0.06)),
        Case::new(format!("κ = {kappa}: ν"), "independent statics", known_nu, nu, Near::Absolute(0.04)),
    ]
}

#[test]
fn moduli_of_contact_bonds_follow_independent_statics() {
    family().check();
}

/// Means over packings.
fn means(packings: &[Packed], bond: impl Fn(f64) -> Bond, kappa: f64, gap: f64) -> [f64; 3] {
    let found: Vec<[f64; 3]> = packings.iter().map(|p| moduli(p, bond(kappa), kappa, gap)).collect();
    [0, 1, 2].map(|k| found.iter().map(|f| f[k]).sum::<f64>() / found.len() as f64)
}

fn contact(_: f64) -> Bond {
    Bond::Contact(ContactBond::new(f64::INFINITY, f64::INFINITY))
}

fn parallel(kappa: f64) -> Bond {
    Bond::Parallel(ParallelBond::new(MODULUS, kappa, f64::INFINITY, f64::INFINITY))
}

#[test]
#[ignore = "minutes; prints moduli of contact and parallel bonds in five periodic packings"]
fn campaign() {
    let packings: Vec<Packed> = (0..5).map(|seed| packing(COUNT, 0.16, seed)).collect();
    let contacts: Vec<f64> = packings.iter().map(|p| p.contacts).collect();
    println!("contacts a disc {contacts:.3?}");
    for kappa in STATICS.map(|s| s[0]) {
        for gap in [1e-6, GAP, 0.01] {
            println!("contact bonds, κ {kappa}, gap {gap}: {:.4?}", means(&packings, contact, kappa, gap));
        }
        println!("parallel bonds, κ {kappa}, gap {GAP}: {:.4?}", means(&packings, parallel, kappa, GAP));
    }
}
