//! Direct tension by grips: the balls in a layer at each end move apart at a prescribed speed without turning.
//!
//! ```text
//! layer  = one tenth of the height at each end; L = distance of the innermost gripped balls
//! stress = force across the edge of the grips / A, mean of both grips           (tension positive)
//! strain = separation of the grips / L
//! lateral: side gauges over the middle half of the height, here contraction positive, so that ν > 0
//! ```
//!
//! The specimen starts with the velocity field of uniform stretching between the grips. Clumps are not gripped; the balls
//! around them are. A run in which most of the cracks lie in or at a grip is not valid.
//!
//! Source: Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011, section 3.

use super::crack::CrackEvent;
use super::curve::evaluate;
use super::drive::{Reading, drive};
use super::gauge::Gauges;
use super::judgement::Judgement;
use super::material::Material;
use super::piece::Piece;
use super::record::{TestRecord, Watcher};
use super::rig::{mount, set_velocities};
use super::settings::{Loading, TestError};
use super::validity::{Check, Reason};
use crate::space::Tuple;
use crate::{Engine, Other, Space, Vector};

/// Height of a grip over that of the specimen.
const GRIP: f64 = 0.1;
/// Least share of cracks that lie between the grips.
const LEAST_BETWEEN: f64 = 0.5;

/// Half of the height between the grips (m).
pub(super) fn half_free(height: f64) -> f64 {
    (0.5 - GRIP) * height
}

pub(super) fn run<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
    watch: Watcher<'_>,
) -> Result<TestRecord<S>, TestError> {
    let (height, section) = (piece.outline.height(), piece.outline.section());
    let mut mounted = mount(piece, material, Vec::new(), Vec::new(), (&test.platens, &test.machine), seed)?;
    let engine = &mut mounted.engine;
    let half = half_free(height);
    let schedule = test.schedule(&mounted.scales, &piece.outline, engine.time_step())?;
    let stretch = |x: Vector<S>| schedule.speed * (x.at(1) / half).clamp(-1.0, 1.0);
    set_velocities(engine, |x| Vector::<S>::build(|k| if k == 1 { stretch(x) } else { 0.0 }))?;
    let grips = grips(piece, half);
    let length = free_length(piece, &grips);
    let gripped: Vec<usize> = (0..grips.len()).filter(|&i| grips[i] != 0).collect();
    engine.fix(&gripped, true, true)?;
    let gauges = Gauges::new::<S>(height, &piece.centres, &piece.radii);
    let marks = [-1, 1].map(|side| grips.iter().position(|&s| s == side));
    let start = separation(engine, marks);
    let mut measure = |engine: &Engine<S>| Reading {
        axial: (separation(engine, marks) - start) / length,
        lateral: -gauges.strain::<S>(|i| engine.position(i)),
        stress: pull(engine, &grips) / section,
        ..Reading::default()
    };
    let run = drive(engine, &schedule, &test.rule, &mut measure, watch);
    let values = evaluate(&run.samples);
    let counts = (mounted.bonds, gauges.count());
    let judgement = Judgement::of(engine, &run, piece, (&mounted.scales, &schedule), counts, values.strength);
    let between = |crack: &&CrackEvent<S>| crack.position.at(1).abs() < half - 2.0 * piece.mean_radius();
    let between = run.cracks.iter().filter(between).count();
    let share = if run.cracks.is_empty() { 1.0 } else { between as f64 / run.cracks.len() as f64 };
    let checks = vec![Check::at_least(Reason::AtGrip, share, LEAST_BETWEEN)];
    Ok(TestRecord::new(run, values, judgement, checks))
}

/// −1 for balls of the lower grip, 1 for the upper, 0 for the rest.
fn grips<S: Space>(piece: &Piece<S>, half: f64) -> Vec<i8> {
    let side = |y: f64| if y <= -half { -1 } else { i8::from(y >= half) };
    piece.centres.iter().zip(piece.clumped()).map(|(x, clumped)| if clumped { 0 } else { side(x.at(1)) }).collect()
}

/// Distance along y of the innermost balls of the grips (m).
fn free_length<S: Space>(piece: &Piece<S>, grips: &[i8]) -> f64 {
    let of = |side: i8| piece.centres.iter().zip(grips).filter(move |(_, grip)| **grip == side).map(|(x, _)| x.at(1));
    of(1).fold(f64::INFINITY, f64::min) - of(-1).fold(f64::NEG_INFINITY, f64::max)
}

/// Distance along y between a ball of each grip (m).
fn separation<S: Space>(engine: &Engine<S>, marks: [Option<usize>; 2]) -> f64 {
    let [low, high] = marks.map(|ball| ball.map_or(0.0, |i| engine.position(i).at(1)));
    high - low
}

/// Mean of the forces by which the grips pull at the rest (N, per metre of thickness in the plane), tension positive.
fn pull<S: Space>(engine: &Engine<S>, grips: &[i8]) -> f64 {
    let mut sum = 0.0;
    for contact in engine.contacts().filter(|contact| contact.active) {
        let Other::Particle(other) = contact.other else { continue };
        let (a, b) = (f64::from(grips[contact.particle]), f64::from(grips[other]));
        // The force acts on the first end; a grip is pulled inwards, against its own sign.
        sum -= contact.force().at(1) * (a - b);
    }
    0.5 * sum
}
