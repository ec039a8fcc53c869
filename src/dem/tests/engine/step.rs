//! The time step: the diagonal estimate of simple bodies, and a packing below and above it.
//!
//! dt = s min(√(m/k), √(I/k_rot)), k_a = Σ k_s + (k_n − k_s) n_a², k_rot = Σ k_s r² and what bonds add. A ball on a wall:
//! √(m/k_n). An undamped packing must keep its energy at s = 0.8 and lose it well above the limit.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "k_n 1e6, k_s 4e5 N/m, safety 0.8. The packing: a bonded block of 20 × 28 discs (7 × 10 × 7 spheres) with a \
        clump, squeezed and let go, without damping, 20,000 steps.";
    Family { title: "Time step", about, cases: &CASES }
}

#[test]
fn the_time_step_is_the_diagonal_estimate() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    single::<D2>(&mut cases);
    single::<D3>(&mut cases);
    packing::<D2>(20, 28, &mut cases);
    packing::<D3>(7, 10, &mut cases);
    cases
}

fn single<S: Space>(cases: &mut Vec<Case>) {
    let (kn, ks) = (1e6, 4e5);
    let law = Interaction::unbonded(Linear::direct(kn, ks, 0.5));
    let near = Near::Relative(1e-12);
    let ball = |x: f64| Particle::<S>::ball(along::<S>(0, x).plus(along::<S>(1, 0.49)), 0.5, 2000.0, GRAIN);
    let step = |balls: Vec<Particle<S>>| {
        Engine::new(&model::<S>(balls, vec![floor()], law, Settings::default())).unwrap().time_step()
    };
    let (mass, inertia) = (ball(0.0).mass, ball(0.0).inertia);
    let turn = (inertia / (ks * 0.495 * 0.495)).sqrt();
    let expected = 0.8 * (mass / kn).sqrt().min(turn).min((inertia / (kn * 0.25)).sqrt());
    cases.push(Case::new(
        format!("{}: ball on a wall, s", S::NAME),
        "0.8 √(I/(k_n R²)): one contact",
        expected,
        step(vec![ball(0.0)]),
        near,
    ));
    // Three balls in a row on the floor: the middle one has two neighbours and the floor.
    let row = vec![ball(-1.0 + 1e-9), ball(0.0), ball(1.0 - 1e-9)];
    let (across, up) = (2.0 * kn + ks, 2.0 * ks + kn);
    let roll = 2.0 * ks * 0.25 + ks * 0.495 * 0.495;
    let least = (mass / across.max(up)).sqrt().min((inertia / roll.max(kn * 0.25)).sqrt());
    let label = format!("{}: middle one of three on a wall, s", S::NAME);
    cases.push(Case::new(label, "0.8 min(√(m/k), √(I/k_rot)), PFC", 0.8 * least, step(row), Near::Relative(1e-6)));
}

/// Energy of an undamped packing after many steps over that at the start.
fn growth<S: Space>(columns: usize, rows: usize, factor: f64) -> f64 {
    let mut model = block::<S>(columns, rows, 0.0);
    model.settings.damping = 0.0;
    for (a, b) in [(GRAIN, GRAIN), (GRAIN, STONE)] {
        let mut law = bonded();
        if let Bond::Parallel(bond) = &mut law.bond {
            (bond.tensile_strength, bond.cohesion) = (f64::INFINITY, f64::INFINITY);
        }
        model.contacts.set(a, b, law);
    }
    let step = {
        let mut engine = Engine::new(&model).unwrap();
        engine.install_bonds(1e-5, 7).unwrap();
        engine.time_step()
    };
    model.settings.fixed_step = Some(step / 0.8 * factor);
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-5, 7).unwrap();
    engine.absorb_overlaps();
    for p in 0..engine.particle_count() {
        let x = engine.position(p);
        engine.set_motion(p, x.times(-1.0), Spin::<S>::zero()).unwrap();
    }
    let total = |e: &Engine<S>| {
        let energy = measure::energy(e);
        energy.kinetic + energy.spring + energy.bond
    };
    engine.advance(1).unwrap();
    let start = total(&engine);
    match engine.advance(20_000) {
        Ok(()) => total(&engine) / start,
        Err(_) => f64::INFINITY,
    }
}

fn packing<S: Space>(columns: usize, rows: usize, cases: &mut Vec<Case>) {
    let label = |s: f64| format!("{}: energy of a packing at s = {s} over its start", S::NAME);
    cases.push(Case::new(label(0.8), "bounded, PFC", 1.05, growth::<S>(columns, rows, 0.8), Near::Below));
    cases.push(Case::new(label(3.0), "unbounded", 1e3, growth::<S>(columns, rows, 3.0), Near::Above));
}
