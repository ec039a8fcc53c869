//! The books of energy close, and no law makes energy.

use super::*;

fn closes<S: Space>(mut model: Model<S>, bond: Bond, steps: u64) -> measure::Energy {
    let linear =
        Linear { dashpot: Dashpot { normal: 0.1, shear: 0.1, tensile: false }, ..Linear::modulus(20e9, 2.5, 0.5) };
    for other in [GRAIN, STONE] {
        model.contacts.set(GRAIN, other, Interaction { linear, bond });
    }
    model.settings.damping = 0.3;
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-5, 7);
    engine.absorb_overlaps();
    engine.keep_books();
    engine.advance(steps).unwrap();
    assert!(engine.cracks().len() > 30, "{} cracks", engine.cracks().len());
    let energy = measure::energy(&engine);
    println!("{energy:?}");
    assert!(energy.imbalance().abs() < 0.01, "{} of {energy:?}", energy.imbalance());
    let spent = [energy.damping, energy.slip, energy.dashpot, energy.broken, energy.boundary, energy.kinetic];
    assert!(spent.iter().all(|&e| e > 0.0), "{energy:?}");
    energy
}

fn parallel() -> Bond {
    bonded().bond
}

fn point() -> Bond {
    Bond::Contact(ContactBond {
        tensile_strength: 20e6,
        shear_strength: 20e6,
        deviation: 0.2,
        shear_break: ShearBreak::Keep,
    })
}

#[test]
fn the_books_close_in_a_test_to_failure() {
    closes(block::<D2>(20, 28, 2.0), parallel(), 2200);
    closes(block::<D3>(7, 10, 2.0), parallel(), 900);
    closes(block::<D2>(20, 28, 2.0), point(), 2200);
    closes(block::<D3>(7, 10, 2.0), point(), 900);
}

#[test]
fn the_books_do_not_depend_on_threads() {
    let model = block::<D2>(20, 28, 2.0);
    let run = |threads| {
        let mut engine = Engine::new(&model).unwrap();
        engine.install_bonds(1e-5, 7);
        engine.keep_books();
        engine.set_threads(threads);
        engine.advance(1000).unwrap();
        measure::energy(&engine)
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn a_ball_that_falls_and_bounces_balances_its_books() {
    let floor = Wall { point: [0.0, 0.0], normal: [0.0, 1.0], motion: Motion::Velocity([0.0; 2]), group: PLATEN };
    let settings =
        Settings { damping: 0.2, gravity: [0.0, -9.81], safety: 0.02, overlap_limit: 1.0, ..Settings::default() };
    let model: Model<D2> = Model {
        particles: vec![Particle::ball([0.0, 0.6], 0.5, 2000.0, GRAIN)],
        clumps: vec![],
        walls: vec![floor],
        contacts: ContactTable::new().with(GRAIN, PLATEN, Interaction::unbonded(Linear::direct(1e7, 1e7, 0.5))),
        settings,
    };
    let mut engine = Engine::new(&model).unwrap();
    engine.set_motion(0, [0.1, 0.0], [0.0]);
    engine.keep_books();
    for _ in 0..40 {
        engine.advance(1000).unwrap();
        let energy = measure::energy(&engine);
        assert!(energy.imbalance().abs() < 0.01, "{} of {energy:?}", energy.imbalance());
    }
    assert!(measure::energy(&engine).slip > 0.0);
}
