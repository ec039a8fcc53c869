//! The point of a polyhedron nearest to the origin, or the proof that the polyhedron is empty.
//!
//! Least distance programming: minimise ‖y‖ subject to G y ≥ h. It is solved through one non-negative least-squares
//! problem, minimise ‖E w − f‖ with w ≥ 0, E = [Gᵀ; hᵀ], f = (0, …, 0, 1)ᵀ. With the residual r = E w − f the answer
//! is y = −r₁‥ₙ / rₙ₊₁; a vanishing residual proves that no y exists, and the rows with w > 0 contradict each other
//! (Farkas).
//!
//! Source: Lawson & Hanson, *Solving Least Squares Problems* (1974, SIAM 1995, doi:10.1137/1.9781611971217), chapter 23,
//! algorithms NNLS and LDP.

use nalgebra::{DMatrix, DVector};

/// Squared residual below which the inequalities count as contradictory (rows of G have unit length).
const EMPTY: f64 = 1e-18;
/// A dual value must exceed this to let a row in.
const DUAL: f64 = 1e-12;

/// The least y with `rows[i] · y ≥ bounds[i]` for all i, or the rows that contradict each other.
pub fn least_distance(rows: &[Vec<f64>], bounds: &[f64]) -> Result<Vec<f64>, Vec<usize>> {
    let Some(first) = rows.first() else { return Ok(Vec::new()) };
    let n = first.len();
    let e = DMatrix::from_fn(n + 1, rows.len(), |i, j| if i < n { rows[j][i] } else { bounds[j] });
    let mut f = DVector::zeros(n + 1);
    f[n] = 1.0;
    let w = non_negative_least_squares(&e, &f);
    let mut residual = -f;
    for (j, &weight) in w.iter().enumerate() {
        residual.axpy(weight, &e.column(j), 1.0);
    }
    if residual.norm_squared() < EMPTY {
        return Err((0..w.len()).filter(|&j| w[j] > 0.0).collect());
    }
    Ok((0..n).map(|i| -residual[i] / residual[n]).collect())
}

/// The w ≥ 0 with the least ‖E w − f‖ (active-set method NNLS).
fn non_negative_least_squares(e: &DMatrix<f64>, f: &DVector<f64>) -> Vec<f64> {
    let m = e.ncols();
    let mut w = vec![0.0; m];
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..3 * m + 10 {
        let residual = residual(e, f, &w);
        let candidate = (0..m)
            .filter(|j| !passive.contains(j))
            .map(|j| (j, e.column(j).dot(&residual)))
            .fold((m, DUAL), |best, this| if this.1 > best.1 { this } else { best });
        if candidate.0 == m {
            break;
        }
        passive.push(candidate.0);
        if !settle(e, f, &mut w, &mut passive) {
            break;
        }
    }
    w
}

/// Least squares over the passive columns, giving up those that would turn negative; false when the newest column
/// cannot stay (rounding), which ends the method.
fn settle(e: &DMatrix<f64>, f: &DVector<f64>, w: &mut [f64], passive: &mut Vec<usize>) -> bool {
    let newest = passive[passive.len() - 1];
    loop {
        let Some(z) = least_squares(e, f, passive) else {
            passive.pop();
            return false;
        };
        if passive.iter().zip(&z).any(|(&j, &value)| j == newest && value <= 0.0) && w[newest] == 0.0 {
            passive.retain(|&j| j != newest);
            return false;
        }
        let blocking = passive.iter().zip(&z).filter(|(_, value)| **value <= 0.0);
        let step = blocking.map(|(&j, &value)| w[j] / (w[j] - value)).fold(f64::INFINITY, f64::min);
        if step == f64::INFINITY {
            passive.iter().zip(&z).for_each(|(&j, &value)| w[j] = value);
            return true;
        }
        for (&j, &value) in passive.iter().zip(&z) {
            w[j] += step * (value - w[j]);
            if value <= 0.0 && w[j] <= 1e-15 {
                w[j] = 0.0;
            }
        }
        passive.retain(|&j| w[j] > 0.0);
    }
}

fn residual(e: &DMatrix<f64>, f: &DVector<f64>, w: &[f64]) -> DVector<f64> {
    let mut r = f.clone();
    for (j, &weight) in w.iter().enumerate() {
        r.axpy(-weight, &e.column(j), 1.0);
    }
    r
}

/// Unconstrained least squares on some columns; none when they are dependent.
fn least_squares(e: &DMatrix<f64>, f: &DVector<f64>, columns: &[usize]) -> Option<Vec<f64>> {
    if columns.len() > e.nrows() {
        return None;
    }
    let qr = e.select_columns(columns).qr();
    let mut right = f.clone();
    qr.q_tr_mul(&mut right);
    let r = qr.r();
    if (0..columns.len()).any(|j| r[(j, j)].abs() < 1e-13) {
        return None;
    }
    r.solve_upper_triangular(&right.rows(0, columns.len()).into_owned()).map(|z| z.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_on_a_half_plane_is_the_foot_of_the_perpendicular() {
        let y = least_distance(&[vec![0.6, 0.8]], &[2.0]).expect("feasible");
        assert!((y[0] - 1.2).abs() < 1e-12 && (y[1] - 1.6).abs() < 1e-12, "{y:?}");
    }

    /// Lawson & Hanson's corner: two constraints active at once.
    #[test]
    fn two_active_rows_meet_in_their_corner() {
        let y =
            least_distance(&[vec![1.0, 0.0], vec![0.0, 1.0], vec![-1.0, 0.0]], &[1.0, 2.0, -3.0]).expect("feasible");
        assert!((y[0] - 1.0).abs() < 1e-12 && (y[1] - 2.0).abs() < 1e-12, "{y:?}");
    }

    #[test]
    fn the_origin_itself_needs_no_move() {
        let y = least_distance(&[vec![1.0, 0.0], vec![0.0, -1.0]], &[-1.0, -0.5]).expect("feasible");
        assert!(y.iter().all(|v| v.abs() < 1e-12), "{y:?}");
    }

    #[test]
    fn contradicting_rows_are_named() {
        let rows = [vec![1.0, 0.0], vec![0.0, 1.0], vec![-1.0, 0.0]];
        assert_eq!(least_distance(&rows, &[2.0, 0.0, -1.0]), Err(vec![0, 2]));
    }

    /// Optimality (Karush–Kuhn–Tucker) on random polyhedra: y is a non-negative combination of its active rows.
    #[test]
    fn answers_meet_the_optimality_conditions() {
        let mut random = math::random::Stream::new(3, "least distance", 0);
        for _ in 0..200 {
            let inside: Vec<f64> = (0..5).map(|_| random.normal()).collect();
            let rows: Vec<Vec<f64>> = (0..12).map(|_| (0..5).map(|_| random.normal()).collect()).collect();
            let bounds: Vec<f64> = rows.iter().map(|row| dot(row, &inside) - random.uniform()).collect();
            let y = least_distance(&rows, &bounds).expect("`inside` is feasible");
            for (row, bound) in rows.iter().zip(&bounds) {
                assert!(dot(row, &y) >= bound - 1e-9);
            }
            // No feasible point is nearer: y · (x − y) ≥ 0 for the feasible x we know.
            let towards: f64 = y.iter().zip(&inside).map(|(a, b)| a * (b - a)).sum();
            assert!(towards > -1e-9, "{towards}");
        }
    }

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }
}
