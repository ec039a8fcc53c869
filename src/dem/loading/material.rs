//! Microparameters of a plane specimen of mortar and aggregate, and the contact table they make.
//!
//! | contact | law | values |
//! |---|---|---|
//! | mortar–mortar | linear + bond | `mortar` |
//! | mortar–aggregate | linear + bond | `interface` |
//! | aggregate–aggregate | linear, never bonded | `aggregate` |
//! | inside a clump | none | |
//! | platen–any | linear, never bonded | modulus and ratio of `mortar`, friction of the platen |
//!
//! Linear spring and cement act in parallel and **each** has the modulus E_c and the ratio k_n/k_s of its contact, so an
//! intact contact is twice as stiff as one of them (E_c = Ē_c and k_n/k_s = k̄_n/k̄_s in the paper).
//!
//! Symbols: E_c modulus (Pa), κ = k_n/k_s, σ_c tensile strength (Pa), τ_c shear strength (Pa), μ friction, λ bond radius
//! multiplier, β moment factor, φ friction angle of the bond.
//!
//! Source: Su et al. 2021, doi:10.3390/ma14071627, sections 2.1 and 3.2, Tables 3 and 4.

use crate::{Bond, BondStiffness, ContactBond, ContactTable, Convention, Dashpot, Group, Interaction, Linear};
use crate::{NormalForce, ParallelBond, ShearBreak, Stiffness};
use serde::{Deserialize, Serialize};

/// Contact group of mortar balls.
pub const MORTAR: Group = Group(0);
/// Contact group of the pebbles of aggregate.
pub const AGGREGATE: Group = Group(1);
/// Contact group of platens.
pub const PLATEN: Group = Group(2);

/// Microparameters of a contact that can be bonded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bonded {
    /// E_c of spring and cement each (Pa).
    pub modulus: f64,
    /// k_n/k_s of spring and cement.
    pub stiffness_ratio: f64,
    /// σ_c (Pa).
    pub tensile_strength: f64,
    /// τ_c (Pa).
    pub shear_strength: f64,
    /// μ of the spring.
    pub friction: f64,
}

/// Microparameters of a contact that is never bonded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unbonded {
    /// E_c (Pa).
    pub modulus: f64,
    /// k_n/k_s.
    pub stiffness_ratio: f64,
    /// μ.
    pub friction: f64,
}

/// Kind of bond.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BondKind {
    /// Cement with a moment.
    Parallel,
    /// Point bond.
    Contact,
}

/// How bonds are formed and act, the same for all bonded contacts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bonding {
    /// Kind.
    pub kind: BondKind,
    /// Bonds form at gaps up to this share of the mean radius; 0: at contacts that overlap.
    pub gap: f64,
    /// λ.
    pub radius_multiplier: f64,
    /// β.
    pub moment_factor: f64,
    /// φ (rad).
    pub friction_angle: f64,
    /// Standard deviation of the strengths over their mean.
    pub deviation: f64,
    /// How a modulus becomes a stiffness.
    pub convention: Convention,
}

/// All microparameters of a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Between mortar balls.
    pub mortar: Bonded,
    /// Between clumps.
    pub aggregate: Unbonded,
    /// Between mortar and clumps.
    pub interface: Bonded,
    /// Bonds.
    pub bonding: Bonding,
}

/// A microparameter outside the law's domain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{group} {name} is {found}; it must be {expected}")]
pub struct MaterialError {
    /// Contact group.
    pub group: &'static str,
    /// Microparameter.
    pub name: &'static str,
    /// What was given.
    pub found: f64,
    /// What it must be.
    pub expected: &'static str,
}

impl Default for Bonding {
    /// Bonds at overlapping contacts, λ = 1, β = 1, φ = 0, no scatter, present stiffness convention.
    fn default() -> Self {
        Self {
            kind: BondKind::Parallel,
            gap: 0.0,
            radius_multiplier: 1.0,
            moment_factor: 1.0,
            friction_angle: 0.0,
            deviation: 0.0,
            convention: Convention::Present,
        }
    }
}

impl Material {
    /// All microparameters that are outside the domain of their law.
    pub fn faults(&self) -> Vec<MaterialError> {
        let mut faults = Vec::new();
        for (group, bonded) in [("mortar", &self.mortar), ("interface", &self.interface)] {
            faults.extend(spring_faults(group, bonded.modulus, bonded.stiffness_ratio, bonded.friction));
            for (name, found) in [("sigma_c", bonded.tensile_strength), ("tau_c", bonded.shear_strength)] {
                if !(found > 0.0 && found.is_finite()) {
                    faults.push(MaterialError { group, name, found, expected: "a positive stress" });
                }
            }
        }
        let Unbonded { modulus, stiffness_ratio, friction } = self.aggregate;
        faults.extend(spring_faults("aggregate", modulus, stiffness_ratio, friction));
        let bonding = &self.bonding;
        let rules = [
            ("gap", bonding.gap, (0.0..=1.0).contains(&bonding.gap), "a share of the mean radius, 0 to 1"),
            ("radius_multiplier", bonding.radius_multiplier, bonding.radius_multiplier > 0.0, "positive"),
            ("moment_factor", bonding.moment_factor, (0.0..=1.0).contains(&bonding.moment_factor), "0 to 1"),
            ("friction_angle", bonding.friction_angle, (0.0..1.5).contains(&bonding.friction_angle), "0 to 1.5 rad"),
            ("deviation", bonding.deviation, (0.0..1.0).contains(&bonding.deviation), "at least 0 and below 1"),
        ];
        let bad = rules.into_iter().filter(|rule| !rule.2);
        faults.extend(bad.map(|(name, found, _, expected)| MaterialError { group: "bond", name, found, expected }));
        faults
    }

    /// The contact table, platens with the given friction.
    pub fn table(&self, platen_friction: f64) -> ContactTable {
        let platen = self.linear(self.mortar.modulus, self.mortar.stiffness_ratio, platen_friction);
        let Unbonded { modulus, stiffness_ratio, friction } = self.aggregate;
        ContactTable::new()
            .with(MORTAR, MORTAR, self.bonded(&self.mortar))
            .with(MORTAR, AGGREGATE, self.bonded(&self.interface))
            .with(AGGREGATE, AGGREGATE, Interaction::unbonded(self.linear(modulus, stiffness_ratio, friction)))
            .with(PLATEN, MORTAR, Interaction::unbonded(platen))
            .with(PLATEN, AGGREGATE, Interaction::unbonded(platen))
    }

    fn linear(&self, modulus: f64, ratio: f64, friction: f64) -> Linear {
        let stiffness = Stiffness::Modulus { modulus, ratio, convention: self.bonding.convention };
        Linear { stiffness, normal_force: NormalForce::Absolute, friction, dashpot: Dashpot::default() }
    }

    fn bonded(&self, values: &Bonded) -> Interaction {
        let bonding = &self.bonding;
        let bond = match bonding.kind {
            BondKind::Parallel => Bond::Parallel(ParallelBond {
                radius_multiplier: bonding.radius_multiplier,
                stiffness: BondStiffness::Modulus { modulus: values.modulus, ratio: values.stiffness_ratio },
                tensile_strength: values.tensile_strength,
                cohesion: values.shear_strength,
                friction_angle: bonding.friction_angle,
                moment_factor: bonding.moment_factor,
                deviation: bonding.deviation,
            }),
            BondKind::Contact => Bond::Contact(ContactBond {
                tensile_strength: values.tensile_strength,
                shear_strength: values.shear_strength,
                deviation: bonding.deviation,
                shear_break: ShearBreak::Keep,
            }),
        };
        Interaction { linear: self.linear(values.modulus, values.stiffness_ratio, values.friction), bond }
    }
}

fn spring_faults(group: &'static str, modulus: f64, ratio: f64, friction: f64) -> Vec<MaterialError> {
    let rules = [
        ("Ec", modulus, modulus > 0.0 && modulus.is_finite(), "a positive modulus"),
        ("kn_ks", ratio, ratio > 0.0 && ratio.is_finite(), "positive"),
        ("mu", friction, friction >= 0.0 && friction.is_finite(), "at least 0"),
    ];
    let bad = rules.into_iter().filter(|rule| !rule.2);
    bad.map(|(name, found, _, expected)| MaterialError { group, name, found, expected }).collect()
}
