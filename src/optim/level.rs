//! The parameters whose responses lie in given bands, and the nearest of them to a point.
//!
//! Sequential linearisation: at u the responses are taken as linear, and the allowed point nearest the preference that
//! meets them is one [`least_distance`] problem; the step towards it is halved while it makes the responses worse.

use super::constraint::Domain;
use super::least_distance::least_distance;
use super::solution_set::Model;
use nalgebra::DMatrix;

/// Largest relative difference of responses within the set.
const SAME: f64 = 1e-6;
/// Step of the finite differences, in ranges.
const DIFFERENCE: f64 = 1e-6;
/// Pivots below this part of the largest count as zero.
const RANK: f64 = 1e-6;

/// The set of points whose responses lie in given bands; a band of no width is a wanted value.
pub(super) struct Level<'a> {
    pub(super) domain: &'a Domain,
    pub(super) model: &'a Model<'a>,
    pub(super) wanted: Vec<[f64; 2]>,
}

/// The end of a band that is its reference: the lower one unless it is open.
fn reference([low, high]: [f64; 2]) -> f64 {
    if low.is_finite() { low } else { high }
}

/// How far apart the two ends of a band lie, relative to its reference.
fn width(band: [f64; 2]) -> f64 {
    (band[1] - band[0]) / size(reference(band))
}

fn size(w: f64) -> f64 {
    if w == 0.0 { 1.0 } else { w.abs() }
}

impl Level<'_> {
    /// Deviations from the reference of every band, relative where that is not zero.
    fn deviations(&self, unit: &[f64]) -> Option<Vec<f64>> {
        let y = (self.model)(&self.domain.natural(unit))?;
        Some(y.iter().zip(&self.wanted).map(|(y, &band)| (y - reference(band)) / size(reference(band))).collect())
    }

    /// What the deviations `d` pass the ends of their bands by: below the lower, above the upper.
    fn beyond(&self, d: &[f64]) -> Vec<[f64; 2]> {
        let one = |(&d, &band): (&f64, &[f64; 2])| match band {
            [low, high] if low == high => [d, d],
            [low, _] if low.is_finite() => [d, d - width(band)],
            // Open below: the reference is the upper end.
            [low, _] => [-low, d],
        };
        d.iter().zip(&self.wanted).map(one).collect()
    }

    /// The largest violation of a band.
    fn worst(&self, d: &[f64]) -> f64 {
        self.beyond(d).iter().fold(0.0_f64, |worst, [low, high]| worst.max(-low).max(*high))
    }

    pub(super) fn is_met(&self, unit: &[f64]) -> bool {
        self.deviations(unit).is_some_and(|d| d.iter().all(|d| !d.is_nan()) && self.worst(&d) <= SAME)
    }

    /// The sensitivities of the responses at an end of their band: those that tie the parameters.
    pub(super) fn active(&self, unit: &[f64]) -> Option<Vec<Vec<f64>>> {
        let ends = self.beyond(&self.deviations(unit)?);
        let tied = |[low, high]: &[f64; 2]| *low <= SAME || *high >= -SAME;
        Some(
            self.sensitivities(unit)?
                .into_iter()
                .zip(&ends)
                .filter(|(_, ends)| tied(ends))
                .map(|(row, _)| row)
                .collect(),
        )
    }

    /// Rows of derivatives of the deviations, one per response.
    fn sensitivities(&self, unit: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut rows = vec![Vec::with_capacity(unit.len()); self.wanted.len()];
        for j in 0..unit.len() {
            let at = |step: f64| {
                let mut moved = unit.to_vec();
                moved[j] = (unit[j] + step).clamp(0.0, 1.0);
                Some((moved[j], self.deviations(&moved)?))
            };
            let ((left, low), (right, high)) = (at(-DIFFERENCE)?, at(DIFFERENCE)?);
            for (row, (a, b)) in rows.iter_mut().zip(low.iter().zip(&high)) {
                row.push((b - a) / (right - left));
            }
        }
        Some(rows)
    }

    /// The point of the set nearest `preference`, sought from `start`.
    pub(super) fn nearest(&self, start: &[f64], preference: &[f64]) -> Option<Vec<f64>> {
        let mut unit = start.to_vec();
        for _ in 0..60 {
            let deviations = self.deviations(&unit)?;
            let aim = self.step(&unit, &deviations, &self.sensitivities(&unit)?, preference)?;
            let (mut part, limit) = (1.0, (2.0 * self.worst(&deviations)).max(0.02));
            let mut next = aim.clone();
            while part > 1e-3 && self.deviations(&next).is_none_or(|d| self.worst(&d) > limit) {
                part *= 0.5;
                next = unit.iter().zip(&aim).map(|(u, a)| u + part * (a - u)).collect();
            }
            let moved = unit.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            unit = self.domain.repair(&next);
            if moved < 1e-10 {
                break;
            }
        }
        Some(unit)
    }

    /// The allowed point nearest `preference` that meets the linearised responses, or as much of them as is allowed.
    fn step(&self, unit: &[f64], deviations: &[f64], rows: &[Vec<f64>], preference: &[f64]) -> Option<Vec<f64>> {
        let mut part = 1.0;
        for _ in 0..12 {
            let (mut g, mut h) = self.domain.walls_from(preference);
            for (row, [low, high]) in rows.iter().zip(self.beyond(deviations)) {
                let length = dot(row, row).sqrt();
                if length == 0.0 {
                    continue;
                }
                let offset: f64 = row.iter().zip(unit.iter().zip(preference)).map(|(r, (u, p))| r * (u - p)).sum();
                // Only what is passed is approached in parts: the other end of a band must hold at once.
                let share =
                    |passed: f64, is: bool| (offset - if is || low == high { part * passed } else { passed }) / length;
                if low.is_finite() {
                    g.push(row.iter().map(|r| r / length).collect());
                    h.push(share(low, low < 0.0));
                }
                if high.is_finite() {
                    g.push(row.iter().map(|r| -r / length).collect());
                    h.push(-share(high, high > 0.0));
                }
            }
            if let Ok(y) = least_distance(&g, &h) {
                return Some(preference.iter().zip(y).map(|(p, y)| (p + y).clamp(0.0, 1.0)).collect());
            }
            part *= 0.5;
        }
        None
    }
}

/// By elimination with full pivoting, whose pivots fall off as the singular values do.
pub(super) fn rank(rows: &[Vec<f64>], columns: usize) -> usize {
    let upper = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]).full_piv_lu().u();
    let pivots: Vec<f64> = (0..rows.len().min(columns)).map(|i| upper[(i, i)].abs()).collect();
    let largest = pivots.iter().fold(0.0_f64, |m, &v| m.max(v));
    pivots.iter().filter(|&&v| v > RANK * largest).count()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Proportional rows count once, as do those that differ by rounding.
    #[test]
    fn the_rank_is_that_of_the_independent_rows() {
        let (a, b) = (vec![1.0, 2.0, 3.0], vec![-4.0, 0.5, 1.0]);
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.1 * a + 0.7 * b).collect();
        assert_eq!(rank(&[a.clone(), b.clone(), sum.clone()], 3), 2);
        assert_eq!(rank(&[a.clone(), a.iter().map(|a| -3.0 * a).collect()], 3), 1);
        assert_eq!(rank(&[vec![0.0; 3]], 3), 0);
        assert_eq!(rank(&[a, b, vec![0.0, 0.0, 1e-3]], 3), 3);
    }
}
