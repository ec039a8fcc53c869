//! Compares a fit through the origin with the same terms and a constant, to show whether the data support the origin.

use stats::regression::{Coefficient, Settings, regress};
use stats::sample::Sample;
use stats::terms::Term;

/// The same terms with a constant.
pub(in super::super) struct Beside {
    /// The constant, which is zero by assumption in a fit through the origin.
    pub constant: Coefficient,
    /// R² about the mean.
    pub r2: f64,
    /// The other coefficients.
    pub rest: Vec<Coefficient>,
}

impl Beside {
    /// The comparison; `None` where there are too few rows for a constant.
    pub(in super::super) fn of(sample: &Sample, response: &str, terms: &[Term], settings: &Settings) -> Option<Self> {
        let with = super::with_constant(terms);
        let mut found = regress(sample, response, &with, settings).ok()?;
        let constant = found.natural.remove(0);
        Some(Self { constant, r2: found.fit.r2, rest: found.natural })
    }

    /// The coefficient of a term.
    pub(in super::super) fn estimate(&self, term: &str) -> Option<f64> {
        self.rest.iter().find(|c| c.term == term).map(|c| c.estimate)
    }
}
