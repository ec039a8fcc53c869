//! Which rows a model does not explain, and which rows make it what it is.
//!
//! For a row with residual `e`, weight `w`, leverage `h` (its diagonal entry of the hat matrix) and a fit with `p`
//! coefficients, `ν` residual degrees of freedom and deviation `s`:
//! internally studentized `r = e√w / (s√(1 − h))`; externally studentized `t = r √((ν − 1)/(ν − r²))`, the residual in
//! units of a deviation estimated without the row, distributed as t on ν − 1; Cook's distance
//! `D = r² h / ((1 − h) p)`; PRESS = `Σ w (e/(1 − h))²`.
//!
//! Rows are flagged, never dropped: outlier when `t` is significant at the level asked for after Bonferroni's
//! correction for having looked at every row; high leverage when `h > 2p/n`; influential when `D > 1`.
//! Source: Cook and Weisberg, Residuals and Influence in Regression, 1982, §2.1–3.5.

use super::columns::Matrix;
use super::fit::Solution;
use super::number::{PANEL, Real};
use super::triangle::{BLOCK, Blocks};
use math::distribution::t_for_tail;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// One row seen by a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// The row, from 1, in the table as given.
    pub row: usize,
    /// The measured value.
    pub observed: f64,
    /// The model's value.
    pub fitted: f64,
    /// Observed minus fitted.
    pub residual: f64,
    /// Diagonal entry of the hat matrix, 0 … 1.
    pub leverage: f64,
    /// Internally studentized residual; `None` at leverage 1 or without error.
    pub standardized: Option<f64>,
    /// Externally studentized residual; `None` at leverage 1 or without error.
    pub studentized: Option<f64>,
    /// Cook's distance.
    pub cook: Option<f64>,
    /// The residual is too large to be chance, Bonferroni-corrected, or the row alone makes all of the error.
    pub outlier: bool,
    /// Leverage above twice the mean.
    pub high_leverage: bool,
    /// Cook's distance above 1.
    pub influential: bool,
}

/// Fitted value, residual (as measured) and leverage of each usable row.
struct Raw {
    fitted: f64,
    residual: f64,
    weighted: f64,
    leverage: f64,
    /// `1 − h`, taken before rounding.
    free: f64,
}

/// All rows, and PRESS (`None` where a row has leverage 1).
pub(crate) fn residuals<T: Real>(
    matrix: &Matrix,
    solution: &Solution<T>,
    rows: &[usize],
    values: &[f64],
    alpha: f64,
) -> (Vec<Residual>, Option<f64>) {
    let starts: Vec<usize> = (0..rows.len()).step_by(BLOCK).collect();
    let raw: Vec<Raw> = starts
        .into_par_iter()
        .flat_map_iter(|start| block(matrix, solution, start..rows.len().min(start + BLOCK)))
        .collect();
    let press = raw.iter().try_fold(0.0, |sum, r| {
        let left_out = r.weighted / r.free;
        (r.free > 1e-12).then_some(sum + left_out * left_out)
    });
    let df = solution.df_residual().saturating_sub(1);
    let limit = t_for_tail(alpha / rows.len() as f64, df as f64);
    let judged = raw.iter().zip(rows.iter().zip(values)).map(|(raw, (&row, &observed))| {
        let mut residual = judge(raw, solution);
        residual.row = row + 1;
        residual.observed = observed;
        let alone = residual.standardized.is_some() && df > 0;
        residual.outlier = residual.studentized.map_or(alone, |t| t.abs() > limit);
        residual
    });
    (judged.collect(), press)
}

/// Fitted values and leverages of a block: `|R⁻ᵀx|²` by forward substitution, all rows at once.
fn block<T: Real>(matrix: &Matrix, solution: &Solution<T>, rows: Range<usize>) -> Vec<Raw> {
    let (height, terms) = (rows.len(), solution.terms());
    let mut entries = vec![T::zero(); height * (terms + 1)];
    matrix.fill(rows.clone(), &mut entries);
    let mut fitted = vec![T::zero(); height];
    for (&b, column) in solution.coefficients.iter().zip(entries.chunks_exact(height)) {
        T::add_multiple(&mut fitted, b, column);
    }
    let response = entries[terms * height..].to_vec();
    let mut leverage = vec![T::zero(); height];
    for j in 0..terms {
        let (done, rest) = entries.split_at_mut(j * height);
        let column = &mut rest[..height];
        let weight = |k: usize| -solution.triangle.at(k, j);
        let whole = j - j % PANEL;
        for k in (0..whole).step_by(PANEL) {
            let own = std::array::from_fn(|i| &done[(k + i) * height..(k + i + 1) * height]);
            T::add_multiples(column, std::array::from_fn(|i| weight(k + i)), own);
        }
        for k in whole..j {
            T::add_multiple(column, weight(k), &done[k * height..(k + 1) * height]);
        }
        let scale = T::from(1.0) / solution.triangle.at(j, j);
        for (entry, h) in column.iter_mut().zip(&mut leverage) {
            *entry = *entry * scale;
            *h = *h + *entry * *entry;
        }
    }
    let finish = |(i, row): (usize, usize)| {
        let root = matrix.root_weight::<T>(row);
        let weighted = response[i] - fitted[i];
        Raw {
            fitted: (fitted[i] / root).value(),
            residual: (weighted / root).value(),
            weighted: weighted.value(),
            leverage: leverage[i].value(),
            free: (T::from(1.0) - leverage[i]).value(),
        }
    };
    rows.enumerate().map(finish).collect()
}

fn judge<T: Real>(raw: &Raw, solution: &Solution<T>) -> Residual {
    let (terms, df) = (solution.terms() as f64, solution.df_residual() as f64);
    let s = solution.deviation().map_or(0.0, Real::value);
    let standardized = (s > 0.0 && raw.free > 1e-12).then(|| raw.weighted / (s * raw.free.sqrt()));
    let left = |r: f64| df - r * r;
    let studentized =
        standardized.filter(|&r| df > 1.0 && left(r) > 1e-12 * df).map(|r| r * ((df - 1.0) / left(r)).sqrt());
    let cook = standardized.map(|r| r * r * raw.leverage / (raw.free * terms));
    Residual {
        row: 0,
        observed: 0.0,
        fitted: raw.fitted,
        residual: raw.residual,
        leverage: raw.leverage,
        standardized,
        studentized,
        cook,
        outlier: false,
        high_leverage: raw.leverage > 2.0 * terms / solution.rows as f64,
        influential: cook.is_some_and(|d| d > 1.0),
    }
}
