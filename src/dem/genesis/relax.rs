//! Rest state of a heap of frictionless discs in its vessel.
//!
//! Without friction and rotation the packing is a minimum of the overlap energy
//!
//! ```text
//! W = Σ ½ kn U²,   kn = E* t 2 min(R₁, R₂)/(R₁ + R₂) between balls,  2 E* t at a wall (E* t = 1 here)
//! ```
//!
//! so it is found by a minimiser and not by waiting for dampers: FIRE (fast inertial relaxation engine), which moves
//! unit masses along the force, turns their velocity towards the force while the power is positive and stops them
//! when it turns negative. No displacement exceeds a tenth of the smallest radius in a step ("calm"). The scale
//! of kn does not matter: the minimum is the same for every modulus.
//!
//! Sums run over one list of pairs sorted by index, so the bits do not depend on anything but the input.
//!
//! Source: Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201, doi:10.1103/PhysRevLett.97.170201; Guénolé et al. 2020,
//! Comput. Mater. Sci. 175, 109584 (semi-implicit form).

use super::cloud::Bins;
use super::region::{Point, Region, norm};
use crate::Watch;

/// Discs in a vessel (m).
#[derive(Clone, Debug)]
pub struct Heap {
    /// Vessel.
    pub region: Region,
    /// Centres.
    pub centres: Vec<Point>,
    /// Radii.
    pub radii: Vec<f64>,
}

/// How a relaxation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Iterations used.
    pub iterations: usize,
    /// Mean unbalanced force of the balls over the mean contact force.
    pub unbalanced: f64,
}

/// Two discs, or a disc and a wall (`second` is then `None`), that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Index of the first ball.
    pub first: usize,
    /// Index of the second ball, larger than the first.
    pub second: Option<usize>,
    /// Overlap, positive (m).
    pub overlap: f64,
    /// Unit vector from the first ball to the second, or to the wall.
    pub normal: Point,
    /// Normal stiffness per E* t.
    pub stiffness: f64,
}

impl Heap {
    /// All pairs whose surfaces are nearer than `margin` (m), each once with the smaller index first, sorted.
    pub fn pairs(&self, margin: f64) -> Vec<(usize, usize)> {
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let mut bins = Bins::new(self.region.extent(), 2.0 * largest + margin);
        for (i, &centre) in self.centres.iter().enumerate() {
            bins.add(centre, i);
        }
        let mut pairs = Vec::with_capacity(4 * self.radii.len());
        for (i, &centre) in self.centres.iter().enumerate() {
            let start = pairs.len();
            for j in bins.near(centre).filter(|&j| j > i) {
                let reach = self.radii[i] + self.radii[j] + margin;
                let apart = [self.centres[j][0] - centre[0], self.centres[j][1] - centre[1]];
                if apart[0] * apart[0] + apart[1] * apart[1] < reach * reach {
                    pairs.push((i, j));
                }
            }
            pairs[start..].sort_unstable();
        }
        pairs
    }

    /// The touch of two balls, if they overlap.
    pub fn touch(&self, i: usize, j: usize) -> Option<Touch> {
        let apart = [self.centres[j][0] - self.centres[i][0], self.centres[j][1] - self.centres[i][1]];
        let (ri, rj) = (self.radii[i], self.radii[j]);
        let square = apart[0] * apart[0] + apart[1] * apart[1];
        if square >= (ri + rj) * (ri + rj) {
            return None;
        }
        let distance = square.sqrt();
        let normal = if distance > 0.0 { [apart[0] / distance, apart[1] / distance] } else { [1.0, 0.0] };
        let stiffness = 2.0 * ri.min(rj) / (ri + rj);
        Some(Touch { first: i, second: Some(j), overlap: ri + rj - distance, normal, stiffness })
    }

    /// Calls `visit` for every overlapping pair among `pairs`, then for every ball that overlaps a wall.
    pub fn touches(&self, pairs: &[(usize, usize)], mut visit: impl FnMut(Touch)) {
        for &(i, j) in pairs {
            if let Some(touch) = self.touch(i, j) {
                visit(touch);
            }
        }
        for (i, (&centre, &radius)) in self.centres.iter().zip(&self.radii).enumerate() {
            self.region.walls_within(centre, radius, |wall| {
                let normal = [-wall.normal[0], -wall.normal[1]];
                visit(Touch { first: i, second: None, overlap: radius - wall.distance, normal, stiffness: 2.0 });
            });
        }
    }

    /// Moves the centres to a minimum of the overlap energy: until the mean unbalanced force is below `limit` times the
    /// mean contact force, or no ball overlaps anything, or `most` iterations are spent, or `watch` says stop.
    pub fn relax(&mut self, limit: f64, most: usize, watch: &dyn Fn() -> Watch) -> Rest {
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let (margin, longest) = (0.5 * smallest, 0.1 * smallest);
        let mut fire = Fire::new(self.radii.len());
        let mut pairs = self.pairs(margin);
        let mut built_at = self.centres.clone();
        let mut force = vec![[0.0; 2]; self.radii.len()];
        let mut unbalanced = f64::INFINITY;
        for iterations in 0..most {
            unbalanced = self.forces(&pairs, &mut force);
            if unbalanced < limit || watch() == Watch::Stop {
                return Rest { iterations, unbalanced };
            }
            fire.step(&mut self.centres, &force, longest);
            let moved = |(a, b): (&Point, &Point)| norm([a[0] - b[0], a[1] - b[1]]);
            if self.centres.iter().zip(&built_at).map(moved).fold(0.0, f64::max) > 0.5 * margin {
                pairs = self.pairs(margin);
                built_at.clone_from(&self.centres);
            }
        }
        Rest { iterations: most, unbalanced }
    }

    /// Fills `force` and returns the mean one over the mean contact force; 0 when nothing overlaps.
    fn forces(&self, pairs: &[(usize, usize)], force: &mut [Point]) -> f64 {
        force.fill([0.0; 2]);
        let (mut sum, mut count) = (0.0, 0_usize);
        self.touches(pairs, |touch| {
            let size = touch.stiffness * touch.overlap;
            let push = [size * touch.normal[0], size * touch.normal[1]];
            force[touch.first][0] -= push[0];
            force[touch.first][1] -= push[1];
            if let Some(j) = touch.second {
                force[j][0] += push[0];
                force[j][1] += push[1];
            }
            sum += size;
            count += 1;
        });
        let mean = force.iter().map(|&f| norm(f)).sum::<f64>() / force.len() as f64;
        if count == 0 { 0.0 } else { mean * count as f64 / sum }
    }
}

/// State of the minimiser for unit masses and unit stiffness.
struct Fire {
    velocity: Vec<Point>,
    dt: f64,
    mixing: f64,
    since_uphill: usize,
}

impl Fire {
    const FIRST_STEP: f64 = 0.1;
    // Half of the stability limit 2/ω of a disc with six contacts of unit stiffness against moving neighbours.
    const LONGEST_STEP: f64 = 0.6;
    const MIXING: f64 = 0.1;

    fn new(count: usize) -> Self {
        let velocity = vec![[0.0; 2]; count];
        Self { velocity, dt: Self::FIRST_STEP, mixing: Self::MIXING, since_uphill: 0 }
    }

    fn step(&mut self, centres: &mut [Point], force: &[Point], longest: f64) {
        let (mut power, mut speed, mut push) = (0.0, 0.0, 0.0);
        for (v, f) in self.velocity.iter().zip(force) {
            power += v[0] * f[0] + v[1] * f[1];
            speed += v[0] * v[0] + v[1] * v[1];
            push += f[0] * f[0] + f[1] * f[1];
        }
        if power > 0.0 {
            self.since_uphill += 1;
            if self.since_uphill > 5 {
                self.dt = (1.1 * self.dt).min(Self::LONGEST_STEP);
                self.mixing *= 0.99;
            }
        } else {
            self.velocity.fill([0.0; 2]);
            (self.since_uphill, self.mixing) = (0, Self::MIXING);
            self.dt = (0.5 * self.dt).max(0.02);
        }
        let turn = if push > 0.0 { self.mixing * (speed / push).sqrt() } else { 0.0 };
        let keep = if power > 0.0 { 1.0 - self.mixing } else { 1.0 };
        let turn = if power > 0.0 { turn } else { 0.0 };
        for ((v, f), x) in self.velocity.iter_mut().zip(force).zip(centres) {
            for k in 0..2 {
                v[k] = keep * v[k] + (turn + self.dt) * f[k];
                x[k] += (self.dt * v[k]).clamp(-longest, longest);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three equal discs in a row between two walls 5 R apart (kn = 1 inside, 2 at the walls): the total overlap R is
    /// shared as 1/kn, so R/6 at each wall and R/3 at each contact.
    #[test]
    fn a_row_shares_its_overlap_by_compliance() {
        let region = Region::Rectangle { width: 5.0, height: 100.0 };
        let centres = vec![[-1.2, 0.0], [0.3, 0.0], [1.7, 0.0]];
        let mut heap = Heap { region, centres, radii: vec![1.0; 3] };
        let rest = heap.relax(1e-10, 10_000, &|| Watch::Continue);
        assert!(rest.unbalanced < 1e-10, "{rest:?}");
        let expected = [-2.5 + 5.0 / 6.0, 0.0, 2.5 - 5.0 / 6.0];
        for (centre, expected) in heap.centres.iter().zip(expected) {
            assert!((centre[0] - expected).abs() < 1e-9, "{centre:?}");
        }
    }

    #[test]
    fn separate_discs_stay_where_they_are() {
        let region = Region::Rectangle { width: 10.0, height: 10.0 };
        let mut heap = Heap { region, centres: vec![[-2.0, 0.0], [2.0, 0.0]], radii: vec![1.0; 2] };
        assert_eq!(heap.relax(1e-3, 100, &|| Watch::Continue), Rest { iterations: 0, unbalanced: 0.0 });
        assert_eq!(heap.centres, [[-2.0, 0.0], [2.0, 0.0]]);
    }

    #[test]
    fn pairs_are_those_of_all_against_all() {
        let mut stream = math::random::Stream::new(2, "pairs", 0);
        let region = Region::Rectangle { width: 1.0, height: 2.0 };
        let centres: Vec<Point> = (0..300).map(|_| [stream.uniform() - 0.5, 2.0 * stream.uniform() - 1.0]).collect();
        let radii: Vec<f64> = (0..300).map(|_| stream.uniform_in(0.01, 0.03)).collect();
        let heap = Heap { region, centres, radii };
        let mut expected = Vec::new();
        for i in 0..300 {
            for j in i + 1..300 {
                let apart = norm([heap.centres[i][0] - heap.centres[j][0], heap.centres[i][1] - heap.centres[j][1]]);
                if apart < heap.radii[i] + heap.radii[j] + 0.01 {
                    expected.push((i, j));
                }
            }
        }
        assert_eq!(heap.pairs(0.01), expected);
    }
}
