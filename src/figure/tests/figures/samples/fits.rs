//! Models, calibrations, verifications.

use super::factors;
use figure::Quantity;
use figure::agreement::{Agreement, Cloud, Pair};
use figure::convergence::{Convergence, Descent};
use figure::effect_plot::{Coordinates, Effect, EffectPlot};
use figure::residuals::Residuals;
use figure::solutions::{SolutionSet, Solutions};
use figure::verification::{Check, Verification};
use math::random::Stream;

/// The filtration rate example of the textbooks: 15 effects of a 2⁴ design.
pub(super) fn effect_plot(coordinates: Coordinates) -> EffectPlot {
    let names = ["A", "B", "C", "D", "E", "AB", "AC", "AD", "AE", "BC", "BD", "BE", "CD", "CE", "DE"];
    let mut effects = [21.6, 3.1, 9.9, 14.6, 0.4, 1.2, -18.1, 16.6, -0.4, 2.4, -0.4, -1.1, -1.9, 4.1, -2.6];
    let half = [0.04, 0.13, 0.21, 0.3, 0.38, 0.48, 0.57, 0.67, 0.78, 0.9, 1.02, 1.17, 1.35, 1.6, 2.13];
    let full = [-1.83, -1.28, -0.97, -0.73, -0.52, -0.34, -0.17, 0.0, 0.17, 0.34, 0.52, 0.73, 0.97, 1.28, 1.83];
    let signed = coordinates == Coordinates::Normal;
    if !signed {
        effects = effects.map(f64::abs);
    }
    let mut order: Vec<usize> = (0..15).collect();
    order.sort_by(|&a, &b| f64::total_cmp(&effects[a], &effects[b]));
    let effect = |(rank, &i): (usize, &usize)| Effect {
        name: format!("${}$", names[i]),
        size: effects[i],
        quantile: if signed { full[rank] } else { half[rank] },
        active: effects[i].abs() > 6.7,
    };
    EffectPlot {
        standardized: false,
        response: Quantity::new("Filtration rate", "", "gal/h"),
        coordinates,
        effects: order.iter().enumerate().map(effect).collect(),
        error: 2.62,
        margin: Some(("margin of error".into(), 6.7)),
    }
}

pub(super) fn residuals() -> Residuals {
    let n = 46;
    let mut random = Stream::new(9, "residuals", 0);
    let mut studentized: Vec<f64> = (0..n).map(|_| 0.95 * random.normal()).collect();
    studentized[17] = 3.9;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| studentized[a].total_cmp(&studentized[b]));
    let mut quantiles = vec![0.0; n];
    for (rank, &i) in order.iter().enumerate() {
        let p: f64 = (rank as f64 + 0.625) / (n as f64 + 0.25);
        quantiles[i] = 4.91 * (p.powf(0.14) - (1.0 - p).powf(0.14));
    }
    Residuals {
        response: Quantity::new("Elastic modulus", "E", "GPa"),
        runs: (1..=n).map(|i| i.to_string()).collect(),
        fitted: (0..n).map(|_| random.uniform_in(16.0, 58.0)).collect(),
        studentized,
        quantiles,
        leverage: (0..n).map(|i| if i % 9 == 0 { 0.16 } else { 0.42 + 0.01 * random.normal() }).collect(),
        coefficients: 21,
        limit: 3.5,
    }
}

fn cloud(name: &str, n: usize, low: f64, high: f64, noise: f64, purpose: &str) -> Cloud {
    let mut random = Stream::new(2, purpose, 0);
    let x: Vec<f64> = (0..n).map(|_| random.uniform_in(low, high)).collect();
    let y = x.iter().map(|v| v * (1.0 + noise * random.normal())).collect();
    Cloud { name: name.into(), rows: (1..=n).map(|i| i.to_string()).collect(), x, y }
}

pub(super) fn published() -> Agreement {
    let pair = |q: Quantity, low: f64, high: f64, noise: f64, other: &str, m: usize| Pair {
        clouds: vec![
            cloud("orthogonal table", 64, low, high, noise, &q.name),
            cloud(other, m, low, high, 0.8 * noise, other),
        ],
        note: format!("mean deviation {} %", if noise > 0.05 { "+3.1" } else { "−0.6" }),
        quantity: q,
    };
    Agreement {
        x_word: "Published".into(),
        y_word: "Computed".into(),
        pairs: vec![
            pair(Quantity::new("Peak strength", r"\sigma_u", "MPa"), 17.0, 62.0, 0.07, "central composite", 13),
            pair(Quantity::new("Elastic modulus", "E", "GPa"), 14.0, 58.0, 0.03, "Box–Behnken", 46),
            pair(Quantity::new("Poisson's ratio", r"\nu", ""), 0.09, 0.38, 0.05, "Box–Behnken", 27),
        ],
        band: Some(0.1),
    }
}

pub(super) fn observed() -> Agreement {
    let quantity = Quantity::new("Elastic modulus", "E", "GPa");
    let pair = Pair {
        quantity,
        clouds: vec![cloud("", 46, 16.0, 58.0, 0.02, "observed")],
        note: "$R^2$ = 0.9964, $R^2_{pred}$ = 0.9871".into(),
    };
    Agreement { x_word: "Observed".into(), y_word: "Predicted".into(), pairs: vec![pair], band: None }
}

pub(super) fn convergence() -> Convergence {
    let run = |k: u64| {
        let mut random = Stream::new(2, "descent", k);
        let effort: Vec<f64> = (0..=120).map(f64::from).collect();
        let mut best = Vec::new();
        let mut now = 0.9;
        for _ in &effort {
            if random.uniform() < 0.35 {
                now *= random.uniform_in(0.55, 0.98);
            }
            best.push(now);
        }
        let median = best.iter().map(|b| 3.0 * b + 0.01).collect();
        Descent { name: format!("target {}", k + 1), effort, best, median }
    };
    Convergence { effort: "Generation".into(), misfit: "Misfit $f$ / –".into(), runs: (0..5).map(run).collect() }
}

pub(super) fn solutions(sets: u64) -> Solutions {
    let keep = [0, 1, 2, 3, 4, 8, 9];
    let all = factors();
    let factors: Vec<Quantity> = keep.iter().map(|&k| all[k].0.clone()).collect();
    let bounds: Vec<[f64; 2]> = keep.iter().map(|&k| [all[k].2[0], all[k].2[2]]).collect();
    let set = |k: u64| {
        let mut random = Stream::new(2, "solutions", k);
        let centre: Vec<f64> =
            bounds.iter().map(|b| random.uniform_in(b[0] + 0.2 * (b[1] - b[0]), b[1] - 0.2 * (b[1] - b[0]))).collect();
        let n = if sets == 1 { 120 } else { 25 };
        let mut misfit: Vec<f64> = (0..n).map(|_| 0.002 + 0.05 * random.uniform()).collect();
        misfit.sort_by(f64::total_cmp);
        let row = |m: &f64| {
            let spread = |(c, b): (&f64, &[f64; 2])| (c + 4.0 * m * (b[1] - b[0]) * random.normal()).clamp(b[0], b[1]);
            centre.iter().zip(&bounds).map(spread).collect()
        };
        let rows = misfit.iter().map(row).collect();
        SolutionSet { name: format!("target {}", k + 1), rows, misfit }
    };
    let sets = (0..sets).map(set).collect();
    Solutions { factors, bounds, sets }
}

pub(super) fn verification() -> Verification {
    let check = |response: Quantity, target: [f64; 5], noise: f64| {
        let mut random = Stream::new(4, &response.name, 0);
        let runs =
            target.iter().map(|t| (0..5).map(|_| t * (1.0 + 0.01 + noise * random.normal())).collect()).collect();
        Check { response, target: target.to_vec(), runs }
    };
    Verification {
        sets: (1..=5).map(|i| i.to_string()).collect(),
        checks: vec![
            check(Quantity::new("Peak strength", r"\sigma_u", "MPa"), [59.67, 42.67, 36.54, 47.67, 30.1], 0.04),
            check(Quantity::new("Elastic modulus", "E", "GPa"), [32.68, 26.78, 25.66, 21.54, 40.2], 0.025),
            check(Quantity::new("Poisson's ratio", r"\nu", ""), [0.201, 0.209, 0.218, 0.222, 0.15], 0.05),
        ],
    }
}
