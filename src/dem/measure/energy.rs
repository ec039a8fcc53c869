//! Energies. With open books ([`Engine::track_energy`]) they close:
//! kinetic + spring + bond + potential + damping + slip + dashpot + broken = initial + boundary, within about 1 %
//! (velocities live half a step from positions).

use crate::engine::Engine;
use crate::particle::Clump;
use crate::space::{Space, Tuple};

/// Energies of a run, J (per metre of thickness in the plane).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy, with the masses that move the bodies.
    pub kinetic: f64,
    /// Strain energy of the linear springs.
    pub spring: f64,
    /// Strain energy of the parallel bonds.
    pub bond: f64,
    /// Potential energy of the weights and applied forces (not moments), 0 at the origin.
    pub potential: f64,
    /// Spent by local damping.
    pub damping: f64,
    /// Spent by friction.
    pub slip: f64,
    /// Spent by dashpots.
    pub dashpot: f64,
    /// Lost with the bonds that broke.
    pub broken: f64,
    /// Given by walls and prescribed motion.
    pub boundary: f64,
    /// Stored when the books were opened.
    pub initial: f64,
}

impl Energy {
    /// What the books fail to explain over the largest sum that went through them.
    pub fn imbalance(&self) -> f64 {
        let stored = self.kinetic + self.spring + self.bond + self.potential;
        let spent = self.damping + self.slip + self.dashpot + self.broken;
        let turnover = self.kinetic
            + self.spring
            + self.bond
            + spent
            + self.boundary.abs()
            + (self.potential - self.initial).abs();
        if turnover > 0.0 { (stored + spent - self.boundary - self.initial) / turnover } else { 0.0 }
    }
}

/// Energies now; what was spent and given since [`Engine::track_energy`], 0 without.
pub fn energy<S: Space>(engine: &Engine<S>) -> Energy {
    engine.account()
}

/// The stored energies alone.
pub(crate) fn stored<S: Space>(engine: &Engine<S>) -> Energy {
    let gravity = engine.settings().gravity;
    let mut energy = Energy::default();
    for particle in (0..engine.particle_count()).filter(|&p| engine.clump_of(p).is_none()) {
        energy.kinetic += kinetic_of_ball(engine, particle);
        energy.potential -= engine.mass(particle) * gravity.dot(engine.position(particle));
    }
    for particle in 0..engine.particle_count() {
        energy.potential -= engine.applied_force(particle).dot(engine.position(particle));
    }
    for clump in 0..engine.clump_count() {
        let c = engine.clump(clump);
        energy.kinetic += kinetic_of_clump(&c);
        energy.potential -= c.mass * gravity.dot(c.centre);
    }
    for contact in engine.contacts() {
        let [spring, bond] = contact.strain_energy();
        energy.spring += spring;
        energy.bond += bond;
    }
    energy
}

/// Kinetic energy of all bodies, with the masses that move them.
pub(crate) fn kinetic<S: Space>(engine: &Engine<S>) -> f64 {
    let balls = (0..engine.particle_count()).filter(|&p| engine.clump_of(p).is_none());
    let clumps = (0..engine.clump_count()).map(|clump| kinetic_of_clump(&engine.clump(clump)));
    balls.map(|particle| kinetic_of_ball(engine, particle)).chain(clumps).sum()
}

fn kinetic_of_ball<S: Space>(engine: &Engine<S>, particle: usize) -> f64 {
    let ([mass, inertia], v, w) = (engine.moving_mass(particle), engine.velocity(particle), engine.spin(particle));
    0.5 * (mass * v.dot(v) + inertia * w.dot(w))
}

fn kinetic_of_clump<S: Space>(c: &Clump<S>) -> f64 {
    0.5 * (c.mass * c.velocity.dot(c.velocity) + S::momentum_of(&c.inertia, c.spin).dot(c.spin))
}
