//! Stones: rigid clumps of given shapes in a solid, placed at random without overlap.
//!
//! Stones of every class are drawn: a shape by its share, a size within the class, a random orientation (a uniform unit
//! quaternion, Shoemake 1992). They are placed in the order of the radius of the ball around them, the largest first, each at
//! the first of a number of uniformly random places where none of its pebbles comes nearer than `gap` to a pebble of another
//! stone, or than `wall_gap` to a wall. A size multiplies a shape as a whole: volume with the third, inertia with the fifth power.
//!
//! Within a class the size is uniform by volume (equal volumes in equal steps of d, number density ∝ d⁻³) or by number.
//! The number follows from a count, a mass or a share of the specimen's volume:
//!
//! ```text
//! N = M / (ρ E[V]) = φ Ω / E[V],   E[V] = Σ share · V₁ · E[d³]
//! E[d³] = (b⁴ − a⁴) / (4 (b − a)) by number,   2 a² b² / (a + b) by volume
//! ```
//!
//! with V₁ the volume of a shape of size 1. Lengths in metres.

use super::region::Region;
use crate::D3;
use math::elementary::{cbrt, sin_cos};
use math::random::Stream;
use math::text::Amount;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// A shape of stones in its principal axes, the origin its centre of mass.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// Share of the stones, by number.
    pub share: f64,
    /// Intermediate extent (m).
    pub breadth: f64,
    /// Volume of the union of the pebbles (m³).
    pub volume: f64,
    /// Principal moments of inertia over the density (m⁵).
    pub inertia: [f64; 3],
    /// Centres of the pebbles (m).
    pub centres: Vec<[f64; 3]>,
    /// Their radii (m).
    pub radii: Vec<f64>,
}

/// What the size of a stone is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StoneSize {
    /// Its intermediate extent, by which it passes a sieve.
    #[default]
    Sieve,
    /// The diameter of the ball of equal volume.
    Volume,
}

/// How sizes lie within a class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WithinClass {
    /// Equal volumes in equal steps of the size.
    #[default]
    ByVolume,
    /// Equal numbers in equal steps of the size.
    ByNumber,
}

/// How many stones a class has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum HowMany {
    /// This number of stones.
    Count(usize),
    /// As many as have this mass together (kg).
    Mass(f64),
    /// As many as fill this share of the specimen's volume.
    Share(f64),
}

/// Stones between two sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoneClass {
    /// Smallest size (m).
    pub from: f64,
    /// Largest size (m).
    pub to: f64,
    /// How many.
    pub number: HowMany,
}

/// Stones of a specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stones {
    /// Classes.
    pub classes: Vec<StoneClass>,
    /// What a size is.
    pub size: StoneSize,
    /// Sizes within a class.
    pub within: WithinClass,
    /// Density (kg/m³).
    pub density: f64,
    /// Least distance between two stones (m).
    pub gap: f64,
    /// Least distance to the walls (m).
    pub wall_gap: f64,
    /// Tries per stone.
    pub attempts: usize,
    /// Name of their group.
    pub group: String,
}

/// A stone in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Stone {
    /// Its shape.
    pub shape: usize,
    /// Its class.
    pub class: usize,
    /// Centre of mass (m).
    pub centre: [f64; 3],
    /// Radius of the ball around it (m).
    pub reach: f64,
    /// Volume (m³).
    pub volume: f64,
    /// Inertia over the density in the axes of the specimen (m⁵).
    pub inertia: [[f64; 3]; 3],
    /// Centres of its pebbles (m).
    pub centres: Vec<[f64; 3]>,
    /// Their radii (m).
    pub radii: Vec<f64>,
}

/// Stones that do not fit, or shapes that are none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StoneFault {
    /// A number outside its range.
    #[error("stones: {name} is {found:#}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// No shape has a share.
    #[error("stones: no shape has a share above 0 and a pebble")]
    NoShape,
    /// Too many.
    #[error("stones: {0:.3e} stones are too many; at most {MOST_STONES:e} are placed")]
    Many(f64),
    /// Stones only in a solid.
    #[error("stones: clumps of shapes need a solid outline; give `depth`, or `diameter` and `height`")]
    Plane,
    /// No place.
    #[error(
        "stones: {placed} of {wanted} stones found a place; the next, {:.1} mm across, found none in {attempts} tries, with {:.1} % \
         of the specimen filled. Lower the numbers or the gaps, or take more tries or a larger specimen", size * 1e3, share * 100.0
    )]
    NoPlace {
        /// Placed before.
        placed: usize,
        /// Wanted.
        wanted: usize,
        /// Largest extent of the one that found no place (m).
        size: f64,
        /// Volume of the placed ones over that of the specimen.
        share: f64,
        /// Tries.
        attempts: usize,
    },
}

/// Most stones that are placed.
pub const MOST_STONES: f64 = 1e5;

impl Template {
    /// The size that it has as it was measured (m).
    fn size(&self, of: StoneSize) -> f64 {
        match of {
            StoneSize::Sieve => self.breadth,
            StoneSize::Volume => cbrt(6.0 * self.volume / PI),
        }
    }
}

impl StoneClass {
    /// E[d³] (m³).
    fn mean_cube(&self, within: WithinClass) -> f64 {
        let (a, b) = (self.from, self.to);
        if a == b {
            return a * a * a;
        }
        match within {
            WithinClass::ByNumber => (b * b * b * b - a * a * a * a) / (4.0 * (b - a)),
            WithinClass::ByVolume => 2.0 * a * a * b * b / (a + b),
        }
    }

    /// A size of the class for u uniform in 0 … 1.
    fn draw(&self, within: WithinClass, u: f64) -> f64 {
        let (a, b) = (self.from, self.to);
        match within {
            WithinClass::ByNumber => a + (b - a) * u,
            WithinClass::ByVolume => ((1.0 - u) / (a * a) + u / (b * b)).sqrt().recip(),
        }
    }
}

impl Stones {
    /// What is wrong with the settings.
    pub fn faults(&self, region: &Region) -> Vec<StoneFault> {
        let mut faults = Vec::new();
        if region.dimension() != 3 {
            faults.push(StoneFault::Plane);
        }
        let mut need = |ok: bool, name, found, expected| {
            faults.extend((!ok).then_some(StoneFault::Value { name, found, expected }));
        };
        let density = Amount(self.density, "kg/m^3");
        need(self.density > 0.0 && self.density.is_finite(), "density", density, "positive");
        need(self.gap >= 0.0 && self.gap.is_finite(), "gap", Amount(self.gap, "m"), "a length of at least 0");
        let wall_gap = Amount(self.wall_gap, "m");
        need(self.wall_gap >= 0.0 && self.wall_gap.is_finite(), "wall gap", wall_gap, "a length of at least 0");
        need(self.attempts > 0, "attempts", Amount::number(0.0), "at least 1");
        need(!self.classes.is_empty(), "number of classes", Amount::number(0.0), "at least 1");
        for class in &self.classes {
            need(class.from > 0.0, "lower bound of a class", Amount(class.from, "m"), "a size above 0");
            need(
                class.to >= class.from && class.to.is_finite(),
                "upper bound of a class",
                Amount(class.to, "m"),
                "at least the lower one",
            );
            match class.number {
                HowMany::Count(_) => {}
                HowMany::Mass(mass) => {
                    need(mass >= 0.0 && mass.is_finite(), "mass of a class", Amount(mass, "kg"), "at least 0");
                }
                HowMany::Share(share) => {
                    need((0.0..1.0).contains(&share), "share of a class", Amount::number(share), "from 0 to below 1")
                }
            }
        }
        faults
    }

    /// How many stones of each class there are in a volume (m³).
    fn counts(&self, shapes: &[Template], volume: f64) -> Vec<f64> {
        let whole: f64 = shapes.iter().map(|shape| shape.share).sum();
        let unit = |shape: &Template| shape.share / whole * shape.volume / shape.size(self.size).powi(3);
        let unit: f64 = shapes.iter().map(unit).sum();
        let count = |class: &StoneClass| {
            let mean = unit * class.mean_cube(self.within);
            match class.number {
                HowMany::Count(count) => count as f64,
                HowMany::Mass(mass) => (mass / self.density / mean).round(),
                HowMany::Share(share) => (share * volume / mean).round(),
            }
        };
        self.classes.iter().map(count).collect()
    }

    /// The stones in their places, the largest first.
    ///
    /// # Errors
    /// Shapes that are none, too many stones, or the first stone that finds no place.
    pub fn place(&self, shapes: &[Template], region: &Region, stream: &mut Stream) -> Result<Vec<Stone>, StoneFault> {
        if !shapes.iter().any(|shape| shape.share > 0.0 && !shape.radii.is_empty()) {
            return Err(StoneFault::NoShape);
        }
        let counts = self.counts(shapes, region.volume());
        let wanted: f64 = counts.iter().sum();
        if !(wanted <= MOST_STONES) {
            return Err(StoneFault::Many(wanted));
        }
        let mut drawn: Vec<Stone> = Vec::with_capacity(wanted as usize);
        for (class, count) in counts.iter().enumerate() {
            let count = *count as usize;
            // One draw of each of equal strata, so that the masses are those of the law; shapes by their shares, in random order.
            let mut kinds = shares(shapes, count);
            stream.shuffle(&mut kinds);
            for (k, shape) in kinds.into_iter().enumerate() {
                let size = self.classes[class].draw(self.within, (k as f64 + stream.uniform()) / count as f64);
                let factor = size / shapes[shape].size(self.size);
                drawn.push(Stone::of(&shapes[shape], (shape, class), factor, quaternion(stream)));
            }
        }
        drawn.sort_by(|a, b| b.reach.total_cmp(&a.reach));
        let mut placed: Vec<Stone> = Vec::with_capacity(drawn.len());
        for stone in &drawn {
            let found = (0..self.attempts).find_map(|_| self.try_once(stone, region, &placed, stream));
            match found {
                Some(stone) => placed.push(stone),
                None => {
                    let share = placed.iter().map(|stone| stone.volume).sum::<f64>() / region.volume();
                    let (placed, wanted, attempts) = (placed.len(), drawn.len(), self.attempts);
                    return Err(StoneFault::NoPlace { placed, wanted, size: 2.0 * stone.reach, share, attempts });
                }
            }
        }
        Ok(placed)
    }

    fn try_once(&self, stone: &Stone, region: &Region, placed: &[Stone], stream: &mut Stream) -> Option<Stone> {
        let edges = region.edges();
        let shift: [f64; 3] = std::array::from_fn(|k| edges[k] * (stream.uniform() - 0.5));
        let inside = |(centre, radius): (&[f64; 3], &f64)| {
            region.depth::<D3>(std::array::from_fn(|k| centre[k] + shift[k])) >= radius + self.wall_gap
        };
        if !stone.centres.iter().zip(&stone.radii).all(inside) {
            return None;
        }
        let free = |other: &Stone| {
            let reach = stone.reach + other.reach + self.gap;
            apart_square(shift, other.centre) >= reach * reach || stone.clear_of(shift, other, self.gap)
        };
        placed.iter().all(free).then(|| stone.moved(shift))
    }
}

impl Stone {
    /// A shape of another size, turned, about the origin.
    fn of(shape: &Template, (index, class): (usize, usize), factor: f64, turn: [[f64; 3]; 3]) -> Self {
        let turned = |c: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| factor * (0..3).map(|k| turn[i][k] * c[k]).sum::<f64>())
        };
        let centres: Vec<[f64; 3]> = shape.centres.iter().map(turned).collect();
        let radii: Vec<f64> = shape.radii.iter().map(|radius| factor * radius).collect();
        let reach = centres.iter().zip(&radii).map(|(c, r)| apart_square(*c, [0.0; 3]).sqrt() + r).fold(0.0, f64::max);
        let fifth = factor * factor * factor * factor * factor;
        let entry =
            |i: usize, j: usize| fifth * (0..3).map(|k| turn[i][k] * shape.inertia[k] * turn[j][k]).sum::<f64>();
        Self {
            shape: index,
            class,
            centre: [0.0; 3],
            reach,
            volume: factor * factor * factor * shape.volume,
            inertia: std::array::from_fn(|i| std::array::from_fn(|j| entry(i.min(j), i.max(j)))),
            centres,
            radii,
        }
    }

    fn moved(&self, shift: [f64; 3]) -> Self {
        let moved = |c: &[f64; 3]| std::array::from_fn(|k| c[k] + shift[k]);
        Self { centre: moved(&self.centre), centres: self.centres.iter().map(moved).collect(), ..self.clone() }
    }

    /// Whether no pebble of this stone, moved, comes nearer than `gap` to one of another.
    fn clear_of(&self, shift: [f64; 3], other: &Self, gap: f64) -> bool {
        self.centres.iter().zip(&self.radii).all(|(c, r)| {
            let place = std::array::from_fn(|k| c[k] + shift[k]);
            other.clear_of_ball(place, r + gap)
        })
    }

    /// Whether a ball overlaps none of its pebbles.
    pub(super) fn clear_of_ball(&self, place: [f64; 3], radius: f64) -> bool {
        let reach = self.reach + radius;
        if apart_square(place, self.centre) >= reach * reach {
            return true;
        }
        self.centres.iter().zip(&self.radii).all(|(c, r)| apart_square(place, *c) >= (radius + r) * (radius + r))
    }
}

fn apart_square(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// The shape of each of so many stones: as many of each as its share asks for, the largest remainders rounded up.
fn shares(shapes: &[Template], count: usize) -> Vec<usize> {
    let whole: f64 = shapes.iter().map(|shape| shape.share).sum();
    let exact: Vec<f64> = shapes.iter().map(|shape| shape.share / whole * count as f64).collect();
    let mut number: Vec<usize> = exact.iter().map(|x| x.floor() as usize).collect();
    let mut order: Vec<usize> = (0..shapes.len()).collect();
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()).then(a.cmp(&b)));
    let missing = count - number.iter().sum::<usize>();
    order.iter().cycle().take(missing).for_each(|&shape| number[shape] += 1);
    number.iter().enumerate().flat_map(|(shape, &many)| std::iter::repeat_n(shape, many)).collect()
}

/// A uniformly random rotation (Shoemake 1992, Graphics Gems III, p. 124).
fn quaternion(stream: &mut Stream) -> [[f64; 3]; 3] {
    let [u, v, w] = std::array::from_fn(|_| stream.uniform());
    let ((s1, c1), (s2, c2)) = (sin_cos(TAU * v), sin_cos(TAU * w));
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let [x, y, z, q] = [a * s1, a * c1, b * s2, b * c2];
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * q), 2.0 * (x * z + y * q)],
        [2.0 * (x * y + z * q), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * q)],
        [2.0 * (x * z - y * q), 2.0 * (y * z + x * q), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Two equal balls of radius 1 at a distance of 1: lens π (2 − d)² (d² + 4 d) / (12 d).
    pub(crate) fn dumbbell() -> Template {
        let volume = 8.0 / 3.0 * PI - PI * 5.0 / 12.0;
        let centres = vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]];
        Template { share: 1.0, breadth: 2.0, volume, inertia: [2.6, 4.4, 4.4], centres, radii: vec![1.0; 2] }
    }

    pub(crate) fn stones(classes: Vec<StoneClass>) -> Stones {
        Stones {
            classes,
            size: StoneSize::Sieve,
            within: WithinClass::ByVolume,
            density: 2700.0,
            gap: 0.01,
            wall_gap: 0.02,
            attempts: 20_000,
            group: "stones".into(),
        }
    }

    /// E[d³] against the mean over many draws of both laws.
    #[test]
    fn sizes_have_the_mean_of_their_law() {
        let class = StoneClass { from: 1.0, to: 4.0, number: HowMany::Count(1) };
        for within in [WithinClass::ByVolume, WithinClass::ByNumber] {
            let n = 200_000;
            let mean: f64 =
                (0..n).map(|k| class.draw(within, (f64::from(k) + 0.5) / f64::from(n)).powi(3)).sum::<f64>()
                    / f64::from(n);
            assert!((mean / class.mean_cube(within) - 1.0).abs() < 1e-6, "{within:?}");
            assert_eq!((class.draw(within, 0.0), class.draw(within, 1.0)), (1.0, 4.0));
        }
    }

    /// Stones lie inside, apart, in the order of their reach; masses and shares become numbers; inertia turns along.
    #[test]
    fn stones_lie_apart_inside() {
        let region = Region::Box { width: 30.0, height: 30.0, depth: 30.0 };
        let classes = vec![
            StoneClass { from: 2.0, to: 4.0, number: HowMany::Count(60) },
            StoneClass { from: 4.0, to: 6.0, number: HowMany::Share(0.1) },
        ];
        let stones = stones(classes);
        let shape = dumbbell();
        let found = stones.place(std::slice::from_ref(&shape), &region, &mut Stream::new(1, "stones", 0)).unwrap();
        let coarse: Vec<&Stone> = found.iter().filter(|stone| stone.class == 1).collect();
        let share = coarse.iter().map(|stone| stone.volume).sum::<f64>() / region.volume();
        assert!((share - 0.1).abs() < 0.003, "{share}");
        assert_eq!(found.len() - coarse.len(), 60);
        assert!(found.windows(2).all(|pair| pair[0].reach >= pair[1].reach));
        for (k, stone) in found.iter().enumerate() {
            let factor = stone.radii[0];
            let trace: f64 = (0..3).map(|i| stone.inertia[i][i]).sum();
            assert!((trace / factor.powi(5) / shape.inertia.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for (c, r) in stone.centres.iter().zip(&stone.radii) {
                assert!(c.iter().all(|x| x.abs() + r + 0.02 <= 15.0 + 1e-12));
                assert!(found[..k].iter().all(|other| other.clear_of_ball(*c, r + 0.01 - 1e-12)));
            }
        }
        // The long axes point everywhere: the mean of e ⊗ e is 1/3 along each axis.
        let mean = |axis: usize| {
            let part = |s: &Stone| ((s.centres[1][axis] - s.centres[0][axis]) / s.radii[0]).powi(2);
            found.iter().map(part).sum::<f64>() / found.len() as f64
        };
        assert!((0..3).all(|axis| (mean(axis) - 1.0 / 3.0).abs() < 0.15), "{} {} {}", mean(0), mean(1), mean(2));
    }

    #[test]
    fn too_much_is_said_with_how_far_it_came() {
        let region = Region::Box { width: 10.0, height: 10.0, depth: 10.0 };
        let full =
            Stones { attempts: 200, ..stones(vec![StoneClass { from: 4.0, to: 4.0, number: HowMany::Count(50) }]) };
        let found = full.place(&[dumbbell()], &region, &mut Stream::new(1, "stones", 0));
        assert!(matches!(found, Err(StoneFault::NoPlace { placed, wanted: 50, .. }) if placed > 0), "{found:?}");
        assert_eq!(full.place(&[], &region, &mut Stream::new(1, "stones", 0)), Err(StoneFault::NoShape));
        let odd =
            Stones { density: 0.0, ..stones(vec![StoneClass { from: 3.0, to: 1.0, number: HowMany::Share(1.5) }]) };
        assert_eq!(odd.faults(&Region::Disc { diameter: 1.0 }).len(), 4);
    }
}
