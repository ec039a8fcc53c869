//! The plane: discs of unit thickness.

use super::{End, Load, Space, Touch, Tuple};
use crate::engine::Engine;
use crate::error::Failure;
use crate::simd::{Lane, Quad};

/// Discs of unit thickness.
///
/// Record: `x y θ r`, `vx vy ω 0`. Loads: `fx fy m 0`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct D2;

impl Space for D2 {
    const NAME: &'static str = "2D";
    const DIMENSION: usize = 2;
    const RECORD: usize = 2;
    const LOADS: usize = 1;
    const SHEAR: usize = 1;
    const GYRATION: f64 = 1.0 / 3.0;
    type Vector<L: Lane> = [L; 2];
    type Spin<L: Lane> = [L; 1];
    type Turn = [f64; 2];
    type Shear<L: Lane> = [L; 1];

    fn advance(engine: &mut Engine<Self>, steps: u64) -> Result<(), Failure> {
        engine.march_on(steps)
    }

    fn volume(radius: f64) -> f64 {
        std::f64::consts::PI * radius * radius
    }

    fn inertia(mass: f64, radius: f64) -> f64 {
        0.5 * mass * radius * radius
    }

    fn section(radius: f64) -> f64 {
        2.0 * radius
    }

    #[inline(always)]
    fn ends<L: Lane>(table: &[Quad], ends: &[u32]) -> End<Self, L> {
        let [[x, y, _, radius], [vx, vy, spin, _]] = L::gather(table, ends);
        End { position: [x, y], radius, velocity: [vx, vy], spin: [spin] }
    }

    #[inline(always)]
    fn touch<L: Lane>(
        i: &End<Self, L>,
        j: &End<Self, L>,
        normal: [L; 2],
        gap: L,
        arms: [L; 2],
        inverse_distance: L,
        dt: L,
    ) -> Touch<Self, L> {
        let [nx, ny] = normal;
        let [ux, uy] = j.velocity.minus(i.velocity);
        let rolling = i.spin[0] * arms[0] + j.spin[0] * arms[1];
        let across = uy * nx - ux * ny;
        // The displacement is taken along the mean normal and tangent of the step, which lag behind the new ones.
        let lag = L::splat(0.5) * (across * inverse_distance * dt);
        let parting = (ux * nx + uy * ny) - across * lag;
        Touch {
            normal,
            gap,
            arm_i: arms[0],
            arm_j: arms[1],
            radius: i.radius.min(j.radius),
            opening: parting * dt,
            slide: [(across + lag * parting - rolling) * dt],
            twist: L::splat(0.0),
            bend: [(j.spin[0] - i.spin[0]) * dt],
            tilt: normal,
            roll: L::splat(0.0),
        }
    }

    #[inline(always)]
    fn turned<L: Lane>(shear: [L; 1], _touch: &Touch<Self, L>) -> [L; 1] {
        shear
    }

    #[inline(always)]
    fn limited<L: Lane>(shear: [L; 1], limit: L) -> [L; 1] {
        [shear[0].min(limit).max(-limit)]
    }

    #[inline(always)]
    fn push_one<L: Lane>(loads: &mut [Quad], ends: &[u32], touch: &Touch<Self, L>, load: &Load<Self, L>) {
        let [fx, fy] = Self::force(touch, load);
        let moment = touch.arm_i * load.shear[0] + load.bend[0];
        L::scatter_add(loads, ends, [[fx, fy, moment, L::splat(0.0)]]);
    }

    #[inline(always)]
    fn push_both<L: Lane>(loads: &mut [Quad], ends: [&[u32]; 2], touch: &Touch<Self, L>, load: &Load<Self, L>) {
        let zero = L::splat(0.0);
        let [fx, fy] = Self::force(touch, load);
        let first = touch.arm_i * load.shear[0] + load.bend[0];
        let second = touch.arm_j * load.shear[0] - load.bend[0];
        L::scatter_add_both(loads, ends, [[[fx, fy, first, zero]], [[-fx, -fy, second, zero]]]);
    }

    #[inline(always)]
    fn force<L: Lane>(touch: &Touch<Self, L>, load: &Load<Self, L>) -> [L; 2] {
        let ([nx, ny], shear) = (touch.normal, load.shear[0]);
        [load.normal * nx - shear * ny, load.normal * ny + shear * nx]
    }

    #[inline(always)]
    fn flat<L: Lane>(vector: [L; 1], _frame: [L; 1], _normal: [L; 2]) -> [L; 2] {
        [vector[0], L::splat(0.0)]
    }

    #[inline(always)]
    fn across<L: Lane>([x, y]: [L; 2], [nx, ny]: [L; 2]) -> [L; 1] {
        [y * nx - x * ny]
    }

    #[inline(always)]
    fn raised<L: Lane>(flat: [L; 2], _frame: [L; 1], _normal: [L; 2]) -> [L; 1] {
        [flat[0]]
    }

    #[inline(always)]
    fn slope<L: Lane>(bend: [L; 1], _frame: [L; 1], _normal: [L; 2]) -> [L; 2] {
        [-bend[0], L::splat(0.0)]
    }

    #[inline(always)]
    fn bend<L: Lane>(moments: [L; 2], _frame: [L; 1], _normal: [L; 2]) -> [L; 1] {
        [-moments[0]]
    }

    #[inline(always)]
    fn bond_moment<L: Lane>(_touch: &Touch<Self, L>, load: &Load<Self, L>) -> [L; 1] {
        load.bend
    }

    #[inline(always)]
    fn moment<L: Lane>(arm: [L; 2], force: [L; 2]) -> [L; 1] {
        [arm[0] * force[1] - arm[1] * force[0]]
    }

    #[inline(always)]
    fn carried<L: Lane>(spin: [L; 1], arm: [L; 2]) -> [L; 2] {
        [-(spin[0] * arm[1]), spin[0] * arm[0]]
    }

    fn upright() -> [f64; 2] {
        [1.0, 0.0]
    }

    fn turn_on([c, s]: [f64; 2], rotation: [f64; 1]) -> [f64; 2] {
        // Cayley's map: exact to third order in the step's angle, and a rotation whatever the angle.
        let half = 0.5 * rotation[0];
        let scale = 1.0 / (1.0 + half * half);
        let (a, b) = ((1.0 - half * half) * scale, 2.0 * half * scale);
        let [c, s] = [a * c - b * s, a * s + b * c];
        let length = (c * c + s * s).sqrt();
        [c / length, s / length]
    }

    fn outward([c, s]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        [c * x - s * y, s * x + c * y]
    }

    fn inward(_turn: [f64; 2], spin: [f64; 1]) -> [f64; 1] {
        spin
    }

    fn outward_spin(_turn: [f64; 2], spin: [f64; 1]) -> [f64; 1] {
        spin
    }

    fn spin_of(_turn: [f64; 2], inverse: &[[f64; 3]; 3], momentum: [f64; 1]) -> [f64; 1] {
        [inverse[2][2] * momentum[0]]
    }

    fn momentum_of(inertia: &[[f64; 3]; 3], spin: [f64; 1]) -> [f64; 1] {
        [inertia[2][2] * spin[0]]
    }

    fn turned_inertia(_turn: [f64; 2], inertia: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        *inertia
    }

    fn inverse_inertia(inertia: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
        let mut inverse = [[0.0; 3]; 3];
        inverse[2][2] = 1.0 / inertia[2][2];
        (inertia[2][2] > 0.0 && inertia[2][2].is_finite()).then_some(inverse)
    }
}
