//! Direct tension by grips: the balls in a layer at each end move apart at a prescribed speed without turning.
//!
//! ```text
//! layer  = one tenth of the height at each end; L = distance of the innermost gripped balls
//! stress = force across the edge of the grips / W, mean of both grips           (tension positive)
//! strain = separation of the grips / L
//! lateral: side gauges over the middle half of the height, here contraction positive, so that ν > 0
//! ```
//!
//! The specimen starts with the velocity field of uniform stretching between the grips. Clumps are not gripped; the mortar
//! around them is.
//!
//! Source: Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011, section 3.

use super::curve::{Sample, evaluate};
use super::drive::{Loading, TestError, TestRecord, drive};
use super::gauge::Gauges;
use super::judgement::Judgement;
use super::material::Material;
use super::rig::{mount, set_velocities};
use super::uniaxial::judge;
use crate::genesis::region::Region;
use crate::genesis::specimen::Specimen;
use crate::{D2, Engine, Other, Watch};

/// Height of a grip over that of the specimen.
const GRIP: f64 = 0.1;

pub(super) fn run(
    test: &Loading,
    specimen: &Specimen,
    material: &Material,
    seed: u64,
    watch: &mut dyn FnMut(&Sample) -> Watch,
) -> Result<TestRecord, TestError> {
    let Region::Rectangle { width, height } = specimen.region else {
        return Err(TestError::Outline { test: "tension", wanted: "rectangle", remedy: "width and height" });
    };
    let mut engine = mount(specimen, material, Vec::new(), 0.0, &test.machine, seed)?;
    let half = (0.5 - GRIP) * height;
    let rate = test.speed / half;
    set_velocities(&mut engine, |x| [0.0, test.speed * (x[1] / half).clamp(-1.0, 1.0)])?;
    let grips = grips(specimen, half);
    let length = free_length(specimen, &grips);
    let gripped: Vec<usize> = (0..grips.len()).filter(|&i| grips[i] != 0).collect();
    engine.fix(&gripped, true, true)?;
    let gauges = Gauges::new(height, &specimen.centres, &specimen.radii);
    let bonds = engine.bond_count();
    let marks = [-1, 1].map(|side| grips.iter().position(|&s| s == side));
    let start = separation(&engine, marks);
    let measure = |engine: &Engine<D2>| {
        let strain = (separation(engine, marks) - start) / length;
        [strain, -gauges.strain(|i| engine.position(i)[0]), pull(engine, &grips) / width]
    };
    let run = drive(&mut engine, rate, &test.rule, measure, watch);
    let values = evaluate(&run.samples);
    let judgement =
        Judgement { gauges: gauges.count(), ..judge(test, specimen, material, &engine, &run, &values, bonds) };
    Ok(TestRecord { run, values, judgement, checks: Vec::new() })
}

/// −1 for balls of the lower grip, 1 for the upper, 0 for the rest.
fn grips(specimen: &Specimen, half: f64) -> Vec<i8> {
    let side = |y: f64| if y <= -half { -1 } else { i8::from(y >= half) };
    let of = specimen.clump_of_balls();
    specimen.centres.iter().zip(of).map(|(x, clump)| if clump.is_some() { 0 } else { side(x[1]) }).collect()
}

/// Distance along y of the innermost balls of the grips (m).
fn free_length(specimen: &Specimen, grips: &[i8]) -> f64 {
    let of = |side: i8| specimen.centres.iter().zip(grips).filter(move |(_, grip)| **grip == side).map(|(x, _)| x[1]);
    of(1).fold(f64::INFINITY, f64::min) - of(-1).fold(f64::NEG_INFINITY, f64::max)
}

/// Distance along y between a ball of each grip (m).
fn separation(engine: &Engine<D2>, marks: [Option<usize>; 2]) -> f64 {
    let [low, high] = marks.map(|ball| ball.map_or(0.0, |i| engine.position(i)[1]));
    high - low
}

/// Mean of the forces by which the grips pull at the rest (N per metre of thickness), tension positive.
fn pull(engine: &Engine<D2>, grips: &[i8]) -> f64 {
    let mut sum = 0.0;
    for contact in engine.contacts().filter(|contact| contact.active) {
        let Other::Particle(other) = contact.other else { continue };
        let (a, b) = (f64::from(grips[contact.particle]), f64::from(grips[other]));
        // The force acts on the first end; a grip is pulled inwards, against its own sign.
        sum -= contact.force()[1] * (a - b);
    }
    0.5 * sum
}
