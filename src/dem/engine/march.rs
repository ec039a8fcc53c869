//! The steps of one stretch of bodies, on one thread.
//!
//! Order of a step: contact forces at x(t) from velocities at t − dt/2; clumps and balls gain velocity, then position
//! (leapfrog); walls move; the threads meet; servo walls take the speed that the forces of this step ask for. Every
//! thread moves its own copy of the walls with the same numbers, and every thread takes the same decision to stop.

use super::domain::Domain;
use super::{Class, Engine, MovingWall};
use crate::body::Rigid;
use crate::boundary::{Motion, MovingCell};
use crate::contact::{Break, Second, Sweep, sweep_section};
use crate::damping::damped;
use crate::simd::{Board, Kernel, Lane, Quad, Rows, Update};
use crate::space::{Space, Tuple};
use std::sync::atomic::{AtomicU64, Ordering};

/// What all threads of a march know.
pub(super) struct Orders<'a> {
    pub(super) classes: &'a [Class],
    pub(super) inverse: &'a [Quad],
    pub(super) inverse_mass: &'a [f64],
    pub(super) weights: &'a [Quad],
    pub(super) damping: f64,
    pub(super) dt: f64,
    pub(super) first_step: u64,
    pub(super) steps: u64,
    /// Travel of any body since the list was made, and the largest that the list allows, m.
    pub(super) travelled: f64,
    pub(super) reach: f64,
    /// Largest way in one step, m.
    pub(super) stride: f64,
    pub(super) shared: &'a Shared,
}

/// Values that the threads exchange: for even and odd steps, the largest speed of each stretch, and the normal force of
/// each contact of a servo wall in the order of the list.
pub(super) struct Shared {
    speeds: [Vec<AtomicU64>; 2],
    forces: [Vec<AtomicU64>; 2],
    /// Servo walls and their stretch of `forces`.
    servos: Vec<(usize, std::ops::Range<usize>)>,
    /// First index in `forces` of each section, by stretch and section.
    first: Vec<Vec<Option<usize>>>,
}

impl Shared {
    pub(super) fn new<S: Space>(engine: &Engine<S>) -> Self {
        let mut first: Vec<Vec<Option<usize>>> = engine.domains.iter().map(|d| vec![None; d.sections.len()]).collect();
        let mut servos = Vec::new();
        let mut count = 0;
        for (w, wall) in engine.walls.iter().enumerate() {
            if !matches!(wall.motion, Motion::Servo(_)) {
                continue;
            }
            let start = count;
            let sections = engine.domains.iter().enumerate().flat_map(|(d, domain)| {
                domain.sections.iter().enumerate().map(move |(s, section)| (section.rank, d, s, section.count))
            });
            let mut own: Vec<_> = sections.filter(|(rank, ..)| rank.at_wall && rank.second == w as u32).collect();
            own.sort_unstable();
            for (_, d, s, contacts) in own {
                first[d][s] = Some(count);
                count += contacts;
            }
            servos.push((w, start..count));
        }
        let cells = |n: usize| (0..n).map(|_| AtomicU64::new(0)).collect();
        let stretches = engine.domains.len();
        Self { speeds: [cells(stretches), cells(stretches)], forces: [cells(count), cells(count)], servos, first }
    }
}

/// How a march ended.
#[derive(Clone, Debug)]
pub(super) struct Outcome<S: Space> {
    pub(super) walls: Vec<MovingWall<S>>,
    pub(super) cell: Option<MovingCell<S>>,
    pub(super) steps: u64,
    pub(super) travelled: f64,
    pub(super) stale: bool,
    /// The way of the last step, if it was too long.
    pub(super) unstable: Option<f64>,
}

/// One thread's march.
pub(super) struct March<'a, S: Space> {
    pub(super) orders: &'a Orders<'a>,
    pub(super) index: usize,
    pub(super) domain: &'a mut Domain,
    pub(super) clumps: &'a mut [Rigid<S>],
    pub(super) walls: Vec<MovingWall<S>>,
    pub(super) cell: Option<MovingCell<S>>,
    pub(super) board: Board<'a>,
}

impl<S: Space> Kernel for March<'_, S> {
    type Output = Outcome<S>;

    #[inline(always)]
    fn run<L: Lane>(mut self) -> Outcome<S> {
        let orders = self.orders;
        let (steps, travelled) = (0, orders.travelled);
        let mut end = Outcome { walls: Vec::new(), cell: None, steps, travelled, stale: false, unstable: None };
        while end.steps < orders.steps && !end.stale {
            let parity = (end.steps % 2) as usize;
            self.forces::<L>(orders.first_step + end.steps);
            let update = Integrate { orders, domain: &mut *self.domain, clumps: &mut *self.clumps };
            let fastest = self.board.update(update);
            move_walls(&mut self.walls, orders.dt);
            if let Some(cell) = &mut self.cell {
                cell.advance(orders.dt);
            }
            self.tell(parity, fastest);
            self.board.meet();
            end.steps += 1;
            serve(&mut self.walls, orders, parity);
            let speeds = &orders.shared.speeds[parity];
            let balls = speeds.iter().map(|s| f64::from_bits(s.load(Ordering::Relaxed))).fold(0.0, f64::max);
            let fastest = self.walls.iter().map(|w| w.face.velocity.norm()).fold(balls, f64::max);
            let fastest = self.cell.as_ref().map_or(fastest, |cell| fastest + 0.5 * cell.speed());
            let way = fastest * orders.dt;
            end.travelled += way;
            end.stale = 2.0 * end.travelled > orders.reach;
            if way > orders.stride {
                (end.stale, end.unstable) = (true, Some(way));
            }
        }
        (end.walls, end.cell) = (self.walls, self.cell);
        end
    }
}

impl<S: Space> March<'_, S> {
    /// Contact forces at the present positions, into the loads.
    #[inline(always)]
    fn forces<L: Lane>(&mut self, step: u64) {
        let Domain { sections, loads, breaks, particles, .. } = &mut *self.domain;
        let task = Sweep { records: self.board.all(), inverse_mass: self.orders.inverse_mass, dt: self.orders.dt };
        let mut broken: Vec<Break> = Vec::new();
        for section in sections {
            let class = &self.orders.classes[section.rank.class];
            let image = section.wall().is_none().then_some(section.rank.second as u8).filter(|&image| image != 0);
            let image = self.cell.as_ref().zip(image).map(|(cell, image)| cell.image(image));
            let second = match (section.wall(), &image) {
                (Some(w), _) => Second::Wall(&self.walls[w as usize].face),
                (None, Some(image)) => Second::Images(image),
                (None, None) => Second::Balls,
            };
            sweep_section::<S, L>(&class.constants, second, section, &task, loads, &mut broken);
        }
        // A bond across two stretches breaks in both; its first particle's owner reports it.
        breaks.extend(broken.into_iter().filter(|b| particles.contains(&(b.i as usize))).map(|b| (step, b)));
    }

    /// Publishes the numbers of this stretch to the other threads.
    #[inline(always)]
    fn tell(&self, parity: usize, fastest: f64) {
        let shared = self.orders.shared;
        shared.speeds[parity][self.index].store(fastest.to_bits(), Ordering::Relaxed);
        for (section, first) in self.domain.sections.iter().zip(&shared.first[self.index]) {
            if let (Some(first), Some(wall)) = (first, section.wall()) {
                let normal = self.walls[wall as usize].face.normal;
                let mut next = *first;
                Engine::<S>::visit_reactions(section, |force| {
                    let normal: f64 = (0..S::DIMENSION).map(|k| force[k] * normal.at(k)).sum();
                    shared.forces[parity][next].store(normal.to_bits(), Ordering::Relaxed);
                    next += 1;
                });
            }
        }
    }
}

fn move_walls<S: Space>(walls: &mut [MovingWall<S>], dt: f64) {
    for wall in walls {
        wall.face.point = wall.face.point.plus(wall.face.velocity.times(dt));
    }
}

/// New speeds of the servo walls from the forces of this step.
fn serve<S: Space>(walls: &mut [MovingWall<S>], orders: &Orders<'_>, parity: usize) {
    for (w, range) in &orders.shared.servos {
        let wall = &mut walls[*w];
        let Motion::Servo(servo) = wall.motion else { continue };
        let forces = &orders.shared.forces[parity][range.clone()];
        let force: f64 = forces.iter().map(|f| f64::from_bits(f.load(Ordering::Relaxed))).sum();
        let stress = -force / servo.area;
        let gain = servo.relaxation * servo.area / (wall.stiffness.max(f64::MIN_POSITIVE) * orders.dt);
        let speed = (gain * (servo.pressure - stress)).clamp(-servo.speed_limit, servo.speed_limit);
        wall.face.velocity = wall.face.normal.times(speed);
    }
}

/// New velocities and positions of a stretch; returns its largest speed (a bound that takes each component's largest), or
/// ∞ if a velocity is not finite.
struct Integrate<'a, S: Space> {
    orders: &'a Orders<'a>,
    domain: &'a mut Domain,
    clumps: &'a mut [Rigid<S>],
}

impl<S: Space> Update<f64> for Integrate<'_, S> {
    #[inline(always)]
    fn run<R: Rows>(self, rows: &mut R) -> f64 {
        let Orders { damping, dt, inverse, weights, .. } = *self.orders;
        let loads = &mut *self.domain.loads;
        let (mut fastest, mut spoiled) = (Quad::default(), Quad::default());
        let books = !self.domain.spent.is_empty();
        for (k, clump) in self.clumps.iter_mut().enumerate() {
            let (force, moment) = clump.collect(rows, loads);
            let drag = clump.advance(force, moment, damping, dt);
            if books {
                self.domain.clump_spent[k] += drag;
            }
            let top = clump.place(rows);
            fastest = fastest.larger(top);
            spoiled = spoiled.plus(top.times(0.0));
        }
        for p in self.domain.singles.iter().flat_map(|run| run.clone()) {
            let mut way = Quad::default();
            for q in 0..S::LOADS {
                let slot = p * S::LOADS + q;
                let mut load = loads[slot];
                if !weights.is_empty() {
                    load = load.plus(weights[slot]);
                }
                loads[slot] = Quad::default();
                let before = rows.read(p * S::RECORD + 1 + q);
                let velocity = accelerated(before, load, inverse[slot], damping, dt);
                if books {
                    let spent = &mut self.domain.spent[p - self.domain.particles.start];
                    book(spent, load, inverse[slot], [before, velocity], damping, dt);
                }
                rows.write(p * S::RECORD + 1 + q, velocity);
                // 0 · v is 0 unless v is not finite; such a sum never comes back to 0.
                spoiled = spoiled.plus(velocity.times(0.0));
                if q == 0 {
                    way = velocity;
                    fastest = fastest.larger(velocity);
                }
            }
            let mut position = rows.read(p * S::RECORD);
            for k in 0..4 {
                position.0[k] += way.0[k] * dt;
            }
            rows.write(p * S::RECORD, position);
        }
        if spoiled != Quad::default() {
            return f64::INFINITY;
        }
        fastest.0[..S::DIMENSION].iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// v + (damped force) / m dt, component by component.
#[inline(always)]
fn accelerated(velocity: Quad, load: Quad, inverse: Quad, damping: f64, dt: f64) -> Quad {
    let mut next = velocity;
    for k in 0..4 {
        let push = damped(load.0[k], velocity.0[k], damping) * inverse.0[k];
        next.0[k] = velocity.0[k] + push * dt;
    }
    next
}

/// Work of local damping, and of the agent that prescribes components, with the mean of the old and new velocity.
#[inline(always)]
fn book(spent: &mut [f64; 2], load: Quad, inverse: Quad, [before, after]: [Quad; 2], damping: f64, dt: f64) {
    for k in 0..4 {
        let way = 0.5 * (before.0[k] + after.0[k]) * dt;
        if inverse.0[k] == 0.0 {
            spent[1] -= load.0[k] * way;
        } else {
            spent[0] += (load.0[k] - damped(load.0[k], before.0[k], damping)) * way;
        }
    }
}
