//! Factors, and the two scales they are measured on.
//!
//! A factor has a *natural* scale (gigapascal, ratio …) and a *coded* one on which its lowest level is −1 and its
//! highest +1: `coded = (natural − centre) / half`, with `centre = (low + high) / 2` and `half = (high − low) / 2` (Box
//! & Wilson 1951, doi:10.1111/j.2517-6161.1951.tb00067.x). On a logarithmic scale the same holds of ln natural, so that equal
//! steps are equal ratios and the centre is √(low high); that is for ranges over decades. Values that are a declared level up to rounding are given
//! that level's very bits, so that a row of one design equals the same row of another.

use super::error::Fault;
use math::occurrence::occurrences;
use math::scale::Scale;
use serde::{Deserialize, Serialize};

/// Relative distance below which a computed value is taken for a declared level or a whole coded number.
const SNAP: f64 = 1e-12;

/// The values a factor may take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Domain {
    /// These values only, in the order "level 1, level 2, …".
    Levels(Vec<f64>),
    /// Any value from `low` to `high`.
    Range {
        /// Coded −1.
        low: f64,
        /// Coded +1.
        high: f64,
    },
}

/// A factor of a design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Factor {
    /// Name, unique in the design; it appears in the names of terms (`Ec*kn_ks`).
    pub name: String,
    /// Unit of the values, as text for tables; empty for a plain number.
    pub unit: String,
    /// The values it may take, in `unit`.
    pub domain: Domain,
    /// How its range is divided.
    #[serde(default, skip_serializing_if = "Scale::is_linear")]
    pub scale: Scale,
}

impl Factor {
    /// A factor with discrete levels.
    pub fn levels(name: &str, unit: &str, levels: &[f64]) -> Self {
        Self { name: name.into(), unit: unit.into(), domain: Domain::Levels(levels.to_vec()), scale: Scale::Linear }
    }

    /// A factor with a continuous range.
    pub fn range(name: &str, unit: &str, low: f64, high: f64) -> Self {
        Self { name: name.into(), unit: unit.into(), domain: Domain::Range { low, high }, scale: Scale::Linear }
    }

    /// The same factor on a logarithmic scale.
    #[must_use]
    pub fn log(self) -> Self {
        Self { scale: Scale::Log, ..self }
    }

    /// Lowest value (coded −1).
    pub fn low(&self) -> f64 {
        match &self.domain {
            Domain::Levels(levels) => levels.iter().copied().fold(f64::INFINITY, f64::min),
            Domain::Range { low, .. } => *low,
        }
    }

    /// Highest value (coded +1).
    pub fn high(&self) -> f64 {
        match &self.domain {
            Domain::Levels(levels) => levels.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Domain::Range { high, .. } => *high,
        }
    }

    /// Middle of the range (coded 0).
    pub fn centre(&self) -> f64 {
        match self.scale {
            Scale::Linear => self.middle(),
            Scale::Log => (self.low() * self.high()).sqrt(),
        }
    }

    /// Middle of the range in the coordinate of the scale.
    fn middle(&self) -> f64 {
        0.5 * (self.scale.of(self.low()) + self.scale.of(self.high()))
    }

    /// Half of the range in the coordinate of the scale (one coded unit).
    pub fn half(&self) -> f64 {
        0.5 * (self.scale.of(self.high()) - self.scale.of(self.low()))
    }

    /// Number of levels; a range counts its two ends.
    pub fn level_count(&self) -> usize {
        match &self.domain {
            Domain::Levels(levels) => levels.len(),
            Domain::Range { .. } => 2,
        }
    }

    /// Natural value of level `index`, from 0; a range has its two ends.
    pub fn level(&self, index: usize) -> f64 {
        match &self.domain {
            Domain::Levels(levels) => levels[index],
            Domain::Range { low, high } => [*low, *high][index],
        }
    }

    /// Coded value of a natural one.
    pub fn coded(&self, natural: f64) -> f64 {
        self.coding().coded(natural)
    }

    /// Its coding, for many values at once.
    pub fn coding(&self) -> Coding {
        Coding { centre: self.middle(), half: self.half(), scale: self.scale }
    }

    /// Natural value of a coded one: exactly the declared level or end of the range where it is one up to rounding,
    /// else rounded to twelve digits, so that a table reads 3.025 and not 3.0250000000000004.
    pub fn natural(&self, coded: f64) -> f64 {
        let value = self.scale.natural(self.middle() + self.half() * coded);
        let size = if self.scale == Scale::Linear { self.half() } else { 0.0 };
        let near = |known: &f64| (value - known).abs() <= SNAP * size.max(known.abs());
        let known = match &self.domain {
            Domain::Levels(levels) => levels.iter().copied().find(near),
            Domain::Range { low, high } => [*low, *high].into_iter().find(near),
        };
        known.unwrap_or_else(|| format!("{value:.11e}").parse().unwrap_or(value)) + 0.0
    }

    /// Faults of this factor alone.
    fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let factor = || self.name.clone();
        let mut finite = |what: &dyn Fn() -> String, value: f64| {
            if !value.is_finite() {
                faults.push(Fault::NotFinite { factor: factor(), what: what(), value });
            }
        };
        match &self.domain {
            Domain::Levels(levels) => {
                for (i, &value) in levels.iter().enumerate() {
                    finite(&|| format!("level {}", i + 1), value);
                }
                if levels.len() < 2 {
                    faults.push(Fault::TooFewLevels { factor: factor(), found: levels.len() });
                }
                // −0 is 0.
                let words: Vec<u64> = levels.iter().map(|value| (value + 0.0).to_bits()).collect();
                let again =
                    occurrences(&words, 1, words.len()).into_iter().enumerate().filter(|(_, number)| *number > 1);
                for (position, _) in again.filter(|(position, _)| !levels[*position].is_nan()) {
                    let first = words.iter().position(|word| *word == words[position]).unwrap_or(position);
                    let (value, first, second) = (levels[position], first + 1, position + 1);
                    faults.push(Fault::DuplicateLevel { factor: factor(), value, first, second });
                }
            }
            Domain::Range { low, high } => {
                finite(&|| "the lower limit".into(), *low);
                finite(&|| "the upper limit".into(), *high);
                if low >= high {
                    faults.push(Fault::EmptyRange { factor: factor(), low: *low, high: *high });
                }
            }
        }
        if self.scale == Scale::Log && self.low() <= 0.0 {
            faults.push(Fault::NoLogarithm { factor: factor(), low: self.low() });
        }
        faults
    }
}

/// Middle and half of a factor's range: what turns natural values into coded ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coding {
    centre: f64,
    half: f64,
    scale: Scale,
}

impl Coding {
    /// Coded value of a natural one.
    pub fn coded(&self, natural: f64) -> f64 {
        let coded = (self.scale.of(natural) - self.centre) / self.half;
        let whole = coded.round();
        if (coded - whole).abs() < SNAP { whole + 0.0 } else { coded }
    }
}

/// All faults of a list of factors: names, levels, ranges.
pub fn check(factors: &[Factor]) -> Vec<Fault> {
    let mut faults = Vec::new();
    if factors.is_empty() {
        faults.push(Fault::NoFactors);
    }
    for (i, factor) in factors.iter().enumerate() {
        if factor.name.trim().is_empty() {
            faults.push(Fault::NoName { number: i + 1 });
        } else if let Some(first) = factors[..i].iter().position(|f| f.name == factor.name) {
            faults.push(Fault::DuplicateName { factor: factor.name.clone(), first: first + 1, second: i + 1 });
        }
        faults.extend(factor.faults());
    }
    faults
}

/// Faults of factors that a two-level design cannot set: those with more than two levels.
pub(super) fn check_two_level(factors: &[Factor], design: &str) -> Vec<Fault> {
    let many = factors.iter().filter(|f| f.level_count() > 2);
    let fault = |f: &Factor| Fault::WrongLevels {
        factor: f.name.clone(),
        found: f.level_count(),
        design: design.into(),
        wanted: "two".into(),
        remedy: format!("give two of them, or the range {} to {}", f.low(), f.high()),
    };
    many.map(fault).collect()
}

/// Faults of factors that a response-surface design cannot set: levels other than two, or three evenly spaced.
pub(super) fn check_surface(factors: &[Factor], design: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    for f in factors {
        let Domain::Levels(levels) = &f.domain else { continue };
        if levels.len() > 3 {
            faults.push(Fault::WrongLevels {
                factor: f.name.clone(),
                found: levels.len(),
                design: design.into(),
                wanted: "its own between the lowest and the highest".into(),
                remedy: format!("give the range {} to {}", f.low(), f.high()),
            });
        } else if let Some(&middle) = levels.iter().find(|&&v| v != f.low() && v != f.high())
            && f.coded(middle) != 0.0
        {
            let (low, high, centre) = (f.low(), f.high(), f.centre());
            faults.push(Fault::UnevenLevels { factor: f.name.clone(), middle, low, high, centre });
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_centre_and_levels_keep_their_bits() {
        let f = Factor::levels("mu", "", &[0.1, 0.2, 0.3]);
        assert_eq!([f.natural(-1.0), f.natural(0.0), f.natural(1.0)], [0.1, 0.2, 0.3]);
        assert_eq!([f.coded(0.1), f.coded(0.2), f.coded(0.3)], [-1.0, 0.0, 1.0]);
        let f = Factor::levels("kn_ks", "", &[1.0, 2.5, 4.0]);
        assert_eq!([f.coded(1.0), f.coded(2.5), f.coded(4.0), f.coded(1.75)], [-1.0, 0.0, 1.0, -0.5]);
        assert_eq!(f.natural(0.0).to_bits(), 2.5_f64.to_bits());
        assert_eq!(Factor::range("kn_ks", "", 1.0, 4.0).natural(0.35), 3.025);
    }

    #[test]
    fn a_logarithmic_scale_divides_by_ratios() {
        let f = Factor::range("kn", "N/m", 1e5, 1e9).log();
        assert_eq!([-1.0, -0.5, 0.0, 0.5, 1.0].map(|coded| f.natural(coded)), [1e5, 1e6, 1e7, 1e8, 1e9]);
        for (natural, coded) in [(1e5, -1.0), (1e6, -0.5), (1e7, 0.0), (1e9, 1.0)] {
            let off = f.coded(natural) - coded;
            assert!(off.abs() <= 4.0 * f64::EPSILON, "{natural}: {off:e}"); // a quotient of two rounded logarithms
        }
        let levels = Factor::levels("kn", "N/m", &[1.0, 10.0, 100.0]).log();
        assert_eq!((levels.coded(10.0), levels.centre()), (0.0, 10.0));
        assert!(check_surface(&[levels], "box-behnken").is_empty());
        let none = check(&[Factor::range("kn", "N/m", 0.0, 1e9).log()]);
        assert!(none[0].to_string().contains("logarithmic scale"), "{none:?}");
    }

    #[test]
    fn order_of_levels_does_not_turn_the_coded_scale() {
        let f = Factor::levels("Ec", "GPa", &[30.0, 10.0, 20.0]);
        assert_eq!((f.level(0), f.coded(f.level(0)), f.coded(10.0)), (30.0, 1.0, -1.0));
    }

    #[test]
    fn all_faults_come_at_once_and_name_the_factor() {
        let factors = [
            Factor::levels("a", "", &[1.0]),
            Factor::range("a", "", 2.0, 2.0),
            Factor::levels("c", "", &[1.0, f64::NAN, 1.0]),
            Factor::range("d", "", f64::INFINITY, 3.0),
        ];
        let faults = check(&factors);
        let text: Vec<String> = faults.iter().map(ToString::to_string).collect();
        assert_eq!(text.len(), 7, "{text:#?}");
        assert!(text[0].starts_with("factor `a` has one level"));
        assert!(text[1].contains("named twice, as factors 1 and 2"));
        assert!(text[2].contains("empty range, 2 to 2"));
        assert!(text[3].contains("`c`: level 2 is NaN"));
        assert!(text[4].contains("the level 1 twice, as levels 1 and 3"));
        assert!(text[5].contains("the lower limit is inf") && text[6].contains("empty range"));
        assert!(check(&[])[0].to_string().contains("no factors"));
    }
}
