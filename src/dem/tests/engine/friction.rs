//! Blocks and balls on a slope, and sliding that becomes rolling.
//!
//! Gravity is tilted instead of the floor. A block (a clump on two feet) keeps still below the angle of friction and
//! slides with g (sin θ − μ cos θ) above it. A ball rolls with g sin θ c/(1 + c), c = m R²/I (2 for a disc, 5/2 for a
//! sphere), if tan θ ≤ (1 + c) μ, and else slides with g (sin θ − μ cos θ) and ω' = c μ g cos θ / R. A ball that starts to
//! slide with v₀ on a level floor rolls from t = v₀/((1 + c) μ g) on with v = v₀ c/(1 + c).

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::elementary::sin_cos;
use std::sync::LazyLock;

const GRAVITY: f64 = 9.81;
const MU: f64 = 0.3;
const KN: f64 = 1e9;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "μ = 0.3, gravity 9.81 m/s², k_n 1e9 N/m; accelerations are 2 s/t² over 0.2 s from rest.";
    Family { title: "Friction", about, cases: &CASES }
}

#[test]
fn friction_has_its_closed_forms() {
    family().check();
}

fn law() -> Interaction {
    let dashpot = Dashpot { normal: 0.2, shear: 0.2, tensile: false };
    Interaction::unbonded(Linear { dashpot, ..Linear::direct(KN, KN, MU) })
}

fn settings<S: Space>(angle: f64) -> Settings<S> {
    let (sin, cos) = sin_cos(angle);
    let gravity = along::<S>(0, GRAVITY * sin).plus(along::<S>(1, -GRAVITY * cos));
    Settings { damping: 0.0, gravity, safety: 0.1, ..Settings::default() }
}

/// A ball of radius 0.1 m that rests on the floor with its own overlap.
fn ball<S: Space>(angle: f64) -> Engine<S> {
    let mut ball = Particle::ball(along::<S>(1, 0.1), 0.1, 2000.0, GRAIN);
    ball.position = along::<S>(1, 0.1 - ball.mass * GRAVITY * sin_cos(angle).1 / KN);
    Engine::new(&model::<S>(vec![ball], vec![floor()], law(), settings(angle))).unwrap()
}

/// Two pebbles as one block, 0.4 m apart and low enough not to topple.
fn block<S: Space>(angle: f64) -> Engine<S> {
    let feet = [along::<S>(0, -0.2), along::<S>(0, 0.2)];
    let up = along::<S>(1, 0.1);
    let particles: Vec<_> = feet.iter().map(|&x| Particle::ball(x.plus(up), 0.1, 2000.0, GRAIN)).collect();
    let mass = 2.0 * particles[0].mass;
    let inertia = std::array::from_fn(|a| std::array::from_fn(|b| if a == b { mass * 0.05 } else { 0.0 }));
    let (velocity, spin) = (Vector::<S>::zero(), Spin::<S>::zero());
    let clump = Clump { pebbles: vec![0, 1], centre: up, velocity, spin, mass, inertia };
    let mut model = model::<S>(particles, vec![floor()], law(), settings(angle));
    model.clumps.push(clump);
    Engine::new(&model).unwrap()
}

/// Steps of about `seconds`; how long they really were.
fn wait<S: Space>(engine: &mut Engine<S>, seconds: f64) -> f64 {
    let start = engine.time();
    while engine.time() < start + seconds {
        engine.advance(1).unwrap();
    }
    engine.time() - start
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    space::<D2>(2.0, &mut cases);
    space::<D3>(2.5, &mut cases);
    cases
}

fn space<S: Space>(c: f64, cases: &mut Vec<Case>) {
    let name = S::NAME;
    let acceleration = |mut engine: Engine<S>| {
        let start = engine.position(0).at(0);
        let time = wait(&mut engine, 0.2);
        (2.0 * (engine.position(0).at(0) - start) / (time * time), turning::<S>(engine.spin(0)) / time)
    };
    let near = Near::Relative(2e-3);
    let (sin, cos) = sin_cos(0.2);
    let (slid, _) = acceleration(block::<S>(0.2));
    cases.push(Case::new(
        format!("{name}: block below the angle of friction, m/s²"),
        "0",
        0.0,
        slid,
        Near::Absolute(1e-3),
    ));
    let (rolled, _) = acceleration(ball::<S>(0.2));
    let expected = GRAVITY * sin * c / (1.0 + c);
    cases.push(Case::new(format!("{name}: ball that rolls down, m/s²"), "g sin θ c/(1+c)", expected, rolled, near));
    let (sin_steep, cos_steep) = sin_cos(0.5);
    let expected = GRAVITY * (sin_steep - MU * cos_steep);
    let (slid, _) = acceleration(block::<S>(0.5));
    cases.push(Case::new(format!("{name}: block that slides, m/s²"), "g(sin θ − μ cos θ)", expected, slid, near));
    let (sin_wall, cos_wall) = sin_cos(1.2);
    let (slid, turned) = acceleration(ball::<S>(1.2));
    let expected = GRAVITY * (sin_wall - MU * cos_wall);
    cases.push(Case::new(
        format!("{name}: ball that slides on a steep slope, m/s²"),
        "g(sin θ − μ cos θ)",
        expected,
        slid,
        near,
    ));
    let expected = c * MU * GRAVITY * cos_wall / 0.1;
    cases.push(Case::new(format!("{name}: its spin, rad/s²"), "c μ g cos θ/R", expected, -turned, near));
    let _ = cos;
    let (start, mut engine) = (1.0, ball::<S>(0.0));
    engine.set_motion(0, along::<S>(0, start), Spin::<S>::zero()).unwrap();
    let slip = |e: &Engine<S>| e.velocity(0).at(0) + turning::<S>(e.spin(0)) * 0.1;
    while slip(&engine) > 1e-4 * start {
        engine.advance(1).unwrap();
    }
    let expected = start / ((1.0 + c) * MU * GRAVITY);
    cases.push(Case::new(
        format!("{name}: time until a sliding ball rolls, s"),
        "v₀/((1+c)μg)",
        expected,
        engine.time(),
        near,
    ));
    wait(&mut engine, 0.1);
    let (expected, got) = (start * c / (1.0 + c), engine.velocity(0).at(0));
    cases.push(Case::new(format!("{name}: its speed then, m/s"), "v₀ c/(1+c)", expected, got, near));
}
