//! Linear constraints on the factors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Σ terms ≤ `at_most`, in the factors' units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Coefficient of each factor.
    pub terms: BTreeMap<String, f64>,
    /// Upper bound.
    pub at_most: f64,
}
