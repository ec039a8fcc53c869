//! The first point of a search, from numbers and from formulas of the targets.

use super::config::{Calibrate, First};
use super::params::{TargetParam, middle};
use crate::expression::{Expression, Measure};
use crate::stage::Context;

/// A formula that gives no first value: the factor, and why.
#[derive(Debug, PartialEq)]
pub(super) struct NoStart {
    pub(super) factor: String,
    pub(super) why: String,
}

impl Calibrate {
    /// The numbers among the first values.
    pub(super) fn start_numbers(&self) -> std::collections::BTreeMap<String, f64> {
        let number = |(name, first): (&String, &First)| match first {
            First::Number(value) => Some((name.clone(), *value)),
            First::Formula(_) => None,
        };
        self.start.iter().filter_map(number).collect()
    }

    /// The first point for these targets, in the units of the factors; `None` where no first value is a formula.
    ///
    /// # Errors
    /// A formula that cannot be read, names something else than a target with one value, or gives no number.
    pub(super) fn started(&self, context: &Context, targets: &[TargetParam]) -> Result<Option<Vec<f64>>, NoStart> {
        if !self.start.values().any(|first| matches!(first, First::Formula(_))) {
            return Ok(None);
        }
        let value = |name: &String| match self.start.get(name) {
            Some(First::Number(value)) => Ok(*value),
            Some(First::Formula(text)) => evaluated(text, targets).map_err(|why| NoStart { factor: name.clone(), why }),
            None => {
                // A factor without a range is a fault of its own.
                let range = self.range(context, name).unwrap_or([f64::NAN; 2]);
                Ok(middle(self.is_log(context, name), range))
            }
        };
        self.factors.iter().map(value).collect::<Result<_, _>>().map(Some)
    }
}

fn evaluated(text: &str, targets: &[TargetParam]) -> Result<f64, String> {
    let formula = Expression::parse(text)?;
    let known = targets.iter().filter(|target| target.low.is_some() && target.low == target.high);
    let value = |name: &String| {
        let found = known.clone().find(|target| target.response == *name).and_then(|target| target.low);
        let names = || known.clone().map(|target| target.response.as_str()).collect::<Vec<_>>().join(", ");
        found.map(Measure::number).ok_or_else(|| format!("`{name}` is no target with one value; known are {}", names()))
    };
    let values = formula.names().iter().map(value).collect::<Result<Vec<_>, String>>()?;
    let value = formula.eval(&values)?.value;
    if value.is_finite() { Ok(value) } else { Err(format!("its value is {value}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(response: &str, low: f64, high: f64) -> TargetParam {
        TargetParam {
            response: response.to_owned(),
            unit: String::new(),
            low: Some(low),
            high: Some(high),
            weight: 1.0,
            tolerance: None,
            strain: None,
        }
    }

    #[test]
    fn formulas_take_the_targets_in_their_units() {
        let targets = [target("UCS", 150.0, 150.0), target("sigma_t", 9.0, 9.0), target("nu", 0.2, 0.3)];
        assert_eq!(evaluated("0.85*UCS", &targets), Ok(0.85 * 150.0));
        assert_eq!(evaluated("2 + UCS/sigma_t", &targets), Ok(2.0 + 150.0 / 9.0));
        assert!(evaluated("4*nu", &targets).unwrap_err().contains("known are UCS, sigma_t"));
        assert!(
            evaluated("E", &targets).is_err()
                && evaluated("1/0", &targets).is_err()
                && evaluated("(", &targets).is_err()
        );
    }
}
