//! One step, and many.
//!
//! Order: contact forces at x(t) from velocities at t − dt/2; clumps and balls gain velocity, then position (leapfrog);
//! walls move; the contact list is renewed if a body came too far.

use super::{Ended, Engine, Watch};
use crate::dem::body::velocity;
use crate::dem::boundary::Motion;
use crate::dem::contact::{Other, Sweep, sweep_section};
use crate::dem::damping::damped;
use crate::dem::error::Failure;
use crate::dem::measure::{Crack, Mode};
use crate::dem::space::{Space, Tuple, Vector};

/// Share of the smallest radius that a body may move in one step before the run is called unstable.
const STRIDE: f64 = 0.1;

impl<S: Space> Engine<S> {
    /// Makes `steps` steps; every `every` steps (and at the end) `watch` looks at the engine and may stop it.
    ///
    /// # Errors
    /// Why the run failed.
    pub fn run(&mut self, steps: u64, every: u64, mut watch: impl FnMut(&Self) -> Watch) -> Result<Ended, Failure> {
        let mut left = steps;
        while left > 0 {
            let now = left.min(every.max(1));
            self.advance(now)?;
            left -= now;
            if watch(self) == Watch::Stop {
                return Ok(Ended::Stopped);
            }
        }
        Ok(Ended::Finished)
    }

    /// Makes `steps` steps.
    ///
    /// # Errors
    /// Why the run failed.
    pub fn advance(&mut self, steps: u64) -> Result<(), Failure> {
        for _ in 0..steps {
            if self.stale {
                self.check()?;
                self.relist_if_due();
                self.derive_step();
            }
            self.forces();
            self.note_cracks();
            let fastest = self.integrate();
            self.move_walls();
            self.step += 1;
            self.time += self.dt;
            self.note_travel(fastest)?;
        }
        self.check()
    }

    /// Contact forces at the present positions.
    fn forces(&mut self) {
        let task = Sweep { records: &self.records, inverse_mass: &self.inverse_mass, dt: self.dt };
        for section in &mut self.sections {
            let class = &self.classes[section.class];
            let face = section.wall.map(|w| &self.walls[w as usize].face);
            sweep_section::<S, f64>(
                class.law,
                &class.constants,
                face,
                section,
                &task,
                &mut self.loads,
                &mut self.breaks,
            );
        }
    }

    /// New velocities and positions; the largest speed squared, componentwise summed.
    fn integrate(&mut self) -> f64 {
        let (alpha, dt) = (self.settings.damping, self.dt);
        for clump in &mut self.clumps {
            let (force, moment) = clump.collect(&self.records, &mut self.loads);
            clump.advance(force, moment, alpha, dt);
            clump.place(&mut self.records);
        }
        let mut fastest = [0.0_f64; 4];
        for p in 0..self.caller.len() {
            let record = &mut self.records[p * S::RECORD..(p + 1) * S::RECORD];
            if (self.bodies[p] as usize) >= self.clumps.len() {
                for q in 0..S::LOADS {
                    let load = &mut self.loads[p * S::LOADS + q];
                    for k in 0..4 {
                        let weight = self.weights.get(p * S::LOADS + q).map_or(0.0, |w| w.0[k]);
                        let v = record[1 + q].0[k];
                        let push = damped(load.0[k] + weight, v, alpha) * self.inverse[p * S::LOADS + q].0[k];
                        record[1 + q].0[k] = v + push * dt;
                    }
                    load.0 = [0.0; 4];
                }
                for k in 0..4 {
                    record[0].0[k] += record[1].0[k] * dt;
                }
            }
            for (top, v) in fastest.iter_mut().zip(record[1].0) {
                *top = if v.abs() > *top { v.abs() } else { *top };
            }
        }
        fastest[..S::DIMENSION].iter().map(|v| v * v).sum::<f64>().sqrt()
    }

    fn move_walls(&mut self) {
        for w in 0..self.walls.len() {
            if let Motion::Servo(servo) = self.walls[w].motion {
                let stress = -self.wall_force(w).dot(self.walls[w].face.normal) / servo.area;
                let stiffness = self.wall_stiffness(w).max(f64::MIN_POSITIVE);
                let gain = servo.relaxation * servo.area / (stiffness * self.dt);
                let limit = servo.speed_limit;
                let speed = (gain * (servo.pressure - stress)).clamp(-limit, limit);
                self.walls[w].face.velocity = self.walls[w].face.normal.times(speed);
            }
            let face = &mut self.walls[w].face;
            face.point = face.point.plus(face.velocity.times(self.dt));
        }
    }

    /// Keeps the bound of the way travelled, and marks the list when it may miss a contact.
    fn note_travel(&mut self, fastest: f64) -> Result<(), Failure> {
        let walls = self.walls.iter().map(|w| w.face.velocity.norm()).fold(0.0, f64::max);
        let stride = fastest.max(walls) * self.dt;
        if stride > STRIDE * self.smallest_radius {
            return Err(self.unstable(stride));
        }
        self.travelled += stride;
        if 2.0 * self.travelled > self.margin {
            // The bound adds up the fastest body of each step; what truly moved is often less.
            self.travelled = self.true_travel().max(walls * self.dt * (self.step - self.listed_at) as f64);
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
    fn check(&self) -> Result<(), Failure> {
        for p in 0..self.caller.len() {
            let particle = self.caller[p] as usize;
            let (x, v) = (self.position_of(p), velocity::<S>(&self.records, p));
            if !(x.norm() + v.norm()).is_finite() {
                return Err(Failure::NotFinite { particle, step: self.step });
            }
            if let Some([low, high]) = self.settings.bounds {
                if (0..S::DIMENSION).any(|k| x.at(k) < low.at(k) || x.at(k) > high.at(k)) {
                    return Err(Failure::Escape { particle, step: self.step });
                }
            }
        }
        Ok(())
    }

    /// Turns the breaks of this step into cracks.
    fn note_cracks(&mut self) {
        let breaks = std::mem::take(&mut self.breaks);
        for b in &breaks {
            let (i, j) = (b.i as usize, b.j as usize);
            let key = crate::dem::contact::Key { i: b.i, at_wall: b.at_wall, j: b.j };
            let gap = self.gap(key);
            let x = self.position_of(i);
            let normal = if b.at_wall {
                self.walls[j].face.normal.times(-1.0)
            } else {
                let apart = self.position_of(j).minus(x);
                apart.times(1.0 / apart.norm())
            };
            let [first, second] = self.contact_radii(key);
            self.cracks.push(Crack {
                step: self.step,
                time: self.time,
                mode: if b.tensile { Mode::Tension } else { Mode::Shear },
                particle: self.caller[i] as usize,
                other: if b.at_wall { Other::Wall(j) } else { Other::Particle(self.caller[j] as usize) },
                position: x.plus(normal.times(self.radii[i] + 0.5 * gap)),
                normal,
                size: 2.0 * self.classes[b.class].constants.multiplier * first.min(second),
                gap,
            });
        }
        self.breaks = breaks;
        self.breaks.clear();
    }

    /// Force of the balls on wall `w`, N, at the positions of the last step.
    pub fn wall_force(&self, w: usize) -> Vector<S> {
        let mut sum = Vector::<S>::zero();
        for section in self.sections.iter().filter(|s| s.wall == Some(w as u32)) {
            for block in section.reactions.chunks_exact(S::DIMENSION) {
                for lane in 0..crate::dem::simd::WIDEST {
                    sum = sum.plus(Vector::<S>::build(|k| block[k].0[lane]));
                }
            }
        }
        sum
    }

    /// Sum of the normal stiffnesses of the closed contacts of wall `w`, N/m.
    fn wall_stiffness(&self, w: usize) -> f64 {
        let mut sum = 0.0;
        for section in self.sections.iter().filter(|s| s.wall == Some(w as u32)) {
            for c in 0..section.count {
                sum += section.value::<S>(c, crate::dem::law::KN);
            }
        }
        sum
    }
}
