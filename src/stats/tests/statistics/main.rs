//! The statistics against certified data, published tables and other programs.
#![allow(clippy::unwrap_used)]

mod agreement;
mod close;
mod faults;
mod identities;
mod models;
mod nist;
mod other_code;
mod scales;
mod su2021;

use stats::sample::{Factor, Response, Sample};
use toml::{Table, Value};

/// A reference file of `tests/reference/statistics`.
fn reference(name: &str) -> Table {
    let path = format!("{}/../../tests/reference/statistics/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}")).parse().unwrap()
}

/// A number, written with or without a point.
fn number(value: &Value) -> f64 {
    value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64)
}

/// A list of numbers.
fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// A list of texts.
fn texts(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|t| t.as_str().unwrap()).collect()
}

/// A table of named factors and one response `y`.
fn sample(factors: &Table, y: &Value) -> Sample {
    Sample {
        factors: factors.iter().map(|(name, values)| Factor::new(name, numbers(values))).collect(),
        responses: vec![Response::new("y", numbers(y))],
        weights: None,
    }
}

/// Decimal digits that agree: −log₁₀ of the relative error, at most 16.
fn digits(found: f64, wanted: f64) -> f64 {
    let error = if wanted == 0.0 { found.abs() } else { ((found - wanted) / wanted).abs() };
    if error == 0.0 { 16.0 } else { (-math::elementary::log10(error)).min(16.0) }
}
