//! Rest state of a heap of frictionless balls in its vessel.
//!
//! Without friction and rotation the packing is a minimum of the overlap energy
//!
//! ```text
//! W = Σ ½ k_n U²
//! ```
//!
//! so it is found by a minimiser and not by waiting for dampers: FIRE (fast inertial relaxation engine), which moves
//! unit masses along the force, turns their velocity towards the force while the power is positive and stops them
//! when it turns negative. No displacement exceeds a tenth of the smallest radius in a step ("calm"). The scale of k_n
//! does not matter: the minimum is the same for every modulus. It is chosen so that a contact of two balls of the mean
//! radius has the stiffness 1.
//!
//! **Swelling** balls have their radius as a further coordinate: a constant push p acts against the sum of their normal
//! forces, so that they grow until their contacts carry p together. A ball that is held by too few contacts slips aside
//! and grows on, so it ends with as many as hold it in place.
//!
//! Sums run over one list of pairs sorted by index, so the bits do not depend on anything but the input: neither on when
//! pairs are listed ([`super::vicinity`]) nor on how many are computed at a time ([`super::repulsion`]).
//!
//! Source: Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201, doi:10.1103/PhysRevLett.97.170201; Guénolé et al. 2020,
//! Comput. Mater. Sci. 175, 109584 (semi-implicit form).

use super::heap::Heap;
use super::repulsion::Forces;
use super::vicinity::Vicinity;
use crate::Watch;
use crate::space::{Space, Tuple, Vector};

/// When a relaxation ends.
#[derive(Clone, Copy, Debug)]
pub struct Until {
    /// Mean unbalanced force over the mean contact force.
    pub unbalanced: f64,
    /// Mean contact force, in units of the stiffness between mean balls (m), below which the heap hangs together by nothing:
    /// without stress all forces vanish together and their ratio means nothing.
    pub slack: f64,
    /// Iterations at most.
    pub iterations: usize,
    /// Neighbours are listed within this share of the smallest radius: much while balls move far, little near rest.
    pub margin: f64,
}

/// How a relaxation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Iterations used.
    pub iterations: usize,
    /// Mean unbalanced force of the balls over the mean contact force; 0 when nothing overlaps, or slackly.
    pub unbalanced: f64,
}

/// Balls whose radii grow against their contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swelling<'a> {
    /// The balls.
    pub(super) balls: &'a [usize],
    /// Sum of the normal forces that ends the growth of each, over the mean contact force.
    pub(super) pushes: &'a [f64],
}

/// Push on a swelling ball that its contacts may leave unanswered, over the mean contact force.
const UNANSWERED: f64 = 0.1;

impl<S: Space> Heap<S> {
    /// Moves the centres to a minimum of the overlap energy: until the mean unbalanced force is below the limit, or no
    /// ball overlaps anything, or the iterations are spent, or `watch` stops it.
    pub fn relax(&mut self, until: Until, watch: &dyn Fn() -> Watch) -> Rest {
        self.relax_swelling(until, Swelling { balls: &[], pushes: &[] }, watch)
    }

    /// The same while some balls swell.
    pub(super) fn relax_swelling(&mut self, until: Until, swelling: Swelling<'_>, watch: &dyn Fn() -> Watch) -> Rest {
        let smallest = self.free().iter().copied().fold(f64::INFINITY, f64::min);
        let (margin, longest) = (until.margin * smallest, 0.1 * smallest);
        let scale = self.unit_scale();
        let mut fire = Fire::<S>::new(self.radii.len(), swelling.balls.len());
        let mut vicinity = Vicinity::new(self, margin, scale);
        let mut forces = Forces::<S>::new(self, vicinity.list());
        let mut unbalanced = f64::INFINITY;
        for iterations in 0..until.iterations {
            unbalanced = forces.fill(self, vicinity.list());
            let drives = swelling.drives(&forces);
            let answered = drives.iter().all(|drive| drive.abs() <= UNANSWERED * forces.mean);
            if forces.mean < until.slack {
                return Rest { iterations, unbalanced: 0.0 };
            }
            if unbalanced < until.unbalanced && answered || watch() == Watch::Stop {
                return Rest { iterations, unbalanced };
            }
            let way = fire.step(self, &forces.balls, (swelling.balls, &drives), longest);
            let anew = match swelling.balls {
                [] => vicinity.follow(self, way),
                balls => vicinity.follow_swelling(self, balls),
            };
            if anew {
                forces.take(vicinity.list());
            }
        }
        Rest { iterations: until.iterations, unbalanced }
    }

    /// Inverse of the stiffness between two balls of the mean radius; exactly 1 in the plane.
    fn unit_scale(&self) -> f64 {
        let free = self.free();
        let mean = free.iter().sum::<f64>() / free.len() as f64;
        2.0 * mean / S::section(mean)
    }
}

impl Swelling<'_> {
    /// What drives the radii of the balls.
    fn drives<S: Space>(&self, forces: &Forces<S>) -> Vec<f64> {
        let drive = |(&i, push): (&usize, &f64)| push * forces.mean - forces.on(i);
        self.balls.iter().zip(self.pushes).map(drive).collect()
    }
}

/// State of the minimiser for unit masses and unit stiffness.
struct Fire<S: Space> {
    velocity: Vec<Vector<S>>,
    growth: Vec<f64>,
    dt: f64,
    mixing: f64,
    since_uphill: usize,
}

impl<S: Space> Fire<S> {
    const FIRST_STEP: f64 = 0.1;
    // Half of the stability limit 2/ω of a disc with six contacts of unit stiffness against moving neighbours.
    const LONGEST_STEP: f64 = 0.6;
    const MIXING: f64 = 0.1;

    fn new(balls: usize, swelling: usize) -> Self {
        let (velocity, growth) = (vec![Vector::<S>::zero(); balls], vec![0.0; swelling]);
        Self { velocity, growth, dt: Self::FIRST_STEP, mixing: Self::MIXING, since_uphill: 0 }
    }

    /// One step of all centres, and of the radii of the swelling balls with what drives them. Returns the largest way of a
    /// centre (m).
    fn step(
        &mut self,
        heap: &mut Heap<S>,
        force: &[Vector<S>],
        (balls, drives): (&[usize], &[f64]),
        longest: f64,
    ) -> f64 {
        let (mut power, mut speed, mut push) = (0.0, 0.0, 0.0);
        for (v, f) in self.velocity.iter().zip(force) {
            power += v.dot(*f);
            speed += v.dot(*v);
            push += f.dot(*f);
        }
        for (v, f) in self.growth.iter().zip(drives) {
            power += v * f;
            speed += v * v;
            push += f * f;
        }
        let keep = self.turn(power);
        let turn = if power > 0.0 && push > 0.0 { self.mixing * (speed / push).sqrt() } else { 0.0 };
        let gain = turn + self.dt;
        let mut farthest = 0.0;
        for ((v, f), x) in self.velocity.iter_mut().zip(force).zip(&mut heap.centres) {
            *v = Vector::<S>::build(|k| keep * v.at(k) + gain * f.at(k));
            let way = Vector::<S>::build(|k| (self.dt * v.at(k)).clamp(-longest, longest));
            *x = x.plus(way);
            let square = way.dot(way);
            farthest = if square > farthest { square } else { farthest };
        }
        for ((v, f), &i) in self.growth.iter_mut().zip(drives).zip(balls) {
            *v = keep * *v + gain * f;
            heap.radii[i] += (self.dt * *v).clamp(-longest, longest);
        }
        farthest.sqrt()
    }

    /// Adapts step and mixing to the power; the share of the velocity that stays.
    fn turn(&mut self, power: f64) -> f64 {
        if power > 0.0 {
            self.since_uphill += 1;
            if self.since_uphill > 5 {
                self.dt = (1.1 * self.dt).min(Self::LONGEST_STEP);
                self.mixing *= 0.99;
            }
            return 1.0 - self.mixing;
        }
        self.velocity.fill(Vector::<S>::zero());
        self.growth.fill(0.0);
        (self.since_uphill, self.mixing) = (0, Self::MIXING);
        self.dt = (0.5 * self.dt).max(0.02);
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::heap::Still;
    use super::super::region::Region;
    use super::*;
    use crate::{D2, D3};

    const UNTIL: Until = Until { unbalanced: 1e-10, slack: 0.0, iterations: 10_000, margin: 0.5 };
    const GO_ON: &dyn Fn() -> Watch = &|| Watch::Continue;

    /// Three equal balls in a row between two walls 5 R apart, twice as stiff at the walls: the total overlap R is shared
    /// as 1/k_n, so R/6 at each wall and R/3 at each contact, in the plane and in the solid.
    #[test]
    fn a_row_shares_its_overlap_by_compliance() {
        fn row<S: Space>(region: Region) -> Vec<f64> {
            let centres = [-1.2, 0.3, 1.7].map(|x| Vector::<S>::build(|k| if k == 0 { x } else { 0.0 })).to_vec();
            let mut heap = Heap::<S> { region, centres, radii: vec![1.0; 3], still: Still::default() };
            let rest = heap.relax(UNTIL, GO_ON);
            assert!(rest.unbalanced < 1e-10, "{rest:?}");
            heap.centres.iter().map(|x| x.at(0)).collect()
        }
        let plane = row::<D2>(Region::Rectangle { width: 5.0, height: 100.0 });
        let solid = row::<D3>(Region::Box { width: 5.0, height: 100.0, depth: 100.0 });
        let expected = [-2.5 + 5.0 / 6.0, 0.0, 2.5 - 5.0 / 6.0];
        for (found, expected) in plane.iter().chain(&solid).zip(expected.iter().chain(&expected)) {
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
    }

    #[test]
    fn separate_balls_stay_where_they_are() {
        let region = Region::Rectangle { width: 10.0, height: 10.0 };
        let mut heap =
            Heap::<D2> { region, centres: vec![[-2.0, 0.0], [2.0, 0.0]], radii: vec![1.0; 2], still: Still::default() };
        let until = Until { unbalanced: 1e-3, slack: 0.0, iterations: 100, margin: 0.5 };
        assert_eq!(heap.relax(until, GO_ON), Rest { iterations: 0, unbalanced: 0.0 });
        assert_eq!(heap.centres, [[-2.0, 0.0], [2.0, 0.0]]);
    }

    /// A small disc off the centre of a hole between four large ones that press on each other grows until it touches as
    /// many as hold it, and its contacts carry the push: it fits the hole, √2 − 1 of the large radius, nearly.
    #[test]
    fn a_swelling_ball_fills_its_hole() {
        let region = Region::Rectangle { width: 3.98, height: 3.98 };
        let mut centres: Vec<[f64; 2]> = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].to_vec();
        centres.push([0.05, 0.02]);
        let mut heap = Heap::<D2> { region, centres, radii: vec![1.0, 1.0, 1.0, 1.0, 0.2], still: Still::default() };
        let until = Until { unbalanced: 1e-4, slack: 0.0, iterations: 20_000, margin: 0.5 };
        let rest = heap.relax_swelling(until, Swelling { balls: &[4], pushes: &[1.0] }, GO_ON);
        assert!(rest.unbalanced < 1e-4, "{rest:?}");
        assert!(heap.contact_counts()[4] >= 3);
        assert!((heap.radii[4] - (2.0_f64.sqrt() - 1.0)).abs() < 0.02, "{}", heap.radii[4]);
    }
}
