//! The same bits for every number of threads and every lane width.

use crate::block::*;
use dem::simd::Width;
use dem::*;

/// blake3 of everything a run leaves.
pub(crate) fn digest<S: Space>(engine: &Engine<S>) -> String {
    use dem::space::Tuple;
    let mut hash = blake3::Hasher::new();
    let mut put = |x: f64| {
        hash.update(&x.to_bits().to_le_bytes());
    };
    put(engine.time());
    for p in 0..engine.particle_count() {
        for k in 0..S::DIMENSION {
            put(engine.position(p).at(k));
            put(engine.velocity(p).at(k));
        }
        put(engine.spin(p).norm());
    }
    for w in 0..2 {
        put(engine.wall_force(w).at(1));
        put(engine.wall_point(w).at(1));
    }
    for crack in engine.cracks() {
        put(crack.step as f64);
        put(crack.particle as f64);
        put(crack.gap);
        put(crack.position.at(0));
    }
    for contact in engine.contacts() {
        put(contact.gap);
        put(contact.force().at(0));
        put(contact.moment.at(0));
    }
    hash.finalize().to_hex().to_string()
}

/// A compression test past its peak; pieces of `every` steps must not matter either.
fn compressed<S: Space>(model: &Model<S>, steps: u64, every: u64, threads: usize, width: Width) -> Engine<S> {
    let mut engine = Engine::new(model).unwrap();
    engine.install_bonds(1e-5, 7).unwrap();
    engine.absorb_overlaps();
    engine.set_threads(threads);
    engine.set_width(width);
    engine.run(steps, every, |_| Watch::Continue).unwrap();
    engine
}

fn same_everywhere<S: Space>(model: &Model<S>, steps: u64) {
    let reference = compressed(model, steps, 1000, 1, Width::One);
    let bonds = reference.bond_count();
    assert!(reference.cracks().len() > 30, "only {} cracks, {bonds} bonds left", reference.cracks().len());
    let expected = digest(&reference);
    for (threads, width) in [(1, Width::Four), (1, Width::Eight), (2, Width::One), (2, Width::Eight), (8, Width::Four)]
    {
        if !width.available() {
            continue;
        }
        let found = digest(&compressed(model, steps, 77, threads, width));
        assert_eq!(found, expected, "{threads} threads, {width:?}");
    }
}

#[test]
fn a_test_to_failure_in_the_plane_has_the_same_bits_everywhere() {
    same_everywhere(&block::<D2>(20, 28, 2.0), 2200);
}

#[test]
fn a_test_to_failure_in_space_has_the_same_bits_everywhere() {
    same_everywhere(&block::<D3>(7, 10, 2.0), 900);
}

/// The model with flat joints in place of the parallel bonds.
fn with_joints<S: Space>(mut model: Model<S>) -> Model<S> {
    for other in [GRAIN, STONE] {
        model.contacts.set(GRAIN, other, Interaction { bond: jointed(), ..bonded() });
    }
    model
}

#[test]
fn flat_joints_have_the_same_bits_everywhere() {
    same_everywhere(&with_joints(block::<D2>(20, 28, 2.0)), 2200);
    same_everywhere(&with_joints(block::<D3>(7, 10, 2.0)), 900);
}

#[test]
fn a_servo_wall_has_the_same_bits_everywhere() {
    let mut model = block::<D2>(20, 20, 1.0);
    let servo = Servo { pressure: 1e6, area: 0.02, relaxation: 0.5, speed_limit: 0.5 };
    model.walls[1].motion = Motion::Servo(servo);
    model.walls[0].motion = Motion::Velocity([0.0, 0.0]);
    let run = |threads| {
        let engine = compressed(&model, 2500, 500, threads, Width::detect());
        (digest(&engine), engine.wall_force(1)[1] / 0.02)
    };
    let (expected, pressure) = run(1);
    assert!((pressure / 1e6 - 1.0).abs() < 0.02, "{pressure}");
    assert_eq!(run(2).0, expected);
    assert_eq!(run(8).0, expected);
}
