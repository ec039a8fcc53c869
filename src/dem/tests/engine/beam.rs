//! The bonded cantilever against its exact discrete formula.
//!
//! N bonds of length l, first ball held, k̄_n = E/l, k̄_s = G/l, no spring: tip deflection under F
//! F L³/(3EI) (1 − 1/(4N²)) + F L/(GA), extension P L/(EA), tip rotation M L/(EI), twist T L/(GJ).

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

const BONDS: usize = 6;
const LENGTH: f64 = 1.0;
const YOUNG: f64 = 1e9;
const SHEAR: f64 = 4e8;
const NEAR: Near = Near::Relative(1e-5);

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Seven balls of radius 0.5 m in a row, six bonds, E 1 GPa, G 0.4 GPa, first ball held, damped to rest.";
    Family { title: "Bonded cantilever", about, cases: &CASES }
}

#[test]
fn beams_have_their_closed_forms() {
    family().check();
}

/// Tip displacement and tip rotation under a load on the last ball.
fn tip<S: Space>(force: Vector<S>, moment: Spin<S>) -> (Vector<S>, Spin<S>) {
    let place = |n: usize| along::<S>(0, LENGTH * n as f64);
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::PerArea { kn: YOUNG / LENGTH, ks: SHEAR / LENGTH },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    let soft = Interaction { linear: Linear::direct(1e-6, 1e-6, 0.0), bond: Bond::Parallel(bond) };
    let balls = (0..=BONDS).map(|n| Particle::ball(place(n), LENGTH / 2.0, 2000.0, GRAIN)).collect();
    let settings = Settings { damping: 0.5, ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], soft, settings)).unwrap();
    assert_eq!(engine.install_bonds(1e-9, 0).unwrap(), BONDS);
    engine.fix(&[0], true, true).unwrap();
    engine.apply(BONDS, force, moment).unwrap();
    let mut turned = Spin::<S>::zero();
    for _ in 0..30_000 {
        engine.advance(1).unwrap();
        turned = turned.plus(engine.spin(BONDS).times(engine.time_step()));
    }
    (engine.position(BONDS).minus(place(BONDS)), turned)
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    bent::<D2>(&mut cases);
    bent::<D3>(&mut cases);
    let polar = 2.0 * D3::GYRATION * D3::section(0.5) * 0.25;
    let (_, turned) = tip::<D3>([0.0; 3], [10.0, 0.0, 0.0]);
    let expected = 10.0 * BONDS as f64 * LENGTH / (SHEAR * polar);
    cases.push(Case::new("3D: twist, rad", "T L/(GJ)", expected, turned[0], NEAR));
    cases
}

fn bent<S: Space>(cases: &mut Vec<Case>) {
    let (n, span, name) = (BONDS as f64, BONDS as f64 * LENGTH, S::NAME);
    let area = S::section(LENGTH / 2.0);
    let inertia = S::GYRATION * area * LENGTH * LENGTH / 4.0;
    let still = Spin::<S>::zero();
    let (across, _) = tip::<S>(along::<S>(1, 10.0), still);
    let bending = 10.0 * span.powi(3) / (3.0 * YOUNG * inertia) * (1.0 - 1.0 / (4.0 * n * n));
    let expected = bending + 10.0 * span / (SHEAR * area);
    let source = "FL³/(3EI)(1−1/(4N²)) + FL/(GA), exact";
    cases.push(Case::new(format!("{name}: tip deflection, m"), source, expected, across.at(1), NEAR));
    let (pulled, _) = tip::<S>(along::<S>(0, 1e3), still);
    cases.push(Case::new(format!("{name}: extension, m"), "PL/(EA)", 1e3 * span / (YOUNG * area), pulled.at(0), NEAR));
    let (_, turned) = tip::<S>(along::<S>(0, 0.0), about::<S>(10.0));
    let expected = 10.0 * span / (YOUNG * inertia);
    cases.push(Case::new(format!("{name}: tip rotation, rad"), "ML/(EI)", expected, turning::<S>(turned), NEAR));
}
