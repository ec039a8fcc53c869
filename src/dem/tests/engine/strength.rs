//! Strengths that scatter: what the bonds of a lattice carry, against the law they are drawn from.
//!
//! Each strength is m (1 + δ z), z standard normal, drawn again while it is not above 0: the normal law N(m, δm) cut off at
//! 0. With α = −1/δ and λ = φ(α)/(1 − Φ(α)) its mean is m (1 + δλ) and its variance (δm)² (1 + αλ − λ²). D is the largest
//! distance of the two distribution functions (Kolmogorov–Smirnov); 1 % of all samples of n have √n D above 1.628.
//! Tolerances of moments are three standard errors.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::elementary::exp;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::sync::LazyLock;

/// Mean strengths, Pa.
const MEANS: [f64; 2] = [10e6, 15e6];
/// √n D that 1 % of all samples exceed.
const KOLMOGOROV: f64 = 1.628;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Every bond of a square lattice of 90 × 90 discs (cement) and of a simple cubic one of 18 × 18 × 18 spheres (contact \
        bonds): the largest forces that it carries over its section and over the mean strength. The law is the normal one cut \
        off at 0, of standard deviation δ.";
    Family { title: "Strengths that scatter", about, cases: &CASES }
}

#[test]
fn strengths_follow_their_law() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let cement = |deviation| {
        Bond::Parallel(ParallelBond {
            radius_multiplier: 0.8,
            stiffness: BondStiffness::Modulus { modulus: 1e9, ratio: 2.5 },
            tensile_strength: MEANS[0],
            cohesion: MEANS[1],
            friction_angle: 0.3,
            moment_factor: 1.0,
            deviation,
        })
    };
    let point = |deviation| {
        let [tensile_strength, shear_strength] = MEANS;
        Bond::Contact(ContactBond { tensile_strength, shear_strength, deviation, shear_break: ShearBreak::Keep })
    };
    compared::<D2>("2D, parallel bond", cement(0.2), 0.2, 90, 0.8, &mut cases);
    compared::<D3>("3D, contact bond", point(0.5), 0.5, 18, 1.0, &mut cases);
    cases
}

/// Strengths over their means of all bonds of a square (cubic) lattice of unit balls.
fn drawn<S: Space>(bond: Bond, side: usize, multiplier: f64) -> [Vec<f64>; 2] {
    let count = side.pow(S::DIMENSION as u32);
    let place = |p: usize| Vector::<S>::build(|k| (p / side.pow(k as u32) % side) as f64);
    let balls = (0..count).map(|p| Particle::ball(place(p), 0.5, 2000.0, GRAIN)).collect();
    let law = Interaction { linear: Linear::direct(1e6, 5e5, 0.0), bond };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, Settings::default())).unwrap();
    assert_eq!(engine.install_bonds(1e-6, 11).unwrap(), S::DIMENSION * count / side * (side - 1));
    let bonds: Vec<[f64; 2]> = engine.contacts().filter(|c| c.bonded).map(|c| c.capacity).collect();
    let section = S::section(0.5 * multiplier);
    [0, 1].map(|k| bonds.iter().map(|forces| forces[k] / section / MEANS[k]).collect())
}

/// Mean, standard deviation.
fn moments(sample: &[f64]) -> [f64; 2] {
    let n = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / n;
    let square: f64 = sample.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, (square / (n - 1.0)).sqrt()]
}

/// Φ.
fn below(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Distance of a sample from the normal law N(1, δ) cut off at 0.
fn distance(sample: &[f64], deviation: f64) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let cut = below(-1.0 / deviation);
    let law = |x: f64| (below((x - 1.0) / deviation) - cut) / (1.0 - cut);
    let step = |(k, &x): (usize, &f64)| (law(x) - k as f64 / n).max((k + 1) as f64 / n - law(x));
    sorted.iter().enumerate().map(step).fold(0.0, f64::max)
}

fn compared<S: Space>(name: &str, bond: Bond, deviation: f64, side: usize, multiplier: f64, cases: &mut Vec<Case>) {
    let samples = drawn::<S>(bond, side, multiplier);
    let n = samples[0].len() as f64;
    let alpha = -1.0 / deviation;
    let hazard = exp(-0.5 * alpha * alpha) / TAU.sqrt() / (1.0 - below(alpha));
    let mean = 1.0 + deviation * hazard;
    let spread = deviation * (1.0 + alpha * hazard - hazard * hazard).sqrt();
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("{name}, δ = {deviation}: {what}"), source, expected, got, near));
    };
    for (what, sample) in ["tensile", "shear"].into_iter().zip(&samples) {
        let [own_mean, own_spread] = moments(sample);
        let near = [Near::Relative(3.0 * spread / mean / n.sqrt()), Near::Relative(3.0 / (2.0 * n).sqrt())];
        push(&format!("mean of the {what} strength"), "1 + δλ", mean, own_mean, near[0]);
        push("its standard deviation", "δ √(1 + αλ − λ²)", spread, own_spread, near[1]);
        let distance = distance(sample, deviation);
        push("its distance D from the law", "1.628/√n", KOLMOGOROV / n.sqrt(), distance, Near::Below);
        let least = sample.iter().copied().fold(f64::INFINITY, f64::min);
        push("its smallest value", "above 0", f64::MIN_POSITIVE, least, Near::Above);
    }
    let centred = [0, 1].map(|k| {
        let [mean, spread] = moments(&samples[k]);
        samples[k].iter().map(|x| (x - mean) / spread).collect::<Vec<f64>>()
    });
    let together = centred[0].iter().zip(&centred[1]).map(|(a, b)| a * b).sum::<f64>() / (n - 1.0);
    push("correlation of the two strengths", "0", 0.0, together, Near::Absolute(3.0 / n.sqrt()));
}
