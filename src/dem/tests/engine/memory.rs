//! What contacts remember: reference gaps outlive a loss of contact, renewals of the list change nothing.

use crate::block::*;
use dem::*;

/// A ball on a floor with an overlap that was taken as the state of rest.
fn resting() -> Engine<D2> {
    let floor = Wall { point: [0.0, 0.0], normal: [0.0, 1.0], motion: Motion::Velocity([0.0; 2]), group: PLATEN };
    let linear = Interaction::unbonded(Linear::direct(1e7, 1e7, 0.0));
    let model: Model<D2> = Model {
        particles: vec![
            Particle::ball([0.0, 0.49], 0.5, 2000.0, GRAIN),
            Particle::ball([0.97, 0.49], 0.5, 2000.0, GRAIN),
        ],
        clumps: vec![],
        walls: vec![floor],
        contacts: ContactTable::new().with(GRAIN, GRAIN, linear).with(GRAIN, PLATEN, linear),
        settings: Settings { damping: 0.0, ..Settings::default() },
    };
    let mut engine = Engine::new(&model).unwrap();
    engine.absorb_overlaps();
    engine
}

#[test]
fn a_reference_gap_outlives_a_loss_of_contact() {
    let mut engine = resting();
    engine.fix(&[0], true, true).unwrap();
    engine.advance(10).unwrap();
    assert_eq!(engine.wall_force(0), [0.0, 0.0]);
    // The first ball rises by a third of its radius, far beyond the margin, and comes back.
    let steps = (0.15 / engine.time_step()).round() as u64;
    for up in [1.0, -1.0] {
        engine.set_motion(0, [0.0, up], [0.0]).unwrap();
        engine.advance(steps).unwrap();
    }
    engine.set_motion(0, [0.0, 0.0], [0.0]).unwrap();
    engine.advance(1).unwrap();
    assert!(engine.contacts().all(|c| c.reference < -0.009), "a reference gap was lost");
    assert!(engine.wall_force(0)[1].abs() < 1.0, "{:?}", engine.wall_force(0));
    // Pressed in further, only the new overlap counts.
    engine.set_motion(0, [0.0, -1.0], [0.0]).unwrap();
    engine.advance(10).unwrap();
    engine.set_motion(0, [0.0, 0.0], [0.0]).unwrap();
    engine.advance(1).unwrap();
    let pressed = 0.49 - engine.position(0)[1];
    assert!((engine.wall_force(0)[1] / (-1e7 * pressed) - 1.0).abs() < 1e-6);
}

#[test]
fn renewing_the_list_changes_no_bit() {
    let run = |threads: &[usize]| {
        let mut engine = Engine::new(&block::<D2>(20, 20, 1.0)).unwrap();
        engine.install_bonds(1e-5, 7).unwrap();
        for &threads in threads {
            // Dealing the contacts out anew is what a renewal does to their state.
            engine.set_threads(threads);
            engine.advance(400).unwrap();
        }
        (engine.wall_force(0), engine.position(17), engine.cracks().len())
    };
    assert_eq!(run(&[1, 1, 1, 1, 1]), run(&[1, 2, 5, 1, 3]));
}

#[test]
fn equal_steps_keep_the_mass_and_lengthen_the_step() {
    let mut model = block::<D2>(20, 20, 1.0);
    let mut step = |masses| {
        model.settings.masses = masses;
        let mut engine = Engine::new(&model).unwrap();
        engine.install_bonds(1e-5, 7).unwrap();
        let total: f64 = (0..engine.particle_count()).map(|p| engine.moving_mass(p)[0]).sum();
        (engine.time_step(), total)
    };
    let (real, equal) = (step(Masses::Real), step(Masses::EqualStep));
    assert!((real.1 / equal.1 - 1.0).abs() < 1e-12, "{real:?} {equal:?}");
    assert!(equal.0 > 1.1 * real.0, "{real:?} {equal:?}");
}
