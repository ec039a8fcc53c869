//! The loose cloud that a packing grows from: radii scaled to a porosity, positions at half size.
//!
//! ```text
//! m = R̄ / R̄₀ = ((1 − n) / (1 − n₀))^(1/d)                                               Su et al. 2021 eq. (5, 6)
//! ```
//!
//! Where the radii give way ([`super::sizes`]), eq. (4) counts every ball with the *mean* radius, yet the mean of R²
//! exceeds R̄² by 1 + (ρ − 1)² / (3 (ρ + 1)²), ρ = R_max / R_min (6 % at ρ = 2.5). N balls of the stated mean radius
//! would therefore fill more than 1 − n: with n = 0.12 the porosity would come out at 0.066. **N stays and the radii give
//! way**: they are multiplied by one factor so that Σ V(R) = (1 − n) Ω exactly, overlaps counted twice ("ball porosity").
//! At ρ = 2.5 the mean radius becomes 0.971 of the stated one.
//!
//! The balls are placed at half their final size without overlap, so 1 − n₀ = (1 − n)/2ᵈ and the factor m of eq. (6) is
//! exactly 2.

use super::heap::ball_volume;
use super::region::Region;
use crate::space::{Space, Tuple, Vector};
use math::elementary::cbrt;
use math::random::Stream;

/// Multiplies all radii by the one factor that gives the ball porosity in `volume`; returns the factor.
pub fn scale_to_porosity<S: Space>(radii: &mut [f64], volume: f64, porosity: f64) -> f64 {
    let growth = (1.0 - porosity) * volume / ball_volume::<S>(radii);
    let factor = if S::DIMENSION == 2 { growth.sqrt() } else { cbrt(growth) };
    for r in radii {
        *r *= factor;
    }
    factor
}

/// Random centres for balls of half the given radii, inside `region` and without overlap. A ball that finds no position in
/// a thousand tries is put at the last one tried; the relaxation moves it.
pub fn scatter<S: Space>(radii: &[f64], region: &Region, stream: &mut Stream) -> Vec<Vector<S>> {
    scatter_where::<S>(radii, region, &|_, _| true, stream)
}

/// The same at places that are free for a ball of half the radius, as `room(centre, half radius)` says. A ball that finds no
/// place is put at the last one tried that `room` allowed; after a million tries without one, at the last tried.
pub(super) fn scatter_where<S: Space>(
    radii: &[f64],
    region: &Region,
    room: &dyn Fn(Vector<S>, f64) -> bool,
    stream: &mut Stream,
) -> Vec<Vector<S>> {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let edges = region.edges();
    let mut grid = Bins::new(edges, largest.max(1e-300), S::DIMENSION);
    let mut centres: Vec<Vector<S>> = Vec::with_capacity(radii.len());
    for (i, r) in radii.iter().map(|r| 0.5 * r).enumerate() {
        let mut centre = Vector::<S>::zero();
        let mut allowed = false;
        for attempt in 0..1_000_000 {
            if allowed && attempt >= 1000 {
                break;
            }
            let tried = Vector::<S>::build(|k| edges[k] * (stream.uniform() - 0.5));
            let roomy = room(tried, r);
            if allowed && !roomy {
                continue;
            }
            (centre, allowed) = (tried, roomy);
            let free = |j: usize| centres[j].minus(centre).norm() >= r + 0.5 * radii[j];
            if roomy && region.depth::<S>(centre) >= r && grid.near::<S>(centre).all(free) {
                break;
            }
        }
        grid.add::<S>(centre, i);
        centres.push(centre);
    }
    centres
}

/// Bins of equal edges over the box around a region; balls are added one by one while positions are sought.
struct Bins {
    low: [f64; 3],
    side: f64,
    count: [usize; 3],
    members: Vec<Vec<usize>>,
}

impl Bins {
    /// Bins of at least `side` over `edges` (m).
    fn new(edges: [f64; 3], side: f64, dimension: usize) -> Self {
        let most = if dimension == 2 { 4096 } else { 256 };
        let count = edges.map(|length| ((length / side) as usize).clamp(1, most));
        let members = vec![Vec::new(); count.iter().product()];
        let side = (0..dimension).map(|k| edges[k] / count[k] as f64).fold(0.0, f64::max);
        Self { low: edges.map(|edge| -0.5 * edge), side, count, members }
    }

    fn cell<S: Space>(&self, point: Vector<S>) -> [usize; 3] {
        let point = crate::space::flat::<S>(point);
        std::array::from_fn(|k| (((point[k] - self.low[k]) / self.side).max(0.0) as usize).min(self.count[k] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }

    /// Puts item `index` at `point`.
    fn add<S: Space>(&mut self, point: Vector<S>, index: usize) {
        let bin = self.index(self.cell::<S>(point));
        self.members[bin].push(index);
    }

    /// Items in the bin of `point` and its neighbours, in the order of bins and adding.
    fn near<S: Space>(&self, point: Vector<S>) -> impl Iterator<Item = usize> + '_ {
        let home = self.cell::<S>(point);
        let [columns, rows, layers] =
            std::array::from_fn(|k| home[k].saturating_sub(1)..=(home[k] + 1).min(self.count[k] - 1));
        let bins = layers.flat_map(move |z| {
            let columns = columns.clone();
            rows.clone().flat_map(move |y| columns.clone().map(move |x| [x, y, z]))
        });
        bins.flat_map(move |bin| self.members[self.index(bin)].iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sizes::Sizes;
    use super::*;
    use crate::{D2, D3};

    #[test]
    fn the_published_specimen_has_22409_balls() {
        assert_eq!(Sizes::uniform(0.5e-3, 2.5).count::<D2>(0.2 * 0.1, 0.12), 22_409.0);
    }

    /// E[R²]/R̄² = 1 + (ρ−1)²/(3(ρ+1)²), hence the factor and the porosity without it.
    #[test]
    fn radii_give_way_to_the_porosity() {
        let mut radii = Sizes::uniform(0.5e-3, 2.5).draw::<D2>(22_409, &mut Stream::new(1, "radii", 0));
        let without = 1.0 - ball_volume::<D2>(&radii) / 0.02;
        assert!((without - 0.066).abs() < 8e-3, "{without}");
        let factor = scale_to_porosity::<D2>(&mut radii, 0.02, 0.12);
        assert!((ball_volume::<D2>(&radii) / 0.02 - 0.88).abs() < 1e-12);
        let second_moment = 1.0 + (1.5_f64 / 3.5).powi(2) / 3.0;
        assert!((factor - second_moment.sqrt().recip()).abs() < 4e-3);
        let (low, high) = radii.iter().fold((f64::MAX, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
        assert!((high / low - 2.5).abs() < 1e-3);
    }

    fn lie_apart<S: Space>(region: &Region, porosity: f64) {
        let mut radii = Sizes::uniform(0.03, 2.5).draw::<S>(400, &mut Stream::new(1, "radii", 0));
        scale_to_porosity::<S>(&mut radii, region.volume(), porosity);
        let centres = scatter::<S>(&radii, region, &mut Stream::new(1, "places", 0));
        for i in 0..400 {
            assert!(region.depth::<S>(centres[i]) >= 0.5 * radii[i]);
            for j in 0..i {
                assert!(centres[i].minus(centres[j]).norm() >= 0.5 * (radii[i] + radii[j]));
            }
        }
    }

    #[test]
    fn half_size_balls_lie_inside_without_overlap() {
        lie_apart::<D2>(&Region::Rectangle { width: 1.0, height: 2.0 }, 0.12);
        lie_apart::<D2>(&Region::Disc { diameter: 1.5 }, 0.12);
        lie_apart::<D3>(&Region::Box { width: 1.0, height: 2.0, depth: 0.5 }, 0.35);
        lie_apart::<D3>(&Region::Cylinder { diameter: 1.0, height: 2.0 }, 0.35);
    }
}
