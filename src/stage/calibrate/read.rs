//! Responses for the optimiser: from surfaces, from single runs, from tables of runs.

use super::params::{FactorParam, Params, SetParam, TargetParam};
use crate::artifact::results::Results;
use crate::artifact::run::{Curve, Run};
use crate::artifact::{Artifact, Table};
use crate::stage::StageError;
use crate::stage::fitted::models;
use crate::stage::invalid::{Invalid, refused};
use crate::unit::Conversion;
use optim::Interval;
use optim::misfit::ordinates;
use optim::search::{Knowledge, Run as Trial};
use optim::surrogate::Trend;
use stats::model::Model;
use std::collections::BTreeMap;
use std::sync::Arc;

/// One surface per target: the model, and the source of the value of each of its axes.
type Surface = (Model, Vec<Axis>);

/// Source of the value of an axis.
#[derive(Clone, Copy, Debug)]
enum Axis {
    /// The factor at this index.
    Calibrated(usize),
    /// A factor that is held at a value.
    Held(f64),
}

/// The values of a surface's axes at a point.
fn on_axes(axes: &[Axis], point: &[f64]) -> Vec<f64> {
    let value = |axis: &Axis| match *axis {
        Axis::Calibrated(index) => point[index],
        Axis::Held(value) => value,
    };
    axes.iter().map(value).collect()
}

/// The fitted surfaces of the targets, as a function of the factors.
pub(super) fn surfaces(
    artifact: &Artifact,
    factors: &[FactorParam],
    held: &Held,
    targets: &[TargetParam],
) -> Result<Trend, StageError> {
    let chosen = chosen(artifact, factors, held, targets)?;
    Ok(Arc::new(move |point: &[f64]| {
        let value = |(model, axes): &Surface| model.value(&on_axes(axes, point));
        Some(chosen.iter().map(value).collect())
    }))
}

/// Factors that are held, and their values.
type Held = BTreeMap<String, f64>;

/// The mean responses of the surfaces at a point, each with its 95 % interval; NaN for the ends where the fit has no
/// residual degrees of freedom.
pub(super) fn outlook(
    artifact: &Artifact,
    factors: &[FactorParam],
    set: &SetParam,
) -> Result<impl Fn(&[f64]) -> Option<Vec<Interval>> + use<>, StageError> {
    let chosen = chosen(artifact, factors, &set.held, &set.targets)?;
    Ok(move |point: &[f64]| {
        let one = |(model, axes): &Surface| {
            let told = model.predict(&on_axes(axes, point), COVERAGE);
            let (low, high) = told.confidence.unwrap_or((f64::NAN, f64::NAN));
            Interval { mean: told.value, low, high }
        };
        Some(chosen.iter().map(one).collect())
    })
}

/// Coverage of the intervals.
pub(super) const COVERAGE: f64 = 0.95;

impl Params {
    /// The prior knowledge of the surrogate.
    pub(super) fn knowledge(
        &self,
        set: usize,
        surfaces: Option<&Artifact>,
        earlier: &[Arc<Artifact>],
    ) -> Result<Knowledge, StageError> {
        let SetParam { targets, held, .. } = &self.sets[set];
        let trend = surfaces.map(|artifact| self::surfaces(artifact, &self.factors, held, targets)).transpose()?;
        let mut known = Vec::new();
        for artifact in earlier {
            known.extend(runs(artifact, &self.factors, targets, self.invalid)?);
        }
        Ok(Knowledge { earlier: known, trend })
    }
}

/// The surface of every target.
fn chosen(
    artifact: &Artifact,
    factors: &[FactorParam],
    held: &Held,
    targets: &[TargetParam],
) -> Result<Vec<Surface>, StageError> {
    let known = models(artifact)?;
    let mut chosen: Vec<Surface> = Vec::new();
    for target in targets {
        let found = known.iter().find(|(name, _)| *name == target.response);
        let (_, model) = found.ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
            StageError::new(format!("no surface of `{}` was fitted", target.response))
                .hint(format!("there are surfaces of {}", names.join(", ")))
        })?;
        chosen.push((model.clone(), axes(model, &target.response, factors, held)?));
    }
    Ok(chosen)
}

/// Largest excess of a range over a surface's domain that counts as rounding, in parts of the domain.
const ROUNDING: f64 = 1e-9;

/// The sources of the axes of a surface; ranges and held values must lie in its domain.
fn axes(model: &Model, response: &str, factors: &[FactorParam], held: &Held) -> Result<Vec<Axis>, StageError> {
    let mut found = Vec::new();
    for axis in &model.axes {
        let index = factors.iter().position(|f| f.name == axis.name);
        let (taken, [low, high], unit) = match (index, held.get(&axis.name)) {
            (Some(index), _) => {
                let FactorParam { low, high, unit, .. } = &factors[index];
                (Axis::Calibrated(index), [*low, *high], unit.as_str())
            }
            (None, Some(&value)) => (Axis::Held(value), [value, value], ""),
            (None, None) => {
                let message = format!("the surface of `{response}` needs factor `{}`", axis.name);
                return Err(StageError::new(message).hint("add it to `factors`, or give it a value in `held`"));
            }
        };
        let slack = ROUNDING * (axis.high - axis.low);
        if low < axis.low - slack || high > axis.high + slack {
            let (name, from, to) = (&axis.name, axis.low, axis.high);
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let message = format!(
                "the range {low} … {high}{unit} of `{name}` leaves the domain {from} … {to}{unit} of the surface of \
                 `{response}`"
            );
            return Err(StageError::new(message).hint("narrow it: `ranges`, or run a wider design"));
        }
        found.push(taken);
    }
    Ok(found)
}

fn converted(value: f64, from: &str, to: &str, what: &str) -> Result<f64, StageError> {
    let conversion = Conversion::between(from, to)
        .map_err(|e| StageError::new(format!("`{what}` comes in `{from}` and is wanted in `{to}`: {e}")))?;
    Ok(conversion.of(value))
}

/// One simulator's run at a point.
pub(super) struct Part<'a> {
    /// The simulator.
    pub stage: &'a str,
    /// Its outcome.
    pub run: &'a Artifact,
}

/// Validity and failures of the runs of one evaluation.
#[derive(Default)]
pub(in crate::stage) struct Judgement {
    /// Why a run gave no result; empty when all gave one.
    pub failure: String,
    /// Why a run that gave a result is not valid; empty when all are valid.
    pub validity: String,
    /// Whether the simulators have checks at all.
    pub checked: bool,
}

impl Judgement {
    /// Collects validity and failures of the runs of one evaluation.
    ///
    /// # Errors
    /// An artifact is not a run.
    pub(super) fn of(parts: &[Part<'_>]) -> Result<Self, StageError> {
        let mut found = Self::default();
        for part in parts {
            let outcome = Run::outcome(part.run)?;
            found.checked |= outcome.validity.is_some();
            let whose = if parts.len() > 1 { format!("{}: ", part.stage) } else { String::new() };
            if !outcome.failure.is_empty() {
                return Ok(Self { failure: format!("{whose}{}", outcome.failure), validity: String::new(), ..found });
            }
            if let (Some(why), true) = (outcome.invalid(), found.validity.is_empty()) {
                found.validity = format!("{whose}{why}");
            }
        }
        Ok(found)
    }
}

/// The responses of one evaluation in the order of the targets, or why it has none: a run gave no result, or is left out
/// because it is not valid. Each is taken from the simulator that `from` names, or from the first that gives it. Where all
/// targets are ordinates of curves, a run whose curve reaches their strains has them, though it found no peak later.
///
/// # Errors
/// A run is refused because it is not valid, or no simulator gives a response, or gives it in a unit of another dimension.
pub(super) fn evaluation(
    parts: &[Part<'_>],
    from: &BTreeMap<String, String>,
    targets: &[TargetParam],
    invalid: Invalid,
) -> Result<Result<Vec<f64>, String>, StageError> {
    let Judgement { failure, validity, .. } = Judgement::of(parts)?;
    let measured = failure.is_empty() || curves_reach(parts, targets)?;
    match (measured, validity.is_empty(), invalid) {
        (false, _, _) => return Ok(Err(failure)),
        (true, false, Invalid::LeaveOut) => return Ok(Err(format!("{}{validity}", Run::NOT_VALID))),
        (true, false, Invalid::Refuse) => return Err(refused(&format!("a run is not valid: {validity}"))),
        (true, false, Invalid::Keep) | (true, true, _) => {}
    }
    let mut found = Vec::new();
    for part in parts {
        found.push((part, Run::outcome(part.run)?.responses));
    }
    let mut values = Vec::with_capacity(targets.len());
    for target in targets {
        let wanted = |stage: &str| from.get(&target.response).is_none_or(|own| own == stage);
        let mut givers = found.iter().filter(|(part, _)| wanted(part.stage));
        let value = match target.strain {
            Some(strain) => match givers.find(|(part, _)| Run::curve_of(part.run).is_some()) {
                Some((part, _)) => stress_at(part.run, strain)?.map(|stress| (stress, "Pa")),
                None => return Err(StageError::new("no simulator stores a stress–strain curve")),
            },
            None => {
                let mut all = givers.flat_map(|(_, responses)| responses);
                let own = all.find(|(name, ..)| *name == target.response);
                let &(_, value, unit) = own.ok_or_else(|| no_response(&target.response, &found))?;
                Ok((value, unit))
            }
        };
        match value {
            Ok((value, _)) if !value.is_finite() => return Ok(Err(format!("`{}` is not a number", target.response))),
            Ok((value, unit)) => values.push(converted(value, unit, &target.unit, &target.response)?),
            Err(reason) => return Ok(Err(reason)),
        }
    }
    Ok(Ok(values))
}

/// Whether all targets are ordinates of curves, and the curve of every run reaches their strains.
fn curves_reach(parts: &[Part<'_>], targets: &[TargetParam]) -> Result<bool, StageError> {
    let Some(strains) = targets.iter().map(|target| target.strain).collect::<Option<Vec<f64>>>() else {
        return Ok(false);
    };
    let largest = strains.into_iter().fold(0.0, f64::max);
    for part in parts {
        let last = curve(part.run)?.and_then(|curve| curve.axial_strain.last().copied());
        if last.is_none_or(|last| last < largest) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The curve of a run, without its other tables; `None` if it stores none.
fn curve(run: &Artifact) -> Result<Option<Curve>, StageError> {
    Ok(Run::curve_of(run).map(Curve::from_table).transpose()?)
}

type Given<'a> = (&'a Part<'a>, Vec<(&'a str, f64, &'a str)>);

fn no_response(response: &str, found: &[Given<'_>]) -> StageError {
    let gives = |(part, responses): &Given| {
        let names: Vec<&str> = responses.iter().map(|(name, ..)| *name).collect();
        format!("{} gives {}", part.stage, names.join(", "))
    };
    let given: Vec<String> = found.iter().map(gives).collect();
    StageError::new(format!("no simulator gives a response `{response}`")).hint(given.join("; "))
}

/// Stress of a run's curve at a strain, Pa; the inner error says why the curve cannot be read. Before its first point the
/// curve rises from zero. Beyond its last point, on the falling branch, no stress was measured: it is taken to fall with the
/// inverse of the strain, so that among runs that broke too early the one that came nearest deviates least.
fn stress_at(artifact: &Artifact, strain: f64) -> Result<Result<f64, String>, StageError> {
    let missing = || StageError::new("the simulator stores no stress–strain curve");
    let curve = curve(artifact)?.ok_or_else(missing)?;
    let (mut strains, mut stresses) = (curve.axial_strain, curve.stress);
    let Some(&last) = strains.last() else { return Ok(Err("the stress–strain curve is empty".to_owned())) };
    if strains[0] > 0.0 {
        strains.insert(0, 0.0);
        stresses.insert(0, 0.0);
    }
    let beyond = if strain > last { last / strain } else { 1.0 };
    let at = ordinates(&strains, &stresses, &[strain.min(last)]);
    Ok(at.map(|values| beyond * values[0]).map_err(|fault| fault.to_string()))
}

/// The runs of a table, in the order of factors and targets; a missing value is NaN. A run that is left out because it is
/// not valid counts as failed.
pub(super) fn runs(
    artifact: &Artifact,
    factors: &[FactorParam],
    targets: &[TargetParam],
    invalid: Invalid,
) -> Result<Vec<Trial>, StageError> {
    let table = Results::table(artifact)?;
    let judged = invalid.judge(table)?;
    let points = factors.iter().map(|f| factor_values(table, f)).collect::<Result<Vec<_>, _>>()?;
    let responses = targets.iter().map(|t| response_values(table, t)).collect::<Result<Vec<_>, _>>()?;
    let failures = Results::failures(table);
    let failed = |row: usize| failures.get(row).is_some_and(|reason| !reason.is_empty());
    let row = |i: usize| {
        let values: Vec<f64> = responses.iter().map(|column| column[i]).collect();
        let left_out = judged.leaves_out(i);
        let some = values.iter().any(|v| v.is_finite()) && !left_out;
        let point = points.iter().map(|column| column[i]).collect();
        // A run without any response that has not failed holds no information.
        (some || failed(i) || left_out).then_some(Trial { point, responses: some.then_some(values) })
    };
    Ok((0..table.rows()).filter_map(row).collect())
}

/// How many of the runs that a search learns from are not valid, and whether they are used.
pub(super) fn not_valid(artifact: &Artifact, invalid: Invalid) -> Result<Option<String>, StageError> {
    Ok(invalid.judge(Results::table(artifact)?)?.sentence())
}

fn factor_values(table: &Table, factor: &FactorParam) -> Result<Vec<f64>, StageError> {
    let name = &factor.name;
    match (table.column(name), factor.fallback) {
        (Some(column), _) => Ok(column.numbers(&factor.unit)?),
        (None, Some(fallback)) => Ok(vec![fallback; table.rows()]),
        (None, None) => {
            Err(StageError::new(format!("a table of `learn_from` does not say at what `{name}` its runs were"))
                .hint("name the `material` that they held it at"))
        }
    }
}

fn response_values(table: &Table, target: &TargetParam) -> Result<Vec<f64>, StageError> {
    let name = &target.response;
    match table.column(name) {
        Some(column) => Ok(column.numbers(&target.unit)?),
        None => Ok(vec![f64::NAN; table.rows()]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::run::Responses;

    /// A run that ended at a strain of 0.002 under 10 MPa.
    fn run(failure: &str) -> Artifact {
        let curve = Curve {
            axial_strain: vec![0.001, 0.002],
            stress: vec![8e6, 10e6],
            lateral_strain: vec![0.0; 2],
            volumetric_strain: vec![0.0; 2],
            cracks: vec![0; 2],
            speed: None,
        };
        Run { curve: Some(curve), ..Run::plain(failure, Responses::default()) }.to_artifact()
    }

    fn ordinate(strain: f64) -> TargetParam {
        let (response, unit) = (String::from("stress"), String::from("MPa"));
        TargetParam { response, unit, low: None, high: None, weight: 1.0, tolerance: None, strain: Some(strain) }
    }

    fn read(run: &Artifact, targets: &[TargetParam]) -> Result<Vec<f64>, String> {
        evaluation(&[Part { stage: "crush", run }], &BTreeMap::new(), targets, Invalid::LeaveOut).unwrap()
    }

    #[test]
    fn beyond_its_end_a_curve_falls_with_the_inverse_of_the_strain() {
        let found = read(&run(""), &[0.0005, 0.0015, 0.002, 0.004].map(ordinate)).unwrap();
        let wanted = [4.0, 9.0, 10.0, 5.0];
        assert!(found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn a_run_without_a_peak_has_the_ordinates_that_its_curve_reaches() {
        let endless = run("no peak");
        assert_eq!(read(&endless, &[0.001, 0.002].map(ordinate)), Ok(vec![8.0, 10.0]));
        assert_eq!(read(&endless, &[0.001, 0.003].map(ordinate)), Err("no peak".to_owned()));
        let strength = TargetParam { response: "UCS".to_owned(), strain: None, ..ordinate(0.001) };
        assert_eq!(read(&endless, &[ordinate(0.001), strength]), Err("no peak".to_owned()));
    }
}
