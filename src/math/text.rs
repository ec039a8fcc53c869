//! Numbers as people and programs read them back.
//!
//! In sentences a number has three digits, and the prefix or power of ten that makes it readable. What a person gave is shown as
//! it was given, by `{:#}`: with three digits 0.3001 would be refused as the 0.3 that it must not exceed.

use std::fmt;

/// All digits of a number, in its shortest form: with a power of ten where it would otherwise be long. It reads back as the
/// same number.
pub fn typed(value: f64) -> String {
    let usual = value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite();
    if usual { value.to_string() } else { format!("{value:e}") }
}

/// A pure number, or one whose unit is written behind it as it is: `0.006`, `2e-9`, `1.25e7`.
pub struct Number(pub f64);

/// A number with its SI unit, empty for a pure number; a unit that takes prefixes has one: `34.5 MPa`, `1.2 mm`, `2600 kg/m^3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount(pub f64, pub &'static str);

/// SI prefixes from the largest on, with their factors.
const PREFIXES: [(&str, f64); 7] =
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)];

/// Units that take prefixes: a prefix before a power would be part of it.
const PREFIXED: [&str; 7] = ["Pa", "m", "s", "N", "m/s", "N/m", "Pa/m"];

/// Digits behind the first one of a number that was computed.
const MORE_DIGITS: usize = 2;
/// Those of a number that was given: all but the last, which a conversion may have changed.
const ALL_DIGITS: usize = 14;

/// The value with the digits that a formatter asks for, in scientific notation.
fn digits(value: f64, f: &fmt::Formatter<'_>) -> String {
    let more = if f.alternate() { ALL_DIGITS } else { MORE_DIGITS };
    format!("{value:.more$e}")
}

impl Amount {
    /// A pure number.
    pub const fn number(value: f64) -> Self {
        Self(value, "")
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = digits(self.0, f);
        let Some((digits, power)) = short.split_once('e') else { return write!(f, "{}", self.0) };
        let rounded: f64 = short.parse().unwrap_or(self.0);
        if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) {
            return write!(f, "{rounded}");
        }
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        write!(f, "{digits}e{power}")
    }
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, unit) = *self;
        if unit.is_empty() {
            return Number(value).fmt(f);
        }
        let rounded: f64 = digits(value, f).parse().unwrap_or(value);
        // Beyond the prefixes a power of ten is plainer than a power of ten of the last of them.
        let prefixed = PREFIXED.contains(&unit) && (1e-12..1e15).contains(&rounded.abs());
        let fits = |(_, factor): &&(&str, f64)| rounded.abs() >= *factor;
        let (prefix, factor) =
            if prefixed { *PREFIXES.iter().find(fits).unwrap_or(&PREFIXES[PREFIXES.len() - 1]) } else { ("", 1.0) };
        Number(value / factor).fmt(f)?;
        write!(f, " {prefix}{unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        for (value, text) in [
            (0.0, "0"),
            (0.1, "0.1"),
            (-1.5e-5, "-0.000015"),
            (9.9e-6, "9.9e-6"),
            (1e15, "1000000000000000"),
            (1.5e16, "1.5e16"),
            (5e-324, "5e-324"),
            (-1.797_693_134_862_315_7e308, "-1.7976931348623157e308"),
        ] {
            assert_eq!(typed(value), text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert_eq!([f64::INFINITY, f64::NAN].map(typed), ["inf", "NaN"]);
    }

    #[test]
    fn numbers_have_three_digits_and_a_power_where_they_need_one() {
        for (value, said) in [
            (0.0, "0"),
            (2e-9, "2e-9"),
            (0.017_53, "0.0175"),
            (0.006, "0.006"),
            (99_999.0, "1e5"),
            (1234.0, "1230"),
            (-1.257e7, "-1.26e7"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Number(value).to_string(), said, "{value}");
        }
    }

    #[test]
    fn what_was_given_is_shown_as_it_was_given() {
        for (value, unit, said) in [
            (0.3001, "", "0.3001"),
            (0.1 + 0.2, "", "0.3"),
            (1e7, "Pa", "10 MPa"),
            (12_345_678.0, "Pa", "12.345678 MPa"),
            (-0.001, "m", "-1 mm"),
            (f64::NAN, "m", "NaN m"),
        ] {
            assert_eq!(format!("{:#}", Amount(value, unit)), said, "{value}");
        }
    }

    #[test]
    fn quantities_have_the_prefix_that_leaves_one_to_three_digits_before_the_point() {
        for (value, unit, said) in [
            (0.0, "Pa", "0 Pa"),
            (34.512e6, "Pa", "34.5 MPa"),
            (999.9, "Pa", "1 kPa"),
            (0.4e-3, "Pa", "400 µPa"),
            (2.5e12, "Pa", "2500 GPa"),
            (1e-12, "m", "0.001 nm"),
            (-0.0175, "m", "-17.5 mm"),
            (f64::INFINITY, "Pa", "inf Pa"),
            (2600.0, "kg/m^3", "2600 kg/m^3"),
            (-4e-6, "m^2", "-4e-6 m^2"),
            (0.02, "m/s", "20 mm/s"),
            (1.25e-7, "", "1.25e-7"),
            (1e300, "m/s", "1e300 m/s"),
        ] {
            assert_eq!(Amount(value, unit).to_string(), said, "{value}");
        }
    }
}
