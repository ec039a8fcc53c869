//! Free fall, rest, and a wall under servo.
//!
//! Local damping takes gravity in: a ball falls with g (1 − α) (Cundall & Strack 1979; the damping is not Galilean invariant).
//! At rest on a wall the overlap is m g/k_n and the unbalanced ratio, mean unbalanced force over mean contact force, is that
//! of what still moves. A servo wall holds its stress.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

const GRAVITY: f64 = 9.81;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "A ball of radius 0.5 m and density 2000 kg/m³, g = 9.81 m/s², α = 0.7, k_n 1e9 N/m. The servo: a block of 20 × 20 \
        discs, 1 MPa, relaxation 0.5.";
    Family { title: "Fall, rest and servo", about, cases: &CASES }
}

#[test]
fn falls_and_rests_have_their_closed_forms() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    ball::<D2>(&mut cases);
    ball::<D3>(&mut cases);
    let mut model = block::<D2>(20, 20, 0.0);
    model.walls[1].motion = Motion::Servo(Servo { pressure: 1e6, area: 0.02, relaxation: 0.5, speed_limit: 0.5 });
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-5, 7).unwrap();
    engine.absorb_overlaps();
    engine.advance(6000).unwrap();
    let near = Near::Relative(1e-2);
    cases.push(Case::new("2D: stress of a servo wall, Pa", "target", 1e6, engine.wall_force(1)[1] / 0.02, near));
    let below = -engine.wall_force(0)[1] / 0.02;
    cases.push(Case::new("2D: stress of the wall across, Pa", "equilibrium", 1e6, below, near));
    cases
}

fn ball<S: Space>(cases: &mut Vec<Case>) {
    let law = Interaction::unbonded(Linear::direct(1e9, 4e8, 0.5));
    let start = |height: f64| {
        let settings = Settings { gravity: along::<S>(1, -GRAVITY), ..Settings::default() };
        let ball = Particle::<S>::ball(along::<S>(1, height), 0.5, 2000.0, GRAIN);
        (ball.mass, Engine::new(&model::<S>(vec![ball], vec![floor()], law, settings)).unwrap())
    };
    let label = |what: &str| format!("{}: {what}", S::NAME);
    let (_, mut falling) = start(100.0);
    // The first step starts at rest, where nothing is damped.
    falling.advance(1).unwrap();
    let (first, since) = (falling.velocity(0).at(1), falling.time());
    falling.advance(1000).unwrap();
    let rate = (first - falling.velocity(0).at(1)) / (falling.time() - since);
    let name = label("acceleration of a free fall, m/s²");
    cases.push(Case::new(name, "g (1 − α), CS79", 0.3 * GRAVITY, rate, Near::Relative(1e-9)));
    let (mass, mut resting) = start(0.5);
    resting.advance(4000).unwrap();
    let overlap = 0.5 - resting.position(0).at(1);
    let near = Near::Relative(1e-6);
    cases.push(Case::new(label("overlap at rest, m"), "m g/k_n", mass * GRAVITY / 1e9, overlap, near));
    cases.push(Case::new(label("force on the wall, N"), "m g", -mass * GRAVITY, resting.wall_force(0).at(1), near));
    let ratio = measure::unbalanced_ratio(&resting);
    cases.push(Case::new(label("unbalanced ratio at rest"), "0", 0.0, ratio, Near::Absolute(1e-6)));
}
