//! Parallel bond: an elastic cement beside the linear contact (Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011;
//! PFC `linearpbond`).
//!
//! Increments in a step, with A, I, J of the radius R̄ = λ min(R₁, R₂) and k = k̄_n A:
//! ΔF_n = k Δ_n, ΔF_s = k κ̄⁻¹ Δ_s, ΔM_b = k (I/A) Δθ_b, ΔM_t = k κ̄⁻¹ (J/A) Δθ_t (solid only).
//!
//! Break, in tension first: F_n + β |M_b| A R̄ / I > σ_c A; else in shear: |F_s| + β |M_t| A R̄ / J > c A − F_n tan φ
//! (both sides multiplied by A). A broken bond vanishes at once; the linear contact stays.

use super::linear::spring;
use super::{BROKEN, Broken, Constants, Law, Ledger, Rows, Viscous, load_shear, store_shear};
use crate::dem::simd::{Lane, Row};
use crate::dem::space::{Load, Space, Touch, Tuple};

/// The parallel-bond law.
pub(crate) struct ParallelBondLaw;

/// Forces and moments of the cement.
#[derive(Clone, Copy)]
struct Cement<S: Space, L: Lane> {
    normal: L,
    shear: S::Shear<L>,
    bend: S::Shear<L>,
    twist: L,
}

impl<S: Space, L: Lane> Cement<S, L> {
    #[inline(always)]
    fn load(rows: &[Row], at: usize) -> Self {
        let solid = S::DIMENSION == 3;
        Self {
            normal: L::load(&rows[Rows::<S>::BOND_NORMAL], at),
            shear: load_shear::<S, L>(rows, Rows::<S>::BOND_SHEAR, at),
            bend: load_shear::<S, L>(rows, Rows::<S>::BOND_BEND, at),
            twist: if solid { L::load(&rows[Rows::<S>::BOND_TWIST], at) } else { L::splat(0.0) },
        }
    }

    #[inline(always)]
    fn store(self, rows: &mut [Row], at: usize) {
        self.normal.store(&mut rows[Rows::<S>::BOND_NORMAL], at);
        store_shear::<S, L>(rows, Rows::<S>::BOND_SHEAR, at, self.shear);
        store_shear::<S, L>(rows, Rows::<S>::BOND_BEND, at, self.bend);
        if S::DIMENSION == 3 {
            self.twist.store(&mut rows[Rows::<S>::BOND_TWIST], at);
        }
    }

    /// Strain energy, J.
    #[inline(always)]
    fn energy(&self, k: L, ks: L, gyration: L) -> L {
        // Idle lanes have no stiffness and no forces.
        let floor = |x: L| x.max(L::splat(f64::MIN_POSITIVE));
        let normal = (self.normal * self.normal + self.bend.dot(self.bend) / gyration) / floor(k);
        let shear = (self.shear.dot(self.shear) + self.twist * self.twist / (gyration + gyration)) / floor(ks);
        L::splat(0.5) * (normal + shear)
    }

    /// Zero where the mask holds.
    #[inline(always)]
    fn without(self, gone: L::Mask) -> Self {
        let keep = |x: L| L::select(gone, L::splat(0.0), x);
        Self {
            normal: keep(self.normal),
            shear: S::Shear::<L>::build(|k| keep(self.shear.at(k))),
            bend: S::Shear::<L>::build(|k| keep(self.bend.at(k))),
            twist: keep(self.twist),
        }
    }
}

impl<S: Space> Law<S> for ParallelBondLaw {
    const ROWS: usize = Rows::<S>::COUNT;

    #[inline(always)]
    fn respond<L: Lane>(
        constants: &Constants,
        touch: &Touch<S, L>,
        viscous: Option<Viscous<L>>,
        rows: &mut [Row],
        at: usize,
        ledger: &mut Ledger<'_>,
    ) -> (Load<S, L>, Option<Broken<L>>) {
        let (compression, spring_shear) = spring(constants, touch, viscous, rows, at, ledger);
        let radius = L::splat(constants.multiplier) * touch.radius;
        let k = L::load(&rows[Rows::<S>::BOND], at);
        let ks = k * L::splat(constants.bond_share);
        let gyration = L::splat(S::GYRATION) * (radius * radius);
        let old = Cement::<S, L>::load(rows, at);
        let mut cement = Cement::<S, L> {
            normal: old.normal + k * touch.opening,
            shear: S::turned(old.shear, touch).plus(touch.slide.times(ks)),
            bend: S::turned(old.bend, touch).plus(touch.bend.times(k * gyration)),
            twist: old.twist + ks * gyration * L::splat(2.0) * touch.twist,
        };
        let lever = L::splat(constants.moment_factor / S::GYRATION) / radius;
        let capacity = [L::load(&rows[Rows::<S>::TENSION], at), L::load(&rows[Rows::<S>::COHESION], at)];
        let pull = cement.normal + lever * cement.bend.norm();
        let mut drag = cement.shear.norm();
        if S::DIMENSION == 3 {
            drag = drag + L::splat(0.5) * lever * cement.twist.abs();
        }
        let tension = pull.above(capacity[0]);
        let sheared = drag.above(capacity[1] - cement.normal * L::splat(constants.slope));
        let broken = L::or(tension, sheared);
        let breaks = (L::bits(broken) != 0).then(|| {
            if ledger.open() {
                let energy = cement.energy(k, ks, gyration);
                ledger.charge(BROKEN, at, L::select(broken, energy, L::splat(0.0)));
            }
            cement = cement.without(broken);
            L::select(broken, L::splat(0.0), k).store(&mut rows[Rows::<S>::BOND], at);
            for (row, value) in [Rows::<S>::TENSION, Rows::<S>::COHESION].into_iter().zip(capacity) {
                L::select(broken, L::splat(f64::INFINITY), value).store(&mut rows[row], at);
            }
            Broken { tension, shear: sheared }
        });
        cement.store(rows, at);
        let load = Load {
            normal: cement.normal - compression,
            shear: spring_shear.plus(cement.shear),
            twist: cement.twist,
            bend: cement.bend,
        };
        (load, breaks)
    }
}
