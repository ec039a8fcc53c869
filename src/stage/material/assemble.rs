//! Assembles the microparameters of the contacts of a specimen from values by path.

use super::{Material, PairRule, Values};
use crate::stage::Complaint;
use crate::unit::{Dimension, Unit};
use dem::Convention;
use dem::loading::fissure::Fissures;
use dem::loading::material::{BondKind, Contact, Material as Made, MaterialFault};
use dem::parameter::{Parameter, Quantity};
use serde::Serialize;
use std::collections::BTreeMap;

/// Settings of a stage for all bonds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bonding {
    /// Bond of the entries without a bond of their own.
    pub kind: BondKind,
    /// Bonds form at gaps up to this fraction of the mean radius.
    pub gap: f64,
    /// Definition of the stiffness by a modulus.
    pub convention: Convention,
    /// Fissures in the specimen, set by set.
    pub fissures: Vec<Fissures>,
    /// Values of the entries that have none of their own.
    pub values: BTreeMap<Parameter, f64>,
}

/// What determines the contacts of a specimen besides the values.
#[derive(Clone, Copy, Debug)]
pub struct Need<'a> {
    /// Name of the `[material.NAME]`; `None` for one that a stage gives.
    pub name: Option<&'a str>,
    /// Names of the specimen's groups by their number.
    pub groups: &'a [String],
    /// Settings of the stage for all bonds.
    pub bonding: &'a Bonding,
}

/// The source of the values of the contacts of two groups.
enum Source<'m> {
    /// An entry of the material.
    Entry(&'m str),
    /// A rule, applied to the entries of the two groups.
    Rule(PairRule),
}

impl Material {
    /// The microparameters of every contact that particles of these groups can have, from values by path.
    ///
    /// # Errors
    /// All values that are missing, without effect, of another kind or outside their range.
    pub fn contacts(&self, values: &Values, need: Need<'_>) -> Result<Made, Vec<Complaint>> {
        let made = self.made(values, need).map_err(|faults| {
            let place = |fault: Complaint| match need.name {
                Some(name) => fault.in_material(name),
                None => Complaint { path: vec!["material".to_owned()], ..fault },
            };
            faults.into_iter().map(place).collect::<Vec<_>>()
        })?;
        let idle = unused(&made, need.bonding);
        if idle.is_empty() { Ok(made) } else { Err(idle) }
    }

    fn made(&self, values: &Values, need: Need<'_>) -> Result<Made, Vec<Complaint>> {
        let names = self.group_names(need.groups)?;
        let mut made = Made {
            groups: names,
            gap: need.bonding.gap,
            convention: need.bonding.convention,
            fissures: need.bonding.fissures.clone(),
            ..Made::default()
        };
        let mut faults = Vec::new();
        let groups = made.groups.clone();
        let pairs = || (0..groups.len()).flat_map(|a| (a..groups.len()).map(move |b| (a, b)));
        let mut derived = Vec::new();
        for (a, b) in pairs() {
            let between = [groups[a].clone(), groups[b].clone()];
            match self.source(&between) {
                Err(fault) => faults.push(fault),
                Ok(Source::Rule(rule)) => derived.push((between, rule)),
                Ok(Source::Entry(name)) => {
                    let (contact, bad) = self.entry_contact(name, between, values, need.bonding);
                    made.contacts.insert(name.to_owned(), contact);
                    faults.extend(bad);
                }
            }
        }
        for (name, contact) in &made.contacts {
            faults.extend(contact.faults(name).iter().map(in_material));
        }
        if faults.is_empty() {
            for (between, rule) in derived {
                match combined(&made, &between, rule) {
                    Ok(contact) => drop(made.contacts.insert(between.join("-"), contact)),
                    Err(fault) => faults.push(fault),
                }
            }
        }
        if faults.is_empty() { Ok(made) } else { Err(faults) }
    }

    /// Names of the groups: those of the specimen; if it has one group and the material one, that of the material.
    fn group_names(&self, asked: &[String]) -> Result<Vec<String>, Vec<Complaint>> {
        let own: Vec<&String> = self.entries.keys().filter(|name| self.groups_of(name).len() == 1).collect();
        if let ([_], [own]) = (asked, &own[..]) {
            return Ok(vec![(*own).clone()]);
        }
        let lacking = asked.iter().filter(|name| !own.contains(name));
        let known = own.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let fault = |name: &String| {
            let hint = format!(
                "add `{name} = {{ Ec = \"20 GPa\", kn_ks = 2.5, mu = 0.5, … }}`, or name the specimen's groups as the material does: {known}"
            );
            Complaint::new(
                "",
                format!("the specimen has particles of group `{name}`, and the material has no such group"),
            )
            .hint(hint)
        };
        let faults: Vec<Complaint> = lacking.map(fault).collect();
        if faults.is_empty() { Ok(asked.to_vec()) } else { Err(faults) }
    }

    fn source(&self, between: &[String; 2]) -> Result<Source<'_>, Complaint> {
        if between[0] == between[1] {
            let entry = self.entries.get_key_value(&between[0]).map(|(name, _)| Source::Entry(name));
            return entry.ok_or_else(|| Complaint::new("", format!("the material has no group `{}`", between[0])));
        }
        let is = |name: &str| {
            let groups = self.groups_of(name);
            groups == [&between[0], &between[1]] || groups == [&between[1], &between[0]]
        };
        let [a, b] = between;
        let mut found = self.entries.keys().filter(|name| is(name));
        match (found.next(), found.next(), self.pairs) {
            (Some(first), Some(second), _) => Err(Complaint::new(
                second,
                format!("`{first}` and `{second}` both hold the contacts of `{a}` and `{b}`"),
            )),
            (Some(name), None, _) => Ok(Source::Entry(name)),
            (None, _, Some(rule)) => Ok(Source::Rule(rule)),
            (None, _, None) => {
                let hint = format!(
                    "add an entry `{a}-{b}`, or one with `between = [\"{a}\", \"{b}\"]`, or say `pairs = \"weaker\"`"
                );
                Err(Complaint::new("", format!("contacts of `{a}` and `{b}` have no values")).hint(hint))
            }
        }
    }

    /// The contact of an entry, and the faults of its keys and units; the contact itself reports values that are missing or
    /// outside their range.
    fn entry_contact(
        &self,
        name: &str,
        between: [String; 2],
        values: &Values,
        bonding: &Bonding,
    ) -> (Contact, Vec<Complaint>) {
        let entry = self.entries.get(name).cloned().unwrap_or_default();
        let bond = entry.bond.unwrap_or(bonding.kind);
        let mut contact =
            Contact { between, bond, distribution: entry.distribution.unwrap_or_default(), values: BTreeMap::new() };
        let mut faults = Vec::new();
        let prefix = format!("{name}.");
        let own: Vec<(&str, crate::stage::Parameter)> =
            values.iter().filter_map(|(path, value)| Some((path.strip_prefix(&prefix)?, *value))).collect();
        for &(key, value) in &own {
            match microparameter(name, key, value, &own) {
                Ok((parameter, value)) => drop(contact.values.insert(parameter, value)),
                Err(fault) => {
                    // The value exists, although it is wrong: do not report it as missing.
                    contact.values.extend(Parameter::from_key(key).map(|parameter| (parameter, 1.0)));
                    faults.push(fault);
                }
            }
        }
        if entry.distribution.is_some() && bond == BondKind::None {
            let message = format!("`distribution` has no effect on contact `{name}`, which has no bond");
            faults.push(Complaint::new(&format!("{name}.distribution"), message));
        }
        for (&parameter, &value) in &bonding.values {
            if parameter.declaration().laws.iter().all(|law| bond.laws().contains(law)) {
                contact.values.entry(parameter).or_insert(value);
            }
        }
        contact.values.retain(|parameter, value| *value != parameter.declaration().default);
        (contact, faults)
    }
}

/// The microparameter of a key and its value; deviations are divided by the mean.
fn microparameter(
    entry: &str,
    key: &str,
    found: crate::stage::Parameter,
    all: &[(&str, crate::stage::Parameter)],
) -> Result<(Parameter, f64), Complaint> {
    let path = format!("{entry}.{key}");
    let Some(parameter) = Parameter::from_key(key) else {
        let known = Parameter::ALL.iter().map(|p| p.key()).collect::<Vec<_>>().join(", ");
        return Err(Complaint::new(&path, format!("`{key}` is not a microparameter")).hint(format!("known: {known}")));
    };
    let quantity = parameter.declaration().quantity;
    let wanted = dimension(quantity);
    if quantity == Quantity::Deviation && found.dimension == Dimension::NONE {
        return Ok((parameter, found.value));
    }
    if found.dimension != wanted {
        let message = match (wanted == Dimension::NONE, found.dimension == Dimension::NONE) {
            (true, _) => format!("`{path}` is a pure number and has no unit"),
            (_, true) => format!("`{path}` needs a unit, found the number {}", found.value),
            (false, false) => format!("`{path}` is measured in {}, not in {}", quantity.unit(), found.dimension),
        };
        return Err(Complaint::new(&path, message).hint(format!("write for example {}", quantity.example())));
    }
    if quantity != Quantity::Deviation {
        return Ok((parameter, found.value));
    }
    let mean =
        if parameter == Parameter::TensileDeviation { Parameter::TensileStrength } else { Parameter::ShearStrength };
    let mean = all.iter().find(|(key, _)| *key == mean.key()).map(|(_, mean)| mean.value);
    // Without a mean the contact lacks its strength, and reports that.
    Ok((parameter, mean.map_or(0.0, |mean| found.value / mean)))
}

/// Whether a microparameter may have units of this dimension.
pub fn measures(parameter: Parameter, given: Dimension) -> bool {
    let quantity = parameter.declaration().quantity;
    given == dimension(quantity) || (quantity == Quantity::Deviation && given == Dimension::NONE)
}

/// The dimension of a kind of microparameter.
fn dimension(quantity: Quantity) -> Dimension {
    Unit::parse(quantity.unit()).map_or(Dimension::NONE, |unit| unit.dimension)
}

fn in_material(fault: &MaterialFault) -> Complaint {
    let (contact, parameter) = fault.subject();
    let complaint = Complaint::new(&format!("{contact}.{}", parameter.key()), fault.to_string());
    let hint = fault.hint();
    if hint.is_empty() { complaint } else { complaint.hint(hint) }
}

/// The contact between two groups by a rule.
fn combined(made: &Made, between: &[String; 2], rule: PairRule) -> Result<Contact, Complaint> {
    let [a, b] = between.each_ref().map(|name| &made.contacts[name]);
    let name = between.join("-");
    let differ = |what: &str| {
        let hint = format!("add an entry `{name}` with the values of these contacts");
        let message = format!(
            "`{}` and `{}` differ in {what}, so no rule gives the values of their contacts",
            between[0], between[1]
        );
        Complaint::new("pairs", message).hint(hint)
    };
    let bond = match (a.bond, b.bond, rule) {
        (a, b, _) if a == b => a,
        (BondKind::None, _, PairRule::Weaker) | (_, BondKind::None, PairRule::Weaker) => BondKind::None,
        _ => return Err(differ("their bond")),
    };
    if bond != BondKind::None && a.distribution != b.distribution {
        return Err(differ("the distribution of their strengths"));
    }
    let mut contact = Contact { between: between.clone(), bond, distribution: a.distribution, values: BTreeMap::new() };
    let acts = |parameter: &Parameter| parameter.declaration().laws.iter().any(|law| bond.laws().contains(law));
    let keys: std::collections::BTreeSet<Parameter> =
        a.values.keys().chain(b.values.keys()).copied().filter(acts).collect();
    for parameter in keys {
        let of = |contact: &Contact| {
            let default = parameter.declaration().default;
            contact.values.get(&parameter).copied().or_else(|| (!default.is_nan()).then_some(default))
        };
        let (Some(x), Some(y)) = (of(a), of(b)) else { return Err(differ(&format!("`{}`", parameter.key()))) };
        let value = match rule {
            PairRule::Weaker => x.min(y),
            PairRule::Mean => 0.5 * (x + y),
        };
        contact.values.insert(parameter, value);
    }
    contact.values.retain(|parameter, value| *value != parameter.declaration().default);
    Ok(contact)
}

/// Bond settings of the stage that no contact uses.
fn unused(made: &Made, bonding: &Bonding) -> Vec<Complaint> {
    let acts = |parameter: &Parameter| {
        let laws = parameter.declaration().laws;
        made.contacts.values().any(|contact| laws.iter().any(|law| contact.bond.laws().contains(law)))
    };
    let idle = bonding.values.keys().filter(|parameter| !made.contacts.is_empty() && !acts(parameter));
    let fault = |parameter: &Parameter| {
        let key = parameter.key();
        Complaint::new(&format!("bond.{key}"), format!("`{key}` has no effect: no contact has a bond with it"))
            .hint(format!("leave out `{key}`"))
    };
    idle.map(fault).collect()
}
