//! Rigid clumps: mass and inertia of a union of discs, and free rotation.
//!
//! Two discs of radius R a distance d apart share a lens of area 2R² acos(d/2R) − (d/2) √(4R² − d²); the union's area is
//! 2πR² less that. Discs far apart follow the parallel axis theorem. A free body keeps its angular momentum and energy;
//! a symmetric top's axis turns about the momentum with L/I₁.

use crate::block::*;
use crate::case::{Case, Family, Near};
use flow::dem::genesis::clump::union_moments;
use flow::dem::space::Tuple;
use flow::dem::*;
use flow::math::elementary::{acos, atan2, sin_cos};
use std::f64::consts::PI;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Unit discs; three pebbles in free flight, 1000 or 25,000 steps of 1 ms. Spin and frame are half a step \
        apart, hence an error of the order of the step.";
    Family { title: "Clumps", about, cases: &CASES }
}

#[test]
fn clumps_have_their_closed_forms() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = unions();
    plane(&mut cases);
    tumbling(&mut cases);
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
