//! Numbers as people and programs read them back.

/// All digits of a number, in its shortest form: with a power of ten where it would otherwise be long. It reads back as the
/// same number.
pub fn typed(value: f64) -> String {
    let usual = value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite();
    if usual { value.to_string() } else { format!("{value:e}") }
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
}
