//! All that decides a calibration's result, and the optimisation problem it makes.

use super::config::Constraint;
use super::read;
use crate::artifact::Artifact;
use crate::stage::StageError;
use optim::constraint::{Domain, Factor, Linear};
use optim::misfit::{Denominator, Form, Misfit, Target};
use optim::search::{Knowledge, Limits, Method};
use optim::{Error, Problem};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A parameter to find.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FactorParam {
    pub name: String,
    pub unit: String,
    pub low: f64,
    pub high: f64,
    /// Its value in runs that do not vary it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fallback: Option<f64>,
}

/// How the name of a curve's ordinate begins; the strain follows.
pub(super) const ORDINATE: &str = "stress at ";

/// A wanted response.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TargetParam {
    pub response: String,
    pub unit: String,
    pub value: f64,
    pub weight: f64,
    /// The strain at which the curve gives it; none for a response by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<f64>,
}

/// What was told of one simulation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Told {
    pub point: Vec<f64>,
    /// Which of the set's run inputs it is; none when the task itself failed.
    pub run: Option<usize>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub failure: String,
}

/// Parameters of the work `calibrate`.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub factors: Vec<FactorParam>,
    pub sets: Vec<Vec<TargetParam>>,
    pub form: Form,
    pub denominator: Denominator,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<Constraint>,
    pub method: Method,
    pub limits: Limits,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub preference: BTreeMap<String, f64>,
    pub solutions: usize,
    /// Simulations of each set; empty on surfaces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<Vec<Told>>,
}

impl Params {
    fn domain(&self) -> Result<Domain, Vec<Error>> {
        let factor = |f: &FactorParam| Factor::linear(&f.name, f.low, f.high);
        let linear = |c: &Constraint| Linear { terms: c.terms.clone(), at_most: c.at_most };
        let walls: Vec<Linear> = self.constraints.iter().map(linear).collect();
        Domain::new(self.factors.iter().map(factor).collect(), &walls)
    }

    fn misfit(&self, set: usize) -> Result<Misfit, Vec<Error>> {
        let target = |t: &TargetParam| Target::exactly(&t.response, t.value, t.weight);
        Misfit::new(self.sets[set].iter().map(target).collect(), self.form, self.denominator)
    }

    /// The preferred point in natural units, the middle of the range where nothing is said; none without a preference.
    pub(super) fn preferred(&self) -> Option<Vec<f64>> {
        let middle = |f: &FactorParam| self.preference.get(&f.name).copied().unwrap_or(0.5 * (f.low + f.high));
        (!self.preference.is_empty()).then(|| self.factors.iter().map(middle).collect())
    }

    /// Every fault of the problem.
    pub(super) fn faults(&self) -> Vec<Error> {
        let domain = self.domain();
        let outside = domain.as_ref().ok().and_then(|domain| domain.check(&self.preferred()?).err());
        let mut found: Vec<Error> = outside.into_iter().collect();
        found.extend(domain.err().unwrap_or_default());
        for set in 0..self.sets.len() {
            for fault in self.misfit(set).err().unwrap_or_default() {
                if !found.contains(&fault) {
                    found.push(fault);
                }
            }
        }
        found.extend(method_faults(&self.method));
        found
    }

    /// Refuses faulty settings.
    pub(super) fn check(&self) -> Result<(), StageError> {
        let faults: Vec<String> = self.faults().iter().map(ToString::to_string).collect();
        if faults.is_empty() { Ok(()) } else { Err(StageError::new(faults.join("; "))) }
    }

    /// The optimisation problem of one set.
    pub(super) fn problem(&self, set: usize) -> Result<Problem, StageError> {
        let all =
            |faults: Vec<Error>| StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        Ok(Problem { domain: self.domain().map_err(all)?, misfit: self.misfit(set).map_err(all)?, start: None })
    }

    /// What the surrogate knows beforehand.
    pub(super) fn knowledge(
        &self,
        set: usize,
        surfaces: Option<&Artifact>,
        earlier: &[Arc<Artifact>],
    ) -> Result<Knowledge, StageError> {
        let trend = surfaces.map(|artifact| read::surfaces(artifact, &self.factors, &self.sets[set])).transpose()?;
        let mut runs = Vec::new();
        for artifact in earlier {
            runs.extend(read::runs(artifact, &self.factors, &self.sets[set])?);
        }
        Ok(Knowledge { earlier: runs, trend })
    }

    /// The responses of one run in the order of a set's targets, or why there are none.
    pub(super) fn read(&self, set: usize, run: &Artifact) -> Result<Result<Vec<f64>, String>, StageError> {
        read::run(run, &self.sets[set])
    }
}

/// Settings of the method that are out of their range.
fn method_faults(method: &Method) -> Vec<Error> {
    let mut found = Vec::new();
    let mut within = |setting: &'static str, value: f64, fine: bool, expected: &'static str| {
        if !fine {
            found.push(Error::Setting { setting, value, expected });
        }
    };
    let part = |value: f64| (0.0..=1.0).contains(&value);
    match method {
        Method::Genetic(s) => {
            within("elite", s.elite, part(s.elite), "a part between 0 and 1 is needed");
            within("crossover", s.crossover, part(s.crossover), "a part between 0 and 1 is needed");
        }
        Method::Annealing(s) => {
            let factor = s.factor.unwrap_or(0.5);
            within("factor", factor, factor > 0.0 && factor < 1.0, "a number between 0 and 1 is needed");
            let hot = s.temperature.unwrap_or(1.0);
            within("temperature", hot, hot > 0.0, "a positive number is needed");
        }
        Method::Differential(s) => {
            let f = s.initial_f.unwrap_or(0.5);
            within("initial_f", f, f > 0.0 && f <= 2.0, "a number between 0 and 2 is needed");
            let cr = s.initial_cr.unwrap_or(0.5);
            within("initial_cr", cr, part(cr), "a part between 0 and 1 is needed");
        }
        Method::CmaEs(s) => within("step", s.step, s.step > 0.0 && s.step <= 1.0, "a part of the range is needed"),
        Method::Surrogate(s) => {
            within("width", s.width, s.width > 0.0 && s.width <= 0.5, "at most half a range is needed");
            within("tolerance", s.tolerance, s.tolerance >= 0.0, "it cannot be negative");
            within("batch", s.batch as f64, s.batch > 0, "at least one run is needed");
        }
    }
    found
}
