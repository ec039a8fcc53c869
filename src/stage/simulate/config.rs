//! Settings of a `simulate` stage, and the plain parameters that its tasks are made of.

use super::super::{Complaint, Context, Parameter, StageError};
use super::speed::PlatenSpeed;
use crate::unit::{Angle, Dimension, Length, Pressure};
use dem::loading::kind::TestKind;
use dem::loading::material::{BondKind, Bonded, Bonding, Material, MaterialError, Unbonded};
use dem::loading::rig::Machine;
use dem::loading::settings::{Loading, Notch, Rule};
use dem::{Convention, Masses};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of a `simulate` stage.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simulate {
    /// The specimen that is tested.
    pub specimen: String,
    /// The design whose rows are run; the material alone when not given.
    pub design: Option<String>,
    /// The `[material.NAME]` with the microparameters that rows vary.
    pub material: String,
    /// The test.
    pub test: TestKind,
    /// Speed of each platen or grip, or the strain rate, or the quasi-static number.
    pub platen_speed: PlatenSpeed,
    /// Friction of the platens.
    #[serde(default)]
    pub platen_friction: f64,
    /// Modulus of the contacts with the platens; that of the material when not given.
    pub platen_modulus: Option<Pressure>,
    /// `brazilian`: whole angle of the arc on which curved jaws touch the disc; flat platens when not given.
    pub jaw_angle: Option<Angle>,
    /// `biaxial`, `triaxial`: the confining stress.
    pub confinement: Option<Pressure>,
    /// `bending`: distance of the supports; nine tenths of the width when not given.
    pub span: Option<Length>,
    /// `bending`: the notch, if any.
    pub notch: Option<Notch>,
    /// Share of the peak at which the test ends.
    #[serde(default = "stop_fraction")]
    pub stop_fraction: f64,
    /// Further strain, over the strain at the peak, for which the stress must stay below that share; 0, but 0.05 for
    /// `brazilian` and `bending`, where a first contact may fail early.
    pub lasting: Option<f64>,
    /// Stress that must be passed before the test may end; a hundredth of the bonds' tensile strength when not given.
    pub seating_stress: Option<Pressure>,
    /// Strain between two samples; 1/500 of the strain at which the bonds can be expected to fail (tensile strength over
    /// modulus) when not given.
    pub sample_strain: Option<f64>,
    /// Strain at which a test without a peak is given up; 20 times the strain at which the bonds can be expected to fail
    /// when not given.
    pub strain_limit: Option<f64>,
    /// Steps after which a test is given up.
    #[serde(default = "max_steps")]
    pub max_steps: u64,
    /// Shares of the peak at which the state is kept.
    #[serde(default = "snapshots")]
    pub snapshots: Vec<f64>,
    /// Whether the forces between the discs are kept with these states, for force chains.
    #[serde(default)]
    pub forces: bool,
    /// Local damping.
    #[serde(default = "damping")]
    pub damping: f64,
    /// Masses that move the bodies: their own, or of one critical time step.
    #[serde(default)]
    pub masses: Masses,
    /// Whether different rows share packings.
    #[serde(default)]
    pub packing: PackingChoice,
    /// How bonds form and act.
    #[serde(default)]
    pub bond: BondConfig,
}

/// Whether different rows share packings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PackingChoice {
    /// Replicate k of every row stands on replicate k of the specimen.
    #[default]
    Shared,
    /// Every row and replicate has its own packing.
    Own,
}

/// How bonds form and act.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BondConfig {
    /// Parallel bond or contact bond.
    pub kind: BondKind,
    /// Bonds form at gaps up to this share of the mean radius; 0: where discs overlap.
    pub gap: f64,
    /// Bond radius over the smaller radius.
    pub radius_multiplier: f64,
    /// Share of the moment in the bond stresses.
    pub moment_factor: f64,
    /// Friction angle of the bond.
    pub friction_angle: Angle,
    /// Standard deviation of the strengths over their mean.
    pub deviation: f64,
    /// How a modulus becomes a stiffness.
    pub convention: Convention,
}

impl Default for BondConfig {
    fn default() -> Self {
        let Bonding { kind, gap, radius_multiplier, moment_factor, friction_angle, deviation, convention } =
            Bonding::default();
        let friction_angle = Angle::si(friction_angle);
        Self { kind, gap, radius_multiplier, moment_factor, friction_angle, deviation, convention }
    }
}

impl BondConfig {
    pub(super) fn bonding(&self) -> Bonding {
        Bonding {
            kind: self.kind,
            gap: self.gap,
            radius_multiplier: self.radius_multiplier,
            moment_factor: self.moment_factor,
            friction_angle: self.friction_angle.get(),
            deviation: self.deviation,
            convention: self.convention,
        }
    }
}

fn stop_fraction() -> f64 {
    Rule::default().stop_fraction
}

fn max_steps() -> u64 {
    Rule::default().max_steps
}

fn snapshots() -> Vec<f64> {
    Rule::default().snapshots
}

fn damping() -> f64 {
    Machine::default().damping
}

/// What decides a simulation besides its specimen and seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub(super) material: Material,
    pub(super) test: Loading,
}

const STRESS: Dimension = Dimension::new(-1, 1, -2);

/// Every microparameter by its path, with its dimension.
const MICROPARAMETERS: [(&str, Dimension); 13] = [
    ("mortar.Ec", STRESS),
    ("mortar.kn_ks", Dimension::NONE),
    ("mortar.sigma_c", STRESS),
    ("mortar.tau_c", STRESS),
    ("mortar.mu", Dimension::NONE),
    ("aggregate.Ec", STRESS),
    ("aggregate.kn_ks", Dimension::NONE),
    ("aggregate.mu", Dimension::NONE),
    ("interface.Ec", STRESS),
    ("interface.kn_ks", Dimension::NONE),
    ("interface.sigma_c", STRESS),
    ("interface.tau_c", STRESS),
    ("interface.mu", Dimension::NONE),
];

impl Simulate {
    /// The material's values by path, SI.
    pub(super) fn base(&self, context: &Context) -> Result<BTreeMap<String, f64>, StageError> {
        let found = context.materials.get(&self.material);
        let found = found.ok_or_else(|| StageError::new(format!("there is no [material.{}]", self.material)))?;
        Ok(found.iter().map(|(path, parameter)| (path.clone(), parameter.value)).collect())
    }

    /// All that is wrong with settings and material.
    pub(super) fn faults(&self, context: &Context) -> Vec<Complaint> {
        let mut faults = self.setting_faults();
        let Some(values) = context.materials.get(&self.material) else {
            let known: Vec<&str> = context.materials.keys().map(String::as_str).collect();
            let message = format!("there is no [material.{}]", self.material);
            faults.push(Complaint::new("material", message).hint(format!("known: {}", known.join(", "))));
            return faults;
        };
        faults.extend(self.material_faults(values));
        // What it lacks was told already.
        let mut base: BTreeMap<String, f64> = MICROPARAMETERS.map(|(path, _)| (path.to_owned(), 1.0)).into();
        base.extend(values.iter().map(|(path, parameter)| (path.clone(), parameter.value)));
        let outside = assembled(&base, self.bond.bonding()).map_or_else(|_| Vec::new(), |material| material.faults());
        faults.extend(outside.into_iter().map(|MaterialError { group, name, expected, .. }| {
            let complaint = Complaint::new(&format!("{group}.{name}"), format!("`{group}.{name}` must be {expected}"));
            if group == "bond" { complaint } else { complaint.in_material(&self.material) }
        }));
        faults
    }

    /// Microparameters that are missing, of another kind, or unknown.
    fn material_faults(&self, values: &BTreeMap<String, Parameter>) -> Vec<Complaint> {
        let known = || MICROPARAMETERS.iter().map(|(path, _)| *path);
        let mut faults = Vec::new();
        for (path, wanted) in MICROPARAMETERS {
            let complaint = match values.get(path) {
                None => Complaint::new(path, format!("[material.{}] lacks `{path}`", self.material))
                    .hint("every contact group needs its values"),
                Some(found) if found.dimension != wanted => {
                    let message = match (wanted == Dimension::NONE, found.dimension == Dimension::NONE) {
                        (true, _) => format!("`{path}` is a pure number and has no unit"),
                        (_, true) => format!("`{path}` needs a unit, found the number {}", found.value),
                        (false, false) => format!("`{path}` is a stress and cannot have this unit"),
                    };
                    let form = if wanted == STRESS { "\"16 GPa\"" } else { "2.5" };
                    Complaint::new(path, message).hint(format!("write for example {form}"))
                }
                Some(_) => continue,
            };
            faults.push(complaint.in_material(&self.material));
        }
        for path in values.keys().filter(|path| known().all(|known| known != path.as_str())) {
            let complaint = Complaint::new(path, format!("`{path}` is not a microparameter"));
            let hint = format!("known: {}", known().collect::<Vec<_>>().join(", "));
            faults.push(complaint.in_material(&self.material).hint(hint));
        }
        faults
    }
}

/// The material of parameters by path.
///
/// # Errors
/// A value is missing or outside the domain of its law.
pub(super) fn material(values: &BTreeMap<String, f64>, bonding: Bonding) -> Result<Material, StageError> {
    let material = assembled(values, bonding)?;
    let faults = material.faults();
    if faults.is_empty() {
        return Ok(material);
    }
    Err(StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")))
}

/// The material of parameters by path, whatever their values.
fn assembled(values: &BTreeMap<String, f64>, bonding: Bonding) -> Result<Material, StageError> {
    let get =
        |path: &str| values.get(path).copied().ok_or_else(|| StageError::new(format!("the material lacks `{path}`")));
    let bonded = |group: &str| -> Result<Bonded, StageError> {
        Ok(Bonded {
            modulus: get(&format!("{group}.Ec"))?,
            stiffness_ratio: get(&format!("{group}.kn_ks"))?,
            tensile_strength: get(&format!("{group}.sigma_c"))?,
            shear_strength: get(&format!("{group}.tau_c"))?,
            friction: get(&format!("{group}.mu"))?,
        })
    };
    let aggregate = Unbonded {
        modulus: get("aggregate.Ec")?,
        stiffness_ratio: get("aggregate.kn_ks")?,
        friction: get("aggregate.mu")?,
    };
    Ok(Material { mortar: bonded("mortar")?, aggregate, interface: bonded("interface")?, bonding })
}
