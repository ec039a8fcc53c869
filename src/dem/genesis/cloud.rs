//! The loose cloud that a packing grows from: number of balls, radii, places at half size.
//!
//! ```text
//! N = ⌊A (1 − n) / (π R̄²)⌋                                                                Su et al. 2021 eq. (4)
//! m = R̄ / R̄₀ = √((1 − n) / (1 − n₀))                                                               eq. (5, 6)
//! ```
//!
//! Radii are uniform in [R_min, R_max] with R_max / R_min given. Equation (4) counts every ball with the *mean*
//! radius, yet the mean of R² exceeds R̄² by 1 + (ρ − 1)² / (3 (ρ + 1)²), ρ = R_max / R_min (6 % at ρ = 2.5). N balls of
//! the stated mean radius would therefore fill more than 1 − n: with n = 0.12 the porosity would come out at 0.066.
//! **N stays and the radii give way**: they are multiplied by one factor so that Σ π R² = (1 − n) A exactly, overlaps
//! counted twice ("ball porosity"). At ρ = 2.5 the mean radius becomes 0.971 of the stated one.
//!
//! The balls are placed at half their final size without overlap, so n₀ = 1 − (1 − n)/4 and the factor m of eq. (6) is
//! exactly 2.

use super::region::{Point, Region, norm};
use math::random::Stream;
use std::f64::consts::PI;

/// Number of balls of mean radius `mean` (m) that leave the porosity in `area` (m²), eq. (4).
pub fn ball_count(area: f64, porosity: f64, mean: f64) -> usize {
    (area * (1.0 - porosity) / (PI * mean * mean)).floor() as usize
}

/// `count` radii, uniform with the given mean and R_max / R_min (m).
pub fn uniform_radii(count: usize, mean: f64, ratio: f64, stream: &mut Stream) -> Vec<f64> {
    let smallest = 2.0 * mean / (1.0 + ratio);
    (0..count).map(|_| stream.uniform_in(smallest, ratio * smallest)).collect()
}

/// Multiplies all radii by the one factor that gives the ball porosity in `area`; returns the factor.
pub fn scale_to_porosity(radii: &mut [f64], area: f64, porosity: f64) -> f64 {
    let factor = ((1.0 - porosity) * area / ball_area(radii)).sqrt();
    for r in radii {
        *r *= factor;
    }
    factor
}

/// Σ π R² (m²).
pub fn ball_area(radii: &[f64]) -> f64 {
    PI * radii.iter().fold(0.0, |sum, r| sum + r * r)
}

/// Random centres for balls of half the given radii, inside `region` and without overlap. A ball that finds no place in
/// a thousand tries is put at the last one tried; the relaxation moves it.
pub fn scatter(radii: &[f64], region: &Region, stream: &mut Stream) -> Vec<Point> {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let mut grid = Bins::new(region.extent(), largest.max(1e-300));
    let mut centres: Vec<Point> = Vec::with_capacity(radii.len());
    let [width, height] = region.extent();
    for (i, r) in radii.iter().map(|r| 0.5 * r).enumerate() {
        let mut centre = [0.0; 2];
        for _ in 0..1000 {
            centre = [width * (stream.uniform() - 0.5), height * (stream.uniform() - 0.5)];
            let free = |j: usize| {
                let apart = [centres[j][0] - centre[0], centres[j][1] - centre[1]];
                norm(apart) >= r + 0.5 * radii[j]
            };
            if region.depth(centre) >= r && grid.near(centre).all(free) {
                break;
            }
        }
        grid.add(centre, i);
        centres.push(centre);
    }
    centres
}

/// Square bins over a region centred at the origin.
pub(super) struct Bins {
    low: Point,
    side: f64,
    count: [usize; 2],
    members: Vec<Vec<usize>>,
}

impl Bins {
    /// Bins of at least `side` over `extent` (m).
    pub(super) fn new(extent: Point, side: f64) -> Self {
        let count = extent.map(|length| ((length / side) as usize).clamp(1, 4096));
        let members = vec![Vec::new(); count[0] * count[1]];
        let side = (extent[0] / count[0] as f64).max(extent[1] / count[1] as f64);
        Self { low: [-0.5 * extent[0], -0.5 * extent[1]], side, count, members }
    }

    fn cell(&self, point: Point) -> [usize; 2] {
        let along = |k: usize| (((point[k] - self.low[k]) / self.side).max(0.0) as usize).min(self.count[k] - 1);
        [along(0), along(1)]
    }

    /// Puts item `index` at `point`.
    pub(super) fn add(&mut self, point: Point, index: usize) {
        let [x, y] = self.cell(point);
        self.members[y * self.count[0] + x].push(index);
    }

    /// Items in the bin of `point` and its eight neighbours, in the order of bins and adding.
    pub(super) fn near(&self, point: Point) -> impl Iterator<Item = usize> + '_ {
        let [x, y] = self.cell(point);
        let columns = x.saturating_sub(1)..=(x + 1).min(self.count[0] - 1);
        let rows = y.saturating_sub(1)..=(y + 1).min(self.count[1] - 1);
        rows.flat_map(move |row| {
            columns.clone().flat_map(move |column| self.members[row * self.count[0] + column].iter().copied())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_specimen_has_22409_balls() {
        assert_eq!(ball_count(0.2 * 0.1, 0.12, 0.5e-3), 22_409);
    }

    /// E[R²]/R̄² = 1 + (ρ−1)²/(3(ρ+1)²), hence the factor and the porosity without it.
    #[test]
    fn radii_give_way_to_the_porosity() {
        let mut radii = uniform_radii(22_409, 0.5e-3, 2.5, &mut Stream::new(1, "radii", 0));
        let without = 1.0 - ball_area(&radii) / 0.02;
        assert!((without - 0.066).abs() < 8e-3, "{without}");
        let factor = scale_to_porosity(&mut radii, 0.02, 0.12);
        assert!((ball_area(&radii) / 0.02 - 0.88).abs() < 1e-12);
        let second_moment = 1.0 + (1.5_f64 / 3.5).powi(2) / 3.0;
        assert!((factor - second_moment.sqrt().recip()).abs() < 4e-3);
        let (low, high) = radii.iter().fold((f64::MAX, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
        assert!((high / low - 2.5).abs() < 1e-3);
    }

    #[test]
    fn half_size_balls_lie_inside_without_overlap() {
        for region in [Region::Rectangle { width: 1.0, height: 2.0 }, Region::Disc { diameter: 1.5 }] {
            let mut radii = uniform_radii(400, 0.03, 2.5, &mut Stream::new(1, "radii", 0));
            scale_to_porosity(&mut radii, region.area(), 0.12);
            let centres = scatter(&radii, &region, &mut Stream::new(1, "places", 0));
            for i in 0..400 {
                assert!(region.depth(centres[i]) >= 0.5 * radii[i]);
                for j in 0..i {
                    let apart = norm([centres[i][0] - centres[j][0], centres[i][1] - centres[j][1]]);
                    assert!(apart >= 0.5 * (radii[i] + radii[j]));
                }
            }
        }
    }
}
