//! Settings of a `simulate` stage, and the parameters of its tasks.

use super::super::material::{self, Bonding, GivenMaterial, Need};
use super::super::rows;
use super::super::{Complaint, Context, Known, Named, Point, StageError};
use super::fissures::FissureConfig;
use super::speed::PlatenSpeed;
use crate::expression::Measure;
use crate::unit::{Angle, Length, Pressure};
use dem::genesis::region::Region;
use dem::loading::kind::TestKind;
use dem::loading::material::{BondKind, Material};
use dem::loading::rig::Machine;
use dem::loading::settings::{Loading, Notch, Rule};
use dem::parameter::Parameter;
use dem::{Convention, Masses};
use math::text::Amount;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of a `simulate` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simulate {
    /// The specimen that is tested.
    pub specimen: String,
    /// The design whose rows are run; without it there is one run, of the material.
    pub design: Option<String>,
    /// The `[material.NAME]` with the microparameters that rows vary, or the stage whose result gives them: formulas, or a
    /// calibration.
    pub material: String,
    /// Number of the set of a calibrated material; the first by default.
    pub set: Option<usize>,
    /// The test.
    pub test: TestKind,
    /// Speed of each platen or grip, or the strain rate, or the quasi-static number.
    pub platen_speed: PlatenSpeed,
    /// Friction of the platens.
    #[serde(default)]
    pub platen_friction: f64,
    /// Modulus of the contacts with the platens; by default that of the material.
    pub platen_modulus: Option<Pressure>,
    /// `brazilian`: whole angle of the arc on which curved jaws touch the disc; by default platens are flat.
    pub jaw_angle: Option<Angle>,
    /// `biaxial`, `triaxial`: the confining stress.
    pub confinement: Option<Pressure>,
    /// `bending`: distance of the supports; by default nine tenths of the width.
    pub span: Option<Length>,
    /// `bending`: the notch, if any.
    pub notch: Option<Notch>,
    /// Fraction of the peak stress at which the test ends.
    #[serde(default = "stop_fraction")]
    pub stop_fraction: f64,
    /// Further strain, divided by the strain at the peak, for which the stress must stay below that fraction; 0 by default, but
    /// 0.05 for `brazilian` and `bending`, where a first contact may fail early.
    pub lasting: Option<f64>,
    /// Stress that must be exceeded before the test may end; by default a hundredth of the bonds' tensile strength.
    pub seating_stress: Option<Pressure>,
    /// Strain between two samples; by default 1/500 of the strain at which the bonds can be expected to fail (tensile strength
    /// over modulus).
    pub sample_strain: Option<f64>,
    /// Strain at which a test without a peak is stopped; by default 20 times the strain at which the bonds can be expected to
    /// fail.
    pub strain_limit: Option<f64>,
    /// Number of steps after which a test is stopped.
    #[serde(default = "max_steps")]
    pub max_steps: u64,
    /// Fractions of the peak stress at which the state is stored.
    #[serde(default = "snapshots")]
    pub snapshots: Vec<f64>,
    /// Whether the forces between the discs are stored with these states, for force chains.
    #[serde(default)]
    pub forces: bool,
    /// Local damping.
    #[serde(default = "damping")]
    pub damping: f64,
    /// Masses of the bodies: their own, or masses that give all the same critical time step.
    #[serde(default)]
    pub masses: Masses,
    /// Whether different rows share packings.
    #[serde(default)]
    pub packing: PackingChoice,
    /// How bonds form and act.
    #[serde(default)]
    pub bond: BondConfig,
    /// Fissures that are put into the specimen before it is bonded, set by set.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fissures: Vec<FissureConfig>,
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

/// Formation and law of bonds.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BondConfig {
    /// Law of the bonds of entries of the material that name none.
    pub kind: BondKind,
    /// Bonds form at gaps up to this fraction of the mean radius; with 0, where particles overlap.
    pub gap: f64,
    /// Radius multiplier of contacts for which the material has none.
    pub radius_multiplier: Option<f64>,
    /// Moment factor of contacts for which the material has none.
    pub moment_factor: Option<f64>,
    /// Friction angle of bonds for which the material has none.
    pub friction_angle: Option<Angle>,
    /// Definition of the stiffness by a modulus.
    pub convention: Convention,
}

impl BondConfig {
    pub(super) fn bonding(&self) -> Bonding {
        let values = [
            (Parameter::RadiusMultiplier, self.radius_multiplier),
            (Parameter::MomentFactor, self.moment_factor),
            (Parameter::FrictionAngle, self.friction_angle.map(Angle::get)),
        ];
        let values = values.into_iter().filter_map(|(parameter, value)| Some((parameter, value?))).collect();
        Bonding { kind: self.kind, gap: self.gap, convention: self.convention, fissures: Vec::new(), values }
    }

    fn faults(&self) -> Vec<Complaint> {
        let outside =
            self.bonding().values.into_iter().filter(|(parameter, value)| !parameter.declaration().range.holds(*value));
        let fault = |(parameter, value): (Parameter, f64)| {
            let (key, declared) = (parameter.key(), parameter.declaration());
            let found = Amount(value, declared.quantity.unit());
            let message = format!("`{key}` is {found:#}; it must be {}", declared.range.words());
            Complaint::new(&format!("bond.{key}"), message)
        };
        let mut faults: Vec<Complaint> = outside.map(fault).collect();
        if !(0.0..=1.0).contains(&self.gap) {
            let message = format!("`gap` is {}; it must be a share of the mean radius, 0 to 1", self.gap);
            faults.push(Complaint::new("bond.gap", message));
        }
        faults
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

/// Parameters of the task: everything that decides a simulation besides its specimen and seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub(super) material: Material,
    pub(super) test: Loading,
    /// Whether the record says which elements of which interfaces its cracks are, and which fissures there are: with flat
    /// joints and with fissures.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) joints: bool,
    /// [`revision`] of the kind of test, so that its results are kept apart from earlier ones.
    #[serde(default, skip_serializing_if = "is_first")]
    revision: u32,
}

fn is_first(revision: &u32) -> bool {
    *revision == 0
}

/// Raised when the results of one kind of test change and those of the others do not: where all change, the version of the work
/// function is raised instead.
fn revision(test: TestKind) -> u32 {
    match test {
        // 1: the rollers go with the beam; on the flank of a ball they pushed it along.
        TestKind::Bending => 1,
        _ => 0,
    }
}

/// Whether some contacts are flat joints.
fn flat(material: &Material) -> bool {
    material.contacts.values().any(|contact| contact.bond == BondKind::FlatJoint)
}

impl Params {
    pub(super) fn new(material: Material, test: Loading) -> Self {
        let joints = flat(&material) || !material.fissures.is_empty();
        let revision = revision(test.kind);
        Self { material, test, joints, revision }
    }

    /// Whether the record names the interfaces of its cracks.
    pub(super) fn interfaces(&self) -> bool {
        self.joints && flat(&self.material)
    }
}

impl Simulate {
    /// The microparameters at a point of the factor space.
    ///
    /// # Errors
    /// The material lacks what the specimen's contacts need, or a value is outside the domain of its law.
    pub(super) fn contacts(
        &self,
        context: &Context,
        material: &material::Material,
        point: &Point,
    ) -> Result<Material, StageError> {
        let values = rows::apply(material, point, context)?;
        let bonding = self.bonding(context.seed);
        material.contacts(&values, self.need(context, &bonding)).map_err(|faults| {
            let hint = faults.iter().find_map(|fault| fault.hint.clone());
            let words: Vec<String> = faults.into_iter().map(|fault| fault.message).collect();
            StageError { message: words.join("; "), hint }
        })
    }

    /// The material, and the point of a calibrated one.
    ///
    /// # Errors
    /// The result of the stage under `material` is not a material.
    pub(super) fn given(&self, known: &Known) -> Result<GivenMaterial, StageError> {
        if let Some(material) = known.context.materials.get(&self.material) {
            return Ok(GivenMaterial { material: material.clone(), point: Point::new() });
        }
        let input = known.one("material")?;
        let groups = known.context.sketches.get(&self.specimen).map_or(&[][..], |sketch| &sketch.groups);
        material::given(input.stage, &*known.load(input)?, self.set.unwrap_or(1), groups, known.context)
    }

    /// The settings of the stage for all bonds, in a campaign of this seed.
    fn bonding(&self, seed: u64) -> Bonding {
        let fissures = self.fissures.iter().map(|set| set.made(seed)).collect();
        Bonding { fissures, ..self.bond.bonding() }
    }

    fn need<'a>(&'a self, context: &'a Context, bonding: &'a Bonding) -> Need<'a> {
        let groups = context.sketches.get(&self.specimen).map_or(&[][..], |sketch| &sketch.groups);
        Need { name: context.materials.contains_key(&self.material).then_some(&self.material), groups, bonding }
    }

    /// All faults of settings and material.
    pub(super) fn faults(&self, context: &Context) -> Vec<Complaint> {
        let mut faults = self.setting_faults();
        faults.extend(self.bond.faults());
        let region = context.sketches.get(&self.specimen).and_then(|sketch| sketch.region);
        let dimension = region.map(|region| region.dimension());
        faults.extend(self.fissures.iter().enumerate().flat_map(|(set, own)| own.faults(set, dimension)));
        let suits = |region: Region| self.test.suits(&region.into(), region.dimension());
        faults.extend(region.and_then(|region| suits(region).err()).map(|e| Complaint::new("test", e.to_string())));
        let named = context.materials.get(&self.material);
        if self.set.is_some() && named.is_some() {
            let message = format!("`set` has no effect: [material.{}] is no calibrated one", self.material);
            faults.push(Complaint::new("set", message).hint("leave out `set`"));
        }
        let Some(material) = named else {
            if !context.sketches.contains_key(&self.material) {
                faults.extend(rows::check_material(Some(&self.material), context));
            }
            return faults;
        };
        let (values, unresolved) = material.resolve(&material::Values::new(), &|name| self.factor(context, name));
        faults.extend(unresolved.iter().map(|fault| {
            let complaint = Complaint::new(&fault.path, &fault.why).in_material(&self.material);
            if let Some(factor) = &fault.factor {
                complaint
                    .missing(Named::Factor, factor)
                    .hint("let the design of the stage vary it, or give the value itself")
            } else {
                complaint
            }
        }));
        let bonding = self.bonding(context.seed);
        // Without the specimen there is another fault, reported elsewhere.
        if unresolved.is_empty() && context.sketches.get(&self.specimen).is_some_and(|sketch| !sketch.groups.is_empty())
        {
            faults.extend(material.contacts(&values, self.need(context, &bonding)).err().unwrap_or_default());
        }
        faults
    }

    /// A value of a factor that the design varies, so that formulas of the material may name it.
    fn factor(&self, context: &Context, name: &str) -> Option<Measure> {
        let design = context.sketches.get(self.design.as_ref()?)?;
        let varied = design.factors.as_ref().is_none_or(|factors| factors.iter().any(|factor| factor == name));
        context.factors.get(name).filter(|_| varied)?.sample()
    }
}
