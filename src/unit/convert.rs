//! Numbers in one unit as numbers in another: the only arithmetic of conversion.

use super::{Unit, UnitError};

/// How numbers in one unit become numbers in another of the same dimension.
///
/// A decimal of at most twelve digits is what a person wrote, and it stays one: where the units differ by a power of ten,
/// its point is moved. 0.07 is exactly 7 %, 16.1 GPa exactly 16100 MPa, so equal levels are equal in every unit. A number
/// of more digits was computed, and is multiplied by the ratio of the units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    ratio: f64,
    /// The power of ten that the ratio is.
    exponent: Option<i32>,
}

/// Most digits of a number that is converted as the decimal it is.
const WRITTEN: usize = 12;

impl Unit {
    /// The conversion from this unit.
    ///
    /// # Errors
    /// The other unit is of another dimension.
    pub fn to(self, other: Self) -> Result<Conversion, UnitError> {
        if self.dimension != other.dimension {
            return Err(UnitError::Differ);
        }
        let ratio = self.factor / other.factor;
        let exponent = math::elementary::log10(ratio).round();
        let is_power = (ratio / math::elementary::pow(10.0, exponent) - 1.0).abs() < 1e-13;
        Ok(Conversion { ratio, exponent: is_power.then_some(exponent as i32) })
    }

    /// A number of SI units as a number of this unit.
    pub fn of_si(self, value: f64) -> f64 {
        Self { factor: 1.0, ..self }.to(self).map_or(f64::NAN, |conversion| conversion.of(value))
    }
}

impl Conversion {
    /// Numbers stay as they are.
    pub const NONE: Self = Self { ratio: 1.0, exponent: Some(0) };

    /// Between units as texts; equal texts need no reading.
    ///
    /// # Errors
    /// A unit cannot be read, or the two are of different dimensions.
    pub fn between(from: &str, to: &str) -> Result<Self, UnitError> {
        if from == to {
            return Ok(Self::NONE);
        }
        Unit::parse(from)?.to(Unit::parse(to)?)
    }

    /// Whether numbers stay as they are.
    pub fn is_identity(self) -> bool {
        self.exponent == Some(0)
    }

    /// The number in the other unit.
    pub fn of(self, value: f64) -> f64 {
        match self.exponent {
            Some(0) => value,
            Some(exponent) => moved(value, exponent).unwrap_or(value * self.ratio),
            None => value * self.ratio,
        }
    }

    /// The numbers in the other unit.
    #[must_use]
    pub fn of_all(self, mut values: Vec<f64>) -> Vec<f64> {
        if !self.is_identity() {
            values.iter_mut().for_each(|value| *value = self.of(*value));
        }
        values
    }
}

/// The decimal with its point moved; `None` when it has more digits than people write.
fn moved(value: f64, exponent: i32) -> Option<f64> {
    let text = format!("{value:e}");
    let (digits, power) = text.split_once('e')?;
    let written = digits.bytes().filter(u8::is_ascii_digit).count();
    let power = power.parse::<i32>().ok()?.checked_add(exponent)?;
    (written <= WRITTEN).then(|| format!("{digits}e{power}").parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn convert(value: f64, from: &str, to: &str) -> f64 {
        Conversion::between(from, to).unwrap().of(value)
    }

    /// Exact arithmetic: each pair names one decimal.
    #[test]
    fn equal_levels_are_equal_in_every_unit() {
        for (a, from, b, to) in [
            (0.07, "", 7.0, "%"),
            (0.14, "", 14.0, "%"),
            (0.57, "", 57.0, "%"),
            (16.1, "GPa", 16100.0, "MPa"),
            (32.2, "GPa", 32_200.0, "MPa"),
            (9.0, "mm", 0.009, "m"),
            (2.65, "g/cm^3", 2650.0, "kg/m^3"),
            (1.1, "kN/mm^2", 1.1, "GPa"),
            (90.0, "s", 1.5, "min"),
            (28.0, "d", 672.0, "h"),
            (0.25, "MPa*m^1", 0.25e3, "MPa*mm"),
        ] {
            assert_eq!(convert(a, from, to), b, "{a} {from}");
            assert_eq!(convert(b, to, from), a, "{b} {to}");
        }
        assert!((convert(0.5, "MPa*m^0.5", "MPa*mm^0.5") - 0.5 * 1000_f64.sqrt()).abs() < 1e-13);
        assert!((convert(180.0, "deg", "rad") - std::f64::consts::PI).abs() < 1e-15);
    }

    #[test]
    fn numbers_that_were_computed_are_multiplied_by_the_ratio() {
        let strength = 1.0e8 / 3.0;
        assert_eq!(convert(strength, "Pa", "MPa"), strength * 1e-6);
        assert!(convert(f64::NAN, "Pa", "MPa").is_nan());
        assert_eq!(convert(f64::INFINITY, "MPa", "Pa"), f64::INFINITY);
        assert_eq!(convert(-0.0, "MPa", "Pa").to_bits(), (-0.0_f64).to_bits());
        assert!(Conversion::between("MPa", "mm").is_err() && Conversion::between("MPa", "m^x").is_err());
    }

    #[test]
    fn a_written_number_is_the_decimal_that_its_moved_point_names() {
        let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
        proptest!(config, |(digits in -999_999_999_999_i64..=999_999_999_999, power in -20_i32..20)| {
            let value: f64 = format!("{digits}e{power}").parse().unwrap();
            let wanted: f64 = format!("{digits}e{}", power + 3).parse().unwrap();
            prop_assert_eq!(convert(value, "GPa", "MPa"), wanted);
            prop_assert_eq!(convert(wanted, "MPa", "GPa"), value);
        });
    }
}
