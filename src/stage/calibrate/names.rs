//! One stage or several, as a workflow names them: `"a"`, or `["a", "b"]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Names of stages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Names {
    /// One.
    One(String),
    /// Several, in order.
    Several(Vec<String>),
}

impl Default for Names {
    fn default() -> Self {
        Self::Several(Vec::new())
    }
}

impl Names {
    /// One name.
    pub fn one(name: &str) -> Self {
        Self::One(name.to_owned())
    }

    /// The names in order.
    pub fn list(&self) -> Vec<String> {
        match self {
            Self::One(name) => vec![name.clone()],
            Self::Several(names) => names.clone(),
        }
    }

    /// Whether nothing is named.
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::Several(names) if names.is_empty())
    }
}
