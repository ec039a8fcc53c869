//! Rigid clumps: mass and inertia of a union of discs or spheres, and free rotation.
//!
//! Two discs of radius R a distance d apart share a lens of area 2R² acos(d/2R) − (d/2) √(4R² − d²); the union's area is
//! 2πR² less that; spheres share π (4R + d)(2R − d)²/12. Discs far apart follow the parallel axis theorem. A free body keeps its angular momentum and energy;
//! a symmetric top's axis turns about the momentum with L/I₁.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::genesis::clump::union_moments;
use dem::space::Tuple;
use dem::*;
use math::elementary::{acos, atan2, sin_cos};
use std::f64::consts::PI;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Unit discs and spheres, density 1; three pebbles in free flight, 1000 or 25,000 steps of 1 ms. Spin and frame are half a step \
        apart, hence an error of the order of the step. The stone: 2 cm, 2700 kg/m³, 20 rad/s, read in the middle of the step.";
    Family { title: "Clumps", about, cases: &CASES }
}

#[test]
fn clumps_have_their_closed_forms() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = unions();
    solids(&mut cases);
    plane(&mut cases);
    tumbling(&mut cases);
    stone(&mut cases);
    precessing(&mut cases);
    cases
}

fn unions() -> Vec<Case> {
    let near = Near::Relative(1e-12);
    let (d, two) = (1.0_f64, union_moments(&[([0.0, 0.0], 1.0), ([1.0, 0.0], 1.0)]));
    let lens = 2.0 * acos(d / 2.0) - d / 2.0 * (4.0 - d * d).sqrt();
    let apart = union_moments(&[([-2.0, 0.0], 1.0), ([2.0, 0.0], 1.0)]);
    let covered = union_moments(&[([0.0, 0.0], 1.0), ([0.1, 0.0], 0.5)]);
    vec![
        Case::new("2D: area of two discs that overlap, m²", "2πR² − lens", 2.0 * PI - lens, two.area, near),
        Case::new("2D: centre of the two, m", "d/2", 0.5, two.centroid[0], near),
        Case::new(
            "2D: inertia of two discs apart, m⁴",
            "2(πR⁴/2 + πR² a²)",
            2.0 * (PI / 2.0 + 4.0 * PI),
            apart.polar,
            near,
        ),
        Case::new("2D: inertia of a disc that covers another, m⁴", "πR⁴/2", PI / 2.0, covered.polar, near),
    ]
}

/// A clump of unit spheres (discs) of density 1 at these places.
fn clump_of<S: Space>(places: &[[f64; 3]], radii: &[f64]) -> Clump<S> {
    let ball = |(x, &r): (&[f64; 3], &f64)| Particle::ball(Vector::<S>::build(|k| x[k]), r, 1.0, STONE);
    let balls: Vec<Particle<S>> = places.iter().zip(radii).map(ball).collect();
    Clump::of(&balls, &(0..places.len()).collect::<Vec<usize>>(), 1.0).unwrap()
}

/// Moments of inertia of two unit spheres a distance 2h apart about their axis and across it: each is a sphere cut off at
/// h from its centre, a stack of discs of radius √(1 − t²), t from −h to 1.
fn snowman(h: f64) -> [f64; 2] {
    let square = |t: f64| t - 2.0 * t.powi(3) / 3.0 + t.powi(5) / 5.0;
    let arm = |t: f64| h * h * t + h * t * t + (1.0 - h * h) * t.powi(3) / 3.0 - h * t.powi(4) / 2.0 - t.powi(5) / 5.0;
    let [disc, apart] = [square(1.0) - square(-h), arm(1.0) - arm(-h)];
    [PI * disc, 2.0 * PI * (0.25 * disc + apart)]
}

fn solids(cases: &mut Vec<Case>) {
    let near = Near::Relative(1e-6);
    let d = 1.0;
    let along = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let two = clump_of::<D3>(&[[4.0, 5.0, 6.0], [4.0 + d / 3.0, 5.0 + 2.0 * d / 3.0, 6.0 + 2.0 * d / 3.0]], &[1.0; 2]);
    let lens = PI * (4.0 + d) * (2.0 - d) * (2.0 - d) / 12.0;
    let [axial, across] = snowman(0.5 * d);
    let whole = 8.0 * PI / 3.0 - lens;
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("3D: {what}"), source, expected, got, near));
    };
    push("volume of two spheres that overlap, m³", "8πR³/3 − lens", whole, two.mass, near);
    push("centre of the two, x, m", "d/6", 4.0 + d / 6.0, two.centre[0], near);
    let turned = two.inertia.map(|row| row.dot(along));
    push("inertia about their axis, m⁵", "π ∫ (1 − t²)² dt", axial, turned.dot(along), near);
    let trace = two.inertia[0][0] + two.inertia[1][1] + two.inertia[2][2];
    push("inertia across it, m⁵", "2π ∫ (1 − t²)²/4 + (1 − t²)(t + d/2)² dt", across, 0.5 * (trace - axial), near);
    push("its product xy, m⁵", "(I₁ − I₂) n_x n_y", (axial - across) * along[0] * along[1], two.inertia[0][1], near);
    let apart = clump_of::<D3>(&[[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[1.0; 2]);
    let mass = 4.0 * PI / 3.0;
    let exact = 2.0 * mass * (0.4 + 4.0);
    push("inertia of two spheres apart, m⁵", "2 (2/5 m R² + m a²)", exact, apart.inertia[1][1], near);
    let covered = clump_of::<D3>(&[[0.0; 3], [0.1, 0.2, 0.0], [0.0; 3]], &[1.0, 0.5, 1.0]);
    push("inertia of a sphere that covers others, m⁵", "2/5 m R²", 0.4 * mass, covered.inertia[0][0], near);
    // Three in one another have no short closed form; slices along other directions must find the same body.
    let three = [[0.0; 3], [0.9, 0.1, 0.0], [0.3, 0.8, 0.4]];
    let radii = [1.0, 0.8, 0.6];
    let (sin, cos) = sin_cos(0.7);
    let turn = |x: &[f64; 3]| [cos * x[0] - sin * x[2], x[1], sin * x[0] + cos * x[2]];
    let (plain, turned) = (clump_of::<D3>(&three, &radii), clump_of::<D3>(&three.each_ref().map(turn), &radii));
    let cube = |c: &Clump<D3>| c.inertia.iter().flatten().map(|x| x * x).sum::<f64>();
    push("volume of three spheres, turned, m³", "the same", plain.mass, turned.mass, near);
    push("square of their inertia, turned, m¹⁰", "the same", cube(&plain), cube(&turned), near);
    let flat = clump_of::<D2>(&[[3.0, 0.0, 0.0], [4.0, 0.0, 0.0]], &[1.0; 2]);
    let lens = 2.0 * acos(0.5) - 0.5 * 3.0_f64.sqrt();
    cases.push(Case::new("2D: mass of a clump of two discs", "ρ (2πR² − lens)", 2.0 * PI - lens, flat.mass, near));
}

#[test]
fn a_clump_of_nothing_sound_is_refused() {
    let mut balls = vec![Particle::<D3>::ball([0.0; 3], 1.0, 1.0, STONE); 3];
    balls[1].radius = f64::NAN;
    let text = Clump::of(&balls, &[0, 1, 7], -1.0).unwrap_err().to_string();
    let expected = "clump 0: pebble 1 has a radius or position that is none; clump 0: pebble 7 does not exist; \
        clump 0: density is -1 kg/m^3, wanted a number above 0";
    assert_eq!(text, expected);
    let text = Clump::of(&balls, &[], 1.0).unwrap_err().to_string();
    assert_eq!(text, "clump 0: number of pebbles is 0, wanted at least 1");
}

fn lone<S: Space>(inertia: [[f64; 3]; 3], velocity: Vector<S>, spin: Spin<S>) -> Engine<S> {
    let place = |k: usize| Vector::<S>::build(|a| if a == k % S::DIMENSION { 0.4 } else { 0.1 * k as f64 });
    let particles = (0..3).map(|k| Particle::ball(place(k), 0.5, 1000.0, STONE)).collect();
    let clump = Clump { pebbles: vec![0, 1, 2], centre: Vector::<S>::zero(), velocity, spin, mass: 2.0, inertia };
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-3), ..Settings::default() };
    let model = Model { particles, clumps: vec![clump], walls: vec![], contacts: ContactTable::new(), settings };
    Engine::new(&model).unwrap()
}

fn plane(cases: &mut Vec<Case>) {
    let mut engine = lone::<D2>([[0.0; 3], [0.0; 3], [0.0, 0.0, 3.0]], [1.0, 2.0], [2.0]);
    let start = engine.position(0);
    engine.advance(1000).unwrap();
    let (sin, cos) = sin_cos(2.0);
    let expected = [1.0 + cos * start[0] - sin * start[1], 2.0 + sin * start[0] + cos * start[1]];
    // Cayley's map lags by (ω dt)³/12 a step.
    for (k, axis) in ["x", "y"].into_iter().enumerate() {
        let label = format!("2D: {axis} of a pebble of a body that flies and turns, m");
        cases.push(Case::new(label, "X + R(ωt) b", expected[k], engine.position(0)[k], Near::Absolute(1e-6)));
    }
    cases.push(Case::new("2D: its spin, rad/s", "unchanged", 2.0, engine.clump(0).spin[0], Near::Exact));
}

fn momentum(clump: &Clump<D3>) -> [f64; 3] {
    clump.inertia.map(|row| row.dot(clump.spin))
}

/// Spin close to the middle axis: the body tumbles (Dzhanibekov), momentum and energy stay.
fn tumbling(cases: &mut Vec<Case>) {
    let inertia = [[1.0, 0.1, 0.0], [0.1, 2.0, 0.05], [0.0, 0.05, 3.0]];
    let mut engine = lone::<D3>(inertia, [1.0, 2.0, 3.0], [0.05, 1.0, 0.02]);
    let energy = |clump: &Clump<D3>| 0.5 * momentum(clump).dot(clump.spin);
    let before = engine.clump(0);
    let (mut drift, mut gain, mut tumble) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..50 {
        engine.advance(500).unwrap();
        let now = engine.clump(0);
        tumble = tumble.max(now.spin[0].abs()).max(now.spin[2].abs());
        drift = drift.max(momentum(&now).minus(momentum(&before)).norm() / momentum(&before).norm());
        gain = gain.max((energy(&now) / energy(&before) - 1.0).abs());
    }
    let few = Near::Absolute(2e-3);
    cases.push(Case::new("3D: drift of a tumbling body's momentum", "0", 0.0, drift, few));
    cases.push(Case::new("3D: drift of its energy", "0", 0.0, gain, few));
    cases.push(Case::new("3D: spin off the middle axis, rad/s", "unstable", 0.3, tumble, Near::Above));
}

/// An asymmetric stone of a specimen in free flight at the time step of a campaign, 100,000 steps. Spin and momentum are those of
/// the middle of a step, so the inertia is the mean of those at its ends.
fn stone(cases: &mut Vec<Case>) {
    let mut clump = clump_of::<D3>(&[[0.0; 3], [9e-3, 1e-3, 0.0], [3e-3, 8e-3, 4e-3]], &[1e-2, 8e-3, 6e-3]);
    let (place, radius) = ([[0.0; 3], [9e-3, 1e-3, 0.0], [3e-3, 8e-3, 4e-3]], [1e-2, 8e-3, 6e-3]);
    let particles = (0..3).map(|k| Particle::ball(place[k], radius[k], 2700.0, STONE)).collect();
    (clump.mass, clump.inertia) = (2700.0 * clump.mass, clump.inertia.map(|row| row.times(2700.0)));
    (clump.velocity, clump.spin) = ([0.3, -0.2, 0.1], [4.0, 19.0, 3.0]);
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-5), ..Settings::default() };
    let model = Model { particles, clumps: vec![clump], walls: vec![], contacts: ContactTable::new(), settings };
    let mut engine = Engine::new(&model).unwrap();
    let mut look = || {
        engine.advance(999).unwrap();
        let before = engine.clump(0);
        engine.advance(1).unwrap();
        let now = engine.clump(0);
        let middle: [f64; 3] =
            std::array::from_fn(|k| 0.5 * (before.inertia[k].dot(now.spin) + now.inertia[k].dot(now.spin)));
        let linear = 0.5 * now.mass * now.velocity.dot(now.velocity);
        (middle, now.velocity.times(now.mass), linear + 0.5 * middle.dot(now.spin), now.spin)
    };
    let first = look();
    let off = |a: [f64; 3], b: [f64; 3]| a.minus(b).norm() / b.norm();
    let (mut worst, mut turned) = ([0.0_f64; 3], 0.0_f64);
    for _ in 1..100 {
        let now = look();
        let found = [off(now.0, first.0), off(now.1, first.1), (now.2 / first.2 - 1.0).abs()];
        worst = std::array::from_fn(|k| worst[k].max(found[k]));
        turned = turned.max(off(now.3, first.3));
    }
    let near = Near::Absolute(1e-6);
    let whats = ["angular momentum", "momentum", "energy"];
    for (what, worst) in whats.into_iter().zip(worst) {
        let label = format!("3D: drift of a stone's {what} in 100,000 steps of 10 µs");
        cases.push(Case::new(label, "0", 0.0, worst, near));
    }
    cases.push(Case::new("3D: change of its spin on the way", "asymmetric", 0.1, turned, Near::Above));
}

/// A symmetric top: in a time t the spin turns about the momentum by L t/I₁.
fn precessing(cases: &mut Vec<Case>) {
    let inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.6]];
    let spin = [0.3, 0.0, 1.0];
    let mut engine = lone::<D3>(inertia, [0.0; 3], spin);
    let whole = momentum(&engine.clump(0));
    let axis = whole.times(1.0 / whole.norm());
    let across = |w: [f64; 3]| w.minus(axis.times(w.dot(axis)));
    let first = across(spin);
    let second = D3::carried(axis, first);
    engine.advance(1000).unwrap();
    let now = across(engine.clump(0).spin);
    let turned = atan2(now.dot(second), now.dot(first));
    cases.push(Case::new("3D: turn of a top's spin in 1 s, rad", "L t/I₁", whole.norm(), turned, Near::Relative(2e-3)));
}
