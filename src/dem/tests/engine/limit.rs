//! The sharp limit of the explicit time step: rows of balls and a ball that turns, below and above it.
//!
//! Leapfrog carries a mode of frequency ω, with s = ω dt, by v' − 2 v + v° = −s² v. For s < 2 it is bounded, at most
//! 1/√(1 − s²/4) times the first velocity; for s > 2 it grows by λ = s²/2 − 1 + s/2 √(s² − 4) in every step, with changing
//! sign. The fastest mode of n equal masses in a free row is ω = 2 √(k/m) cos(π/2n), v_j ~ cos((j + 1/2)(n − 1)π/n); a ball
//! held at its centre and bonded at one point turns with ω = R √(k_s/I). Contact bonds without an end make the springs
//! linear; nothing damps.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::elementary::{cos, ln};
use std::f64::consts::PI;
use std::sync::LazyLock;

const KN: f64 = 1e6;
const KS: f64 = 1e3;
/// First velocity, m/s, or spin, rad/s.
const START: f64 = 1e-7;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Balls of radius 0.5 m and density 2000 kg/m³, contact bonds of endless strength, k_n 1e6 and k_s 1e3 N/m, no damping, \
        the step given. 2/ω is that of the fastest mode; velocities are over the first one (1e-7 m/s or rad/s).";
    Family { title: "Critical time step", about, cases: &CASES }
}

#[test]
fn the_critical_step_is_sharp() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in [2, 6] {
        row::<D2>(count, &mut cases);
        row::<D3>(count, &mut cases);
    }
    turning_ball::<D2>(&mut cases);
    turning_ball::<D3>(&mut cases);
    cases
}

/// A row of bonded balls at rest that touch, with a given step or the derived one.
fn bonded_row<S: Space>(count: usize, step: Option<f64>) -> Engine<S> {
    let place = |j: usize| along::<S>(0, j as f64);
    let balls = (0..count).map(|j| Particle::ball(place(j), 0.5, 2000.0, GRAIN)).collect();
    let endless = f64::INFINITY;
    let bond = ContactBond {
        tensile_strength: endless,
        shear_strength: endless,
        scatter: Scatter::default(),
        shear_break: ShearBreak::Keep,
    };
    let law = Interaction { linear: Linear::direct(KN, KS, 0.0), bond: Bond::Contact(bond) };
    let settings = Settings { damping: 0.0, fixed_step: step, ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    assert_eq!(engine.install_bonds(1e-9, 1).unwrap(), count - 1);
    engine
}

fn row<S: Space>(count: usize, cases: &mut Vec<Case>) {
    let n = count as f64;
    let mass = Particle::<S>::ball(along::<S>(0, 0.0), 0.5, 2000.0, GRAIN).mass;
    let omega = 2.0 * (KN / mass).sqrt() * cos(PI / (2.0 * n));
    let shape: Vec<f64> = (0..count).map(|j| cos((j as f64 + 0.5) * (n - 1.0) * PI / n)).collect();
    let whole: f64 = shape.iter().map(|x| x * x).sum();
    let make = |step| {
        let mut engine = bonded_row::<S>(count, step);
        for (j, x) in shape.iter().enumerate() {
            engine.set_motion(j, along::<S>(0, START * x), Spin::<S>::zero()).unwrap();
        }
        engine
    };
    let mode = |engine: &Engine<S>| {
        let share = shape.iter().enumerate().map(|(j, x)| x * engine.velocity(j).at(0));
        share.sum::<f64>() / whole / START
    };
    judged(&format!("{}, row of {count}", S::NAME), 2.0 / omega, make, mode, cases);
}

fn turning_ball<S: Space>(cases: &mut Vec<Case>) {
    let inertia = Particle::<S>::ball(along::<S>(0, 0.0), 0.5, 2000.0, GRAIN).inertia;
    let omega = 0.5 * (KS / inertia).sqrt();
    let make = |step| {
        let mut engine = bonded_row::<S>(2, step);
        engine.fix(&[0], true, true).unwrap();
        engine.fix(&[1], true, false).unwrap();
        engine.set_motion(1, Vector::<S>::zero(), about::<S>(START)).unwrap();
        engine
    };
    let spin = |engine: &Engine<S>| turning::<S>(engine.spin(1)) / START;
    judged(&format!("{}, turning ball", S::NAME), 2.0 / omega, make, spin, cases);
}

fn judged<S: Space>(
    name: &str,
    limit: f64,
    make: impl Fn(Option<f64>) -> Engine<S>,
    amplitude: impl Fn(&Engine<S>) -> f64,
    cases: &mut Vec<Case>,
) {
    let mut push = |what: String, source, expected, got, near| {
        cases.push(Case::new(format!("{name}: {what}"), source, expected, got, near));
    };
    push("derived step, s".to_owned(), "at most 2/ω", limit, make(None).time_step(), Near::Below);
    for share in [0.9, 0.99_f64] {
        let mut engine = make(Some(share * limit));
        let mut largest = 0.0_f64;
        for _ in 0..5000 {
            engine.advance(1).unwrap();
            largest = largest.max(amplitude(&engine).abs());
        }
        let expected = 1.0 / (1.0 - share * share).sqrt();
        let what = format!("largest velocity in 5000 steps of {share} · 2/ω");
        push(what, "1/√(1 − s²/4)", expected, largest, Near::Relative(1e-3));
    }
    for share in [1.001, 1.01, 1.2_f64] {
        let s = 2.0 * share;
        let growth = s * s / 2.0 - 1.0 + s / 2.0 * (s * s - 4.0).sqrt();
        let mut engine = make(Some(share * limit));
        // Far enough for the mode that dies out to be gone, and still small against the balls.
        engine.advance((ln(1e4) / ln(growth)).ceil() as u64).unwrap();
        let before = amplitude(&engine);
        engine.advance(1).unwrap();
        let what = format!("growth in a step of {share} · 2/ω");
        push(what, "−λ", -growth, amplitude(&engine) / before, Near::Relative(1e-6));
    }
}
