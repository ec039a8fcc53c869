//! Fitted models as artifacts: the tables for readers and the data for prediction, shared by `regression` and `rsm`, and
//! read by every stage that predicts.

use super::columns::{Columns, Rows, refused_without, runs};
use super::notes::Notes;
use super::published::{Computed, beside, prints};
use super::{Failure, Job, StageError};
use crate::artifact::Artifact;
use crate::artifact::statistics::{Fits, Residuals};
use crate::artifact::surfaces::{Coefficients, Domains, PrincipalAxes, Selections, Stationary, Surfaces, WithConstant};
use crate::artifact::validity::NotValid;
use origin::Beside;
use serde::{Deserialize, Serialize};
use stats::canonical::canonical;
use stats::diagnostics::Residual;
use stats::fit::Fit;
use stats::regression::{Coefficient, Regression, Settings, regress};
use stats::selection::{Direction, Selection};
use stats::terms::Term;

mod keep;
pub(super) mod origin;
mod predict;
pub use keep::models;
pub use predict::Predict;
pub(super) use predict::check_predict;

/// One response to be fitted.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Fitting {
    pub response: String,
    /// Name of the task's input that holds its table.
    pub input: String,
    pub columns: Columns,
    pub terms: Vec<Term>,
}

/// Parameters of the task: everything that decides fitted models.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub fittings: Vec<Fitting>,
    /// Whether every model passes through the origin; it is then compared with the same terms and a constant.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub through_origin: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub select: Option<Direction>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub select_alpha: Option<f64>,
    pub outlier_alpha: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predict: Option<Predict>,
}

/// Default level at which terms are selected.
pub(super) const SELECT_ALPHA: f64 = 0.05;

/// Fits every response and makes the artifact `surfaces`.
pub(super) fn fit(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    if let Some(own) = params.fittings.iter().find(|f| f.response.contains('/')) {
        let message = format!("response `{}` holds a `/`, which a name in a result file cannot", own.response);
        return Err(StageError::new(message).hint("give the response another name").into());
    }
    let alpha = params.select_alpha.unwrap_or(SELECT_ALPHA);
    let settings = Settings {
        outlier_alpha: params.outlier_alpha,
        selection: params.select.map(|direction| Selection { direction, alpha }),
    };
    let mut found: Vec<(&Fitting, Regression)> = Vec::new();
    let mut with_constant: Vec<(&str, Beside)> = Vec::new();
    let mut faults: Vec<StageError> = Vec::new();
    let mut not_valid = NotValid::default();
    for fitting in &params.fittings {
        let table = runs(job.input(&fitting.input)?)?;
        let sample = fitting.columns.sample(table)?;
        let own = fitting.columns.not_valid(table)?;
        match regress(&sample, &fitting.response, &fitting.terms, &settings) {
            Ok(regression) => {
                let beside =
                    params.through_origin.then(|| Beside::of(&sample, &fitting.response, &fitting.terms, &settings));
                with_constant.extend(beside.flatten().map(|beside| (fitting.response.as_str(), beside)));
                found.push((fitting, regression));
            }
            Err(error) => faults.push(refused_without(error, &own)),
        }
        not_valid.append(own);
    }
    if !faults.is_empty() {
        let all: Vec<String> = faults.into_iter().map(|f| f.message).collect();
        return Err(StageError::new(all.join("\n")).into());
    }
    let fits: Vec<&Fit> = found.iter().map(|(_, r)| &r.fit).collect();
    let mut natural = coefficient_table(&found, |r| &r.natural);
    let mut fit = fit_table(&fits);
    if let Some(prints) = prints(job, "term", "estimate")? {
        let plain = |response, line, value| Computed { response, line, value: Some(value), rounding: 0.0, remark: "" };
        let own = |(f, c): (&'_ Fitting, &'_ Coefficient)| (f.response.clone(), c.term.clone(), c.estimate);
        let values: Vec<(String, String, f64)> =
            found.iter().flat_map(|(f, r)| r.natural.iter().map(move |c| own((*f, c)))).collect();
        let computed: Vec<Computed> = values.iter().map(|(r, t, v)| plain(r, t, *v)).collect();
        let (published, remark) = beside(&prints, &computed);
        (natural.published, natural.remark) = (Some(published), Some(remark));
        let computed: Vec<Computed> = fits.iter().map(|f| plain(&f.response, "r2", f.r2)).collect();
        let (published, remark) = beside(&prints, &computed);
        (fit.published, fit.remark) = (Some(published), Some(remark));
    }
    let residuals = found.iter().map(|(f, r)| (f.response.as_str(), r.residuals.as_slice()));
    let (stationary, axes) = stationary_tables(&found);
    let surfaces = Surfaces {
        coefficients: natural,
        coded: coefficient_table(&found, |r| &r.coded),
        fit,
        residuals: residual_table(residuals),
        stationary,
        axes,
        path: predict::path_table(&found),
        domain: domain_table(&found),
        selection: selection_table(&found),
        notes: notes(&found, params.predict.as_ref(), &not_valid).table(),
        models: found.iter().map(|(f, r)| (f.response.clone(), keep::stored(&r.model))).collect(),
        with_constant: params.through_origin.then(|| constant_table(&with_constant)),
        predictions: params.predict.as_ref().map(|points| predict::prediction_table(&found, points)),
        not_valid: not_valid.some(),
    };
    Ok(surfaces.to_artifact())
}

/// Notes on what a reader must know first.
fn notes<'a>(found: &[(&Fitting, Regression)], points: Option<&Predict>, not_valid: &'a NotValid) -> Notes<'a> {
    let mut notes = Notes::of(not_valid);
    for (fitting, regression) in found {
        let response = fitting.response.as_str();
        notes.fit(&regression.fit);
        notes.one_level(response, "", &regression.model.axes);
        for (factor, reference) in fitting.columns.categories() {
            let text = format!(
                "`{factor}` has names for levels and enters by dummy coding: `{factor}[…]` is the difference from `{reference}`"
            );
            notes.add(response, text);
        }
        let axes = &regression.model.axes;
        for factor in fitting.columns.logarithmic().filter(|own| axes.iter().any(|axis| axis.name == *own)) {
            let unit = fitting.columns.unit_of(factor);
            let value = if unit.is_empty() { factor.to_owned() } else { format!("{factor} in {unit}") };
            notes.add(
                response,
                format!("`{factor}` has a logarithmic scale: its terms are of the logarithm, ln({value})"),
            );
        }
        notes.residuals(response, &regression.residuals);
        notes.inflation(response, if regression.coded.is_empty() { &regression.natural } else { &regression.coded });
        if let Some(place) = canonical(&regression.model).filter(|place| !place.inside) {
            let nature = place.nature.word();
            notes.add(
                response,
                format!("the stationary point ({nature}) lies outside the domain, where nothing was run"),
            );
        }
    }
    if let Some(points) = points {
        predict::extrapolations(found, points, &mut notes);
    }
    notes
}

fn coefficient_table(
    found: &[(&Fitting, Regression)],
    list: impl Fn(&Regression) -> &Vec<Coefficient>,
) -> Coefficients {
    let all: Vec<(&str, &Coefficient)> =
        found.iter().flat_map(|(f, r)| list(r).iter().map(|c| (f.response.as_str(), c))).collect();
    let rows = Rows(&all);
    Coefficients {
        response: rows.texts(|(response, _)| *response),
        term: rows.texts(|(_, c)| c.term.as_str()),
        estimate: rows.reals(|(_, c)| Some(c.estimate)),
        std_error: rows.reals(|(_, c)| c.std_error),
        t: rows.reals(|(_, c)| c.t),
        p: rows.reals(|(_, c)| c.p),
        vif: rows.reals(|(_, c)| c.vif),
        published: None,
        remark: None,
    }
}

/// The same terms with a constant, for fits through the origin.
fn constant_table(found: &[(&str, Beside)]) -> WithConstant {
    let all: Vec<(&str, f64, &Coefficient)> = found
        .iter()
        .flat_map(|(response, b)| std::iter::once(&b.constant).chain(&b.rest).map(|c| (*response, b.r2, c)))
        .collect();
    let rows = Rows(&all);
    WithConstant {
        response: rows.texts(|(response, ..)| *response),
        term: rows.texts(|(.., c)| c.term.as_str()),
        estimate: rows.reals(|(.., c)| Some(c.estimate)),
        std_error: rows.reals(|(.., c)| c.std_error),
        t: rows.reals(|(.., c)| c.t),
        p: rows.reals(|(.., c)| c.p),
        r2: rows.reals(|(_, r2, _)| Some(*r2)),
    }
}

/// Quality of fits, one row each.
pub(super) fn fit_table(fits: &[&Fit]) -> Fits {
    let rows = Rows(fits);
    let through_origin = fits.iter().any(|f| !f.constant);
    let about = |f: &&Fit| if f.constant { "with a constant" } else { "through the origin: r2 about zero" };
    Fits {
        response: rows.texts(|f| f.response.as_str()),
        n: rows.ints(|f| f.n),
        missing: rows.ints(|f| f.missing),
        df_residual: rows.ints(|f| f.df_residual),
        s: rows.reals(|f| f.s),
        r2: rows.reals(|f| Some(f.r2)),
        r2_adjusted: rows.reals(|f| f.r2_adjusted),
        r2_predicted: rows.reals(|f| f.r2_predicted),
        press: rows.reals(|f| f.press),
        f: rows.reals(|f| f.f),
        p: rows.reals(|f| f.p),
        df_pure_error: rows.ints(|f| f.df_pure_error),
        lack_of_fit_f: rows.reals(|f| f.lack_of_fit_f),
        lack_of_fit_p: rows.reals(|f| f.lack_of_fit_p),
        model: through_origin.then(|| rows.texts(about)),
        r2_about_mean: through_origin.then(|| rows.reals(|f| f.r2_about_mean)),
        pooled: None,
        not_estimable: None,
        published: None,
        remark: None,
    }
}

/// The residuals of every model, row by row.
pub(super) fn residual_table<'a>(found: impl Iterator<Item = (&'a str, &'a [Residual])>) -> Residuals {
    let all: Vec<(&str, &Residual)> = found.flat_map(|(name, list)| list.iter().map(move |r| (name, r))).collect();
    let rows = Rows(&all);
    let flag = |(_, r): &(&str, &Residual)| {
        let flags = [(r.outlier, "outlier"), (r.high_leverage, "high leverage"), (r.influential, "influential")];
        flags.into_iter().filter(|(set, _)| *set).map(|(_, word)| word).collect::<Vec<_>>().join(", ")
    };
    Residuals {
        response: rows.texts(|(response, _)| *response),
        row: rows.ints(|(_, r)| r.row),
        observed: rows.reals(|(_, r)| Some(r.observed)),
        fitted: rows.reals(|(_, r)| Some(r.fitted)),
        residual: rows.reals(|(_, r)| Some(r.residual)),
        leverage: rows.reals(|(_, r)| Some(r.leverage)),
        standardized: rows.reals(|(_, r)| r.standardized),
        studentized: rows.reals(|(_, r)| r.studentized),
        cook: rows.reals(|(_, r)| r.cook),
        flag: rows.texts(flag),
    }
}

/// Stationary points factor by factor, and the principal axes of the surfaces.
fn stationary_tables(found: &[(&Fitting, Regression)]) -> (Stationary, PrincipalAxes) {
    let places: Vec<_> = found.iter().filter_map(|(f, r)| Some((f.response.as_str(), canonical(&r.model)?))).collect();
    let points: Vec<_> = places.iter().flat_map(|place| (0..place.1.factors.len()).map(move |i| (place, i))).collect();
    let rows = Rows(&points);
    let stationary = Stationary {
        response: rows.texts(|(place, _)| place.0),
        nature: rows.texts(|(place, _)| place.1.nature.word()),
        value: rows.reals(|(place, _)| Some(place.1.value)),
        domain: rows.texts(|(place, _)| if place.1.inside { "inside" } else { "outside" }),
        factor: rows.texts(|(place, i)| place.1.factors[*i].as_str()),
        natural: rows.reals(|(place, i)| Some(place.1.natural[*i])),
        coded: rows.reals(|(place, i)| Some(place.1.coded[*i])),
    };
    let parts: Vec<_> = places
        .iter()
        .flat_map(|place| place.1.axes.iter().enumerate().map(move |(k, axis)| (place, k, axis)))
        .flat_map(|(place, k, axis)| (0..axis.direction.len()).map(move |i| (place, k, axis, i)))
        .collect();
    let rows = Rows(&parts);
    let axes = PrincipalAxes {
        response: rows.texts(|(place, ..)| place.0),
        axis: rows.ints(|(_, k, ..)| k + 1),
        eigenvalue: rows.reals(|(_, _, axis, _)| Some(axis.eigenvalue)),
        factor: rows.texts(|(place, _, _, i)| place.1.factors[*i].as_str()),
        direction: rows.reals(|(_, _, axis, i)| Some(axis.direction[*i])),
    };
    (stationary, axes)
}

/// The domain of each model: its factors' ranges in the data. A point beyond it is an extrapolation.
fn domain_table(found: &[(&Fitting, Regression)]) -> Domains {
    let all: Vec<_> = found.iter().flat_map(|(f, r)| r.model.axes.iter().map(move |axis| (f, axis))).collect();
    let rows = Rows(&all);
    Domains {
        response: rows.texts(|(f, _)| f.response.as_str()),
        factor: rows.texts(|(_, axis)| axis.name.as_str()),
        unit: rows.texts(|(f, axis)| f.columns.unit_of(&axis.name)),
        low: rows.reals(|(_, axis)| Some(axis.low)),
        high: rows.reals(|(_, axis)| Some(axis.high)),
        scale: keep::scales(&all.iter().map(|(_, axis)| *axis).collect::<Vec<_>>()),
    }
}

fn selection_table(found: &[(&Fitting, Regression)]) -> Selections {
    let all: Vec<_> = found.iter().flat_map(|(f, r)| r.steps.iter().map(move |step| (f, step))).collect();
    let rows = Rows(&all);
    Selections {
        response: rows.texts(|(f, _)| f.response.as_str()),
        term: rows.texts(|(_, step)| step.term.as_str()),
        step: rows.texts(|(_, step)| if step.added { "added" } else { "removed" }),
        p: rows.reals(|(_, step)| Some(step.p)),
    }
}

/// The terms with the constant in front.
pub(super) fn with_constant(terms: &[Term]) -> Vec<Term> {
    let rest = terms.iter().filter(|t| t.degree() > 0).cloned();
    std::iter::once(Term::constant()).chain(rest).collect()
}

/// The error of an artifact `surfaces` that cannot be read.
fn unreadable(what: &str) -> StageError {
    StageError::new(format!("the fitted models cannot be read: {what}"))
}
