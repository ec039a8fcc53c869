//! Responses for the optimiser: from surfaces, from single runs, from tables of runs.

use super::params::{FactorParam, TargetParam};
use crate::artifact::results::Results;
use crate::artifact::run::Run;
use crate::artifact::{Artifact, Table};
use crate::stage::StageError;
use crate::stage::fitted::models;
use crate::unit::Conversion;
use optim::Interval;
use optim::misfit::ordinates;
use optim::search::Run as Trial;
use optim::surrogate::Trend;
use stats::model::Model;
use std::sync::Arc;

/// One surface per target: the model, and where its axes stand among the factors.
type Surface = (Model, Vec<usize>);

/// The fitted surfaces of the targets, as a function of the factors.
pub(super) fn surfaces(
    artifact: &Artifact,
    factors: &[FactorParam],
    targets: &[TargetParam],
) -> Result<Trend, StageError> {
    let chosen = chosen(artifact, factors, targets)?;
    Ok(Arc::new(move |point: &[f64]| {
        let value = |(model, places): &Surface| model.value(&places.iter().map(|&i| point[i]).collect::<Vec<_>>());
        Some(chosen.iter().map(value).collect())
    }))
}

/// What the surfaces expect at a point, each with the 95 % interval of its mean response; NaN for the ends where the
/// fit has no residual to tell from.
pub(super) fn expected(
    artifact: &Artifact,
    factors: &[FactorParam],
    targets: &[TargetParam],
    point: &[f64],
) -> Result<Vec<Interval>, StageError> {
    let one = |(model, places): &Surface| {
        let told = model.predict(&places.iter().map(|&i| point[i]).collect::<Vec<_>>(), COVERAGE);
        let (low, high) = told.confidence.unwrap_or((f64::NAN, f64::NAN));
        Interval { mean: told.value, low, high }
    };
    Ok(chosen(artifact, factors, targets)?.iter().map(one).collect())
}

/// Coverage of the intervals.
const COVERAGE: f64 = 0.95;

/// The surface of every target.
fn chosen(artifact: &Artifact, factors: &[FactorParam], targets: &[TargetParam]) -> Result<Vec<Surface>, StageError> {
    let known = models(artifact)?;
    let mut chosen: Vec<Surface> = Vec::new();
    for target in targets {
        let found = known.iter().find(|(name, _)| *name == target.response);
        let (_, model) = found.ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
            StageError::new(format!("no surface of `{}` was fitted", target.response))
                .hint(format!("there are surfaces of {}", names.join(", ")))
        })?;
        chosen.push((model.clone(), places(model, &target.response, factors)?));
    }
    Ok(chosen)
}

/// How far a range may stand beyond a surface's domain by rounding, in parts of the domain.
const ROUNDING: f64 = 1e-9;

/// Where the axes of a surface stand among the factors, whose ranges must lie in its domain.
fn places(model: &Model, response: &str, factors: &[FactorParam]) -> Result<Vec<usize>, StageError> {
    let mut places = Vec::new();
    for axis in &model.axes {
        let place = factors.iter().position(|f| f.name == axis.name).ok_or_else(|| {
            StageError::new(format!("the surface of `{response}` needs factor `{}`", axis.name))
                .hint("add it to `factors`")
        })?;
        let FactorParam { name, low, high, unit, .. } = &factors[place];
        let slack = ROUNDING * (axis.high - axis.low);
        if *low < axis.low - slack || *high > axis.high + slack {
            let (from, to) = (axis.low, axis.high);
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let message = format!(
                "the range {low} … {high}{unit} of `{name}` leaves the domain {from} … {to}{unit} of the surface of \
                 `{response}`"
            );
            return Err(StageError::new(message).hint("narrow it: `ranges`, or run a wider design"));
        }
        places.push(place);
    }
    Ok(places)
}

fn converted(value: f64, from: &str, to: &str, what: &str) -> Result<f64, StageError> {
    let conversion = Conversion::between(from, to)
        .map_err(|e| StageError::new(format!("`{what}` comes in `{from}` and is wanted in `{to}`: {e}")))?;
    Ok(conversion.of(value))
}

/// The responses of one run in the order of the targets, or why it has none.
pub(super) fn run(artifact: &Artifact, targets: &[TargetParam]) -> Result<Result<Vec<f64>, String>, StageError> {
    let (failure, found) = Run::outcome(artifact)?;
    if !failure.is_empty() {
        return Ok(Err(failure.to_owned()));
    }
    let mut values = Vec::with_capacity(targets.len());
    for target in targets {
        if let Some(strain) = target.strain {
            match stress_at(artifact, strain)? {
                Ok(stress) => values.push(converted(stress, "Pa", &target.unit, &target.response)?),
                Err(reason) => return Ok(Err(reason)),
            }
            continue;
        }
        let entry = found.iter().find(|(name, ..)| *name == target.response);
        let (_, value, unit) = entry.ok_or_else(|| {
            let names: Vec<&str> = found.iter().map(|(name, ..)| *name).collect();
            StageError::new(format!("the simulator gives no response `{}`", target.response))
                .hint(format!("it gives {}", names.join(", ")))
        })?;
        if !value.is_finite() {
            return Ok(Err(format!("`{}` is not a number", target.response)));
        }
        values.push(converted(*value, unit, &target.unit, &target.response)?);
    }
    Ok(Ok(values))
}

/// Stress of a run's curve at a strain, in Pa; the inner error when the curve ends before.
fn stress_at(artifact: &Artifact, strain: f64) -> Result<Result<f64, String>, StageError> {
    let missing = || StageError::new("the simulator stores no stress–strain curve");
    let curve = Run::from_artifact(artifact)?.curve.ok_or_else(missing)?;
    Ok(ordinates(&curve.axial_strain, &curve.stress, &[strain])
        .map(|values| values[0])
        .map_err(|fault| fault.to_string()))
}

/// The runs of a table, in the order of factors and targets; what a run lacks is NaN.
pub(super) fn runs(
    artifact: &Artifact,
    factors: &[FactorParam],
    targets: &[TargetParam],
) -> Result<Vec<Trial>, StageError> {
    let table = Results::table(artifact)?;
    let points = factors.iter().map(|f| factor_values(table, f)).collect::<Result<Vec<_>, _>>()?;
    let responses = targets.iter().map(|t| response_values(table, t)).collect::<Result<Vec<_>, _>>()?;
    let failures = Results::failures(table);
    let failed = |row: usize| failures.get(row).is_some_and(|reason| !reason.is_empty());
    let row = |i: usize| {
        let values: Vec<f64> = responses.iter().map(|column| column[i]).collect();
        let some = values.iter().any(|v| v.is_finite());
        let point = points.iter().map(|column| column[i]).collect();
        // A run that lacks every response without having failed says nothing.
        (some || failed(i)).then_some(Trial { point, responses: some.then_some(values) })
    };
    Ok((0..table.rows()).filter_map(row).collect())
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

/// The failure text of a run's artifact, empty when all went well.
pub(super) fn failure(artifact: &Artifact) -> String {
    Run::outcome(artifact).map_or_else(|_| String::new(), |(failure, _)| failure.to_owned())
}
