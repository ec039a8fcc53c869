//! From a model to an engine.

use super::{Class, Engine, Model, MovingWall};
use crate::body::{Rigid, set_kinematics, spin_place};
use crate::boundary::{Motion, MovingCell, Wall};
use crate::contact::{Face, LawKind};
use crate::error::Faults;
use crate::interaction::ContactTable;
use crate::law::Constants;
use crate::neighbour::morton_order;
use crate::particle::Clump;
use crate::simd::{Quad, Same, Table, Width};
use crate::space::{Space, Spin, Tuple, Vector, flat};
use std::collections::BTreeMap;

/// A body of its own, in `bodies`.
const NO_CLUMP: u32 = u32::MAX;

impl<S: Space> Engine<S> {
    /// Checks a model and sets it up: bodies are renumbered along a Morton curve, contacts are searched, the time step
    /// is derived.
    ///
    /// # Errors
    /// All faults of the model.
    pub fn new(model: &Model<S>) -> Result<Self, Faults> {
        super::validate::check(model)?;
        let (caller, clump_of) = numbering(model);
        let mut engine = Self::empty(model, caller, &clump_of);
        engine.add_particles(model);
        engine.add_clumps(model);
        for wall in &model.walls {
            engine.walls.push(moving(wall));
        }
        engine.set_inverse_masses();
        engine.relist();
        engine.derive_step();
        engine.choose_masses();
        if let Some(cell) = &model.settings.cell {
            engine.strain_cell(cell.rate)?;
        }
        Ok(engine)
    }

    fn empty(model: &Model<S>, caller: Vec<u32>, clump_of: &[u32]) -> Self {
        let n = caller.len();
        let mut index = vec![0; n];
        let mut bodies = vec![0; n];
        let mut single = model.clumps.len() as u32;
        for (p, &id) in caller.iter().enumerate() {
            index[id as usize] = p as u32;
            bodies[p] = clump_of[id as usize];
            if bodies[p] == NO_CLUMP {
                bodies[p] = single;
                single += 1;
            }
        }
        let smallest = model.particles.iter().map(|p| p.radius).fold(f64::INFINITY, f64::min);
        Self {
            settings: model.settings.clone(),
            table: model.contacts.clone(),
            classes: classes::<S>(&model.contacts),
            caller,
            index,
            groups: Vec::with_capacity(n),
            bodies,
            radii: Vec::with_capacity(n),
            masses: Vec::with_capacity(n),
            inertias: Vec::with_capacity(n),
            moving: Vec::with_capacity(n),
            fixed: vec![[false; 2]; n],
            applied: BTreeMap::new(),
            records: Table::new((n + 2) * S::RECORD),
            spare: Table::default(),
            inverse: Table::new(n * S::LOADS),
            inverse_mass: vec![0.0; n + 2],
            weights: Vec::new(),
            clumps: Vec::with_capacity(model.clumps.len()),
            clump_index: vec![0; model.clumps.len()],
            clump_caller: Vec::with_capacity(model.clumps.len()),
            walls: Vec::with_capacity(model.walls.len()),
            cell: model.settings.cell.as_ref().map(MovingCell::new),
            joints: super::joints::Joints::default(),
            domains: Vec::new(),
            threads: 1,
            width: Width::detect(),
            cracks: Vec::new(),
            margin: 0.1 * smallest,
            smallest_radius: smallest,
            travelled: 0.0,
            origins: Vec::new(),
            listed_at: 0,
            checked_at: 0,
            stale: false,
            dt: 0.0,
            step: 0,
            epoch: (0.0, 0),
            energy_sums: None,
        }
    }

    fn add_particles(&mut self, model: &Model<S>) {
        let n = self.caller.len();
        for p in 0..n {
            let particle = &model.particles[self.caller[p] as usize];
            let record = &mut self.records[p * S::RECORD..(p + 1) * S::RECORD];
            record[0].0[3] = particle.radius;
            set_kinematics::<S>(record, particle.position, particle.velocity, particle.spin);
            self.groups.push(particle.group);
            self.radii.push(particle.radius);
            self.masses.push(particle.mass);
            self.inertias.push(particle.inertia);
            self.moving.push([particle.mass, particle.inertia]);
        }
        // Two dummies, apart from each other and at rest, for the idle lanes of the last blocks.
        for (k, p) in [n, n + 1].into_iter().enumerate() {
            self.records[p * S::RECORD].0 = [3.0 * k as f64, 0.0, 0.0, 1.0];
        }
    }

    fn add_clumps(&mut self, model: &Model<S>) {
        // Pebbles of a clump stand together in the engine's order.
        let first = |clump: &Clump<S>| clump.pebbles.iter().map(|&id| self.index[id] as usize).min().unwrap_or(0);
        let mut order: Vec<(usize, usize)> = model.clumps.iter().map(first).zip(0..).collect();
        order.sort_unstable();
        for (k, &(first, id)) in order.iter().enumerate() {
            let clump = &model.clumps[id];
            self.clump_index[id] = k as u32;
            self.clump_caller.push(id as u32);
            let pebbles = first..first + clump.pebbles.len();
            self.bodies[pebbles.clone()].fill(k as u32);
            let offset = |p: usize| model.particles[self.caller[p] as usize].position.minus(clump.centre);
            let mut rigid = Rigid {
                offsets: pebbles.clone().map(offset).collect(),
                pebbles,
                centre: clump.centre,
                velocity: clump.velocity,
                momentum: clump.spin,
                spin: clump.spin,
                turn: S::upright(),
                mass: clump.mass,
                inertia: clump.inertia,
                inverse: S::inverse_inertia(&clump.inertia).unwrap_or_default(),
                weight: (Vector::<S>::zero(), Spin::<S>::zero()),
            };
            rigid.set_motion(clump.velocity, clump.spin);
            rigid.place(&mut Same(&mut self.records));
            self.clumps.push(rigid);
        }
    }

    /// Inverse masses from the moving masses and the fixed components, and the weights.
    pub(super) fn set_inverse_masses(&mut self) {
        let (row, first) = spin_place::<S>();
        let spins = first..first + S::Spin::<f64>::LENGTH;
        for p in 0..self.caller.len() {
            let inverse = &mut self.inverse[p * S::LOADS..(p + 1) * S::LOADS];
            inverse.fill(Quad::default());
            self.inverse_mass[p] = 0.0;
            let clump = self.bodies[p] as usize;
            if clump < self.clumps.len() {
                self.inverse_mass[p] = 1.0 / self.clumps[clump].mass;
                continue;
            }
            if !self.fixed[p][0] {
                self.inverse_mass[p] = 1.0 / self.moving[p][0];
                inverse[0].0[..S::DIMENSION].fill(self.inverse_mass[p]);
            }
            if !self.fixed[p][1] {
                inverse[row].0[spins.clone()].fill(1.0 / self.moving[p][1]);
            }
        }
        self.set_weights();
    }

    /// Weights of the real masses, and the loads that the caller applies.
    fn set_weights(&mut self) {
        let (n, gravity) = (self.caller.len(), self.settings.gravity);
        let any = gravity.norm() > 0.0 || !self.applied.is_empty();
        self.weights = if any { vec![Quad::default(); n * S::LOADS] } else { Vec::new() };
        for clump in &mut self.clumps {
            clump.weight = (gravity.times(clump.mass), Spin::<S>::zero());
        }
        for p in (0..if any { n } else { 0 }).filter(|&p| self.bodies[p] as usize >= self.clumps.len()) {
            let weight = gravity.times(self.masses[p]);
            add_load::<S>(&mut self.weights[p * S::LOADS..(p + 1) * S::LOADS], weight, Spin::<S>::zero());
        }
        for (&p, &(force, moment)) in &self.applied {
            match self.clumps.get_mut(self.bodies[p] as usize) {
                Some(clump) => clump.weight = (clump.weight.0.plus(force), clump.weight.1.plus(moment)),
                None => add_load::<S>(&mut self.weights[p * S::LOADS..(p + 1) * S::LOADS], force, moment),
            }
        }
    }
}

/// Adds to a load record.
fn add_load<S: Space>(load: &mut [Quad], force: Vector<S>, moment: Spin<S>) {
    let (row, first) = spin_place::<S>();
    for k in 0..S::DIMENSION {
        load[0].0[k] += force.at(k);
    }
    for k in 0..S::Spin::<f64>::LENGTH {
        load[row].0[first + k] += moment.at(k);
    }
}

/// The classes of a table.
pub(super) fn classes<S: Space>(table: &ContactTable) -> Vec<Class> {
    let class = |e: &(_, _, crate::interaction::Interaction)| Class {
        law: LawKind::of(&e.2.bond),
        constants: Constants::new::<S>(&e.2),
    };
    table.entries.iter().map(class).collect()
}

/// A wall as it starts.
pub(super) fn moving<S: Space>(wall: &Wall<S>) -> MovingWall<S> {
    let velocity = match wall.motion {
        Motion::Velocity(v) => v,
        Motion::Servo(_) => Vector::<S>::zero(),
    };
    let normal = wall.normal.times(1.0 / wall.normal.norm());
    MovingWall {
        face: Face { point: wall.point, normal, velocity },
        motion: wall.motion,
        group: wall.group,
        present: true,
        origin: wall.point,
        stiffness: 0.0,
    }
}

/// The caller's indices in the engine's order (bodies along a Morton curve, pebbles of a clump together), and the clump
/// of each of the caller's particles.
fn numbering<S: Space>(model: &Model<S>) -> (Vec<u32>, Vec<u32>) {
    let mut clump_of = vec![NO_CLUMP; model.particles.len()];
    for (k, clump) in model.clumps.iter().enumerate() {
        for &id in &clump.pebbles {
            clump_of[id] = k as u32;
        }
    }
    let mut centres: Vec<[f64; 3]> = model.clumps.iter().map(|c| flat::<S>(c.centre)).collect();
    let singles: Vec<u32> = (0..clump_of.len() as u32).filter(|&id| clump_of[id as usize] == NO_CLUMP).collect();
    centres.extend(singles.iter().map(|&id| flat::<S>(model.particles[id as usize].position)));
    let mut caller = Vec::with_capacity(clump_of.len());
    for body in morton_order(&centres, S::DIMENSION) {
        match model.clumps.get(body as usize) {
            None => caller.push(singles[body as usize - model.clumps.len()]),
            Some(clump) => {
                let pebbles: Vec<[f64; 3]> =
                    clump.pebbles.iter().map(|&id| flat::<S>(model.particles[id].position)).collect();
                let order = morton_order(&pebbles, S::DIMENSION);
                caller.extend(order.iter().map(|&k| clump.pebbles[k as usize] as u32));
            }
        }
    }
    (caller, clump_of)
}
