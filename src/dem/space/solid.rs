//! The solid: spheres.
//!
//! Shear, bending and the like are vectors in the contact plane. When the normal swings from n to n', a vector v of the
//! old plane is carried along without turning about it: v' = v − (v·n') (n + n') / (1 + n·n'). With δ the swing in a step,
//! (n + n') / (1 + n·n') = n' − δ/2 up to third order. Then v' is turned about n' by the mean spin's angle φ, to second
//! order: (1 − φ²/2) v' + φ n' × v'. So a rigid rotation keeps lengths to fourth order in a step.

use super::{End, Load, Space, Touch, Tuple};
use crate::engine::Engine;
use crate::error::Failure;
use crate::simd::{Lane, Quad};
use std::f64::consts::PI;

/// Spheres.
///
/// Record: `x y z r`, `vx vy vz 0`, `ωx ωy ωz 0`. Loads: `fx fy fz 0`, `mx my mz 0`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct D3;

#[inline(always)]
pub(crate) fn cross<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The part of v normal to the unit vector n.
#[inline(always)]
fn flattened<L: Lane>(v: [L; 3], n: [L; 3]) -> [L; 3] {
    v.minus(n.times(v.dot(n)))
}

impl Space for D3 {
    const NAME: &'static str = "3D";
    const DIMENSION: usize = 3;
    const RECORD: usize = 3;
    const LOADS: usize = 2;
    const SHEAR: usize = 3;
    const GYRATION: f64 = 0.25;
    type Vector<L: Lane> = [L; 3];
    type Spin<L: Lane> = [L; 3];
    type Turn = [[f64; 3]; 3];
    type Shear<L: Lane> = [L; 3];

    fn advance(engine: &mut Engine<Self>, steps: u64) -> Result<(), Failure> {
        engine.march_on(steps)
    }

    fn volume(radius: f64) -> f64 {
        4.0 / 3.0 * PI * radius * radius * radius
    }

    fn inertia(mass: f64, radius: f64) -> f64 {
        0.4 * mass * radius * radius
    }

    fn section(radius: f64) -> f64 {
        PI * radius * radius
    }

    #[inline(always)]
    fn ends<L: Lane>(table: &[Quad], ends: &[u32]) -> End<Self, L> {
        let [[x, y, z, radius], [vx, vy, vz, _], [wx, wy, wz, _]] = L::gather(table, ends);
        End { position: [x, y, z], radius, velocity: [vx, vy, vz], spin: [wx, wy, wz] }
    }

    #[inline(always)]
    fn touch<L: Lane>(
        i: &End<Self, L>,
        j: &End<Self, L>,
        normal: [L; 3],
        gap: L,
        arms: [L; 2],
        inverse_distance: L,
        dt: L,
    ) -> Touch<Self, L> {
        let apart = j.velocity.minus(i.velocity);
        let speed = apart.dot(normal);
        let rolling = i.spin.times(arms[0]).plus(j.spin.times(arms[1]));
        let tangential = apart.minus(normal.times(speed));
        let turn = j.spin.minus(i.spin).times(dt);
        let twist = turn.dot(normal);
        let half = L::splat(0.5);
        // The displacement is taken in the mean plane of the step and laid into the new one.
        let lag = tangential.times(inverse_distance * dt * half);
        let tilt = normal.minus(lag);
        let parting = apart.dot(tilt);
        let slide = tangential.plus(lag.times(parting)).minus(flattened(cross(rolling, tilt), normal));
        let roll = i.spin.plus(j.spin).dot(normal) * (half * dt);
        Touch {
            normal,
            gap,
            arm_i: arms[0],
            arm_j: arms[1],
            radius: i.radius.min(j.radius),
            opening: parting * dt,
            slide: slide.times(dt),
            twist,
            bend: turn.minus(normal.times(twist)),
            tilt,
            roll,
        }
    }

    #[inline(always)]
    fn turned<L: Lane>(shear: [L; 3], touch: &Touch<Self, L>) -> [L; 3] {
        let laid = shear.minus(touch.tilt.times(shear.dot(touch.normal)));
        let shrink = L::splat(1.0) - L::splat(0.5) * (touch.roll * touch.roll);
        laid.times(shrink).plus(cross(touch.normal, laid).times(touch.roll))
    }

    #[inline(always)]
    fn limited<L: Lane>(shear: [L; 3], limit: L) -> [L; 3] {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let square = shear.dot(shear);
        // Where nothing slips the factor is 1, and without a limit 0: no root and no division are needed.
        let sticks = (limit * limit * L::splat(1.0 - 1e-9)).above(square);
        let free = L::splat(f64::from_bits(1)).above(limit);
        if L::bits(L::or(sticks, free)) == L::ALL {
            return shear.times(L::select(sticks, one, zero));
        }
        let length = square.sqrt().max(L::splat(f64::MIN_POSITIVE));
        shear.times((limit / length).min(one))
    }

    #[inline(always)]
    fn push_one<L: Lane>(loads: &mut [Quad], ends: &[u32], touch: &Touch<Self, L>, load: &Load<Self, L>) {
        let zero = L::splat(0.0);
        let [fx, fy, fz] = Self::force(touch, load);
        let bond = Self::bond_moment(touch, load);
        let [mx, my, mz] = cross(touch.normal, load.shear).times(touch.arm_i).plus(bond);
        L::scatter_add(loads, ends, [[fx, fy, fz, zero], [mx, my, mz, zero]]);
    }

    #[inline(always)]
    fn push_both<L: Lane>(loads: &mut [Quad], ends: [&[u32]; 2], touch: &Touch<Self, L>, load: &Load<Self, L>) {
        let zero = L::splat(0.0);
        let [fx, fy, fz] = Self::force(touch, load);
        let bond = Self::bond_moment(touch, load);
        let lever = cross(touch.normal, load.shear);
        let [mx, my, mz] = lever.times(touch.arm_i).plus(bond);
        let [ox, oy, oz] = lever.times(touch.arm_j).minus(bond);
        let first = [[fx, fy, fz, zero], [mx, my, mz, zero]];
        let second = [[-fx, -fy, -fz, zero], [ox, oy, oz, zero]];
        L::scatter_add_both(loads, ends, [first, second]);
    }

    #[inline(always)]
    fn force<L: Lane>(touch: &Touch<Self, L>, load: &Load<Self, L>) -> [L; 3] {
        touch.normal.times(load.normal).plus(load.shear)
    }

    #[inline(always)]
    fn flat<L: Lane>(vector: [L; 3], frame: [L; 3], normal: [L; 3]) -> [L; 2] {
        [vector.dot(frame), vector.dot(cross(normal, frame))]
    }

    #[inline(always)]
    fn across<L: Lane>(vector: [L; 3], _normal: [L; 3]) -> [L; 3] {
        vector
    }

    #[inline(always)]
    fn raised<L: Lane>(flat: [L; 2], frame: [L; 3], normal: [L; 3]) -> [L; 3] {
        frame.times(flat[0]).plus(cross(normal, frame).times(flat[1]))
    }

    #[inline(always)]
    fn slope<L: Lane>(bend: [L; 3], frame: [L; 3], normal: [L; 3]) -> [L; 2] {
        let [first, second] = Self::flat(bend, frame, normal);
        [-second, first]
    }

    #[inline(always)]
    fn bend<L: Lane>(moments: [L; 2], frame: [L; 3], normal: [L; 3]) -> [L; 3] {
        Self::raised([moments[1], -moments[0]], frame, normal)
    }

    #[inline(always)]
    fn bond_moment<L: Lane>(touch: &Touch<Self, L>, load: &Load<Self, L>) -> [L; 3] {
        touch.normal.times(load.twist).plus(load.bend)
    }

    #[inline(always)]
    fn moment<L: Lane>(arm: [L; 3], force: [L; 3]) -> [L; 3] {
        cross(arm, force)
    }

    #[inline(always)]
    fn carried<L: Lane>(spin: [L; 3], arm: [L; 3]) -> [L; 3] {
        cross(spin, arm)
    }

    fn upright() -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    }

    fn turn_on(turn: [[f64; 3]; 3], rotation: [f64; 3]) -> [[f64; 3]; 3] {
        // Cayley's map on the columns, then Gram-Schmidt against rounding.
        let half = rotation.map(|x| 0.5 * x);
        let scale = 2.0 / (1.0 + half.dot(half));
        let column = |k: usize| {
            let v = [turn[0][k], turn[1][k], turn[2][k]];
            let first = cross(half, v);
            v.plus(first.plus(cross(half, first)).times(scale))
        };
        let x = column(0);
        let x = x.times(1.0 / x.norm());
        let y = flattened(column(1), x);
        let y = y.times(1.0 / y.norm());
        let z = cross(x, y);
        std::array::from_fn(|k| [x[k], y[k], z[k]])
    }

    fn outward(turn: [[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
        turn.map(|row| row.dot(vector))
    }

    fn inward(turn: [[f64; 3]; 3], spin: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| turn[0][k] * spin[0] + turn[1][k] * spin[1] + turn[2][k] * spin[2])
    }

    fn outward_spin(turn: [[f64; 3]; 3], spin: [f64; 3]) -> [f64; 3] {
        Self::outward(turn, spin)
    }

    fn spin_of(turn: [[f64; 3]; 3], inverse: &[[f64; 3]; 3], momentum: [f64; 3]) -> [f64; 3] {
        let inward = Self::inward(turn, momentum);
        Self::outward(turn, inverse.map(|row| row.dot(inward)))
    }

    fn momentum_of(inertia: &[[f64; 3]; 3], spin: [f64; 3]) -> [f64; 3] {
        inertia.map(|row| row.dot(spin))
    }

    fn turned_inertia(turn: [[f64; 3]; 3], inertia: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let half = turn.map(|row| std::array::from_fn::<f64, 3, _>(|k| (0..3).map(|m| row[m] * inertia[m][k]).sum()));
        half.map(|row| turn.map(|other| row.dot(other)))
    }

    fn inverse_inertia(inertia: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
        let [a, b, c] = *inertia;
        let minor = a[0] * b[1] - a[1] * b[0];
        let determinant = a.dot(cross(b, c));
        let positive = a[0] > 0.0 && minor > 0.0 && determinant > 0.0 && determinant.is_finite();
        // Columns of the inverse are the cross products of the rows over the determinant.
        let columns = [cross(b, c), cross(c, a), cross(a, b)].map(|v: [f64; 3]| v.times(1.0 / determinant));
        positive.then(|| std::array::from_fn(|k| [columns[0][k], columns[1][k], columns[2][k]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::random::Stream;

    #[test]
    fn a_limit_has_the_bits_of_its_formula() {
        let mut stream = Stream::new(8, "shear", 0);
        for _ in 0..20_000 {
            let shear: [f64; 3] = std::array::from_fn(|_| stream.normal());
            let length = shear.norm();
            for share in [0.0, 0.5, 1.0 - 1e-9, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.0 + 1e-9, 2.0] {
                let limit = share * length;
                let plain = shear.times((limit / length.max(f64::MIN_POSITIVE)).min(1.0));
                assert_eq!(D3::limited(shear, limit).map(f64::to_bits), plain.map(f64::to_bits), "{shear:?} {share}");
            }
        }
    }
}
