//! The answer does not depend on the frame, nor on the space: turned, mirrored, and a plane run as its flat twin.
//!
//! The heap of the balance cases is turned or mirrored, run, and turned back. Differences grow from rounding because
//! balls that collide are chaotic, so the runs are short. Local damping acts along the axes and is left out.

use crate::balance::{laws, thrown};
use crate::case::{Case, Family, Near};
use crate::twin;
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about =
        "Largest difference of a position, over the radius, after 600 steps in the other frame (1500 for the twin).";
    Family { title: "Frames and spaces", about, cases: &CASES }
}

#[test]
fn the_frame_does_not_matter() {
    family().check();
}

/// A turn by atan(4/3) in the plane; in the solid about an oblique axis.
fn turn<S: Space>(x: Vector<S>) -> Vector<S> {
    if S::DIMENSION == 2 {
        let [a, b] = [x.at(0), x.at(1)];
        return Vector::<S>::build(|k| if k == 0 { 0.6 * a - 0.8 * b } else { 0.8 * a + 0.6 * b });
    }
    // Rodrigues' turn by 90° about (2, 3, 6)/7.
    let axis = Vector::<S>::build(|k| [2.0, 3.0, 6.0][k] / 7.0);
    let cross = S::moment(axis, x);
    Vector::<S>::build(|k| axis.at(k) * axis.dot(x) + cross.at(k))
}

fn mirror<S: Space>(x: Vector<S>) -> Vector<S> {
    Vector::<S>::build(|k| if k == 0 { -x.at(0) } else { x.at(k) })
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    space::<D2>(&mut cases);
    space::<D3>(&mut cases);
    let label = "contact bond: plane run against its flat twin";
    cases.push(Case::new(label, "equal", 0.0, twin::difference(), Near::Absolute(1e-9)));
    cases
}

fn space<S: Space>(cases: &mut Vec<Case>) {
    for (law, interaction) in laws::<S>() {
        let run = |mut engine: Engine<S>| {
            engine.advance(600).unwrap();
            engine
        };
        let plain = run(thrown::<S>(interaction, |x| x, 1.0));
        let turned = run(thrown::<S>(interaction, turn::<S>, 1.0));
        let mirrored = run(thrown::<S>(interaction, mirror::<S>, -1.0));
        let off = |other: &Engine<S>, frame: fn(Vector<S>) -> Vector<S>| {
            let one = |p: usize| other.position(p).minus(frame(plain.position(p))).norm() / 0.5;
            (0..plain.particle_count()).map(one).fold(0.0, f64::max)
        };
        let near = Near::Absolute(1e-9);
        let name = S::NAME;
        cases.push(Case::new(format!("{name}, {law}: turned"), "invariance", 0.0, off(&turned, turn::<S>), near));
        cases.push(Case::new(format!("{name}, {law}: mirrored"), "invariance", 0.0, off(&mirrored, mirror::<S>), near));
    }
}
