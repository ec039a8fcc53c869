//! Least squares by orthogonal reduction: coefficients, their standard errors, and the quality of a fit.
//!
//! With `X = QR` (rows multiplied by the root of their weight) and `z = Qᵀy`: coefficients `b = R⁻¹z`, residual sum of
//! squares `SSE = |y|² − |z|²` taken from the reduced response itself, `s² = SSE/(n − p)`, standard error of `bᵢ` =
//! `s` times the norm of row i of `R⁻¹`. The total sum of squares is about the mean when the model has a constant as
//! its first column, about zero otherwise.
//!
//! Source: Draper and Smith, Applied Regression Analysis, 3rd ed., 1998, chapters 1–8.

use super::columns::Matrix;
use super::error::Fault;
use super::number::Real;
use super::sample::{Sample, Usable};
use super::triangle::Triangle;
use math::distribution::{f_upper, t_two_sided};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A table is computed in 31 digits as long as rows × columns² stays below this (some tens of milliseconds).
const SMALL: usize = 2_000_000;

/// Responses whose spread is below this share of their size are computed in 31 digits however large the table is: in
/// doubles the reduction itself would cost as many digits as the responses have in common.
const CLOSE: f64 = 1e-6;

/// Whether a fit is computed in pairs of doubles.
pub(crate) fn in_pairs(usable: &Usable, columns: usize) -> bool {
    let small = usable.rows.len().saturating_mul(columns).saturating_mul(columns) <= SMALL;
    small || usable.spread() < CLOSE * usable.largest()
}

/// A reduced table and its solution.
pub(crate) struct Solution<T> {
    /// `R`, with the rotated response as its last column.
    pub triangle: Triangle<T>,
    /// `b`.
    pub coefficients: Vec<T>,
    /// `R⁻¹`, row by row.
    pub inverse: Vec<T>,
    /// Whether the first column is the constant.
    pub constant: bool,
    /// Usable rows.
    pub rows: usize,
    /// The sum of squares that rounding alone can leave of an exact fit.
    rounding: T,
}

impl<T: Real> Solution<T> {
    /// Reduces and solves; `label` gives the term that a column belongs to.
    pub(crate) fn of(matrix: &Matrix, response: &str, label: impl Fn(usize) -> String) -> Result<Self, Vec<Fault>> {
        let triangle = Triangle::of(matrix);
        let terms = matrix.columns.len();
        let faults = aliases(&triangle, terms, response, label);
        if !faults.is_empty() {
            return Err(faults);
        }
        let constant = matrix.columns.first().is_some_and(Vec::is_empty);
        Ok(Self::solved(triangle, constant, super::triangle::Blocks::<T>::rows(matrix), matrix.rounding()))
    }

    /// The solution of a reduced table of full rank.
    fn solved(triangle: Triangle<T>, constant: bool, rows: usize, rounding: T) -> Self {
        let terms = triangle.width() - 1;
        let (coefficients, inverse) = (triangle.solve(terms, terms), triangle.inverse(terms));
        Self { coefficients, inverse, constant, rows, rounding, triangle }
    }

    /// The same response on fewer columns.
    pub(crate) fn with_terms(&self, columns: &[usize]) -> Self {
        let mut independent = columns.to_vec();
        independent.push(self.terms());
        let constant = self.constant && columns.first() == Some(&0);
        Self::solved(self.triangle.with_columns(&independent), constant, self.rows, self.rounding)
    }

    /// Number of coefficients.
    pub(crate) fn terms(&self) -> usize {
        self.triangle.width() - 1
    }

    /// Residual degrees of freedom.
    pub(crate) fn df_residual(&self) -> usize {
        self.rows - self.terms()
    }

    /// Residual sum of squares; zero when it is but the rounding of the responses.
    pub(crate) fn residual_squares(&self) -> T {
        let last = self.triangle.at(self.terms(), self.terms());
        let left = last * last;
        if self.is_something(left) { left } else { T::zero() }
    }

    /// Whether a sum of squares is more than the rounding of the responses.
    pub(crate) fn is_something(&self, squares: T) -> bool {
        let last = self.triangle.at(self.terms(), self.terms());
        squares > self.rounding + T::from(T::EXACT * T::EXACT) * (self.squares(0, self.terms()) + last * last)
    }

    /// Sum of squares that the columns `from..to` add to those before them.
    pub(crate) fn squares(&self, from: usize, to: usize) -> T {
        (from..to).fold(T::zero(), |sum, i| {
            let part = self.triangle.at(i, self.terms());
            sum + part * part
        })
    }

    /// Total sum of squares: about the mean with a constant, about zero without.
    pub(crate) fn total_squares(&self) -> T {
        self.squares(usize::from(self.constant), self.terms()) + self.residual_squares()
    }

    /// Residual standard deviation; `None` without degrees of freedom.
    pub(crate) fn deviation(&self) -> Option<T> {
        let df = self.df_residual();
        (df > 0).then(|| (self.residual_squares() / T::from(df as f64)).sqrt())
    }

    /// Norm of row `i` of `R⁻¹`: the standard error of coefficient `i` in units of `s`.
    pub(crate) fn relative_error(&self, i: usize) -> T {
        let terms = self.terms();
        let row = &self.inverse[i * terms + i..(i + 1) * terms];
        T::dot(row, row).sqrt()
    }

    /// `t` and `p` of every coefficient.
    pub(crate) fn coefficient(&self, i: usize) -> Estimate {
        let error = self.deviation().map(|s| s * self.relative_error(i));
        Estimate::new(self.coefficients[i], error, self.df_residual())
    }

    /// `p` of a coefficient for choosing terms: in an exact fit 0 for what the fit needs and 1 for what it does not.
    pub(crate) fn p_for_choice(&self, i: usize) -> Option<f64> {
        let exact = || {
            let part = self.coefficients[i] / self.relative_error(i);
            (self.df_residual() > 0).then(|| if self.is_something(part * part) { 0.0 } else { 1.0 })
        };
        self.coefficient(i).p.or_else(exact)
    }
}

/// A coefficient with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    pub estimate: f64,
    pub std_error: Option<f64>,
    pub t: Option<f64>,
    pub p: Option<f64>,
}

impl Estimate {
    /// `t` is left out where there is no error to divide by.
    pub(crate) fn new<T: Real>(estimate: T, std_error: Option<T>, df: usize) -> Self {
        let t = std_error.filter(|e| *e > T::zero()).map(|e| (estimate / e).value());
        Self {
            estimate: estimate.value(),
            std_error: std_error.map(Real::value),
            t,
            p: t.map(|t| t_two_sided(t, df as f64)),
        }
    }
}

/// How well a model fits, in the statistician's words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The response.
    pub response: String,
    /// Usable rows.
    pub n: usize,
    /// Rows without a value (failed or not done).
    pub missing: usize,
    /// Degrees of freedom of the model, the constant not counted.
    pub df_model: usize,
    /// Residual degrees of freedom.
    pub df_residual: usize,
    /// Residual standard deviation, in the unit of the response.
    pub s: Option<f64>,
    /// Whether the model has a constant. Without one the total sum of squares is about zero, not about the mean, so R²
    /// is the share of `Σy²` and compares only with that of another fit through the origin.
    pub constant: bool,
    /// Coefficient of determination: about the mean with a constant, about zero without.
    pub r2: f64,
    /// `1 − SSE/Σ(y − ȳ)²` of a model without a constant, which compares with R² of one that has it; it is negative when
    /// the mean alone explains more.
    pub r2_about_mean: Option<f64>,
    /// R² adjusted for degrees of freedom.
    pub r2_adjusted: Option<f64>,
    /// Predicted R²: `1 − PRESS/SST`.
    pub r2_predicted: Option<f64>,
    /// Sum of squared leave-one-out residuals.
    pub press: Option<f64>,
    /// F of the whole model.
    pub f: Option<f64>,
    /// Its tail probability.
    pub p: Option<f64>,
    /// Degrees of freedom of pure error: replicates.
    pub df_pure_error: usize,
    /// Pure-error sum of squares.
    pub ss_pure_error: f64,
    /// F of the lack of fit against pure error; `None` without both.
    pub lack_of_fit_f: Option<f64>,
    /// Its tail probability.
    pub lack_of_fit_p: Option<f64>,
}

impl Fit {
    /// The summary of a solution; `press` is `None` where a row has leverage 1, `about_mean` is `Σw(y − ȳ)²`
    /// where the model has no constant.
    pub(crate) fn of<T: Real>(
        solution: &Solution<T>,
        response: &str,
        missing: usize,
        press: Option<f64>,
        pure: PureError<T>,
        about_mean: Option<T>,
    ) -> Self {
        let df_residual = solution.df_residual();
        let df_model = solution.terms() - usize::from(solution.constant);
        let (error, total) = (solution.residual_squares(), solution.total_squares());
        let model = solution.squares(usize::from(solution.constant), solution.terms());
        let f = ratio(model, df_model, error, df_residual);
        let df_lack = df_residual.saturating_sub(pure.df);
        let lack = error - pure.squares;
        let lack = if lack > T::zero() { lack } else { T::zero() };
        let lack_of_fit_f = ratio(lack, df_lack, pure.squares, pure.df);
        let df_total = (df_model + df_residual) as f64;
        Self {
            response: response.into(),
            n: solution.rows,
            missing,
            df_model,
            df_residual,
            s: solution.deviation().map(Real::value),
            constant: solution.constant,
            r2: (model / total).value(),
            r2_about_mean: about_mean.map(|squares| (T::from(1.0) - error / squares).value()),
            r2_adjusted: (df_residual > 0)
                .then(|| (T::from(1.0) - error / total * T::from(df_total / df_residual as f64)).value()),
            r2_predicted: press.map(|press| 1.0 - press / total.value()),
            press,
            f,
            p: f.map(|f| f_upper(f, df_model as f64, df_residual as f64)),
            df_pure_error: pure.df,
            ss_pure_error: pure.squares.value(),
            lack_of_fit_f,
            lack_of_fit_p: lack_of_fit_f.map(|f| f_upper(f, df_lack as f64, pure.df as f64)),
        }
    }
}

/// `(a/df_a)/(b/df_b)`; `None` when a degree of freedom or the denominator is zero.
pub(crate) fn ratio<T: Real>(a: T, df_a: usize, b: T, df_b: usize) -> Option<f64> {
    (df_a > 0 && df_b > 0 && b > T::zero()).then(|| (a / T::from(df_a as f64) / (b / T::from(df_b as f64))).value())
}

/// `Σw(y − ȳ)²` of the usable rows.
pub(crate) fn squares_about_mean<T: Real>(sample: &Sample, usable: &Usable) -> T {
    let rows = || usable.rows.iter().zip(&usable.values).map(|(&row, &y)| (T::from(sample.weight(row)), T::from(y)));
    let (sum, weights) = rows().fold((T::zero(), T::zero()), |(s, w), (weight, y)| (s + weight * y, w + weight));
    let mean = sum / weights;
    rows().fold(T::zero(), |sum, (weight, y)| sum + weight * (y - mean) * (y - mean))
}

/// Scatter of replicates about their means.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PureError<T> {
    pub df: usize,
    pub squares: T,
}

impl<T: Real> PureError<T> {
    /// Rows that agree in all the listed factors are replicates.
    pub(crate) fn of(sample: &Sample, usable: &Usable, factors: &[usize]) -> Self {
        let settings = |&row: &usize| factors.iter().map(move |&f| (sample.factors[f].values[row] + 0.0).to_bits());
        let keys: Vec<u64> = usable.rows.iter().flat_map(settings).collect();
        let key = |row: usize| &keys[row * factors.len()..(row + 1) * factors.len()];
        let mut sorted: Vec<usize> = (0..usable.rows.len()).collect();
        sorted.par_sort_by(|&a, &b| key(a).cmp(key(b)));
        let mut pure = Self { df: 0, squares: T::zero() };
        for group in sorted.chunk_by(|&a, &b| key(a) == key(b)).filter(|group| group.len() > 1) {
            let weight = |i: usize| T::from(sample.weight(usable.rows[i]));
            let (sum, weights) = group.iter().fold((T::zero(), T::zero()), |(sum, weights), &i| {
                (sum + weight(i) * T::from(usable.values[i]), weights + weight(i))
            });
            let mean = sum / weights;
            for &i in group {
                let off = T::from(usable.values[i]) - mean;
                pure.squares = pure.squares + weight(i) * off * off;
            }
            pure.df += group.len() - 1;
        }
        pure
    }
}

/// The aliased terms of a reduced table, each with the terms that it is aliased with.
pub(crate) fn aliases<T: Real>(
    triangle: &Triangle<T>,
    terms: usize,
    response: &str,
    label: impl Fn(usize) -> String,
) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for (column, partners) in triangle.dependent(terms) {
        let term = label(column);
        let mut others: Vec<String> = partners.into_iter().map(&label).filter(|other| *other != term).collect();
        others.dedup();
        if others.len() > 1 {
            others.retain(|other| other != "const");
        }
        let known = faults.iter().any(|f| matches!(f, Fault::Aliased { term: t, .. } if *t == term));
        if !known {
            faults.push(Fault::Aliased { response: response.into(), term, others });
        }
    }
    faults
}
