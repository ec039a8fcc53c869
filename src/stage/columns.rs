//! Converts a table of runs into a sample for statistics and back: shared by every stage of statistics.

use super::derived::Derived;
use super::invalid::Invalid;
use super::{Complaint, Context, Named, StageError, known_are};
use crate::artifact::groups::Groups;
use crate::artifact::results::Results;
use crate::artifact::validity::NotValid;
use crate::artifact::{Artifact, Table, Values};
use math::scale::Scale;
use serde::{Deserialize, Serialize};
use stats::error::Faults;
use stats::sample::{Factor, Response, Sample};
use std::collections::BTreeMap;

/// The columns of a table that are analysed, with their units.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Columns {
    factors: Vec<FactorColumn>,
    responses: Vec<ResponseColumn>,
    /// Formulas of factors that terms name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    derived: Vec<Derived>,
    /// Column with the number of replicates of which a row is the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    weights: Option<String>,
    /// What becomes of runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    invalid: Invalid,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct FactorColumn {
    name: String,
    unit: String,
    /// The values that are allowed; empty when every value is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    levels: Vec<f64>,
    /// Natural values of −1 and +1 in coded units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coding: Option<(f64, f64)>,
    /// Whether models use its logarithm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    log: bool,
    /// Names of the levels of a category.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    labels: Vec<String>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct ResponseColumn {
    name: String,
    unit: String,
}

/// A stage's choice of columns.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted<'a> {
    /// Factors, or formulas of factors; empty for all factors of the table.
    pub factors: &'a [String],
    /// Responses; empty for all of the table.
    pub responses: &'a [String],
    /// Column of weights.
    pub weights: Option<&'a str>,
    /// Whether factors are categories, so that every value must be a declared level.
    pub levels: bool,
    /// Whether factors with a logarithmic scale enter by their logarithms.
    pub scales: bool,
    /// What to do with runs that are not valid.
    pub invalid: Invalid,
}

/// The table `runs` of an artifact, or the table `groups` of fits by groups.
pub(super) fn runs(artifact: &Artifact) -> Result<&Table, StageError> {
    Ok(if artifact.is(Groups::KIND) { Groups::table(artifact)? } else { Results::table(artifact)? })
}

impl Columns {
    /// The chosen columns of `table`, in the table's order.
    pub(super) fn of(table: &Table, context: &Context, wanted: Wanted) -> Result<Self, StageError> {
        let present = |name: &&String| table.column(name).is_some();
        let known: Vec<&String> = table.columns.iter().map(|c| &c.name).collect();
        let unit_of = |name: &str| context.factors.get(name).map(|factor| factor.unit.clone());
        let formulas = wanted.factors.iter().filter(|name| !present(name) && !context.factors.contains_key(*name));
        let derived = formulas.map(|name| Derived::of(name, unit_of)).collect::<Result<Vec<_>, _>>()?;
        let is_derived = |name: &String| derived.iter().any(|d| d.name == *name);
        let parts = derived.iter().flat_map(|d| d.factors.iter().map(|(name, _)| name));
        let plain = wanted.factors.iter().filter(|name| !is_derived(name)).chain(wanted.responses);
        if let Some(name) = plain.chain(parts).find(|name| !present(name)) {
            let names = known.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(", ");
            return Err(StageError::new(format!("the table has no column `{name}`")).hint(format!("it has {names}")));
        }
        let takes = |list: &[String], name: &String| list.is_empty() || list.contains(name);
        for column in table.columns.iter().filter(|column| takes(wanted.factors, &column.name)) {
            let factor = context.factors.get(&column.name).filter(|factor| factor.names.is_empty());
            if let Some((row, word)) = factor.and_then(|_| first_word(&column.values)) {
                return Err(not_a_level(&column.name, row, word));
            }
        }
        let factor = |name: &&String| {
            let factor = context.factors.get(*name).filter(|_| takes(wanted.factors, name))?;
            let ends = factor
                .levels
                .iter()
                .copied()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| (low.min(level), high.max(level)));
            let coding = factor.range.map(|[low, high]| (low, high)).or((!factor.levels.is_empty()).then_some(ends));
            let seen = table.column(name).map(|column| labels(&column.values)).unwrap_or_default();
            // the order of the workflow, if it names the levels: the first is the reference of dummy coding
            let labels = if seen.is_empty() || factor.names.is_empty() { seen } else { factor.names.clone() };
            let is_number = labels.is_empty();
            Some(FactorColumn {
                name: (*name).clone(),
                unit: factor.unit.clone(),
                levels: if wanted.levels && is_number { factor.levels.clone() } else { Vec::new() },
                coding: coding.filter(|_| !wanted.levels && is_number),
                log: wanted.scales && is_number && factor.scale == Scale::Log,
                labels,
            })
        };
        let response = |name: &&String| {
            let response = context.responses.get(*name).filter(|_| takes(wanted.responses, name))?;
            Some(ResponseColumn { name: (*name).clone(), unit: response.unit.clone() })
        };
        let columns = Self {
            factors: known.iter().filter_map(factor).collect(),
            responses: known.iter().filter_map(response).collect(),
            derived,
            weights: wanted.weights.map(str::to_owned),
            invalid: wanted.invalid,
        };
        if (columns.factors.is_empty() && columns.derived.is_empty()) || columns.responses.is_empty() {
            let message = "the table has no column that is a [factor], or none that is a [response]";
            return Err(StageError::new(message).hint("declare its columns under [factor] and [response]"));
        }
        Ok(columns)
    }

    /// Names of the factors, in the table's order.
    pub(super) fn factor_names(&self) -> Vec<String> {
        self.factors.iter().map(|f| f.name.clone()).collect()
    }

    /// Categories among the factors, each with its first level: the reference of dummy coding.
    pub(super) fn categories(&self) -> impl Iterator<Item = (&str, &str)> {
        self.factors.iter().filter_map(|f| Some((f.name.as_str(), f.labels.first()?.as_str())))
    }

    /// The value of a factor or a formula at a point that gives values of factors in their units.
    pub(super) fn value_at(&self, name: &str, point: &BTreeMap<String, f64>) -> Option<f64> {
        let formula = || {
            let derived = self.derived.iter().find(|d| d.name == name)?;
            let values: Option<Vec<Vec<f64>>> =
                derived.factors.iter().map(|(factor, _)| Some(vec![*point.get(factor)?])).collect();
            derived.values(&values?).ok()?.first().copied()
        };
        point.get(name).copied().or_else(formula)
    }

    /// Names of the responses, in the table's order.
    pub(super) fn response_names(&self) -> Vec<String> {
        self.responses.iter().map(|r| r.name.clone()).collect()
    }

    /// The factors that a model takes by their logarithms.
    pub(super) fn logarithmic(&self) -> impl Iterator<Item = &str> {
        self.factors.iter().filter(|factor| factor.log).map(|factor| factor.name.as_str())
    }

    /// Unit of a factor.
    pub(super) fn unit_of(&self, factor: &str) -> &str {
        let plain = self.factors.iter().map(|f| (&f.name, &f.unit));
        let mut all = plain.chain(self.derived.iter().map(|d| (&d.name, &d.unit)));
        all.find(|(name, _)| *name == factor).map_or("", |(_, unit)| unit.as_str())
    }

    /// The runs of a table that are not valid, for each response that they gave, and whether they are used.
    ///
    /// # Errors
    /// Such runs are refused, or a response cannot be read.
    pub(super) fn not_valid(&self, table: &Table) -> Result<NotValid, StageError> {
        let judged = self.invalid.judge(table)?;
        let mut list = NotValid::default();
        for own in &self.responses {
            list.append(judged.listed(&own.name, &table.numbers(&own.name, &own.unit)?));
        }
        Ok(list)
    }

    /// The sample of the columns of `table`. A response without a number is missing, as is that of a run that is left out.
    pub(super) fn sample(&self, table: &Table) -> Result<Sample, StageError> {
        let factor = |own: &FactorColumn| {
            if !own.labels.is_empty() {
                return named(table, own);
            }
            let values = table.numbers(&own.name, &own.unit)?;
            let scale = if own.log { Scale::Log } else { Scale::Linear };
            Ok(Factor { levels: own.levels.clone(), coding: own.coding, scale, ..Factor::new(&own.name, values) })
        };
        let derived = |own: &Derived| {
            let parts = own.factors.iter().map(|(name, unit)| Ok(table.numbers(name, unit)?));
            let values = own.values(&parts.collect::<Result<Vec<_>, StageError>>()?)?;
            Ok(Factor::new(&own.name, values))
        };
        let judged = self.invalid.judge(table)?;
        let plain = self.factors.iter().map(factor);
        let response = |own: &ResponseColumn| {
            let values = table.numbers(&own.name, &own.unit)?;
            let counts = |(row, value): (usize, f64)| (!value.is_nan() && !judged.leaves_out(row)).then_some(value);
            let values = values.into_iter().enumerate().map(counts).collect();
            Ok(Response { name: own.name.clone(), values })
        };
        Ok(Sample {
            factors: plain.chain(self.derived.iter().map(derived)).collect::<Result<_, StageError>>()?,
            responses: self.responses.iter().map(response).collect::<Result<_, StageError>>()?,
            weights: self.weights.as_ref().map(|name| table.numbers(name, "")).transpose()?,
        })
    }
}

/// Names of the levels of a column whose cells are words, in alphabetical order; empty for a column of numbers.
fn labels(values: &Values) -> Vec<String> {
    let Values::Texts(texts) = values else { return Vec::new() };
    let number = |text: &String| text.is_empty() || text.parse().is_ok_and(f64::is_finite);
    if texts.iter().all(number) {
        return Vec::new();
    }
    let mut found: Vec<String> = texts.iter().filter(|text| !text.is_empty()).cloned().collect();
    found.sort();
    found.dedup();
    found
}

/// The first cell that is not a number, with its row from 0. One such cell makes the reader return the whole column as text.
fn first_word(values: &Values) -> Option<(usize, &str)> {
    let Values::Texts(texts) = values else { return None };
    let is_word = |text: &str| !text.is_empty() && !text.parse().is_ok_and(f64::is_finite);
    texts.iter().map(String::as_str).enumerate().find(|(_, text)| is_word(text))
}

/// A factor whose levels are numbers has a word in a table.
fn not_a_level(factor: &str, row: usize, word: &str) -> StageError {
    let message = format!("row {}: `{factor}` is `{word}`, and the levels of [factor.{factor}] are numbers", row + 1);
    StageError::new(message).hint(format!("correct the cell, or name the levels: `levels = [\"{word}\", …]`"))
}

/// A factor whose levels are names.
fn named(table: &Table, own: &FactorColumn) -> Result<Factor, StageError> {
    let texts = table.texts(&own.name)?;
    if let Some(row) = texts.iter().position(String::is_empty) {
        let message = format!("row {}: `{}` is empty, where other rows name a level", row + 1, own.name);
        return Err(StageError::new(message).hint("name the level, or leave out the row"));
    }
    if let Some(row) = texts.iter().position(|text| !own.labels.contains(text)) {
        let message = format!("row {}: `{}` is `{}`, which is none of its levels", row + 1, own.name, texts[row]);
        return Err(StageError::new(message).hint(format!("its levels are {}", own.labels.join(", "))));
    }
    Ok(Factor::of_labels(&own.name, texts, own.labels.clone()))
}

/// The faults of a sample or a model as one error.
pub(super) fn refused(Faults(faults): Faults) -> StageError {
    StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}

/// The faults of a sample from which runs may have been left out, which may be the cause.
pub(super) fn refused_without(faults: Faults, not_valid: &NotValid) -> StageError {
    let mut error = refused(faults);
    not_valid.grouped_sentences().iter().for_each(|sentence| error.message += &format!("\n{sentence}"));
    error
}

/// Complaints about names that the workflow does not declare.
pub(super) fn check_names(context: &Context, factors: &[String], responses: &[String]) -> Vec<Complaint> {
    let unknown = |name: &String| {
        let known = known_are(context.responses.keys(), "response");
        Complaint::new("responses", format!("there is no [response.{name}]"))
            .missing(Named::Response, name)
            .among(context.responses.keys())
            .hint(known)
    };
    let factors = factors.iter().flat_map(|name| super::derived::check(name, context));
    factors.chain(responses.iter().filter(|name| !context.responses.contains_key(*name)).map(unknown)).collect()
}

/// A complaint about a probability outside (0, 1).
pub(super) fn check_probability(key: &str, value: f64) -> Option<Complaint> {
    let fine = value > 0.0 && value < 1.0;
    (!fine)
        .then(|| Complaint::new(key, format!("`{key}` is {value}; it must lie between 0 and 1")).hint("such as 0.05"))
}

/// Adds columns to a table, row by row computed from a list.
pub(super) struct Rows<'a, R>(pub &'a [R]);

impl<'a, R> Rows<'a, R> {
    /// A number of every row, NaN where there is none.
    pub(super) fn reals(&self, pick: impl Fn(&'a R) -> Option<f64>) -> Vec<f64> {
        self.0.iter().map(|row| pick(row).unwrap_or(f64::NAN)).collect()
    }

    /// A whole number of every row.
    pub(super) fn ints(&self, pick: impl Fn(&'a R) -> usize) -> Vec<i64> {
        self.0.iter().map(|row| pick(row) as i64).collect()
    }

    /// A text of every row.
    pub(super) fn texts<T: Into<String>>(&self, pick: impl Fn(&'a R) -> T) -> Vec<String> {
        self.0.iter().map(|row| pick(row).into()).collect()
    }
}
