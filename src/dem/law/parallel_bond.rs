//! Parallel bond: an elastic cement beside the linear contact (Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011;
//! PFC `linearpbond`).
//!
//! Increments in a step, with A, I, J of the radius R̄ = λ min(R₁, R₂) and k = k̄_n A:
//! ΔF_n = k Δ_n, ΔF_s = k κ̄⁻¹ Δ_s, ΔM_b = k (I/A) Δθ_b, ΔM_t = k κ̄⁻¹ (J/A) Δθ_t (solid only).
//!
//! Break, in tension first: F_n + β |M_b| A R̄ / I > σ_c A; else in shear: |F_s| + β |M_t| A R̄ / J > c A − F_n tan φ
//! (both sides multiplied by A). A broken bond vanishes at once; the linear contact stays.

use super::linear::spring;
use super::{Account, BROKEN, Broken, Constants, Law, Layout, RowIndex, Viscous, load_shear, store_shear};
use crate::simd::{Lane, Row};
use crate::space::{Load, Space, Touch, Tuple};

/// The parallel-bond law.
pub(crate) struct ParallelBondLaw;

/// Share by which the quick check of the strengths is narrower than the criteria.
const NARROWER: f64 = 1e-9;

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
            normal: L::load(&rows[RowIndex::<S>::BOND_NORMAL], at),
            shear: load_shear::<S, L>(rows, RowIndex::<S>::BOND_SHEAR, at),
            bend: load_shear::<S, L>(rows, RowIndex::<S>::BOND_BEND, at),
            twist: if solid { L::load(&rows[RowIndex::<S>::BOND_TWIST], at) } else { L::splat(0.0) },
        }
    }

    #[inline(always)]
    fn store(self, rows: &mut [Row], at: usize) {
        self.normal.store(&mut rows[RowIndex::<S>::BOND_NORMAL], at);
        store_shear::<S, L>(rows, RowIndex::<S>::BOND_SHEAR, at, self.shear);
        store_shear::<S, L>(rows, RowIndex::<S>::BOND_BEND, at, self.bend);
        if S::DIMENSION == 3 {
            self.twist.store(&mut rows[RowIndex::<S>::BOND_TWIST], at);
        }
    }

    /// Where the stress is above the strength: in tension, in shear.
    #[inline(always)]
    fn exceeds(&self, constants: &Constants, radius: L, capacity: [L; 2]) -> [L::Mask; 2] {
        let lever = L::splat(constants.moment_factor / S::GYRATION) / radius;
        let pull = self.normal + lever * self.bend.norm();
        let mut drag = self.shear.norm();
        if S::DIMENSION == 3 {
            drag = drag + L::splat(0.5) * lever * self.twist.abs();
        }
        [pull.above(capacity[0]), drag.above(capacity[1] - self.normal * L::splat(constants.slope))]
    }

    /// Whether no bond of the lane is anywhere near its strength: the criteria squared and times R̄, so without roots and
    /// divisions, and narrower by far more than rounding. True means that [`Self::exceeds`] finds nothing; capacities are
    /// positive.
    #[inline(always)]
    fn surely_holds(&self, constants: &Constants, radius: L, capacity: [L; 2]) -> bool {
        let arm = L::splat(constants.moment_factor / S::GYRATION);
        let less = L::splat(1.0 - NARROWER);
        let pull = (capacity[0] * less - self.normal) * radius;
        let bend = arm * arm * self.bend.dot(self.bend);
        let mut drag = capacity[1] * less - self.normal * L::splat(constants.slope);
        if S::DIMENSION == 3 {
            drag = drag * radius - L::splat(0.5) * arm * self.twist.abs();
        }
        let shear = self.shear.dot(self.shear) * if S::DIMENSION == 3 { radius * radius } else { L::splat(1.0) };
        let holds = |room: L, square: L| {
            // Of a room below 0 the square says nothing.
            let room = room.max(L::splat(0.0));
            (room * room * less).above(square)
        };
        L::bits(holds(pull, bend)) & L::bits(holds(drag, shear)) == L::ALL
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
    #[inline(always)]
    fn rows(_layout: &Layout) -> usize {
        RowIndex::<S>::COUNT
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
        let radius = L::splat(constants.multiplier) * touch.radius;
        let k = L::load(&rows[RowIndex::<S>::BOND], at);
        let ks = k * L::splat(constants.bond_share);
        let gyration = L::splat(S::GYRATION) * (radius * radius);
        let old = Cement::<S, L>::load(rows, at);
        let mut cement = Cement::<S, L> {
            normal: old.normal + k * touch.opening,
            shear: S::turned(old.shear, touch).plus(touch.slide.times(ks)),
            bend: S::turned(old.bend, touch).plus(touch.bend.times(k * gyration)),
            twist: old.twist + ks * gyration * L::splat(2.0) * touch.twist,
        };
        let capacity = [L::load(&rows[RowIndex::<S>::TENSION], at), L::load(&rows[RowIndex::<S>::COHESION], at)];
        // In the plane there are no roots to save.
        let breaks = if S::SHEAR > 1 && cement.surely_holds(constants, radius, capacity) {
            None
        } else {
            let [tension, sheared] = cement.exceeds(constants, radius, capacity);
            let broken = L::or(tension, sheared);
            (L::bits(broken) != 0).then(|| {
                if account.open() {
                    let energy = cement.energy(k, ks, gyration);
                    account.charge(BROKEN, at, L::select(broken, energy, L::splat(0.0)));
                }
                cement = cement.without(broken);
                L::select(broken, L::splat(0.0), k).store(&mut rows[RowIndex::<S>::BOND], at);
                for (row, value) in [RowIndex::<S>::TENSION, RowIndex::<S>::COHESION].into_iter().zip(capacity) {
                    L::select(broken, L::splat(f64::INFINITY), value).store(&mut rows[row], at);
                }
                Broken { tension, shear: sheared }
            })
        };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interaction::{Bond, BondStiffness, Interaction, Linear, ParallelBond};
    use crate::space::{D2, D3};
    use crate::strength::Scatter;
    use math::random::Stream;

    /// Draws cements whose stress is at the strength to within `share`; how often the quick check held.
    fn held<S: Space>(share: f64) -> usize {
        let bond = ParallelBond {
            radius_multiplier: 1.0,
            stiffness: BondStiffness::PerArea { kn: 1e9, ks: 5e8 },
            tensile_strength: 1.0,
            cohesion: 1.0,
            friction_angle: 0.4,
            moment_factor: 0.7,
            scatter: Scatter::default(),
        };
        let law = Interaction { linear: Linear::direct(1.0, 1.0, 0.0), bond: Bond::Parallel(bond) };
        let (constants, mut stream) = (Constants::new::<S>(&law), Stream::new(3, "cement", 0));
        let draw = |_: usize| {
            let mut number = || 1e3 * stream.normal();
            let (normal, twist) = (number(), if S::DIMENSION == 3 { number() } else { 0.0 });
            let shear = S::Shear::<f64>::build(|_| number());
            let cement = Cement::<S, f64> { normal, shear, bend: S::Shear::<f64>::build(|_| number()), twist };
            let radius = stream.uniform_in(0.1, 10.0);
            let near = [0, 1].map(|_| 1.0 + share * stream.uniform_in(-1.0, 1.0));
            let lever = constants.moment_factor / S::GYRATION / radius;
            let turning = if S::DIMENSION == 3 { 0.5 * lever * twist.abs() } else { 0.0 };
            let pull = normal + lever * cement.bend.norm();
            let drag = cement.shear.norm() + turning + normal * constants.slope;
            if pull <= 0.0 || drag <= 0.0 {
                return 0;
            }
            let capacity = [pull * near[0], drag * near[1]];
            let quick = cement.surely_holds(&constants, radius, capacity);
            let exceeded = cement.exceeds(&constants, radius, capacity);
            assert!(!(quick && (exceeded[0] || exceeded[1])), "{normal} {capacity:?}");
            usize::from(quick)
        };
        (0..20_000).map(draw).sum()
    }

    #[test]
    fn the_quick_check_never_overlooks_a_break() {
        assert_eq!(held::<D2>(1e-15) + held::<D3>(1e-15), 0);
        assert!(held::<D2>(1e-6) > 1000 && held::<D3>(1e-6) > 1000);
        assert!(held::<D2>(0.5) > 1000 && held::<D3>(0.5) > 1000);
    }
}
