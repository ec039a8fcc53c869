//! Balls that hit a wall or each other: rebound, restitution, oblique impact.
//!
//! * Linear spring: contact time π √(m/k), largest overlap v √(m/k), with the effective mass m = m₁m₂/(m₁ + m₂).
//! * Local damping α: restitution √((1 − α)/(1 + α)).
//! * Dashpot β that may pull: restitution exp(−πβ/√(1 − β²)). One that may not loses contact when its force would pull:
//!   exp(−β/√(1 − β²) (π − atan(2β√(1 − β²)/(1 − 2β²)))), β < 1/√2.
//! * Oblique impact that slips throughout: v_t' = v_t − μ(1 + e) v_n, ω' R = c μ(1 + e) v_n with c = m R²/I (2 for a disc,
//!   5/2 for a sphere), if v_t/v_n > max(μ k_n/k_s, (1 + c) μ(1 + e)).

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::elementary::{atan, exp};
use std::sync::LazyLock;

const SPEED: f64 = 0.1;
const KN: f64 = 1e8;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    Family { title: "Impact", about: "A ball of radius 0.5 m against a wall, and two unequal balls.", cases: &CASES }
}

#[test]
fn impacts_have_their_closed_forms() {
    family().check();
}

fn linear(dashpot: Dashpot, friction: f64) -> Interaction {
    Interaction::unbonded(Linear { dashpot, ..Linear::direct(KN, KN, friction) })
}

/// A ball that hits the floor at the given speed along it, up to the step in which it has left; the engine and the
/// largest overlap.
fn dropped<S: Space>(law: Interaction, damping: f64, drift: f64) -> (Engine<S>, f64) {
    let settings = Settings { damping, safety: 0.01, ..Settings::default() };
    let ball = Particle::ball(along::<S>(1, 0.5), 0.5, 2000.0, GRAIN);
    let mut engine = Engine::new(&model::<S>(vec![ball], vec![floor()], law, settings)).unwrap();
    engine.set_motion(0, along::<S>(0, drift).plus(along::<S>(1, -SPEED)), Spin::<S>::zero()).unwrap();
    let mut deepest: f64 = 0.0;
    for _ in 0..100_000 {
        engine.advance(1).unwrap();
        let height = engine.position(0).at(1);
        deepest = deepest.max(0.5 - height);
        if height > 0.5 {
            break;
        }
    }
    (engine, deepest)
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    space::<D2>(2.0, &mut cases);
    space::<D3>(2.5, &mut cases);
    cases
}

fn space<S: Space>(c: f64, cases: &mut Vec<Case>) {
    let name = S::NAME;
    let (engine, deepest) = dropped::<S>(linear(Dashpot::default(), 0.0), 0.0, 0.0);
    let period = (engine.mass(0) / KN).sqrt();
    let time = Near::Relative(0.01);
    cases.push(Case::new(
        format!("{name}: contact time at a wall, s"),
        "π√(m/k)",
        std::f64::consts::PI * period,
        engine.time(),
        time,
    ));
    cases.push(Case::new(
        format!("{name}: largest overlap at a wall, m"),
        "v√(m/k)",
        SPEED * period,
        deepest,
        Near::Relative(1e-3),
    ));
    two_balls::<S>(cases);
    for alpha in [0.3, 0.7] {
        let (engine, _) = dropped::<S>(linear(Dashpot::default(), 0.0), alpha, 0.0);
        let expected = ((1.0 - alpha) / (1.0 + alpha)).sqrt();
        let got = engine.velocity(0).at(1) / SPEED;
        let label = format!("{name}: restitution by local damping α = {alpha}");
        cases.push(Case::new(label, "√((1−α)/(1+α)), CS79", expected, got, Near::Relative(5e-3)));
    }
    for (beta, tensile) in [(0.1, true), (0.4, true), (0.1, false), (0.4, false)] {
        let dashpot = Dashpot { normal: beta, shear: 0.0, tensile };
        let (engine, _) = dropped::<S>(linear(dashpot, 0.0), 0.0, 0.0);
        let root = (1.0_f64 - beta * beta).sqrt();
        let (early, source) = if tensile {
            (0.0, "exp(−πβ/√(1−β²)), PFC")
        } else {
            (atan(2.0 * beta * root / (1.0 - 2.0 * beta * beta)), "the same, left when the force is 0")
        };
        let expected = exp(-beta / root * (std::f64::consts::PI - early));
        let pull = if tensile { "may pull" } else { "may not pull" };
        let label = format!("{name}: restitution by a dashpot β = {beta} that {pull}");
        cases.push(Case::new(label, source, expected, engine.velocity(0).at(1) / SPEED, Near::Relative(5e-3)));
    }
    let (mu, drift) = (0.2, 0.5);
    let (engine, _) = dropped::<S>(linear(Dashpot::default(), mu), 0.0, drift);
    let impulse = mu * 2.0 * SPEED;
    let near = Near::Relative(1e-3);
    cases.push(Case::new(
        format!("{name}: oblique impact, speed along, m/s"),
        "v_t − μ(1+e)v_n",
        drift - impulse,
        engine.velocity(0).at(0),
        near,
    ));
    let rim = -turning::<S>(engine.spin(0)) * 0.5;
    cases.push(Case::new(format!("{name}: oblique impact, ωR, m/s"), "c μ(1+e)v_n", c * impulse, rim, near));
}

/// Two unequal balls head on: the exchange of momentum of an elastic impact, and the duration with the effective mass.
fn two_balls<S: Space>(cases: &mut Vec<Case>) {
    let balls = vec![
        Particle::ball(along::<S>(0, 0.0), 0.5, 2000.0, GRAIN),
        Particle::ball(along::<S>(0, 0.8), 0.3, 2000.0, GRAIN),
    ];
    let settings = Settings { damping: 0.0, safety: 0.01, ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], linear(Dashpot::default(), 0.0), settings)).unwrap();
    engine.set_motion(0, along::<S>(0, SPEED), Spin::<S>::zero()).unwrap();
    let (m1, m2) = (engine.mass(0), engine.mass(1));
    let gap = |e: &Engine<S>| e.position(1).minus(e.position(0)).norm() - 0.8;
    engine.advance(2).unwrap();
    while gap(&engine) < 0.0 {
        engine.advance(1).unwrap();
    }
    let effective = m1 * m2 / (m1 + m2);
    let period = std::f64::consts::PI * (effective / KN).sqrt();
    let name = S::NAME;
    let label = format!("{name}: contact time of two balls, s");
    cases.push(Case::new(label, "π√(m_eff/k)", period, engine.time(), Near::Relative(0.01)));
    let expected = 2.0 * m1 / (m1 + m2) * SPEED;
    let label = format!("{name}: speed of the ball that was hit, m/s");
    cases.push(Case::new(label, "2m₁/(m₁+m₂) v", expected, engine.velocity(1).at(0), Near::Relative(1e-4)));
}
