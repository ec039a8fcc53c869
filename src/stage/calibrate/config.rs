//! The settings of a calibration, and what can be wrong with them before anything runs.

use super::params::{FactorParam, ORDINATE, Params, TargetParam};
use crate::stage::{Complaint, Context, StageError};
use crate::unit::{Unit, split_any};
use optim::Error;
use optim::misfit::{Denominator, Form};
use optim::search::{Limits, Method};
use optim::{annealing, cma_es, differential, genetic, surrogate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of a `calibrate` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Calibrate {
    /// The stage with the fitted surfaces.
    pub surfaces: Option<String>,
    /// The stage whose simulation is run: its specimen, material and test.
    pub simulator: Option<String>,
    /// Stages whose runs the surrogate learns from.
    #[serde(default)]
    pub learn_from: Vec<String>,
    /// The material whose values stand for factors that a table of `learn_from` does not vary.
    pub material: Option<String>,
    /// The parameters to find, between the ends of their ranges.
    pub factors: Vec<String>,
    /// Other ranges than those of the factors, in their units.
    #[serde(default)]
    pub ranges: BTreeMap<String, [f64; 2]>,
    /// Linear constraints on the factors.
    #[serde(default)]
    pub constraints: Vec<Constraint>,
    /// Target sets: the wanted value of each response, such as `{ UCS = "30 MPa", nu = 0.2 }`.
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, Wanted>>,
    /// A stress–strain curve that every set must follow as well; needs a simulator.
    pub curve: Option<Curve>,
    /// Weight of the deviation of a response, 1 when not given.
    #[serde(default)]
    pub weights: BTreeMap<String, f64>,
    /// How deviations are combined.
    #[serde(default)]
    pub misfit: Form,
    /// What deviations are relative to.
    #[serde(default)]
    pub denominator: Denominator,
    /// The optimiser: `genetic` on surfaces and `surrogate` with a simulator when not given.
    pub method: Option<MethodName>,
    /// Settings of the genetic algorithm.
    pub genetic: Option<genetic::Settings>,
    /// Settings of the annealing.
    pub annealing: Option<annealing::Settings>,
    /// Settings of the differential evolution.
    pub differential: Option<differential::Settings>,
    /// Settings of the covariance matrix adaptation.
    pub cma_es: Option<cma_es::Settings>,
    /// Settings of the surrogate.
    pub surrogate: Option<surrogate::Settings>,
    /// Most evaluations of a set.
    pub evaluations: Option<usize>,
    /// Misfit that is good enough.
    pub stop_at: Option<f64>,
    /// Refine the best point at the end; on surfaces only.
    #[serde(default)]
    pub polish: bool,
    /// Point that the solution shall be nearest to, in the factors' units; the centre for factors that are not named.
    #[serde(default)]
    pub preference: BTreeMap<String, f64>,
    /// Size of the sample of the solution set.
    #[serde(default = "solutions")]
    pub solutions: usize,
    /// Specimens to cycle through; a fresh one for every simulation of a set when not given.
    pub specimens: Option<u64>,
}

fn solutions() -> usize {
    50
}

/// Σ terms ≤ `at_most`, in the factors' units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Coefficient of each factor.
    pub terms: BTreeMap<String, f64>,
    /// Upper bound.
    pub at_most: f64,
}

/// A curve to follow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Axial strains, shortening positive.
    pub strain: Vec<f64>,
    /// Axial stress at each, compression positive, such as `"12.5 MPa"`.
    pub stress: Vec<Wanted>,
}

/// A number, or a text with a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Wanted {
    /// A pure number.
    Number(f64),
    /// A number with a unit.
    Text(String),
}

/// The optimisers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// MATLAB's genetic algorithm.
    Genetic,
    /// Improved simulated annealing.
    Annealing,
    /// Adaptive differential evolution.
    Differential,
    /// Covariance matrix adaptation.
    CmaEs,
    /// One model per response over all runs.
    Surrogate,
}

impl Wanted {
    /// The value in `unit`.
    ///
    /// # Errors
    /// It is of another dimension or cannot be read.
    pub fn value_in(&self, unit: &str) -> Result<f64, String> {
        let (value, own) = match self {
            Self::Number(value) => (*value, ""),
            Self::Text(text) => split_any(text).map_err(|e| e.to_string())?,
        };
        let wanted = Unit::parse(unit).map_err(|e| e.to_string())?;
        let Ok(conversion) = Unit::parse(own).map_err(|e| e.to_string())?.to(wanted) else {
            let found = match self {
                Self::Number(value) => value.to_string(),
                Self::Text(text) => format!("\"{text}\""),
            };
            return Err(format!("{found} is not a value in `{unit}`; write for example \"30 {unit}\""));
        };
        Ok(conversion.of(value))
    }
}

impl Calibrate {
    /// The optimiser that is used.
    pub(super) fn method_name(&self) -> MethodName {
        let usual = if self.simulator.is_some() { MethodName::Surrogate } else { MethodName::Genetic };
        self.method.unwrap_or(usual)
    }

    fn method(&self) -> Method {
        match self.method_name() {
            MethodName::Genetic => Method::Genetic(self.genetic.clone().unwrap_or_default()),
            MethodName::Annealing => Method::Annealing(self.annealing.clone().unwrap_or_default()),
            MethodName::Differential => Method::Differential(self.differential.clone().unwrap_or_default()),
            MethodName::CmaEs => Method::CmaEs(self.cma_es.clone().unwrap_or_default()),
            MethodName::Surrogate => Method::Surrogate(self.surrogate.clone().unwrap_or_default()),
        }
    }

    /// The wanted misfit: as set, or as the method's preset has it.
    fn stop_at(&self) -> Option<f64> {
        let published = match self.method() {
            Method::Annealing(settings) => settings.published_misfit(),
            Method::Genetic(_) | Method::Differential(_) | Method::CmaEs(_) | Method::Surrogate(_) => None,
        };
        self.stop_at.or(published)
    }

    /// All that decides the result, in the units of factors and responses.
    pub(super) fn params(&self, context: &Context) -> Result<Params, StageError> {
        let factor = |name: &String| {
            let factor = context.factors.get(name).ok_or_else(|| StageError::new(format!("no [factor.{name}]")))?;
            let [low, high] = self.range(context, name).ok_or_else(|| no_range(name))?;
            let fallback = self.held(context, name);
            Ok(FactorParam { name: name.clone(), unit: factor.unit.clone(), low, high, fallback })
        };
        let factors = self.factors.iter().map(factor).collect::<Result<_, StageError>>()?;
        let none = [BTreeMap::new()];
        let listed = if self.targets.is_empty() { &none } else { self.targets.as_slice() };
        let sets = listed.iter().map(|set| self.set(context, set)).collect::<Result<_, _>>();
        Ok(Params {
            factors,
            sets: sets.map_err(StageError::new)?,
            form: self.misfit,
            denominator: self.denominator,
            constraints: self.constraints.clone(),
            method: self.method(),
            limits: Limits { evaluations: self.evaluations, misfit: self.stop_at(), polish: self.polish },
            preference: self.preference.clone(),
            solutions: self.solutions,
            history: Vec::new(),
        })
    }

    /// The targets of one set.
    fn set(&self, context: &Context, listed: &BTreeMap<String, Wanted>) -> Result<Vec<TargetParam>, String> {
        let mut targets = Vec::new();
        for (response, wanted) in listed {
            let unit = context.responses.get(response).map_or("", |r| r.unit.as_str());
            targets.push(TargetParam {
                response: response.clone(),
                unit: unit.to_owned(),
                value: wanted.value_in(unit).map_err(|e| format!("target of `{response}`: {e}"))?,
                weight: self.weights.get(response).copied().unwrap_or(1.0),
                strain: None,
            });
        }
        if let Some(curve) = &self.curve {
            for (strain, stress) in curve.strain.iter().zip(&curve.stress) {
                targets.push(TargetParam {
                    response: format!("{ORDINATE}{strain}"),
                    unit: "MPa".to_owned(),
                    value: stress.value_in("MPa").map_err(|e| format!("stress at strain {strain}: {e}"))?,
                    weight: 1.0 / curve.strain.len() as f64,
                    strain: Some(*strain),
                });
            }
        }
        Ok(targets)
    }

    /// Range of a factor: the stage's own, the factor's, or between its levels.
    fn range(&self, context: &Context, name: &str) -> Option<[f64; 2]> {
        let factor = context.factors.get(name)?;
        let levels = factor.levels.iter();
        let ends = levels.fold(None, |ends: Option<[f64; 2]>, &level| {
            Some(ends.map_or([level, level], |[low, high]| [low.min(level), high.max(level)]))
        });
        self.ranges.get(name).copied().or(factor.range).or(ends)
    }

    /// The value that the stage's material has for a factor, in the factor's unit.
    fn held(&self, context: &Context, name: &str) -> Option<f64> {
        let factor = context.factors.get(name)?;
        let values = context.materials.get(self.material.as_ref()?)?.resolve_alone();
        let parameter = factor.sets.iter().find_map(|path| values.get(path))?;
        let unit = Unit::parse(&factor.unit).ok()?;
        Some(unit.of_si(parameter.value))
    }

    /// Every fault of the settings.
    pub(super) fn faults(&self, context: &Context) -> Vec<Complaint> {
        let mut found = self.unknown_names(context);
        found.extend(self.ineffective());
        if self.surfaces.is_none() && self.simulator.is_none() {
            let complaint = Complaint::new("", "neither `surfaces` nor `simulator` is given");
            found.push(complaint.hint("name a stage of kind rsm, or one of kind simulate or command"));
        }
        if self.targets.is_empty() && self.curve.is_none() {
            let complaint = Complaint::new("", "no targets are given");
            found.push(complaint.hint("targets = [{ UCS = \"30 MPa\", E = \"30 GPa\", nu = 0.2 }]"));
        }
        if let Some(curve) = self.curve.as_ref().filter(|curve| curve.strain.len() != curve.stress.len()) {
            let (strains, stresses) = (curve.strain.len(), curve.stress.len());
            found.push(Complaint::new("curve", format!("{strains} strains but {stresses} stresses")));
        }
        if self.specimens == Some(0) {
            found.push(Complaint::new("specimens", "there must be at least one specimen"));
        }
        if !found.is_empty() {
            return found;
        }
        for (i, set) in self.targets.iter().enumerate() {
            if let Err(message) = self.set(context, set) {
                found.push(Complaint::new("targets", format!("set {}: {message}", i + 1)));
            }
        }
        if found.is_empty() {
            match self.params(context) {
                Ok(params) => {
                    let complaint = |fault: &Error| Complaint::new(self.key_of(fault), fault.to_string());
                    found.extend(params.faults().iter().map(complaint));
                }
                Err(error) => found.push(Complaint { hint: error.hint, ..Complaint::new("", error.message) }),
            }
        }
        found
    }

    /// The key that a fault of the problem is about; empty where the workflow's factors decide.
    fn key_of(&self, fault: &Error) -> &'static str {
        match fault {
            Error::Nothing { what: "factor" } | Error::Twice { .. } => "factors",
            Error::EmptyRange { factor, .. } if self.ranges.contains_key(factor) => "ranges",
            Error::NoLogarithm { factor, .. } if self.ranges.contains_key(factor) => "ranges",
            Error::EmptyBand { .. } => "targets",
            Error::NotLogarithmic { .. } | Error::Contradiction { .. } | Error::UnknownFactor { .. } => "constraints",
            Error::ZeroTarget { .. } if self.curve.is_none() => "targets",
            Error::Weight { response, .. } if self.weights.contains_key(response) => "weights",
            Error::Outside { .. } => "preference",
            Error::Nothing { .. }
            | Error::EmptyRange { .. }
            | Error::NoLogarithm { .. }
            | Error::NotFinite { .. }
            | Error::ZeroTarget { .. }
            | Error::Weight { .. }
            | Error::Setting { .. }
            | Error::ForeignHistory { .. }
            | Error::CurveTooShort { .. } => "",
        }
    }

    /// Names that the workflow does not declare, or that are none of the calibrated factors.
    fn unknown_names(&self, context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        let mut unknown = |path: String, what: &str, name: &String, known: Vec<&String>| {
            if !known.contains(&name) {
                let known: Vec<&str> = known.into_iter().map(String::as_str).collect();
                let complaint = Complaint::new(&path, format!("unknown {what} `{name}`"));
                found.push(complaint.hint(format!("known are {}", known.join(", "))));
            }
        };
        for name in &self.factors {
            unknown("factors".to_owned(), "factor", name, context.factors.keys().collect());
        }
        for name in self.targets.iter().flat_map(BTreeMap::keys) {
            unknown("targets".to_owned(), "response", name, context.responses.keys().collect());
        }
        for name in self.weights.keys() {
            unknown("weights".to_owned(), "response", name, context.responses.keys().collect());
        }
        for (key, names) in [
            ("ranges", self.ranges.keys().collect::<Vec<_>>()),
            ("preference", self.preference.keys().collect()),
            ("constraints", self.constraints.iter().flat_map(|c| c.terms.keys()).collect()),
        ] {
            for name in names {
                unknown(key.to_owned(), "calibrated factor", name, self.factors.iter().collect());
            }
        }
        if let Some(material) = &self.material {
            unknown("material".to_owned(), "material", material, context.materials.keys().collect());
        }
        found
    }

    /// Settings that do nothing with the rest as it is.
    fn ineffective(&self) -> Vec<Complaint> {
        let method = self.method_name();
        let name = json_name(method);
        let tables = [
            ("genetic", self.genetic.is_some(), MethodName::Genetic),
            ("annealing", self.annealing.is_some(), MethodName::Annealing),
            ("differential", self.differential.is_some(), MethodName::Differential),
            ("cma_es", self.cma_es.is_some(), MethodName::CmaEs),
            ("surrogate", self.surrogate.is_some(), MethodName::Surrogate),
        ];
        let others = tables.into_iter().filter(|(_, given, own)| *given && *own != method);
        let others = others.map(|(key, ..)| (key, format!("`{key}` has no effect with method `{name}`")));
        let simulated = self.simulator.is_some();
        let rules = [
            ("learn_from", !self.learn_from.is_empty() && method != MethodName::Surrogate, "only the surrogate learns"),
            ("learn_from", !self.learn_from.is_empty() && !simulated, "runs are learned from only with a simulator"),
            ("material", self.material.is_some() && self.learn_from.is_empty(), "it is used with `learn_from` only"),
            ("specimens", self.specimens.is_some() && !simulated, "it is used with a simulator only"),
            ("curve", self.curve.is_some() && !simulated, "surfaces give no curve; name a simulator"),
            ("curve", self.curve.is_some() && self.surfaces.is_some(), "surfaces give no curve; leave them out"),
            ("polish", self.polish && simulated, "descents need a model without scatter; it is for surfaces only"),
            (
                "surfaces",
                self.surfaces.is_some() && simulated && method != MethodName::Surrogate,
                "with a simulator only the surrogate uses surfaces",
            ),
        ];
        let rules = rules.into_iter().filter(|rule| rule.1).map(|(key, _, why)| (key, why.to_owned()));
        others.chain(rules).map(|(key, message)| Complaint::new(key, message)).collect()
    }
}

/// The method's name as a workflow writes it.
fn json_name(method: MethodName) -> String {
    match serde_json::to_value(method) {
        Ok(serde_json::Value::String(name)) => name,
        other => panic!("BUG: a method's name is a text, not {other:?}"),
    }
}

fn no_range(name: &str) -> StageError {
    StageError::new(format!("factor `{name}` has neither levels nor a range"))
        .hint(format!("give it one: [factor.{name}] range = [low, high]"))
}
