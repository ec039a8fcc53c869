//! Formulas as people write them: `sigma_c / s`, `1.083*sigma_c + 0.919*tau_c`.
//!
//! A formula names values and knows `+ - * / ^`, `abs sqrt exp ln log10 sin cos tan atan tanh min max`; its grammar stands in
//! `expression/read.rs`. It is evaluated in plain numbers, or in quantities: then sums need one dimension, and functions, exponents and their results a pure number. All operators have
//! the same bits on every machine.

use crate::unit::Dimension;
use math::elementary;
use read::Term;
use std::fmt;

mod read;

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

/// A function of one value, by its name; results have the same bits everywhere.
pub(crate) fn function_of_one(name: &str) -> Option<fn(Measure) -> Measure> {
    Some(match name {
        "abs" => |a| a.mapped(f64::abs),
        "sqrt" => |a| Measure { value: a.value.sqrt(), ..a.raised(Measure::number(0.5)) },
        "exp" => |a| a.function(elementary::exp),
        "ln" => |a| a.function(elementary::ln),
        "log10" => |a| a.function(elementary::log10),
        "sin" => |a| a.function(elementary::sin),
        "cos" => |a| a.function(elementary::cos),
        "tan" => |a| a.function(elementary::tan),
        "atan" => |a| a.function(elementary::atan),
        "tanh" => |a| a.function(elementary::tanh),
        _ => return None,
    })
}

/// A function of one value or more, two by two from the left. A value that is no number makes the result none, unlike that
/// of [`f64::min`].
pub(crate) fn function_of_all(name: &str) -> Option<fn(Measure, Measure) -> Measure> {
    Some(match name {
        "min" => |a, b| a.sum(b, if a.value.is_nan() || b.value.is_nan() { f64::NAN } else { a.value.min(b.value) }),
        "max" => |a, b| a.sum(b, if a.value.is_nan() || b.value.is_nan() { f64::NAN } else { a.value.max(b.value) }),
        _ => return None,
    })
}

/// A formula that was read. Two are equal when their texts are.
#[derive(Clone)]
pub struct Expression {
    text: String,
    root: Term,
    names: Vec<String>,
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
        let (root, names) = read::formula(text).map_err(|why| format!("`{}` is no formula: {why}", shortened(text)))?;
        Ok(Self { text: text.to_owned(), root, names })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The names that it uses, each once, in alphabetical order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Its value from the values of its names, in the order of [`Expression::names`].
    ///
    /// # Errors
    /// There are not as many values as names.
    pub fn eval(&self, values: &[Measure]) -> Result<Measure, String> {
        if values.len() != self.names.len() {
            return Err(format!(
                "`{}` has {} names, and {} values are given",
                self.text,
                self.names.len(),
                values.len()
            ));
        }
        Ok(self.root.value(values))
    }
}

/// A text short enough for a message.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 200;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests;
