//! The incremental form of the normal force beside the absolute one: F ← max(0, F − k_n Δg) while the surfaces overlap.
//!
//! Two overlapping balls at rest (the overlap absorbed) are pressed by d, let go by 2d and pressed by d/2. The absolute
//! spring finds its reference gap again and carries nothing; the incremental one grips at once. A stiffness that changes
//! leaves the incremental force as it is; the absolute one follows.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

const KN: f64 = 1e6;
const WAY: f64 = 1e-3;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "k_n 1e6 N/m, d = 1 mm, overlap absorbed 0.1 m; then k_n is doubled and d/2 more pressed.";
    Family { title: "Absolute and incremental normal force", about, cases: &CASES }
}

#[test]
fn the_incremental_spring_grips_where_it_was_let_go() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for normal_force in [NormalForce::Absolute, NormalForce::Incremental] {
        forces::<D2>(normal_force, &mut cases);
        forces::<D3>(normal_force, &mut cases);
    }
    cases
}

fn forces<S: Space>(normal_force: NormalForce, cases: &mut Vec<Case>) {
    let law = |kn| Interaction::unbonded(Linear { normal_force, ..Linear::direct(kn, kn, 0.0) });
    let balls = [0.0, 0.9].map(|x| Particle::ball(along::<S>(0, x), 0.5, 2000.0, GRAIN)).to_vec();
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-3), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law(KN), settings)).unwrap();
    engine.absorb_overlaps();
    engine.fix(&[0, 1], true, true).unwrap();
    let force = |e: &Engine<S>| e.contacts().map(|c| c.force().norm()).sum::<f64>();
    let press = |e: &mut Engine<S>, way: f64| {
        e.set_motion(1, along::<S>(0, -way / 0.1), Spin::<S>::zero()).unwrap();
        e.advance(100).unwrap();
        e.set_motion(1, Vector::<S>::zero(), Spin::<S>::zero()).unwrap();
        e.advance(1).unwrap();
        force(e)
    };
    let incremental = normal_force == NormalForce::Incremental;
    let pressed = press(&mut engine, WAY);
    let freed = press(&mut engine, -2.0 * WAY);
    let gripped = press(&mut engine, 0.5 * WAY);
    engine.set_contacts(&ContactTable::new().with(GRAIN, GRAIN, law(2.0 * KN))).unwrap();
    let stiffer = force(&engine);
    let last = press(&mut engine, 0.5 * WAY);
    let either = |yes: f64| if incremental { yes * KN * WAY } else { 0.0 };
    let rows = [
        ("pressed by d, N", KN * WAY, pressed),
        ("let go by 2d, N", 0.0, freed),
        ("pressed by d/2, N", either(0.5), gripped),
        ("k_n doubled, N", either(0.5), stiffer),
        ("pressed by d/2 more, N", either(1.5), last),
    ];
    for (what, expected, got) in rows {
        let name = format!("{}, {normal_force:?}: {what}", S::NAME);
        cases.push(Case::new(name, "F − k_n Δg, PFC", expected, got, Near::Absolute(1e-6 * KN * WAY)));
    }
}
