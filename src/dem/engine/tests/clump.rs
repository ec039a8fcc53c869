//! Clumps: momentum, spin and free rotation.

use super::*;
use crate::dem::space::Tuple;

fn lone<S: Space>(inertia: [[f64; 3]; 3], spin: Spin<S>) -> Engine<S> {
    let place = |k: usize| Vector::<S>::build(|a| if a == k % S::DIMENSION { 0.4 } else { 0.1 * k as f64 });
    let particles = (0..3).map(|k| Particle::ball(place(k), 0.5, 1000.0, STONE)).collect();
    let velocity = Vector::<S>::build(|k| 1.0 + k as f64);
    let clump = Clump { pebbles: vec![0, 1, 2], centre: Vector::<S>::zero(), velocity, spin, mass: 2.0, inertia };
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-3), ..Settings::default() };
    let model = Model { particles, clumps: vec![clump], walls: vec![], contacts: ContactTable::new(), settings };
    Engine::new(&model).unwrap()
}

#[test]
fn a_free_clump_in_the_plane_turns_about_its_centre() {
    let mut engine = lone::<D2>([[0.0; 3], [0.0; 3], [0.0, 0.0, 3.0]], [2.0]);
    let start = engine.position(0);
    engine.advance(1000).unwrap();
    let clump = engine.clump(0);
    assert!((clump.centre[0] - 1.0).abs() < 1e-12 && (clump.centre[1] - 2.0).abs() < 1e-12);
    assert_eq!(clump.spin, [2.0]);
    let (sin, cos) = 2.0_f64.sin_cos();
    let expected = [1.0 + cos * start[0] - sin * start[1], 2.0 + sin * start[0] + cos * start[1]];
    let found = engine.position(0);
    // Cayley's map lags by (ω dt)³/12 a step.
    assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-6), "{found:?} {expected:?}");
}

#[test]
fn a_free_clump_in_space_keeps_momentum_and_energy() {
    // Spin close to the middle axis: the body tumbles (Dzhanibekov), L stays, the energy must too.
    let inertia = [[1.0, 0.1, 0.0], [0.1, 2.0, 0.05], [0.0, 0.05, 3.0]];
    let mut engine = lone::<D3>(inertia, [0.05, 1.0, 0.02]);
    let momentum = |clump: &Clump<D3>| clump.inertia.map(|row| row.dot(clump.spin));
    let energy = |clump: &Clump<D3>| 0.5 * momentum(clump).dot(clump.spin);
    let before = engine.clump(0);
    let (mut lowest, mut first_tumble) = (1.0_f64, false);
    for _ in 0..50 {
        engine.advance(500).unwrap();
        let now = engine.clump(0);
        lowest = lowest.min(engine.position(0).minus(now.centre)[1]);
        first_tumble |= now.spin[0].abs() > 0.3 || now.spin[2].abs() > 0.3;
        let (l0, l1) = (momentum(&before), momentum(&now));
        // Spin and frame are half a step apart, hence the order of dt.
        assert!((0..3).all(|k| (l0[k] - l1[k]).abs() < 2e-3), "{l0:?} {l1:?}");
        assert!((energy(&now) / energy(&before) - 1.0).abs() < 2e-3, "{} {}", energy(&now), energy(&before));
    }
    assert!(first_tumble, "spin about the middle axis is unstable");
}
