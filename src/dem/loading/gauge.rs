//! Lateral strain from pairs of balls at the sides of a specimen.
//!
//! The middle half of the height is cut into slices two mean diameters high. In each slice the ball that reaches farthest
//! left and the one that reaches farthest right are a gauge of length L₀ with strain (L − L₀)/L₀, extension positive. The
//! strain of the specimen is the mean of the middle half of all gauges in order of size (interquartile mean): where a
//! flake has come off the side, its gauge does not count.
//!
//! Lengths in metres; the loading axis is y.

use crate::genesis::region::Point;

/// Gauges across a specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauges {
    /// Left ball, right ball, distance along x at the start (m).
    pairs: Vec<(usize, usize, f64)>,
}

impl Gauges {
    /// Gauges on the balls of a specimen of `height` centred at the origin. A specimen of few balls has few gauges, but
    /// at least one.
    pub fn new(height: f64, centres: &[Point], radii: &[f64]) -> Self {
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        let slices = ((0.5 * height / (4.0 * mean)) as usize).max(1);
        let slice_of = |y: f64| {
            let share = y / (0.5 * height) + 0.5;
            (0.0..1.0).contains(&share).then_some((share * slices as f64) as usize)
        };
        let mut ends: Vec<Option<(usize, usize)>> = vec![None; slices];
        for (i, centre) in centres.iter().enumerate() {
            let Some(slice) = slice_of(centre[1]) else { continue };
            let (left, right) = ends[slice].unwrap_or((i, i));
            let left = if centre[0] - radii[i] < centres[left][0] - radii[left] { i } else { left };
            let right = if centre[0] + radii[i] > centres[right][0] + radii[right] { i } else { right };
            ends[slice] = Some((left, right));
        }
        let length = |(left, right): (usize, usize)| (left, right, centres[right][0] - centres[left][0]);
        let pairs = ends.into_iter().flatten().map(length).filter(|gauge| gauge.2 > 0.0).collect();
        Self { pairs }
    }

    /// Number of gauges.
    pub fn count(&self) -> usize {
        self.pairs.len()
    }

    /// The balls whose positions are read.
    pub fn balls(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.iter().flat_map(|&(left, right, _)| [left, right])
    }

    /// Lateral strain, given the present x of any ball (m).
    pub fn strain(&self, x: impl Fn(usize) -> f64) -> f64 {
        let strain = |&(left, right, length): &(usize, usize, f64)| (x(right) - x(left)) / length - 1.0;
        let mut strains: Vec<f64> = self.pairs.iter().map(strain).collect();
        strains.sort_by(f64::total_cmp);
        let cut = strains.len() / 4;
        let middle = &strains[cut..strains.len() - cut];
        middle.iter().sum::<f64>() / middle.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> (Vec<Point>, Vec<f64>) {
        let at = |k: i32, n: i32| f64::from(k) - 0.5 * f64::from(n - 1);
        let centres = (0..20 * 40).map(|k| [at(k % 20, 20), at(k / 20, 40)]).collect();
        (centres, vec![0.5; 800])
    }

    #[test]
    fn a_uniform_strain_is_read_exactly() {
        let (centres, radii) = grid();
        let gauges = Gauges::new(40.0, &centres, &radii);
        assert_eq!(gauges.count(), 10);
        let strain = gauges.strain(|i| 1.002 * centres[i][0] + 5.0);
        assert!((strain - 0.002).abs() < 1e-14);
    }

    #[test]
    fn flakes_do_not_count() {
        let (centres, radii) = grid();
        let gauges = Gauges::new(40.0, &centres, &radii);
        let flake: Vec<usize> = gauges.balls().take(4).collect();
        let moved = |i: usize| 1.002 * centres[i][0] + if flake.contains(&i) { centres[i][0] } else { 0.0 };
        assert!((gauges.strain(moved) - 0.002).abs() < 1e-14);
    }
}
