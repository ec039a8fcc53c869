//! The time step: a share of min √(m/k), √(I/k_rot) over bodies and axes, from the diagonal of the stiffness.
//!
//! A contact adds k_s + (k_n − k_s) n_a² to axis a of both bodies, and with the arm r from the body's centre
//! k_n (r × n)_a² + k_s (|e_a × r|² − (r × n)_a²) to its rotation, plus bending and torsion of its bond; k_n, k_s are
//! those of spring and bond together. The estimate is that of an endless alternating row of masses and springs (PFC).
//!
//! Counted are closed and bonded contacts. A body with fewer stiffness than one closed contact with its own like is
//! given that of one, so that a body in flight has a step as well.

use super::{Engine, Masses};
use crate::body::position;
use crate::law::{KN, REFERENCE, RowIndex};
use crate::space::{Space, Tuple, flat};

/// Stiffness of one body along and about the axes.
#[derive(Clone, Copy, Debug, Default)]
struct Diagonal {
    shift: [f64; 3],
    turn: [f64; 3],
}

impl Diagonal {
    fn largest(&self) -> [f64; 2] {
        [self.shift, self.turn].map(|k| k.into_iter().fold(0.0, f64::max))
    }
}

impl<S: Space> Engine<S> {
    /// Sets the time step for the present contacts.
    pub(super) fn derive_step(&mut self) {
        self.epoch = (self.time(), self.step);
        self.dt = self.settings.fixed_step.unwrap_or_else(|| self.stable_step());
    }

    fn stable_step(&self) -> f64 {
        let stiffness = self.body_stiffness();
        // Where nothing can move any step will do; that of the free bodies keeps the time scale.
        let free = shortest_period(&self.body_masses(true), &stiffness);
        let shortest = if free.is_finite() { free } else { shortest_period(&self.body_masses(false), &stiffness) };
        self.settings.safety * shortest
    }

    /// Mass and smallest inertia of each body, clumps first; 0 where a body cannot move, if `fixing` counts.
    fn body_masses(&self, fixing: bool) -> Vec<[f64; 2]> {
        let mut masses = Vec::with_capacity(self.clumps.len() + self.caller.len());
        for clump in &self.clumps {
            // 1/λ_max of the inverse, bounded by its Frobenius norm.
            let norm: f64 = clump.inverse.iter().flatten().map(|x| x * x).sum();
            masses.push([clump.mass, 1.0 / norm.sqrt()]);
        }
        for p in (0..self.caller.len()).filter(|&p| self.bodies[p] as usize >= self.clumps.len()) {
            let free = |fixed: bool, x: f64| if fixed && fixing { 0.0 } else { x };
            masses.push([free(self.fixed[p][0], self.moving[p][0]), free(self.fixed[p][1], self.moving[p][1])]);
        }
        masses
    }

    /// Largest stiffness of each body along and about an axis.
    fn body_stiffness(&self) -> Vec<[f64; 2]> {
        let mut bodies = vec![Diagonal::default(); self.bodies.iter().map(|&b| b as usize + 1).max().unwrap_or(0)];
        for (section, own) in self.stretches() {
            for c in own {
                self.add_stiffness(section, c, &mut bodies);
            }
        }
        let mut stiffness: Vec<[f64; 2]> = bodies.iter().map(Diagonal::largest).collect();
        for p in 0..self.caller.len() {
            let own = &mut stiffness[self.bodies[p] as usize];
            let kn = self.stiffest_contact(p);
            *own = [own[0].max(kn), own[1].max(kn * self.radii[p] * self.radii[p])];
        }
        stiffness
    }

    /// Stiffness of the stiffest contact that a particle may make with its like, N/m.
    fn stiffest_contact(&self, p: usize) -> f64 {
        let group = self.groups[p];
        let radius = self.radii[p];
        let entries = self.table.entries.iter().filter(|e| e.0 == group || e.1 == group);
        entries.map(|e| e.2.linear.stiffness.normal::<S>([radius, radius])).fold(0.0, f64::max)
    }

    fn add_stiffness(&self, section: &crate::contact::Section, c: usize, bodies: &mut [Diagonal]) {
        let key = section.key(c);
        let gap = self.gap(key);
        let kb = section.value::<S>(c, RowIndex::<S>::BOND);
        // An interface that is open at its middle may still touch at its rim.
        if !section.joined::<S>(c) && gap >= section.value::<S>(c, REFERENCE) {
            return;
        }
        let constants = &self.classes[section.rank.class].constants;
        let kn = section.value::<S>(c, KN);
        let ks = kn * constants.shear_share + kb * constants.bond_share;
        let kn = kn + kb;
        let [first, second] = self.contact_radii(key);
        let radius = constants.multiplier * first.min(second);
        let bend = kb * S::GYRATION * radius * radius;
        let twist = 2.0 * bend * constants.bond_share;
        let i = key.i as usize;
        let x = position::<S>(&self.records, i);
        let normal = if key.at_wall {
            self.walls[key.j as usize].face.normal.times(-1.0)
        } else {
            let apart = self.apart(key);
            apart.times(1.0 / apart.norm())
        };
        let point = x.plus(normal.times(first + 0.5 * gap));
        let n = flat::<S>(normal);
        let ends = if key.at_wall { vec![i] } else { vec![i, key.j as usize] };
        for p in ends {
            let body = self.bodies[p] as usize;
            let centre = self.clumps.get(body).map_or_else(|| position::<S>(&self.records, p), |clump| clump.centre);
            let centre = if p == i { centre } else { centre.plus(self.shift(key)) };
            let r = flat::<S>(point.minus(centre));
            let across = [r[1] * n[2] - r[2] * n[1], r[2] * n[0] - r[0] * n[2], r[0] * n[1] - r[1] * n[0]];
            let square: f64 = r.iter().map(|x| x * x).sum();
            for a in 0..3 {
                let (n2, c2) = (n[a] * n[a], across[a] * across[a]);
                bodies[body].shift[a] += ks + (kn - ks) * n2;
                let shear = square - r[a] * r[a] - c2;
                bodies[body].turn[a] += kn * c2 + ks * shear + bend * (1.0 - n2) + twist * n2;
            }
        }
    }

    /// Sets the masses that move the balls as [`Settings::masses`](super::Settings) wants them.
    pub(super) fn choose_masses(&mut self) {
        self.moving = self.masses.iter().zip(&self.inertias).map(|(&m, &i)| [m, i]).collect();
        if self.settings.masses == Masses::EqualStep {
            self.equalise_masses();
        }
        self.set_inverse_masses();
        self.derive_step();
    }

    /// Gives every free ball a mass in proportion to its stiffness, with the same total. Its inertia is that of a ball, or
    /// what its rotational stiffness asks for.
    fn equalise_masses(&mut self) {
        let clumps = self.clumps.len();
        let (masses, stiffness) = (self.body_masses(true), self.body_stiffness());
        let free = |b: usize| b >= clumps && masses[b][0] > 0.0;
        let total: f64 = (0..masses.len()).filter(|&b| free(b)).map(|b| masses[b][0]).sum();
        let whole: f64 = (0..masses.len()).filter(|&b| free(b)).map(|b| stiffness[b][0]).sum();
        for p in 0..self.caller.len() {
            let body = self.bodies[p] as usize;
            if free(body) {
                let mass = total / whole * stiffness[body][0];
                let inertia = total / whole * stiffness[body][1];
                self.moving[p] = [mass, inertia.max(S::inertia(mass, self.radii[p]))];
            }
        }
    }
}

/// Smallest √(m/k), √(I/k), s.
fn shortest_period(masses: &[[f64; 2]], stiffness: &[[f64; 2]]) -> f64 {
    let ratios = masses.iter().zip(stiffness).flat_map(|(m, k)| [(m[0], k[0]), (m[1], k[1])]);
    ratios.filter(|&(m, k)| m > 0.0 && k > 0.0).map(|(m, k)| m / k).fold(f64::INFINITY, f64::min).sqrt()
}
