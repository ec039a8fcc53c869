//! Size distributions of the balls: a law of radii, what fixes its scale, and how many balls that makes.
//!
//! A law is its quantile function R(u), u uniform in (0, 1) **by number**; d is the dimension, V(R) the volume of a ball
//! (area of a disc).
//!
//! | law | R(u) |
//! |---|---|
//! | uniform by number | a + (b − a) u |
//! | uniform by volume: equal volumes in equal steps of R, number density ∝ R⁻ᵈ | (a^(1−d) − u (a^(1−d) − b^(1−d)))^(1/(1−d)) |
//! | log-normal, cut at its median times ρ^±½ | exp(s z), s² = ln(1 + c²), c deviation over mean before the cut |
//! | sieve curve | uniform by volume between neighbouring sieves, with the masses of the curve |
//! | classes | stated radii in stated numbers |
//!
//! Number of balls at the porosity n in the volume Ω:
//!
//! ```text
//! radii give way:   N = ⌊Ω (1 − n) / V(R̄)⌋, all radii then times one factor       Su et al. 2021 eq. (4)
//! number gives way: N = round(Ω (1 − n) / E[V(R)]), radii as they are
//! ```
//!
//! Radii of the first kind are independent draws for the uniform law. All others are one draw from each of N equal
//! strata of u, so that masses and means are those of the law and not those of a few large balls.
//!
//! Lengths in metres. Source: doi:10.3390/ma14071627, section 2.2.

use crate::space::Space;
use math::distribution::{normal_lower, normal_quantile};
use math::elementary::{exp, ln};
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// Law of the radii, without its scale where a [`Size`] gives it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SizeLaw {
    /// Uniform by number.
    Uniform {
        /// Largest over smallest radius.
        ratio: f64,
    },
    /// Uniform by volume.
    UniformVolume {
        /// Largest over smallest radius.
        ratio: f64,
    },
    /// Log-normal by number, cut on both sides.
    LogNormal {
        /// Largest over smallest radius.
        ratio: f64,
        /// Standard deviation over mean before the cut.
        deviation: f64,
    },
    /// Mass that passes each sieve; sizes are not scaled.
    Sieve {
        /// Increasing diameters (m).
        diameters: Vec<f64>,
        /// Share of the mass below each diameter, from 0 to 1.
        passing: Vec<f64>,
    },
    /// Radii in given numbers; sizes are not scaled.
    Classes {
        /// Radii (m).
        radii: Vec<f64>,
        /// Balls of each.
        counts: Vec<usize>,
    },
}

/// What fixes the scale of a law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Size {
    /// Mean radius by number (m).
    Mean(f64),
    /// Smallest radius (m).
    Smallest(f64),
    /// The law has sizes of its own.
    Stated,
}

/// What follows from the other: porosity (or stress), radii and number cannot all be chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GivesWay {
    /// The number follows from the stated size; the radii are multiplied by what is left over.
    #[default]
    Radius,
    /// The radii are as stated; the number follows.
    Number,
}

/// Sizes of the balls of a packing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sizes {
    /// Law.
    pub law: SizeLaw,
    /// Scale.
    pub size: Size,
    /// What gives way.
    pub gives_way: GivesWay,
}

/// Points of the quadrature for means over a law.
const QUADRATURE: usize = 4096;

impl Sizes {
    /// Uniform by number with a mean radius (m) that gives way.
    pub fn uniform(mean: f64, ratio: f64) -> Self {
        Self { law: SizeLaw::Uniform { ratio }, size: Size::Mean(mean), gives_way: GivesWay::Radius }
    }

    /// Mean radius by number (m).
    pub fn mean_radius<S: Space>(&self) -> f64 {
        match (&self.law, self.size) {
            (_, Size::Mean(mean)) => mean,
            (SizeLaw::Uniform { ratio }, Size::Smallest(smallest)) => 0.5 * smallest * (1.0 + ratio),
            _ => self.mean::<S>(|r| r),
        }
    }

    /// Number of balls at a porosity of the volume (m³, or m²).
    pub fn count<S: Space>(&self, volume: f64, porosity: f64) -> f64 {
        let solid = volume * (1.0 - porosity);
        match (&self.law, self.gives_way) {
            (SizeLaw::Classes { counts, .. }, _) => counts.iter().map(|&n| n as f64).sum(),
            (_, GivesWay::Radius) => (solid / S::volume(self.mean_radius::<S>())).floor(),
            (_, GivesWay::Number) => (solid / self.mean::<S>(S::volume)).round(),
        }
    }

    /// `count` radii (m); stratified ones from the largest down.
    pub fn draw<S: Space>(&self, count: usize, stream: &mut Stream) -> Vec<f64> {
        match (&self.law, self.gives_way) {
            (SizeLaw::Classes { radii, counts }, _) => {
                let class = |(&r, &n): (&f64, &usize)| std::iter::repeat_n(r, n);
                radii.iter().zip(counts).flat_map(class).collect()
            }
            (SizeLaw::Uniform { ratio }, GivesWay::Radius) => {
                let smallest = self.smallest_uniform(*ratio);
                (0..count).map(|_| stream.uniform_in(smallest, ratio * smallest)).collect()
            }
            _ => {
                let quantile = self.quantile::<S>();
                let stratum = |k: usize| quantile((k as f64 + stream.uniform()) / count as f64);
                (0..count).rev().map(stratum).collect()
            }
        }
    }

    /// Largest radius (m).
    pub fn largest<S: Space>(&self) -> f64 {
        match &self.law {
            SizeLaw::Classes { radii, .. } => radii.iter().copied().fold(0.0, f64::max),
            _ => self.quantile::<S>()(1.0),
        }
    }

    fn smallest_uniform(&self, ratio: f64) -> f64 {
        match self.size {
            Size::Mean(mean) => 2.0 * mean / (1.0 + ratio),
            Size::Smallest(smallest) => smallest,
            Size::Stated => 1.0,
        }
    }

    /// Mean of a function of the radius, by number.
    fn mean<S: Space>(&self, of: impl Fn(f64) -> f64) -> f64 {
        if let SizeLaw::Classes { radii, counts } = &self.law {
            let weighted: f64 = radii.iter().zip(counts).map(|(&r, &n)| n as f64 * of(r)).sum();
            return weighted / counts.iter().map(|&n| n as f64).sum::<f64>();
        }
        let quantile = self.quantile::<S>();
        let middle = |k: usize| of(quantile((k as f64 + 0.5) / QUADRATURE as f64));
        (0..QUADRATURE).map(middle).sum::<f64>() / QUADRATURE as f64
    }

    /// The quantile function, in metres.
    fn quantile<S: Space>(&self) -> Box<dyn Fn(f64) -> f64> {
        let shape = self.law.shape::<S>();
        let scale = match (&self.law, self.size) {
            (SizeLaw::Uniform { ratio }, _) => self.smallest_uniform(*ratio),
            (_, Size::Stated) => 1.0,
            (_, Size::Smallest(smallest)) => smallest / shape(0.0),
            (_, Size::Mean(mean)) => {
                let middle = |k: usize| shape((k as f64 + 0.5) / QUADRATURE as f64);
                mean * QUADRATURE as f64 / (0..QUADRATURE).map(middle).sum::<f64>()
            }
        };
        Box::new(move |u| scale * shape(u))
    }
}

impl SizeLaw {
    /// The quantile function up to a scale.
    fn shape<S: Space>(&self) -> Box<dyn Fn(f64) -> f64> {
        match self {
            &Self::Uniform { ratio } => Box::new(move |u| 1.0 + (ratio - 1.0) * u),
            &Self::UniformVolume { ratio } => Box::new(move |u| by_volume::<S>(1.0, ratio, u)),
            &Self::LogNormal { ratio, deviation } => {
                let spread = ln(1.0 + deviation * deviation).sqrt();
                let reach = 0.5 * ln(ratio);
                let cut = normal_lower(-reach / spread);
                Box::new(move |u| {
                    let z = normal_quantile((cut + (1.0 - 2.0 * cut) * u).clamp(cut, 1.0 - cut));
                    exp((spread * z).clamp(-reach, reach))
                })
            }
            Self::Sieve { diameters, passing } => sieve::<S>(diameters, passing),
            Self::Classes { radii, counts } => {
                let total: f64 = counts.iter().map(|&n| n as f64).sum();
                let (radii, counts) = (radii.clone(), counts.clone());
                Box::new(move |u| {
                    let mut below = 0.0;
                    let class = counts.iter().position(|&n| {
                        below += n as f64;
                        below > u * total
                    });
                    radii[class.unwrap_or(radii.len() - 1)]
                })
            }
        }
    }
}

/// Quantile by number of radii from `low` to `high` that are uniform by volume.
fn by_volume<S: Space>(low: f64, high: f64, u: f64) -> f64 {
    if S::DIMENSION == 2 {
        return 1.0 / (1.0 / low - u * (1.0 / low - 1.0 / high));
    }
    let [a, b] = [low, high].map(|r| 1.0 / (r * r));
    1.0 / (a - u * (a - b)).sqrt()
}

/// Number of balls per volume between two radii that are uniform by volume.
fn number_density<S: Space>(low: f64, high: f64) -> f64 {
    let power =
        if S::DIMENSION == 2 { 1.0 / low - 1.0 / high } else { 0.5 * (1.0 / (low * low) - 1.0 / (high * high)) };
    power / (S::volume(1.0) * (high - low))
}

fn sieve<S: Space>(diameters: &[f64], passing: &[f64]) -> Box<dyn Fn(f64) -> f64> {
    let mut sum = 0.0;
    // Bounds of each class and the number of balls up to its end.
    let mut classes = Vec::new();
    for (d, p) in diameters.windows(2).zip(passing.windows(2)) {
        let [low, high] = [0.5 * d[0], 0.5 * d[1]];
        sum += (p[1] - p[0]) * number_density::<S>(low, high);
        classes.push((low, high, sum));
    }
    Box::new(move |u| {
        let at = u * sum;
        let k = classes.iter().position(|class| at < class.2).unwrap_or(classes.len() - 1);
        let before = if k == 0 { 0.0 } else { classes[k - 1].2 };
        let (low, high, up_to) = classes[k];
        by_volume::<S>(low, high, ((at - before) / (up_to - before)).clamp(0.0, 1.0))
    })
}

#[cfg(test)]
mod tests;
