//! Seeded random streams with stable values.
//!
//! A stream is named by (seed, purpose, index): the three are hashed into the key of a ChaCha8 generator, so streams
//! are independent of one another and of the order in which they are made. The conversions to numbers are written
//! here and pinned by tests, because library ones may change their values between releases.

use crate::elementary::{cos, ln, pow};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// One independent stream of random numbers.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of `seed` for one `purpose` ("radii", "aggregate", …) and `index` (replicate, generation, …).
    pub fn new(seed: u64, purpose: &str, index: u64) -> Self {
        let mut hash = blake3::Hasher::new_derive_key("flow random stream 1");
        hash.update(&seed.to_le_bytes());
        hash.update(&index.to_le_bytes());
        hash.update(purpose.as_bytes());
        Self(ChaCha8Rng::from_seed(*hash.finalize().as_bytes()))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Uniform in [low, high); `low` when the interval is empty.
    pub fn uniform_in(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Uniform among 0 … n − 1, without bias (Lemire 2019, doi:10.1145/3230636). `n` must not be 0.
    pub fn below(&mut self, n: usize) -> usize {
        let n = n as u64;
        assert!(n > 0, "BUG: a choice among nothing");
        loop {
            let wide = u128::from(self.bits()) * u128::from(n);
            if (wide as u64) >= n.wrapping_neg() % n {
                return (wide >> 64) as usize;
            }
        }
    }

    /// Standard normal (Box–Muller, cosine branch: two uniforms a draw, so the stream's position is predictable).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * ln(1.0 - self.uniform())).sqrt();
        radius * cos(std::f64::consts::TAU * self.uniform())
    }

    /// Weibull with the given scale and shape.
    pub fn weibull(&mut self, scale: f64, shape: f64) -> f64 {
        scale * pow(-ln(1.0 - self.uniform()), 1.0 / shape)
    }

    /// Fisher–Yates shuffle in place.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written down once; a change of these values changes every specimen ever made.
    #[test]
    fn values_are_pinned() {
        let mut s = Stream::new(1, "test", 0);
        let drawn = [s.uniform(), s.uniform_in(-1.0, 1.0), s.normal(), s.weibull(2.0, 3.0), s.below(1000) as f64];
        assert_eq!(drawn, GOLDEN, "got {drawn:?}");
        let mut cards: Vec<u8> = (0..8).collect();
        s.shuffle(&mut cards);
        assert_eq!(cards, CARDS);
    }
    const GOLDEN: [f64; 5] = [0.3676333323198179, -0.28618743720392104, 1.345811012220993, 2.6582812818233683, 213.0];
    const CARDS: [u8; 8] = [1, 6, 7, 5, 3, 4, 0, 2];

    #[test]
    fn streams_differ_by_seed_purpose_and_index() {
        let first = |seed, purpose, index| Stream::new(seed, purpose, index).bits();
        let all = [first(1, "a", 0), first(2, "a", 0), first(1, "b", 0), first(1, "a", 1)];
        for (i, x) in all.iter().enumerate() {
            assert!(!all[..i].contains(x));
        }
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let mut s = Stream::new(7, "moments", 0);
        let n = 200_000;
        let (mut sum, mut square, mut hits) = (0.0, 0.0, [0_usize; 3]);
        for _ in 0..n {
            let z = s.normal();
            sum += z;
            square += z * z;
            hits[s.below(3)] += 1;
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 0.01 && (square / n - 1.0).abs() < 0.02);
        assert!(hits.iter().all(|&h| (h as f64 / n - 1.0 / 3.0).abs() < 0.005));
    }
}
