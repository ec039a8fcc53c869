//! Converts models to and from the artifact `surfaces`.

use super::super::StageError;
use super::unreadable;
use crate::artifact::Artifact;
use crate::artifact::surfaces::{CodedFactors, CodedTerms, FittedModel, Surfaces};
use math::scale::Scale;
use ndarray::Array2;
use stats::model::{Axis, Model};
use stats::terms::Term;

/// The stored form of a model.
pub(super) fn stored(model: &Model) -> FittedModel {
    let of = |pick: fn(&Axis) -> f64| model.axes.iter().map(pick).collect::<Vec<f64>>();
    let count = model.terms.len();
    FittedModel {
        factors: CodedFactors {
            factor: model.axes.iter().map(|axis| axis.name.clone()).collect(),
            centre: of(|axis| axis.centre),
            half: of(|axis| axis.half),
            low: of(|axis| axis.low),
            high: of(|axis| axis.high),
            scale: scales(&model.axes.iter().collect::<Vec<_>>()),
        },
        terms: CodedTerms {
            term: model.terms.iter().map(Term::to_string).collect(),
            coefficient: model.coefficients.clone(),
        },
        root: Array2::from_shape_fn((count, count), |(row, column)| model.root[row * count + column]),
        s: model.s.unwrap_or(f64::NAN),
        df_residual: model.df_residual as i64,
        greatest_leverage: model.greatest_leverage,
    }
}

/// Scales of the factors of a model; `None` when all are linear.
pub(super) fn scales(axes: &[&Axis]) -> Option<Vec<Scale>> {
    axes.iter().any(|axis| !axis.scale.is_linear()).then(|| axes.iter().map(|axis| axis.scale).collect())
}

/// The models of an artifact `surfaces`, by response.
///
/// # Errors
/// Something is missing or of another type.
pub fn models(surfaces: &Artifact) -> Result<Vec<(String, Model)>, StageError> {
    let surfaces = Surfaces::from_artifact(surfaces).map_err(|e| unreadable(&e.to_string()))?;
    surfaces.models.into_iter().map(|(response, stored)| Ok((response, read(stored)?))).collect()
}

fn read(stored: FittedModel) -> Result<Model, StageError> {
    let FittedModel { factors, terms: CodedTerms { term, coefficient }, root, s, df_residual, greatest_leverage } =
        stored;
    let axis = |(i, name): (usize, &String)| Axis {
        name: name.clone(),
        scale: factors.scale.as_ref().map_or(Scale::Linear, |all| all[i]),
        centre: factors.centre[i],
        half: factors.half[i],
        low: factors.low[i],
        high: factors.high[i],
    };
    let axes: Vec<Axis> = factors.factor.iter().enumerate().map(axis).collect();
    let terms = term.iter().map(|t| Term::parse(t)).collect::<Result<Vec<_>, _>>();
    let terms = terms.map_err(|e| unreadable(&e.to_string()))?;
    if root.dim() != (terms.len(), terms.len()) {
        return Err(unreadable("`root` is not the square of the terms"));
    }
    Ok(Model {
        powers: terms.iter().flat_map(|t| axes.iter().map(|axis| t.power_of(&axis.name))).collect(),
        axes,
        terms,
        coefficients: coefficient,
        root: root.into_iter().collect(),
        s: (!s.is_nan()).then_some(s),
        df_residual: usize::try_from(df_residual).map_err(|_| unreadable("`df_residual` is negative"))?,
        greatest_leverage,
    })
}
