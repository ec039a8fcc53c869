//! A bonded pair that is loaded and then turned as a whole, once around: forces and moments keep their sizes.
//!
//! The balls are so heavy that the bond does not move them; a load on each bends its path to the circle, so that the
//! velocity of a step is the chord from one place to the next. Chords against arcs leave an error of the order of
//! steps⁻².

use crate::block::{GRAIN, about, along};
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

const STEPS: u32 = 20_000;
const STEP: f64 = 1e-3;
const MASS: f64 = 1e24;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Two balls of radius 0.5 m, bonded in parallel or by a flat joint, k̄_n 1e9 and k̄_s 5e8 Pa/m, loaded by a displacement and a rotation, then turned once about their middle in 20,000 steps: size after over size before.";
    Family { title: "A rigidly turned pair", about, cases: &CASES }
}

#[test]
fn a_rigid_turn_keeps_forces_and_moments() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (law, bond) in [("", cement()), ("flat joint, ", joint())] {
        turned::<D2>(&mut cases, bond, &format!("{law}about z"), [0.0, 0.0, 1.0]);
        turned::<D3>(&mut cases, bond, &format!("{law}about z"), [0.0, 0.0, 1.0]);
        turned::<D3>(&mut cases, bond, &format!("{law}about its own axis"), [1.0, 0.0, 0.0]);
        turned::<D3>(&mut cases, bond, &format!("{law}about an oblique axis"), [0.48, 0.6, 0.64]);
    }
    cases
}

fn joint() -> Bond {
    let stiffness = BondStiffness::PerArea { kn: 1e9, ks: 5e8 };
    Bond::Flat(FlatJoint { stiffness, ..FlatJoint::new(1.0, 1.0, f64::INFINITY, f64::INFINITY) })
}

fn cement() -> Bond {
    Bond::Parallel(ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::PerArea { kn: 1e9, ks: 5e8 },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    })
}

fn pair<S: Space>(bond: Bond) -> Engine<S> {
    let ball = |x: f64| {
        let mut ball = Particle::<S>::ball(along::<S>(0, x), 0.5, 1.0, GRAIN);
        (ball.mass, ball.inertia) = (MASS, MASS);
        ball
    };
    let law = Interaction { linear: Linear::direct(1e-9, 1e-9, 0.0), bond };
    let settings = Settings { damping: 0.0, fixed_step: Some(STEP), ..Settings::default() };
    let contacts = ContactTable::new().with(GRAIN, GRAIN, law);
    let particles = vec![ball(-0.5), ball(0.5)];
    let model = Model { particles, clumps: vec![], walls: vec![], contacts, settings };
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-9, 1).unwrap();
    engine
}

/// Normal force, shear force, bending moment and twist of the one contact.
fn sizes<S: Space>(engine: &Engine<S>) -> [f64; 4] {
    let contact = engine.contacts().next().unwrap();
    let force = contact.cement;
    let normal = force.dot(contact.normal);
    let shear = force.minus(contact.normal.times(normal)).norm();
    let bend = (contact.moment.dot(contact.moment) - contact.twist * contact.twist).max(0.0).sqrt();
    [normal.abs(), shear, bend, contact.twist.abs()]
}

fn turned<S: Space>(cases: &mut Vec<Case>, bond: Bond, name: &str, axis: [f64; 3]) {
    let mut engine = pair::<S>(bond);
    // One step of loading moves the second ball away, aside and around.
    let vector = |x: [f64; 3]| Vector::<S>::build(|k| x[k]);
    let aside = if S::DIMENSION == 2 { 0.0 } else { 5e-5 };
    let spin =
        if S::DIMENSION == 2 { about::<S>(5e-5 / STEP) } else { Spin::<S>::build(|k| [3e-5, 4e-5, 5e-5][k] / STEP) };
    engine.set_motion(1, vector([1e-5, 1e-4, aside]).times(1.0 / STEP), spin).unwrap();
    engine.advance(1).unwrap();
    engine.calm();
    engine.advance(1).unwrap();
    let before = sizes(&engine);
    let places = [0, 1].map(|p| engine.position(p));
    let middle = places[0].plus(places[1]).times(0.5);
    let angle = std::f64::consts::TAU / f64::from(STEPS);
    let at = |p: usize, step: u32| middle.plus(around::<S>(axis, places[p].minus(middle), angle * f64::from(step)));
    let rate = if S::DIMENSION == 2 { about::<S>(angle / STEP) } else { Spin::<S>::build(|k| axis[k] * angle / STEP) };
    // The forces of a step know the velocity that led to its place, so a last step at rest books the last chord.
    for step in 0..=STEPS {
        for p in 0..2 {
            let (next, spin) = if step < STEPS {
                (at(p, step + 1).minus(at(p, step)).times(1.0 / STEP), rate)
            } else {
                (Vector::<S>::zero(), Spin::<S>::zero())
            };
            let push = next.minus(engine.velocity(p)).times(MASS / STEP);
            engine.apply(p, push, spin.minus(engine.spin(p)).times(MASS / STEP)).unwrap();
        }
        engine.advance(1).unwrap();
    }
    let after = sizes(&engine);
    for (k, what) in ["normal force", "shear force", "bending moment", "twisting moment"].into_iter().enumerate() {
        if before[k] > 0.0 {
            let label = format!("{}, {name}: {what}", S::NAME);
            cases.push(Case::new(label, "unchanged", 1.0, after[k] / before[k], Near::Relative(2e-3)));
        }
    }
}

/// A vector turned by `angle` about an axis (Rodrigues).
fn around<S: Space>(axis: [f64; 3], x: Vector<S>, angle: f64) -> Vector<S> {
    let (sin, cos) = math::elementary::sin_cos(angle);
    let x = [0, 1, 2].map(|k| if k < S::DIMENSION { x.at(k) } else { 0.0 });
    let cross = D3::moment(axis, x);
    let share = axis.dot(x) * (1.0 - cos);
    Vector::<S>::build(|k| x[k] * cos + cross[k] * sin + axis[k] * share)
}
