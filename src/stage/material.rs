//! Materials: `[material.NAME]` as the workflow writes it, and the microparameters that it gives to the contacts of a specimen.
//!
//! * An entry is a group of particles, by any name: `rock = { Ec = "20 GPa", … }` holds the contacts within the group.
//! * An entry with `between = ["a", "b"]`, or named `a-b`, holds the contacts between two groups.
//! * Pairs that have no entry follow the rule `pairs`: `"weaker"` takes the smaller of the two values, microparameter by
//!   microparameter, and no bond when one of the two has none; `"mean"` takes their mean.
//! * `bond` of an entry is its bond where it differs from that of the stage; `"none"` for contacts that are never bonded.
//!
//! A value is a quantity, or a formula. A name in a formula is a microparameter of the same entry, else a factor, else
//! a microparameter of another entry (`rock_Ec`: `_` in place of `.` and `-`); units are checked. Values that no contact of
//! a specimen can have are not required and are not part of a task.

mod assemble;
mod given;
mod read;

pub use assemble::{Bonding, Need, measures};
pub use dem::loading::material::BondKind;
pub use dem::parameter::{Parameter as Microparameter, Quantity};
pub use given::{GivenMaterial, given};
pub use read::MaterialTable;

use super::Parameter;
use crate::expression::{Expression, Measure};
use dem::Distribution;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Microparameters by contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Material {
    /// Rule for pairs that have no entry.
    pub pairs: Option<PairRule>,
    /// Entries by name.
    pub entries: BTreeMap<String, Entry>,
}

/// The values of pairs that have no entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PairRule {
    /// The smaller value of each microparameter.
    Weaker,
    /// The mean of each microparameter.
    Mean,
}

/// One entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entry {
    /// The two groups between which its contacts lie; `None` when the name of the entry says it.
    pub between: Option<[String; 2]>,
    /// Its bond; by default that of the stage.
    pub bond: Option<BondKind>,
    /// Distribution of its strengths.
    pub distribution: Option<Distribution>,
    /// Microparameters by key.
    pub values: BTreeMap<String, Value>,
}

/// A value of a material.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A quantity.
    Given(Parameter),
    /// A formula of other values.
    Formula(Expression),
}

/// Values by path (`rock.Ec`).
pub type Values = BTreeMap<String, Parameter>;

/// The fault of a value that cannot be computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// Path of the value, such as `rock.tau_c`.
    pub path: String,
    /// The factor that its formula needs and that is not set.
    pub factor: Option<String>,
    /// Why.
    pub why: String,
}

impl Material {
    /// Paths of all values, ascending.
    pub fn paths(&self) -> impl Iterator<Item = String> + '_ {
        self.entries.iter().flat_map(|(entry, all)| all.values.keys().map(move |key| format!("{entry}.{key}")))
    }

    /// The value of a path.
    pub fn get(&self, path: &str) -> Option<&Value> {
        let (entry, key) = path.split_once('.')?;
        self.entries.get(entry)?.values.get(key)
    }

    /// Whether a factor may set this path: the entry exists, and has the value or can have it.
    pub fn takes(&self, path: &str) -> bool {
        let known = |(entry, key): (&str, &str)| {
            let entry = self.entries.get(entry)?;
            Some(entry.values.contains_key(key) || dem::parameter::Parameter::from_key(key).is_some())
        };
        path.split_once('.').and_then(known).unwrap_or(false)
    }

    /// The groups of an entry: one, or the two of a pair.
    pub fn groups_of<'m>(&'m self, name: &'m str) -> Vec<&'m str> {
        if let Some(between) = self.entries.get(name).and_then(|entry| entry.between.as_ref()) {
            return between.iter().map(String::as_str).collect();
        }
        let splits = name.match_indices('-').map(|(at, _)| (&name[..at], &name[at + 1..]));
        let group = |name: &str| self.entries.get(name).is_some_and(|entry| entry.between.is_none());
        match splits.into_iter().find(|(a, b)| group(a) && group(b)) {
            Some((a, b)) => vec![a, b],
            None => vec![name],
        }
    }

    /// The values that do not depend on factors.
    pub fn resolve_alone(&self) -> Values {
        self.resolve(&Values::new(), &|_| None).0
    }

    /// All values, where those of `set` replace its own; `factor` gives the factors that formulas may name.
    pub fn resolve(&self, set: &Values, factor: &dyn Fn(&str) -> Option<Measure>) -> (Values, Vec<Unresolved>) {
        let mut resolver = Resolver { material: self, set, factor, values: Values::new(), open: Vec::new() };
        let paths: Vec<String> = self.paths().chain(set.keys().cloned()).collect();
        let mut faults: Vec<Unresolved> = paths.iter().filter_map(|path| resolver.value(path).err()).collect();
        faults.dedup();
        (resolver.values, faults)
    }
}

/// Computes values one after the other.
struct Resolver<'a> {
    material: &'a Material,
    set: &'a Values,
    factor: &'a dyn Fn(&str) -> Option<Measure>,
    values: Values,
    /// Paths whose formulas are being computed.
    open: Vec<String>,
}

impl Resolver<'_> {
    fn value(&mut self, path: &str) -> Result<Parameter, Unresolved> {
        if let Some(known) = self.values.get(path) {
            return Ok(*known);
        }
        let fault = |why: String| Unresolved { path: path.to_owned(), factor: None, why };
        let value = match (self.set.get(path), self.material.get(path)) {
            (Some(given), _) | (None, Some(Value::Given(given))) => *given,
            (None, Some(Value::Formula(formula))) => {
                if self.open.iter().any(|open| open == path) {
                    let circle = self.open.iter().map(String::as_str).chain([path]).collect::<Vec<_>>().join(" → ");
                    return Err(fault(format!("the formulas need one another in a circle: {circle}")));
                }
                self.open.push(path.to_owned());
                let value = self.formula(path, &formula.clone());
                self.open.pop();
                value?
            }
            (None, None) => return Err(fault(format!("`{path}` is not there"))),
        };
        self.values.insert(path.to_owned(), value);
        Ok(value)
    }

    fn formula(&mut self, path: &str, formula: &Expression) -> Result<Parameter, Unresolved> {
        let fault = |why: String| Unresolved { path: path.to_owned(), factor: None, why };
        let names = formula.names().iter().map(|name| self.name(path, name)).collect::<Result<Vec<_>, _>>()?;
        let found = formula.eval(&names).map_err(&fault)?;
        match found.dimension {
            Ok(dimension) => Ok(Parameter { value: found.value, dimension }),
            Err(misfit) => Err(fault(format!("`{}`: {misfit}", formula.text()))),
        }
    }

    /// The value of a name in the formula of `path`.
    fn name(&mut self, path: &str, name: &str) -> Result<Measure, Unresolved> {
        let (entry, _) = path.split_once('.').unwrap_or((path, ""));
        let own = format!("{entry}.{name}");
        let there = |path: &String| self.set.contains_key(path) || self.material.get(path).is_some();
        let other = || self.material.paths().find(|path| path.replace(['.', '-'], "_") == name);
        let place = if there(&own) && own != path { Some(own) } else { None };
        if let Some(place) = place {
            return self.value(&place).map(|p| Measure::of(p.value, p.dimension));
        }
        if let Some(factor) = (self.factor)(name) {
            return Ok(factor);
        }
        match other() {
            Some(place) => self.value(&place).map(|p| Measure::of(p.value, p.dimension)),
            None => Err(Unresolved {
                path: path.to_owned(),
                factor: Some(name.to_owned()),
                why: format!("the formula of `{path}` needs `{name}`, which is not set"),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
