//! How fast a test is driven, and thresholds relative to the piece.
//!
//! | given as | speed of each platen |
//! |---|---|
//! | speed v | v |
//! | strain rate ε̇ | ε̇ L: on the way L the strain grows by 1; H / 2 where both platens move |
//! | transits N | ε_r c / (2 N) |
//!
//! N is the quasi-static number: how many times a wave of speed c = √(E*/ρ) runs through the height H while the strain
//! grows by ε_r = σ_c/E*, the strain at which the bonds can be expected to fail ([`Scales`]). At the speed v that takes the
//! time ε_r H/(2v), a transit the time H/c. N does not depend on size, stiffness or density of the piece, so rows of a
//! design are equally quasi-static. Above about 60 a compressive strength follows the speed by less than its scatter.

use super::rig::Scales;
use math::text::Amount;
use serde::{Deserialize, Serialize};

/// How fast a test is driven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Speed {
    /// Speed of each platen or grip (m/s).
    Each(f64),
    /// Strain rate of the piece (1/s).
    StrainRate(f64),
    /// Wave transits of the height within the reference strain.
    Transits(f64),
}

impl Speed {
    /// Speed of each platen (m/s); on the way `length` (m) of a platen the strain grows by 1.
    pub fn of(&self, length: f64, scales: &Scales) -> f64 {
        match *self {
            Self::Each(speed) => speed,
            Self::StrainRate(rate) => rate * length,
            Self::Transits(transits) => 0.5 * scales.strain() * scales.wave_speed() / transits,
        }
    }

    /// Wave transits of the height within the reference strain when each platen moves at `speed` (m/s): the number that was
    /// given, where it was.
    pub fn transits(&self, speed: f64, scales: &Scales) -> f64 {
        match *self {
            Self::Transits(transits) => transits,
            Self::Each(_) | Self::StrainRate(_) => 0.5 * scales.strain() * scales.wave_speed() / speed,
        }
    }

    /// The number that was given, with its unit.
    pub fn given(&self) -> Amount {
        match *self {
            Self::Each(speed) => Amount(speed, "m/s"),
            Self::StrainRate(rate) => Amount(rate, "1/s"),
            Self::Transits(transits) => Amount::number(transits),
        }
    }
}

/// A threshold, of its own or relative to the piece.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Threshold {
    /// Strain, or stress in Pa.
    Absolute(f64),
    /// Share of the reference strain or stress of the piece.
    Share(f64),
}

impl Threshold {
    /// The threshold for a piece with the reference value `scale`.
    pub fn of(&self, scale: f64) -> f64 {
        match *self {
            Self::Absolute(value) => value,
            Self::Share(share) => share * scale,
        }
    }

    /// The number that was given, with its unit: of a strain none, of a stress Pa.
    pub fn given(&self, unit: &'static str) -> Amount {
        match *self {
            Self::Absolute(x) => Amount(x, unit),
            Self::Share(x) => Amount::number(x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 MPa over 20 GPa, 2000 kg/m³: ε_r = 1e-3, c = 3162.3 m/s. A transit of 0.2 m takes 63.25 µs; 100 of them are
    /// 6.325 ms, in which the piece shortens by 0.2 mm: 0.01581 m/s at each end.
    #[test]
    fn three_ways_to_one_speed() {
        let scales = Scales { modulus: 20e9, strength: 20e6, density: 2000.0 };
        let speed = Speed::Transits(100.0).of(0.2, &scales);
        assert!((speed - 0.015_811_388).abs() < 1e-8, "{speed}");
        assert_eq!(Speed::StrainRate(2.0 * speed / 0.2).of(0.1, &scales), speed);
        assert_eq!(Speed::Each(0.02).of(0.2, &scales), 0.02);
        // The same number at twice the height, and a piece four times as stiff and strong goes twice as fast.
        assert_eq!(Speed::Transits(100.0).of(0.4, &scales), speed);
        let strong = Scales { modulus: 80e9, strength: 80e6, ..scales };
        assert_eq!(Speed::Transits(100.0).of(0.2, &strong), 2.0 * speed);
    }

    #[test]
    fn strengths_that_mean_unbreakable_say_nothing_of_the_strain_to_come() {
        let scales = Scales { modulus: 20e9, strength: 1e15, density: 2000.0 };
        assert_eq!(scales.strain(), 0.05);
        assert_eq!(Threshold::Share(0.1).of(scales.stress()), 1e8);
        assert_eq!(Threshold::Absolute(2e-6).of(scales.strain()), 2e-6);
    }
}
