//! Flat joint: two flat faces instead of a point of contact (Potyondy 2012, ARMA 12-501; PFC `flatjoint`).
//!
//! Between two grains is an interface of radius R = λ min(R₁, R₂): a strip 2R wide in the plane, a disc in space. It is
//! divided into N elements of equal area A/N, each with its own state. With u the opening of the faces since they
//! were made, g₀ the gap that they were made with, ψ the slope of one face against the other and r the position of an element:
//!
//! * gap g = g₀ + u + ψ·r; u is absolute, from the distance of the grains, and ψ the sum of the bending rotations;
//! * bonded: F = k_n (A/N) g, tension positive; the shear force adds k_s (A/N) Δ_s at r, twist included;
//! * unbonded: F as above where the faces touch, else 0; the shear force is at most −μ F;
//! * breaks in tension at F > σ_b A/N, else in shear at |F_s| > c_b A/N − F tan φ_b, and is unbonded from then on.
//!
//! In the plane an element is a segment of half width b = R/N. Its force and moment are integrated over it exactly, also where it is
//! partly open, so that an intact or closed interface has the bending stiffness k_n I for every N. In space the elements are rings of equal area
//! by equal sectors and act at the polar radius of gyration of their ring, R √((2k + 1)/(2 rings)): with three sectors
//! or more k_n I and k_s J are exact as well; an unbonded one is open or closed as a whole.
//!
//! There is no linear spring beside the interface. A contact that never had one is linear.

use super::linear::spring;
use super::{
    Account, BROKEN, Broken, Constants, KN, Law, Memory, Piece, RowIndex, SLIP, Viscous, load_shear, store_shear,
};
use crate::interaction::Division;
use crate::simd::{Lane, Row};
use crate::space::{Load, Space, Touch, Tuple, Vector};
use math::elementary::{cos, sin};
use std::f64::consts::TAU;

/// The flat-joint law.
pub(crate) struct FlatJointLaw;

/// Most elements of an interface.
const MOST: usize = Division::MOST as usize;

/// Elements of an interface, and where they act.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// How many.
    pub(crate) count: u32,
    /// Where each acts along t₁ and t₂, over R.
    arms: [[f64; 2]; MOST],
    /// Half width of an element in the plane over R; 0 in space.
    half: f64,
    /// Width (plane) or diameter of the disc of the same area (space) of an element over that of the interface.
    pub(crate) size: f64,
}

impl Default for Layout {
    /// One element: a bond that breaks as a whole.
    fn default() -> Self {
        Self { count: 1, arms: [[0.0; 2]; MOST], half: 0.0, size: 1.0 }
    }
}

impl Layout {
    pub(crate) fn new<S: Space>(division: Division) -> Self {
        let count = division.count().clamp(1, Division::MOST);
        let n = f64::from(count);
        let mut layout = Self { count, ..Self::default() };
        if S::DIMENSION == 2 {
            (layout.half, layout.size) = (1.0 / n, 1.0 / n);
            for (e, arm) in layout.arms[..count as usize].iter_mut().enumerate() {
                *arm = [(2.0 * e as f64 + 1.0) / n - 1.0, 0.0];
            }
            return layout;
        }
        layout.size = 1.0 / n.sqrt();
        for (e, arm) in layout.arms[..count as usize].iter_mut().enumerate() {
            let (ring, sector) = (e as u32 / division.sectors, e as u32 % division.sectors);
            let radius = (f64::from(2 * ring + 1) / f64::from(2 * division.rings)).sqrt();
            let angle = TAU * (f64::from(sector) + 0.5) / f64::from(division.sectors);
            *arm = [radius * cos(angle), radius * sin(angle)];
        }
        layout
    }
}

/// Rows after those that all laws share.
struct Own<S>(std::marker::PhantomData<S>);

impl<S: Space> Own<S> {
    /// Gap of the grains at which the faces touch, m.
    const ORIGIN: usize = RowIndex::<S>::COUNT;
    /// First row of the slope ψ.
    const SLOPE: usize = Self::ORIGIN + 1;
    /// First row of the frame t₁ (space only).
    const FRAME: usize = Self::SLOPE + Self::FLAT;
    /// First row of the elements.
    const ELEMENTS: usize = Self::FRAME + if S::DIMENSION == 2 { 0 } else { 3 };
    /// Numbers of a vector of the contact plane in its frame.
    const FLAT: usize = S::DIMENSION - 1;
    /// Rows of an element: whether it holds, then its shear force, N.
    const STRIDE: usize = 1 + Self::FLAT;
}

/// An element that is bonded; those of a contact without interface hold as well, with no stiffness.
const HOLDS: f64 = 1.0;
/// An element that is not.
const FREE: f64 = 0.0;
/// An element that broke in tension or shear in this step; a note is taken, and then it is free.
const TORN: f64 = -1.0;
const SHEARED: f64 = -2.0;

/// Row `row` after the shared ones of a contact without interface.
pub(crate) fn idle<S: Space>(row: usize) -> f64 {
    let element = row.checked_sub(Own::<S>::ELEMENTS);
    if element.is_some_and(|row| row % Own::<S>::STRIDE == 0) { HOLDS } else { 0.0 }
}

/// Makes the interface of a contact: with the gap of the grains at which its faces touch (m), k_n A (N/m), the capacities
/// of the whole interface (N; none for one that is unbonded) and the normal.
pub(crate) fn join<S: Space>(
    memory: &mut Memory,
    layout: &Layout,
    origin: f64,
    stiffness: f64,
    capacity: Option<[f64; 2]>,
    normal: Vector<S>,
) {
    let capacity = capacity.map(|whole| whole.map(|c| c.min(f64::MAX)));
    let holds = if capacity.is_some() { HOLDS } else { FREE };
    let [tension, cohesion] = capacity.unwrap_or([f64::INFINITY; 2]);
    memory[KN] = 0.0;
    memory[RowIndex::<S>::TENSION] = tension;
    memory[RowIndex::<S>::COHESION] = cohesion;
    memory[RowIndex::<S>::BOND] = stiffness;
    memory.tail = (RowIndex::<S>::COUNT..rows::<S>(layout.count)).map(idle::<S>).collect();
    let first = RowIndex::<S>::COUNT;
    memory.tail[Own::<S>::ORIGIN - first] = origin;
    if S::DIMENSION == 3 {
        // Across the axis that is furthest from the normal.
        let least = (1..3).fold(0, |least, k| if normal.at(k).abs() < normal.at(least).abs() { k } else { least });
        let along = normal.at(least);
        let length = (1.0 - along * along).sqrt();
        for k in 0..3 {
            let axis = if k == least { 1.0 } else { 0.0 };
            memory.tail[Own::<S>::FRAME - first + k] = (axis - along * normal.at(k)) / length;
        }
    }
    for element in memory.tail[Own::<S>::ELEMENTS - first..].chunks_exact_mut(Own::<S>::STRIDE) {
        element[0] = holds;
    }
}

/// Rows of a contact with `count` elements.
pub(crate) fn rows<S: Space>(count: u32) -> usize {
    Own::<S>::ELEMENTS + count as usize * Own::<S>::STRIDE
}

/// What there is to see of an interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Its elements.
    pub elements: u32,
    /// Those that are bonded.
    pub intact: u32,
    /// Opening at its middle, m: below 0 where its faces are pressed on each other.
    pub opening: f64,
    /// Strain energy, J.
    pub energy: f64,
    /// The fracture whose smooth joint it is, by its index among those that were laid; none for a flat joint.
    pub fracture: Option<usize>,
}

impl Interface {
    /// Reads the interface of a contact from its memory; nothing if it has none.
    pub(crate) fn read<S: Space>(memory: &Memory, constants: &Constants, gap: f64, radius: f64) -> Option<Self> {
        let stiffness = memory[RowIndex::<S>::BOND];
        if stiffness == 0.0 || memory.tail.is_empty() {
            return None;
        }
        let (layout, first) = (&constants.layout, RowIndex::<S>::COUNT);
        let n = f64::from(layout.count);
        let shear_stiffness = stiffness / n * constants.bond_share;
        let opening = gap - memory.tail[Own::<S>::ORIGIN - first];
        let slope: [f64; 2] =
            std::array::from_fn(|k| if k < Own::<S>::FLAT { memory.tail[Own::<S>::SLOPE - first + k] } else { 0.0 });
        let slope = slope.times(radius);
        let mut read = Self { elements: layout.count, intact: 0, opening, energy: 0.0, fracture: None };
        let elements = memory.tail[Own::<S>::ELEMENTS - first..].chunks_exact(Own::<S>::STRIDE);
        for (arm, element) in layout.arms.iter().zip(elements) {
            let gap = opening + arm.dot(slope);
            let half = layout.half * slope[0].abs();
            let holds = element[0] == HOLDS;
            read.intact += u32::from(holds);
            read.energy += stiffness / n * square(gap, half, holds);
            let shear: f64 = element[1..].iter().map(|x| x * x).sum();
            read.energy += if shear_stiffness > 0.0 { 0.5 * shear / shear_stiffness } else { 0.0 };
        }
        Some(read)
    }
}

/// Half the mean square of the gap where it carries force, over an element with the gap at its middle and half the
/// difference of its ends.
fn square<L: Lane>(gap: L, half: L, holds: bool) -> L {
    let (zero, third) = (L::splat(0.0), L::splat(1.0 / 3.0));
    let whole = L::splat(0.5) * (gap * gap + half * half * third);
    if holds {
        return whole;
    }
    let (low, high) = ((gap - half).min(zero), gap + half);
    let floor = half.max(L::splat(f64::MIN_POSITIVE));
    let part = L::splat(1.0 / 12.0) * low.abs() * low * low / floor;
    L::select(high.above(zero), L::select(half.above(zero), part, zero), whole)
}

/// One element in a step: what the formulas share.
struct Element<L> {
    /// Normal force if bonded, N.
    elastic: L,
    /// Half the difference of the gaps at its ends times the stiffness, N.
    swing: L,
}

impl<L: Lane> Element<L> {
    /// Normal force and first moment about the middle, over the half width, of the faces without a bond.
    #[inline(always)]
    fn unbonded(&self, rising: L::Mask) -> [L; 2] {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (low, high) = (self.elastic - self.swing, self.elastic + self.swing);
        let open = high.above(zero);
        let floor = self.swing.max(L::splat(f64::MIN_POSITIVE));
        // A triangle over the share of the width that is closed.
        let share = L::splat(0.5) * low.min(zero).abs() / floor;
        let force = L::splat(0.5) * low.min(zero) * share;
        let arm = one - L::splat(2.0 / 3.0) * share;
        let moment = L::select(rising, -(force * arm), force * arm);
        let [whole, turned] = self.bonded(rising);
        [L::select(open, force, whole), L::select(open, moment, turned)]
    }

    /// The same with the bond.
    #[inline(always)]
    fn bonded(&self, rising: L::Mask) -> [L; 2] {
        let third = self.swing * L::splat(1.0 / 3.0);
        [self.elastic, L::select(rising, third, -third)]
    }
}

/// Sums over the elements of an interface.
#[derive(Clone, Copy)]
struct Sums<L> {
    normal: L,
    shear: [L; 2],
    /// First moments ∑ r F over R.
    moments: [L; 2],
    /// Moment of the shear forces about the normal over R.
    twist: L,
}

/// What the faces do in a step.
struct Faces<L> {
    /// Opening at the middle, and slope times R, m.
    opening: L,
    tilt: [L; 2],
    /// Shear displacement at the middle and twist times R in this step, m.
    slide: [L; 2],
    twist: L,
    /// k_n A/N and k_s A/N, N/m.
    kn: L,
    ks: L,
    /// Capacities of an element, N.
    capacity: [L; 2],
}

/// The shear force shortened to `limit`.
#[inline(always)]
fn limited<S: Space, L: Lane>(shear: [L; 2], limit: L) -> [L; 2] {
    if S::DIMENSION == 2 {
        return [shear[0].min(limit).max(-limit), shear[1]];
    }
    let length = shear.norm().max(L::splat(f64::MIN_POSITIVE));
    shear.times((limit / length).min(L::splat(1.0)))
}

impl<L: Lane> Faces<L> {
    /// Computes the response of one element; adds it to the sums and returns whether it broke.
    #[inline(always)]
    fn element<S: Space>(
        &self,
        constants: &Constants,
        arm: [f64; 2],
        rows: &mut [Row],
        at: usize,
        account: &mut Account<'_>,
        sums: &mut Sums<L>,
    ) -> Option<Broken<L>> {
        let (zero, infinite, solid) = (L::splat(0.0), L::splat(f64::INFINITY), S::DIMENSION == 3);
        let [x, y] = arm.map(L::splat);
        let mut gap = self.opening + x * self.tilt[0];
        let mut way = self.slide;
        if solid {
            gap = gap + y * self.tilt[1];
            way = [way[0] - y * self.twist, way[1] + x * self.twist];
        }
        let half = L::splat(constants.layout.half);
        let rising = self.tilt[0].above(zero);
        let face = Element { elastic: self.kn * gap, swing: self.kn * half * self.tilt[0].abs() };
        let state = L::load(&rows[0], at);
        let old = [L::load(&rows[1], at), if solid { L::load(&rows[2], at) } else { zero }];
        let trial = [old[0] + self.ks * way[0], if solid { old[1] + self.ks * way[1] } else { zero }];
        let before = state.above(zero);
        let tension = face.elastic.above(L::select(before, self.capacity[0], infinite));
        let room = (self.capacity[1] - face.elastic * L::splat(constants.slope)).max(zero);
        let room = L::select(before, room, infinite);
        let sheared = trial.dot(trial).above(room * room);
        let broken = L::or(tension, sheared);
        let after = L::select(broken, zero, state).above(zero);
        let [mut normal, mut moment] = face.bonded(rising);
        let mut shear = trial;
        if L::bits(after) != L::ALL {
            let [force, turned] = face.unbonded(rising);
            (normal, moment) = (L::select(after, normal, force), L::select(after, moment, turned));
            let limit = L::splat(constants.friction) * (-normal).max(zero);
            let held = limited::<S, L>(trial, limit);
            shear = [0, 1].map(|k| L::select(after, trial[k], held[k]));
            if account.open() {
                self.charge([old, trial, shear], [before, broken], gap, half, at, account);
            }
        }
        shear[0].store(&mut rows[1], at);
        if solid {
            shear[1].store(&mut rows[2], at);
        }
        sums.normal = sums.normal + normal;
        sums.shear = [sums.shear[0] + shear[0], sums.shear[1] + shear[1]];
        sums.moments[0] = sums.moments[0] + x * normal + half * moment;
        if solid {
            sums.moments[1] = sums.moments[1] + y * normal;
            sums.twist = sums.twist + (x * shear[1] - y * shear[0]);
        }
        (L::bits(broken) != 0).then(|| {
            let torn = L::select(tension, L::splat(TORN), L::splat(SHEARED));
            L::select(broken, torn, state).store(&mut rows[0], at);
            Broken { tension, shear: sheared }
        })
    }

    /// EnergySums what a slip or a break spent; shear forces: before, unlimited, now.
    #[inline(always)]
    fn charge(
        &self,
        [old, trial, now]: [[L; 2]; 3],
        [before, broken]: [L::Mask; 2],
        gap: L,
        half: L,
        at: usize,
        account: &mut Account<'_>,
    ) {
        let zero = L::splat(0.0);
        let floor = |x: L| x.max(L::splat(f64::MIN_POSITIVE));
        let lost = trial.minus(now);
        let slip = L::splat(0.5) * old.plus(now).dot(lost) / floor(self.ks);
        account.charge(SLIP, at, L::select(before, zero, slip));
        let swing = half * self.tilt[0].abs();
        let normal = self.kn * (square(gap, swing, true) - square(gap, swing, false));
        let shear = L::splat(0.5) * (trial.dot(trial) - now.dot(now)) / floor(self.ks);
        account.charge(BROKEN, at, L::select(broken, normal + shear, zero));
    }
}

impl<S: Space> Law<S> for FlatJointLaw {
    #[inline(always)]
    fn rows(layout: &Layout) -> usize {
        rows::<S>(layout.count)
    }

    #[inline(always)]
    fn stiffness<L: Lane>(rows: &[Row], at: usize) -> L {
        // One of the two is 0.
        L::load(&rows[KN], at) + L::load(&rows[RowIndex::<S>::BOND], at)
    }

    fn pieces(constants: &Constants, rows: &mut [Row], lane: usize, _tensile: bool, mut put: impl FnMut(Piece)) {
        let frame = std::array::from_fn(|k| if S::DIMENSION == 2 { 0.0 } else { rows[Own::<S>::FRAME + k].0[lane] });
        let elements = rows[Own::<S>::ELEMENTS..].chunks_exact_mut(Own::<S>::STRIDE);
        let mut whole = false;
        for (element, (rows, arm)) in elements.zip(&constants.layout.arms).enumerate() {
            let state = &mut rows[0].0[lane];
            if *state < FREE {
                let arm = arm.map(|x| x * constants.multiplier);
                put(Piece { tensile: *state == TORN, element: element as u32, arm, frame });
                *state = FREE;
            }
            whole |= *state == HOLDS;
        }
        if !whole {
            rows[RowIndex::<S>::TENSION].0[lane] = f64::INFINITY;
            rows[RowIndex::<S>::COHESION].0[lane] = f64::INFINITY;
        }
    }

    #[inline(always)]
    fn respond<L: Lane>(
        constants: &Constants,
        touch: &Touch<S, L>,
        viscous: Option<Viscous<L>>,
        rows: &mut [Row],
        at: usize,
        account: &mut Account<'_>,
    ) -> (Load<S, L>, Option<Broken<L>>) {
        let (compression, spring_shear) = spring(constants, touch, viscous, rows, at, account);
        let zero = L::splat(0.0);
        let (solid, share) = (S::DIMENSION == 3, L::splat(1.0 / f64::from(constants.layout.count)));
        let radius = L::splat(constants.multiplier) * touch.radius;
        let mut frame = S::Shear::<L>::zero();
        if solid {
            frame = S::turned(load_shear::<S, L>(rows, Own::<S>::FRAME, at), touch);
            store_shear::<S, L>(rows, Own::<S>::FRAME, at, frame);
        }
        let steeper = S::slope(touch.bend, frame, touch.normal);
        let mut slope = [zero; 2];
        for k in 0..Own::<S>::FLAT {
            slope[k] = L::load(&rows[Own::<S>::SLOPE + k], at) + steeper[k];
            slope[k].store(&mut rows[Own::<S>::SLOPE + k], at);
        }
        let kn = L::load(&rows[RowIndex::<S>::BOND], at) * share;
        let faces = Faces {
            opening: touch.gap - L::load(&rows[Own::<S>::ORIGIN], at),
            tilt: slope.times(radius),
            slide: S::flat(touch.slide, frame, touch.normal),
            twist: touch.twist * radius,
            kn,
            ks: kn * L::splat(constants.bond_share),
            capacity: [RowIndex::<S>::TENSION, RowIndex::<S>::COHESION].map(|row| L::load(&rows[row], at) * share),
        };
        let mut sums = Sums { normal: zero, shear: [zero; 2], moments: [zero; 2], twist: zero };
        let mut breaks: Option<Broken<L>> = None;
        let elements = rows[Own::<S>::ELEMENTS..].chunks_exact_mut(Own::<S>::STRIDE);
        for (element, arm) in elements.zip(&constants.layout.arms) {
            let broken = faces.element::<S>(constants, *arm, element, at, account, &mut sums);
            breaks = match (breaks, broken) {
                (Some(a), Some(b)) => {
                    Some(Broken { tension: L::or(a.tension, b.tension), shear: L::or(a.shear, b.shear) })
                }
                (a, b) => a.or(b),
            };
        }
        let shear = S::raised(sums.shear, frame, touch.normal);
        let bend = S::bend(sums.moments.times(radius), frame, touch.normal);
        let twist = sums.twist * radius;
        sums.normal.store(&mut rows[RowIndex::<S>::BOND_NORMAL], at);
        store_shear::<S, L>(rows, RowIndex::<S>::BOND_SHEAR, at, shear);
        store_shear::<S, L>(rows, RowIndex::<S>::BOND_BEND, at, bend);
        if solid {
            twist.store(&mut rows[RowIndex::<S>::BOND_TWIST], at);
        }
        let load = Load { normal: sums.normal - compression, shear: spring_shear.plus(shear), twist, bend };
        (load, breaks)
    }
}
