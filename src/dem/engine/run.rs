//! Many steps: marches between renewals of the contact list, and what can end a run.

use super::march::{March, Orders, Outcome, Shared};
use super::{Ended, Engine, Watch};
use crate::body::velocity;
use crate::contact::{Break, Key, Other};
use crate::error::Failure;
use crate::measure::{Crack, Mode};
use crate::simd::{Board, dispatch, exchange};
use crate::space::{Space, Tuple, Vector};

/// Smallest radii that a body may move in one step; further, and it could pass through another.
const STRIDE: f64 = 2.0;
/// Steps after which the end of a run looks for bodies out of bounds; every renewal of the list does.
const CHECK: u64 = 1000;
/// Particles that occupy a thread: with fewer, it waits at the barrier of every step longer than it computes.
const WORTHWHILE: usize = 1000;

impl<S: Space> Engine<S> {
    /// Makes `steps` steps; every `every` steps (at least one, and at the end) `watch` looks at the engine and may stop it.
    ///
    /// # Errors
    /// Why the run failed.
    pub fn run(&mut self, steps: u64, every: u64, mut watch: impl FnMut(&Self) -> Watch) -> Result<Ended, Failure> {
        let mut left = steps;
        while left > 0 {
            let now = left.min(every.max(1));
            self.advance(now)?;
            left -= now;
            let wish = watch(self);
            if !self.heed(wish) {
                return Ok(Ended::Stopped);
            }
        }
        Ok(Ended::Finished)
    }

    /// Does what a watcher wants: uses the threads it grants, as far as the particles are enough to occupy them. Returns
    /// false when it wants the run to end.
    pub fn heed(&mut self, wish: Watch) -> bool {
        if let Watch::Threads(granted) = wish {
            let threads = granted.min(self.particle_count() / WORTHWHILE).max(1);
            if threads != self.threads {
                self.set_threads(threads);
            }
        }
        wish != Watch::Stop
    }

    /// Makes `steps` steps.
    ///
    /// # Errors
    /// Why the run failed.
    pub fn advance(&mut self, steps: u64) -> Result<(), Failure> {
        S::advance(self, steps)
    }

    /// The loop itself, called by each space.
    pub(crate) fn march_on(&mut self, steps: u64) -> Result<(), Failure> {
        let end = self.step.saturating_add(steps);
        while self.step < end {
            if self.stale {
                self.check()?;
                self.relist_when_old();
                self.derive_step();
            }
            let outcome = self.march(end - self.step);
            self.take_in(outcome)?;
        }
        if self.step - self.checked_at >= CHECK {
            self.check()?;
        }
        Ok(())
    }

    /// Makes up to `steps` steps on all threads, until the contact list may miss something.
    fn march(&mut self, steps: u64) -> Outcome<S> {
        let shared = Shared::new(self);
        let mut domains = std::mem::take(&mut self.domains);
        let mut records = std::mem::take(&mut self.records);
        let mut clumps = std::mem::take(&mut self.clumps);
        let orders = Orders {
            classes: &self.classes,
            inverse: &self.inverse,
            inverse_mass: &self.inverse_mass,
            weights: &self.weights,
            damping: self.settings.damping,
            dt: self.dt,
            first_step: self.step,
            steps,
            travelled: self.travelled,
            reach: self.margin,
            stride: STRIDE * self.smallest_radius,
            shared: &shared,
        };
        let ranges: Vec<_> =
            domains.iter().map(|d| d.particles.start * S::RECORD..d.particles.end * S::RECORD).collect();
        let mut rest = clumps.as_mut_slice();
        let mut tasks = Vec::with_capacity(domains.len());
        for (index, domain) in domains.iter_mut().enumerate() {
            let (own, others) = rest.split_at_mut(domain.clumps.len());
            rest = others;
            let (orders, walls, cell, width) = (&orders, self.walls.clone(), self.cell.clone(), self.width);
            tasks.push(move |board: Board<'_>| {
                dispatch(width, March { orders, index, domain, clumps: own, walls, cell, board })
            });
        }
        let mut outcomes = exchange(&mut records, &mut self.spare, &ranges, tasks);
        (self.domains, self.records, self.clumps) = (domains, records, clumps);
        outcomes.swap_remove(0)
    }

    /// Takes over what a march left, and judges it.
    fn take_in(&mut self, outcome: Outcome<S>) -> Result<(), Failure> {
        (self.walls, self.cell) = (outcome.walls, outcome.cell);
        self.note_cracks();
        self.step += outcome.steps;
        self.travelled = outcome.travelled;
        if let Some(travel) = outcome.unstable {
            self.check()?;
            return Err(self.unstable(travel));
        }
        if outcome.stale {
            // The bound adds up the fastest body of each step; what truly moved is often less.
            self.travelled = self.true_travel();
            self.stale = 2.0 * self.travelled > self.margin;
        }
        Ok(())
    }

    fn unstable(&self, travel: f64) -> Failure {
        let speed = |p: usize| velocity::<S>(&self.records, p).norm();
        let fastest = (0..self.caller.len()).fold(0, |best, p| if speed(p) > speed(best) { p } else { best });
        let limit = STRIDE * self.smallest_radius;
        Failure::Instability { particle: self.caller[fastest] as usize, step: self.step, travel, limit }
    }

    /// Finite and inside the bounds.
    fn check(&mut self) -> Result<(), Failure> {
        self.checked_at = self.step;
        for p in 0..self.caller.len() {
            let particle = self.caller[p] as usize;
            let (x, v) = (self.position_of(p), velocity::<S>(&self.records, p));
            if !(x.norm() + v.norm()).is_finite() {
                return Err(Failure::NotFinite { particle, step: self.step });
            }
            let outside =
                |[low, high]: [Vector<S>; 2]| (0..S::DIMENSION).any(|k| x.at(k) < low.at(k) || x.at(k) > high.at(k));
            let strayed = self.cell.as_ref().is_some_and(|cell| !cell.holds(x));
            if strayed || self.settings.bounds.is_some_and(outside) {
                return Err(Failure::Escape { particle, step: self.step });
            }
        }
        Ok(())
    }

    /// Turns the breaks of the last march into cracks, in the order of (step, wall or not, class, ends, element).
    fn note_cracks(&mut self) {
        let mut breaks: Vec<(u64, Break)> = self.domains.iter_mut().flat_map(|d| d.breaks.drain(..)).collect();
        breaks.sort_unstable_by_key(|(step, b)| (*step, b.at_wall, b.class, b.i, b.j, b.element));
        for (step, b) in breaks {
            let key = Key { i: b.i, at_wall: b.at_wall, j: b.j, image: 0 };
            let (i, j) = (b.i as usize, b.j as usize);
            let [first, second] = self.contact_radii(key);
            let constants = &self.classes[b.class].constants;
            self.cracks.push(Crack {
                step,
                time: self.epoch.0 + (step - self.epoch.1) as f64 * self.dt,
                mode: if b.tensile { Mode::Tension } else { Mode::Shear },
                particle: self.caller[i] as usize,
                other: if b.at_wall { Other::Wall(j) } else { Other::Particle(self.caller[j] as usize) },
                position: Vector::<S>::build(|k| b.middle[k]),
                contact: Vector::<S>::build(|k| b.point[k]),
                normal: Vector::<S>::build(|k| b.normal[k]),
                element: b.element,
                elements: constants.layout.count,
                size: 2.0 * constants.multiplier * first.min(second) * constants.layout.size,
                gap: b.gap,
            });
        }
    }
}
