//! Physical quantities as people write them: `"16 GPa"`, `"0.5 mm"`, `"2650 kg/m^3"`. SI inside.
//!
//! A unit is a product of powers of the symbols below, with SI prefixes where they are usual. A [`Quantity`] carries
//! its dimension in its type, so a length cannot be read where a pressure is wanted; it is read from text only, and
//! a bare number is refused with the right form.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

mod convert;
mod near;
mod power;
mod read;

pub use convert::Conversion;

use power::Power;

/// Exponents of metre, kilogram and second. An angle is a pure number (radians).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    length: Power,
    mass: Power,
    time: Power,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self::new(0, 0, 0);

    /// Whole exponents of metre, kilogram, second.
    pub const fn new(length: i8, mass: i8, time: i8) -> Self {
        Self { length: Power::whole(length), mass: Power::whole(mass), time: Power::whole(time) }
    }

    /// The dimension of a product; `None` when an exponent has no small fraction.
    pub fn product(self, other: Self) -> Option<Self> {
        self.times(other, Power::whole(1))
    }

    /// The dimension of a power; `None` when an exponent has no small fraction.
    pub fn power(self, exponent: f64) -> Option<Self> {
        if self == Self::NONE {
            return Some(self);
        }
        let whole = |d: &f64| (exponent * d - (exponent * d).round()).abs() < 1e-9;
        let denominator = (1..=12).map(f64::from).find(whole)?;
        let power = Power::read(&format!("{}/{denominator}", (exponent * denominator).round()))?;
        Self::NONE.times(self, power)
    }

    /// `self · other^power`; `None` when an exponent has no small fraction.
    fn times(self, other: Self, power: Power) -> Option<Self> {
        let one = |a: Power, b: Power| a.plus(b.times(power)?);
        Some(Self {
            length: one(self.length, other.length)?,
            mass: one(self.mass, other.mass)?,
            time: one(self.time, other.time)?,
        })
    }
}

/// As its SI unit: that of the list of symbols, else a product of powers of metre, kilogram and second.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE {
            return f.write_str("a pure number");
        }
        let coherent = SYMBOLS.iter().find(|(_, factor, dimension, _)| *factor == 1.0 && dimension == self);
        if let Some((symbol, ..)) = coherent {
            return f.write_str(symbol);
        }
        let powers = [("kg", self.mass), ("m", self.length), ("s", self.time)];
        let parts = powers.into_iter().filter(|(_, power)| *power != Power::whole(0));
        let part = |(symbol, power): (&str, Power)| match power == Power::whole(1) {
            true => symbol.to_owned(),
            false => format!("{symbol}^{power}"),
        };
        f.write_str(&parts.map(part).collect::<Vec<_>>().join(" "))
    }
}

/// A unit: how many SI units it is, and of what dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// SI units in one of this unit.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

/// What is wrong with a quantity's text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// The text does not begin with a number.
    #[error("`{0}` does not begin with a number; write for example \"{1}\"")]
    NoNumber(String, &'static str),
    /// The number is infinite, not a number, or too close to zero.
    #[error("`{0}` is not a finite number, or too small for one")]
    NotFinite(String),
    /// A number without a unit.
    #[error("`{0}` needs a unit; write for example \"{1}\"")]
    NoUnit(String, &'static str),
    /// A sign of multiplication or division with nothing beside it, or a bracket without its partner.
    #[error("`{0}` has a sign with no unit beside it, or an open bracket; write for example \"kg/m^3\"")]
    Incomplete(String),
    /// A power that is not a number, or beyond all use.
    #[error(
        "`{0}` has a power that is no number from -60 to 60; write for example \"m^2\", \"m^-1\", \"m^0.5\" or \"m^(1/3)\""
    )]
    Power(String),
    /// Powers whose product no number holds.
    #[error("`{0}` is too large or too small a unit")]
    Extreme(String),
    /// A symbol that is not known, and the one that was meant or all that are.
    #[error("`{0}` is not a unit that flow knows; {1}")]
    Unknown(String, String),
    /// A decimal comma.
    #[error("`{0}` has a decimal comma; write \"{1}\"")]
    Comma(String, String),
    /// Two units of different kinds of quantity.
    #[error("the two units measure different quantities")]
    Differ,
    /// A unit of another kind of quantity.
    #[error("`{found}` is not a unit of {wanted}; write for example \"{example}\"")]
    OtherKind {
        /// The unit as written.
        found: String,
        /// The quantity that is wanted, such as `length`.
        wanted: &'static str,
        /// The right form.
        example: &'static str,
    },
}

/// Symbol, SI factor, dimension, and whether SI prefixes are usual on it.
const SYMBOLS: &[(&str, f64, Dimension, bool)] = &[
    ("m", 1.0, Dimension::new(1, 0, 0), true),
    ("g", 1e-3, Dimension::new(0, 1, 0), true),
    ("t", 1e3, Dimension::new(0, 1, 0), false),
    ("s", 1.0, Dimension::new(0, 0, 1), true),
    ("min", 60.0, Dimension::new(0, 0, 1), false),
    ("h", 3600.0, Dimension::new(0, 0, 1), false),
    ("d", 86_400.0, Dimension::new(0, 0, 1), false),
    ("Hz", 1.0, Dimension::new(0, 0, -1), true),
    ("N", 1.0, Dimension::new(1, 1, -2), true),
    ("Pa", 1.0, Dimension::new(-1, 1, -2), true),
    ("J", 1.0, Dimension::new(2, 1, -2), true),
    ("W", 1.0, Dimension::new(2, 1, -3), true),
    ("rad", 1.0, Dimension::NONE, false),
    ("deg", std::f64::consts::PI / 180.0, Dimension::NONE, false),
    ("°", std::f64::consts::PI / 180.0, Dimension::NONE, false),
    ("%", 1e-2, Dimension::NONE, false),
    ("‰", 1e-3, Dimension::NONE, false),
    ("1", 1.0, Dimension::NONE, false),
];

/// The sign of a millionth is written as `u` too, and as the Greek letter, which looks the same and is another character.
const PREFIXES: &[(&str, f64)] = &[
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("c", 1e-2),
    ("m", 1e-3),
    ("\u{b5}", 1e-6),
    ("\u{3bc}", 1e-6),
    ("u", 1e-6),
    ("n", 1e-9),
];

impl Unit {
    /// Reads a unit such as `GPa`, `m/s`, `kg/m^3` or `MPa*m^0.5`; the empty text is the pure number.
    ///
    /// Factors are joined by `*`, `·` or a space; all that follows a `/`, up to the next one, divides. A power is a
    /// whole number, a decimal or a fraction (`m^(1/3)`), or raised digits (`m²`, `s⁻¹`); `√m` is `m^0.5`. Brackets
    /// hold units together: `J/(kg*m)`.
    ///
    /// # Errors
    /// The symbol that is not known, the power that is no number, the sign with nothing beside it.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        if text.trim().is_empty() {
            return Ok(Self { factor: 1.0, dimension: Dimension::NONE });
        }
        read::Reader::new(text).whole()
    }
}

fn symbol_unit(symbol: &str) -> Option<Unit> {
    let plain = |symbol: &str, prefixed: bool| {
        let (_, factor, dimension, _) = SYMBOLS.iter().find(|s| s.0 == symbol && (!prefixed || s.3))?;
        Some(Unit { factor: *factor, dimension: *dimension })
    };
    plain(symbol, false).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, scale)| {
            let unit = plain(symbol.strip_prefix(prefix)?, true)?;
            Some(Unit { factor: unit.factor * scale, ..unit })
        })
    })
}

/// What to write instead of a symbol that is not known.
fn instead_of(symbol: &str) -> String {
    near::meant(symbol).map_or_else(
        || {
            let known = SYMBOLS.iter().map(|s| s.0).collect::<Vec<_>>().join(", ");
            format!("known are {known}, with the prefixes G M k c m µ n where usual")
        },
        |meant| format!("did you mean `{meant}`?"),
    )
}

/// A kind of physical quantity.
pub trait Kind {
    /// Its dimension.
    const DIMENSION: Dimension;
    /// Its name in messages.
    const NAME: &'static str;
    /// The form in which a person writes it.
    const EXAMPLE: &'static str;
}

/// A number of SI units of a kind of quantity.
pub struct Quantity<K>(f64, PhantomData<K>);

impl<K: Kind> Quantity<K> {
    /// From a number of SI units.
    pub const fn si(value: f64) -> Self {
        Self(value, PhantomData)
    }

    /// The number of SI units.
    pub const fn get(self) -> f64 {
        self.0
    }

    /// Reads `"16 GPa"`.
    ///
    /// # Errors
    /// What is wrong with number or unit, with the right form.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let text = text.trim();
        let (value, rest) = finite(text, K::EXAMPLE)?;
        if rest.is_empty() && K::DIMENSION != Dimension::NONE {
            return Err(UnitError::NoUnit(text.to_owned(), K::EXAMPLE));
        }
        let unit = Unit::parse(rest)?;
        if unit.dimension != K::DIMENSION {
            return Err(UnitError::OtherKind { found: rest.to_owned(), wanted: K::NAME, example: K::EXAMPLE });
        }
        si(text, value, unit).map(Self::si)
    }
}

/// Reads a number with or without a unit of any kind: its SI value and dimension.
///
/// # Errors
/// What is wrong with number or unit.
pub fn parse_any(text: &str) -> Result<(f64, Dimension), UnitError> {
    let (value, rest) = finite(text.trim(), "16 GPa")?;
    let unit = Unit::parse(rest)?;
    Ok((si(text, value, unit)?, unit.dimension))
}

/// Reads a number with or without a unit of any kind, as the number and the text of its unit.
///
/// # Errors
/// What is wrong with the number.
pub fn split_any(text: &str) -> Result<(f64, &str), UnitError> {
    finite(text.trim(), "16 GPa")
}

/// The number of SI units, which must be finite too.
fn si(text: &str, value: f64, unit: Unit) -> Result<f64, UnitError> {
    let si = value * unit.factor;
    let lost = si == 0.0 && value != 0.0;
    if si.is_finite() && !lost { Ok(si) } else { Err(UnitError::NotFinite(text.to_owned())) }
}

fn finite<'t>(text: &'t str, example: &'static str) -> Result<(f64, &'t str), UnitError> {
    let (value, rest) = split_number(text).ok_or_else(|| UnitError::NoNumber(text.to_owned(), example))?;
    if let Some(meant) = near::without_comma(text) {
        return Err(UnitError::Comma(text.to_owned(), meant));
    }
    if value.is_finite() { Ok((value, rest)) } else { Err(UnitError::NotFinite(text.to_owned())) }
}

/// Whether a text that was read as zero has another digit than 0 before its exponent: it is too small for a double.
pub fn vanishes(text: &str, value: f64) -> bool {
    let mantissa = text.split(['e', 'E', 'd', 'D', 'q', 'Q']).next().unwrap_or_default();
    value == 0.0 && mantissa.bytes().any(|digit| (b'1'..=b'9').contains(&digit))
}

/// The longest leading text that is a number, and what follows it.
fn split_number(text: &str) -> Option<(f64, &str)> {
    let numeric = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E' | '_');
    let mut end = text.find(|c| !numeric(c)).unwrap_or(text.len());
    while end > 0 {
        if let Ok(value) = text[..end].replace('_', "").parse() {
            // A number that nothing can be computed with is none: it is refused as an infinite one is.
            let value = if vanishes(&text[..end], value) { f64::NAN } else { value };
            return Some((value, text[end..].trim_start()));
        }
        end -= 1;
    }
    None
}

impl<K> Clone for Quantity<K> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<K> Copy for Quantity<K> {}
impl<K> PartialEq for Quantity<K> {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}
impl<K> PartialOrd for Quantity<K> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.0.partial_cmp(&other.0)
    }
}
impl<K> fmt::Debug for Quantity<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// As the number of SI units.
impl<K> Serialize for Quantity<K> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

/// From text with its unit only: this is how a person writes it. Programs hand over plain SI numbers.
impl<'de, K: Kind> Deserialize<'de> for Quantity<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor<K>(PhantomData<K>);
        impl<K: Kind> de::Visitor<'_> for Visitor<K> {
            type Value = Quantity<K>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a {} with its unit, such as \"{}\"", K::NAME, K::EXAMPLE)
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
                Quantity::parse(text).map_err(E::custom)
            }
            /// A hole: the value was faulty, which is reported already.
            fn visit_unit<E: de::Error>(self) -> Result<Self::Value, E> {
                Ok(Quantity::si(1.0))
            }
        }
        deserializer.deserialize_any(Visitor(PhantomData))
    }
}

/// A number and something behind it, for editors; the reader knows better what.
const WITH_UNIT: &str = r"^\s*[-+]?[0-9._]+([eE][-+]?[0-9]+)?\s*[^\s0-9]";

impl<K: Kind> JsonSchema for Quantity<K> {
    fn schema_name() -> Cow<'static, str> {
        K::NAME.replace(' ', "_").into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "string",
            "pattern": if K::DIMENSION == Dimension::NONE { r"^\s*[-+]?[0-9._]" } else { WITH_UNIT },
            "description": format!("A {} with its unit, such as \"{}\".", K::NAME, K::EXAMPLE),
            "examples": [K::EXAMPLE],
        })
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $alias:ident, $marker:ident = ($l:literal, $m:literal, $t:literal), $name:literal, $example:literal;)*) => {$(
        #[doc = concat!("Marker of [`", stringify!($alias), "`].")]
        pub enum $marker {}
        impl Kind for $marker {
            const DIMENSION: Dimension = Dimension::new($l, $m, $t);
            const NAME: &'static str = $name;
            const EXAMPLE: &'static str = $example;
        }
        $(#[$doc])*
        pub type $alias = Quantity<$marker>;
    )*};
}
kinds! {
    /// Metres.
    Length, LengthKind = (1, 0, 0), "length", "0.5 mm";
    /// Pascals: stress, strength, modulus.
    Pressure, PressureKind = (-1, 1, -2), "stress or modulus", "16 GPa";
    /// Pascals per metre: stiffness of a joint.
    Stiffness, StiffnessKind = (-2, 1, -2), "stiffness per area", "5e12 Pa/m";
    /// Per metre: intensity of fractures.
    Intensity, IntensityKind = (-1, 0, 0), "intensity of fractures", "50 m^-1";
    /// Metres per second.
    Velocity, VelocityKind = (1, 0, -1), "velocity", "0.02 m/s";
    /// Per second.
    Rate, RateKind = (0, 0, -1), "strain rate", "0.1 s^-1";
    /// Kilograms per cubic metre.
    Density, DensityKind = (-3, 1, 0), "density", "2650 kg/m^3";
    /// Metres per second squared.
    Acceleration, AccelerationKind = (1, 0, -2), "acceleration", "9.81 m/s^2";
    /// Seconds.
    Time, TimeKind = (0, 0, 1), "time", "30 s";
    /// Newtons.
    Force, ForceKind = (1, 1, -2), "force", "10 kN";
    /// Kilograms.
    Mass, MassKind = (0, 1, 0), "mass", "2.5 kg";
    /// Radians.
    Angle, AngleKind = (0, 0, 0), "angle", "30 deg";
}

#[cfg(test)]
mod tests;
