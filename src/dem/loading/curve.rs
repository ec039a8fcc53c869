//! The record of a loading test and the macroscopic quantities read from it.
//!
//! Signs: stress and axial strain are positive in the sense of loading (compression in a compression test, tension in a
//! tension test); lateral strain is positive in extension, so in compression a dense material has ν = ε_lat / ε_ax > 0 and
//! its volume shrinks by ε_v = ε_ax − ε_lat. Stress in Pa.
//!
//! Definitions ("first reach" = first sample at which the stress has reached the level, the values interpolated to it):
//!
//! | name | meaning |
//! |---|---|
//! | `strength` | largest stress |
//! | `modulus_tangent` | slope of the least-squares line through the samples between the first reach of 40 % and of 60 % of the strength |
//! | `modulus_secant` | stress over axial strain at the first reach of 50 % |
//! | `poisson_secant` | lateral over axial strain at the first reach of 50 % |
//! | `poisson_tangent` | slope of lateral against axial strain over the window of `modulus_tangent` |
//! | `crack_initiation` | stress at which 1 % of the cracks present at the peak exist |
//! | `crack_damage` | stress at the largest volumetric contraction before the peak |
//!
//! Under a confining stress, stress and strains count from the isotropic state on: the stress is the deviator.
//!
//! Su et al. 2021 define E as "the tangent slope of the curve when the stress reaches half the peak stress for the first
//! time" and ν as the "ratio of lateral strain to axial strain at this time": `modulus_tangent` and `poisson_secant`.

use serde::{Deserialize, Serialize};

/// One sample of a test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Axial strain.
    pub axial: f64,
    /// Lateral strain, extension positive.
    pub lateral: f64,
    /// Stress (Pa).
    pub stress: f64,
    /// Cracks so far.
    pub cracks: usize,
    /// Speed of each platen or grip at which it was reached (m/s).
    #[serde(default)]
    pub speed: f64,
}

/// Macroscopic quantities of a compression or tension test; those that the record does not support are NaN.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Macro {
    /// Peak stress (Pa).
    pub strength: f64,
    /// Axial strain at the peak.
    pub peak_strain: f64,
    /// Tangent modulus around half the peak (Pa).
    pub modulus_tangent: f64,
    /// Secant modulus to half the peak (Pa).
    pub modulus_secant: f64,
    /// Strain ratio at half the peak.
    pub poisson_secant: f64,
    /// Slope of the strain ratio around half the peak.
    pub poisson_tangent: f64,
    /// Crack-initiation stress (Pa).
    pub crack_initiation: f64,
    /// Crack-damage stress (Pa).
    pub crack_damage: f64,
    /// Confining stress at the peak (Pa); 0 without one.
    pub confinement: f64,
    /// Work to break a unit of the section (J/m²), where the test measures it.
    pub fracture_energy: f64,
}

/// The window of the tangents, as shares of the peak.
const WINDOW: [f64; 2] = [0.4, 0.6];

/// Index of the largest stress, the first if there are several; none for an empty record.
pub fn peak(samples: &[Sample]) -> Option<usize> {
    let better = |best: usize, k: usize| if samples[k].stress > samples[best].stress { k } else { best };
    (!samples.is_empty()).then(|| (1..samples.len()).fold(0, better))
}

/// The sample at which the stress first reaches `level` (Pa), interpolated.
pub fn first_reach(samples: &[Sample], level: f64) -> Option<Sample> {
    let k = samples.iter().position(|s| s.stress >= level)?;
    let (after, before) = (samples[k], if k > 0 { samples[k - 1] } else { Sample::default() });
    let rise = after.stress - before.stress;
    let share = if rise > 0.0 { (level - before.stress) / rise } else { 1.0 };
    let mix = |a: f64, b: f64| a + share * (b - a);
    Some(Sample {
        axial: mix(before.axial, after.axial),
        lateral: mix(before.lateral, after.lateral),
        stress: level,
        cracks: after.cracks,
        speed: after.speed,
    })
}

/// All quantities of a record.
pub fn evaluate(samples: &[Sample]) -> Macro {
    let Some(top) = peak(samples) else { return Macro::unknown() };
    let strength = samples[top].stress;
    let half = first_reach(samples, 0.5 * strength).unwrap_or_default();
    let window = WINDOW.map(|share| samples.iter().position(|s| s.stress >= share * strength).unwrap_or(top));
    let inside = &samples[window[0]..=window[1]];
    let onset = 0.01 * samples[top].cracks as f64;
    let initiation = samples[..=top].iter().find(|s| s.cracks > 0 && s.cracks as f64 >= onset);
    let contraction = |s: &Sample| s.axial - s.lateral;
    let damage =
        samples[..=top].iter().fold(&samples[0], |best, s| if contraction(s) > contraction(best) { s } else { best });
    Macro {
        strength,
        peak_strain: samples[top].axial,
        modulus_tangent: slope(inside.iter().map(|s| (s.axial, s.stress))),
        modulus_secant: half.stress / half.axial,
        poisson_secant: half.lateral / half.axial,
        poisson_tangent: slope(inside.iter().map(|s| (s.axial, s.lateral))),
        crack_initiation: initiation.map_or(f64::NAN, |s| s.stress),
        crack_damage: damage.stress,
        confinement: 0.0,
        fracture_energy: f64::NAN,
    }
}

impl Macro {
    /// Nothing known.
    pub fn unknown() -> Self {
        let nan = f64::NAN;
        Self {
            strength: nan,
            peak_strain: nan,
            modulus_tangent: nan,
            modulus_secant: nan,
            poisson_secant: nan,
            poisson_tangent: nan,
            crack_initiation: nan,
            crack_damage: nan,
            confinement: 0.0,
            fracture_energy: nan,
        }
    }
}

/// Least-squares slope; NaN without two distinct abscissae.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = points.clone().count() as f64;
    let (mx, my) = points.clone().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let (sxx, sxy) = points.fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (x - mx), b + (x - mx) * (y - my)));
    sxy / sxx
}

/// The record at `count` strains, evenly from 0 to the last one, interpolated; the sample next to the peak is the peak.
pub fn thinned(samples: &[Sample], count: usize) -> Vec<Sample> {
    let (Some(top), Some(last)) = (peak(samples), samples.last()) else { return Vec::new() };
    let step = last.axial / (count.max(2) - 1) as f64;
    let mut thin: Vec<Sample> = (0..count.max(2)).map(|k| at_strain(samples, step * k as f64)).collect();
    if step > 0.0 {
        let nearest = ((samples[top].axial / step).round() as usize).min(thin.len() - 1);
        thin[nearest] = samples[top];
    }
    thin
}

fn at_strain(samples: &[Sample], axial: f64) -> Sample {
    let k = samples.partition_point(|s| s.axial < axial).min(samples.len() - 1);
    let (after, before) = (samples[k], if k > 0 { samples[k - 1] } else { Sample::default() });
    let run = after.axial - before.axial;
    let share = if run > 0.0 { ((axial - before.axial) / run).clamp(0.0, 1.0) } else { 1.0 };
    let mix = |a: f64, b: f64| a + share * (b - a);
    Sample {
        axial,
        lateral: mix(before.lateral, after.lateral),
        stress: mix(before.stress, after.stress),
        cracks: if share < 1.0 { before.cracks } else { after.cracks },
        speed: after.speed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// σ = E ε (1 − ε / 2ε_p), lateral = ν ε, cracks from 30 % of the peak strain on.
    fn parabola() -> Vec<Sample> {
        let (modulus, peak_strain) = (40e9, 1e-3);
        (0..=1500)
            .map(|k| {
                let e = peak_strain * f64::from(k) / 1000.0;
                let cracks = (k as usize).saturating_sub(300);
                Sample {
                    axial: e,
                    lateral: 0.2 * e,
                    stress: modulus * e * (1.0 - 0.5 * e / peak_strain),
                    cracks,
                    speed: 0.02,
                }
            })
            .collect()
    }

    #[test]
    fn a_parabola_has_its_closed_forms() {
        let got = evaluate(&parabola());
        let close =
            |got: f64, expected: f64, share: f64| assert!((got / expected - 1.0).abs() < share, "{got} {expected}");
        close(got.strength, 20e6, 1e-12);
        close(got.peak_strain, 1e-3, 1e-12);
        // Half the peak at x = 1 − √½ of the peak strain; slope there E √½, secant E (1 − x/2).
        let x = 1.0 - 0.5_f64.sqrt();
        close(got.modulus_secant, 40e9 * (1.0 - 0.5 * x), 1e-5);
        // The line through a parabola over an interval has the slope at its middle.
        let middle = 1.0 - 0.5 * (0.6_f64.sqrt() + 0.4_f64.sqrt());
        close(got.modulus_tangent, 40e9 * (1.0 - middle), 2e-3);
        close(got.poisson_secant, 0.2, 1e-9);
        close(got.poisson_tangent, 0.2, 1e-9);
        // 1 % of the 700 cracks at the peak is the 7th, at 0.307 of the peak strain.
        close(got.crack_initiation, 40e9 * 0.307e-3 * (1.0 - 0.1535), 1e-12);
        close(got.crack_damage, 20e6, 1e-12);
    }

    #[test]
    fn first_reach_is_the_first_and_interpolated() {
        let stresses = [1.0, 3.0, 2.0, 5.0];
        let samples: Vec<Sample> = (0..4)
            .map(|k| Sample { axial: k as f64 + 1.0, lateral: 0.0, stress: stresses[k], cracks: 0, speed: 0.02 })
            .collect();
        assert_eq!(first_reach(&samples, 2.5).unwrap().axial, 1.75);
        assert_eq!(first_reach(&samples, 4.0).unwrap().axial, 3.0 + 2.0 / 3.0);
        assert_eq!(first_reach(&samples, 6.0), None);
    }

    #[test]
    fn a_thinned_record_keeps_the_peak() {
        let thin = thinned(&parabola(), 78);
        assert_eq!(thin.len(), 78);
        assert_eq!(thin[0].stress, 0.0);
        assert_eq!(thin[77].axial, 1.5e-3);
        assert_eq!(thin[peak(&thin).unwrap()].stress, 20e6);
        assert!(thin.windows(2).all(|pair| pair[0].axial < pair[1].axial));
    }

    #[test]
    fn an_empty_record_is_unknown_and_not_a_panic() {
        assert!(evaluate(&[]).strength.is_nan());
        assert!(thinned(&[], 10).is_empty());
    }
}
