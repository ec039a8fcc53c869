//! Formulas as people write them: `sigma_c / s`, `1.083*sigma_c + 0.919*tau_c`.
//!
//! A formula names values and knows `+ - * / ^`, `abs sqrt exp ln log10 sin cos tan atan tanh min max`. It is evaluated in plain numbers,
//! or in quantities: then sums need one dimension, and functions, exponents and their results a pure number. All operators have
//! the same bits on every machine.

use crate::unit::Dimension;
use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern};
use math::elementary;
use std::fmt;
use std::str::FromStr;

/// A value in SI units, and its dimension unless the operations on the way to it do not fit together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The value in SI units.
    pub value: f64,
    /// Its dimension.
    pub dimension: Result<Dimension, Misfit>,
}

/// Why quantities do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// Two quantities are added or compared.
    #[error("{0} and {1} cannot be added or compared")]
    Sum(Dimension, Dimension),
    /// A function or exponent of a quantity.
    #[error("a function or an exponent needs a pure number, not {0}")]
    Function(Dimension),
    /// A product or power beyond all use.
    #[error("the powers of the units grow too large")]
    Power,
}

impl Measure {
    /// A pure number.
    pub const fn number(value: f64) -> Self {
        Self { value, dimension: Ok(Dimension::NONE) }
    }

    /// A quantity.
    pub const fn of(value: f64, dimension: Dimension) -> Self {
        Self { value, dimension: Ok(dimension) }
    }

    fn sum(self, other: Self, value: f64) -> Self {
        Self { value, dimension: self.alike(other) }
    }

    /// The common dimension of two measures.
    ///
    /// # Errors
    /// They have none.
    pub fn alike(self, other: Self) -> Result<Dimension, Misfit> {
        let (a, b) = (self.dimension?, other.dimension?);
        if a == b { Ok(a) } else { Err(Misfit::Sum(a, b)) }
    }

    fn scaled(self, other: Self, value: f64, power: f64) -> Self {
        let dimension = self.dimension.and_then(|a| {
            let b = other.dimension?.power(power).ok_or(Misfit::Power)?;
            a.product(b).ok_or(Misfit::Power)
        });
        Self { value, dimension }
    }

    fn raised(self, exponent: Self) -> Self {
        let dimension = self.dimension.and_then(|base| match exponent.dimension? {
            Dimension::NONE => base.power(exponent.value).ok_or(Misfit::Power),
            other => Err(Misfit::Function(other)),
        });
        Self { value: elementary::pow(self.value, exponent.value), dimension }
    }

    fn mapped(self, function: fn(f64) -> f64) -> Self {
        Self { value: function(self.value), ..self }
    }

    fn function(self, function: fn(f64) -> f64) -> Self {
        let dimension = self.dimension.and_then(|dimension| match dimension {
            Dimension::NONE => Ok(Dimension::NONE),
            other => Err(Misfit::Function(other)),
        });
        Self { value: function(self.value), dimension }
    }
}

impl Default for Measure {
    fn default() -> Self {
        Self::number(0.0)
    }
}

impl FromStr for Measure {
    type Err = std::num::ParseFloatError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().map(Self::number)
    }
}

/// Operators whose results have the same bits everywhere.
#[derive(Clone, Debug)]
struct Operators;

impl MakeOperators<Measure> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Measure>> {
        let binary =
            |apply: fn(Measure, Measure) -> Measure, prio, is_commutative| BinOp { apply, prio, is_commutative };
        vec![
            Operator::make_bin("^", binary(Measure::raised, 4, false)),
            Operator::make_bin("*", binary(|a, b| a.scaled(b, a.value * b.value, 1.0), 2, true)),
            Operator::make_bin("/", binary(|a, b| a.scaled(b, a.value / b.value, -1.0), 3, false)),
            Operator::make_bin_unary("+", binary(|a, b| a.sum(b, a.value + b.value), 0, true), |a| a),
            Operator::make_bin_unary("-", binary(|a, b| a.sum(b, a.value - b.value), 1, false), |a| a.mapped(|x| -x)),
            Operator::make_bin("min", binary(|a, b| a.sum(b, a.value.min(b.value)), 0, true)),
            Operator::make_bin("max", binary(|a, b| a.sum(b, a.value.max(b.value)), 0, true)),
            Operator::make_unary("abs", |a| a.mapped(f64::abs)),
            Operator::make_unary("sqrt", |a| Measure { value: a.value.sqrt(), ..a.raised(Measure::number(0.5)) }),
            Operator::make_unary("exp", |a| a.function(elementary::exp)),
            Operator::make_unary("ln", |a| a.function(elementary::ln)),
            Operator::make_unary("log10", |a| a.function(elementary::log10)),
            Operator::make_unary("sin", |a| a.function(elementary::sin)),
            Operator::make_unary("cos", |a| a.function(elementary::cos)),
            Operator::make_unary("tan", |a| a.function(elementary::tan)),
            Operator::make_unary("atan", |a| a.function(elementary::atan)),
            Operator::make_unary("tanh", |a| a.function(elementary::tanh)),
        ]
    }
}

literal_matcher_from_pattern!(Number, r"^(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?");

/// A formula that was read. Two are equal when their texts are.
#[derive(Clone)]
pub struct Expression {
    text: String,
    tree: FlatEx<Measure, Operators, Number>,
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text.fmt(f)
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Expression {
    /// Reads a formula.
    ///
    /// # Errors
    /// What cannot be read, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        if let Some(place) = ambiguous_power(text) {
            return Err(format!("`{text}`: a minus before a power at `{}`; write -(a^2) or (-a)^2", &text[place..]));
        }
        let tree = FlatEx::parse(text).map_err(|e| format!("`{text}` is not a formula: {e}"))?;
        Ok(Self { text: text.to_owned(), tree })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The names that it uses, each once.
    pub fn names(&self) -> &[String] {
        self.tree.var_names()
    }

    /// Its value from the values of its names, in the order of [`Expression::names`].
    ///
    /// # Errors
    /// It cannot be evaluated, in words.
    pub fn eval(&self, values: &[Measure]) -> Result<Measure, String> {
        self.tree.eval(values).map_err(|e| format!("`{}`: {e}", self.text))
    }
}

/// Place of a sign that stands directly before a power: mathematics reads `-a^2` as −(a²), the library as (−a)².
fn ambiguous_power(text: &str) -> Option<usize> {
    let mut before = None;
    for (place, c) in text.char_indices().filter(|(_, c)| !c.is_whitespace()) {
        let sign = c == '-' && before.is_none_or(|b| "(,+-*/^".contains(b));
        // The exponent of a number, as in 1e-3, is no sign.
        if sign && after_operand(text[place + 1..].trim_start()).trim_start().starts_with('^') {
            return Some(place);
        }
        before = Some(c);
    }
    None
}

/// What follows the first name, number, call or bracket of a formula.
fn after_operand(text: &str) -> &str {
    let name = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).unwrap_or(text.len());
    let rest = &text[name..];
    if !rest.starts_with('(') {
        return rest;
    }
    let mut depth = 0;
    for (place, c) in rest.char_indices() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth == 0 {
            return &rest[place + 1..];
        }
    }
    ""
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::{Unit, parse_any};

    fn value(text: &str, a: f64) -> f64 {
        let formula = Expression::parse(text).unwrap();
        formula.eval(&[Measure::number(a)][..formula.names().len()]).unwrap().value
    }

    #[test]
    fn formulas_are_read_as_they_are_written() {
        for (text, expected) in [
            ("2*a/1e2 - 3", 2.0 * 5.0 / 1e2 - 3.0),
            ("-(a^2) + 1.5E+1", -25.0 + 15.0),
            ("(-a)^2 - a^2 * 1e-1", 25.0 - 2.5),
            ("sqrt(abs(-16)) + max(1, a)", 4.0 + 5.0),
            ("a - 1 - 1", 3.0),
            ("a / 5 / 2", 0.5),
            ("10 - a + 1", 6.0),
        ] {
            assert_eq!(value(text, 5.0), expected, "{text}");
        }
        assert!(Expression::parse("a +* 2").is_err());
        for unclear in ["-a^2", "3 * -sqrt(a)^2", "-(a + (1))^2 + 1", "max(-a^2, 1)"] {
            assert!(Expression::parse(unclear).unwrap_err().contains("a minus before a power"), "{unclear}");
        }
    }

    #[test]
    fn quantities_carry_their_dimension_through_a_formula() {
        let measure = |text: &str| parse_any(text).map(|(value, dimension)| Measure::of(value, dimension)).unwrap();
        let of = |text: &str, a: &str, b: &str| {
            let formula = Expression::parse(text).unwrap();
            let values = [measure(a), measure(b)];
            formula.eval(&values[..formula.names().len()]).unwrap()
        };
        let unit = |text: &str| Unit::parse(text).unwrap().dimension;
        assert_eq!(of("a / b", "30 MPa", "0.5"), Measure::of(60e6, unit("Pa")));
        assert_eq!(of("a*b^2/(2*b)", "2 N/m^3", "4 m"), Measure::of(4.0, unit("N/m^2")));
        assert_eq!(of("sqrt(a*b)", "4 Pa", "9 Pa"), Measure::of(6.0, unit("Pa")));
        assert_eq!(of("ln(a/b)", "1 GPa", "1 GPa"), Measure::number(0.0));
        let misfit = |text: &str, a: &str, b: &str| of(text, a, b).dimension.unwrap_err().to_string();
        assert_eq!(misfit("a + b", "1 MPa", "2 m"), "Pa and m cannot be added or compared");
        assert_eq!(misfit("a + b", "1 MPa", "2"), "Pa and a pure number cannot be added or compared");
        assert_eq!(misfit("exp(a)/b", "1 MPa", "2"), "a function or an exponent needs a pure number, not Pa");
        assert_eq!(misfit("b^a", "1 m", "2"), "a function or an exponent needs a pure number, not m");
    }
}
