//! A plane run equals its flat twin in space.

use crate::block::*;
use dem::space::Tuple;
use dem::*;
use math::random::Stream;

/// Contact-bonded balls with stiffnesses and inertias that do not know the space, thrown at each other.
fn thrown<S: Space>() -> Engine<S> {
    let mut stream = Stream::new(9, "twin", 0);
    let mut particles = Vec::new();
    for n in 0..36 {
        let x = [0.98 * f64::from(n % 6), 0.98 * f64::from(n / 6), 0.0];
        let velocity = [stream.uniform_in(-3.0, 3.0), stream.uniform_in(-3.0, 3.0), 0.0];
        let mut ball = Particle::<S>::ball(Vector::<S>::build(|k| x[k]), 0.5, 1.0, GRAIN);
        ball.velocity = Vector::<S>::build(|k| velocity[k]);
        (ball.mass, ball.inertia) = (100.0, 12.0);
        particles.push(ball);
    }
    let capacity = 1.5e4 / S::section(0.5);
    let bond = ContactBond {
        tensile_strength: capacity,
        shear_strength: capacity,
        scatter: Scatter::default(),
        shear_break: ShearBreak::Keep,
    };
    let law = Interaction { linear: Linear::direct(1e6, 4e5, 0.3), bond: Bond::Contact(bond) };
    let settings = Settings { damping: 0.1, fixed_step: Some(1e-4), ..Settings::default() };
    let contacts = ContactTable::new().with(GRAIN, GRAIN, law);
    let model = Model { particles, clumps: vec![], walls: vec![], contacts, settings };
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(0.0, 1).unwrap();
    engine.advance(1500).unwrap();
    engine
}

/// Largest difference of a position of the two runs over the radius.
pub(crate) fn difference() -> f64 {
    let (plane, solid) = (thrown::<D2>(), thrown::<D3>());
    assert!(plane.cracks().len() > 10, "{}", plane.cracks().len());
    assert_eq!(plane.cracks().len(), solid.cracks().len());
    let one = |p: usize| {
        let (a, b) = (plane.position(p), solid.position(p));
        [a[0] - b[0], a[1] - b[1], b[2]].norm() / 0.5
    };
    (0..plane.particle_count()).map(one).fold(0.0, f64::max)
}
