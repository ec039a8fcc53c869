//! Smooth joint: a contact in the frame of a plane instead of its own (Mas Ivars et al. 2011,
//! doi:10.1016/j.ijrmms.2010.11.014; PFC `smoothjoint`).
//!
//! Grains on the two sides of a plane with the unit normal n, from i's side to j's, slide past each other along the plane and not
//! around each other. With A the section of the radius λ min(R₁, R₂), u the opening along n, Δ the displacement of j's surface
//! against i's in a step, tension positive:
//!
//! * F_n = k_n A u while bonded, k_n A min(u, 0) after; F_s ← F_s + k_s A (Δ − (Δ·n) n), |F_s| ≤ −μ F_n after;
//! * breaks in tension at F_n > σ A, else in shear at |F_s| > c A − F_n tan φ;
//! * a slip of s = (|F_s| before the limit − limit)/(k_s A) parts the faces by s tan ψ: u is what is left of the opening
//!   without it.
//!
//! The forces act at the contact point; there is no moment of the joint's own. n stays as it was laid.

use super::{Account, BROKEN, Broken, Constants, KN, Law, Layout, Memory, RowIndex, SLIP, Viscous, store_shear};
use crate::simd::{Lane, Row};
use crate::space::{Load, Space, Touch, Tuple, Vector};

/// The smooth-joint law.
pub(crate) struct SmoothJointLaw;

/// Rows after those that all laws share.
struct Own<S>(std::marker::PhantomData<S>);

impl<S: Space> Own<S> {
    /// First row of the plane's normal.
    const NORMAL: usize = RowIndex::<S>::COUNT;
    /// Opening, m.
    const OPENING: usize = Self::NORMAL + S::DIMENSION;
    /// First row of the shear force, a vector, N.
    const SHEAR: usize = Self::OPENING + 1;
    /// All rows.
    const COUNT: usize = Self::SHEAR + S::DIMENSION;
}

/// Rows of a contact.
pub(crate) fn rows<S: Space>() -> usize {
    Own::<S>::COUNT
}

/// Lays a joint into a contact: the plane's normal from i's side to j's, k_n A (N/m), the opening (m), the capacities (N; none
/// where it is not bonded).
pub(crate) fn lay<S: Space>(
    memory: &mut Memory,
    normal: Vector<S>,
    stiffness: f64,
    opening: f64,
    capacity: Option<[f64; 2]>,
) {
    let [tension, cohesion] = capacity.map_or([f64::INFINITY; 2], |whole| whole.map(|c| c.min(f64::MAX)));
    memory[KN] = 0.0;
    memory[RowIndex::<S>::TENSION] = tension;
    memory[RowIndex::<S>::COHESION] = cohesion;
    memory[RowIndex::<S>::BOND] = stiffness;
    memory.tail = (0..S::DIMENSION).map(|k| normal.at(k)).chain([opening]).collect();
    memory.tail.resize(Own::<S>::COUNT - RowIndex::<S>::COUNT, 0.0);
}

/// Opening (m) and strain energy (J) of a joint; nothing if the contact has none.
pub(crate) fn read<S: Space>(memory: &Memory, constants: &Constants) -> Option<[f64; 2]> {
    let stiffness = memory[RowIndex::<S>::BOND];
    if stiffness == 0.0 || memory.tail.is_empty() {
        return None;
    }
    let first = RowIndex::<S>::COUNT;
    let bonded = memory[RowIndex::<S>::TENSION] < f64::INFINITY;
    let open = memory.tail[Own::<S>::OPENING - first];
    let opening = if bonded { open } else { open.min(0.0) };
    let shear: f64 = memory.tail[Own::<S>::SHEAR - first..].iter().map(|x| x * x).sum();
    let ks = stiffness * constants.bond_share;
    Some([open, 0.5 * (stiffness * opening * opening + if ks > 0.0 { shear / ks } else { 0.0 })])
}

#[inline(always)]
fn load_vector<S: Space, L: Lane>(rows: &[Row], first: usize, at: usize) -> S::Vector<L> {
    S::Vector::<L>::build(|k| L::load(&rows[first + k], at))
}

impl<S: Space> Law<S> for SmoothJointLaw {
    #[inline(always)]
    fn rows(_layout: &Layout) -> usize {
        Own::<S>::COUNT
    }

    #[inline(always)]
    fn respond<L: Lane>(
        constants: &Constants,
        touch: &Touch<S, L>,
        _viscous: Option<Viscous<L>>,
        rows: &mut [Row],
        at: usize,
        account: &mut Account<'_>,
    ) -> (Load<S, L>, Option<Broken<L>>) {
        let (zero, infinite) = (L::splat(0.0), L::splat(f64::INFINITY));
        let floor = |x: L| x.max(L::splat(f64::MIN_POSITIVE));
        let flat = S::Shear::<L>::zero();
        let way = S::force(touch, &Load { normal: touch.opening, shear: touch.slide, twist: zero, bend: flat });
        let plane = load_vector::<S, L>(rows, Own::<S>::NORMAL, at);
        let parting = way.dot(plane);
        let kn = L::load(&rows[RowIndex::<S>::BOND], at);
        let ks = kn * L::splat(constants.bond_share);
        let capacity = [RowIndex::<S>::TENSION, RowIndex::<S>::COHESION].map(|row| L::load(&rows[row], at));
        let held = infinite.above(capacity[0]);
        let opening = L::load(&rows[Own::<S>::OPENING], at) + parting;
        let elastic = kn * opening;
        let old = load_vector::<S, L>(rows, Own::<S>::SHEAR, at);
        let trial = old.plus(way.minus(plane.times(parting)).times(ks));
        let tension = elastic.above(capacity[0]);
        let size = trial.norm();
        let room = L::select(held, (capacity[1] - elastic * L::splat(constants.slope)).max(zero), infinite);
        let sheared = size.above(room);
        let broken = L::or(tension, sheared);
        let holds = infinite.above(L::select(broken, infinite, capacity[0]));
        let normal = L::select(holds, elastic, elastic.min(zero));
        let limit = L::select(holds, infinite, L::splat(constants.friction) * (-normal).max(zero));
        let share = L::select(size.above(limit), limit / floor(size), L::splat(1.0));
        let shear = trial.times(share);
        // What slips parts the faces, and so presses them on each other. A break is no slip.
        let slip = L::select(held, zero, (size - size * share) / floor(ks)) * L::splat(constants.dilation);
        let closed = L::select(zero.above(opening), slip, zero);
        let left = opening - closed;
        left.store(&mut rows[Own::<S>::OPENING], at);
        for k in 0..S::DIMENSION {
            shear.at(k).store(&mut rows[Own::<S>::SHEAR + k], at);
        }
        if account.open() {
            let half = L::splat(0.5);
            let lost = half * (trial.dot(trial) - shear.dot(shear)) / floor(ks);
            let pull = half * kn * (opening * opening - opening.min(zero) * opening.min(zero));
            account.charge(BROKEN, at, L::select(broken, lost + pull, zero));
            // Friction pays for the pressure that the dilation adds.
            let friction = half * old.plus(shear).dot(trial.minus(shear)) / floor(ks);
            let lifted = half * kn * (left * left - opening * opening);
            account.charge(SLIP, at, L::select(held, zero, friction - L::select(zero.above(opening), lifted, zero)));
        }
        let force = plane.times(normal).plus(shear);
        let along = force.dot(touch.normal);
        let across = S::across(force.minus(touch.normal.times(along)), touch.normal);
        along.store(&mut rows[RowIndex::<S>::BOND_NORMAL], at);
        store_shear::<S, L>(rows, RowIndex::<S>::BOND_SHEAR, at, across);
        let breaks = (L::bits(broken) != 0).then(|| {
            for (row, value) in [RowIndex::<S>::TENSION, RowIndex::<S>::COHESION].into_iter().zip(capacity) {
                L::select(broken, infinite, value).store(&mut rows[row], at);
            }
            Broken { tension, shear: sheared }
        });
        (Load { normal: along, shear: across, twist: zero, bend: flat }, breaks)
    }
}
