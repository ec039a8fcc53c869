//! How evenly a sample fills its cube.

use crate::table::DesignTable;

/// Distances and discrepancy in the unit cube, u = (coded + 1) / 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Smallest Euclidean distance of two runs; NaN for more than 5000 runs.
    pub smallest_distance: f64,
    /// Centred L2 discrepancy (Hickernell 1998, *Math. Comp.* 67, 299, doi:10.1090/S0025-5718-98-00894-1),
    /// squared as is usual in programs; NaN for more than 5000 runs.
    pub discrepancy: f64,
}

/// More runs than this have too many pairs.
const MOST_RUNS: usize = 5000;

/// Spread of the rows.
pub fn spread(table: &DesignTable) -> Spread {
    let n = table.runs();
    if n > MOST_RUNS {
        return Spread { smallest_distance: f64::NAN, discrepancy: f64::NAN };
    }
    let rows: Vec<Vec<f64>> = table.coded.iter().map(|r| r.iter().map(|x| 0.5 * (x + 1.0)).collect()).collect();
    let mut least = f64::INFINITY;
    let (mut single, mut double) = (0.0, 0.0);
    for (i, a) in rows.iter().enumerate() {
        single += a.iter().map(|&x| (x - 0.5_f64).abs()).map(|d| 1.0 + 0.5 * d - 0.5 * d * d).product::<f64>();
        double += a.iter().map(|&x| 1.0 + (x - 0.5).abs()).product::<f64>();
        for b in &rows[..i] {
            let (mut square, mut product) = (0.0, 1.0);
            for (&x, &y) in a.iter().zip(b) {
                square += (x - y) * (x - y);
                product *= 1.0 + 0.5 * ((x - 0.5).abs() + (y - 0.5).abs() - (x - y).abs());
            }
            least = least.min(square);
            double += 2.0 * product;
        }
    }
    let (n, k) = (n as f64, table.factors.len() as i32);
    let whole = (0..k).fold(1.0, |product, _| product * 13.0 / 12.0);
    Spread { smallest_distance: least.sqrt(), discrepancy: whole - 2.0 / n * single + double / (n * n) }
}
