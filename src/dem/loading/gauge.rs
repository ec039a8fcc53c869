//! Lateral strain from pairs of balls at the sides of a specimen.
//!
//! The middle half of the height is cut into slices two mean diameters high. In each slice, for each axis across the
//! load, the ball that reaches farthest to one side and the one that reaches farthest to the other are a gauge of length
//! L₀ with strain (L − L₀)/L₀, extension positive. The strain of an axis is the mean of the middle half of its gauges in
//! order of size (interquartile mean): where a flake has come off the side, its gauge does not count. The strain of the
//! specimen is the mean over the axes, x in the plane, x and z in the solid.
//!
//! Lengths in metres; the loading axis is y.

use crate::space::Tuple;
use crate::{Space, Vector};

/// Axes across the load; the plane has the first alone.
const ACROSS: [usize; 2] = [0, 2];

/// Two balls and their distance at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gauge {
    ends: [usize; 2],
    length: f64,
}

/// Gauges across a specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauges {
    /// Gauges along each axis across the load.
    axes: Vec<(usize, Vec<Gauge>)>,
}

impl Gauges {
    /// Gauges on the balls of a specimen of `height` centred at the origin. A specimen of few balls has few gauges, but
    /// at least one.
    pub fn new<S: Space>(height: f64, centres: &[Vector<S>], radii: &[f64]) -> Self {
        let along = |axis: usize| (axis, gauges::<S>(axis, height, centres, radii));
        Self { axes: ACROSS[..S::DIMENSION - 1].iter().map(|&axis| along(axis)).collect() }
    }

    /// Number of gauges.
    pub fn count(&self) -> usize {
        self.axes.iter().map(|(_, gauges)| gauges.len()).sum()
    }

    /// The balls whose positions are read.
    pub fn balls(&self) -> impl Iterator<Item = usize> + '_ {
        self.axes.iter().flat_map(|(_, gauges)| gauges.iter().flat_map(|gauge| gauge.ends))
    }

    /// Lateral strain, given the present centre of any ball (m).
    pub fn strain<S: Space>(&self, centre: impl Fn(usize) -> Vector<S>) -> f64 {
        let mean = |(axis, gauges): &(usize, Vec<Gauge>)| {
            let x = |ball: usize| centre(ball).at(*axis);
            let strain = |gauge: &Gauge| (x(gauge.ends[1]) - x(gauge.ends[0])) / gauge.length - 1.0;
            let mut strains: Vec<f64> = gauges.iter().map(strain).collect();
            strains.sort_by(f64::total_cmp);
            let cut = strains.len() / 4;
            let middle = &strains[cut..strains.len() - cut];
            middle.iter().sum::<f64>() / middle.len().max(1) as f64
        };
        self.axes.iter().map(mean).sum::<f64>() / self.axes.len() as f64
    }
}

fn gauges<S: Space>(axis: usize, height: f64, centres: &[Vector<S>], radii: &[f64]) -> Vec<Gauge> {
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let slices = ((0.5 * height / (4.0 * mean)) as usize).max(1);
    let slice_of = |y: f64| {
        let share = y / (0.5 * height) + 0.5;
        (0.0..1.0).contains(&share).then_some((share * slices as f64) as usize)
    };
    let x = |ball: usize| centres[ball].at(axis);
    let mut ends: Vec<Option<[usize; 2]>> = vec![None; slices];
    for (i, centre) in centres.iter().enumerate() {
        let Some(slice) = slice_of(centre.at(1)) else { continue };
        let [left, right] = ends[slice].unwrap_or([i, i]);
        let left = if x(i) - radii[i] < x(left) - radii[left] { i } else { left };
        let right = if x(i) + radii[i] > x(right) + radii[right] { i } else { right };
        ends[slice] = Some([left, right]);
    }
    let gauge = |ends: [usize; 2]| Gauge { ends, length: x(ends[1]) - x(ends[0]) };
    ends.into_iter().flatten().map(gauge).filter(|gauge| gauge.length > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{D2, D3};

    fn grid() -> (Vec<[f64; 2]>, Vec<f64>) {
        let at = |k: i32, n: i32| f64::from(k) - 0.5 * f64::from(n - 1);
        let centres = (0..20 * 40).map(|k| [at(k % 20, 20), at(k / 20, 40)]).collect();
        (centres, vec![0.5; 800])
    }

    #[test]
    fn a_uniform_strain_is_read_exactly() {
        let (centres, radii) = grid();
        let gauges = Gauges::new::<D2>(40.0, &centres, &radii);
        assert_eq!(gauges.count(), 10);
        let strain = gauges.strain::<D2>(|i| [1.002 * centres[i][0] + 5.0, centres[i][1]]);
        assert!((strain - 0.002).abs() < 1e-14);
    }

    #[test]
    fn flakes_do_not_count() {
        let (centres, radii) = grid();
        let gauges = Gauges::new::<D2>(40.0, &centres, &radii);
        let flake: Vec<usize> = gauges.balls().take(4).collect();
        let moved = |i: usize| {
            let x = centres[i][0];
            [1.002 * x + if flake.contains(&i) { x } else { 0.0 }, centres[i][1]]
        };
        assert!((gauges.strain::<D2>(moved) - 0.002).abs() < 1e-14);
    }

    /// ε_x = 0.002, ε_z = 0.004: the mean.
    #[test]
    fn a_block_has_gauges_along_both_axes_across_the_load() {
        let at = |k: usize, n: usize| k as f64 - 0.5 * (n - 1) as f64;
        let centre = |k: usize| [at(k % 6, 6), at(k / 36, 12), at(k / 6 % 6, 6)];
        let centres: Vec<[f64; 3]> = (0..6 * 6 * 12).map(centre).collect();
        let gauges = Gauges::new::<D3>(12.0, &centres, &vec![0.5; centres.len()]);
        assert_eq!(gauges.count(), 6);
        let strain = gauges.strain::<D3>(|i| [1.002 * centres[i][0], centres[i][1], 1.004 * centres[i][2]]);
        assert!((strain - 0.003).abs() < 1e-14, "{strain}");
    }
}
