//! Linear contact: F_n = k_n max(0, g_r − g), F_s ← turned(F_s) + k_s Δ_s, |F_s| ≤ μ F_n.
//!
//! Absolute normal force, incremental shear (Cundall & Strack 1979, doi:10.1680/geot.1979.29.1.47; PFC `linear`).
//! g_r is the reference gap; it belongs to the pair and outlives a loss of contact. Dashpots act while the surfaces
//! touch: 2 β √(m k) v in each direction, the shear one only while the contact does not slip. SI units; Δ_s is the
//! displacement of j's surface relative to i's, F_s acts on i.

use super::{Constants, KN, Law, REFERENCE, SHEAR, Viscous, load_shear, store_shear};
use crate::dem::law::Broken;
use crate::dem::simd::{Lane, Row};
use crate::dem::space::{Load, Space, Touch, Tuple};

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
) -> (L, S::Shear<L>) {
    let zero = L::splat(0.0);
    let kn = L::load(&rows[KN], at);
    let overlap = L::load(&rows[REFERENCE], at) - touch.gap;
    let compression = kn * overlap.max(zero);
    let limit = L::splat(constants.friction) * compression;
    let old = S::turned(load_shear::<S, L>(rows, SHEAR, at), touch);
    let trial = old.plus(touch.slide.times(kn * L::splat(constants.shear_share)));
    let shear = S::limited(trial, limit);
    store_shear::<S, L>(rows, SHEAR, at, shear);
    let Some(viscous) = viscous else { return (compression, shear) };
    let touching = overlap.above(zero);
    let damped = compression - viscous.normal * touch.opening;
    let damped = if constants.tensile_dashpot { damped } else { damped.max(zero) };
    let slipping = trial.norm().above(limit);
    let drag = touch.slide.times(L::select(slipping, zero, L::select(touching, viscous.shear, zero)));
    (L::select(touching, damped, zero), shear.plus(drag))
}

impl<S: Space> Law<S> for LinearLaw {
    #[inline(always)]
    fn respond<L: Lane>(
        constants: &Constants,
        touch: &Touch<S, L>,
        viscous: Option<Viscous<L>>,
        rows: &mut [Row],
        at: usize,
    ) -> (Load<S, L>, Option<Broken<L>>) {
        let (compression, shear) = spring(constants, touch, viscous, rows, at);
        let zero = L::splat(0.0);
        (Load { normal: -compression, shear, twist: zero, bend: S::Shear::<L>::zero() }, None)
    }
}
