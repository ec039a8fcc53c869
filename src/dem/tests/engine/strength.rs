//! Strengths that scatter: what the bonds of a lattice carry, against the law they are drawn from.
//!
//! Each strength is m (1 + δ z), z standard normal, drawn again while it is not above 0: the normal law N(m, δm) cut off at
//! 0. With α = −1/δ and λ = φ(α)/(1 − Φ(α)) its mean is m (1 + δλ) and its variance (δm)² (1 + αλ − λ²). D is the largest
//! distance of the two distribution functions (Kolmogorov–Smirnov); 1 % of all samples of n have √n D above 1.628.
//! Tolerances of moments are three standard errors; that of a standard
//! deviation is √((κ − 1)/4n) of it, with κ the kurtosis of the law (3 taken for the cut normal one).
//!
//! Weibull's law is drawn from its mean and standard deviation: √(4/π − 1) of the mean makes it Rayleigh's, 1 − exp(−πx²/4), and 1
//! the exponential one, 1 − exp(−x).

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::elementary::exp;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::sync::LazyLock;

/// Mean strengths, Pa.
const MEANS: [f64; 2] = [10e6, 15e6];
/// √n D that 1 % of all samples exceed.
const KOLMOGOROV: f64 = 1.628;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Every bond of a square lattice of 90 × 90 discs (cement) and of a simple cubic one of 18 × 18 × 18 spheres (contact \
        bonds): the largest forces that it carries over its section and over the mean strength. The law is the normal one cut \
        off at 0, of standard deviation δ; of Weibull's the two that have names: Rayleigh's law in tension, the exponential one in \
        shear.";
    Family { title: "Strengths that scatter", about, cases: &CASES }
}

#[test]
fn strengths_follow_their_law() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let cement = |scatter| {
        Bond::Parallel(ParallelBond {
            radius_multiplier: 0.8,
            stiffness: BondStiffness::Modulus { modulus: 1e9, ratio: 2.5 },
            tensile_strength: MEANS[0],
            cohesion: MEANS[1],
            friction_angle: 0.3,
            moment_factor: 1.0,
            scatter,
        })
    };
    let point = |scatter| {
        let [tensile_strength, shear_strength] = MEANS;
        Bond::Contact(ContactBond { tensile_strength, shear_strength, scatter, shear_break: ShearBreak::Keep })
    };
    let normal = |deviation| (Scatter::both(deviation), [cut_normal(deviation), cut_normal(deviation)]);
    let (scatter, laws) = normal(0.2);
    compared::<D2>("2D, parallel bond", cement(scatter), laws, 90, 0.8, &mut cases);
    let (scatter, laws) = normal(0.5);
    compared::<D3>("3D, contact bond", point(scatter), laws, 18, 1.0, &mut cases);
    let (laws, tensile) = ([rayleigh(), exponential()], (4.0 / PI - 1.0).sqrt());
    let scatter = Scatter { tensile, shear: 1.0, distribution: Distribution::Weibull };
    compared::<D2>("2D, contact bond, Weibull", point(scatter), laws, 90, 1.0, &mut cases);
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

/// What the strengths over their means follow.
struct Law {
    name: String,
    mean: (&'static str, f64),
    spread: (&'static str, f64),
    kurtosis: f64,
    below: Box<dyn Fn(f64) -> f64>,
}

/// N(1, δ) cut off at 0.
fn cut_normal(deviation: f64) -> Law {
    let alpha = -1.0 / deviation;
    let hazard = exp(-0.5 * alpha * alpha) / TAU.sqrt() / (1.0 - below(alpha));
    let cut = below(alpha);
    Law {
        name: format!("δ = {deviation}"),
        mean: ("1 + δλ", 1.0 + deviation * hazard),
        spread: ("δ √(1 + αλ − λ²)", deviation * (1.0 + alpha * hazard - hazard * hazard).sqrt()),
        kurtosis: 3.0,
        below: Box::new(move |x| (below((x - 1.0) / deviation) - cut) / (1.0 - cut)),
    }
}

/// Weibull's law of shape 2 is Rayleigh's.
fn rayleigh() -> Law {
    Law {
        name: "δ = √(4/π − 1)".to_owned(),
        mean: ("1", 1.0),
        spread: ("√(4/π − 1)", (4.0 / PI - 1.0).sqrt()),
        kurtosis: 3.0 + (-6.0 * PI * PI + 24.0 * PI - 16.0) / ((4.0 - PI) * (4.0 - PI)),
        below: Box::new(|x| 1.0 - exp(-0.25 * PI * x * x)),
    }
}

/// Weibull's law of shape 1 is the exponential one.
fn exponential() -> Law {
    Law {
        name: "δ = 1".to_owned(),
        mean: ("1", 1.0),
        spread: ("1", 1.0),
        kurtosis: 9.0,
        below: Box::new(|x| 1.0 - exp(-x)),
    }
}

/// Distance of a sample from its law.
fn distance(sample: &[f64], law: &Law) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let step = |(k, &x): (usize, &f64)| ((law.below)(x) - k as f64 / n).max((k + 1) as f64 / n - (law.below)(x));
    sorted.iter().enumerate().map(step).fold(0.0, f64::max)
}

fn compared<S: Space>(name: &str, bond: Bond, laws: [Law; 2], side: usize, multiplier: f64, cases: &mut Vec<Case>) {
    let samples = drawn::<S>(bond, side, multiplier);
    let n = samples[0].len() as f64;
    for ((what, sample), law) in ["tensile", "shear"].into_iter().zip(&samples).zip(&laws) {
        let mut push = |what: &str, source, expected, got, near| {
            cases.push(Case::new(format!("{name}, {}: {what}", law.name), source, expected, got, near));
        };
        let ((mean_source, mean), (spread_source, spread)) = (law.mean, law.spread);
        let [own_mean, own_spread] = moments(sample);
        let near = [
            Near::Relative(3.0 * spread / mean / n.sqrt()),
            Near::Relative(3.0 * ((law.kurtosis - 1.0) / (4.0 * n)).sqrt()),
        ];
        push(&format!("mean of the {what} strength"), mean_source, mean, own_mean, near[0]);
        push("its standard deviation", spread_source, spread, own_spread, near[1]);
        let distance = distance(sample, law);
        push("its distance D from the law", "1.628/√n", KOLMOGOROV / n.sqrt(), distance, Near::Below);
        let least = sample.iter().copied().fold(f64::INFINITY, f64::min);
        push("its smallest value", "above 0", f64::MIN_POSITIVE, least, Near::Above);
    }
    let centred = [0, 1].map(|k| {
        let [mean, spread] = moments(&samples[k]);
        samples[k].iter().map(|x| (x - mean) / spread).collect::<Vec<f64>>()
    });
    let together = centred[0].iter().zip(&centred[1]).map(|(a, b)| a * b).sum::<f64>() / (n - 1.0);
    let name = format!("{name}, {}: correlation of the two strengths", laws[0].name);
    cases.push(Case::new(name, "0", 0.0, together, Near::Absolute(3.0 / n.sqrt())));
}
