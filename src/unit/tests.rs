//! Units and quantities against their written definitions.

use super::*;

#[test]
fn units_are_products_of_powers() {
    let factor = |text: &str| Unit::parse(text).unwrap().factor;
    assert_eq!(factor("GPa"), 1e9);
    assert_eq!(factor("kg/m^3"), 1.0);
    assert_eq!(factor("g/cm^3"), 1e-3 / 0.01_f64.powi(3));
    assert_eq!(factor("mm"), 1e-3);
    // The sign of a millionth and the Greek letter.
    assert_eq!([factor("\u{b5}m"), factor("\u{3bc}m"), factor("um")], [1e-6; 3]);
    assert_eq!(factor("N/mm²"), 1.0 / (1e-3_f64 * 1e-3));
    assert_eq!(Unit::parse("N*m").unwrap().dimension, Unit::parse("J").unwrap().dimension);
}

#[test]
fn quantities_are_read_and_faults_name_the_right_form() {
    assert_eq!(Pressure::parse("16 GPa").unwrap().get(), 1.6e10);
    assert_eq!(Length::parse("1e-3m").unwrap().get(), 1e-3);
    assert_eq!(Angle::parse("180 deg").unwrap().get(), std::f64::consts::PI);
    let message = |r: Result<Length, UnitError>| r.unwrap_err().to_string();
    assert_eq!(message(Length::parse("5")), "`5` needs a unit; write for example \"0.5 mm\"");
    assert_eq!(message(Length::parse("5 GPa")), "`GPa` is not a unit of length; write for example \"0.5 mm\"");
    assert!(message(Length::parse("5 ell")).starts_with("`ell` is not a unit that flow knows"));
    assert!(message(Length::parse(&format!("5 m*{}", "m*".repeat(2000)))).chars().count() < 200);
    assert!(message(Length::parse("wide")).contains("does not begin with a number"));
}

/// Fracture toughness in `MPa*m^0.5`, creep rates, Paris' law: exponents of physics are not all whole.
#[test]
fn powers_may_be_fractions() {
    let unit = |text: &str| Unit::parse(text).unwrap();
    let scale = unit("MPa*m^0.5").factor / unit("MPa*mm^0.5").factor;
    assert!((scale / 1000_f64.sqrt() - 1.0).abs() < 1e-15, "{scale}");
    assert_eq!(unit("MPa*m^0.5").dimension, unit("N*m^-1.5").dimension);
    assert_ne!(unit("MPa*m^0.5").dimension, unit("MPa").dimension);
    assert_eq!(unit("m^(1/3)*m^(2/3)"), unit("m"));
    assert_eq!(unit("m^(-1/2)").dimension, unit("1/m^0.5").dimension);
    for (a, b) in [("MPa·√m", "MPa*m^0.5"), ("s⁻¹", "1/s"), ("m s⁻²", "m/s^2"), ("m^+2", "m²"), ("m^2.0", "m^2")]
    {
        assert_eq!(unit(a), unit(b), "{a} {b}");
    }
    assert_eq!(unit("m/(MPa*m^0.5)^3.2").dimension, unit("m*MPa^-3.2*m^-1.6").dimension);
}

#[test]
fn what_is_no_unit_is_an_error_and_no_value() {
    for text in [
        "m^x",
        "MPa^",
        "m^300",
        "m^61",
        "m^nan",
        "m^inf",
        "m^1e400",
        "m^0.123456789",
        "m^2^3",
        "m^(1/0)",
        "m^(1/2",
        "m^1/2/",
        "m^()",
        "^2",
        "√",
        "m/",
        "/s",
        "m//s",
        "m**s",
        "*m",
        "m*",
        "m^--2",
        "m^- 2",
        "m^0x2",
        "m^1_0",
        "GPa^60",
        "()",
        "(m",
        "m)",
        "(m^2",
        "((m)",
        "m^²",
        "²",
        "⁻¹",
        "m⁻",
        "m^9999999999999999999",
        "m^.",
        "m^1e1",
    ] {
        assert!(Unit::parse(text).is_err(), "{text}: {:?}", Unit::parse(text));
    }
    assert!(Length::parse("1e308 m").is_ok() && Pressure::parse("1e308 GPa").is_err());
    assert!(parse_any("1e300 m^60").is_err() || parse_any("1e300 km^60").is_err());
}

/// A power that is read counts: the square of any unit has twice each of its exponents.
#[test]
fn no_text_is_read_as_half_of_itself() {
    use proptest::prelude::*;
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(text in "[mskgNPa^0-9./*() √²⁻-]{0,12}")| {
        let Ok(unit) = Unit::parse(&text) else { return Ok(()) };
        prop_assert!(unit.factor.is_normal());
        if text.trim().is_empty() {
            return Ok(());
        }
        if let Ok(squared) = Unit::parse(&format!("({text})^2")) {
            let twice = unit.dimension.times(unit.dimension, power::Power::whole(1));
            prop_assert_eq!(Some(squared.dimension), twice);
        }
    });
}
