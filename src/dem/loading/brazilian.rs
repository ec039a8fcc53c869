//! Brazilian test: a disc split between two flat platens.
//!
//! ```text
//! σ_t = 2 F / (π D t)      at the largest F, the mean of both platen forces (t = 1 m)
//! strain = approach of the platens / D
//! ```
//!
//! An elastic disc has tension 2F/(πDt) and compression 6F/(πDt) at its centre; σ_t is the tensile strength only if the
//! disc fails there. Checks of the record:
//! * at least half of the cracks up to the peak lie within a tenth of the diameter of the loaded diameter;
//! * the disc has not rotated by more than one degree up to the peak (least-squares rotation of all balls).
//!
//! The disc has no modulus or Poisson's ratio: these values are NaN.
//!
//! Source: ISRM suggested method (1978), doi:10.1016/0148-9062(78)90003-7; Hondros 1959 for the elastic stresses.

use super::curve::{Macro, Sample, evaluate, peak};
use super::drive::{Check, Loading, Run, TestError, TestRecord, drive};
use super::gauge::Gauges;
use super::judgement::Judgement;
use super::material::Material;
use super::uniaxial::{between_platens, judge, platens};
use crate::genesis::region::{Point, Region};
use crate::genesis::specimen::Specimen;
use crate::{D2, Engine, Watch};

/// Half width of the band about the loaded diameter, over the diameter.
const BAND: f64 = 0.1;
/// Least share of cracks in the band.
const LEAST_SHARE: f64 = 0.5;
/// Largest rotation up to the peak, one degree (rad).
const LARGEST_ROTATION: f64 = std::f64::consts::PI / 180.0;

pub(super) fn run(
    test: &Loading,
    specimen: &Specimen,
    material: &Material,
    seed: u64,
    watch: &mut dyn FnMut(&Sample) -> Watch,
) -> Result<TestRecord, TestError> {
    let Region::Disc { diameter } = specimen.region else {
        return Err(TestError::Outline { test: "brazilian", wanted: "disc", remedy: "a diameter" });
    };
    let mut engine = between_platens(test, specimen, material, seed)?;
    let gauges = Gauges::new(0.4 * diameter, &specimen.centres, &specimen.radii);
    let bonds = engine.bond_count();
    let measure = |engine: &Engine<D2>| {
        let [approach, force] = platens(engine, diameter);
        let tension = 2.0 * force / (std::f64::consts::PI * diameter);
        [approach / diameter, gauges.strain(|i| engine.position(i)[0]), tension]
    };
    let run = drive(&mut engine, 2.0 * test.speed / diameter, &test.rule, measure, watch);
    let all = evaluate(&run.samples);
    let values = Macro {
        strength: all.strength,
        peak_strain: all.peak_strain,
        crack_initiation: all.crack_initiation,
        ..Macro::unknown()
    };
    let judgement =
        Judgement { gauges: gauges.count(), ..judge(test, specimen, material, &engine, &run, &values, bonds) };
    let checks = checks(&run, &specimen.centres, diameter);
    Ok(TestRecord { run, values, judgement, checks })
}

fn checks(run: &Run, start: &[Point], diameter: f64) -> Vec<Check> {
    let strain = peak(&run.samples).map_or(0.0, |k| run.samples[k].axial);
    let early: Vec<_> = run.cracks.iter().filter(|crack| crack.strain <= strain).collect();
    let central = early.iter().filter(|crack| crack.position[0].abs() <= BAND * diameter).count();
    let share = if early.is_empty() { 1.0 } else { central as f64 / early.len() as f64 };
    let at_peak = run.snapshots.iter().max_by(|a, b| a.stress.total_cmp(&b.stress));
    let turned = at_peak.map_or(0.0, |kept| rotation(start, &kept.state.centres).abs());
    vec![
        Check { name: "cracks near the loaded diameter", value: share, bound: LEAST_SHARE, met: share >= LEAST_SHARE },
        Check { name: "rotation", value: turned, bound: LARGEST_ROTATION, met: turned <= LARGEST_ROTATION },
    ]
}

/// Least-squares rotation about the origin (rad): Σ r × u / Σ r².
fn rotation(start: &[Point], now: &[Point]) -> f64 {
    let (mut moment, mut square) = (0.0, 0.0);
    for (a, b) in start.iter().zip(now) {
        moment += a[0] * (b[1] - a[1]) - a[1] * (b[0] - a[0]);
        square += a[0] * a[0] + a[1] * a[1];
    }
    moment / square
}
