//! Rigid clumps in motion.
//!
//! A clump carries the angular momentum L in the fixed frame, so that a torque-free body keeps it exactly; the spin is
//! ω = I⁻¹ L with the inertia turned along. In a step L gains the (damped) moment, the spin is taken at the middle of the
//! step, and the frame is turned by ω dt. Pebbles follow as x = X + R b with v = V + ω × (x − X).

use super::damping::damped;
use super::simd::{Quad, Rows};
use super::space::{Space, Spin, Tuple, Vector};
use std::ops::Range;

/// A clump in the engine's numbering.
#[derive(Clone, Debug)]
pub(crate) struct Rigid<S: Space> {
    /// Its pebbles, one after the other.
    pub(crate) pebbles: Range<usize>,
    /// Their positions in the clump's frame, m.
    pub(crate) offsets: Vec<Vector<S>>,
    /// Centre of mass, m.
    pub(crate) centre: Vector<S>,
    /// Velocity, m/s.
    pub(crate) velocity: Vector<S>,
    /// Angular momentum, kg·m²/s.
    pub(crate) momentum: Spin<S>,
    /// Spin, rad/s.
    pub(crate) spin: Spin<S>,
    /// Turn against the first frame.
    pub(crate) turn: S::Turn,
    /// Mass, kg.
    pub(crate) mass: f64,
    /// Inertia and its inverse in the clump's frame.
    pub(crate) inertia: [[f64; 3]; 3],
    pub(crate) inverse: [[f64; 3]; 3],
    /// Weight and applied load: force, N, and moment, N·m.
    pub(crate) weight: (Vector<S>, Spin<S>),
}

impl<S: Space> Rigid<S> {
    /// Resultant of the pebbles' loads in the order of the pebbles; the loads are cleared.
    #[inline(always)]
    pub(crate) fn collect(&self, rows: &impl Rows, loads: &mut [Quad]) -> (Vector<S>, Spin<S>) {
        let (mut force, mut moment) = self.weight;
        for p in self.pebbles.clone() {
            let load = &mut loads[p * S::LOADS..(p + 1) * S::LOADS];
            let (f, m) = split::<S>(load);
            let place = rows.read(p * S::RECORD);
            let arm = Vector::<S>::build(|k| place.0[k]).minus(self.centre);
            force = force.plus(f);
            moment = moment.plus(m.plus(S::moment(arm, f)));
            load.fill(Quad::default());
        }
        (force, moment)
    }

    /// One step under a resultant; returns the work of local damping, J.
    pub(crate) fn advance(&mut self, force: Vector<S>, moment: Spin<S>, damping: f64, dt: f64) -> f64 {
        let velocity = self.velocity;
        let push = Vector::<S>::build(|k| damped(force.at(k), velocity.at(k), damping));
        self.velocity = velocity.plus(push.times(1.0 / self.mass).times(dt));
        self.centre = self.centre.plus(self.velocity.times(dt));
        let spin = self.spin;
        let twist = Spin::<S>::build(|k| damped(moment.at(k), spin.at(k), damping));
        self.momentum = self.momentum.plus(twist.times(dt));
        let early = S::spin_of(self.turn, &self.inverse, self.momentum);
        let middle = S::turn_on(self.turn, early.times(0.5 * dt));
        self.spin = S::spin_of(middle, &self.inverse, self.momentum);
        self.turn = S::turn_on(self.turn, self.spin.times(dt));
        let shift = force.minus(push).dot(velocity.plus(self.velocity));
        let turn = moment.minus(twist).dot(spin.plus(self.spin));
        0.5 * dt * (shift + turn)
    }

    /// Writes the pebbles' records; returns the largest speed components.
    #[inline(always)]
    pub(crate) fn place(&self, rows: &mut impl Rows) -> Quad {
        let mut fastest = Quad::default();
        for (p, &offset) in self.pebbles.clone().zip(&self.offsets) {
            let arm = S::outward(self.turn, offset);
            let mut record = [Quad::default(); 3];
            record[0] = rows.read(p * S::RECORD);
            set_kinematics::<S>(
                &mut record,
                self.centre.plus(arm),
                self.velocity.plus(S::carried(self.spin, arm)),
                self.spin,
            );
            for (k, &quad) in record[..S::RECORD].iter().enumerate() {
                rows.write(p * S::RECORD + k, quad);
            }
            fastest = fastest.larger(record[1]);
        }
        fastest
    }

    /// Sets velocity and spin.
    pub(crate) fn set_motion(&mut self, velocity: Vector<S>, spin: Spin<S>) {
        self.velocity = velocity;
        self.spin = spin;
        // ω in the body's frame would do as well; turning the inertia keeps one formula for L.
        self.momentum = self.momentum_for(spin);
    }

    fn momentum_for(&self, spin: Spin<S>) -> Spin<S> {
        let back = S::inward(self.turn, spin);
        S::outward_spin(self.turn, S::momentum_of(&self.inertia, back))
    }
}

/// Position of particle `p`.
pub(crate) fn position<S: Space>(records: &[Quad], p: usize) -> Vector<S> {
    let quad = &records[p * S::RECORD].0;
    Vector::<S>::build(|k| quad[k])
}

/// Velocity of particle `p`.
pub(crate) fn velocity<S: Space>(records: &[Quad], p: usize) -> Vector<S> {
    let quad = &records[p * S::RECORD + 1].0;
    Vector::<S>::build(|k| quad[k])
}

/// Spin of particle `p`.
pub(crate) fn spin<S: Space>(records: &[Quad], p: usize) -> Spin<S> {
    let (row, first) = spin_place::<S>();
    let quad = &records[p * S::RECORD + 1 + row].0;
    Spin::<S>::build(|k| quad[first + k])
}

/// Row (after the velocity's) and column at which a spin or moment begins.
pub(crate) fn spin_place<S: Space>() -> (usize, usize) {
    if S::DIMENSION == 2 { (0, 2) } else { (1, 0) }
}

/// Force and moment of a load record.
pub(crate) fn split<S: Space>(load: &[Quad]) -> (Vector<S>, Spin<S>) {
    let (row, first) = spin_place::<S>();
    (Vector::<S>::build(|k| load[0].0[k]), Spin::<S>::build(|k| load[row].0[first + k]))
}

/// Writes a record, all but its radius (and the angle of a disc).
pub(crate) fn set_kinematics<S: Space>(record: &mut [Quad], x: Vector<S>, v: Vector<S>, w: Spin<S>) {
    let (row, first) = spin_place::<S>();
    for k in 0..S::DIMENSION {
        record[0].0[k] = x.at(k);
        record[1].0[k] = v.at(k);
    }
    for k in 0..S::Spin::<f64>::LENGTH {
        record[1 + row].0[first + k] = w.at(k);
    }
}
