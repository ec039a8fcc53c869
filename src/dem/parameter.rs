//! Microparameters: the parameters of contact models, each declared once.
//!
//! Whoever reads, checks, lists or exports a microparameter asks here for its key, symbol, unit, range and meaning, and for the laws
//! that it has an effect on. Symbols are LaTeX; a bar marks the cement of a parallel bond.
//!
//! Three sets of them describe one spring, and one set is given:
//! * linear spring: `Ec` and `kn_ks` (the deformability method, [`interaction`](crate::interaction)), or `kn` and `ks`;
//! * cement: none (then `Ec` and `kn_ks` are those of the cement too), or `pb_Ec` and `pb_kn_ks`, or `pb_kn` and `pb_ks`.
//!
//! Strengths are stresses. The force that a contact bond carries is the stress on the section of the smaller disc or sphere:
//! σ_c 2 min(R) t in the plane (t = 1 m), σ_c π min(R)² in space; a parallel bond has λ min(R) in place of min(R).

use std::fmt;

/// A law that acts in a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Law {
    /// The linear spring with friction, in every contact.
    Spring,
    /// The contact bond.
    Contact,
    /// The parallel bond.
    Parallel,
    /// The flat joint.
    Flat,
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Spring => "linear spring",
            Self::Contact => "contact bond",
            Self::Parallel => "parallel bond",
            Self::Flat => "flat joint",
        })
    }
}

/// What a microparameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Stress, strength or modulus, Pa.
    Stress,
    /// Stiffness of a contact, N/m.
    Stiffness,
    /// Stiffness per area of the cement, Pa/m.
    StiffnessPerArea,
    /// Angle, rad.
    Angle,
    /// Length, m.
    Length,
    /// A pure number.
    Number,
    /// Standard deviation of a stress: a stress, or a share of the mean.
    Deviation,
}

impl Quantity {
    /// The SI unit; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Stress | Self::Deviation => "Pa",
            Self::Stiffness => "N/m",
            Self::StiffnessPerArea => "Pa/m",
            Self::Angle => "rad",
            Self::Length => "m",
            Self::Number => "",
        }
    }

    /// How a person writes it.
    pub const fn example(self) -> &'static str {
        match self {
            Self::Stress => "\"16 GPa\"",
            Self::Stiffness => "\"1.7e7 N/m\"",
            Self::StiffnessPerArea => "\"5.3e11 Pa/m\"",
            Self::Angle => "\"30 deg\"",
            Self::Length => "\"20 um\"",
            Self::Number => "2.5",
            Self::Deviation => "\"3 MPa\" or \"20 %\"",
        }
    }
}

/// The values that a microparameter may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Above 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// 0 to 1.
    Share,
    /// 0 to below 90°.
    Acute,
    /// A whole number from 1 to [`Division::MOST`](crate::Division::MOST).
    Count,
}

impl Range {
    /// Whether it holds the value.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Share => (0.0..=1.0).contains(&value),
                Self::Acute => (0.0..std::f64::consts::FRAC_PI_2).contains(&value),
                Self::Count => (1.0..=f64::from(crate::Division::MOST)).contains(&value) && value.fract() == 0.0,
            }
    }

    /// In words that follow "must be".
    pub const fn words(self) -> &'static str {
        match self {
            Self::Positive => "above 0",
            Self::NotNegative => "0 or more",
            Self::Share => "0 to 1",
            Self::Acute => "0 to below 90°",
            Self::Count => "a whole number from 1 to 32",
        }
    }
}

/// Description of a microparameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declaration {
    /// Key in a material, such as `sigma_c`.
    pub key: &'static str,
    /// Symbol in LaTeX.
    pub symbol: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Its values.
    pub range: Range,
    /// The value when none is given; NaN when one is needed or another microparameter replaces it.
    pub default: f64,
    /// Laws that it has an effect on.
    pub laws: &'static [Law],
    /// What it is.
    pub meaning: &'static str,
}

/// `parameters! { Variant, key, symbol, quantity, range, default, [laws], meaning; … }` becomes the enum of microparameters, the list of all and
/// the declaration of each.
macro_rules! parameters {
    ($($name:ident, $key:literal, $symbol:literal, $quantity:ident, $range:ident, $default:expr, [$($law:ident)*], $meaning:literal;)*) => {
        /// A microparameter.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Parameter {
            $(#[doc = $meaning] $name,)*
        }

        impl Parameter {
            /// All of them, in the order in which tables list them.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// Its declaration.
            pub const fn declaration(self) -> Declaration {
                match self {
                    $(Self::$name => Declaration {
                        key: $key,
                        symbol: $symbol,
                        quantity: Quantity::$quantity,
                        range: Range::$range,
                        default: $default,
                        laws: &[$(Law::$law),*],
                        meaning: $meaning,
                    },)*
                }
            }
        }
    };
}

parameters! {
    Modulus, "Ec", "E_c", Stress, Positive, f64::NAN, [Spring Parallel Flat],
        "contact modulus of the linear spring and of a flat joint, and of the cement when that has none of its own";
    Ratio, "kn_ks", "k_n/k_s", Number, Positive, f64::NAN, [Spring Parallel Flat],
        "normal over shear stiffness of the linear spring and of a flat joint, and of the cement when that has none of its own";
    Kn, "kn", "k_n", Stiffness, Positive, f64::NAN, [Spring], "normal stiffness of the linear spring, in place of `Ec`";
    Ks, "ks", "k_s", Stiffness, NotNegative, f64::NAN, [Spring], "shear stiffness of the linear spring, in place of `kn_ks`";
    Friction, "mu", r"\mu", Number, NotNegative, f64::NAN, [Spring Flat],
        "friction of the linear spring and of the broken elements of a flat joint; it acts where no bond holds";
    BondModulus, "pb_Ec", r"\bar E_c", Stress, Positive, f64::NAN, [Parallel], "modulus of the cement; `Ec` when not given";
    BondRatio, "pb_kn_ks", r"\bar k_n/\bar k_s", Number, Positive, f64::NAN, [Parallel],
        "normal over shear stiffness of the cement; `kn_ks` when not given";
    BondKn, "pb_kn", r"\bar k_n", StiffnessPerArea, Positive, f64::NAN, [Parallel],
        "normal stiffness of the cement per area, in place of a modulus";
    BondKs, "pb_ks", r"\bar k_s", StiffnessPerArea, NotNegative, f64::NAN, [Parallel],
        "shear stiffness of the cement per area, in place of a ratio";
    TensileStrength, "sigma_c", r"\bar\sigma_c", Stress, Positive, f64::NAN, [Contact Parallel Flat], "mean tensile strength of the bond";
    ShearStrength, "tau_c", r"\bar\tau_c", Stress, Positive, f64::NAN, [Contact Parallel Flat],
        "mean shear strength of the bond; with a friction angle its cohesion";
    TensileDeviation, "sigma_c_deviation", r"s_{\bar\sigma_c}", Deviation, NotNegative, 0.0, [Contact Parallel Flat],
        "standard deviation of the tensile strength from bond to bond";
    ShearDeviation, "tau_c_deviation", r"s_{\bar\tau_c}", Deviation, NotNegative, 0.0, [Contact Parallel Flat],
        "standard deviation of the shear strength from bond to bond";
    FrictionAngle, "friction_angle", r"\bar\phi", Angle, Acute, 0.0, [Parallel Flat],
        "friction angle of the bond: compression adds its tangent times the mean normal stress (flat joint: of each element) to the shear strength";
    RadiusMultiplier, "radius_multiplier", r"\bar\lambda", Number, Positive, 1.0, [Parallel Flat],
        "radius of the cement or the interface over the smaller radius of the two particles";
    MomentFactor, "moment_factor", r"\bar\beta", Number, Share, 1.0, [Parallel], "share of the moments in the stresses of the bond";
    Elements, "fj_elements", "N_e", Number, Count, 4.0, [Flat],
        "elements of an interface: equal segments in the plane, sectors of a ring in space (3 or more)";
    Rings, "fj_rings", "N_r", Number, Count, 1.0, [Flat],
        "rings of an interface in space, of equal area; in the plane it multiplies the segments";
    Gapped, "fj_gapped", r"\phi_G", Number, Share, 0.0, [Flat], "share of interfaces that are made unbonded and open by `fj_gap`";
    Slit, "fj_slit", r"\phi_S", Number, Share, 0.0, [Flat], "share of interfaces that are made unbonded and closed";
    InitialGap, "fj_gap", "g_0", Length, NotNegative, 0.0, [Flat], "gap of the gapped interfaces";
}

impl Parameter {
    /// Its key in a material.
    pub const fn key(self) -> &'static str {
        self.declaration().key
    }

    /// The microparameter with this key.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|parameter| parameter.key() == key)
    }
}

impl serde::Serialize for Parameter {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> serde::Deserialize<'de> for Parameter {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        Self::from_key(&key).ok_or_else(|| serde::de::Error::custom(format!("`{key}` is not a microparameter")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_symbols_are_unique_and_defaults_lie_in_their_range() {
        for (i, parameter) in Parameter::ALL.iter().enumerate() {
            let one = parameter.declaration();
            assert_eq!(Parameter::from_key(one.key), Some(*parameter));
            for other in &Parameter::ALL[i + 1..] {
                let other = other.declaration();
                assert!(one.key != other.key && one.symbol != other.symbol && one.meaning != other.meaning, "{one:?}");
            }
            assert!(one.default.is_nan() || one.range.holds(one.default), "{one:?}");
            assert!(!one.laws.is_empty());
        }
    }
}
