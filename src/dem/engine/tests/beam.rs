//! The bonded cantilever against its exact discrete formula.
//!
//! N bonds of length l, first ball held, k̄_n = E/l, k̄_s = G/l, no spring: tip deflection under F
//! F L³/(3EI) (1 − 1/(4N²)) + F L/(GA), extension P L/(EA), tip rotation M L/(EI), twist T L/(GJ).

use super::*;
use crate::dem::space::Tuple;

const BONDS: usize = 6;
const LENGTH: f64 = 1.0;
const YOUNG: f64 = 1e9;
const SHEAR: f64 = 4e8;

/// Tip displacement and tip rotation under a load on the last ball.
fn tip<S: Space>(force: Vector<S>, moment: Spin<S>) -> (Vector<S>, Spin<S>) {
    let place = |n: usize| Vector::<S>::build(|k| if k == 0 { LENGTH * n as f64 } else { 0.0 });
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::PerArea { kn: YOUNG / LENGTH, ks: SHEAR / LENGTH },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        deviation: 0.0,
    };
    let soft = Interaction { linear: Linear::direct(1e-6, 1e-6, 0.0), bond: Bond::Parallel(bond) };
    let model: Model<S> = Model {
        particles: (0..=BONDS).map(|n| Particle::ball(place(n), LENGTH / 2.0, 2000.0, GRAIN)).collect(),
        clumps: vec![],
        walls: vec![],
        contacts: ContactTable::new().with(GRAIN, GRAIN, soft),
        settings: Settings { damping: 0.5, ..Settings::default() },
    };
    let mut engine = Engine::new(&model).unwrap();
    assert_eq!(engine.install_bonds(1e-9, 0), BONDS);
    engine.fix(0, true, true);
    engine.apply(BONDS, force, moment);
    let mut turned = Spin::<S>::zero();
    for _ in 0..30_000 {
        engine.advance(1).unwrap();
        turned = turned.plus(engine.spin(BONDS).times(engine.time_step()));
    }
    (engine.position(BONDS).minus(place(BONDS)), turned)
}

fn check(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} against {expected}");
}

fn bent<S: Space>(area: f64, inertia: f64, axis: usize) {
    let (n, span) = (BONDS as f64, BONDS as f64 * LENGTH);
    let along = |k: usize, x: f64| Vector::<S>::build(|a| if a == k { x } else { 0.0 });
    let (tip_bent, _) = tip::<S>(along(1, 10.0), Spin::<S>::zero());
    let bending = 10.0 * span.powi(3) / (3.0 * YOUNG * inertia) * (1.0 - 1.0 / (4.0 * n * n));
    check(tip_bent.at(1), bending + 10.0 * span / (SHEAR * area));
    let (tip_pulled, _) = tip::<S>(along(0, 1e3), Spin::<S>::zero());
    check(tip_pulled.at(0), 1e3 * span / (YOUNG * area));
    let (_, turned) = tip::<S>(along(0, 0.0), Spin::<S>::build(|a| if a == axis { 10.0 } else { 0.0 }));
    check(turned.at(axis), 10.0 * span / (YOUNG * inertia));
}

#[test]
fn a_cantilever_bends_as_its_discrete_formula_says() {
    let r = LENGTH / 2.0;
    bent::<D2>(2.0 * r, 2.0 / 3.0 * r.powi(3), 0);
    let pi = std::f64::consts::PI;
    bent::<D3>(pi * r * r, 0.25 * pi * r.powi(4), 2);
}

#[test]
fn a_rod_of_spheres_twists_as_a_shaft() {
    let r = LENGTH / 2.0_f64;
    let polar = 0.5 * std::f64::consts::PI * r.powi(4);
    let (_, turned) = tip::<D3>([0.0; 3], [10.0, 0.0, 0.0]);
    check(turned[0], 10.0 * BONDS as f64 * LENGTH / (SHEAR * polar));
}
