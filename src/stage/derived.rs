//! Formulas of factors as columns: the values of a term such as `scn/(1+ratio)`, with their unit.
//!
//! A formula is computed in SI units and shown in the unit of a factor of the same dimension (the first in the alphabet),
//! or in SI units. One that adds quantities of different kinds, or takes the exponential of one, is refused.

use super::{Complaint, Context, Named, StageError, known_are};
use crate::expression::{Expression, Measure};
use crate::unit::{Dimension, Unit};
use serde::{Deserialize, Serialize};

/// One formula with the units of its factors.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Derived {
    /// The formula as it was written: the name of its column.
    pub name: String,
    /// Names of the factors, in the order in which the formula is evaluated, with their units.
    pub factors: Vec<(String, String)>,
    /// Unit of its values.
    pub unit: String,
}

/// Whether a name is that of a factor, not a formula.
fn is_plain(name: &str) -> bool {
    name.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// The names in a formula of factors; `None` for the plain name of one, and for a text that is no formula.
pub(super) fn factors_of_formula(text: &str) -> Option<Vec<String>> {
    let formula = Expression::parse(text).ok().filter(|_| !is_plain(text))?;
    Some(formula.names().to_vec()).filter(|names| !names.is_empty())
}

/// Complaints about a name in a term that is neither a factor nor a formula of factors.
pub(super) fn check(name: &str, context: &Context) -> Vec<Complaint> {
    let known = || known_are(context.factors.keys(), "factor");
    let unknown = |name: &str| {
        Complaint::new("factors", format!("there is no [factor.{name}]"))
            .missing(Named::Factor, name)
            .among(context.factors.keys())
            .hint(known())
    };
    if context.factors.contains_key(name) {
        return Vec::new();
    }
    if is_plain(name) {
        return vec![unknown(name)];
    }
    let formula = match Expression::parse(name) {
        Ok(formula) => formula,
        Err(why) => return vec![Complaint::new("factors", why)],
    };
    let lost: Vec<Complaint> =
        formula.names().iter().filter(|own| !context.factors.contains_key(*own)).map(|own| unknown(own)).collect();
    if lost.is_empty()
        && let Some(category) = formula.names().iter().find(|own| !context.factors[*own].names.is_empty())
    {
        let message = format!("`{name}` computes with `{category}`, whose levels are names");
        return vec![Complaint::new("factors", message).hint("name the factor as a term of its own")];
    }
    if lost.is_empty()
        && let Err(error) = Derived::of(name, |factor| context.factors.get(factor).map(|f| f.unit.clone()))
    {
        return vec![Complaint::new("factors", error.message)];
    }
    lost
}

impl Derived {
    /// The formula, with the unit of each factor that it names.
    ///
    /// # Errors
    /// It cannot be read, names no known factor, or mixes quantities of different kinds.
    pub(super) fn of(name: &str, unit_of: impl Fn(&str) -> Option<String>) -> Result<Self, StageError> {
        let formula = Expression::parse(name).map_err(StageError::new)?;
        let factor = |own: &String| {
            let unit =
                unit_of(own).ok_or_else(|| StageError::new(format!("`{name}` names `{own}`, which is no factor")))?;
            Ok((own.clone(), unit))
        };
        let factors = formula.names().iter().map(factor).collect::<Result<Vec<_>, StageError>>()?;
        if factors.is_empty() {
            return Err(StageError::new(format!("`{name}` names no factor")).hint("a term depends on a factor"));
        }
        let unit = unit_of_formula(name, &formula, &factors)?;
        Ok(Self { name: name.to_owned(), factors, unit })
    }

    /// Its values, given those of its factors in their units, column by column in the order of [`Self::factors`].
    ///
    /// # Errors
    /// A row gives no number, such as a division by zero.
    pub(super) fn values(&self, columns: &[Vec<f64>]) -> Result<Vec<f64>, StageError> {
        let formula = Expression::parse(&self.name).map_err(StageError::new)?;
        let own = parsed_unit(&self.unit)?.factor;
        let units = self.factors.iter().map(|(_, unit)| parsed_unit(unit));
        let units = units.collect::<Result<Vec<Unit>, StageError>>()?;
        let rows = columns.first().map_or(0, Vec::len);
        let value = |row: usize| {
            let measure = |(column, unit): (&Vec<f64>, &Unit)| Measure::of(column[row] * unit.factor, unit.dimension);
            let point: Vec<Measure> = columns.iter().zip(&units).map(measure).collect();
            let value = formula.eval(&point).map_err(StageError::new)?.value / own;
            let undefined = || {
                let message = format!("row {}: `{}` is {value}", row + 1, self.name);
                StageError::new(message).hint("leave out the row, or write a formula that holds for it")
            };
            if value.is_finite() { Ok(value) } else { Err(undefined()) }
        };
        (0..rows).map(value).collect()
    }
}

fn parsed_unit(text: &str) -> Result<Unit, StageError> {
    Unit::parse(text).map_err(|e| StageError::new(e.to_string()))
}

/// The unit in which the values of a formula are shown.
fn unit_of_formula(name: &str, formula: &Expression, factors: &[(String, String)]) -> Result<String, StageError> {
    let units = factors.iter().map(|(_, unit)| parsed_unit(unit)).collect::<Result<Vec<Unit>, StageError>>()?;
    let point: Vec<Measure> = units.iter().map(|unit| Measure::of(1.0, unit.dimension)).collect();
    let found = formula.eval(&point).map_err(StageError::new)?;
    let dimension = found.dimension.map_err(|why| {
        StageError::new(format!("`{name}`: {why}")).hint("divide each quantity by one of its kind before it is added")
    })?;
    if dimension == Dimension::NONE {
        return Ok(String::new());
    }
    let of_factor = factors.iter().zip(&units).find(|(_, unit)| unit.dimension == dimension);
    Ok(of_factor.map_or_else(|| dimension.to_string(), |((_, unit), _)| unit.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(name: &str) -> Option<String> {
        let known = [("scn", "MPa"), ("E", "GPa"), ("ratio", ""), ("R", "mm")];
        known.iter().find(|(known, _)| *known == name).map(|(_, unit)| (*unit).to_owned())
    }

    #[test]
    fn units_follow_from_the_formula() {
        for (text, wanted) in [
            ("scn/(1+ratio)", "MPa"),
            ("scn/E", ""),
            ("ratio^2", ""),
            ("exp(-ratio)", ""),
            ("E*R", "kg s^-2"),
            ("sqrt(R)", "m^(1/2)"),
            ("max(scn, E)", "GPa"),
        ] {
            assert_eq!(Derived::of(text, unit).unwrap().unit, wanted, "{text}");
        }
        for mixed in ["scn+ratio", "exp(scn)", "scn + R", "1+E"] {
            let message = Derived::of(mixed, unit).unwrap_err().message;
            assert!(
                message.contains("cannot be added") || message.contains("needs a pure number"),
                "{mixed}: {message}"
            );
        }
        assert!(Derived::of("scn/foo", unit).unwrap_err().message.contains("`foo`"));
        assert!(Derived::of("2*3", unit).unwrap_err().message.contains("names no factor"));
    }

    #[test]
    fn values_are_in_that_unit() {
        let of = |text: &str, columns: &[Vec<f64>]| Derived::of(text, unit).unwrap().values(columns);
        let formula = Derived::of("scn/(1+ratio)", unit).unwrap();
        let names: Vec<&str> = formula.factors.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["ratio", "scn"]);
        assert_eq!(formula.values(&[vec![1.0, 3.0], vec![30.0, 8.0]]).unwrap(), [15.0, 2.0]);
        // 20 MPa over 2 GPa
        assert_eq!(of("scn/E", &[vec![2.0], vec![20.0]]).unwrap(), [0.01]);
        assert!(of("1/ratio", &[vec![1.0, 0.0]]).unwrap_err().message.contains("row 2"));
    }
}
