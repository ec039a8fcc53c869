//! What a caller may change between runs. Particles are named by their indices in the caller's list.
//!
//! A call that is refused has changed nothing; calls that return nothing cannot be wrong.

use super::Engine;
use super::build::{classes, moving};
use crate::body::set_kinematics;
use crate::boundary::{Motion, Wall};
use crate::error::Faults;
use crate::interaction::ContactTable;
use crate::law::unbond;
use crate::measure::kinetic;
use crate::simd::{Same, Width};
use crate::space::{Space, Spin, Tuple, Vector};

impl<S: Space> Engine<S> {
    /// Sets all velocities and spins of free bodies to zero.
    pub fn calm(&mut self) {
        let rest = (Vector::<S>::zero(), Spin::<S>::zero());
        for p in 0..self.caller.len() {
            let x = self.position_of(p);
            let (v, w) = (crate::body::velocity::<S>(&self.records, p), crate::body::spin::<S>(&self.records, p));
            let [keep_v, keep_w] = self.fixed[p];
            let (v, w) = (if keep_v { v } else { rest.0 }, if keep_w { w } else { rest.1 });
            set_kinematics::<S>(&mut self.records[p * S::RECORD..(p + 1) * S::RECORD], x, v, w);
        }
        for clump in &mut self.clumps {
            clump.set_motion(rest.0, rest.1);
        }
    }

    /// Sets velocity (m/s) and spin (rad/s) of a ball, or of the clump it belongs to.
    ///
    /// # Errors
    /// No such particle, or a number that is not finite.
    pub fn set_motion(&mut self, particle: usize, velocity: Vector<S>, spin: Spin<S>) -> Result<(), Faults> {
        let p = self.admit(particle, ("velocity", velocity, "m/s"), ("spin", spin, "rad/s"))?;
        match self.clumps.get_mut(self.bodies[p] as usize) {
            Some(clump) => {
                clump.set_motion(velocity, spin);
                clump.place(&mut Same(&mut self.records));
            }
            None => {
                let x = self.position_of(p);
                set_kinematics::<S>(&mut self.records[p * S::RECORD..(p + 1) * S::RECORD], x, velocity, spin);
            }
        }
        Ok(())
    }

    /// Multiplies the velocity and spin of every body, those that are held among them, and the velocity of every wall but a
    /// servo's, which sets its own. The energy sums take what that adds to the kinetic energy as given from outside.
    ///
    /// # Errors
    /// A factor that is negative or not finite.
    pub fn scale_motion(&mut self, factor: f64) -> Result<(), Faults> {
        super::validate::check_factor(factor)?;
        if self.energy_sums.is_some() {
            let given = (factor * factor - 1.0) * kinetic(self);
            self.energy_sums.iter_mut().for_each(|sums| sums.bodies[1] += given);
        }
        for p in (0..self.caller.len()).filter(|&p| self.bodies[p] as usize >= self.clumps.len()) {
            let (x, v) = (self.position_of(p), crate::body::velocity::<S>(&self.records, p));
            let (v, w) = (v.times(factor), crate::body::spin::<S>(&self.records, p).times(factor));
            set_kinematics::<S>(&mut self.records[p * S::RECORD..(p + 1) * S::RECORD], x, v, w);
        }
        for clump in &mut self.clumps {
            clump.set_motion(clump.velocity.times(factor), clump.spin.times(factor));
            clump.place(&mut Same(&mut self.records));
        }
        for wall in &mut self.walls {
            if let Motion::Velocity(v) = &mut wall.motion {
                *v = v.times(factor);
                wall.face.velocity = *v;
            }
        }
        Ok(())
    }

    /// Takes the velocity (and spin) of some balls out of the equations of motion, or gives them back: they stay as set by
    /// [`set_motion`](Self::set_motion).
    ///
    /// # Errors
    /// Every particle that does not exist or is a pebble of a clump.
    pub fn fix(&mut self, particles: &[usize], velocity: bool, spin: bool) -> Result<(), Faults> {
        for p in self.admit_fixing(particles)? {
            self.fixed[p] = [velocity, spin];
        }
        self.set_inverse_masses();
        self.derive_step();
        Ok(())
    }

    /// Puts a constant force (N) and moment (N·m) on a ball, or at the centre of the clump it belongs to, instead of an
    /// earlier one.
    ///
    /// # Errors
    /// No such particle, or a number that is not finite.
    pub fn apply(&mut self, particle: usize, force: Vector<S>, moment: Spin<S>) -> Result<(), Faults> {
        let p = self.admit(particle, ("force", force, "N"), ("moment", moment, "N*m"))?;
        let body = self.clumps.get(self.bodies[p] as usize).map_or(p, |clump| clump.pebbles.start);
        self.applied.insert(body, (force, moment));
        self.set_inverse_masses();
        Ok(())
    }

    /// Multiplies the radius of some balls; mass and inertia follow at constant density. Stiffnesses of the springs (and
    /// the masses of [`Masses::EqualStep`](super::Masses)) are derived anew; bonds do not change.
    ///
    /// # Errors
    /// Every particle that does not exist or is a pebble of a clump, every factor that is not above 0 or makes a radius or
    /// mass that is no number above 0; a periodic cell with an edge below six times the largest radius.
    pub fn scale_radii(&mut self, factors: &[(usize, f64)]) -> Result<(), Faults> {
        let places = self.admit_scaling(factors)?;
        for (p, &(_, factor)) in places.into_iter().zip(factors) {
            let volume = S::volume(self.radii[p]);
            self.radii[p] *= factor;
            let growth = S::volume(self.radii[p]) / volume;
            self.masses[p] *= growth;
            self.inertias[p] *= growth * factor * factor;
            self.records[p * S::RECORD].0[3] = self.radii[p];
        }
        self.smallest_radius = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        self.relist();
        self.choose_masses();
        Ok(())
    }

    /// Replaces the contact table. Contacts keep their reference gaps and forces; bonds retain the values of their
    /// installation as long as the law of the pair stays the same, and vanish otherwise.
    ///
    /// # Errors
    /// All faults of the table.
    pub fn set_contacts(&mut self, table: &ContactTable) -> Result<(), Faults> {
        super::validate::check_table::<S>(table, &self.meetings())?;
        let mut after = classes::<S>(table);
        after.extend(self.joints.classes());
        let before = std::mem::replace(&mut self.classes, after);
        self.table = table.clone();
        // A class is a pair of groups, so a section keeps its contacts and takes the pair's place in the new table.
        let mut domains = std::mem::take(&mut self.domains);
        let mut exchanged = vec![false; self.classes.len()];
        for section in domains.iter_mut().flat_map(|domain| &mut domain.sections) {
            let class = self.class_of(section.key(0)) as usize;
            exchanged[class] = self.classes[class].law != before[section.rank.class].law;
            section.rank.class = class;
        }
        self.domains = domains;
        self.rewrite(&[], |engine, key, memory| {
            if exchanged[engine.class_of(key) as usize] {
                unbond::<S>(memory);
            }
            engine.set_stiffness(key, memory);
        });
        self.renew();
        Ok(())
    }

    /// Strains a periodic cell from now on with the velocity gradient `rate` (1/s). The bodies take part from the start:
    /// their velocities gain what the change of the gradient gives at their positions.
    ///
    /// # Errors
    /// No cell, or a rate that is not finite.
    pub fn strain_cell(&mut self, rate: [[f64; 3]; 3]) -> Result<(), Faults> {
        super::validate::check_rate(self.cell.is_some(), &rate)?;
        let Some(cell) = &mut self.cell else { return Ok(()) };
        let mut gain = cell.clone();
        gain.rate = std::array::from_fn(|a| std::array::from_fn(|b| rate[a][b] - cell.rate[a][b]));
        cell.rate = rate;
        let low = gain.low;
        for p in (0..self.caller.len()).filter(|&p| self.bodies[p] as usize >= self.clumps.len()) {
            let (x, v) = (self.position_of(p), crate::body::velocity::<S>(&self.records, p));
            let (v, w) = (v.plus(gain.carried(x.minus(low))), crate::body::spin::<S>(&self.records, p));
            set_kinematics::<S>(&mut self.records[p * S::RECORD..(p + 1) * S::RECORD], x, v, w);
        }
        for clump in &mut self.clumps {
            let velocity = clump.velocity.plus(gain.carried(clump.centre.minus(low)));
            clump.set_motion(velocity, clump.spin);
            clump.place(&mut Same(&mut self.records));
        }
        Ok(())
    }

    /// Adds a wall and returns its index.
    ///
    /// # Errors
    /// All faults of the wall, and every ball that is deeper in it than a start may be.
    pub fn add_wall(&mut self, wall: &Wall<S>) -> Result<usize, Faults> {
        self.admit_new_wall(wall)?;
        self.walls.push(moving(wall));
        if let Err(faults) = super::validate::check_table::<S>(&self.table, &self.meetings()) {
            self.walls.pop();
            return Err(faults);
        }
        self.renew();
        Ok(self.walls.len() - 1)
    }

    /// Removes a wall. The indices of the others do not change.
    ///
    /// # Errors
    /// No such wall, or one that was removed.
    pub fn remove_wall(&mut self, w: usize) -> Result<(), Faults> {
        self.admit_wall(w)?;
        self.walls[w].present = false;
        self.walls[w].motion = Motion::Velocity(Vector::<S>::zero());
        self.walls[w].face.velocity = Vector::<S>::zero();
        self.renew();
        Ok(())
    }

    /// Changes how a wall moves.
    ///
    /// # Errors
    /// No such wall, one that was removed, or all faults of the motion.
    pub fn move_wall(&mut self, w: usize, motion: Motion<S>) -> Result<(), Faults> {
        self.admit_motion(w, &motion)?;
        self.walls[w].motion = motion;
        if let Motion::Velocity(v) = motion {
            self.walls[w].face.velocity = v;
        }
        Ok(())
    }

    /// Which masses move the balls from now on, for the present contacts.
    pub fn set_masses(&mut self, masses: super::Masses) {
        self.settings.masses = masses;
        self.choose_masses();
    }

    /// Local damping from now on.
    ///
    /// # Errors
    /// A number outside [0, 1).
    pub fn set_damping(&mut self, alpha: f64) -> Result<(), Faults> {
        super::validate::check_damping(alpha)?;
        self.settings.damping = alpha;
        Ok(())
    }

    /// Threads of a run from now on: at least one, at most one for every 64 particles. Results do not depend on it.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads.max(1);
        let accounts = self.accounts();
        self.rewrite(&[], |_, _, _| ());
        if let Some(accounts) = accounts {
            self.reopen(accounts);
        }
    }

    /// Threads of a run.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Contacts computed at a time; the machine's best by default, the narrowest where the machine lacks the one asked for.
    /// Results do not depend on it.
    pub fn set_width(&mut self, width: Width) {
        self.width = width;
    }

    /// Forgets the cracks so far.
    pub fn forget_cracks(&mut self) {
        self.cracks.clear();
    }

    fn renew(&mut self) {
        self.relist();
        self.derive_step();
    }

    /// Pairs of groups that can meet.
    fn meetings(&self) -> Vec<(crate::particle::Group, crate::particle::Group)> {
        let members = self.groups.iter().copied().zip(self.bodies.iter().copied());
        super::validate::meetings(members, self.walls.iter().filter(|w| w.present).map(|w| w.group))
    }
}
