//! A fitted polynomial that travels: its value, its uncertainty and the domain it was seen in.

use super::diagnostics::Residual;
use super::fit::Solution;
use super::number::Real;
use super::terms::Term;
use math::distribution::t_for_coverage;
use math::scale::Scale;
use serde::{Deserialize, Serialize};

/// One factor of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// The factor.
    pub name: String,
    /// How the model takes its values.
    pub scale: Scale,
    /// Value at coded 0; on a logarithmic scale its logarithm.
    pub centre: f64,
    /// Length of one coded unit; on a logarithmic scale that of the logarithm.
    pub half: f64,
    /// Least value that was fitted.
    pub low: f64,
    /// Greatest value that was fitted.
    pub high: f64,
}

impl Axis {
    /// Coded units of a natural value.
    pub fn coded(&self, natural: f64) -> f64 {
        (self.scale.of(natural) - self.centre) / self.half
    }

    /// Natural value of coded units.
    pub fn natural(&self, coded: f64) -> f64 {
        self.scale.natural(self.half.mul_add(coded, self.centre))
    }

    /// Whether a natural value lies in the domain.
    pub fn holds(&self, natural: f64) -> bool {
        (self.low..=self.high).contains(&natural)
    }

    /// `u = constant + slope·x`, x the value or its logarithm.
    pub(crate) fn of_coded<T: Real>(&self) -> (T, T) {
        let half = T::from(self.half);
        (-T::from(self.centre) / half, T::from(1.0) / half)
    }

    /// `x = constant + slope·u`.
    pub(crate) fn of_natural<T: Real>(&self) -> (T, T) {
        (T::from(self.centre), T::from(self.half))
    }
}

/// A polynomial in the coded axes, with what its intervals need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Its factors with their coding and domain.
    pub axes: Vec<Axis>,
    /// Its terms.
    pub terms: Vec<Term>,
    /// Powers of the axes, term by term: entry (term, axis) at `term · axes + axis`.
    pub powers: Vec<u32>,
    /// Coefficients of the coded terms.
    pub coefficients: Vec<f64>,
    /// `R⁻¹` of the fit, row by row: its rows span the covariance of the coefficients in units of `s²`.
    pub root: Vec<f64>,
    /// Residual standard deviation.
    pub s: Option<f64>,
    /// Residual degrees of freedom.
    pub df_residual: usize,
    /// The greatest leverage of a fitted row: beyond it lies extrapolation, even inside the box.
    pub greatest_leverage: f64,
}

/// The prediction of a model at one point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// The value.
    pub value: f64,
    /// Standard error of the mean response.
    pub std_error: Option<f64>,
    /// Confidence interval of the mean response.
    pub confidence: Option<(f64, f64)>,
    /// Prediction interval of one new run.
    pub prediction: Option<(f64, f64)>,
    /// Leverage of the point.
    pub leverage: f64,
    /// Factors outside their domain.
    pub outside: Vec<String>,
    /// Farther from the data than any fitted row, though every factor may be inside its range.
    pub far: bool,
}

impl Model {
    pub(crate) fn new<T: Real>(solution: &Solution<T>, axes: &[Axis], terms: &[Term], rows: &[Residual]) -> Self {
        let used = |axis: &&Axis| terms.iter().any(|t| t.power_of(&axis.name) > 0);
        let axes: Vec<Axis> = axes.iter().filter(used).cloned().collect();
        let powers = terms.iter().flat_map(|t| axes.iter().map(|axis| t.power_of(&axis.name)));
        Self {
            powers: powers.collect(),
            coefficients: solution.coefficients.iter().map(|b| b.value()).collect(),
            root: solution.inverse.iter().map(|r| r.value()).collect(),
            s: solution.deviation().map(Real::value),
            df_residual: solution.df_residual(),
            greatest_leverage: rows.iter().map(|r| r.leverage).fold(0.0, f64::max),
            terms: terms.to_vec(),
            axes,
        }
    }

    /// The values of the terms at a point given in coded units.
    fn basis<'a>(&'a self, coded: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let axes = self.axes.len();
        (0..self.terms.len()).map(move |term| {
            let powers = &self.powers[term * axes..(term + 1) * axes];
            powers.iter().zip(coded).fold(1.0, |product, (&power, &u)| (0..power).fold(product, |p, _| p * u))
        })
    }

    /// The model's value at a point in natural units, one number per axis.
    pub fn value(&self, point: &[f64]) -> f64 {
        let coded: Vec<f64> = self.axes.iter().zip(point).map(|(axis, &x)| axis.coded(x)).collect();
        self.value_coded(&coded)
    }

    /// The model's value at a point in coded units.
    pub fn value_coded(&self, coded: &[f64]) -> f64 {
        self.basis(coded).zip(&self.coefficients).fold(0.0, |sum, (f, b)| sum + f * b)
    }

    /// Value, intervals of the given coverage (such as 0.95) and flags at a point in natural units.
    pub fn predict(&self, point: &[f64], coverage: f64) -> Prediction {
        let coded: Vec<f64> = self.axes.iter().zip(point).map(|(axis, &x)| axis.coded(x)).collect();
        let basis: Vec<f64> = self.basis(&coded).collect();
        let count = basis.len();
        let leverage = (0..count).fold(0.0, |sum, j| {
            let entry = (0..=j).fold(0.0, |s, i| s + basis[i] * self.root[i * count + j]);
            sum + entry * entry
        });
        let value = basis.iter().zip(&self.coefficients).fold(0.0, |sum, (f, b)| sum + f * b);
        let quantile = t_for_coverage(coverage, self.df_residual as f64);
        let about = |share: f64| {
            self.s.map(|s| {
                let reach = quantile * s * share.sqrt();
                (value - reach, value + reach)
            })
        };
        let outside = self.axes.iter().zip(point).filter(|(axis, x)| !axis.holds(**x));
        Prediction {
            value,
            std_error: self.s.map(|s| s * leverage.sqrt()),
            confidence: about(leverage),
            prediction: about(1.0 + leverage),
            leverage,
            outside: outside.map(|(axis, _)| axis.name.clone()).collect(),
            far: leverage > self.greatest_leverage * (1.0 + 1e-9),
        }
    }
}
