//! One fit per group of rows: `by = ["R_min", "ratio"]`.
//!
//! The result is an artifact `groups`: table `groups`, one row per response, group and term, with the quality of the fit
//! beside it and, for fits through the origin, the same terms with a constant; `residuals`; `notes`. A group that does not
//! support its model has a row that says why. Later stages read `groups` as a table of runs.

use super::super::columns::{Rows, refused, runs};
use super::super::fitted::Fitting;
use super::super::notes::Notes;
use super::super::{Failure, Job, StageError};
use super::origin::Beside;
use crate::artifact::{Artifact, ArtifactKind, Group, Node, Table, Values};
use math::distribution::t_for_coverage;
use serde::{Deserialize, Serialize};
use stats::diagnostics::Residual;
use stats::groups::{Grouped, groups};
use stats::regression::{Coefficient, Regression, Settings, regress};
use stats::sample::Sample;

/// Fits by groups.
pub(super) const GROUPS: ArtifactKind = ArtifactKind::new("groups", 1).main("groups");

/// Everything that decides fits by groups.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub fittings: Vec<Fitting>,
    /// Columns whose equal values make a group.
    pub by: Vec<String>,
    pub through_origin: bool,
    pub outlier_alpha: f64,
    /// Coverage of the intervals of the coefficients.
    pub confidence: f64,
}

/// A column that groups are made by.
struct By<'a> {
    name: &'a str,
    unit: &'a str,
    values: Vec<f64>,
    /// Names of the values 0, 1, 2 … of a column of words.
    labels: Vec<String>,
}

/// The fit of one group, or why there is none.
struct Found<'a> {
    response: &'a str,
    group: Grouped,
    fit: Result<(Regression, Option<Beside>), String>,
}

/// One row of the table: a group and a coefficient, or a group without a fit.
struct Line<'a>(&'a Found<'a>, Option<(&'a Regression, &'a Coefficient, Option<&'a Beside>)>);

pub(super) fn fit(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let table = runs(job.input("table")?)?;
    let by = params.by.iter().map(|name| by_column(table, name)).collect::<Result<Vec<By>, StageError>>()?;
    let columns: Vec<&[f64]> = by.iter().map(|b| b.values.as_slice()).collect();
    let all = groups(&columns);
    let mut found = Vec::new();
    for fitting in &params.fittings {
        let sample = fitting.columns.sample(table)?;
        for group in &all {
            let fit = one(&sample.with_rows(&group.rows), fitting, &params);
            found.push(Found { response: &fitting.response, group: group.clone(), fit });
        }
    }
    let root = Group::new()
        .with("groups", Node::Table(group_table(&found, &by, &params)))
        .with("residuals", Node::Table(residual_table(&found, &by)))
        .with("notes", Node::Table(notes(&found, &by).table()));
    Ok(Artifact::of(GROUPS, root))
}

fn by_column<'a>(table: &'a Table, name: &str) -> Result<By<'a>, StageError> {
    let column = table.column(name).ok_or_else(|| {
        let there = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
        StageError::new(format!("the table has no column `{name}` to group by")).hint(format!("it has {there}"))
    })?;
    let (values, labels) = match &column.values {
        Values::Texts(texts) => {
            let mut labels = texts.clone();
            labels.sort();
            labels.dedup();
            let place = |text: &String| labels.iter().position(|l| l == text).map_or(f64::NAN, |i| i as f64);
            (texts.iter().map(place).collect(), labels)
        }
        Values::Reals(values) => (values.clone(), Vec::new()),
        Values::Ints(values) => (values.iter().map(|&v| v as f64).collect(), Vec::new()),
    };
    Ok(By { name: &column.name, unit: &column.unit, values, labels })
}

fn one(sample: &Sample, fitting: &Fitting, params: &Params) -> Result<(Regression, Option<Beside>), String> {
    let settings = Settings { outlier_alpha: params.outlier_alpha, selection: None };
    let found = regress(sample, &fitting.response, &fitting.terms, &settings).map_err(|e| refused(e).message)?;
    let beside = params.through_origin.then(|| Beside::of(sample, &fitting.response, &fitting.terms, &settings));
    Ok((found, beside.flatten()))
}

/// The values that make a group, as texts.
fn key_texts(by: &[By], group: &Grouped) -> Vec<String> {
    let text = |(by, value): (&By, &f64)| {
        let name = by.labels.get(*value as usize).cloned().unwrap_or_else(|| value.to_string());
        format!("{} {name}", by.name)
    };
    by.iter().zip(&group.key).map(text).collect()
}

/// Adds the columns that groups were made by.
fn with_key<R>(table: Table, by: &[By], rows: &[R], group: impl Fn(&R) -> &Grouped) -> Table {
    by.iter().enumerate().fold(table, |table, (k, by)| {
        let values = rows.iter().map(|row| group(row).key[k]);
        if by.labels.is_empty() {
            return table.reals_column(by.name, by.unit, "what the group shares", values.collect());
        }
        let names = values.map(|v| by.labels.get(v as usize).cloned().unwrap_or_default());
        table.texts_column(by.name, "what the group shares", names.collect())
    })
}

fn group_table(found: &[Found], by: &[By], params: &Params) -> Table {
    let lines: Vec<Line> = found
        .iter()
        .flat_map(|f| match &f.fit {
            Ok((fit, beside)) => fit.natural.iter().map(|c| Line(f, Some((fit, c, beside.as_ref())))).collect(),
            Err(_) => vec![Line(f, None)],
        })
        .collect();
    let rows = Rows(&lines);
    let table = Table { about: "coefficients of one fit per group".to_owned(), columns: Vec::new() };
    let table = with_key(table.texts_column("response", "", rows.texts(|l| l.0.response)), by, &lines, |l| &l.0.group);
    let of = |pick: fn(&Regression, &Coefficient) -> Option<f64>| {
        rows.reals(|Line(_, fit)| fit.and_then(|(fit, c, _)| pick(fit, c)))
    };
    let reach = |fit: &Regression, c: &Coefficient| {
        Some(t_for_coverage(params.confidence, fit.fit.df_residual as f64) * c.std_error?)
    };
    let end =
        |sign: f64| rows.reals(|Line(_, fit)| fit.and_then(|(fit, c, _)| Some(c.estimate + sign * reach(fit, c)?)));
    let failure = |Line(found, _): &Line| found.fit.as_ref().err().cloned().unwrap_or_default();
    let table = table
        .texts_column("term", "", rows.texts(|Line(_, fit)| fit.map_or("", |(_, c, _)| c.term.as_str())))
        .reals_column("estimate", "", "unit of the response per unit of the term", of(|_, c| Some(c.estimate)))
        .reals_column("std_error", "", "standard error", of(|_, c| c.std_error))
        .reals_column("low", "", "lower end of its confidence interval", end(-1.0))
        .reals_column("high", "", "upper end of its confidence interval", end(1.0))
        .reals_column("t", "", "estimate over standard error", of(|_, c| c.t))
        .reals_column("p", "", "probability of such a t by chance", of(|_, c| c.p))
        .ints_column("n", "runs used", rows.ints(|Line(_, fit)| fit.map_or(0, |(fit, ..)| fit.fit.n)))
        .ints_column("missing", "runs without a value", rows.ints(|Line(_, fit)| fit.map_or(0, |f| f.0.fit.missing)))
        .reals_column("s", "", "residual standard deviation", of(|fit, _| fit.fit.s))
        .reals_column("r2", "", params.r2_about(), of(|fit, _| Some(fit.fit.r2)));
    let table = if params.through_origin {
        let beside = |pick: fn(&Beside, &str) -> Option<f64>| {
            rows.reals(|Line(_, fit)| fit.and_then(|(_, c, beside)| pick(beside?, &c.term)))
        };
        table
            .reals_column("r2_about_mean", "", "1 - SSE over squares about the mean", of(|f, _| f.fit.r2_about_mean))
            .reals_column("constant", "", "of the same terms with a constant", beside(|b, _| Some(b.constant.estimate)))
            .reals_column("constant_std_error", "", "its standard error", beside(|b, _| b.constant.std_error))
            .reals_column("beside_constant", "", "this estimate with a constant", beside(|b, t| b.estimate(t)))
            .reals_column("r2_with_constant", "", "about the mean", beside(|b, _| Some(b.r2)))
    } else {
        table
    };
    table.texts_column("failure", "why the group has no fit", rows.texts(failure))
}

impl Params {
    fn r2_about(&self) -> &'static str {
        if self.through_origin { "through the origin: share of the squares about zero" } else { "about the mean" }
    }
}

fn residual_table(found: &[Found], by: &[By]) -> Table {
    let residuals = |f: &'_ &'_ Found| f.fit.as_ref().map_or(&[][..], |(fit, _)| fit.residuals.as_slice()).len();
    let all: Vec<(&Found, &Residual)> = found
        .iter()
        .filter(|f| residuals(f) > 0)
        .flat_map(|f| f.fit.iter().flat_map(move |(fit, _)| fit.residuals.iter().map(move |r| (f, r))))
        .collect();
    let rows = Rows(&all);
    let row = |(found, r): &(&Found, &Residual)| found.group.rows.get(r.row - 1).map_or(0, |row| row + 1);
    let table = Table { about: "residuals; outliers are flagged, not dropped".to_owned(), columns: Vec::new() };
    let table = table.texts_column("response", "", rows.texts(|(f, _)| f.response));
    with_key(table, by, &all, |(f, _)| &f.group)
        .ints_column("row", "in the table of runs, counted from 1", rows.ints(row))
        .reals_column("observed", "", "as measured", rows.reals(|(_, r)| Some(r.observed)))
        .reals_column("fitted", "", "as the model says", rows.reals(|(_, r)| Some(r.fitted)))
        .reals_column("residual", "", "observed minus fitted", rows.reals(|(_, r)| Some(r.residual)))
        .reals_column("leverage", "", "diagonal of the hat matrix", rows.reals(|(_, r)| Some(r.leverage)))
        .reals_column("studentized", "", "externally studentized residual", rows.reals(|(_, r)| r.studentized))
        .texts_column("flag", "what is suspicious", rows.texts(|(_, r)| if r.outlier { "outlier" } else { "" }))
}

fn notes(found: &[Found], by: &[By]) -> Notes {
    let mut notes = Notes::default();
    let failed: Vec<&Found> = found.iter().filter(|f| f.fit.is_err()).collect();
    for found in &failed {
        let why = found.fit.as_ref().err().cloned().unwrap_or_default();
        notes.add(found.response, format!("{}: no fit: {why}", key_texts(by, &found.group).join(", ")));
    }
    for found in found {
        let missing = found.fit.as_ref().map_or(0, |(fit, _)| fit.fit.missing);
        if missing > 0 {
            let group = key_texts(by, &found.group).join(", ");
            notes.add(found.response, format!("{group}: {missing} of {} runs have no value", found.group.rows.len()));
        }
    }
    notes
}
