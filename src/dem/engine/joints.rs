//! Fractures laid into a specimen: which contacts they cross, and the smooth joints on those contacts.
//!
//! A contact is of a fracture when the line between the centres of its grains, as they stood when the fracture was laid,
//! crosses it within its extent: so a pair that meets only later, because the sides slid along each other, is of it as well. Of
//! several that are crossed the first one counts. Grains further from the fracture than [`REACH`] largest radii when it was
//! laid are not of it, wherever they go.

use super::build::classes;
use super::{Class, Engine};
use crate::contact::{Key, LawKind};
use crate::error::Faults;
use crate::interaction::SmoothJoint;
use crate::law::{Constants, Memory, lay};
use crate::space::{Space, Tuple, Vector};

/// How far a grain of a fracture may be from it, in largest radii: some four diameters of sliding.
const REACH: f64 = 8.0;

/// A flat fracture: a straight line in the plane, a disc in space.
#[derive(Clone, Copy, Debug)]
pub struct Fracture<S: Space> {
    /// Its middle, m.
    pub centre: Vector<S>,
    /// Its normal, of any length above 0.
    pub normal: Vector<S>,
    /// Half its length, or its radius, m; infinite for one that cuts through.
    pub radius: f64,
    /// Which of the joints it has, by its index in their list.
    pub set: usize,
}

impl<S: Space> Fracture<S> {
    /// Whether the line between two points crosses it within its extent. Its normal is a unit vector.
    fn splits(&self, [x, y]: [Vector<S>; 2]) -> bool {
        let height = |x: Vector<S>| x.minus(self.centre).dot(self.normal);
        let (a, b) = (height(x), height(y));
        if (a < 0.0) == (b < 0.0) {
            return false;
        }
        let through = x.plus(y.minus(x).times(a / (a - b)));
        through.minus(self.centre).norm() <= self.radius
    }
}

/// What was laid.
#[derive(Clone, Debug)]
pub(crate) struct Joints<S: Space> {
    fractures: Vec<Fracture<S>>,
    /// Contacts on each that were closed when it was laid.
    closed: Vec<usize>,
    sets: Vec<SmoothJoint>,
    /// Gap up to which a contact is bonded when it is laid, m; −∞ once all are laid.
    gap: f64,
    /// Centres when they were laid, and the fractures near each, in the engine's order.
    start: Vec<Vector<S>>,
    near: Vec<Vec<u32>>,
}

impl<S: Space> Default for Joints<S> {
    fn default() -> Self {
        let (fractures, closed, sets) = (Vec::new(), Vec::new(), Vec::new());
        Self { fractures, closed, sets, gap: f64::NEG_INFINITY, start: Vec::new(), near: Vec::new() }
    }
}

impl<S: Space> Joints<S> {
    /// Their classes.
    pub(super) fn classes(&self) -> impl Iterator<Item = Class> + '_ {
        let class = |set| Class { law: LawKind::SmoothJoint, constants: Constants::joint(set) };
        self.sets.iter().map(class)
    }
}

impl<S: Space> Engine<S> {
    /// Lays fractures with smooth joints into the specimen, in place of earlier ones: every contact that crosses one gets
    /// the joint of its set instead of its own law. Contacts with a gap up to `gap` (m) are bonded where the set says so; those
    /// that form later are as far open as their grains parted since. Bonds that stood there vanish. How many contacts have a gap up to `gap`.
    ///
    /// # Errors
    /// Every fracture or set with a number outside its range; a gap as for [`install_bonds`](Self::install_bonds).
    pub fn lay_joints(&mut self, fractures: &[Fracture<S>], sets: &[SmoothJoint], gap: f64) -> Result<usize, Faults> {
        self.admit_gap(gap)?;
        super::validate::check_joints(fractures, sets)?;
        let unit = |f: &Fracture<S>| Fracture { normal: f.normal.times(1.0 / f.normal.norm()), ..*f };
        let fractures: Vec<Fracture<S>> = fractures.iter().map(unit).collect();
        let reach = REACH * self.radii.iter().copied().fold(0.0, f64::max);
        let start: Vec<Vector<S>> = (0..self.caller.len()).map(|p| self.position_of(p)).collect();
        let touches = |x: &Vector<S>, f: &Fracture<S>| {
            let away = x.minus(f.centre);
            away.dot(f.normal).abs() <= reach && away.norm() <= f.radius + reach
        };
        let near = |x: &Vector<S>| (0..).zip(&fractures).filter(|(_, f)| touches(x, f)).map(|(k, _)| k).collect();
        let near = start.iter().map(near).collect();
        let closed = vec![0; fractures.len()];
        self.joints = Joints { fractures, closed, sets: sets.to_vec(), gap, start, near };
        self.classes = classes::<S>(&self.table);
        self.classes.extend(self.joints.classes());
        self.margin = (0.02 * self.smallest_radius).max(1.01 * gap);
        self.relist();
        self.joints.gap = f64::NEG_INFINITY;
        self.choose_masses();
        let of = |(section, own): (&crate::contact::Section, std::ops::Range<usize>)| {
            let keys = own.map(|c| section.key(c)).filter(|&key| self.gap(key) <= gap);
            let mine = |key| if section.law == LawKind::SmoothJoint { self.crossed(key) } else { None };
            keys.filter_map(mine).collect::<Vec<usize>>()
        };
        let all: Vec<usize> = self.stretches().flat_map(of).collect();
        all.iter().for_each(|&fracture| self.joints.closed[fracture] += 1);
        Ok(all.len())
    }

    /// The fractures that were laid, and on how many closed contacts each acts.
    pub fn fractures(&self) -> impl Iterator<Item = (&Fracture<S>, usize)> + '_ {
        self.joints.fractures.iter().zip(self.joints.closed.iter().copied())
    }

    /// The set of the fracture that a pair crosses.
    pub(super) fn joint_of(&self, key: Key) -> Option<usize> {
        self.crossed(key).map(|fracture| self.joints.fractures[fracture].set)
    }

    /// The first fracture that a pair crosses, by its index.
    pub(super) fn crossed(&self, key: Key) -> Option<usize> {
        if self.joints.fractures.is_empty() || key.at_wall || key.image != 0 {
            return None;
        }
        let (i, j) = (key.i as usize, key.j as usize);
        let (x, y) = (self.joints.start[i], self.joints.start[j]);
        self.joints.near[i].iter().map(|&k| k as usize).find(|&k| self.joints.fractures[k].splits([x, y]))
    }

    /// Lays the joint of the fracture that a contact crosses, if it crosses one, into its memory.
    pub(super) fn begin_joint(&self, key: Key, memory: &mut Memory) {
        let Some(crossed) = self.crossed(key) else { return };
        let fracture = &self.joints.fractures[crossed];
        let (set, radii, gap) = (&self.joints.sets[fracture.set], self.contact_radii(key), self.gap(key));
        let above = self.joints.start[key.i as usize].minus(fracture.centre).dot(fracture.normal) >= 0.0;
        let normal = if above { fracture.normal.times(-1.0) } else { fracture.normal };
        let closed = gap <= self.joints.gap;
        let section = set.section::<S>(radii);
        let bond = set.bond.filter(|_| closed);
        let capacity = bond.map(|bond| [bond.tensile_strength * section, bond.cohesion * section]);
        // How far the two grains parted along the normal since the fracture was laid: its opening where they meet now.
        let start = self.joints.start[key.j as usize].minus(self.joints.start[key.i as usize]);
        let opening = self.apart(key).minus(start).dot(normal);
        crate::law::unbond::<S>(memory);
        memory[crate::law::SHEAR..crate::law::SHEAR + S::SHEAR].fill(0.0);
        lay::<S>(memory, normal, set.normal::<S>(radii), opening, capacity);
    }
}
