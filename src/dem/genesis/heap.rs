//! A heap of frictionless balls in its vessel: what touches what.
//!
//! Neighbour search and stiffness of a contact are those of the engine, with a modulus of 1 Pa: in the plane
//! k_n = 2 min(R₁, R₂) / (R₁ + R₂) per E* t (2 at a wall), in the solid π min(R₁, R₂)² / (R₁ + R₂) (π R at a wall).

use super::region::Region;
use crate::interaction::{Convention, Stiffness};
use crate::neighbour;
use crate::space::{D2, Space, Tuple, Vector, flat};

/// Balls in a vessel (m).
#[derive(Clone, Debug)]
pub struct Heap<S: Space = D2> {
    /// Vessel.
    pub region: Region,
    /// Centres.
    pub centres: Vec<Vector<S>>,
    /// Radii.
    pub radii: Vec<f64>,
    /// Those that stand still.
    pub still: Still,
}

/// The first balls of a heap where they are pebbles of stones that stand still; they overlap one another and the walls as they
/// like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Still {
    /// How many.
    pub pebbles: usize,
    /// Volume of the stones (m³).
    pub volume: f64,
}

/// Two balls, or a ball and a wall (`second` is then `None`), that overlap.
#[derive(Clone, Copy, Debug)]
pub struct Overlap<S: Space> {
    /// Index of the first ball.
    pub first: usize,
    /// Index of the second ball, larger than the first.
    pub second: Option<usize>,
    /// Overlap, positive (m).
    pub depth: f64,
    /// Unit vector from the first ball to the second, or to the wall.
    pub normal: Vector<S>,
    /// Normal stiffness for a modulus of 1 Pa (N/m).
    pub stiffness: f64,
}

/// What may touch: pairs and balls at walls that are nearer than a margin.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    pub(super) pairs: Vec<Pair>,
    pub(super) at_wall: Vec<u32>,
    /// Factor on all stiffnesses.
    scale: f64,
}

/// Two balls that may touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) i: u32,
    pub(super) j: u32,
    /// Sum of the radii (m).
    pub(super) reach: f64,
    pub(super) stiffness: f64,
}

const UNIT: Stiffness = Stiffness::Modulus { modulus: 1.0, ratio: 1.0, convention: Convention::Present };

impl<S: Space> Heap<S> {
    /// All pairs whose surfaces are nearer than `margin` (m), each once with the smaller index first, sorted.
    pub fn pairs(&self, margin: f64) -> Vec<(usize, usize)> {
        let centres: Vec<[f64; 3]> = self.centres.iter().map(|&x| flat::<S>(x)).collect();
        // Pebbles that stand still are one body, so that no pair of them is listed.
        let bodies: Vec<u32> =
            (0..self.radii.len()).map(|i| if i < self.still.pebbles { 0 } else { i as u32 }).collect();
        let mut pairs = Vec::with_capacity(4 * self.radii.len());
        neighbour::pairs(&centres, &self.radii, &bodies, margin, |i, j| pairs.push((i as usize, j as usize)));
        pairs
    }

    /// What may touch within `margin` (m); all stiffnesses times `scale`.
    pub(super) fn neighbours(&self, margin: f64, scale: f64) -> Neighbours {
        let near = |&i: &usize| self.is_near_wall(self.centres[i], i, margin);
        let at_wall = (self.still.pebbles..self.radii.len()).filter(near).map(|i| i as u32).collect();
        let pair = |(i, j): (usize, usize)| self.pair(i, j, scale);
        Neighbours { pairs: self.pairs(margin).into_iter().map(pair).collect(), at_wall, scale }
    }

    /// Balls i < j as a pair; its stiffness times `scale`.
    pub(super) fn pair(&self, i: usize, j: usize, scale: f64) -> Pair {
        let (ri, rj) = (self.radii[i], self.radii[j]);
        // A stone is rigid however small its pebbles are: it resists a ball as another one of the ball's size does.
        let stiffness = scale * UNIT.normal::<S>(if i < self.still.pebbles { [rj, rj] } else { [ri, rj] });
        Pair { i: i as u32, j: j as u32, reach: ri + rj, stiffness }
    }

    /// Whether a wall is nearer than `margin` (m) to the surface of ball `i` with its centre at `x`.
    pub(super) fn is_near_wall(&self, x: Vector<S>, i: usize, margin: f64) -> bool {
        self.region.depth::<S>(x) < self.radii[i] + margin
    }

    /// Calls `visit` for every pair that overlaps, then for every ball that overlaps a wall.
    pub fn overlaps(&self, visit: impl FnMut(Overlap<S>)) {
        self.visit(&self.neighbours(0.0, 1.0), visit);
    }

    /// The same for what a list holds.
    #[inline]
    pub(super) fn visit(&self, list: &Neighbours, mut visit: impl FnMut(Overlap<S>)) {
        for &Pair { i, j, reach, stiffness } in &list.pairs {
            let (i, j) = (i as usize, j as usize);
            let apart = self.centres[j].minus(self.centres[i]);
            let square = apart.dot(apart);
            if square < reach * reach {
                let distance = square.sqrt();
                let along =
                    |k: usize| if distance > 0.0 { apart.at(k) / distance } else { f64::from(u8::from(k == 0)) };
                let normal = Vector::<S>::build(along);
                visit(Overlap { first: i, second: Some(j), depth: reach - distance, normal, stiffness });
            }
        }
        self.visit_walls(list, visit);
    }

    /// The same for what overlaps a wall.
    #[inline]
    pub(super) fn visit_walls(&self, list: &Neighbours, mut visit: impl FnMut(Overlap<S>)) {
        for &i in &list.at_wall {
            let (i, radius) = (i as usize, self.radii[i as usize]);
            let stiffness = list.scale * UNIT.normal::<S>([radius, f64::INFINITY]);
            self.region.walls_within::<S>(self.centres[i], radius, |wall| {
                let (depth, normal) = (radius - wall.distance, wall.normal.times(-1.0));
                visit(Overlap { first: i, second: None, depth, normal, stiffness });
            });
        }
    }

    /// Radii of an overlap's ends; the second is infinite at a wall.
    pub fn ends(&self, overlap: &Overlap<S>) -> [f64; 2] {
        [self.radii[overlap.first], overlap.second.map_or(f64::INFINITY, |j| self.radii[j])]
    }

    /// Depth of an overlap over the smaller radius, or over that of the ball at a stone, whose pebbles are as small as they like.
    pub fn relative(&self, overlap: &Overlap<S>) -> f64 {
        let [first, second] = self.ends(overlap);
        overlap.depth / if overlap.first < self.still.pebbles { second } else { first.min(second) }
    }

    /// Volume between the stones (m³, or m²).
    pub fn room(&self) -> f64 {
        self.region.volume() - self.still.volume
    }

    /// Radii of the balls that do not stand still.
    pub fn free(&self) -> &[f64] {
        &self.radii[self.still.pebbles..]
    }

    /// Number of contacts of every ball, those with walls included.
    pub fn contact_counts(&self) -> Vec<u32> {
        let mut counts = vec![0; self.radii.len()];
        self.overlaps(|overlap| {
            counts[overlap.first] += 1;
            if let Some(second) = overlap.second {
                counts[second] += 1;
            }
        });
        counts
    }

    /// Σ V(R) of the balls that do not stand still, overlaps counted twice (m³, or m²).
    pub fn ball_volume(&self) -> f64 {
        ball_volume::<S>(self.free())
    }

    /// Multiplies the radii of the balls that do not stand still.
    pub(super) fn scale(&mut self, factor: f64) {
        self.radii[self.still.pebbles..].iter_mut().for_each(|r| *r *= factor);
    }

    /// The balls with these indices, in this order; pebbles that stand still must come first and all be there.
    pub(super) fn chosen(&self, order: &[usize]) -> Self {
        let centres = order.iter().map(|&i| self.centres[i]).collect();
        Self { region: self.region, centres, radii: order.iter().map(|&i| self.radii[i]).collect(), still: self.still }
    }
}

/// Σ V(R) (m³, or m²).
pub fn ball_volume<S: Space>(radii: &[f64]) -> f64 {
    S::volume(1.0) * radii.iter().fold(0.0, |sum, &r| sum + (1..S::DIMENSION).fold(r, |power, _| power * r))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D3;
    use math::random::Stream;

    #[test]
    fn pairs_are_those_of_all_against_all() {
        let mut stream = Stream::new(2, "pairs", 0);
        let region = Region::Box { width: 1.0, height: 2.0, depth: 0.5 };
        let edges = region.edges();
        let centres: Vec<[f64; 3]> =
            (0..300).map(|_| std::array::from_fn(|k| edges[k] * (stream.uniform() - 0.5))).collect();
        let radii: Vec<f64> = (0..300).map(|_| stream.uniform_in(0.03, 0.06)).collect();
        let heap = Heap::<D3> { region, centres, radii, still: Still::default() };
        let mut expected = Vec::new();
        for i in 0..300 {
            for j in i + 1..300 {
                let apart: f64 = (0..3).map(|k| (heap.centres[i][k] - heap.centres[j][k]).powi(2)).sum();
                if apart.sqrt() < heap.radii[i] + heap.radii[j] + 0.01 {
                    expected.push((i, j));
                }
            }
        }
        assert!(expected.len() > 100);
        assert_eq!(heap.pairs(0.01), expected);
    }
}
