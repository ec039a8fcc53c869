//! Numbers in sentences: three digits, and the prefix or power of ten that makes them readable.

use std::fmt;

/// A pure number, or one whose unit is written behind it as it is: `0.006`, `2e-9`, `1.25e7`.
pub(crate) struct Number(pub(crate) f64);

/// A number with a unit that takes SI prefixes: `34.5 MPa`, `0 Pa`, `1.2 mm`.
pub(crate) struct Quantity(pub(crate) f64, pub(crate) &'static str);

/// SI prefixes from the largest on, with their factors.
const PREFIXES: [(&str, f64); 7] =
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)];

/// Digits behind the first one.
const MORE_DIGITS: usize = 2;

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = format!("{:.MORE_DIGITS$e}", self.0);
        let Some((digits, power)) = short.split_once('e') else { return write!(f, "{}", self.0) };
        let rounded: f64 = short.parse().unwrap_or(self.0);
        if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) {
            return write!(f, "{rounded}");
        }
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        write!(f, "{digits}e{power}")
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, unit) = *self;
        let rounded: f64 = format!("{value:.MORE_DIGITS$e}").parse().unwrap_or(value);
        if rounded == 0.0 || !rounded.is_finite() {
            return write!(f, "{} {unit}", Number(value));
        }
        let fits = |(_, factor): &&(&str, f64)| rounded.abs() >= *factor;
        let (prefix, factor) = PREFIXES.iter().find(fits).unwrap_or(&PREFIXES[PREFIXES.len() - 1]);
        write!(f, "{} {prefix}{unit}", Number(value / factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        ] {
            assert_eq!(Quantity(value, unit).to_string(), said, "{value}");
        }
    }
}
