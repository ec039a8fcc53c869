//! How a range of values is divided: by equal differences or by equal ratios.

use crate::elementary::{exp, ln};
use serde::{Deserialize, Serialize};

/// How a range is divided, and how a model takes its values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// By equal differences.
    #[default]
    Linear,
    /// By equal ratios.
    Log,
}

impl Scale {
    /// The coordinate in which the range is divided evenly: the value, or its natural logarithm.
    pub fn of(self, natural: f64) -> f64 {
        match self {
            Self::Linear => natural,
            Self::Log => ln(natural),
        }
    }

    /// The value at such a coordinate.
    pub fn natural(self, coordinate: f64) -> f64 {
        match self {
            Self::Linear => coordinate,
            Self::Log => exp(coordinate),
        }
    }

    /// Whether values are used unchanged; files leave this scale out.
    pub fn is_linear(&self) -> bool {
        *self == Self::Linear
    }
}
