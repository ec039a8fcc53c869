//! Fissures of a `simulate` stage: their positions, and the law of their joints.

use super::super::Complaint;
use crate::unit::{Angle, Intensity, Length, Pressure, Stiffness};
use dem::genesis::network::Network;
use dem::loading::fissure::{Fissure, Fissures};
use math::text::Amount;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Fissures that are put into the specimen before it is bonded, each with smooth joints.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FissureConfig {
    /// Fissures one by one.
    #[serde(default)]
    pub list: Vec<JointConfig>,
    /// Fissures by their statistics; every specimen has its own.
    pub network: Option<NetworkConfig>,
    /// Friction on them.
    pub friction: f64,
    /// Dilation angle; 0 by default.
    pub dilation: Option<Angle>,
    /// Normal stiffness per area; by default that of the contacts of the first group.
    pub kn: Option<Stiffness>,
    /// Shear stiffness per area; needs `kn`.
    pub ks: Option<Stiffness>,
    /// Tensile strength of bonded fissures; without it they are open.
    pub tensile_strength: Option<Pressure>,
    /// Cohesion of bonded fissures; needs `tensile_strength`.
    pub cohesion: Option<Pressure>,
    /// Friction angle of their bond; 0 by default.
    pub friction_angle: Option<Angle>,
}

/// One fissure: a straight line in the plane, a disc in space.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointConfig {
    /// Its middle relative to that of the specimen: along the width, the axis of loading and (in space) the depth; 0 by
    /// default.
    pub centre: Option<Vec<Length>>,
    /// Angle below the horizontal.
    pub dip: Angle,
    /// Azimuth of the steepest descent, from the width towards the depth; 0 by default and in the plane.
    pub direction: Option<Angle>,
    /// Length, or diameter of the disc; by default it cuts through the specimen.
    pub length: Option<Length>,
}

/// Statistics of a network of fissures.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkConfig {
    /// Length per area (P21) in the plane, area per volume (P32) in space.
    pub intensity: Intensity,
    /// Smallest and largest length, or diameter of the discs.
    pub sizes: [Length; 2],
    /// Exponent a of the density of the sizes, l^(−a).
    pub exponent: f64,
    /// Mean angle below the horizontal.
    pub dip: Angle,
    /// Azimuth of the mean dip; 0 by default and in the plane.
    pub direction: Option<Angle>,
    /// κ of Fisher's law (space) or von Mises' law (plane); 0 has no preferred orientation.
    pub concentration: f64,
}

/// Largest number of fissures per square (cubic) metre, counted as if all had the smallest size.
const DENSEST: f64 = 1e8;

impl NetworkConfig {
    fn made(&self) -> Network {
        Network {
            intensity: self.intensity.get(),
            exponent: self.exponent,
            sizes: self.sizes.map(Length::get),
            mean: [self.dip.get(), self.direction.map_or(0.0, Angle::get)],
            concentration: self.concentration,
        }
    }

    fn faults(&self) -> Vec<Complaint> {
        let Network { intensity, exponent, sizes: [low, high], concentration, .. } = self.made();
        let (densest, per_length) = (intensity / low, Amount(intensity, "1/m"));
        let rules = [
            (intensity > 0.0, "intensity", per_length, "above 0"),
            (
                low > 0.0 && high >= low,
                "sizes",
                Amount(low, "m"),
                "a smallest size above 0 and a largest one not below it",
            ),
            (
                exponent.is_finite() && exponent.abs() <= 10.0,
                "exponent",
                Amount::number(exponent),
                "a number from -10 to 10",
            ),
            ((0.0..=1e4).contains(&concentration), "concentration", Amount::number(concentration), "0 to 10000"),
            (densest <= DENSEST, "intensity", per_length, "lower for sizes that small"),
        ];
        let wrong = rules.into_iter().filter(|(good, ..)| !good);
        let fault = |(_, key, found, wanted): (bool, &str, Amount, &str)| {
            let message = format!("`{key}` of the network is {found:#}; it must be {wanted}");
            Complaint::new(&format!("fissures.network.{key}"), message)
        };
        wrong.map(fault).collect()
    }
}

impl FissureConfig {
    /// The fissures in the types of the loading tests.
    pub(super) fn made(&self) -> Fissures {
        let centre = |one: &JointConfig, k: usize| one.centre.as_ref().and_then(|x| x.get(k)).map_or(0.0, |x| x.get());
        let fissure = |one: &JointConfig| Fissure {
            centre: std::array::from_fn(|k| centre(one, k)),
            dip: one.dip.get(),
            direction: one.direction.map_or(0.0, Angle::get),
            length: one.length.map(Length::get),
        };
        let angle = self.friction_angle.map_or(0.0, Angle::get);
        let bond =
            self.tensile_strength.zip(self.cohesion).map(|(tension, cohesion)| [tension, cohesion].map(Pressure::get));
        Fissures {
            list: self.list.iter().map(fissure).collect(),
            network: self.network.as_ref().map(NetworkConfig::made),
            stiffness: self.kn.zip(self.ks).map(|(kn, ks)| [kn.get(), ks.get()]),
            friction: self.friction,
            dilation: self.dilation.map_or(0.0, Angle::get),
            bond: bond.map(|[tension, cohesion]| [tension, cohesion, angle]),
        }
    }

    /// All faults of the settings.
    pub(super) fn faults(&self) -> Vec<Complaint> {
        let mut faults = Vec::new();
        let mut check = |good: bool, key: &str, message: String| {
            if !good {
                faults.push(Complaint::new(&format!("fissures.{key}"), message));
            }
        };
        let acute = |angle: f64| (0.0..std::f64::consts::FRAC_PI_2).contains(&angle);
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let none = self.list.is_empty() && self.network.is_none();
        check(!none, "list", "there is no fissure: give a `list` or a `network`, or leave out `fissures`".to_owned());
        let friction = self.friction;
        check(friction >= 0.0, "friction", format!("`friction` is {friction}; it must be 0 or more"));
        let angles = [("dilation", self.dilation), ("friction_angle", self.friction_angle)];
        for (key, angle) in angles.into_iter().filter_map(|(key, angle)| Some((key, angle?.get()))) {
            check(acute(angle), key, format!("`{key}` is {:#}; it must be 0 to below 90°", Amount(angle, "rad")));
        }
        let pressures = [("tensile_strength", self.tensile_strength), ("cohesion", self.cohesion)];
        for (key, value) in pressures.into_iter().filter_map(|(key, value)| Some((key, value?.get()))) {
            check(positive(value), key, format!("`{key}` is {:#}; it must be above 0", Amount(value, "Pa")));
        }
        let per_area = |stiffness: Stiffness| Amount(stiffness.get(), "Pa/m");
        if let Some(kn) = self.kn.map(per_area) {
            check(positive(kn.0), "kn", format!("`kn` is {kn:#}; it must be above 0"));
        }
        if let Some(ks) = self.ks.map(per_area) {
            check(ks.0 >= 0.0, "ks", format!("`ks` is {ks:#}; it must be 0 or more"));
        }
        check(self.kn.is_some() == self.ks.is_some(), "kn", "`kn` and `ks` go together".to_owned());
        let bonded = self.tensile_strength.is_some();
        let words = "`tensile_strength` and `cohesion` go together".to_owned();
        check(bonded == self.cohesion.is_some(), "tensile_strength", words);
        let words = "`friction_angle` has no effect without `tensile_strength` and `cohesion`".to_owned();
        check(bonded || self.friction_angle.is_none(), "friction_angle", words);
        for one in &self.list {
            let length = Amount(one.length.map_or(1.0, Length::get), "m");
            check(positive(length.0), "list", format!("`length` of a fissure is {length:#}; it must be above 0"));
            let count = one.centre.as_ref().map_or(2, Vec::len);
            let words = format!("`centre` of a fissure has {count} coordinates; it must have 2, in space 3");
            check((2..=3).contains(&count), "list", words);
        }
        faults.extend(self.network.iter().flat_map(NetworkConfig::faults));
        faults
    }
}
