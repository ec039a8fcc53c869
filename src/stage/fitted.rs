//! Fitted models as artifacts: the tables that people read and what prediction needs, written once for `regression`
//! and `rsm`, and read back by every stage that predicts.

use super::columns::{Columns, Rows, refused, runs};
use super::notes::Notes;
use super::published::{Computed, beside, prints};
use super::regression::origin::Beside;
use super::{Failure, Job, StageError};
use crate::artifact::{Array, Artifact, ArtifactKind, Group, Node, Table, Values};
use serde::{Deserialize, Serialize};
use stats::canonical::canonical;
use stats::diagnostics::Residual;
use stats::fit::Fit;
use stats::regression::{Coefficient, Regression, Settings, regress};
use stats::selection::{Direction, Selection};
use stats::terms::Term;

mod keep;
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

/// Everything that decides fitted models.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub fittings: Vec<Fitting>,
    /// Every model is through the origin, and stands beside the same terms with a constant.
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

/// The level at which terms are selected when none is given.
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
    for fitting in &params.fittings {
        let sample = fitting.columns.sample(runs(job.input(&fitting.input)?)?)?;
        match regress(&sample, &fitting.response, &fitting.terms, &settings) {
            Ok(regression) => {
                let beside =
                    params.through_origin.then(|| Beside::of(&sample, &fitting.response, &fitting.terms, &settings));
                with_constant.extend(beside.flatten().map(|beside| (fitting.response.as_str(), beside)));
                found.push((fitting, regression));
            }
            Err(error) => faults.push(refused(error)),
        }
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
        natural = beside(natural, &prints, &computed);
        let computed: Vec<Computed> = fits.iter().map(|f| plain(&f.response, "r2", f.r2)).collect();
        fit = beside(fit, &prints, &computed);
    }
    let residuals = found.iter().map(|(f, r)| (f.response.as_str(), r.residuals.as_slice()));
    let (stationary, axes) = stationary_tables(&found);
    let mut root = Group::new()
        .with("coefficients", Node::Table(natural))
        .with("coded", Node::Table(coefficient_table(&found, |r| &r.coded)))
        .with("fit", Node::Table(fit))
        .with("residuals", Node::Table(residual_table(residuals)))
        .with("stationary", Node::Table(stationary))
        .with("axes", Node::Table(axes))
        .with("path", Node::Table(predict::path_table(&found)))
        .with("domain", Node::Table(domain_table(&found)))
        .with("selection", Node::Table(selection_table(&found)))
        .with("notes", Node::Table(notes(&found, params.predict.as_ref()).table()))
        .with("models", Node::Group(keep::kept(found.iter().map(|(f, r)| (f.response.as_str(), &r.model)))));
    if params.through_origin {
        root.put("with_constant", Node::Table(constant_table(&with_constant)));
    }
    if let Some(points) = &params.predict {
        root.put("predictions", Node::Table(predict::prediction_table(&found, points)));
    }
    Ok(Artifact::of(ArtifactKind::SURFACES, root))
}

/// What a person should see at once.
fn notes(found: &[(&Fitting, Regression)], points: Option<&Predict>) -> Notes {
    let mut notes = Notes::default();
    for (fitting, regression) in found {
        let response = fitting.response.as_str();
        notes.fit(&regression.fit);
        for (factor, reference) in fitting.columns.categories() {
            let text = format!(
                "`{factor}` has names for levels and enters by dummy coding: `{factor}[…]` is the difference from `{reference}`"
            );
            notes.add(response, text);
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

fn named(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
}

fn coefficient_table(found: &[(&Fitting, Regression)], list: impl Fn(&Regression) -> &Vec<Coefficient>) -> Table {
    let all: Vec<(&str, &Coefficient)> =
        found.iter().flat_map(|(f, r)| list(r).iter().map(|c| (f.response.as_str(), c))).collect();
    let rows = Rows(&all);
    named("coefficients of the fitted models")
        .texts_column("response", "", rows.texts(|(response, _)| *response))
        .texts_column("term", "", rows.texts(|(_, c)| c.term.as_str()))
        .reals_column(
            "estimate",
            "",
            "unit of the response per unit of the term",
            rows.reals(|(_, c)| Some(c.estimate)),
        )
        .reals_column("std_error", "", "standard error", rows.reals(|(_, c)| c.std_error))
        .reals_column("t", "", "estimate over standard error", rows.reals(|(_, c)| c.t))
        .reals_column("p", "", "probability of such a t by chance", rows.reals(|(_, c)| c.p))
        .reals_column("vif", "", "variance inflation factor", rows.reals(|(_, c)| c.vif))
}

/// The same terms with a constant, for fits through the origin.
fn constant_table(found: &[(&str, Beside)]) -> Table {
    let all: Vec<(&str, f64, &Coefficient)> = found
        .iter()
        .flat_map(|(response, b)| std::iter::once(&b.constant).chain(&b.rest).map(|c| (*response, b.r2, c)))
        .collect();
    let rows = Rows(&all);
    named("the same terms with a constant: whether the data point to the origin")
        .texts_column("response", "", rows.texts(|(response, ..)| *response))
        .texts_column("term", "", rows.texts(|(.., c)| c.term.as_str()))
        .reals_column(
            "estimate",
            "",
            "unit of the response per unit of the term",
            rows.reals(|(.., c)| Some(c.estimate)),
        )
        .reals_column("std_error", "", "standard error", rows.reals(|(.., c)| c.std_error))
        .reals_column("t", "", "estimate over standard error", rows.reals(|(.., c)| c.t))
        .reals_column("p", "", "probability of such a t by chance", rows.reals(|(.., c)| c.p))
        .reals_column("r2", "", "about the mean", rows.reals(|(_, r2, _)| Some(*r2)))
}

/// Quality of fits, one row each.
pub(super) fn fit_table(fits: &[&Fit]) -> Table {
    let rows = Rows(fits);
    let table = named("quality of the fits")
        .texts_column("response", "", rows.texts(|f| f.response.as_str()))
        .ints_column("n", "runs used", rows.ints(|f| f.n))
        .ints_column("missing", "runs without a value", rows.ints(|f| f.missing))
        .ints_column("df_residual", "residual degrees of freedom", rows.ints(|f| f.df_residual))
        .reals_column("s", "", "residual standard deviation, unit of the response", rows.reals(|f| f.s))
        .reals_column("r2", "", "coefficient of determination", rows.reals(|f| Some(f.r2)))
        .reals_column("r2_adjusted", "", "adjusted for degrees of freedom", rows.reals(|f| f.r2_adjusted))
        .reals_column("r2_predicted", "", "1 - PRESS/SST", rows.reals(|f| f.r2_predicted))
        .reals_column("press", "", "sum of squared leave-one-out residuals", rows.reals(|f| f.press))
        .reals_column("f", "", "F of the whole model", rows.reals(|f| f.f))
        .reals_column("p", "", "probability of such an F by chance", rows.reals(|f| f.p))
        .ints_column("df_pure_error", "degrees of freedom of replicates", rows.ints(|f| f.df_pure_error))
        .reals_column("lack_of_fit_f", "", "lack of fit against pure error", rows.reals(|f| f.lack_of_fit_f))
        .reals_column("lack_of_fit_p", "", "probability of such an F by chance", rows.reals(|f| f.lack_of_fit_p));
    if fits.iter().all(|f| f.constant) {
        return table;
    }
    let about = |f: &&Fit| if f.constant { "with a constant" } else { "through the origin: r2 about zero" };
    table.texts_column("model", "what r2 is a share of", rows.texts(about)).reals_column(
        "r2_about_mean",
        "",
        "1 - SSE over squares about the mean",
        rows.reals(|f| f.r2_about_mean),
    )
}

/// Every row seen by every model.
pub(super) fn residual_table<'a>(found: impl Iterator<Item = (&'a str, &'a [Residual])>) -> Table {
    let all: Vec<(&str, &Residual)> = found.flat_map(|(name, list)| list.iter().map(move |r| (name, r))).collect();
    let rows = Rows(&all);
    let flag = |(_, r): &(&str, &Residual)| {
        let flags = [(r.outlier, "outlier"), (r.high_leverage, "high leverage"), (r.influential, "influential")];
        flags.into_iter().filter(|(set, _)| *set).map(|(_, word)| word).collect::<Vec<_>>().join(", ")
    };
    named("residuals; outliers are flagged, not dropped")
        .texts_column("response", "", rows.texts(|(response, _)| *response))
        .ints_column("row", "counted from 1", rows.ints(|(_, r)| r.row))
        .reals_column("observed", "", "as measured", rows.reals(|(_, r)| Some(r.observed)))
        .reals_column("fitted", "", "as the model says", rows.reals(|(_, r)| Some(r.fitted)))
        .reals_column("residual", "", "observed minus fitted", rows.reals(|(_, r)| Some(r.residual)))
        .reals_column("leverage", "", "diagonal of the hat matrix", rows.reals(|(_, r)| Some(r.leverage)))
        .reals_column("standardized", "", "internally studentized residual", rows.reals(|(_, r)| r.standardized))
        .reals_column("studentized", "", "externally studentized residual", rows.reals(|(_, r)| r.studentized))
        .reals_column("cook", "", "Cook's distance", rows.reals(|(_, r)| r.cook))
        .texts_column("flag", "what is suspicious", rows.texts(flag))
}

/// Stationary points factor by factor, and the principal axes of the surfaces.
fn stationary_tables(found: &[(&Fitting, Regression)]) -> (Table, Table) {
    let places: Vec<_> = found.iter().filter_map(|(f, r)| Some((f.response.as_str(), canonical(&r.model)?))).collect();
    let points: Vec<_> = places.iter().flat_map(|place| (0..place.1.factors.len()).map(move |i| (place, i))).collect();
    let rows = Rows(&points);
    let stationary = named("stationary points of the second-order surfaces")
        .texts_column("response", "", rows.texts(|(place, _)| place.0))
        .texts_column("nature", "", rows.texts(|(place, _)| place.1.nature.word()))
        .reals_column("value", "", "the surface there", rows.reals(|(place, _)| Some(place.1.value)))
        .texts_column(
            "domain",
            "whether it lies among the runs",
            rows.texts(|(place, _)| if place.1.inside { "inside" } else { "outside" }),
        )
        .texts_column("factor", "", rows.texts(|(place, i)| place.1.factors[*i].as_str()))
        .reals_column("natural", "", "in the factor's unit", rows.reals(|(place, i)| Some(place.1.natural[*i])))
        .reals_column("coded", "", "in coded units", rows.reals(|(place, i)| Some(place.1.coded[*i])));
    let parts: Vec<_> = places
        .iter()
        .flat_map(|place| place.1.axes.iter().enumerate().map(move |(k, axis)| (place, k, axis)))
        .flat_map(|(place, k, axis)| (0..axis.direction.len()).map(move |i| (place, k, axis, i)))
        .collect();
    let rows = Rows(&parts);
    let axes = named("principal axes of the second-order surfaces, in coded units")
        .texts_column("response", "", rows.texts(|(place, ..)| place.0))
        .ints_column("axis", "by falling eigenvalue", rows.ints(|(_, k, ..)| k + 1))
        .reals_column("eigenvalue", "", "curvature along the axis", rows.reals(|(_, _, axis, _)| Some(axis.eigenvalue)))
        .texts_column("factor", "", rows.texts(|(place, _, _, i)| place.1.factors[*i].as_str()))
        .reals_column(
            "direction",
            "",
            "component along the factor",
            rows.reals(|(_, _, axis, i)| Some(axis.direction[*i])),
        );
    (stationary, axes)
}

/// Where each model was seen: beyond it lies extrapolation.
fn domain_table(found: &[(&Fitting, Regression)]) -> Table {
    let all: Vec<_> = found.iter().flat_map(|(f, r)| r.model.axes.iter().map(move |axis| (f, axis))).collect();
    let rows = Rows(&all);
    named("domain of the models; predictions outside it are extrapolation")
        .texts_column("response", "", rows.texts(|(f, _)| f.response.as_str()))
        .texts_column("factor", "", rows.texts(|(_, axis)| axis.name.as_str()))
        .texts_column("unit", "", rows.texts(|(f, axis)| f.columns.unit_of(&axis.name)))
        .reals_column("low", "", "least value fitted", rows.reals(|(_, axis)| Some(axis.low)))
        .reals_column("high", "", "greatest value fitted", rows.reals(|(_, axis)| Some(axis.high)))
}

fn selection_table(found: &[(&Fitting, Regression)]) -> Table {
    let all: Vec<_> = found.iter().flat_map(|(f, r)| r.steps.iter().map(move |step| (f, step))).collect();
    let rows = Rows(&all);
    named("terms that selection added or removed, in order")
        .texts_column("response", "", rows.texts(|(f, _)| f.response.as_str()))
        .texts_column("term", "", rows.texts(|(_, step)| step.term.as_str()))
        .texts_column("step", "", rows.texts(|(_, step)| if step.added { "added" } else { "removed" }))
        .reals_column("p", "", "in the model that held it", rows.reals(|(_, step)| Some(step.p)))
}

/// An array of numbers without unit.
fn reals(values: Vec<f64>, shape: Vec<usize>, about: &str) -> Node {
    Node::Array(Array { shape, unit: String::new(), about: about.to_owned(), values: Values::Reals(values) })
}

/// The models that an artifact `surfaces` holds, or why it cannot be read.
fn unreadable(what: &str) -> StageError {
    StageError::new(format!("the fitted models cannot be read: {what}"))
}
