//! The target of a response: a value or a band, with weight and tolerance.

use crate::unit::{Unit, split_any};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number, or a text with a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Wanted {
    /// A pure number.
    Number(f64),
    /// A number with a unit.
    Text(String),
}

impl Wanted {
    /// The value in `unit`.
    ///
    /// # Errors
    /// It is of another dimension or cannot be read.
    pub fn value_in(&self, unit: &str) -> Result<f64, String> {
        let (value, own) = match self {
            Self::Number(value) => (*value, ""),
            Self::Text(text) => split_any(text).map_err(|e| e.to_string())?,
        };
        let wanted = Unit::parse(unit).map_err(|e| e.to_string())?;
        let Ok(conversion) = Unit::parse(own).map_err(|e| e.to_string())?.to(wanted) else {
            let found = match self {
                Self::Number(value) => value.to_string(),
                Self::Text(text) => format!("\"{text}\""),
            };
            return Err(format!("{found} is not a value in `{unit}`; write for example \"30 {unit}\""));
        };
        let value = conversion.of(value);
        if value.is_finite() { Ok(value) } else { Err(format!("{value} `{unit}` is not a finite number")) }
    }
}

/// The target of a response: `"30 MPa"`, or a table with a band, a weight or a tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Goal {
    /// A pure number.
    Number(f64),
    /// A number with a unit.
    Text(String),
    /// A value or a band, and more.
    Table(GoalTable),
}

/// A value, or a band that may be open to one side.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalTable {
    /// The target value.
    #[serde(default)]
    pub value: Option<Wanted>,
    /// Lower end of the target band.
    #[serde(default)]
    pub at_least: Option<Wanted>,
    /// Upper end of the target band.
    #[serde(default)]
    pub at_most: Option<Wanted>,
    /// Weight of the deviation in this set, in place of that in `weights`.
    #[serde(default)]
    pub weight: Option<f64>,
    /// Relative deviation up to which the target counts as met, in place of the stage's `tolerance`.
    #[serde(default)]
    pub tolerance: Option<f64>,
}

impl Goal {
    /// The goal as a table.
    pub(super) fn table(&self) -> GoalTable {
        let exactly = |value| GoalTable { value: Some(value), ..GoalTable::default() };
        match self {
            Self::Number(value) => exactly(Wanted::Number(*value)),
            Self::Text(text) => exactly(Wanted::Text(text.clone())),
            Self::Table(table) => table.clone(),
        }
    }
}

impl GoalTable {
    /// The two ends of the target band in `unit`; `None` where it is open.
    pub(super) fn ends(&self, unit: &str) -> Result<[Option<f64>; 2], String> {
        let end = |wanted: &Option<Wanted>| wanted.as_ref().map(|wanted| wanted.value_in(unit)).transpose();
        match (&self.value, &self.at_least, &self.at_most) {
            (Some(_), None, None) => {
                let value = end(&self.value)?;
                Ok([value, value])
            }
            (None, None, None) => Err("neither `value` nor `at_least` nor `at_most` is given".to_owned()),
            (None, low, high) => Ok([end(low)?, end(high)?]),
            (Some(_), ..) => Err("`value` stands alone, or `at_least` and `at_most` without it".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(text: &str) -> Result<[Option<f64>; 2], String> {
        #[derive(Deserialize)]
        struct Line {
            goal: Goal,
        }
        let line: Line = toml::from_str(&format!("goal = {text}")).unwrap();
        line.goal.table().ends("MPa")
    }

    #[test]
    fn values_and_bands_are_read_in_the_unit_of_the_response() {
        assert_eq!(goal("\"30 MPa\""), Ok([Some(30.0); 2]));
        assert_eq!(goal("{ at_least = \"3e6 Pa\" }"), Ok([Some(3.0), None]));
        assert_eq!(goal("{ at_least = \"3 MPa\", at_most = \"5 MPa\", weight = 2 }"), Ok([Some(3.0), Some(5.0)]));
        assert!(goal("{ weight = 2 }").unwrap_err().starts_with("neither"));
        assert!(goal("{ value = \"3 MPa\", at_most = \"5 MPa\" }").unwrap_err().starts_with("`value` stands alone"));
        assert!(goal("30").unwrap_err().contains("\"30 MPa\""));
    }
}
