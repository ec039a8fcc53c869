//! A calibration on surfaces as plain data, from which a page can predict responses and search parameters by itself, with
//! the numbers and settings that `flow calibrate` uses.

use super::config::Calibrate;
use super::outlook::{DETERMINED, FREE};
use super::params::{FactorParam, Params};
use super::read::COVERAGE;
use crate::artifact::Artifact;
use crate::stage::fitted::models;
use crate::stage::{Context, StageError};
use math::distribution::t_for_coverage;
use optim::misfit::{Denominator, Form};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use stats::model::Model;
use std::collections::BTreeMap;

/// The data of a calibration on surfaces. All numbers are in the units beside them.
#[derive(Clone, Debug, Serialize)]
pub struct Instrument {
    /// The parameters: those that are calibrated, then those that a target set holds.
    pub parameters: Vec<Parameter>,
    /// Linear constraints in the unit box of the parameters: `normal · u ≤ bound`.
    pub walls: Vec<Wall>,
    /// The surfaces.
    pub responses: Vec<Surface>,
    /// The target sets of the workflow.
    pub sets: Vec<Aims>,
    /// How deviations are combined.
    pub form: Form,
    /// The value by which deviations are divided.
    pub denominator: Denominator,
    /// Relative deviation up to which a target counts as met.
    pub tolerance: f64,
    /// Largest part of its range over which a determined parameter may lie.
    pub determined: f64,
    /// Smallest part of its range over which a free parameter lies.
    pub free: f64,
}

/// A parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Its name in the workflow.
    pub name: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Lower end of its range.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it is searched by logarithms.
    pub log: bool,
    /// Of equally good solutions the one nearest to this value is taken; by default the middle of the range.
    pub preferred: Option<f64>,
    /// Whether target sets hold it at a value.
    pub held: bool,
    /// Paths of the values that it sets, such as `mortar.Ec`.
    pub sets: Vec<String>,
}

/// A linear constraint.
#[derive(Clone, Debug, Serialize)]
pub struct Wall {
    /// Its normal in the unit box, one number per parameter.
    pub normal: Vec<f64>,
    /// Its bound.
    pub bound: f64,
    /// The constraint as the workflow writes it.
    pub text: String,
}

/// The fitted surface of a response.
#[derive(Clone, Debug, Serialize)]
pub struct Surface {
    /// The response.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Weight of its deviation.
    pub weight: f64,
    /// The coded axes, each with its parameter.
    pub axes: Vec<Axis>,
    /// Powers of the axes, term by term.
    pub powers: Vec<Vec<u32>>,
    /// Coefficients of the terms.
    pub coefficients: Vec<f64>,
    /// Rows that span the covariance of the coefficients in units of `s²`, row by row.
    pub root: Vec<f64>,
    /// Residual standard deviation; `None` without residual degrees of freedom.
    pub s: Option<f64>,
    /// Student's quantile of the 95 % intervals.
    pub quantile: f64,
    /// The greatest leverage of a run: a point with a larger one is an extrapolation, even inside the box.
    pub farthest: f64,
}

/// An axis of a surface.
#[derive(Clone, Debug, Serialize)]
pub struct Axis {
    /// Index of the parameter.
    pub parameter: usize,
    /// Natural value at coded 0.
    pub centre: f64,
    /// Natural length of one coded unit.
    pub half: f64,
    /// Smallest value of a run.
    pub low: f64,
    /// Largest value of a run.
    pub high: f64,
}

/// A target set: its targets and the parameters that it holds.
#[derive(Clone, Debug, Serialize)]
pub struct Aims {
    /// The targets.
    pub targets: Vec<Aim>,
    /// Values of parameters by name.
    pub held: BTreeMap<String, f64>,
}

/// A target band; an end that is `None` is open.
#[derive(Clone, Debug, Serialize)]
pub struct Aim {
    /// Index of the response.
    pub response: usize,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Relative deviation up to which it counts as met; `None` for that of the calibration.
    pub tolerance: Option<f64>,
}

/// The data of the calibration with these settings on these surfaces; `None` when it searches by simulations, which a page
/// cannot run.
///
/// # Errors
/// The settings or surfaces cannot be read, or the constraints leave nothing.
pub fn instrument(settings: &Value, context: &Context, surfaces: &Artifact) -> Result<Option<Instrument>, StageError> {
    let own: Calibrate = Calibrate::deserialize(settings).map_err(|e| StageError::new(format!("the settings: {e}")))?;
    if own.surfaces.is_none() || !own.simulators().is_empty() {
        return Ok(None);
    }
    let params = own.params(context, &[])?;
    params.check()?;
    let models = models(surfaces)?;
    let parameters = parameters(&params, context, &models);
    let responses: Vec<Surface> =
        models.iter().filter_map(|(name, model)| surface(name, model, &params, context, &parameters)).collect();
    let all = |faults: Vec<optim::Error>| StageError::new(faults.first().map(ToString::to_string).unwrap_or_default());
    let domain = params.domain().map_err(all)?;
    let extended = |normal: &[f64]| {
        let mut normal = normal.to_vec();
        normal.resize(parameters.len(), 0.0);
        normal
    };
    let walls = domain
        .walls()
        .map(|(normal, bound, text)| Wall { normal: extended(normal), bound, text: text.to_owned() })
        .collect();
    Ok(Some(Instrument {
        walls,
        sets: sets(&params, &responses),
        form: params.form,
        denominator: params.denominator,
        tolerance: params.tolerance,
        determined: DETERMINED,
        free: FREE,
        parameters,
        responses,
    }))
}

/// The calibrated parameters, then those that some set holds, within the domains of the surfaces.
fn parameters(params: &Params, context: &Context, models: &[(String, Model)]) -> Vec<Parameter> {
    let paths = |name: &str| context.factors.get(name).map(|factor| factor.sets.clone()).unwrap_or_default();
    let preferred = params.preferred();
    let calibrated = |(i, factor): (usize, &FactorParam)| Parameter {
        name: factor.name.clone(),
        unit: factor.unit.clone(),
        low: factor.low,
        high: factor.high,
        log: factor.log,
        preferred: preferred.as_ref().map(|point| point[i]),
        held: false,
        sets: paths(&factor.name),
    };
    let mut found: Vec<Parameter> = params.factors.iter().enumerate().map(calibrated).collect();
    let held = params.sets.iter().flat_map(|set| set.held.keys());
    for name in held {
        let axes = models.iter().flat_map(|(_, model)| &model.axes).filter(|axis| axis.name == *name);
        let ends = axes.map(|axis| [axis.low, axis.high]);
        let domain = ends.reduce(|[low, high], [from, to]| [low.max(from), high.min(to)]);
        if let (Some([low, high]), false) = (domain, found.iter().any(|known| known.name == *name)) {
            let unit = params.held_units.get(name).cloned().unwrap_or_default();
            let (name, sets) = (name.clone(), paths(name));
            found.push(Parameter { name, unit, low, high, log: false, preferred: None, held: true, sets });
        }
    }
    found
}

/// A surface as data; `None` when it needs a factor that is neither calibrated nor held.
fn surface(name: &str, model: &Model, params: &Params, context: &Context, parameters: &[Parameter]) -> Option<Surface> {
    let axis = |axis: &stats::model::Axis| {
        let parameter = parameters.iter().position(|parameter| parameter.name == axis.name)?;
        let stats::model::Axis { centre, half, low, high, .. } = *axis;
        Some(Axis { parameter, centre, half, low, high })
    };
    let axes = model.axes.iter().map(axis).collect::<Option<Vec<Axis>>>()?;
    let target = params.sets.iter().flat_map(|set| &set.targets).find(|target| target.response == name);
    let declared = || context.responses.get(name).map(|response| response.unit.clone());
    Some(Surface {
        name: name.to_owned(),
        unit: target.map(|target| target.unit.clone()).or_else(declared).unwrap_or_default(),
        weight: target.map_or(1.0, |target| target.weight),
        powers: (0..model.terms.len())
            .map(|term| model.powers[term * axes.len()..(term + 1) * axes.len()].to_vec())
            .collect(),
        axes,
        coefficients: model.coefficients.clone(),
        root: model.root.clone(),
        s: model.s,
        quantile: t_for_coverage(COVERAGE, model.df_residual as f64),
        farthest: model.greatest_leverage,
    })
}

fn sets(params: &Params, responses: &[Surface]) -> Vec<Aims> {
    let aims = |set: &super::params::SetParam| {
        let aim = |target: &super::params::TargetParam| {
            let response = responses.iter().position(|response| response.name == target.response)?;
            Some(Aim { response, low: target.low, high: target.high, tolerance: target.tolerance })
        };
        Aims { targets: set.targets.iter().filter_map(aim).collect(), held: set.held.clone() }
    };
    params.sets.iter().map(aims).collect()
}
