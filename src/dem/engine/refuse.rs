//! What the calls that change a model refuse: all faults of a call at once, before anything is changed.

use super::Engine;
use super::validate::{FINITE, POSITIVE, cell_edge, check_wall, motion_faults, ok, positive, wall_overlaps};
use crate::boundary::{Motion, Wall};
use crate::error::{Fault, Faults};
use crate::space::{Space, Spin, Tuple, Vector};
use math::text::Amount;

impl<S: Space> Engine<S> {
    /// A particle that there is, by the engine's index of it.
    fn known(&self, particle: usize) -> Result<usize, Fault> {
        let count = self.index.len();
        let index = self.index.get(particle).map(|&p| p as usize);
        index.ok_or(Fault::Missing { what: "particle", index: particle, count })
    }

    /// A ball of its own. `problem` names what a pebble of a clump cannot do.
    fn single(&self, particle: usize, problem: &'static str) -> Result<usize, Fault> {
        let p = self.known(particle)?;
        match self.clump_of(particle) {
            Some(clump) => Err(Fault::Pebble { clump, pebble: particle, problem }),
            None => Ok(p),
        }
    }

    /// The engine's index of a particle that is given a vector and a spin (or moment), both with name and unit.
    pub(super) fn admit(
        &self,
        particle: usize,
        (vector_name, vector, unit): (&'static str, Vector<S>, &'static str),
        (spin_name, spin, spin_unit): (&'static str, Spin<S>, &'static str),
    ) -> Result<usize, Faults> {
        let p = self.known(particle).map_err(|fault| Faults(vec![fault]))?;
        let numbers = (0..S::DIMENSION).map(|k| (vector_name, Amount(vector.at(k), unit)));
        let turns = (0..S::Spin::<f64>::LENGTH).map(|k| (spin_name, Amount(spin.at(k), spin_unit)));
        let bad = numbers.chain(turns).filter(|(_, value)| !value.0.is_finite());
        let fault = |(quantity, value)| Fault::Particle { particle, quantity, value, wanted: FINITE };
        ok(bad.map(fault).collect())?;
        Ok(p)
    }

    /// The engine's indices of balls that are to be fixed.
    pub(super) fn admit_fixing(&self, particles: &[usize]) -> Result<Vec<usize>, Faults> {
        let index = |&particle: &usize| self.single(particle, "cannot be fixed: it moves with its clump");
        gathered(particles.iter().map(index))
    }

    /// The engine's indices of balls whose radii are to be multiplied. Radius and mass must stay numbers, and a periodic
    /// cell large enough.
    pub(super) fn admit_scaling(&self, factors: &[(usize, f64)]) -> Result<Vec<usize>, Faults> {
        let mut radii = self.radii.clone();
        let scaled = factors.iter().map(|&(particle, factor)| {
            let p = self.single(particle, "cannot be scaled: the mass of its clump would not follow")?;
            let fault = |quantity, value| Err(Fault::Particle { particle, quantity, value, wanted: POSITIVE });
            if !positive(factor) {
                return fault("factor of its radius", Amount::number(factor));
            }
            radii[p] *= factor;
            let growth = S::volume(radii[p]) / S::volume(self.radii[p]);
            let (mass, whole) = (self.masses[p] * growth, radii[p] / self.radii[p]);
            let inertia = self.inertias[p] * growth * whole * whole;
            let scaled = [
                ("radius", Amount(radii[p], "m")),
                ("mass", Amount(mass, "kg")),
                ("inertia", Amount(inertia, "kg*m^2")),
            ];
            match scaled.into_iter().find(|(_, value)| !positive(value.0)) {
                Some((quantity, value)) => fault(quantity, value),
                None => Ok(p),
            }
        });
        let indices = gathered(scaled)?;
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let edges = self.cell.iter().flat_map(|cell| cell.edges[..S::DIMENSION].iter().map(|edge| edge.norm()));
        ok(edges.filter_map(|edge| cell_edge(edge, largest)).collect())?;
        Ok(indices)
    }

    /// A new wall: sound, in no ball deeper than a start may be.
    pub(super) fn admit_new_wall(&self, wall: &Wall<S>) -> Result<(), Faults> {
        let w = self.walls.len();
        check_wall(w, wall, self.cell.is_some())?;
        let balls = (0..self.index.len()).map(|particle| (self.position(particle), self.radius(particle)));
        ok(wall_overlaps(w, wall, balls, self.settings.overlap_limit))
    }

    /// A wall that is there.
    pub(super) fn admit_wall(&self, w: usize) -> Result<(), Faults> {
        let fault = match self.walls.get(w) {
            None => Fault::Missing { what: "wall", index: w, count: self.walls.len() },
            Some(wall) if !wall.present => Fault::Removed { wall: w },
            Some(_) => return Ok(()),
        };
        Err(Faults(vec![fault]))
    }

    /// A wall that is there, and a motion for it.
    pub(super) fn admit_motion(&self, w: usize, motion: &Motion<S>) -> Result<(), Faults> {
        self.admit_wall(w)?;
        ok(motion_faults(w, motion))
    }

    /// A gap across which bonds are installed: no wider than the largest ball, or they would reach past neighbours.
    pub(super) fn admit_gap(&self, gap: f64) -> Result<(), Faults> {
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let wanted = "a number up to the largest radius";
        let good = gap.is_finite() && gap <= largest;
        let (quantity, value) = ("installation gap", Amount(gap, "m"));
        ok((!good).then_some(Fault::Setting { quantity, value, wanted }).into_iter().collect())
    }
}

/// All of them, or all faults.
fn gathered(indices: impl Iterator<Item = Result<usize, Fault>>) -> Result<Vec<usize>, Faults> {
    let (mut good, mut faults) = (Vec::new(), Vec::new());
    for index in indices {
        match index {
            Ok(p) => good.push(p),
            Err(fault) => faults.push(fault),
        }
    }
    ok(faults)?;
    Ok(good)
}
