//! Smooth joints: two held grains across a plane that is oblique to their contact, and a block on a tilted plane.
//!
//! Along the plane's normal F_n = k_n A u up to σ A; along the plane F_s = k_s A s up to c A + P tan φ while bonded, μ P after;
//! with a dilation angle a slip of s at a held opening adds k_n A s tan ψ to P. A block on a plane of dip β rests while
//! tan β < μ, slides with g (sin β − μ cos β) above, and rises by tan ψ of what it slides.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::measure::Mode;
use dem::space::Tuple;
use dem::*;
use math::elementary::{atan, cos, sin};
use std::sync::LazyLock;

const RADII: [f64; 2] = [0.5, 0.4];
const KN: f64 = 1e9;
const KS: f64 = 5e8;
const MU: f64 = 0.4;
const DILATION: f64 = 0.1;
/// Angle of the plane's normal against the line of the centres.
const OBLIQUE: f64 = 0.6;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Grains of radii 0.5 and 0.4 m, the plane's normal 0.6 rad from the line of their centres, k_n 1e9 and k_s 5e8 Pa/m, μ \
        0.4, σ 0.1 and c 0.15 MPa, tan φ 0.5; a block of 8 × 3 bonded grains of radius 0.5 m on a row that is held.";
    Family { title: "Smooth joints", about, cases: &CASES }
}

#[test]
fn smooth_joints_have_their_closed_forms() {
    family().check();
}

fn bond() -> JointBond {
    JointBond { tensile_strength: 1e5, cohesion: 1.5e5, friction_angle: atan(0.5) }
}

/// The plane's normal and a direction along it.
fn axes<S: Space>() -> [Vector<S>; 2] {
    let (c, s) = (cos(OBLIQUE), sin(OBLIQUE));
    [along::<S>(0, c).plus(along::<S>(1, s)), along::<S>(0, -s).plus(along::<S>(1, c))]
}

fn pair<S: Space>(joint: SmoothJoint) -> Engine<S> {
    let at = [along::<S>(0, 0.0), along::<S>(0, RADII[0] + RADII[1])];
    let balls = at.iter().zip(RADII).map(|(&x, r)| Particle::ball(x, r, 2000.0, GRAIN)).collect();
    let settings = Settings { damping: 0.0, fixed_step: Some(1.0), ..Settings::default() };
    let law =
        Interaction { linear: Linear::direct(1e9, 1e9, MU), bond: Bond::Flat(FlatJoint::new(1e9, 2.0, 1e5, 1e5)) };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    let fracture = Fracture { centre: along::<S>(0, 0.5), normal: axes::<S>()[0], radius: 0.3, set: 0 };
    assert_eq!(engine.lay_joints(&[fracture], &[joint], 1e-12).unwrap(), 1);
    // The joint has taken the contact, so there is nothing left to bond.
    assert_eq!(engine.install_bonds(1e-12, 1).unwrap(), 0);
    engine.fix(&[0, 1], true, true).unwrap();
    engine
}

/// Moves the second grain by `way` in `steps` steps, one more at rest; forces on the first along the normal and the plane.
fn moved<S: Space>(engine: &mut Engine<S>, way: Vector<S>, steps: u32) -> [f64; 2] {
    engine.set_motion(1, way.times(1.0 / f64::from(steps)), Spin::<S>::zero()).unwrap();
    engine.advance(u64::from(steps)).unwrap();
    engine.set_motion(1, Vector::<S>::zero(), Spin::<S>::zero()).unwrap();
    engine.advance(1).unwrap();
    let force = engine.contacts().next().unwrap().force();
    axes::<S>().map(|axis| force.dot(axis))
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    held::<D2>(&mut cases);
    held::<D3>(&mut cases);
    block(&mut cases);
    cases
}

fn held<S: Space>(cases: &mut Vec<Case>) {
    let area = S::section(0.4);
    let [across, along] = axes::<S>();
    let joint = SmoothJoint { dilation: atan(DILATION), ..SmoothJoint::new(KN, KS, MU) };
    let bonded = SmoothJoint { bond: Some(bond()), ..joint };
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("{}: {what}", S::NAME), source, expected, got, near));
    };
    // The grains turn about each other by their slide over the distance of their centres.
    let (tight, loose) = (Near::Relative(1e-5), Near::Relative(1e-3));
    // Pulled to just below its strength, then beyond.
    let mut engine = pair::<S>(bonded);
    let [pull, _] = moved(&mut engine, across.times(0.99e5 / KN), 100);
    push("bonded, tension, N", "k_n A u", 0.99e5 * area, pull, tight);
    moved(&mut engine, across.times(0.02e5 / KN), 100);
    push("cracks past σ A", "1, in tension", 1.0, engine.cracks().len() as f64, Near::Exact);
    assert_eq!(engine.cracks()[0].mode, Mode::Tension);
    // Sheared under pressure, before and after the break.
    let mut engine = pair::<S>(bonded);
    let press = 0.5e5;
    moved(&mut engine, across.times(-press / KN), 10);
    let strength = 1.5e5 + 0.5 * press;
    let [normal, shear] = moved(&mut engine, along.times(0.99 * strength / KS), 100);
    push("bonded, shear, N", "k_s A s", 0.99 * strength * area, shear, tight);
    push("bonded, pressure meanwhile, N", "k_n A u", -press * area, normal, loose);
    let [normal, shear] = moved(&mut engine, along.times(0.02 * strength / KS), 100);
    assert_eq!(engine.cracks()[0].mode, Mode::Shear);
    push("after the break, N", "μ P", MU, -shear / normal, loose);
    // Slip with dilation at a held opening.
    let mut engine = pair::<S>(joint);
    let [before, _] = moved(&mut engine, across.times(-press / KN), 10);
    let slide = 1e-4;
    let [after, shear] = moved(&mut engine, along.times(slide), 1000);
    push("slip, shear, N", "μ P", MU, -shear / after, Near::Relative(1e-3));
    let slipped = slide - shear / (KS * area);
    push(
        "slip, added pressure, N",
        "k_n A s tan ψ",
        KN * area * slipped * DILATION,
        before - after,
        Near::Relative(1e-3),
    );
}

/// A block of bonded grains that came to rest on a row that is held, the joint between them, then under the weight of a plane of
/// that slope, with local damping: its way and its rise after `time`.
fn slid(slope: f64, joint: SmoothJoint, damping: f64, time: f64) -> [f64; 2] {
    let angle = atan(slope);
    let (columns, held) = (8, 24);
    let row = (0..held).map(|k| [f64::from(k), 0.0]);
    let block = (0..3 * columns).map(|k| [4.0 + f64::from(k % columns), 1.0 + f64::from(k / columns)]);
    let balls = row.chain(block).map(|x| Particle::ball(x, 0.5, 2000.0, GRAIN)).collect();
    let settings = Settings { gravity: [0.0, -9.81 * cos(angle)], ..Settings::default() };
    let law = Interaction {
        linear: Linear::direct(1e7, 1e7, 0.0),
        bond: Bond::Parallel(ParallelBond::new(1e8, 1.0, f64::INFINITY, f64::INFINITY)),
    };
    let mut engine = Engine::new(&model::<D2>(balls, vec![], law, settings)).unwrap();
    let fracture = Fracture { centre: [0.0, 0.5], normal: [0.0, 1.0], radius: f64::INFINITY, set: 0 };
    engine.lay_joints(&[fracture], &[joint], 1e-9).unwrap();
    engine.install_bonds(1e-9, 1).unwrap();
    let all: Vec<usize> = (0..held as usize).collect();
    engine.fix(&all, true, true).unwrap();
    let mean = |engine: &Engine<D2>, k: usize| {
        let block = held as usize..engine.particle_count();
        block.clone().map(|p| engine.position(p)[k]).sum::<f64>() / block.len() as f64
    };
    engine.advance(3000).unwrap();
    engine.set_damping(damping).unwrap();
    for p in held as usize..engine.particle_count() {
        engine.apply(p, [engine.mass(p) * 9.81 * sin(angle), 0.0], [0.0]).unwrap();
    }
    let start = [mean(&engine, 0), mean(&engine, 1)];
    // The step follows the contacts.
    let end = engine.time() + time;
    while engine.time() < end {
        engine.advance(1).unwrap();
    }
    [mean(&engine, 0) - start[0], mean(&engine, 1) - start[1]]
}

fn block(cases: &mut Vec<Case>) {
    let joint = SmoothJoint::new(1e8, 1e8, MU);
    let fall = |slope: f64| 9.81 * (sin(atan(slope)) - MU * cos(atan(slope)));
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("2D block: {what}"), source, expected, got, near));
    };
    let [way, _] = slid(0.9 * MU, joint, 0.7, 1.0);
    push("way at tan β = 0.9 μ over that of a free fall", "0", 0.0, way / (0.5 * 9.81), Near::Absolute(1e-3));
    // Some three diameters far, over grains that it did not stand on.
    let [way, rise] = slid(2.0 * MU, joint, 0.0, 1.5);
    let expected = 0.5 * fall(2.0 * MU) * 1.5 * 1.5;
    push("way at tan β = 2 μ, m", "g (sin β − μ cos β) t²/2", expected, way, Near::Relative(0.01));
    push("rise meanwhile over the way", "0", 0.0, rise / way, Near::Absolute(1e-3));
    let [way, rise] = slid(2.0 * MU, SmoothJoint { dilation: atan(0.05), ..joint }, 0.0, 0.5);
    push("with dilation, rise over the way", "tan ψ", 0.05, rise / way, Near::Absolute(2e-3));
}

#[test]
fn joints_have_the_same_bits_everywhere() {
    use dem::simd::Width;
    let run = |threads, width| {
        let mut engine = Engine::new(&crate::block::block::<D2>(20, 28, 2.0)).unwrap();
        let normal = [1.0, 0.6];
        let fracture = Fracture { centre: [8e-3, 1e-2], normal, radius: 6e-3, set: 0 };
        let joint = SmoothJoint {
            bond: Some(JointBond { tensile_strength: 1e6, ..bond() }),
            ..SmoothJoint::new(1e13, 5e12, MU)
        };
        assert!(engine.lay_joints(&[fracture], &[joint], 1e-5).unwrap() > 10);
        engine.install_bonds(1e-5, 7).unwrap();
        engine.absorb_overlaps();
        engine.track_energy();
        engine.set_threads(threads);
        engine.set_width(width);
        engine.advance(2200).unwrap();
        let imbalance = measure::energy(&engine).imbalance();
        assert!(imbalance.abs() < 0.01, "{imbalance}");
        crate::bits::digest(&engine)
    };
    let expected = run(1, Width::One);
    for (threads, width) in [(1, Width::Eight), (2, Width::Four), (3, Width::Eight)] {
        if width.available() {
            assert_eq!(run(threads, width), expected, "{threads} {width:?}");
        }
    }
}

#[test]
fn a_fracture_that_cannot_be_is_refused() {
    let mut engine = Engine::new(&crate::block::block::<D2>(4, 4, 0.0)).unwrap();
    let good = Fracture { centre: [0.0; 2], normal: [0.0, 1.0], radius: 1e-3, set: 0 };
    let joint = SmoothJoint::new(1e9, 1e9, 0.3);
    let mut refused = |fracture, joint, wanted: &str| {
        let text = engine.lay_joints(&[fracture], &[joint], 0.0).unwrap_err().to_string();
        assert!(text.contains(wanted), "{text}");
    };
    refused(Fracture { normal: [0.0; 2], ..good }, joint, "normal of a fracture");
    refused(Fracture { radius: 0.0, ..good }, joint, "radius of a fracture");
    refused(Fracture { set: 1, ..good }, joint, "joint of a fracture");
    refused(good, SmoothJoint { friction: -1.0, ..joint }, "friction");
}
