//! One fit per group of rows: `by = ["R_min", "ratio"]`.
//!
//! The result is an artifact `groups`: table `groups`, one row per response, group and term, with the quality of the fit
//! and, for fits through the origin, the same terms with a constant; `residuals`; `notes`. A group whose rows do not
//! determine its model has a row with the reason. Later stages read `groups` as a table of runs.

use super::super::columns::{Rows, refused, runs};
use super::super::fitted::Fitting;
use super::super::notes::Notes;
use super::super::{Failure, Job, StageError};
use crate::artifact::groups::{GroupFits, GroupResiduals, Groups};
use crate::artifact::validity::NotValid;
use crate::artifact::{Artifact, Column, Table, Values};
use crate::stage::fitted::origin::Beside;
use math::distribution::t_for_coverage;
use serde::{Deserialize, Serialize};
use stats::diagnostics::Residual;
use stats::groups::{Grouped, groups};
use stats::regression::{Coefficient, Regression, Settings, regress};
use stats::sample::Sample;

/// Parameters of the task: everything that decides fits by groups.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Params {
    pub fittings: Vec<Fitting>,
    /// Columns by which rows are grouped.
    pub by: Vec<String>,
    pub through_origin: bool,
    pub outlier_alpha: f64,
    /// Coverage of the intervals of the coefficients.
    pub confidence: f64,
}

/// A column by which rows are grouped.
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
    /// Number of runs of the group that have no value or were left out.
    missing: usize,
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
    let (mut found, mut not_valid) = (Vec::new(), NotValid::default());
    for fitting in &params.fittings {
        let sample = fitting.columns.sample(table)?;
        not_valid.append(fitting.columns.not_valid(table)?);
        for group in &all {
            let own = sample.with_rows(&group.rows);
            let fit = one(&own, fitting, &params);
            found.push(Found {
                response: &fitting.response,
                group: group.clone(),
                missing: missing(&own, &fitting.response),
                fit,
            });
        }
    }
    let stored = Groups {
        groups: group_table(&found, &by, &params),
        residuals: residual_table(&found, &by),
        notes: notes(&found, &by, &params.fittings, &not_valid).table(),
        not_valid: not_valid.some(),
    };
    Ok(stored.to_artifact())
}

fn by_column<'a>(table: &'a Table, name: &str) -> Result<By<'a>, StageError> {
    let column = table.column(name).ok_or_else(|| {
        let there = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
        StageError::new(format!("the table has no column `{name}` to group by")).hint(format!("it has {there}"))
    })?;
    let (values, labels) = match &column.values {
        Values::Texts(texts) => {
            let mut labels: Vec<String> = texts.iter().filter(|text| !text.is_empty()).cloned().collect();
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

/// Rows in which the response has no value.
fn missing(sample: &Sample, response: &str) -> usize {
    let own = sample.responses.iter().find(|own| own.name == response);
    own.map_or(0, |own| own.values.iter().filter(|value| value.is_none()).count())
}

/// The values of a group as texts.
fn key_texts(by: &[By], group: &Grouped) -> Vec<String> {
    let text = |(by, value): (&By, &f64)| {
        let name = by.labels.get(*value as usize).cloned().unwrap_or_else(|| value.to_string());
        format!("{} {name}", by.name)
    };
    by.iter().zip(&group.key).map(text).collect()
}

/// Adds the columns of the groups, after the column of the response.
fn with_key<R>(mut table: Table, by: &[By], rows: &[R], group: impl Fn(&R) -> &Grouped) -> Table {
    let column = |(k, by): (usize, &By)| {
        let values = rows.iter().map(|row| group(row).key[k]);
        let (unit, values) = if by.labels.is_empty() {
            (by.unit, Values::Reals(values.collect()))
        } else {
            let name = |v: f64| by.labels.get(v as usize).cloned().unwrap_or_default();
            ("", Values::Texts(values.map(name).collect()))
        };
        let about = "what the group shares".to_owned();
        Column { name: by.name.to_owned(), unit: unit.to_owned(), about, values }
    };
    table.columns.splice(1..1, by.iter().enumerate().map(column));
    table
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
    let of = |pick: fn(&Regression, &Coefficient) -> Option<f64>| {
        rows.reals(|Line(_, fit)| fit.and_then(|(fit, c, _)| pick(fit, c)))
    };
    let reach = |fit: &Regression, c: &Coefficient| {
        Some(t_for_coverage(params.confidence, fit.fit.df_residual as f64) * c.std_error?)
    };
    let end =
        |sign: f64| rows.reals(|Line(_, fit)| fit.and_then(|(fit, c, _)| Some(c.estimate + sign * reach(fit, c)?)));
    // only fits through the origin are compared with the same terms and a constant
    let beside = |pick: fn(&Beside, &str) -> Option<f64>| {
        let value = |Line(_, fit): &Line| fit.and_then(|(_, c, beside)| pick(beside?, &c.term));
        params.through_origin.then(|| rows.reals(value))
    };
    let fits = GroupFits {
        response: rows.texts(|l| l.0.response),
        term: rows.texts(|Line(_, fit)| fit.map_or("", |(_, c, _)| c.term.as_str())),
        estimate: of(|_, c| Some(c.estimate)),
        std_error: of(|_, c| c.std_error),
        low: end(-1.0),
        high: end(1.0),
        t: of(|_, c| c.t),
        p: of(|_, c| c.p),
        n: rows.ints(|Line(_, fit)| fit.map_or(0, |(fit, ..)| fit.fit.n)),
        missing: rows.ints(|l| l.0.missing),
        s: of(|fit, _| fit.fit.s),
        r2: of(|fit, _| Some(fit.fit.r2)),
        r2_about_mean: params.through_origin.then(|| of(|fit, _| fit.fit.r2_about_mean)),
        constant: beside(|b, _| Some(b.constant.estimate)),
        constant_std_error: beside(|b, _| b.constant.std_error),
        beside_constant: beside(|b, term| b.estimate(term)),
        r2_with_constant: beside(|b, _| Some(b.r2)),
        failure: rows.texts(|Line(found, _)| found.fit.as_ref().err().cloned().unwrap_or_default()),
    };
    with_key(fits.to_table(), by, &lines, |l| &l.0.group)
}

fn residual_table(found: &[Found], by: &[By]) -> Table {
    let all: Vec<(&Found, &Residual)> = found
        .iter()
        .flat_map(|f| f.fit.iter().flat_map(move |(fit, _)| fit.residuals.iter().map(move |r| (f, r))))
        .collect();
    let rows = Rows(&all);
    let residuals = GroupResiduals {
        response: rows.texts(|(f, _)| f.response),
        row: rows.ints(|(found, r)| found.group.rows.get(r.row - 1).map_or(0, |row| row + 1)),
        observed: rows.reals(|(_, r)| Some(r.observed)),
        fitted: rows.reals(|(_, r)| Some(r.fitted)),
        residual: rows.reals(|(_, r)| Some(r.residual)),
        leverage: rows.reals(|(_, r)| Some(r.leverage)),
        studentized: rows.reals(|(_, r)| r.studentized),
        flag: rows.texts(|(_, r)| if r.outlier { "outlier" } else { "" }),
    };
    with_key(residuals.to_table(), by, &all, |(f, _)| &f.group)
}

fn notes<'a>(found: &[Found], by: &[By], fittings: &[Fitting], not_valid: &'a NotValid) -> Notes<'a> {
    let mut notes = Notes::of(not_valid);
    for (fitting, by) in fittings.iter().flat_map(|fitting| by.iter().map(move |by| (fitting, by))) {
        let without = by.values.iter().filter(|value| value.is_nan()).count();
        if without > 0 {
            let (all, name) = (by.values.len(), by.name);
            notes.add(&fitting.response, format!("{without} of {all} runs have no `{name}`, so they are in no group"));
        }
    }
    let failed: Vec<&Found> = found.iter().filter(|f| f.fit.is_err()).collect();
    for found in &failed {
        let why = found.fit.as_ref().err().cloned().unwrap_or_default();
        notes.add(found.response, format!("{}: no fit: {why}", key_texts(by, &found.group).join(", ")));
    }
    for found in found {
        if let Ok((fit, _)) = &found.fit {
            notes.one_level(found.response, &format!("{}: ", key_texts(by, &found.group).join(", ")), &fit.model.axes);
        }
        let missing = found.missing;
        if missing > 0 {
            let group = key_texts(by, &found.group).join(", ");
            notes.add(
                found.response,
                format!("{group}: {missing} of {} runs have no value or are left out", found.group.rows.len()),
            );
        }
    }
    notes
}
