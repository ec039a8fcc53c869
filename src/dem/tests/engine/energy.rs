//! The energy balance close: stored + spent = initial + given.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::*;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "What the books fail to explain over all that went through them: a bonded block with a clump crushed between \
        platens past its peak, local damping 0.3, dashpots and friction (20 × 28 discs, 7 × 10 × 7 spheres), and a disc that \
        falls, slips and bounces.";
    Family { title: "Energy balance", about, cases: &CASES }
}

#[test]
fn the_books_close() {
    family().check();
}

fn cases() -> Vec<Case> {
    let few = Near::Absolute(0.01);
    let point = Bond::Contact(ContactBond {
        tensile_strength: 20e6,
        shear_strength: 20e6,
        scatter: Scatter::both(0.2),
        shear_break: ShearBreak::Keep,
    });
    let row = |name: &str, imbalance: f64| Case::new(name, "0, at most 1 %", 0.0, imbalance, few);
    vec![
        row("2D: test to failure, parallel bond", crushed(block::<D2>(20, 28, 2.0), bonded().bond, 2200)),
        row("3D: test to failure, parallel bond", crushed(block::<D3>(7, 10, 2.0), bonded().bond, 900)),
        row("2D: test to failure, contact bond", crushed(block::<D2>(20, 28, 2.0), point, 2200)),
        row("3D: test to failure, contact bond", crushed(block::<D3>(7, 10, 2.0), point, 900)),
        row("2D: test to failure, flat joint", crushed(block::<D2>(20, 28, 2.0), jointed(), 2200)),
        row("3D: test to failure, flat joint", crushed(block::<D3>(7, 10, 2.0), jointed(), 900)),
        row("2D: disc that falls, slips and bounces", bouncing()),
    ]
}

fn crushed<S: Space>(mut model: Model<S>, bond: Bond, steps: u64) -> f64 {
    let dashpot = Dashpot { normal: 0.1, shear: 0.1, tensile: false };
    let linear = Linear { dashpot, ..Linear::modulus(20e9, 2.5, 0.5) };
    for other in [GRAIN, STONE] {
        model.contacts.set(GRAIN, other, Interaction { linear, bond });
    }
    model.settings.damping = 0.3;
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-5, 7).unwrap();
    engine.absorb_overlaps();
    engine.track_energy();
    engine.advance(steps).unwrap();
    assert!(engine.cracks().len() > 30, "{} cracks", engine.cracks().len());
    let energy = measure::energy(&engine);
    let spent = [energy.damping, energy.slip, energy.dashpot, energy.broken, energy.boundary, energy.kinetic];
    assert!(spent.iter().all(|&e| e > 0.0), "{energy:?}");
    energy.imbalance()
}

/// The largest imbalance on the way.
fn bouncing() -> f64 {
    let settings =
        Settings { damping: 0.2, gravity: [0.0, -9.81], safety: 0.02, overlap_limit: 1.0, ..Settings::default() };
    let law = Interaction::unbonded(Linear::direct(1e7, 1e7, 0.5));
    let ball = Particle::ball([0.0, 0.6], 0.5, 2000.0, GRAIN);
    let mut engine = Engine::<D2>::new(&model(vec![ball], vec![floor()], law, settings)).unwrap();
    engine.set_motion(0, [0.1, 0.0], [0.0]).unwrap();
    engine.track_energy();
    let mut worst: f64 = 0.0;
    for _ in 0..40 {
        engine.advance(1000).unwrap();
        worst = worst.max(measure::energy(&engine).imbalance().abs());
    }
    assert!(measure::energy(&engine).slip > 0.0);
    worst
}

#[test]
fn the_books_do_not_depend_on_threads() {
    let model = block::<D2>(20, 28, 2.0);
    let run = |threads| {
        let mut engine = Engine::new(&model).unwrap();
        engine.install_bonds(1e-5, 7).unwrap();
        engine.track_energy();
        engine.set_threads(threads);
        engine.advance(1000).unwrap();
        measure::energy(&engine)
    };
    assert_eq!(run(1), run(3));
}

/// A run that is granted more threads and loses them again, in the middle of a stretch, has the books of one that has one.
#[test]
fn the_books_do_not_depend_on_when_the_threads_change() {
    let model = block::<D2>(20, 28, 2.0);
    let run = |threads: [usize; 4]| {
        let mut engine = Engine::new(&model).unwrap();
        engine.install_bonds(1e-5, 7).unwrap();
        engine.track_energy();
        for threads in threads {
            engine.set_threads(threads);
            engine.advance(331).unwrap();
        }
        measure::energy(&engine)
    };
    let alone = run([1; 4]);
    assert!(alone.damping > 0.0 && alone.boundary != 0.0);
    for threads in [[1, 3, 3, 1], [2, 1, 4, 3]] {
        assert_eq!(run(threads), alone, "{threads:?}");
    }
}
