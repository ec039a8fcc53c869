//! Linear contact: F_n = k_n max(0, g_r − g), F_s ← turned(F_s) + k_s Δ_s, |F_s| ≤ μ F_n.
//!
//! Absolute normal force, incremental shear (Cundall & Strack 1979, doi:10.1680/geot.1979.29.1.47; PFC `linear`).
//! In the incremental form g_r follows the gap while the spring would pull: g_r ← max(g_r, min(g, 0)).
//! g_r is the reference gap; it belongs to the pair and outlives a loss of contact. Dashpots act while the surfaces
//! touch: 2 β √(m k) v in each direction, the shear one only while the contact does not slip. SI units; Δ_s is the
//! displacement of j's surface relative to i's, F_s acts on i.

use super::{
    Account, Broken, Constants, DASHPOT, KN, Law, Layout, REFERENCE, RowIndex, SHEAR, SLIP, Viscous, load_shear,
    store_shear,
};
use crate::simd::{Lane, Row};
use crate::space::{Load, Space, Touch, Tuple};

/// The linear law.
pub(crate) struct LinearLaw;

/// Spring (and dashpot) between unbonded surfaces: compression ≥ 0 (unless the dashpot may pull) and shear.
#[inline(always)]
pub(crate) fn spring<S: Space, L: Lane>(
    constants: &Constants,
    touch: &Touch<S, L>,
    viscous: Option<Viscous<L>>,
    rows: &mut [Row],
    at: usize,
    account: &mut Account<'_>,
) -> (L, S::Shear<L>) {
    let zero = L::splat(0.0);
    let kn = L::load(&rows[KN], at);
    let reference = L::load(&rows[REFERENCE], at);
    let overlap = reference - touch.gap;
    let compression = kn * overlap.max(zero);
    if constants.incremental {
        followed(reference, touch.gap).store(&mut rows[REFERENCE], at);
    }
    let limit = L::splat(constants.friction) * compression;
    let old = S::turned(load_shear::<S, L>(rows, SHEAR, at), touch);
    let ks = kn * L::splat(constants.shear_share);
    let trial = old.plus(touch.slide.times(ks));
    let shear = S::limited(trial, limit);
    store_shear::<S, L>(rows, SHEAR, at, shear);
    if account.open() {
        charge_slip::<S, L>(old, trial, shear, ks, account, at);
    }
    let Some(viscous) = viscous else { return (compression, shear) };
    let touching = overlap.above(zero);
    let damped = compression - viscous.normal * touch.opening;
    let damped = if constants.tensile_dashpot { damped } else { damped.max(zero) };
    let slipping = trial.norm().above(limit);
    let drag = touch.slide.times(L::select(slipping, zero, L::select(touching, viscous.shear, zero)));
    if account.open() {
        let normal = (compression - L::select(touching, damped, zero)) * touch.opening;
        account.charge(DASHPOT, at, normal + drag.dot(touch.slide));
    }
    (L::select(touching, damped, zero), shear.plus(drag))
}

/// Reference gap of an incremental spring: it follows the surfaces as they part, up to the loss of contact, so that the
/// force begins anew from there.
#[inline(always)]
pub(crate) fn followed<L: Lane>(reference: L, gap: L) -> L {
    reference.max(gap.min(L::splat(0.0)))
}

/// Friction work of a step, (F_old + F_new)/2 · (F_trial − F_new)/k_s: what the shear displacement did and the spring did
/// not keep.
#[inline(always)]
pub(crate) fn slip_energy<S: Space, L: Lane>(old: S::Shear<L>, trial: S::Shear<L>, new: S::Shear<L>, ks: L) -> L {
    let slip = trial.minus(new);
    L::splat(0.5) * old.plus(new).dot(slip) / ks.max(L::splat(f64::MIN_POSITIVE))
}

/// EnergySums the friction work where there is any: most contacts stick in most steps.
#[inline(always)]
fn charge_slip<S: Space, L: Lane>(
    old: S::Shear<L>,
    trial: S::Shear<L>,
    new: S::Shear<L>,
    ks: L,
    account: &mut Account<'_>,
    at: usize,
) {
    let work = old.plus(new).dot(trial.minus(new));
    let none = L::splat(f64::from_bits(1)).above(work.abs());
    if L::bits(none) != L::ALL {
        account.charge(SLIP, at, slip_energy::<S, L>(old, trial, new, ks));
    }
}

impl<S: Space> Law<S> for LinearLaw {
    #[inline(always)]
    fn rows(_layout: &Layout) -> usize {
        RowIndex::<S>::TENSION
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
        let (compression, shear) = spring(constants, touch, viscous, rows, at, account);
        let zero = L::splat(0.0);
        (Load { normal: -compression, shear, twist: zero, bend: S::Shear::<L>::zero() }, None)
    }
}
