//! Gradation of the aggregate: how many particles of each size a plane section holds.
//!
//! A gradation is the area fraction of the section that particles below a size take, `passing(D)`. The number of
//! particles of a size class is the area of the class over the area of one circle of the class's middle diameter,
//! rounded to the nearest whole number:
//!
//! ```text
//! n_i = (p_i − p_{i−1}) A / (π d_i² / 4)                                                   Su et al. 2021 eq. (10)
//! ```
//!
//! * `Walraven`: the probability that a point of the section lies in a circle smaller than D when the solid follows
//!   Fuller's curve, p = P_k (1.065 x^½ − 0.053 x⁴ − 0.012 x⁶ − 0.0045 x⁸ + 0.0025 x¹⁰), x = D / D_max; eq. (9).
//!   The polynomial ends at 0.998 for x = 1, as published.
//! * `Fuller`: p = P_k xⁿ applied unchanged to the plane, n = 0.5 by custom.
//! * `Table`: passing at given sizes, straight lines in between; below the first size the line runs to the origin.
//!
//! Sizes in metres, fractions of the section's area. Valid for sizes in (0, D_max]; above D_max all passes.
//!
//! Source: Su, Li, Hu, Yang 2021, Materials 14, 1627, doi:10.3390/ma14071627; Walraven, Reinhardt 1981, Heron 26(1A).

use math::elementary::pow;
use math::text::Amount;
use serde::{Deserialize, Serialize};

/// Area fraction of a plane section that is taken by aggregate below a size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Gradation {
    /// Fuller's solid as a plane section sees it.
    Walraven {
        /// Share of aggregate P_k, 0 … 1.
        content: f64,
        /// Largest diameter (m).
        max_size: f64,
    },
    /// Fuller's power law.
    Fuller {
        /// Share of aggregate, 0 … 1.
        content: f64,
        /// Largest diameter (m).
        max_size: f64,
        /// Exponent of the law.
        exponent: f64,
    },
    /// Sieve curve.
    Table {
        /// Increasing diameters (m).
        sizes: Vec<f64>,
        /// Area fraction below each diameter, non-decreasing, 0 … 1.
        passing: Vec<f64>,
    },
}

/// What is wrong with a gradation or its classes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GradationError {
    /// A number outside its range.
    #[error("gradation: {name} is {found:#}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// Class bounds or table sizes that do not increase.
    #[error("gradation: {name}: {next:#} follows {previous:#}; sizes must increase")]
    Order {
        /// Which list.
        name: &'static str,
        /// The earlier number.
        previous: Amount,
        /// The number that should be larger.
        next: Amount,
    },
    /// Lists of unequal or too small length.
    #[error("gradation: {sizes} sizes but {passing} passing fractions; give at least one of each, equally many")]
    Length {
        /// Number of sizes.
        sizes: usize,
        /// Number of fractions.
        passing: usize,
    },
    /// Fewer than two class bounds.
    #[error("gradation: {0} class bound given; at least two are needed to make a class")]
    NoClass(usize),
}

/// One size class: particles of diameters `low` … `high` (m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeClass {
    /// Smallest diameter (m).
    pub low: f64,
    /// Largest diameter (m).
    pub high: f64,
    /// Number of particles.
    pub count: usize,
}

impl SizeClass {
    /// Middle diameter (m), the one whose circle the count was computed with.
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

impl Gradation {
    /// All that is wrong with the numbers of this gradation.
    pub fn faults(&self) -> Vec<GradationError> {
        let mut faults = Vec::new();
        let mut need = |ok: bool, name, found, expected| {
            if !ok {
                faults.push(GradationError::Value { name, found, expected });
            }
        };
        match self {
            Self::Walraven { content, max_size } => {
                need((0.0..=1.0).contains(content), "content", Amount::number(*content), "between 0 and 1");
                need(*max_size > 0.0, "max_size", Amount(*max_size, "m"), "a positive length");
            }
            Self::Fuller { content, max_size, exponent } => {
                need((0.0..=1.0).contains(content), "content", Amount::number(*content), "between 0 and 1");
                need(*max_size > 0.0, "max_size", Amount(*max_size, "m"), "a positive length");
                need(*exponent > 0.0, "exponent", Amount::number(*exponent), "positive");
            }
            Self::Table { sizes, passing } => {
                if sizes.len() != passing.len() || sizes.is_empty() {
                    return vec![GradationError::Length { sizes: sizes.len(), passing: passing.len() }];
                }
                need(sizes[0] > 0.0, "first size", Amount(sizes[0], "m"), "a positive length");
                for &p in passing {
                    need((0.0..=1.0).contains(&p), "passing fraction", Amount::number(p), "between 0 and 1");
                }
                faults.extend(not_increasing("table sizes", sizes));
                for pair in passing.windows(2).filter(|pair| pair[0] > pair[1]) {
                    let (name, found, expected) =
                        ("passing fraction", Amount::number(pair[1]), "at least the fraction of the size below");
                    faults.push(GradationError::Value { name, found, expected });
                }
            }
        }
        faults
    }

    /// Area fraction of the section in particles below `size` (m).
    pub fn passing(&self, size: f64) -> f64 {
        match self {
            Self::Walraven { content, max_size } => content * walraven((size / max_size).clamp(0.0, 1.0)),
            Self::Fuller { content, max_size, exponent } => content * pow((size / max_size).clamp(0.0, 1.0), *exponent),
            Self::Table { sizes, passing } => interpolate(sizes, passing, size),
        }
    }

    /// Number of particles in each class between neighbouring `bounds` (m) in a section of `area` (m²).
    ///
    /// # Errors
    /// All faults of the gradation and of the bounds at once.
    pub fn classes(&self, bounds: &[f64], area: f64) -> Result<Vec<SizeClass>, Vec<GradationError>> {
        let mut faults = self.faults();
        if bounds.len() < 2 {
            faults.push(GradationError::NoClass(bounds.len()));
        }
        faults.extend(not_increasing("class bounds", bounds));
        if !(area > 0.0) {
            let found = Amount(area, "m^2");
            faults.push(GradationError::Value { name: "section area", found, expected: "positive" });
        }
        if let Some(&first) = bounds.first().filter(|&&first| !(first > 0.0)) {
            faults.push(GradationError::Value {
                name: "first class bound",
                found: Amount(first, "m"),
                expected: "a positive length",
            });
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(bounds
            .windows(2)
            .map(|pair| {
                let middle = 0.5 * (pair[0] + pair[1]);
                let circle = std::f64::consts::FRAC_PI_4 * middle * middle;
                let share = self.passing(pair[1]) - self.passing(pair[0]);
                SizeClass { low: pair[0], high: pair[1], count: (share * area / circle).round() as usize }
            })
            .collect())
    }
}

/// Walraven's polynomial in x = D / D_max, for all-aggregate material.
fn walraven(x: f64) -> f64 {
    let (x2, x4) = (x * x, x * x * x * x);
    1.065 * x.sqrt() - 0.053 * x4 - 0.012 * x4 * x2 - 0.0045 * x4 * x4 + 0.0025 * x4 * x4 * x2
}

/// Straight lines through the points, from the origin to the first one, constant after the last.
fn interpolate(sizes: &[f64], passing: &[f64], size: f64) -> f64 {
    let above = sizes.partition_point(|&s| s < size);
    if above == sizes.len() {
        return passing[above - 1];
    }
    let (left, below) = if above == 0 { (0.0, 0.0) } else { (sizes[above - 1], passing[above - 1]) };
    below + (passing[above] - below) * ((size.max(0.0) - left) / (sizes[above] - left))
}

fn not_increasing(name: &'static str, list: &[f64]) -> Vec<GradationError> {
    let bad = |pair: &&[f64]| !(pair[0] < pair[1]);
    let fault = |pair: &[f64]| {
        let [previous, next] = [pair[0], pair[1]].map(|size| Amount(size, "m"));
        GradationError::Order { name, previous, next }
    };
    list.windows(2).filter(bad).map(fault).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: [f64; 6] = [0.005, 0.007, 0.009, 0.011, 0.013, 0.015];

    fn counts(gradation: &Gradation, bounds: &[f64], area: f64) -> Vec<usize> {
        gradation.classes(bounds, area).unwrap().iter().map(|class| class.count).collect()
    }

    /// Table 2 of Su et al. 2021.
    #[test]
    fn walraven_gives_the_published_counts() {
        let gradation = Gradation::Walraven { content: 0.75, max_size: 0.015 };
        assert_eq!(counts(&gradation, &BOUNDS, 0.2 * 0.1), [59, 28, 15, 8, 4]);
    }

    #[test]
    fn walraven_ends_at_the_sum_of_its_coefficients() {
        let gradation = Gradation::Walraven { content: 1.0, max_size: 2.0 };
        assert!((gradation.passing(2.0) - 0.998).abs() < 1e-15);
        assert_eq!(gradation.passing(5.0), gradation.passing(2.0));
        assert_eq!(gradation.passing(0.0), 0.0);
    }

    /// 0.5 (0.4² − 0.2²) 100 m² = 6 m² of circles of 0.3 m: 84.88 of them.
    #[test]
    fn fuller_counts_follow_the_power() {
        let gradation = Gradation::Fuller { content: 0.5, max_size: 1.0, exponent: 2.0 };
        assert_eq!(counts(&gradation, &[0.2, 0.4], 100.0), [85]);
    }

    #[test]
    fn table_runs_straight_between_its_points() {
        let gradation = Gradation::Table { sizes: vec![0.01, 0.03], passing: vec![0.2, 0.4] };
        let got = [0.005, 0.01, 0.02, 0.03, 0.05].map(|size| gradation.passing(size));
        for (got, expected) in got.iter().zip([0.1, 0.2, 0.3, 0.4, 0.4]) {
            assert!((got - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn every_fault_is_named_at_once() {
        let gradation = Gradation::Walraven { content: 1.4, max_size: -1.0 };
        let faults = gradation.classes(&[0.01, 0.005], 0.0).unwrap_err();
        assert_eq!(faults.len(), 4, "{faults:?}");
        let table = Gradation::Table { sizes: vec![0.1], passing: vec![] };
        assert_eq!(table.faults(), [GradationError::Length { sizes: 1, passing: 0 }]);
    }
}
