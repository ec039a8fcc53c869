//! Contact bond: the linear spring pulls too and does not slip, until F_n (tension) > T_F or |F_s| > S_F.
//!
//! PFC `linearcbond`. Broken in tension the contact carries nothing; broken in shear it carries what friction allows
//! (PFC 3), or drops its shear force (present PFC) when the class says so. No moment. The bond is in force where its
//! tensile capacity is finite.

use super::linear::{followed, slip_energy};
use super::{
    Account, BROKEN, Broken, Constants, DASHPOT, KN, Law, Layout, REFERENCE, RowIndex, SHEAR, SLIP, Viscous,
    load_shear, store_shear,
};
use crate::simd::{Lane, Row};
use crate::space::{Load, Space, Touch, Tuple};

/// The contact-bond law.
pub(crate) struct ContactBondLaw;

impl<S: Space> Law<S> for ContactBondLaw {
    #[inline(always)]
    fn rows(_layout: &Layout) -> usize {
        RowIndex::<S>::BOND
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
        let (zero, infinite) = (L::splat(0.0), L::splat(f64::INFINITY));
        let kn = L::load(&rows[KN], at);
        let capacity = [L::load(&rows[RowIndex::<S>::TENSION], at), L::load(&rows[RowIndex::<S>::COHESION], at)];
        let before = infinite.above(capacity[0]);
        let reference = L::load(&rows[REFERENCE], at);
        let overlap = reference - touch.gap;
        let elastic = kn * overlap;
        let old = S::turned(load_shear::<S, L>(rows, SHEAR, at), touch);
        let ks = kn * L::splat(constants.shear_share);
        let trial = old.plus(touch.slide.times(ks));
        let tension = (-elastic).above(capacity[0]);
        let sheared = trial.norm().above(capacity[1]);
        let broken = L::or(tension, sheared);
        let compression = L::select(before, elastic, elastic.max(zero));
        let compression = L::select(broken, elastic.max(zero), compression);
        let limited = S::limited(trial, L::splat(constants.friction) * elastic.max(zero));
        let after = if constants.zero_shear { S::Shear::<L>::zero() } else { limited };
        let shear = S::Shear::<L>::build(|k| {
            let whole = L::select(before, trial.at(k), limited.at(k));
            L::select(broken, after.at(k), whole)
        });
        store_shear::<S, L>(rows, SHEAR, at, shear);
        if constants.incremental {
            let free = followed(reference, touch.gap);
            let held = L::select(broken, free, reference);
            L::select(before, held, free).store(&mut rows[REFERENCE], at);
        }
        if account.open() {
            // A break spends the pull of the spring and the shear force that is not kept; a slip what friction takes.
            let pull = (-elastic).max(zero);
            let half = L::splat(0.5);
            let floor = |x: L| x.max(L::splat(f64::MIN_POSITIVE));
            let lost = half * (trial.dot(trial) - shear.dot(shear)) / floor(ks);
            let broke = L::select(broken, half * pull * pull / floor(kn) + lost, zero);
            let slip = slip_energy::<S, L>(old, trial, shear, ks);
            account.charge(BROKEN, at, broke);
            account.charge(SLIP, at, L::select(broken, zero, slip));
        }
        let breaks = (L::bits(broken) != 0).then(|| {
            L::select(broken, infinite, capacity[0]).store(&mut rows[RowIndex::<S>::TENSION], at);
            L::select(broken, infinite, capacity[1]).store(&mut rows[RowIndex::<S>::COHESION], at);
            Broken { tension, shear: sheared }
        });
        let mut load = Load::<S, L> { normal: -compression, shear, twist: zero, bend: S::Shear::<L>::zero() };
        if let Some(viscous) = viscous {
            // Bonded surfaces hold, so both dashpots act; unbonded ones only while they touch.
            let closed = L::select(overlap.above(zero), L::splat(1.0), zero);
            let active = L::select(broken, closed, L::select(before, L::splat(1.0), closed));
            let normal = active * viscous.normal * touch.opening;
            let shear = touch.slide.times(active * viscous.shear);
            load.normal = load.normal + normal;
            load.shear = load.shear.plus(shear);
            if account.open() {
                account.charge(DASHPOT, at, normal * touch.opening + shear.dot(touch.slide));
            }
        }
        (load, breaks)
    }
}
