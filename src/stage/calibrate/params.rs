//! The parameters of a calibration's task, and the optimisation problem that they define.

use super::constraint::Constraint;
use crate::stage::StageError;
use crate::stage::invalid::Invalid;
use math::scale::Scale;
use optim::constraint::{Domain, Factor, Linear};
use optim::misfit::{Denominator, Form, Misfit, Target};
use optim::search::{Limits, Method, Run};
use optim::{Error, Problem};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A parameter to find.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FactorParam {
    pub name: String,
    pub unit: String,
    pub low: f64,
    pub high: f64,
    /// Whether it is searched by logarithms.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub log: bool,
    /// Its value in runs that do not vary it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fallback: Option<f64>,
}

/// Prefix of the name of a curve's ordinate, before the strain.
pub(super) const ORDINATE: &str = "stress at ";

/// A target: a response and its band; an end that is `None` is open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct TargetParam {
    pub response: String,
    pub unit: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    pub weight: f64,
    /// Relative deviation up to which it counts as met; `None` for that of the calibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// The strain at which the curve gives it; `None` for a response by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<f64>,
}

impl TargetParam {
    /// As the optimiser sees it.
    pub(super) fn target(&self) -> Target {
        let ends = [self.low.unwrap_or(f64::NEG_INFINITY), self.high.unwrap_or(f64::INFINITY)];
        Target { tolerance: self.tolerance, ..Target::band(&self.response, ends, self.weight) }
    }
}

/// One target set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SetParam {
    pub targets: Vec<TargetParam>,
    /// Factors that are not calibrated, in their units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub held: BTreeMap<String, f64>,
    /// First point of its search, in the factors' units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Vec<f64>>,
    /// Seed of the optimiser in place of the task's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

/// One evaluation of the history: point and outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Told {
    pub point: Vec<f64>,
    /// The responses in the order of the targets; empty when it failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub responses: Option<Vec<f64>>,
    /// Why it failed; a run that is left out because it is not valid counts as failed.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub failure: String,
    /// Why a run that is used is not valid.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub validity: String,
}

impl Told {
    /// As the optimiser sees it.
    pub(super) fn run(&self) -> Run {
        Run { point: self.point.clone(), responses: self.responses.clone() }
    }
}

/// The evaluations of one set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct History {
    /// Evaluations on coarse twins, if there are any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coarse: Vec<Told>,
    /// Evaluations of the simulators themselves.
    pub runs: Vec<Told>,
}

/// Parameters of the work `calibrate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Params {
    pub factors: Vec<FactorParam>,
    pub sets: Vec<SetParam>,
    /// Units of the factors that the sets hold constant.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub held_units: BTreeMap<String, String>,
    pub form: Form,
    pub denominator: Denominator,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<Constraint>,
    pub method: Method,
    pub limits: Limits,
    /// Relative deviation up to which a target counts as met.
    pub tolerance: f64,
    /// Most full runs where the search uses coarse ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full: Option<usize>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub start: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub preference: BTreeMap<String, f64>,
    pub solutions: usize,
    /// Simulations that make one evaluation.
    pub simulators: usize,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
    /// Evaluations of each set; empty on surfaces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<History>,
}

/// The middle of a range, by ratios where it is searched by logarithms.
pub(super) fn middle(log: bool, [low, high]: [f64; 2]) -> f64 {
    if log { (low * high).sqrt() } else { 0.5 * (low + high) }
}

impl Params {
    pub(super) fn domain(&self) -> Result<Domain, Vec<Error>> {
        let scale = |log| if log { Scale::Log } else { Scale::Linear };
        let factor = |f: &FactorParam| Factor { name: f.name.clone(), low: f.low, high: f.high, scale: scale(f.log) };
        let linear = |c: &Constraint| Linear { terms: c.terms.clone(), at_most: c.at_most };
        let walls: Vec<Linear> = self.constraints.iter().map(linear).collect();
        Domain::new(self.factors.iter().map(factor).collect(), &walls)
    }

    fn misfit(&self, set: usize) -> Result<Misfit, Vec<Error>> {
        let targets = self.sets[set].targets.iter().map(TargetParam::target).collect();
        Misfit::new(targets, self.form, self.denominator)
    }

    /// The preferred point in natural units, the middle of the range by default; `None` without a preference.
    pub(super) fn preferred(&self) -> Option<Vec<f64>> {
        self.filled(&self.preference)
    }

    /// A point in natural units, with the middle of the range for factors that are not named; `None` when no factor is named.
    fn filled(&self, named: &BTreeMap<String, f64>) -> Option<Vec<f64>> {
        let value = |f: &FactorParam| named.get(&f.name).copied().unwrap_or_else(|| middle(f.log, [f.low, f.high]));
        (!named.is_empty()).then(|| self.factors.iter().map(value).collect())
    }

    /// Every fault of the problem.
    pub(super) fn faults(&self) -> Vec<Error> {
        let domain = self.domain();
        let outside = |point: Option<Vec<f64>>| domain.as_ref().ok().and_then(|domain| domain.check(&point?).err());
        let mut found: Vec<Error> =
            [self.preferred(), self.filled(&self.start)].into_iter().filter_map(outside).collect();
        for start in self.sets.iter().filter_map(|set| outside(set.start.clone())) {
            if !found.contains(&start) {
                found.push(start);
            }
        }
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

    /// An error when settings have faults.
    pub(super) fn check(&self) -> Result<(), StageError> {
        let faults: Vec<String> = self.faults().iter().map(ToString::to_string).collect();
        if faults.is_empty() { Ok(()) } else { Err(StageError::new(faults.join("; "))) }
    }

    /// The optimisation problem of one set.
    pub(super) fn problem(&self, set: usize) -> Result<Problem, StageError> {
        let all =
            |faults: Vec<Error>| StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        let domain = self.domain().map_err(all)?;
        let start = self.sets[set].start.clone().or_else(|| self.filled(&self.start));
        let start = start.map(|point| domain.repair(&domain.unit(&point)));
        Ok(Problem { domain, misfit: self.misfit(set).map_err(all)?, start })
    }

    /// The seed of the search of a set.
    pub(super) fn seed(&self, set: usize, usual: u64) -> u64 {
        self.sets[set].seed.unwrap_or(usual)
    }
}

/// Largest population: far more than any published one, and little memory.
const MOST_POPULATION: usize = 100_000;
const POPULATION: &str = "a whole number from 5 to 100000 is needed";
/// Most generations or moves.
const MOST_STEPS: usize = 10_000_000;
const STEPS: &str = "a whole number from 1 to 10000000 is needed";
/// Most runs of a surrogate; the time of its models grows with the cube of that number.
const MOST_RUNS: usize = 10_000;
const RUNS: &str = "a whole number from 1 to 10000 is needed";
const RESTARTS: &str = "the population, `growth` times larger at each of them, would pass 100000";

/// Settings of the method outside their ranges.
fn method_faults(method: &Method) -> Vec<Error> {
    let mut found = Vec::new();
    let mut within = |setting: &'static str, value: f64, fine: bool, expected: &'static str| {
        if !fine {
            found.push(Error::Setting { setting, value, expected });
        }
    };
    let part = |value: f64| (0.0..=1.0).contains(&value);
    let count = |count: Option<usize>| count.map_or(f64::NAN, |count| count as f64);
    let some = |count: Option<usize>, least, most| count.is_none_or(|count| (least..=most).contains(&count));
    match method {
        Method::Genetic(s) => {
            within("population", count(s.population), some(s.population, 5, MOST_POPULATION), POPULATION);
            within("generations", count(s.generations), some(s.generations, 1, MOST_STEPS), STEPS);
            within("elite", s.elite, part(s.elite), "a part between 0 and 1 is needed");
            within("crossover", s.crossover, part(s.crossover), "a part between 0 and 1 is needed");
        }
        Method::Annealing(s) => {
            within("chain", count(s.chain), some(s.chain, 1, MOST_STEPS), STEPS);
            within("chains", count(s.chains), some(s.chains, 1, MOST_RUNS), RUNS);
            let factor = s.factor.unwrap_or(0.5);
            within("factor", factor, factor > 0.0 && factor < 1.0, "a number between 0 and 1 is needed");
            let hot = s.temperature.unwrap_or(1.0);
            within("temperature", hot, hot > 0.0, "a positive number is needed");
        }
        Method::Differential(s) => {
            within("population", count(s.population), some(s.population, 5, MOST_POPULATION), POPULATION);
            within("generations", count(s.generations), some(s.generations, 1, MOST_STEPS), STEPS);
            let f = s.initial_f.unwrap_or(0.5);
            within("initial_f", f, f > 0.0 && f <= 2.0, "a number between 0 and 2 is needed");
            let cr = s.initial_cr.unwrap_or(0.5);
            within("initial_cr", cr, part(cr), "a part between 0 and 1 is needed");
            let spread = s.spread.unwrap_or(0.25);
            within("spread", spread, spread > 0.0 && spread <= 1.0, "a part of the range is needed");
        }
        Method::CmaEs(s) => {
            within("population", count(s.population), some(s.population, 5, MOST_POPULATION), POPULATION);
            // Every restart has a larger population than the one before it.
            let last = u32::try_from(s.restarts).ok().and_then(|restarts| s.growth.max(1).checked_pow(restarts));
            let last = last.and_then(|growth| growth.checked_mul(s.population.unwrap_or(4)));
            within("restarts", s.restarts as f64, last.is_some_and(|last| last <= MOST_POPULATION), RESTARTS);
            within("step", s.step, s.step > 0.0 && s.step <= 1.0, "a part of the range is needed");
        }
        Method::Proportional(s) => {
            within("runs", s.runs as f64, some(Some(s.runs), 1, MOST_RUNS), RUNS);
        }
        Method::Surrogate(s) => {
            within("width", s.width, s.width > 0.0 && s.width <= 0.5, "at most half a range is needed");
            within("tolerance", s.tolerance, s.tolerance >= 0.0, "it cannot be negative");
            within("batch", s.batch as f64, some(Some(s.batch), 1, MOST_RUNS), RUNS);
            within("first", count(s.first), some(s.first, 1, MOST_RUNS), RUNS);
            within("runs", s.runs as f64, some(Some(s.runs), 1, MOST_RUNS), RUNS);
        }
    }
    found
}
