//! Packing to a stress: all radii are scaled and the balls relaxed until the mean stress is the one asked for.
//!
//! A fixed porosity near jamming does not fix the state: coordination and moduli scatter by several per cent from packing
//! to packing. A fixed stress does (Potyondy & Cundall 2004). The procedure:
//!
//! 1. The cloud at its porosity is brought to rest ([`super::relax`]).
//! 2. Radii times 1 + a, rest again, until the mean stress is within the tolerance of the target. The first a is that
//!    of Potyondy & Cundall, with which nothing moves ([`Pressure`]); since the balls do move, it falls short, and the next
//!    ones come from the secant of the last two states.
//! 3. Floaters, with fewer contacts than hold a ball, are enlarged until their contacts carry together what a mean contact
//!    carries (one relaxation with their radii free), deleted, or left alone. Then 2 again, until few enough are left.
//!
//! Stress over modulus is all that counts: σ/E* of 10⁻⁵ to 10⁻³ is usual (1 % of the strength).
//!
//! Source: Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011, appendix A.

use super::fabric::{Pressure, held};
use super::heap::Heap;
use super::packing::PackingError;
use super::relax::{Rest, Swelling, Until};
use crate::Watch;
use crate::space::Space;
use serde::{Deserialize, Serialize};

/// A stress-controlled packing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressTarget {
    /// Mean stress (Pa), compression positive.
    pub stress: f64,
    /// Contact modulus while packing (Pa); only stress over modulus has an effect.
    pub modulus: f64,
    /// Allowed deviation of the stress over the stress.
    pub tolerance: f64,
    /// Ball porosity of the cloud that the number of balls is counted at.
    pub cloud_porosity: f64,
    /// Mean unbalanced force over mean contact force that counts as rest.
    pub equilibrium: f64,
    /// What happens to floaters.
    pub floaters: Floaters,
    /// Largest share of balls with too few contacts that is left alone.
    pub floater_share: f64,
}

/// What happens to balls with fewer contacts than hold a ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Floaters {
    /// Enlarged until they are held.
    #[default]
    Enlarge,
    /// Taken out.
    Delete,
    /// Left as they are.
    Keep,
}

/// What happened on the way to a stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Compressed {
    /// Factor on all radii.
    pub(super) factor: f64,
    /// Iterations of the relaxations.
    pub(super) iterations: usize,
    /// Rounds of treating floaters.
    pub(super) rounds: usize,
    /// Largest factor on the radius of a floater alone.
    pub(super) growth: f64,
    /// Floaters taken out.
    pub(super) deleted: usize,
    /// Mean unbalanced force over mean contact force at the end.
    pub(super) unbalanced: f64,
}

impl Default for Compressed {
    fn default() -> Self {
        Self { factor: 1.0, iterations: 0, rounds: 0, growth: 1.0, deleted: 0, unbalanced: 0.0 }
    }
}

impl Compressed {
    /// What happened so far and then.
    pub(super) fn and(self, then: Self) -> Self {
        Self {
            factor: self.factor * then.factor,
            iterations: self.iterations + then.iterations,
            rounds: self.rounds + then.rounds,
            growth: self.growth.max(then.growth),
            deleted: self.deleted + then.deleted,
            unbalanced: then.unbalanced,
        }
    }
}

const MOST_ITERATIONS: usize = 100_000;
const MOST_SCALINGS: usize = 200;
const MOST_ROUNDS: usize = 20;
/// Mean contact force over that of the target below which a heap is slack.
const SLACK: f64 = 0.05;
/// Largest push on a ball that floats again and again, over the mean contact force.
const HARDEST: f64 = 4.0;
/// Growth of the radii of a slack heap, far from the porosity at which balls jam and near it.
const BLIND: [f64; 2] = [4e-3, 5e-4];
/// Width of a bracket of the radii, over the relative stress, that is no longer believed.
const NARROWEST: f64 = 1e-3;
/// Largest change of the radii in one scaling.
const STRIDE: f64 = 2e-2;

impl StressTarget {
    /// Target over modulus.
    pub fn relative(&self) -> f64 {
        self.stress / self.modulus
    }

    /// Brings the heap to the stress; balls are taken out where floaters are deleted.
    pub(super) fn compress<S: Space>(
        &self,
        heap: &mut Heap<S>,
        watch: &dyn Fn() -> Watch,
    ) -> Result<Compressed, PackingError> {
        let mut done = Compressed::default();
        let started = heap.relax(Until { margin: 0.5, ..self.until(heap) }, watch);
        done.iterations += started.iterations;
        self.servo(heap, &mut done, watch)?;
        let stated = heap.radii.clone();
        let scaled = done.factor;
        let mut floated = vec![0.0_f64; heap.radii.len()];
        while self.floaters != Floaters::Keep && done.rounds < MOST_ROUNDS {
            let counts = heap.contact_counts();
            let floating: Vec<usize> = (0..counts.len()).filter(|&i| counts[i] < held::<S>()).collect();
            if floating.len() as f64 <= self.floater_share * counts.len() as f64 {
                break;
            }
            done.rounds += 1;
            if self.floaters == Floaters::Delete {
                let stay: Vec<usize> = (0..counts.len()).filter(|&i| counts[i] >= held::<S>()).collect();
                done.deleted += floating.len();
                *heap = heap.chosen(&stay);
            } else {
                // One that floats again is pushed harder, or the next change of the stress would let it go once more.
                floating.iter().for_each(|&i| floated[i] = (floated[i] + 1.0).min(HARDEST));
                let pushes: Vec<f64> = floating.iter().map(|&i| floated[i]).collect();
                let swelling = Swelling { balls: &floating, pushes: &pushes };
                done.iterations += heap.relax_swelling(self.until(heap), swelling, watch).iterations;
            }
            self.servo(heap, &mut done, watch)?;
            if self.floaters == Floaters::Enlarge {
                let growth = heap.radii.iter().zip(&stated).map(|(r, before)| r / before * scaled / done.factor);
                done.growth = growth.fold(1.0, f64::max);
            }
        }
        Ok(done)
    }

    fn until<S: Space>(&self, heap: &Heap<S>) -> Until {
        // A stress σ puts about σ (2R)^(d−1) on a contact, which is 2 R σ/E* in units of its stiffness.
        let mean = heap.radii.iter().sum::<f64>() / heap.radii.len() as f64;
        let slack = SLACK * self.relative() * 2.0 * mean;
        Until { unbalanced: self.equilibrium, slack, iterations: MOST_ITERATIONS, margin: 0.1 }
    }

    /// Scales all radii until the stress at rest is the target.
    fn servo<S: Space>(
        &self,
        heap: &mut Heap<S>,
        done: &mut Compressed,
        watch: &dyn Fn() -> Watch,
    ) -> Result<(), PackingError> {
        let target = self.relative();
        let mut search = Search::default();
        for _ in 0..MOST_SCALINGS {
            let rest = heap.relax(self.until(heap), watch);
            done.iterations += rest.iterations;
            done.unbalanced = rest.unbalanced;
            if watch() == Watch::Stop {
                return Err(PackingError::Stopped);
            }
            if rest.unbalanced >= self.equilibrium {
                let Rest { iterations, unbalanced } = rest;
                return Err(PackingError::Restless { iterations, unbalanced });
            }
            let found = Pressure::of(heap);
            search.reached = found.stress;
            if (found.stress - target).abs() <= self.tolerance * target {
                return Ok(());
            }
            let change = search.next(&found, target, blind(heap));
            heap.scale(1.0 + change);
            done.factor *= 1.0 + change;
        }
        let reached = search.reached * self.modulus;
        Err(PackingError::Unsettled { target: self.stress, reached, scalings: MOST_SCALINGS })
    }
}

/// What is known of the stress as a function of the radii: sum of the changes so far, the last state, and between which
/// sums the target lies.
#[derive(Debug, Default)]
struct Search {
    at: f64,
    last: Option<(f64, f64)>,
    low: Option<f64>,
    high: Option<f64>,
    reached: f64,
}

impl Search {
    /// Next relative change of the radii: that of the affine slope, or of the secant of the last change, which the moving
    /// balls make flatter, but no less than a fifth of the affine one. Where that leaves the bracket, its middle.
    fn next(&mut self, found: &Pressure, target: f64, blind: f64) -> f64 {
        let slack = found.stress <= SLACK * target;
        let last = self.last.filter(|_| !slack).filter(|&(_, stress)| stress > SLACK * target);
        let secant = last.map(|(at, stress)| (found.stress - stress) / (self.at - at));
        let slope = secant.map_or(found.slope, |secant| secant.clamp(0.2 * found.slope, found.slope));
        let change = if slack { blind } else { ((target - found.stress) / slope).clamp(-STRIDE, STRIDE) };
        *(if found.stress < target { &mut self.low } else { &mut self.high }) = Some(self.at);
        if let (Some(low), Some(high)) = (self.low, self.high) {
            let room = high - low;
            if room < NARROWEST * target {
                // The packing has changed on the way: what was known of it holds no more.
                (self.low, self.high) = (None, None);
            } else if !(low + 0.05 * room..=high - 0.05 * room).contains(&(self.at + change)) {
                let middle = 0.5 * (low + high) - self.at;
                return self.step(middle, found.stress);
            }
        }
        self.step(change, found.stress)
    }

    fn step(&mut self, change: f64, stress: f64) -> f64 {
        self.last = Some((self.at, stress));
        self.at += change;
        change
    }
}

/// Growth of the radii while nothing holds: large while the porosity is far above that of jamming.
fn blind<S: Space>(heap: &Heap<S>) -> f64 {
    let porosity = 1.0 - heap.ball_volume() / heap.region.volume();
    let far = porosity > if S::DIMENSION == 2 { 0.19 } else { 0.40 };
    BLIND[usize::from(!far)]
}
