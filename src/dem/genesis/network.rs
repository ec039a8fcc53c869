//! A network of fractures by its statistics.
//!
//! * **Position**: uniform, in the box of the region widened by half the largest size on every side, so that the edges see what the
//!   middle sees.
//! * **Size** (length; diameter of the disc in space): density ∝ l^(−a) between two ends.
//! * **Orientation**: in space Fisher's law about the mean normal, density ∝ exp(κ cos θ) (Fisher 1953,
//!   doi:10.1098/rspa.1953.0064): cos θ = 1 + ln(u + (1 − u) e^(−2κ))/κ; in the plane von Mises' law of the dip, density
//!   ∝ exp(κ cos θ). κ = 0 has no preference.
//! * **Intensity**: length per area (P21) in the plane, area per volume (P32) in space, over the widened box; fractures are
//!   drawn until it is reached as nearly as the last one can.
//!
//! Given back are those that reach the box of the region.

use math::elementary::{cos, exp, ln, pow, sin};
use math::random::Stream;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Statistics of a network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// P21 or P32 (1/m).
    pub intensity: f64,
    /// Exponent a of the sizes.
    pub exponent: f64,
    /// Smallest and largest size (m).
    pub sizes: [f64; 2],
    /// Mean dip and its azimuth (rad).
    pub mean: [f64; 2],
    /// κ.
    pub concentration: f64,
    /// Seed of the campaign; each piece mixes its own into it.
    pub seed: u64,
}

/// One drawn fracture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Its middle, from that of the region (m).
    pub centre: [f64; 3],
    /// Unit normal; without z in the plane.
    pub normal: [f64; 3],
    /// Length or diameter (m).
    pub size: f64,
}

impl Network {
    /// How many are drawn on average over a box, before those that do not reach it are left out.
    pub fn expected(&self, extents: [f64; 3], dimension: usize) -> f64 {
        self.intensity * self.volume(extents, dimension) / self.mean_measure(dimension)
    }

    /// The fractures that reach a box of these extents about the origin, in the order in which they are drawn.
    pub fn draw(&self, extents: [f64; 3], dimension: usize, stream: &mut Stream) -> Vec<Drawn> {
        let mut all = self.scattered(extents, dimension, stream);
        all.retain(|drawn| reaches(drawn, extents, dimension));
        all
    }

    /// All fractures of the widened box.
    fn scattered(&self, extents: [f64; 3], dimension: usize, stream: &mut Stream) -> Vec<Drawn> {
        let wanted = self.intensity * self.volume(extents, dimension);
        let (mut all, mut sum) = (Vec::new(), 0.0);
        loop {
            let size = self.size(stream.uniform());
            let measure = measure(size, dimension);
            // The last one counts if it brings the sum nearer to what is wanted.
            if sum + 0.5 * measure > wanted {
                break;
            }
            sum += measure;
            let room = |k: usize| 0.5 * (extents[k] + self.sizes[1]);
            let centre =
                std::array::from_fn(|k| if k < dimension { stream.uniform_in(-room(k), room(k)) } else { 0.0 });
            let normal = if dimension == 2 { self.plane_normal(stream) } else { self.solid_normal(stream) };
            all.push(Drawn { centre, normal, size });
        }
        all
    }

    fn volume(&self, extents: [f64; 3], dimension: usize) -> f64 {
        extents[..dimension].iter().map(|edge| edge + self.sizes[1]).product()
    }

    /// ∫ l^p of the size's density between its ends, but for its norm.
    fn moment(&self, power: f64) -> f64 {
        let (k, [low, high]) = (power - self.exponent + 1.0, self.sizes);
        if k.abs() < 1e-12 { ln(high / low) } else { (pow(high, k) - pow(low, k)) / k }
    }

    /// Mean length or area of a fracture.
    fn mean_measure(&self, dimension: usize) -> f64 {
        let power = dimension as f64 - 1.0;
        measure(1.0, dimension) * self.moment(power) / self.moment(0.0)
    }

    /// The size below which a share `u` of all is.
    fn size(&self, u: f64) -> f64 {
        let (k, [low, high]) = (1.0 - self.exponent, self.sizes);
        if k.abs() < 1e-12 {
            return low * pow(high / low, u);
        }
        pow(pow(low, k) + u * (pow(high, k) - pow(low, k)), 1.0 / k).clamp(low, high)
    }

    fn plane_normal(&self, stream: &mut Stream) -> [f64; 3] {
        let turn = loop {
            let angle = stream.uniform_in(-PI, PI);
            if stream.uniform() <= exp(self.concentration * (cos(angle) - 1.0)) {
                break angle;
            }
        };
        let dip = self.mean[0] + turn;
        [sin(dip), cos(dip), 0.0]
    }

    fn solid_normal(&self, stream: &mut Stream) -> [f64; 3] {
        let (u, kappa) = (stream.uniform(), self.concentration);
        let cosine = if kappa < 1e-9 { 2.0 * u - 1.0 } else { 1.0 + ln(u + (1.0 - u) * exp(-2.0 * kappa)) / kappa };
        let cosine = cosine.clamp(-1.0, 1.0);
        let (sine, around) = ((1.0 - cosine * cosine).sqrt(), TAU * stream.uniform());
        let [dip, azimuth] = self.mean;
        // The mean normal, the direction of steepest descent, and the strike.
        let normal = [sin(dip) * cos(azimuth), cos(dip), sin(dip) * sin(azimuth)];
        let fall = [cos(dip) * cos(azimuth), -sin(dip), cos(dip) * sin(azimuth)];
        let strike = [-sin(azimuth), 0.0, cos(azimuth)];
        let (a, b) = (sine * cos(around), sine * sin(around));
        std::array::from_fn(|k| cosine * normal[k] + a * fall[k] + b * strike[k])
    }
}

/// Length of a line, area of a disc.
fn measure(size: f64, dimension: usize) -> f64 {
    if dimension == 2 { size } else { FRAC_PI_4 * size * size }
}

/// Whether any of it may lie in the box: in the plane exactly, in space when its ball reaches it.
fn reaches(drawn: &Drawn, extents: [f64; 3], dimension: usize) -> bool {
    if dimension == 2 {
        return length_inside([drawn.centre, drawn.normal], 0.5 * drawn.size, extents) > 0.0;
    }
    let outside = |k: usize| (drawn.centre[k].abs() - 0.5 * extents[k]).max(0.0);
    let square: f64 = (0..3).map(|k| outside(k) * outside(k)).sum();
    square < 0.25 * drawn.size * drawn.size
}

/// Length of a line of the plane in a rectangle about the origin (m), from its middle, its normal and half its length.
pub(crate) fn length_inside([centre, normal]: [[f64; 3]; 2], reach: f64, extents: [f64; 3]) -> f64 {
    let along = [normal[1], -normal[0]];
    let (mut from, mut to) = (-reach, reach);
    for k in 0..2 {
        let edges = [-0.5, 0.5].map(|side| side * extents[k] - centre[k]);
        if along[k].abs() < 1e-15 {
            if edges[0] > 0.0 || edges[1] < 0.0 {
                return 0.0;
            }
            continue;
        }
        let [a, b] = edges.map(|edge| edge / along[k]);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (to - from).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn network() -> Network {
        let (sizes, mean) = ([4e-3, 20e-3], [0.7, 0.4]);
        Network { intensity: 60.0, exponent: 2.5, sizes, mean, concentration: 12.0, seed: 0 }
    }

    const BOX: [f64; 3] = [0.05, 0.1, 0.04];

    #[test]
    fn the_region_has_the_length_per_area_that_is_asked_for() {
        let seeds = 200;
        let inside = |seed| {
            let all = network().draw(BOX, 2, &mut Stream::new(seed, "network", 0));
            let length = |one: &Drawn| length_inside([one.centre, one.normal], 0.5 * one.size, BOX);
            all.iter().map(length).sum::<f64>() / (BOX[0] * BOX[1])
        };
        let found: Vec<f64> = (0..seeds).map(inside).collect();
        let mean = found.iter().sum::<f64>() / seeds as f64;
        let spread = found.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (seeds as f64 - 1.0);
        let error = (spread / seeds as f64).sqrt();
        assert!((mean - 60.0).abs() < 3.0 * error && error < 1.5, "{mean} ± {error}");
    }

    #[test]
    fn sizes_follow_their_power_law() {
        // The share above l is (l^k − high^k)/(low^k − high^k), k = 1 − a.
        let wide = Network { intensity: 20.0, ..network() };
        for dimension in [2, 3] {
            let all = wide.scattered([1.0, 1.0, 0.3], dimension, &mut Stream::new(3, "network", 0));
            let count = all.len() as f64;
            assert!(count > 1000.0, "{count}");
            let expected = wide.expected([1.0, 1.0, 0.3], dimension);
            assert!((count / expected - 1.0).abs() < 0.03, "{count} {expected}");
            let share = all.iter().filter(|one| one.size > 8e-3).count() as f64 / count;
            let power = |x: f64| pow(x, -1.5);
            let law = (power(8e-3) - power(20e-3)) / (power(4e-3) - power(20e-3));
            assert!((share - law).abs() < 3.0 * (law * (1.0 - law) / count).sqrt(), "{share} {law}");
        }
    }

    #[test]
    fn normals_follow_the_laws_of_fisher_and_von_mises() {
        let wide = Network { intensity: 20.0, ..network() };
        for (dimension, length) in [
            // coth κ − 1/κ; I₁(κ)/I₀(κ) from tables (Abramowitz & Stegun 9.8: e^(−12) I₀(12) = 0.11642622, I₁ 0.11146430).
            (3, 1.0 / math::elementary::tanh(12.0) - 1.0 / 12.0),
            (2, 0.111_464_30 / 0.116_426_22),
        ] {
            let all = wide.scattered([1.0, 1.0, 0.3], dimension, &mut Stream::new(5, "network", 0));
            let count = all.len() as f64;
            let mean: [f64; 3] = std::array::from_fn(|k| all.iter().map(|one| one.normal[k]).sum::<f64>() / count);
            let wanted = if dimension == 2 {
                [sin(0.7), cos(0.7), 0.0]
            } else {
                [sin(0.7) * cos(0.4), cos(0.7), sin(0.7) * sin(0.4)]
            };
            let along: f64 = (0..3).map(|k| mean[k] * wanted[k]).sum();
            assert!((along - length).abs() < 0.01, "{dimension}: {along} {length}");
            let across: f64 = (0..3).map(|k| (mean[k] - along * wanted[k]) * (mean[k] - along * wanted[k])).sum();
            assert!(across.sqrt() < 0.02, "{across}");
            let unit = |one: &Drawn| one.normal.iter().map(|x| x * x).sum::<f64>();
            assert!(all.iter().all(|one| (unit(one) - 1.0).abs() < 1e-12));
        }
    }
}
