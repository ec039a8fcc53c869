//! What a caller may read. Particles, clumps and walls are named by their indices in the caller's list; reading an index that
//! there is not panics, as it does on a slice.

use super::{Engine, Settings};
use crate::body::{self, Rigid};
use crate::contact::{Contact, Key, LawKind, Other, Section};
use crate::law::{Interface, KN, REFERENCE, RowIndex, SHEAR, read_joint};
use crate::measure::Crack;
use crate::particle::{Clump, Group, Particle};
use crate::space::{Load, Space, Spin, Touch, Tuple, Vector};

impl<S: Space> Engine<S> {
    /// Number of particles.
    pub fn particle_count(&self) -> usize {
        self.caller.len()
    }

    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.epoch.0 + (self.step - self.epoch.1) as f64 * self.dt
    }

    /// Time step, s.
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// Settings.
    pub fn settings(&self) -> &Settings<S> {
        &self.settings
    }

    /// Cracks so far, in the order of breaking.
    pub fn cracks(&self) -> &[Crack<S>] {
        &self.cracks
    }

    /// Centre of a particle, m.
    pub fn position(&self, particle: usize) -> Vector<S> {
        self.position_of(self.index[particle] as usize)
    }

    /// Velocity of a particle, m/s.
    pub fn velocity(&self, particle: usize) -> Vector<S> {
        body::velocity::<S>(&self.records, self.index[particle] as usize)
    }

    /// Spin of a particle, rad/s.
    pub fn spin(&self, particle: usize) -> Spin<S> {
        body::spin::<S>(&self.records, self.index[particle] as usize)
    }

    /// Radius of a particle, m.
    pub fn radius(&self, particle: usize) -> f64 {
        self.radii[self.index[particle] as usize]
    }

    /// Group of a particle.
    pub fn group(&self, particle: usize) -> Group {
        self.groups[self.index[particle] as usize]
    }

    /// Mass and inertia that move a ball: its own, or those of [`super::Masses::EqualStep`].
    pub fn moving_mass(&self, particle: usize) -> [f64; 2] {
        self.moving[self.index[particle] as usize]
    }

    /// Mass of a particle that belongs to no clump, kg.
    pub fn mass(&self, particle: usize) -> f64 {
        self.masses[self.index[particle] as usize]
    }

    /// The clump of a particle, by its index in the caller's list of clumps.
    pub fn clump_of(&self, particle: usize) -> Option<usize> {
        let body = self.bodies[self.index[particle] as usize] as usize;
        self.clump_caller.get(body).map(|&clump| clump as usize)
    }

    /// A particle as it is now.
    pub fn particle(&self, particle: usize) -> Particle<S> {
        let p = self.index[particle] as usize;
        Particle {
            position: self.position(particle),
            radius: self.radii[p],
            velocity: self.velocity(particle),
            spin: self.spin(particle),
            mass: self.masses[p],
            inertia: self.inertias[p],
            group: self.groups[p],
        }
    }

    /// A clump as it is now; its inertia in the present frame of the specimen.
    pub fn clump(&self, clump: usize) -> Clump<S> {
        let rigid = self.rigid(clump);
        Clump {
            pebbles: rigid.pebbles.clone().map(|p| self.caller[p] as usize).collect(),
            centre: rigid.centre,
            velocity: rigid.velocity,
            spin: rigid.spin,
            mass: rigid.mass,
            inertia: S::turned_inertia(rigid.turn, &rigid.inertia),
        }
    }

    /// The constant force that [`apply`](Engine::apply) put on the body of a particle, N.
    pub fn applied_force(&self, particle: usize) -> Vector<S> {
        let p = self.index[particle] as usize;
        self.applied.get(&p).map_or(Vector::<S>::zero(), |load| load.0)
    }

    /// Centre of mass of a clump, m.
    pub fn clump_centre(&self, clump: usize) -> Vector<S> {
        self.rigid(clump).centre
    }

    /// Mass of a clump, kg.
    pub fn clump_mass(&self, clump: usize) -> f64 {
        self.rigid(clump).mass
    }

    /// Whether a particle's velocity is prescribed.
    pub fn is_fixed(&self, particle: usize) -> bool {
        self.fixed[self.index[particle] as usize][0]
    }

    fn rigid(&self, clump: usize) -> &Rigid<S> {
        &self.clumps[self.clump_index[clump] as usize]
    }

    /// Number of clumps.
    pub fn clump_count(&self) -> usize {
        self.clumps.len()
    }

    /// A point on wall `w` now, m.
    pub fn wall_point(&self, w: usize) -> Vector<S> {
        self.walls[w].face.point
    }

    /// Unit normal of wall `w`, into the specimen.
    pub fn wall_normal(&self, w: usize) -> Vector<S> {
        self.walls[w].face.normal
    }

    /// Velocity of wall `w` now, m/s.
    pub fn wall_velocity(&self, w: usize) -> Vector<S> {
        self.walls[w].face.velocity
    }

    /// Force of the balls on wall `w`, N, at the positions of the last step; 0 where there is no such wall.
    pub fn wall_force(&self, w: usize) -> Vector<S> {
        let mut sum = Vector::<S>::zero();
        for (section, _) in self.stretches().filter(|(s, _)| s.wall() == Some(w as u32)) {
            Self::visit_reactions(section, |force| sum = sum.plus(Vector::<S>::build(|k| force[k])));
        }
        sum
    }

    /// Edges of the periodic cell now, m; as many as the space has dimensions.
    pub fn cell_edges(&self) -> Option<Vec<Vector<S>>> {
        self.cell.as_ref().map(|cell| cell.edges[..S::DIMENSION].to_vec())
    }

    /// Volume of the periodic cell now (area in the plane), m³ (m²).
    pub fn cell_volume(&self) -> Option<f64> {
        self.cell.as_ref().map(|cell| cell.volume())
    }

    /// All listed contacts, in the engine's order.
    pub fn contacts(&self) -> impl Iterator<Item = Contact<S>> + '_ {
        self.stretches().flat_map(move |(section, own)| own.map(move |c| self.contact(section, c)))
    }

    pub(super) fn position_of(&self, p: usize) -> Vector<S> {
        body::position::<S>(&self.records, p)
    }

    /// Normal of a contact from i outwards.
    pub(super) fn normal_of(&self, key: Key) -> Vector<S> {
        if key.at_wall {
            return self.walls[key.j as usize].face.normal.times(-1.0);
        }
        let apart = self.apart(key);
        apart.times(1.0 / apart.norm())
    }

    fn contact(&self, section: &Section, c: usize) -> Contact<S> {
        let key = section.key(c);
        let (i, j) = (key.i as usize, key.j as usize);
        let (gap, normal, x) = (self.gap(key), self.normal_of(key), self.position_of(i));
        let reach = self.radii[i] + 0.5 * gap;
        let value = |row: usize| section.value::<S>(c, row);
        let bonded = section.bonded::<S>(c);
        let point_bond = bonded && self.classes[section.rank.class].law == LawKind::ContactBond;
        let overlap = value(REFERENCE) - gap;
        let push = value(KN) * if point_bond { overlap } else { overlap.max(0.0) };
        let shear = |first: usize| S::Shear::<f64>::build(|k| value(first + k));
        let interface = self.interface(section, c, gap);
        let touches = interface.is_some() && value(RowIndex::<S>::BOND_NORMAL) != 0.0;
        let solid = S::DIMENSION == 3;
        let cement = Load::<S, f64> {
            normal: value(RowIndex::<S>::BOND_NORMAL),
            shear: shear(RowIndex::<S>::BOND_SHEAR),
            twist: if solid { value(RowIndex::<S>::BOND_TWIST) } else { 0.0 },
            bend: shear(RowIndex::<S>::BOND_BEND),
        };
        let spring = Load::<S, f64> { normal: -push, shear: shear(SHEAR), ..cement };
        let touch = Touch::<S, f64>::still(normal, gap);
        let constants = &self.classes[section.rank.class].constants;
        let [first, second] = self.contact_radii(key);
        let bond_radius = constants.multiplier * first.min(second);
        Contact {
            particle: self.caller[i] as usize,
            other: if key.at_wall { Other::Wall(j) } else { Other::Particle(self.caller[j] as usize) },
            normal,
            point: x.plus(normal.times(reach)),
            branch: normal.times(if key.at_wall { reach } else { self.radii[i] + self.radii[j] + gap }),
            shift: self.shift(key),
            gap,
            reference: value(REFERENCE),
            bonded,
            active: bonded || touches || (interface.is_none() && overlap > 0.0),
            stiffness: [value(KN), value(KN) * constants.shear_share],
            bond_stiffness: [value(RowIndex::<S>::BOND), value(RowIndex::<S>::BOND) * constants.bond_share],
            capacity: if bonded { [RowIndex::<S>::TENSION, RowIndex::<S>::COHESION].map(value) } else { [0.0; 2] },
            gyration: S::GYRATION * bond_radius * bond_radius,
            spring: S::force(&touch, &spring),
            cement: S::force(&touch, &cement),
            moment: S::bond_moment(&touch, &cement),
            twist: cement.twist,
            interface,
        }
    }

    /// The interface of a flat or smooth joint.
    fn interface(&self, section: &Section, c: usize, gap: f64) -> Option<Interface> {
        let constants = &self.classes[section.rank.class].constants;
        if section.law == LawKind::SmoothJoint {
            let [opening, energy] = read_joint::<S>(&section.memory::<S>(c), constants)?;
            let (intact, fracture) = (u32::from(section.bonded::<S>(c)), self.crossed(section.key(c)));
            return Some(Interface { elements: 1, intact, opening, energy, fracture });
        }
        let LawKind::FlatJoint { .. } = section.law else { return None };
        let [first, second] = self.contact_radii(section.key(c));
        Interface::read::<S>(&section.memory::<S>(c), constants, gap, constants.multiplier * first.min(second))
    }
}
