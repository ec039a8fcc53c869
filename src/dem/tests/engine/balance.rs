//! What holds for every law: action and reaction, balance of moments, no energy out of a closed cycle.
//!
//! A heap of balls of random radius, thrown together, keeps Σ m v and Σ (x × m v + I ω) to rounding, whatever contacts do.
//! A contact that is led around a closed path may take work, but must not give any.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use math::random::Stream;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Every law in plane and solid: drift of the momenta of 36 (64) balls that fly at each other, over Σ|m v| and \
        Σ|x × m v|, after 1500 steps with breaks; work that a contact led around a closed path gives, over the work that went \
        through it.";
    Family { title: "Action, reaction and closed cycles", about, cases: &CASES }
}

#[test]
fn every_law_balances() {
    family().check();
}

/// All laws, by name.
pub(crate) fn laws<S: Space>() -> Vec<(&'static str, Interaction)> {
    let linear = Linear::direct(1e6, 4e5, 0.3);
    let dashpot = Dashpot { normal: 0.2, shear: 0.1, tensile: false };
    let capacity = 1.5e4 / S::section(0.5);
    let point = |shear_break| {
        let (tensile_strength, shear_strength) = (capacity, capacity);
        Bond::Contact(ContactBond { tensile_strength, shear_strength, scatter: Scatter::default(), shear_break })
    };
    let parallel = Bond::Parallel(ParallelBond {
        radius_multiplier: 0.8,
        stiffness: BondStiffness::PerArea { kn: 1e6, ks: 4e5 },
        tensile_strength: capacity,
        cohesion: capacity,
        friction_angle: 0.3,
        moment_factor: 0.5,
        scatter: Scatter::both(0.1),
    });
    vec![
        ("linear", Interaction::unbonded(linear)),
        ("linear with dashpots", Interaction::unbonded(Linear { dashpot, ..linear })),
        ("contact bond", Interaction { linear, bond: point(ShearBreak::Keep) }),
        ("contact bond, zero shear", Interaction { linear, bond: point(ShearBreak::Zero) }),
        ("parallel bond", Interaction { linear, bond: parallel }),
    ]
}

/// A heap of balls thrown at each other, in a frame: `frame` takes a vector of the plane or solid into it, `mirror` is −1
/// if it swaps hands.
pub(crate) fn thrown<S: Space>(law: Interaction, frame: impl Fn(Vector<S>) -> Vector<S>, mirror: f64) -> Engine<S> {
    let mut stream = Stream::new(9, "thrown", 0);
    let edge = if S::DIMENSION == 2 { 6 } else { 4 };
    let count = if S::DIMENSION == 2 { 36 } else { 64 };
    let mut particles = Vec::new();
    for n in 0..count {
        let cell = [n % edge, n / edge % edge, n / (edge * edge)];
        let x = Vector::<S>::build(|k| 0.98 * f64::from(cell[k]));
        let v = Vector::<S>::build(|_| stream.uniform_in(-3.0, 3.0));
        let mut ball = Particle::<S>::ball(frame(x), 0.5 * stream.uniform_in(0.95, 1.0), 200.0, GRAIN);
        ball.velocity = frame(v);
        let spin = Vector::<S>::build(|_| stream.uniform_in(-3.0, 3.0));
        // A spin is an axial vector: it turns with the frame, and once more when hands are swapped.
        let axial = frame(spin).times(mirror);
        let plane = stream.uniform_in(-3.0, 3.0) * mirror;
        ball.spin = Spin::<S>::build(|k| if S::DIMENSION == 2 { plane } else { axial.at(k) });
        particles.push(ball);
    }
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-4), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(particles, vec![], law, settings)).unwrap();
    engine.install_bonds(0.02, 1).unwrap();
    engine
}

/// Σ m v and Σ (x × m v + I ω), and the sums of the sizes of their terms.
fn momenta<S: Space>(engine: &Engine<S>) -> (Vector<S>, Spin<S>, [f64; 2]) {
    let mut sums = (Vector::<S>::zero(), Spin::<S>::zero(), [0.0; 2]);
    for p in 0..engine.particle_count() {
        let [mass, inertia] = engine.moving_mass(p);
        let push = engine.velocity(p).times(mass);
        let turn = S::moment(engine.position(p), push);
        sums.0 = sums.0.plus(push);
        sums.1 = sums.1.plus(turn).plus(engine.spin(p).times(inertia));
        sums.2 = [sums.2[0] + push.norm(), sums.2[1] + turn.norm()];
    }
    sums
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    space::<D2>(&mut cases);
    space::<D3>(&mut cases);
    cases
}

fn space<S: Space>(cases: &mut Vec<Case>) {
    let name = S::NAME;
    for (law, interaction) in laws::<S>() {
        let mut engine = thrown::<S>(interaction, |x| x, 1.0);
        let (linear, angular, sizes) = momenta(&engine);
        let bonds = engine.bond_count();
        engine.advance(1500).unwrap();
        assert!(bonds == 0 || engine.cracks().len() > 10, "{law}: {} cracks", engine.cracks().len());
        let (after, turned, _) = momenta(&engine);
        let rounding = Near::Absolute(1e-13);
        let drift = after.minus(linear).norm() / sizes[0];
        cases.push(Case::new(format!("{name}, {law}: drift of momentum"), "action = reaction", 0.0, drift, rounding));
        let drift = turned.minus(angular).norm() / sizes[1];
        let label = format!("{name}, {law}: drift of angular momentum");
        cases.push(Case::new(label, "balance of moments", 0.0, drift, rounding));
        let label = format!("{name}, {law}: work given in a closed cycle");
        cases.push(Case::new(label, "at most rounding of the path", 1e-4, cycle::<S>(interaction), Near::Below));
    }
}

/// Leads the second of two balls around a closed path (in, aside, out, back, with a turn to and fro); the work that the
/// contact gives in the end over all the work that went through it. Elastic paths give 0, all others take.
fn cycle<S: Space>(law: Interaction) -> f64 {
    let balls = vec![
        Particle::ball(along::<S>(0, 0.0), 0.5, 2000.0, GRAIN),
        Particle::ball(along::<S>(0, 1.0), 0.5, 2000.0, GRAIN),
    ];
    let settings = Settings { damping: 0.0, fixed_step: Some(1e-4), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    engine.install_bonds(1e-9, 1).unwrap();
    engine.fix(&[0, 1], true, true).unwrap();
    let legs = 4000;
    let way = 5e-3 / f64::from(legs) / 1e-4;
    let path = [([-way, 0.0], way), ([0.0, way], 0.0), ([way, 0.0], -way), ([0.0, -way], 0.0)];
    let (mut given, mut turnover) = (0.0, 0.0);
    let load = |e: &Engine<S>| {
        let Some(contact) = e.contacts().next() else { return (Vector::<S>::zero(), Spin::<S>::zero()) };
        let force = contact.force().times(-1.0);
        let arm = contact.point.minus(e.position(1));
        (force, S::moment(arm, force).minus(contact.moment))
    };
    let mut before = load(&engine);
    for ([x, y], spin) in path {
        let velocity = along::<S>(0, x).plus(along::<S>(1, y));
        engine.set_motion(1, velocity, about::<S>(spin)).unwrap();
        for _ in 0..legs {
            engine.advance(1).unwrap();
            let after = load(&engine);
            let mean = (before.0.plus(after.0).times(0.5), before.1.plus(after.1).times(0.5));
            let work = (mean.0.dot(velocity) + mean.1.dot(about::<S>(spin))) * 1e-4;
            given += work;
            turnover += work.abs();
            before = after;
        }
    }
    given / turnover
}
