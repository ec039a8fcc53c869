//! From a table of runs to the statistician's sample and back: shared by every stage that analyses.

use super::{Complaint, Context, StageError};
use crate::artifact::results::Results;
use crate::artifact::{Artifact, Table};
use serde::{Deserialize, Serialize};
use stats::error::Faults;
use stats::sample::{Factor, Response, Sample};

/// Which columns of a table are analysed, and in which units.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Columns {
    factors: Vec<FactorColumn>,
    responses: Vec<ResponseColumn>,
    /// Column with the number of replicates that a row is the mean of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    weights: Option<String>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct FactorColumn {
    name: String,
    unit: String,
    /// Values that no row may leave; empty when any value may stand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    levels: Vec<f64>,
    /// Values of −1 and +1 in coded units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coding: Option<(f64, f64)>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct ResponseColumn {
    name: String,
    unit: String,
}

/// What a stage asks of a table.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted<'a> {
    /// Factors; empty takes all that the table has.
    pub factors: &'a [String],
    /// Responses; empty takes all that the table has.
    pub responses: &'a [String],
    /// Column of weights.
    pub weights: Option<&'a str>,
    /// Whether factors are categories, so that every value must be a declared level.
    pub levels: bool,
}

/// The table `runs` of an artifact.
pub(super) fn runs(artifact: &Artifact) -> Result<&Table, StageError> {
    Ok(Results::table(artifact)?)
}

impl Columns {
    /// The columns of `table` that are wanted, in the table's order.
    pub(super) fn of(table: &Table, context: &Context, wanted: Wanted) -> Result<Self, StageError> {
        let present = |name: &&String| table.column(name).is_some();
        let known: Vec<&String> = table.columns.iter().map(|c| &c.name).collect();
        if let Some(name) = wanted.factors.iter().chain(wanted.responses).find(|name| !present(name)) {
            let names = known.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(", ");
            return Err(StageError::new(format!("the table has no column `{name}`")).hint(format!("it has {names}")));
        }
        let takes = |list: &[String], name: &String| list.is_empty() || list.contains(name);
        let factor = |name: &&String| {
            let factor = context.factors.get(*name).filter(|_| takes(wanted.factors, name))?;
            let ends = factor
                .levels
                .iter()
                .copied()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| (low.min(level), high.max(level)));
            let coding = factor.range.map(|[low, high]| (low, high)).or((!factor.levels.is_empty()).then_some(ends));
            Some(FactorColumn {
                name: (*name).clone(),
                unit: factor.unit.clone(),
                levels: if wanted.levels { factor.levels.clone() } else { Vec::new() },
                coding: coding.filter(|_| !wanted.levels),
            })
        };
        let response = |name: &&String| {
            let response = context.responses.get(*name).filter(|_| takes(wanted.responses, name))?;
            Some(ResponseColumn { name: (*name).clone(), unit: response.unit.clone() })
        };
        let columns = Self {
            factors: known.iter().filter_map(factor).collect(),
            responses: known.iter().filter_map(response).collect(),
            weights: wanted.weights.map(str::to_owned),
        };
        if columns.factors.is_empty() || columns.responses.is_empty() {
            let message = "the table has no column that is a [factor], or none that is a [response]";
            return Err(StageError::new(message).hint("declare its columns under [factor] and [response]"));
        }
        Ok(columns)
    }

    /// Names of the factors, in the table's order.
    pub(super) fn factor_names(&self) -> Vec<String> {
        self.factors.iter().map(|f| f.name.clone()).collect()
    }

    /// Names of the responses, in the table's order.
    pub(super) fn response_names(&self) -> Vec<String> {
        self.responses.iter().map(|r| r.name.clone()).collect()
    }

    /// Unit of a factor.
    pub(super) fn unit_of(&self, factor: &str) -> &str {
        self.factors.iter().find(|f| f.name == factor).map_or("", |f| f.unit.as_str())
    }

    /// The sample that the columns of `table` make. A response without a number is a missing row.
    pub(super) fn sample(&self, table: &Table) -> Result<Sample, StageError> {
        let factor = |own: &FactorColumn| {
            let values = table.numbers(&own.name, &own.unit)?;
            Ok(Factor {
                name: own.name.clone(),
                values,
                levels: own.levels.clone(),
                coding: own.coding,
                labels: Vec::new(),
            })
        };
        let response = |own: &ResponseColumn| {
            let values = table.numbers(&own.name, &own.unit)?;
            let values = values.into_iter().map(|v| (!v.is_nan()).then_some(v)).collect();
            Ok(Response { name: own.name.clone(), values })
        };
        Ok(Sample {
            factors: self.factors.iter().map(factor).collect::<Result<_, StageError>>()?,
            responses: self.responses.iter().map(response).collect::<Result<_, StageError>>()?,
            weights: self.weights.as_ref().map(|name| table.numbers(name, "")).transpose()?,
        })
    }
}

/// The faults of a sample or a model as one error.
pub(super) fn refused(Faults(faults): Faults) -> StageError {
    StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}

/// Complaints about names that the workflow does not declare.
pub(super) fn check_names(context: &Context, factors: &[String], responses: &[String]) -> Vec<Complaint> {
    let unknown = |key: &str, what: &str, name: &String, known: Vec<&String>| {
        let known = known.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(", ");
        Complaint::new(key, format!("there is no [{what}.{name}]")).hint(format!("known are {known}"))
    };
    let factors = factors.iter().filter(|name| !context.factors.contains_key(*name));
    let responses = responses.iter().filter(|name| !context.responses.contains_key(*name));
    let factors = factors.map(|name| unknown("factors", "factor", name, context.factors.keys().collect()));
    let responses = responses.map(|name| unknown("responses", "response", name, context.responses.keys().collect()));
    factors.chain(responses).collect()
}

/// A complaint about a probability outside (0, 1).
pub(super) fn check_probability(key: &str, value: f64) -> Option<Complaint> {
    let fine = value > 0.0 && value < 1.0;
    (!fine)
        .then(|| Complaint::new(key, format!("`{key}` is {value}; it must lie between 0 and 1")).hint("such as 0.05"))
}

/// A table column by column from rows.
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
