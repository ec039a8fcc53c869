//! An elastic disc under two opposite point loads P: at its centre tension 2P/(πD t) across the load and compression
//! 6P/(πD t) along it, whatever E and ν.
//!
//! The disc is cut out of the hexagonal lattice, which is isotropic in the plane; cement alone, so that tension and
//! compression are one. The stress is measured in a disc of 0.4 of the diameter; there the mean of the exact field (two
//! Flamant fields, −2P cos θ/(πr) along the rays, and the tension 2P/(πD) all round) is summed over a grid.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Rows between the loaded discs of the coarse disc, even; the fine one has twice as many.
const ROWS: i32 = 28;
/// P, N.
const LOAD: f64 = 1e3;
/// Radius of the measuring disc over the diameter: smaller ones hold too few contacts for a mean.
const MEASURED: f64 = 0.2;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Discs of 28 and 56 rows of discs of radius 0.5 m, cut out of the hexagonal lattice, cement alone, Ē 1 GPa, k̄_n/k̄_s \
        2.5; P = 1 kN on the top and the bottom one, damped to rest. Stresses over 2P/(πD), tension positive, mean of the inner \
        0.4 of the diameter. The ragged edge of so few rows is what is off: it falls with their number.";
    Family { title: "Elastic disc under diametral load", about, cases: &CASES }
}

#[test]
fn a_disc_has_its_elastic_stresses() {
    family().check();
}

/// Exact stresses (across, along) at a point over 2P/(πD), tension positive; the loads act at (0, ±D/2).
fn exact([x, y]: [f64; 2], diameter: f64) -> [f64; 2] {
    let mut stress = [1.0, 1.0];
    for side in [-1.0, 1.0] {
        // From the load inwards: depth and offset.
        let (depth, square) = (0.5 * diameter - side * y, x * x + (0.5 * diameter - side * y).powi(2));
        let share = -diameter * depth / (square * square);
        stress = [stress[0] + share * x * x, stress[1] + share * depth * depth];
    }
    stress
}

/// Measured stresses (across, along) over 2P/(πD), tension positive, of a disc with `rows` rows between the loads, even.
fn measured(rows: i32) -> [f64; 2] {
    let rise = 0.75_f64.sqrt();
    let diameter = f64::from(rows) * rise;
    let mut balls = Vec::new();
    for row in -rows / 2..=rows / 2 {
        for column in -rows..=rows {
            let x = [f64::from(column) + if row % 2 == 0 { 0.0 } else { 0.5 }, f64::from(row) * rise];
            if x.norm() < 0.5 * diameter + 1e-6 {
                balls.push(Particle::<D2>::ball(x, 0.5, 2000.0, GRAIN));
            }
        }
    }
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::Modulus { modulus: 1e9, ratio: 2.5 },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    let law = Interaction { linear: Linear::direct(1e-6, 1e-6, 0.0), bond: Bond::Parallel(bond) };
    let last = balls.len() - 1;
    let mut engine = Engine::new(&model::<D2>(balls, vec![], law, Settings::default())).unwrap();
    engine.install_bonds(1e-6, 0).unwrap();
    engine.apply(0, [0.0, LOAD], [0.0]).unwrap();
    engine.apply(last, [0.0, -LOAD], [0.0]).unwrap();
    engine.advance(4000).unwrap();
    let unit = 2.0 * LOAD / (PI * diameter);
    let region = measure::Region::<D2>::Ball { centre: [0.0; 2], radius: MEASURED * diameter };
    let found = measure::stress(&engine, &region);
    [-found[0][0] / unit, -found[1][1] / unit]
}

/// Mean of the exact field over the measuring disc, summed over a grid.
fn mean_field() -> [f64; 2] {
    let grid = 100;
    let inner: Vec<[f64; 2]> = (0..grid * grid)
        .map(|k| [k % grid, k / grid].map(|c| MEASURED * (2.0 * (f64::from(c) + 0.5) / f64::from(grid) - 1.0)))
        .filter(|x| x.norm() <= MEASURED)
        .collect();
    let sum = inner.iter().map(|&x| exact(x, 1.0)).fold([0.0; 2], |sum, stress| [0, 1].map(|k| sum[k] + stress[k]));
    sum.map(|x| x / inner.len() as f64)
}

fn cases() -> Vec<Case> {
    let (coarse, fine) = (measured(ROWS), measured(2 * ROWS));
    let (centre, mean) = (exact([0.0; 2], 1.0), mean_field());
    let exactly = Near::Relative(1e-12);
    let mut cases = vec![
        Case::new("exact field at the centre, across the load", "1: 2P/(πD)", 1.0, centre[0], exactly),
        Case::new("exact field at the centre, along the load", "−3: 6P/(πD)", -3.0, centre[1], exactly),
    ];
    for (rows, found, share) in [(ROWS, coarse, 0.1), (2 * ROWS, fine, 0.02)] {
        let mut add = |what: &str, source, expected, got| {
            cases.push(Case::new(format!("2D, {rows} rows: {what}"), source, expected, got, Near::Relative(share)));
        };
        add("across the load", "mean of the exact field", mean[0], found[0]);
        add("along the load", "mean of the exact field", mean[1], found[1]);
        add("their sum", "−2: harmonic", -2.0, found[0] + found[1]);
    }
    cases
}
