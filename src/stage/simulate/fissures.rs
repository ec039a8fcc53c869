//! Fissures of a `simulate` stage: their positions, and the law of their joints.
//!
//! A stage has sets of them, each with its own law: fissures one by one (`list`), from a table (`file`, see
//! [`traces`](super::traces)), or by their statistics (`network`). The table is read when the test runs; its content is in the
//! key of the task.

use super::super::beside::Beside;
use super::super::{Complaint, Failure, Job, Known, StageError, Task};
use super::traces;
use crate::unit::{Angle, Intensity, Length, Pressure, Stiffness};
use dem::genesis::network::Network;
use dem::loading::fissure::{Fissure, Fissures};
use math::text::Amount;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A set of fissures that are put into the specimen before it is bonded, each with smooth joints.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FissureConfig {
    /// Fissures one by one.
    #[serde(default)]
    pub list: Vec<JointConfig>,
    /// CSV file beside the workflow with a fissure in each row, with units in the heads: `x`, `y` (in space `z`), `dip`, `length`
    /// and in space `direction`; or in the plane the two ends `x1`, `y1`, `x2`, `y2`.
    pub file: Option<String>,
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
    fn made(&self, seed: u64) -> Network {
        Network {
            seed,
            intensity: self.intensity.get(),
            exponent: self.exponent,
            sizes: self.sizes.map(Length::get),
            mean: [self.dip.get(), self.direction.map_or(0.0, Angle::get)],
            concentration: self.concentration,
        }
    }

    fn check(&self, check: &mut dyn FnMut(bool, &str, String)) {
        let Network { intensity, exponent, sizes: [low, high], concentration, .. } = self.made(0);
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
        for (good, key, found, wanted) in rules {
            let message = format!("`{key}` of the network is {found:#}; it must be {wanted}");
            check(good, &format!("network.{key}"), message);
        }
    }
}

impl FissureConfig {
    /// The fissures in the types of the loading tests, without those of the file; networks follow from the campaign's `seed`.
    pub(super) fn made(&self, seed: u64) -> Fissures {
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
            network: self.network.as_ref().map(|network| network.made(seed)),
            stiffness: self.kn.zip(self.ks).map(|(kn, ks)| [kn.get(), ks.get()]),
            friction: self.friction,
            dilation: self.dilation.map_or(0.0, Angle::get),
            bond: bond.map(|[tension, cohesion]| [tension, cohesion, angle]),
        }
    }

    /// All faults of the settings of set `set`, in a specimen of so many dimensions, where that is known.
    pub(super) fn faults(&self, set: usize, dimension: Option<usize>) -> Vec<Complaint> {
        let mut faults = Vec::new();
        let mut check = |good: bool, key: &str, message: String| {
            if !good {
                faults.push(Complaint::new(&format!("fissures.{set}.{key}"), message));
            }
        };
        let none = self.list.is_empty() && self.network.is_none() && self.file.is_none();
        let words = "there is no fissure: give a `list`, a `file` or a `network`, or leave out the set";
        check(!none, "", words.to_owned());
        check(self.file.as_deref() != Some(""), "file", "the name of the file is empty".to_owned());
        self.check_law(&mut check);
        for one in &self.list {
            let length = Amount(one.length.map_or(1.0, Length::get), "m");
            let positive = length.0 > 0.0 && length.0.is_finite();
            check(positive, "list", format!("`length` of a fissure is {length:#}; it must be above 0"));
            let count = one.centre.as_ref().map_or(2, Vec::len);
            let words = format!("`centre` of a fissure has {count} coordinates; it must have 2, in space 3");
            check((2..=3).contains(&count), "list", words);
            let flat = dimension == Some(2);
            let words = "the third coordinate of `centre` has no effect in the plane; leave it out";
            check(!(flat && count == 3), "list", words.to_owned());
            let words = "`direction` has no effect in the plane; leave it out";
            check(!(flat && one.direction.is_some()), "list", words.to_owned());
        }
        if let Some(network) = &self.network {
            let flat = dimension == Some(2) && network.direction.is_some();
            check(!flat, "network.direction", "`direction` has no effect in the plane; leave it out".to_owned());
            network.check(&mut check);
        }
        faults
    }

    /// Checks the settings of the joints.
    fn check_law(&self, check: &mut dyn FnMut(bool, &str, String)) {
        let acute = |angle: f64| (0.0..std::f64::consts::FRAC_PI_2).contains(&angle);
        let positive = |x: f64| x > 0.0 && x.is_finite();
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
    }
}

/// The name that the file of a set has in a task.
fn file_name(set: usize) -> String {
    format!("fissures {}", set + 1)
}

/// Adds the files of the sets to a task.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn add_files(sets: &[FissureConfig], known: &Known, mut task: Task) -> Result<Task, StageError> {
    for (set, path) in sets.iter().enumerate().filter_map(|(set, own)| Some((set, own.file.as_ref()?))) {
        task.files.push(known.library.file(&file_name(set), path)?);
    }
    Ok(task)
}

/// Adds the fissures of the files of a task to their sets, for a piece of so many dimensions.
///
/// # Errors
/// A file that cannot be read, or what is wrong in it.
pub(super) fn read_files(job: &Job, sets: &mut [Fissures], dimension: usize) -> Result<(), Failure> {
    for (set, fissures) in sets.iter_mut().enumerate() {
        let name = file_name(set);
        if job.files.iter().any(|file| file.name == name) {
            fissures.list.extend(traces::read(&job.file(&name)?, dimension)?);
        }
    }
    Ok(())
}

/// Looks into the files of the sets before anything runs.
pub(super) fn look_into(sets: &[FissureConfig], dimension: Option<usize>, found: &mut Beside) {
    for (set, path) in sets.iter().enumerate().filter_map(|(set, own)| Some((set, own.file.as_ref()?))) {
        let key = format!("fissures.{set}.file");
        let Some(bytes) = found.bytes(&key, path) else { continue };
        let Some(dimension) = dimension else { continue };
        if let Err(StageError { message, hint }) = traces::read(&bytes, dimension) {
            let complaint = Complaint::new(&key, format!("{path}: {message}"));
            found.faults.push(Complaint { hint, ..complaint });
        }
    }
}
