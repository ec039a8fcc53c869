//! Measurements against states of which they are known: lattices, a moved block, columns under load.
//!
//! A lattice has z bonds a ball whose normals have the mean n_a n_b = δ_ab/d. Balls that move by v = L x have the velocity
//! gradient L in every region, and after a free flight of t the displacement gradient L t. Columns of balls between two
//! platens carry the platens' force: over a region that cuts between the balls σ = F/W, and every link bears F over the
//! number of columns.

use crate::block::*;
use crate::case::{Case, Family, Near};
use crate::lattice::{crystal, lattices};
use dem::measure::{self, Region};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "The lattices above, bonded. A block of 8 × 8 discs (8 × 8 × 8 spheres) that moves by v = L x, and its inner part. \
        Ten columns of ten balls of radius 0.5 m, k_n 1e6 N/m, pressed to a strain of 1e-3.";
    Family { title: "Measurements", about, cases: &CASES }
}

#[test]
fn measurements_find_what_is_there() {
    family().check();
}

/// Nothing to measure is no number, and not a panic.
#[test]
fn too_few_centres_have_no_gradient() {
    let engine = columns();
    let start: Vec<[f64; 2]> = (0..engine.particle_count()).map(|p| engine.position(p)).collect();
    let nowhere = Region::Ball { centre: [1e3, 0.0], radius: 1.0 };
    let line = Region::Block { low: [0.0, 0.0], high: [1.0, 10.0] };
    for region in [nowhere, line] {
        assert_eq!(measure::velocity_gradient(&engine, &region), None);
        assert_eq!(measure::displacement_gradient(&engine, &region, &start), None);
    }
    let block = Region::Block { low: [0.0, 0.0], high: [10.0, 10.0] };
    assert_eq!(measure::displacement_gradient(&engine, &block, &[]), None);
    assert_eq!(measure::displacement_gradient(&engine, &block, &start), Some([[0.0; 3]; 3]));
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (lattice, around) in lattices().iter().zip([6.0, 4.0, 6.0, 8.0, 12.0]) {
        let mut push = |what: &str, source, expected, got, near| {
            cases.push(Case::new(format!("{}: {what}", lattice.name), source, expected, got, near));
        };
        let law = Interaction { linear: Linear::direct(1e6, 4e5, 0.0), bond: endless() };
        let (found, fabric, axes) = if lattice.name.starts_with("2D") {
            let engine = crystal::<D2>(lattice, 1.0, law);
            (measure::coordination(&engine), measure::fabric(&engine), 2.0)
        } else {
            let engine = crystal::<D3>(lattice, 1.0, law);
            (measure::coordination(&engine), measure::fabric(&engine), 3.0)
        };
        push("bonds a ball", "z", around, found.bonds, Near::Exact);
        push("mean of n_y²", "1/d", 1.0 / axes, fabric[1][1], Near::Relative(1e-9));
        push("mean of n_x n_y", "0", 0.0, fabric[0][1], Near::Absolute(1e-9));
    }
    moved::<D2>(&mut cases);
    moved::<D3>(&mut cases);
    loaded(&mut cases);
    cases
}

fn endless() -> Bond {
    let endless = f64::INFINITY;
    Bond::Contact(ContactBond {
        tensile_strength: endless,
        shear_strength: endless,
        scatter: Scatter::default(),
        shear_break: ShearBreak::Keep,
    })
}

/// Balls apart from each other in homogeneous motion.
fn moved<S: Space>(cases: &mut Vec<Case>) {
    let rate = [[2e-3, 1e-3, -4e-4], [-5e-4, -3e-3, 6e-4], [1e-4, 2e-4, 1e-3]];
    let count = 8_usize.pow(S::DIMENSION as u32);
    let place = |p: usize| Vector::<S>::build(|k| 1.5 * (p / 8_usize.pow(k as u32) % 8) as f64);
    let start: Vec<Vector<S>> = (0..count).map(place).collect();
    let balls = start.iter().map(|&x| Particle::ball(x, 0.5, 2000.0, GRAIN)).collect();
    let law = Interaction::unbonded(Linear::direct(1e6, 4e5, 0.0));
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-2), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    for (p, x) in start.iter().enumerate() {
        let velocity = Vector::<S>::build(|a| (0..S::DIMENSION).map(|b| rate[a][b] * x.at(b)).sum());
        engine.set_motion(p, velocity, Spin::<S>::zero()).unwrap();
    }
    let region = Region::Ball { centre: Vector::<S>::build(|_| 5.25), radius: 4.0 };
    let velocity = measure::velocity_gradient(&engine, &region).unwrap();
    engine.advance(100).unwrap();
    let displacement = measure::displacement_gradient(&engine, &region, &start).unwrap();
    let mut push = |what: &str, source, expected, got| {
        cases.push(Case::new(format!("{}: {what}", S::NAME), source, expected, got, Near::Relative(1e-9)));
    };
    push("velocity gradient xx, 1/s", "L", rate[0][0], velocity[0][0]);
    push("velocity gradient xy, 1/s", "L", rate[0][1], velocity[0][1]);
    push("velocity gradient yx, 1/s", "L", rate[1][0], velocity[1][0]);
    push("strain yy after 1 s", "L t", rate[1][1], displacement[1][1]);
    let shear = 0.5 * (rate[0][1] + rate[1][0]);
    push("strain xy after 1 s", "(L_xy + L_yx) t/2", shear, 0.5 * (displacement[0][1] + displacement[1][0]));
    if S::DIMENSION == 3 {
        push("strain zz after 1 s", "L t", rate[2][2], displacement[2][2]);
    }
}

/// Ten columns of ten touching discs between platens.
fn columns() -> Engine<D2> {
    let place = |p: usize| [0.5 + (p % 10) as f64, 0.5 + (p / 10) as f64];
    let balls = (0..100).map(|p| Particle::ball(place(p), 0.5, 2000.0, GRAIN)).collect();
    let law = Interaction::unbonded(Linear::direct(1e6, 4e5, 0.0));
    let top = Wall { point: [0.0, 10.0], normal: [0.0, -1.0], motion: Motion::Velocity([0.0; 2]), group: PLATEN };
    Engine::new(&model::<D2>(balls, vec![floor(), top], law, Settings::default())).unwrap()
}

fn loaded(cases: &mut Vec<Case>) {
    let mut engine = columns();
    let start: Vec<[f64; 2]> = (0..100).map(|p| engine.position(p)).collect();
    let steps = 2000;
    let speed = 0.01 / (f64::from(steps) * engine.time_step());
    engine.move_wall(1, Motion::Velocity([0.0, -speed])).unwrap();
    engine.advance(steps as u64).unwrap();
    engine.move_wall(1, Motion::Velocity([0.0; 2])).unwrap();
    engine.advance(4000).unwrap();
    let force = engine.wall_force(1)[1];
    // Nine contacts between the balls and two at the platens, one after the other.
    let exact = 10.0 * 1e6 * 0.01 / 11.0;
    let region = Region::Block { low: [0.0, 2.5], high: [10.0, 7.5] };
    let stress = measure::stress(&engine, &region);
    let strain = measure::displacement_gradient(&engine, &region, &start).unwrap();
    let links = measure::links(&engine);
    let mean = links.iter().map(|link| link.normal).sum::<f64>() / links.len() as f64;
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("columns: {what}"), source, expected, got, near));
    };
    push("force on the platen, N", "10 k_n u/11", exact, force, Near::Relative(1e-6));
    let shorter = 1.0 - 0.01 / 11.0;
    push(
        "stress along, of a region, Pa",
        "F/W (1 − u/11 l): branches",
        force / 10.0 * shorter,
        stress[1][1],
        Near::Relative(1e-9),
    );
    push("stress across, Pa", "0", 0.0, stress[0][0], Near::Absolute(1e-6));
    push("strain along, of a region", "−u/11 l", -0.01 / 11.0, strain[1][1], Near::Relative(1e-6));
    push("links between the balls", "9 × 10", 90.0, links.len() as f64, Near::Exact);
    push("mean force of a link, N", "F/10", force / 10.0, mean, Near::Relative(1e-6));
    let around = measure::coordination(&engine);
    push("contacts a ball with others", "2 · 90/100", 1.8, around.contacts, Near::Relative(1e-12));
    push("share of balls with fewer than two contacts", "0: platens count", 0.0, around.rattlers, Near::Exact);
}
