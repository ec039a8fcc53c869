//! The settings of a calibration, and the parameters of its task.

use super::constraint::Constraint;
use super::curve::Curve;
use super::goal::Goal;
use super::params::{FactorParam, Params};
use super::slope::Slope;
use crate::artifact::Artifact;
use crate::stage::figure::Names;
use crate::stage::invalid::Invalid;
use crate::stage::{Context, StageError};
use crate::unit::Unit;
use math::scale::Scale;
use optim::misfit::{Denominator, Form};
use optim::search::{Limits, Method};
use optim::{annealing, cma_es, differential, genetic, surrogate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The first value of a factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum First {
    /// A number in the unit of the factor.
    Number(f64),
    /// A formula of the targets, in the units of the responses: its value is in the unit of the factor.
    Formula(String),
}

/// Settings of a `calibrate` stage.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Calibrate {
    /// The stage with the fitted surfaces.
    pub surfaces: Option<String>,
    /// The stage whose simulation is run: its specimen, material and test.
    pub simulator: Option<String>,
    /// Several stages, all run at every point, such as a compression and a splitting test.
    pub simulators: Vec<String>,
    /// The simulator that gives a response, when several do; by default the first that does.
    pub from: BTreeMap<String, String>,
    /// Cheaper twins of the simulators, one or in their order: the search runs these, and the simulators themselves only
    /// correct the solution.
    pub coarse: Names,
    /// Most runs of the simulators themselves where there are coarse ones; 12 by default.
    pub full_runs: Option<usize>,
    /// Stages whose runs the surrogate uses too.
    pub learn_from: Vec<String>,
    /// The material with the values of factors that a table of `learn_from` does not vary.
    pub material: Option<String>,
    /// The parameters to find, between the ends of their ranges.
    pub factors: Vec<String>,
    /// Ranges in place of those of the factors, in their units.
    pub ranges: BTreeMap<String, [f64; 2]>,
    /// Factors that are searched on another scale than their own.
    pub scales: BTreeMap<String, Scale>,
    /// Linear constraints on the factors.
    pub constraints: Vec<Constraint>,
    /// Target sets: the target of each response, such as `{ UCS = "30 MPa", sigma_t = { at_least = "3 MPa" } }`.
    pub targets: Vec<BTreeMap<String, Goal>>,
    /// Factors that are not calibrated and their values, in their units: one table for all target sets, or one for each;
    /// several with one target set make as many sets.
    pub held: Vec<BTreeMap<String, f64>>,
    /// A stress–strain curve that is a target of every set too; needs a simulator.
    pub curve: Option<Curve>,
    /// Weight of the deviation of a response, 1 by default.
    pub weights: BTreeMap<String, f64>,
    /// Relative deviation up to which a target counts as met; 0.02 by default.
    pub tolerance: Option<f64>,
    /// What `flow run` does when targets are not met.
    pub unmet: Unmet,
    /// What to do with a run that is not valid. A run that is left out counts as a failed evaluation.
    #[serde(skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
    /// How deviations are combined; by default as in the publication of the method's preset, else as their sum.
    pub misfit: Option<Form>,
    /// The value by which deviations are divided.
    pub denominator: Denominator,
    /// The optimiser; by default `genetic` on surfaces and `surrogate` with a simulator.
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
    /// Settings of the proportional corrections.
    pub proportional: Option<Slope>,
    /// First point of the search: numbers in the factors' units, or formulas of the targets such as `"1.2*E"`; the middle of
    /// the range for factors that are not named.
    pub start: BTreeMap<String, First>,
    /// Seeds of the optimiser, in place of the workflow's: every target set is searched once with each.
    pub seeds: Vec<u64>,
    /// Most evaluations of a set.
    pub evaluations: Option<usize>,
    /// Misfit at which the search stops.
    pub stop_at: Option<f64>,
    /// Whether to refine the best point by a local descent at the end; on surfaces only.
    pub polish: bool,
    /// Of equally good solutions the one nearest to this point is taken, in the factors' units; the middle of the range for
    /// factors that are not named.
    pub preference: BTreeMap<String, f64>,
    /// Number of further solutions in the table `solution_set`; 50 by default.
    pub solutions: Option<usize>,
    /// Number of specimens that the simulations use in turn; by default every simulation of a set has a new one.
    pub specimens: Option<u64>,
}

/// Default number of further solutions.
const SOLUTIONS: usize = 50;
/// Default relative deviation up to which a target counts as met.
const TOLERANCE: f64 = 0.02;
/// Default number of runs of the full simulators.
const FULL_RUNS: usize = 12;

/// What to do when the targets of a calibration are not met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Unmet {
    /// Report it.
    #[default]
    Say,
    /// Report it and let `flow run` exit with 1.
    Fail,
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
    /// One factor, corrected by the slope of the last run.
    Proportional,
}

impl Calibrate {
    /// The stages that are run at every point.
    pub(super) fn simulators(&self) -> Vec<String> {
        self.simulator.iter().chain(&self.simulators).cloned().collect()
    }

    /// The optimiser that is used.
    pub(super) fn method_name(&self) -> MethodName {
        let simulated = !self.simulators().is_empty();
        self.method.unwrap_or(if simulated { MethodName::Surrogate } else { MethodName::Genetic })
    }

    fn method(&self) -> Method {
        match self.method_name() {
            MethodName::Genetic => Method::Genetic(self.genetic.clone().unwrap_or_default()),
            MethodName::Annealing => Method::Annealing(self.annealing.clone().unwrap_or_default()),
            MethodName::Differential => Method::Differential(self.differential.clone().unwrap_or_default()),
            MethodName::CmaEs => Method::CmaEs(self.cma_es.clone().unwrap_or_default()),
            MethodName::Surrogate => Method::Surrogate(self.surrogate.clone().unwrap_or_default()),
            MethodName::Proportional => Method::Proportional(self.proportional.clone().unwrap_or_default().method()),
        }
    }

    /// The misfit at which the search stops: the setting, or that of the method's preset.
    fn stop_at(&self) -> Option<f64> {
        let published = match self.method() {
            Method::Annealing(settings) => settings.published_misfit(),
            Method::Genetic(_)
            | Method::Differential(_)
            | Method::CmaEs(_)
            | Method::Surrogate(_)
            | Method::Proportional(_) => None,
        };
        self.stop_at.or(published)
    }

    /// How deviations are combined: the setting, or that of the method's preset.
    pub(super) fn form(&self) -> Form {
        let published = match self.method() {
            Method::Annealing(settings) => settings.published_form(),
            Method::Genetic(_)
            | Method::Differential(_)
            | Method::CmaEs(_)
            | Method::Surrogate(_)
            | Method::Proportional(_) => None,
        };
        self.misfit.or(published).unwrap_or_default()
    }

    /// All parameters that decide the result, in the units of factors and responses. `measured` are the curves that the stage
    /// names, empty before they are known: then the sets lack the targets of the curves.
    pub(super) fn params(&self, context: &Context, measured: &[Arc<Artifact>]) -> Result<Params, StageError> {
        let factor = |name: &String| {
            let factor = context.factors.get(name).ok_or_else(|| StageError::new(format!("no [factor.{name}]")))?;
            let [low, high] = self.range(context, name).ok_or_else(|| no_range(name))?;
            let (fallback, log) = (self.material_value(context, name), self.is_log(context, name));
            Ok(FactorParam { name: name.clone(), unit: factor.unit.clone(), low, high, log, fallback })
        };
        let factors = self.factors.iter().map(factor).collect::<Result<_, StageError>>()?;
        Ok(Params {
            factors,
            sets: self.sets(context, measured)?,
            held_units: self.held_units(context),
            form: self.form(),
            denominator: self.denominator,
            constraints: self.constraints.clone(),
            method: self.method(),
            limits: Limits { evaluations: self.evaluations, misfit: self.stop_at(), polish: self.polish },
            tolerance: self.tolerance.unwrap_or(TOLERANCE),
            full: (!self.coarse.is_empty()).then(|| self.full_runs.unwrap_or(FULL_RUNS)),
            start: self.start_numbers(),
            preference: self.preference.clone(),
            solutions: self.solutions.unwrap_or(SOLUTIONS),
            simulators: self.simulators().len(),
            invalid: self.invalid,
            history: Vec::new(),
        })
    }

    /// Range of a factor: the stage's own, the factor's, or between its levels.
    pub(super) fn range(&self, context: &Context, name: &str) -> Option<[f64; 2]> {
        let factor = context.factors.get(name)?;
        let levels = factor.levels.iter();
        let ends = levels.fold(None, |ends: Option<[f64; 2]>, &level| {
            Some(ends.map_or([level, level], |[low, high]| [low.min(level), high.max(level)]))
        });
        self.ranges.get(name).copied().or(factor.range).or(ends)
    }

    /// Whether a factor is searched on a logarithmic scale: by the setting of the stage, else of the factor.
    pub(super) fn is_log(&self, context: &Context, name: &str) -> bool {
        let own = context.factors.get(name).is_some_and(|factor| factor.scale == Scale::Log);
        self.scales.get(name).map_or(own, |scale| *scale == Scale::Log)
    }

    fn held_units(&self, context: &Context) -> BTreeMap<String, String> {
        let held = self.held.iter().flat_map(BTreeMap::keys);
        held.filter_map(|name| Some((name.clone(), context.factors.get(name)?.unit.clone()))).collect()
    }

    /// The value that the stage's material has for a factor, in the factor's unit.
    fn material_value(&self, context: &Context, name: &str) -> Option<f64> {
        let factor = context.factors.get(name)?;
        let values = context.materials.get(self.material.as_ref()?)?.resolve_alone();
        let parameter = factor.sets.iter().find_map(|path| values.get(path))?;
        let unit = Unit::parse(&factor.unit).ok()?;
        Some(unit.of_si(parameter.value))
    }
}

fn no_range(name: &str) -> StageError {
    StageError::new(format!("factor `{name}` has neither levels nor a range"))
        .hint(format!("give it one: [factor.{name}] range = [low, high]"))
}
