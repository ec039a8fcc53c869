//! Strength, moduli, Poisson's ratios and crack stresses as they are read from a record, against records in closed form.
//!
//! With x the axial strain over that at the peak, ε_p: σ = E ε_p (x − x²/2), lateral strain ε_p (a x + b x³), cracks
//! N ((x − x₀)/(1 − x₀))² from x₀ on. Then σ_u = E ε_p/2; half of it is reached at x₅₀ = 1 − √½, a share p of it at
//! 1 − √(1 − p). Secant: E (1 − x₅₀/2), a + b x₅₀². The least-squares line over an interval of middle m and half width h has
//! slope E (1 − m) for the stress and a + b (3m² + 3h²/5) for the lateral strain. 1 % of the cracks at the peak exist at
//! x₀ + (1 − x₀)/10; the volume is smallest where a + 3b x² = 1.

use crate::case::{Case, Family, Near};
use dem::loading::curve::{Macro, Sample, evaluate};
use std::sync::LazyLock;

const MODULUS: f64 = 40e9;
/// Strain at the peak.
const PEAK: f64 = 1e-3;
/// a and b.
const LATERAL: [f64; 2] = [0.2, 0.4];
/// x₀.
const ONSET: f64 = 0.4;
/// N, and samples up to the peak.
const COUNT: f64 = 1e4;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Records of 10,000 samples to the peak: E 40 GPa, ε_p 10⁻³, a 0.2, b 0.4, x₀ 0.4; one that falls back after 0.6 of its \
        peak and reaches half of it twice; and a straight one.";
    Family { title: "Quantities read from a record", about, cases: &CASES }
}

#[test]
fn quantities_have_their_definitions() {
    family().check();
}

fn record(stress: impl Fn(f64) -> f64, end: f64) -> Macro {
    let [a, b] = LATERAL;
    let sample = |k: usize| {
        let x = k as f64 / COUNT;
        let share = ((x - ONSET) / (1.0 - ONSET)).max(0.0);
        let cracks = (COUNT * share * share) as usize;
        Sample { axial: PEAK * x, lateral: PEAK * (a * x + b * x * x * x), stress: stress(x), cracks, speed: 0.02 }
    };
    evaluate(&(0..=(end * COUNT) as usize).map(sample).collect::<Vec<Sample>>())
}

fn cases() -> Vec<Case> {
    let stress = |x: f64| MODULUS * PEAK * (x - 0.5 * x * x);
    let curved = record(stress, 1.5);
    let [a, b] = LATERAL;
    let reach = |share: f64| 1.0 - (1.0 - share).sqrt();
    let (half, ends) = (reach(0.5), [reach(0.4), reach(0.6)]);
    let (middle, width) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
    let tangent = a + b * (3.0 * middle * middle + 0.6 * width * width);
    let damage = ((1.0 - a) / (3.0 * b)).sqrt();
    let fine = Near::Relative(1e-6);
    let sampled = Near::Relative(5e-4);
    let mut cases = vec![
        Case::new("strength, Pa", "E ε_p/2", 0.5 * MODULUS * PEAK, curved.strength, fine),
        Case::new("strain at the peak", "ε_p", PEAK, curved.peak_strain, fine),
        Case::new(
            "secant E at half the peak, Pa",
            "E (1 − x₅₀/2)",
            MODULUS * (1.0 - 0.5 * half),
            curved.modulus_secant,
            fine,
        ),
        Case::new("tangent E over 40–60 %, Pa", "E (1 − m)", MODULUS * (1.0 - middle), curved.modulus_tangent, sampled),
        Case::new("secant ν at half the peak", "a + b x₅₀²", a + b * half * half, curved.poisson_secant, fine),
        Case::new("tangent ν over 40–60 %", "a + b (3m² + 3h²/5)", tangent, curved.poisson_tangent, sampled),
        Case::new(
            "crack initiation (1 % of the cracks), Pa",
            "σ(x₀ + (1 − x₀)/10)",
            stress(ONSET + 0.1 * (1.0 - ONSET)),
            curved.crack_initiation,
            sampled,
        ),
        Case::new(
            "crack damage (reversal of the volume), Pa",
            "σ(√((1 − a)/3b))",
            stress(damage),
            curved.crack_damage,
            sampled,
        ),
    ];
    // Half the peak is passed on the way to 0.6 of it, on the fall to 0.3, and on the second rise.
    let twice = record(
        |x| {
            let share = if x < 0.3 { x } else { (0.3 - 1.5 * (x - 0.3)).max(0.15 + (x - 0.4) * 0.35 / 0.6) };
            MODULUS * PEAK * share
        },
        1.0,
    );
    cases.push(Case::new("peak after a fall, Pa", "E ε_p/2", 0.5 * MODULUS * PEAK, twice.strength, fine));
    let what = "secant E, half the peak reached three times, Pa";
    cases.push(Case::new(what, "E: the first", MODULUS, twice.modulus_secant, fine));
    let straight = record(|x| MODULUS * PEAK * x, 1.0);
    cases.push(Case::new("straight record: tangent E, Pa", "E", MODULUS, straight.modulus_tangent, fine));
    cases.push(Case::new("straight record: secant E, Pa", "E", MODULUS, straight.modulus_secant, fine));
    cases
}
