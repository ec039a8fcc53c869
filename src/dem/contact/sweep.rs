//! The one contact loop: geometry, law, loads, for every block of a section.

use super::section::{Chunk, LawKind, Rank, Section};
use crate::boundary::Image;
use crate::law::{
    Account, BOUNDARY, Constants, ContactBondLaw, ENERGIES, FlatJointLaw, Law, LinearLaw, ParallelBondLaw,
};
use crate::law::{Piece, SmoothJointLaw, Viscous};
use crate::simd::{Lane, Quad, Row, WIDEST, prefetch, prefetch_rows};
use crate::space::{End, Load, Space, Touch, Tuple, Vector};

/// Blocks between the one at work and the one whose memory and second ends are asked for.
const AHEAD: usize = 2;
/// Rows of a block from which on its memory is worth asking for; shorter ones the machine foresees by itself.
const LONG: usize = 12;

/// The side of a wall that balls see, now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face<S: Space> {
    /// A point on it.
    pub(crate) point: Vector<S>,
    /// Unit normal into the specimen.
    pub(crate) normal: Vector<S>,
    /// Velocity.
    pub(crate) velocity: Vector<S>,
}

/// What the second ends of a section are.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Second<'a, S: Space> {
    /// Balls.
    Balls,
    /// Images of balls in a periodic cell.
    Images(&'a Image<S>),
    /// A wall.
    Wall(&'a Face<S>),
}

/// What a sweep reads besides its section.
pub(crate) struct Sweep<'a> {
    /// Kinematic records, two dummies at the end.
    pub(crate) records: &'a [Quad],
    /// 1/m of the body of each particle, two dummies at the end.
    pub(crate) inverse_mass: &'a [f64],
    /// Time step, s.
    pub(crate) dt: f64,
}

/// A bond that broke in this step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Break {
    /// Class of the contact.
    pub(crate) class: usize,
    /// Ends in the engine's numbering; j is the wall when `at_wall`.
    pub(crate) i: u32,
    pub(crate) j: u32,
    pub(crate) at_wall: bool,
    /// Its element; 0 for a bond that breaks as a whole.
    pub(crate) element: u32,
    /// Tension, else shear.
    pub(crate) tensile: bool,
    /// Gap, unit normal from i and contact point when it broke; the third coordinate is 0 in the plane.
    pub(crate) gap: f64,
    pub(crate) normal: [f64; 3],
    pub(crate) point: [f64; 3],
    /// Middle of the element that broke.
    pub(crate) middle: [f64; 3],
}

/// Touch of two balls.
#[inline(always)]
fn pair_touch<S: Space, L: Lane>(i: &End<S, L>, j: &End<S, L>, dt: L) -> Touch<S, L> {
    let apart = j.position.minus(i.position);
    let distance = apart.norm();
    let inverse = L::splat(1.0) / distance;
    let gap = distance - (i.radius + j.radius);
    let half = gap * L::splat(0.5);
    S::touch(i, j, apart.times(inverse), gap, [i.radius + half, j.radius + half], inverse, dt)
}

/// An end at its image.
#[inline(always)]
fn shifted<S: Space, L: Lane>(mut end: End<S, L>, image: &Image<S>) -> End<S, L> {
    let lanes = |v: Vector<S>| S::Vector::<L>::build(|k| L::splat(v.at(k)));
    end.position = end.position.plus(lanes(image.shift));
    end.velocity = end.velocity.plus(lanes(image.velocity));
    end
}

/// Touch of a ball and a wall.
#[inline(always)]
fn wall_touch<S: Space, L: Lane>(i: &End<S, L>, face: &Face<S>, dt: L) -> Touch<S, L> {
    let lanes = |v: Vector<S>| S::Vector::<L>::build(|k| L::splat(v.at(k)));
    let inward = lanes(face.normal);
    let gap = i.position.minus(lanes(face.point)).dot(inward) - i.radius;
    let zero = L::splat(0.0);
    let j = End {
        position: i.position,
        radius: L::splat(f64::INFINITY),
        velocity: lanes(face.velocity),
        spin: S::Spin::<L>::zero(),
    };
    let arm = i.radius + gap * L::splat(0.5);
    S::touch(i, &j, inward.times(L::splat(-1.0)), gap, [arm, zero], zero, dt)
}

/// Runs the law of a section over all its blocks.
#[inline(always)]
pub(crate) fn sweep_section<S: Space, L: Lane>(
    constants: &Constants,
    second: Second<'_, S>,
    section: &mut Section,
    task: &Sweep<'_>,
    loads: &mut [Quad],
    breaks: &mut Vec<Break>,
) {
    let rank = section.rank;
    for chunk in &mut section.chunks {
        match section.law {
            LawKind::Linear => blocks::<S, L, LinearLaw>(constants, second, rank, chunk, task, loads, breaks),
            LawKind::ContactBond => blocks::<S, L, ContactBondLaw>(constants, second, rank, chunk, task, loads, breaks),
            LawKind::ParallelBond => {
                blocks::<S, L, ParallelBondLaw>(constants, second, rank, chunk, task, loads, breaks);
            }
            LawKind::FlatJoint { .. } => {
                blocks::<S, L, FlatJointLaw>(constants, second, rank, chunk, task, loads, breaks);
            }
            LawKind::SmoothJoint => blocks::<S, L, SmoothJointLaw>(constants, second, rank, chunk, task, loads, breaks),
        }
    }
}

#[inline(always)]
fn blocks<S: Space, L: Lane, K: Law<S>>(
    constants: &Constants,
    second: Second<'_, S>,
    rank: Rank,
    chunk: &mut Chunk,
    task: &Sweep<'_>,
    loads: &mut [Quad],
    breaks: &mut Vec<Break>,
) {
    let viscous = constants.dashpot != [0.0; 2];
    let dt = L::splat(task.dt);
    let count = K::rows(&constants.layout);
    let mut after = &mut chunk.rows[..];
    for (b, ends) in chunk.ends.iter().enumerate() {
        let (rows, rest) = after.split_at_mut(count);
        after = rest;
        if count >= LONG
            && let Some(next) = after.get((AHEAD - 1) * count..AHEAD * count)
        {
            prefetch_rows(next);
        }
        if let Some(next) = chunk.ends.get(b + AHEAD) {
            for &j in &next[1] {
                prefetch(task.records, S::RECORD, j);
                prefetch(loads, S::LOADS, j);
            }
        }
        for at in (0..WIDEST).step_by(L::WIDTH) {
            let (first, others) = (&ends[0][at..at + L::WIDTH], &ends[1][at..at + L::WIDTH]);
            let i = S::ends::<L>(task.records, first);
            let touch = match second {
                Second::Balls => pair_touch(&i, &S::ends::<L>(task.records, others), dt),
                Second::Images(image) => pair_touch(&i, &shifted(S::ends::<L>(task.records, others), image), dt),
                Second::Wall(face) => wall_touch(&i, face, dt),
            };
            let balls = (!matches!(second, Second::Wall(_))).then_some(others);
            let drag = viscous.then(|| drag(constants, task, first, balls, K::stiffness::<L>(rows, at)));
            let mut account = Account(chunk.account.get_mut(b * ENERGIES..(b + 1) * ENERGIES));
            let (load, broken) = K::respond::<L>(constants, &touch, drag, rows, at, &mut account);
            match second {
                Second::Balls => S::push_both(loads, [first, others], &touch, &load),
                Second::Images(image) => {
                    if account.open() {
                        account.charge(BOUNDARY, at, work(image.velocity, task.dt, &touch, &load));
                    }
                    S::push_both(loads, [first, others], &touch, &load);
                }
                Second::Wall(face) => {
                    if account.open() {
                        account.charge(BOUNDARY, at, work(face.velocity, task.dt, &touch, &load));
                    }
                    S::push_one(loads, first, &touch, &load);
                    react(&mut chunk.reactions[b * S::DIMENSION..], at, &touch, &load);
                }
            }
            if let Some(broken) = broken {
                let (tension, shear) = (L::bits(broken.tension), L::bits(broken.shear));
                let geometry = Geometry::new(&i, &touch);
                let masks = [tension, tension | shear];
                note::<S, K>(constants, rank, [first, others], masks, &geometry, (rows, at), breaks);
            }
        }
    }
}

/// Dashpot coefficients over the time step, 2 β √(m_eff k) / dt.
#[inline(always)]
fn drag<L: Lane>(constants: &Constants, task: &Sweep<'_>, first: &[u32], second: Option<&[u32]>, kn: L) -> Viscous<L> {
    let mut inverse = Row::default();
    for (k, &i) in first.iter().enumerate() {
        inverse.0[k] = task.inverse_mass[i as usize] + second.map_or(0.0, |j| task.inverse_mass[j[k] as usize]);
    }
    // Two bodies that are both held have no effective mass, and no dashpot.
    let inverse = L::load(&inverse, 0);
    let free = inverse.above(L::splat(0.0));
    let inverse = inverse.max(L::splat(f64::MIN_POSITIVE));
    let critical = |k: L| L::select(free, (k / inverse).sqrt(), L::splat(0.0));
    Viscous {
        normal: L::splat(2.0 * constants.dashpot[0] / task.dt) * critical(kn),
        shear: L::splat(2.0 * constants.dashpot[1] / task.dt) * critical(kn * L::splat(constants.shear_share)),
    }
}

/// Work of a moving wall on the ball, or of a moving cell on what it holds, J.
#[inline(always)]
fn work<S: Space, L: Lane>(velocity: Vector<S>, dt: f64, touch: &Touch<S, L>, load: &Load<S, L>) -> L {
    let way = velocity.times(dt);
    S::force(touch, load).dot(S::Vector::<L>::build(|k| L::splat(way.at(k))))
}

/// Stores the force on the wall.
#[inline(always)]
fn react<S: Space, L: Lane>(reactions: &mut [Row], at: usize, touch: &Touch<S, L>, load: &Load<S, L>) {
    let force = S::force(touch, load);
    for k in 0..S::DIMENSION {
        (-force.at(k)).store(&mut reactions[k], at);
    }
}

/// Where the contacts of a lane are, out of the registers.
#[derive(Default)]
struct Geometry {
    gap: Row,
    normal: [Row; 3],
    point: [Row; 3],
    radius: Row,
}

impl Geometry {
    #[inline(always)]
    fn new<S: Space, L: Lane>(i: &End<S, L>, touch: &Touch<S, L>) -> Self {
        let mut geometry = Self::default();
        touch.gap.store(&mut geometry.gap, 0);
        touch.radius.store(&mut geometry.radius, 0);
        let point = i.position.plus(touch.normal.times(touch.arm_i));
        for k in 0..S::DIMENSION {
            touch.normal.at(k).store(&mut geometry.normal[k], 0);
            point.at(k).store(&mut geometry.point[k], 0);
        }
        geometry
    }
}

/// Notes the contacts of a lane that broke, piece by piece: in tension (first mask) or at all (second).
#[cold]
#[inline(never)]
fn note<S: Space, K: Law<S>>(
    constants: &Constants,
    rank: Rank,
    ends: [&[u32]; 2],
    masks: [u8; 2],
    geometry: &Geometry,
    (rows, at): (&mut [Row], usize),
    breaks: &mut Vec<Break>,
) {
    for k in (0..ends[0].len()).filter(|k| masks[1] >> k & 1 == 1) {
        let (normal, point) = (geometry.normal.map(|row| row.0[k]), geometry.point.map(|row| row.0[k]));
        K::pieces(constants, rows, at + k, masks[0] >> k & 1 == 1, |piece| {
            let arm = offset::<S>(&piece, normal);
            breaks.push(Break {
                class: rank.class,
                i: ends[0][k],
                j: if rank.at_wall { rank.second } else { ends[1][k] },
                at_wall: rank.at_wall,
                element: piece.element,
                tensile: piece.tensile,
                gap: geometry.gap.0[k],
                normal,
                point,
                middle: std::array::from_fn(|a| point[a] + arm[a] * geometry.radius.0[k]),
            });
        });
    }
}

/// From the contact point to a piece of its bond, over the smaller radius.
fn offset<S: Space>(piece: &Piece, n: [f64; 3]) -> [f64; 3] {
    let [x, y] = piece.arm;
    if S::DIMENSION == 2 {
        return [-n[1] * x, n[0] * x, 0.0];
    }
    let t = piece.frame;
    let across = crate::space::D3::moment(n, t);
    std::array::from_fn(|k| t[k] * x + across[k] * y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interaction::{Bond, BondStiffness, Interaction, Linear, ParallelBond};
    use crate::law::RowIndex;
    use crate::space::{D2, D3};
    use crate::strength::Scatter;

    /// Loads a bonded pair, then turns it as a whole once around `axis` in `steps` steps (chords against arcs leave an
    /// error of the order of steps⁻²); normal force, shear force,
    /// moment before and after.
    fn turned<S: Space>(axis: [f64; 3], steps: u32) -> [[f64; 3]; 2] {
        let bond = ParallelBond {
            radius_multiplier: 1.0,
            stiffness: BondStiffness::PerArea { kn: 1e9, ks: 5e8 },
            tensile_strength: f64::INFINITY,
            cohesion: f64::INFINITY,
            friction_angle: 0.0,
            moment_factor: 1.0,
            scatter: Scatter::default(),
        };
        let constants =
            Constants::new::<S>(&Interaction { linear: Linear::direct(1.0, 1.0, 0.0), bond: Bond::Parallel(bond) });
        let mut rows = vec![Row::default(); RowIndex::<S>::COUNT];
        rows[RowIndex::<S>::TENSION] = Row([f64::MAX; WIDEST]);
        rows[RowIndex::<S>::COHESION] = Row([f64::MAX; WIDEST]);
        rows[RowIndex::<S>::BOND] = Row([1e9; WIDEST]);
        let mut answer = |ends: &[End<S, f64>; 2]| {
            let touch = pair_touch(&ends[0], &ends[1], 1.0);
            let (load, _) = ParallelBondLaw::respond(&constants, &touch, None, &mut rows, 0, &mut Account(None));
            [load.normal, load.shear.norm(), (load.bend.norm().powi(2) + load.twist.powi(2)).sqrt()]
        };
        let vector = |x: [f64; 3]| Vector::<S>::build(|k| x[k]);
        let spin = |w: [f64; 3]| S::Spin::<f64>::build(|k| if S::DIMENSION == 2 { w[2] } else { w[k] });
        let end = |x: [f64; 3], v: [f64; 3], w: [f64; 3]| End::<S, f64> {
            position: vector(x),
            radius: 0.5,
            velocity: vector(v),
            spin: spin(w),
        };
        let zero = [0.0; 3];
        let start = [0.5, 1e-4, 0.0];
        let pushed = end(start, [1e-5, 1e-4, 5e-5], [3e-5, 4e-5, 5e-5]);
        let before = answer(&[end([-0.5, 0.0, 0.0], zero, zero), pushed]);
        // Rodrigues' formula about the middle of the pair.
        let around = |x: [f64; 3], angle: f64| {
            let (sin, cos) = math::elementary::sin_cos(angle);
            let cross = D3::carried(axis, x);
            let along = axis.dot(x) * (1.0 - cos);
            std::array::from_fn::<f64, 3, _>(|k| x[k] * cos + cross[k] * sin + axis[k] * along)
        };
        let angle = std::f64::consts::TAU / f64::from(steps);
        let middle = [0.0, 5e-5, 0.0];
        let mut after = before;
        for step in 1..=steps {
            let ends = [[-0.5, 0.0, 0.0], start].map(|x| {
                let arm = x.minus(middle);
                let (old, new) = (around(arm, angle * f64::from(step - 1)), around(arm, angle * f64::from(step)));
                end(new, new.minus(old), axis.times(angle))
            });
            after = answer(&ends);
        }
        [before, after]
    }

    #[test]
    fn a_rigid_rotation_keeps_forces_and_moments() {
        let check = |[before, after]: [[f64; 3]; 2]| {
            assert!(before.iter().all(|x| x.abs() > 1e3), "{before:?}");
            for k in 0..3 {
                assert!((after[k] / before[k] - 1.0).abs() < 5e-4, "{before:?} {after:?}");
            }
        };
        check(turned::<D2>([0.0, 0.0, 1.0], 40_000));
        check(turned::<D3>([0.0, 0.0, 1.0], 40_000));
        check(turned::<D3>([1.0, 0.0, 0.0], 40_000));
        check(turned::<D3>([0.48, 0.6, 0.64], 40_000));
    }
}
