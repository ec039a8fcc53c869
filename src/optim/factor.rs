//! A calibrated parameter: its range, and the scale on which it is searched.
//!
//! A parameter x of a range a … b has in the unit box the coordinate
//! * u = (x − a) / (b − a) on a linear scale,
//! * u = ln(x/a) / ln(b/a) on a logarithmic one, which needs a > 0: equal steps of u are equal ratios of x. Stiffnesses
//!   and strengths whose right order of magnitude is not known are searched there.

use super::Error;
use math::elementary::{exp, ln};
use math::scale::Scale;

/// A calibrated parameter and its range, in the unit the model takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Name.
    pub name: String,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How the range is divided.
    pub scale: Scale,
}

impl Factor {
    /// A parameter on a linear scale.
    pub fn linear(name: &str, low: f64, high: f64) -> Self {
        Self { name: name.to_owned(), low, high, scale: Scale::Linear }
    }

    /// A parameter on a logarithmic scale.
    pub fn log(name: &str, low: f64, high: f64) -> Self {
        Self { name: name.to_owned(), low, high, scale: Scale::Log }
    }

    /// The value at `unit`; 0 and 1 give the ends of the range exactly, as does what lies beyond 1 (or below 0 by
    /// logarithms).
    pub(super) fn natural(&self, unit: f64) -> f64 {
        match self.scale {
            _ if unit >= 1.0 => self.high,
            Scale::Log if unit <= 0.0 => self.low,
            Scale::Linear | Scale::Log => self.natural_beyond(unit),
        }
    }

    /// The value at a coordinate that may lie outside 0 … 1.
    pub(super) fn natural_beyond(&self, unit: f64) -> f64 {
        match self.scale {
            Scale::Linear => self.low + unit * (self.high - self.low),
            Scale::Log => self.low * exp(unit * self.span()),
        }
    }

    /// The coordinate of a value; outside the range it lies outside 0 … 1, and a value without logarithm is at −∞.
    pub fn unit(&self, natural: f64) -> f64 {
        match self.scale {
            Scale::Linear => (natural - self.low) / (self.high - self.low),
            Scale::Log if natural <= 0.0 => f64::NEG_INFINITY,
            Scale::Log => ln(natural / self.low) / self.span(),
        }
    }

    /// What one range is in the coordinate of the scale.
    pub(super) fn span(&self) -> f64 {
        match self.scale {
            Scale::Linear => self.high - self.low,
            Scale::Log => ln(self.high / self.low),
        }
    }

    /// The fault of the range, if it has one.
    pub(super) fn fault(&self) -> Option<Error> {
        let Self { name, low, high, scale } = self;
        if let Some(&value) = [low, high].into_iter().find(|v| !v.is_finite()) {
            return Some(Error::NotFinite { what: format!("an end of the range of `{name}`"), value });
        }
        if low >= high {
            return Some(Error::EmptyRange { factor: name.clone(), low: *low, high: *high });
        }
        (*scale == Scale::Log && *low <= 0.0).then(|| Error::NoLogarithm { factor: name.clone(), low: *low })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_range_is_divided_by_ratios() {
        let factor = Factor::log("kn", 1e6, 1e10);
        assert_eq!([factor.natural(0.0), factor.natural(1.0)], [1e6, 1e10]);
        for (unit, value) in [(0.25, 1e7), (0.5, 1e8), (0.75, 1e9)] {
            assert!((factor.natural(unit) / value - 1.0).abs() < 1e-12, "{}", factor.natural(unit));
            assert!((factor.unit(value) - unit).abs() < 1e-15, "{}", factor.unit(value));
        }
        assert_eq!(factor.unit(0.0), f64::NEG_INFINITY);
    }

    #[test]
    fn a_logarithmic_range_cannot_begin_at_zero() {
        let fault = Factor::log("kn", 0.0, 1e10).fault().map(|fault| fault.to_string());
        assert_eq!(
            fault.as_deref(),
            Some("the range of `kn` begins at 0, and a logarithmic scale needs a positive lower end")
        );
        assert_eq!(Factor::linear("kn", 0.0, 1e10).fault(), None);
    }
}
