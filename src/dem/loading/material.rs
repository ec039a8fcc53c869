//! Microparameters of a specimen by contact, and the contact table that they make.
//!
//! A specimen has groups of particles. Contacts within a group and between two groups have values of their own: a linear
//! spring, and a bond where the contact is bonded. Platens are never bonded; the spring of a platen is that of the first group
//! with the friction of the platen (a platen of the material's own modulus). Inside a clump there are
//! no contacts.
//!
//! Linear spring and cement act in parallel. Without stiffness of its own the cement has the modulus and ratio of the spring, so
//! an intact contact is twice as stiff as one of them (E_c = Ē_c and k_n/k_s = k̄_n/k̄_s, Su et al. 2021, doi:10.3390/ma14071627).

use super::fissure::Fissures;
use crate::parameter::{Law, Parameter};
use crate::{Bond, BondStiffness, ContactBond, ContactTable, Convention, Dashpot, Distribution, Group, Interaction};
use crate::{Division, FlatJoint, Linear, NormalForce, ParallelBond, Scatter, Shares, ShearBreak, Space, Stiffness};
use math::text::Amount;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Contact group of platens.
pub const PLATEN: Group = Group(u8::MAX);

/// Kind of bond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BondKind {
    /// Cement with a moment.
    #[default]
    Parallel,
    /// Point bond.
    Contact,
    /// Interface of finite size that breaks element by element.
    FlatJoint,
    /// No bond: spring and friction only.
    None,
}

impl BondKind {
    /// The laws of a contact with this bond.
    pub const fn laws(self) -> &'static [Law] {
        match self {
            Self::Parallel => &[Law::Spring, Law::Parallel],
            Self::Contact => &[Law::Spring, Law::Contact],
            Self::FlatJoint => &[Law::Spring, Law::Flat],
            Self::None => &[Law::Spring],
        }
    }
}

/// Values of the contacts between two groups, or within one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Names of the two groups.
    pub between: [String; 2],
    /// Bond.
    pub bond: BondKind,
    /// Distribution of the strengths.
    #[serde(default, skip_serializing_if = "is_normal")]
    pub distribution: Distribution,
    /// Microparameters, SI; deviations over the mean.
    #[serde(flatten)]
    pub values: BTreeMap<Parameter, f64>,
}

fn is_normal(distribution: &Distribution) -> bool {
    *distribution == Distribution::Normal
}

/// All microparameters of a specimen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Names of the groups by their number.
    pub groups: Vec<String>,
    /// Contacts by name.
    pub contacts: BTreeMap<String, Contact>,
    /// Bonds form at gaps up to this share of the mean radius; 0: at contacts that overlap.
    #[serde(default)]
    pub gap: f64,
    /// How a modulus becomes a stiffness.
    #[serde(default)]
    pub convention: Convention,
    /// Fissures in the piece, set by set.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fissures: Vec<Fissures>,
}

/// What is wrong with a microparameter of a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialFault {
    /// The law needs it.
    #[error("contact `{contact}` lacks `{key}`, {meaning}", key = .parameter.key(), meaning = .parameter.declaration().meaning)]
    Missing {
        /// The contact's name.
        contact: String,
        /// The microparameter.
        parameter: Parameter,
    },
    /// No law of the contact has it.
    #[error("`{key}` has no effect on contact `{contact}`, which has {}", with_bond(*.bond), key = .parameter.key())]
    NoEffect {
        /// The contact's name.
        contact: String,
        /// The microparameter.
        parameter: Parameter,
        /// Its bond.
        bond: BondKind,
    },
    /// Another microparameter replaces it.
    #[error("`{}` of contact `{contact}` has no effect beside `{}`", .parameter.key(), .other.key())]
    Beside {
        /// The contact's name.
        contact: String,
        /// The microparameter.
        parameter: Parameter,
        /// The other one.
        other: Parameter,
    },
    /// Shares of more than everything.
    #[error("`fj_gapped` and `fj_slit` of contact `{contact}` come to {found}; together they must be at most 1")]
    Shares {
        /// The contact's name.
        contact: String,
        /// Their sum.
        found: f64,
    },
    /// Outside its range.
    #[error("`{}` of contact `{contact}` is {:#}; it must be {}", .parameter.key(), Amount(*.found, .parameter.declaration().quantity.unit()), .parameter.declaration().range.words())]
    Outside {
        /// The contact's name.
        contact: String,
        /// The microparameter.
        parameter: Parameter,
        /// The value.
        found: f64,
    },
}

impl MaterialFault {
    /// The contact's name and the microparameter.
    pub fn subject(&self) -> (&str, Parameter) {
        match self {
            Self::Missing { contact, parameter }
            | Self::NoEffect { contact, parameter, .. }
            | Self::Beside { contact, parameter, .. }
            | Self::Outside { contact, parameter, .. } => (contact, *parameter),
            Self::Shares { contact, .. } => (contact, Parameter::Slit),
        }
    }

    /// What to do.
    pub fn hint(&self) -> String {
        match self {
            Self::Missing { parameter, .. } => match parameter {
                Parameter::Modulus | Parameter::Ratio => "give `Ec` and `kn_ks`, or `kn` and `ks`".to_owned(),
                Parameter::Kn | Parameter::Ks => "`kn` and `ks` go together".to_owned(),
                Parameter::BondKn | Parameter::BondKs => {
                    "give `pb_kn` and `pb_ks`, or `pb_Ec` and `pb_kn_ks`".to_owned()
                }
                Parameter::TensileStrength | Parameter::ShearStrength => {
                    "give it, or say `bond = \"none\"` for a contact without bond".to_owned()
                }
                _ => format!("write for example {}", parameter.declaration().quantity.example()),
            },
            Self::NoEffect { parameter, .. } => {
                format!("leave out `{}`, or choose a bond that has it", parameter.key())
            }
            Self::Beside { parameter, other, .. } => format!("leave out `{}` or `{}`", parameter.key(), other.key()),
            Self::Shares { .. } => "what is neither gapped nor slit is bonded".to_owned(),
            Self::Outside { .. } => String::new(),
        }
    }
}

fn with_bond(bond: BondKind) -> &'static str {
    match bond {
        BondKind::Parallel => "a parallel bond",
        BondKind::Contact => "a contact bond",
        BondKind::FlatJoint => "a flat joint",
        BondKind::None => "no bond",
    }
}

impl Contact {
    /// Of one group, with a parallel bond: E_c (Pa), k_n/k_s, σ_c and τ_c (Pa), μ.
    pub fn bonded(group: &str, modulus: f64, ratio: f64, strengths: [f64; 2], friction: f64) -> Self {
        let values = [
            (Parameter::Modulus, modulus),
            (Parameter::Ratio, ratio),
            (Parameter::TensileStrength, strengths[0]),
            (Parameter::ShearStrength, strengths[1]),
            (Parameter::Friction, friction),
        ];
        let between = [group.to_owned(), group.to_owned()];
        Self { between, bond: BondKind::Parallel, distribution: Distribution::Normal, values: values.into() }
    }

    /// All that is wrong with its values; `name` is its name.
    pub fn faults(&self, name: &str) -> Vec<MaterialFault> {
        let contact = || name.to_owned();
        let bond = self.bond;
        let mut faults = Vec::new();
        for (&parameter, &found) in &self.values {
            let declaration = parameter.declaration();
            if !declaration.laws.iter().any(|law| bond.laws().contains(law)) {
                faults.push(MaterialFault::NoEffect { contact: contact(), parameter, bond });
            } else if !declaration.range.holds(found) {
                faults.push(MaterialFault::Outside { contact: contact(), parameter, found });
            }
        }
        let unbonded = self.get(Parameter::Gapped) + self.get(Parameter::Slit);
        if unbonded > 1.0 {
            faults.push(MaterialFault::Shares { contact: contact(), found: unbonded });
        }
        for (parameter, other) in self.beside() {
            faults.push(MaterialFault::Beside { contact: contact(), parameter, other });
        }
        faults.extend(
            self.missing().into_iter().map(|parameter| MaterialFault::Missing { contact: contact(), parameter }),
        );
        faults
    }

    fn has(&self, parameter: Parameter) -> bool {
        self.values.contains_key(&parameter)
    }

    /// Values that others replace.
    fn beside(&self) -> Vec<(Parameter, Parameter)> {
        use Parameter::{BondKn, BondKs, BondModulus, BondRatio, Kn, Ks, Modulus, Ratio};
        // `kn_ks` beside `kn` and `ks` still is the ratio of a cement that is given by its modulus.
        let cement = self.has(BondModulus) && !self.has(BondRatio);
        let pairs = [(Kn, Modulus), (Ks, Ratio), (BondKn, BondModulus), (BondKs, BondRatio)];
        let both = pairs.into_iter().filter(|&(direct, other)| self.has(direct) && self.has(other));
        both.filter(|&(direct, _)| !(direct == Ks && cement)).collect()
    }

    /// Values that the laws need and that are not given.
    fn missing(&self) -> Vec<Parameter> {
        use Parameter::{BondKn, BondKs, BondModulus, BondRatio, Kn, Ks, Modulus, Ratio};
        let direct = self.has(Kn) || self.has(Ks);
        // A flat joint has the modulus of the spring, whose stiffness depends on the radii.
        let direct = direct && self.bond != BondKind::FlatJoint;
        let mut needed = if direct { vec![Kn, Ks] } else { vec![Modulus, Ratio] };
        if self.has(Parameter::Gapped) {
            needed.push(Parameter::InitialGap);
        }
        needed.push(Parameter::Friction);
        if self.bond == BondKind::Parallel {
            let bond_direct = self.has(BondKn) || self.has(BondKs);
            if bond_direct || (direct && !self.has(BondModulus)) {
                needed.extend([BondKn, BondKs]);
            } else if direct && !self.has(Ratio) {
                needed.push(BondRatio);
            }
        }
        if self.bond != BondKind::None {
            needed.extend([Parameter::TensileStrength, Parameter::ShearStrength]);
        }
        needed.into_iter().filter(|&parameter| !self.has(parameter)).collect()
    }

    /// A value, or its default; NaN where it has none, which the engine refuses.
    fn get(&self, parameter: Parameter) -> f64 {
        self.values.get(&parameter).copied().unwrap_or(parameter.declaration().default)
    }

    fn stiffness(&self, convention: Convention) -> Stiffness {
        if self.has(Parameter::Kn) {
            return Stiffness::Direct { kn: self.get(Parameter::Kn), ks: self.get(Parameter::Ks) };
        }
        Stiffness::Modulus { modulus: self.get(Parameter::Modulus), ratio: self.get(Parameter::Ratio), convention }
    }

    fn linear(&self, convention: Convention, friction: f64) -> Linear {
        let stiffness = self.stiffness(convention);
        Linear { stiffness, normal_force: NormalForce::Absolute, friction, dashpot: Dashpot::default() }
    }

    fn cement(&self) -> BondStiffness {
        if self.has(Parameter::BondKn) {
            return BondStiffness::PerArea { kn: self.get(Parameter::BondKn), ks: self.get(Parameter::BondKs) };
        }
        let own = |bond, spring| if self.has(bond) { self.get(bond) } else { self.get(spring) };
        BondStiffness::Modulus {
            modulus: own(Parameter::BondModulus, Parameter::Modulus),
            ratio: own(Parameter::BondRatio, Parameter::Ratio),
        }
    }

    fn joint(&self, [tensile_strength, cohesion]: [f64; 2], scatter: Scatter) -> FlatJoint {
        let whole = |parameter| self.get(parameter) as u32;
        FlatJoint {
            radius_multiplier: self.get(Parameter::RadiusMultiplier),
            division: Division { rings: whole(Parameter::Rings), sectors: whole(Parameter::Elements) },
            stiffness: self.cement(),
            tensile_strength,
            cohesion,
            friction_angle: self.get(Parameter::FrictionAngle),
            shares: Shares {
                gapped: self.get(Parameter::Gapped),
                slit: self.get(Parameter::Slit),
                gap: self.get(Parameter::InitialGap),
            },
            scatter,
        }
    }

    /// Law and values as the engine takes them.
    pub fn interaction(&self, convention: Convention) -> Interaction {
        let scatter = Scatter {
            tensile: self.get(Parameter::TensileDeviation),
            shear: self.get(Parameter::ShearDeviation),
            distribution: self.distribution,
        };
        let [tensile_strength, shear] = [Parameter::TensileStrength, Parameter::ShearStrength].map(|p| self.get(p));
        let bond = match self.bond {
            BondKind::None => Bond::None,
            BondKind::Contact => Bond::Contact(ContactBond {
                tensile_strength,
                shear_strength: shear,
                scatter,
                shear_break: ShearBreak::Keep,
            }),
            BondKind::Parallel => Bond::Parallel(ParallelBond {
                radius_multiplier: self.get(Parameter::RadiusMultiplier),
                stiffness: self.cement(),
                tensile_strength,
                cohesion: shear,
                friction_angle: self.get(Parameter::FrictionAngle),
                moment_factor: self.get(Parameter::MomentFactor),
                scatter,
            }),
            BondKind::FlatJoint => Bond::Flat(self.joint([tensile_strength, shear], scatter)),
        };
        Interaction { linear: self.linear(convention, self.get(Parameter::Friction)), bond }
    }
}

impl Material {
    /// Of one group with the values of `contact`.
    pub fn of_one(contact: Contact) -> Self {
        let name = contact.between[0].clone();
        Self { groups: vec![name.clone()], contacts: [(name, contact)].into(), ..Self::default() }
    }

    /// All microparameters that are missing, without effect or outside their range.
    pub fn faults(&self) -> Vec<MaterialFault> {
        self.contacts.iter().flat_map(|(name, contact)| contact.faults(name)).collect()
    }

    /// Name and values of the contacts of two groups, by their numbers.
    pub fn contact(&self, a: usize, b: usize) -> Option<(&str, &Contact)> {
        let (a, b) = (self.groups.get(a)?, self.groups.get(b)?);
        let is = |between: &[String; 2]| (&between[0], &between[1]) == (a, b) || (&between[1], &between[0]) == (a, b);
        self.contacts.iter().find(|(_, contact)| is(&contact.between)).map(|(name, contact)| (name.as_str(), contact))
    }

    /// The contact table, platens with the given friction. A pair without values has no entry: the engine refuses a
    /// specimen in which it could touch.
    pub fn table(&self, platen_friction: f64) -> ContactTable {
        let mut table = ContactTable::new();
        let group = |number: usize| Group(number as u8);
        for a in 0..self.groups.len() {
            for b in a..self.groups.len() {
                if let Some((_, contact)) = self.contact(a, b) {
                    table.set(group(a), group(b), contact.interaction(self.convention));
                }
            }
        }
        if let Some((_, first)) = self.contact(0, 0) {
            let platen = Interaction::unbonded(first.linear(self.convention, platen_friction));
            (0..self.groups.len()).for_each(|number| table.set(PLATEN, group(number), platen));
        }
        table
    }

    /// Modulus of the linear springs of the first group (Pa): E_c, or the one that gives k_n between two particles of this
    /// radius.
    pub fn modulus<S: Space>(&self, radius: f64) -> f64 {
        match self.contact(0, 0).map(|(_, first)| first.stiffness(self.convention)) {
            Some(Stiffness::Modulus { modulus, .. }) => modulus,
            Some(Stiffness::Direct { kn, .. }) => kn * 2.0 * radius / S::section(radius),
            None => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests;
