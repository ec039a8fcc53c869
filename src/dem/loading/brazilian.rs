//! Brazilian test: a disc, or a lying cylinder, split between two platens or curved jaws.
//!
//! ```text
//! σ_t = 2 F / (π D t)      at the largest F, the mean of both platen forces (t = 1 m in the plane)
//! strain = approach of the platens / D
//! ```
//!
//! An elastic disc has tension 2F/(πDt) and compression 6F/(πDt) at its centre; on jaws of the whole angle 2α the tension
//! there is 2F/(πDt) (sin 2α/α − 1) (Hondros). σ_t is the tensile strength only if the disc fails there.
//!
//! The piece comes to rest between the platens before they move. The test ends when a path of cracks runs from platen to
//! platen and the stress is past its peak, or when the stress has fallen for good; not at the first drop, which may be a
//! contact that gives way under a platen. What makes a run invalid:
//! * the cracks up to the peak lie away from the loaded diameter, half of them or more;
//! * the disc has rotated by more than one degree up to the peak (least-squares rotation of all balls);
//! * at the end the cracks do not run along the loaded diameter: of its middle four fifths, in cells of two mean
//!   diameters, less than three quarters hold a crack;
//! * at the peak the two platens carry forces that differ by more than a fifth.
//!
//! That most of the cracks on the diameter are tensile is a further check, a caution.
//!
//! The disc has no modulus or Poisson's ratio: these values are NaN.
//!
//! Source: ISRM suggested method (1978), doi:10.1016/0148-9062(78)90003-7; Hondros 1959 for the elastic stresses.

use super::crack::CrackEvent;
use super::curve::{Macro, evaluate};
use super::drive::{Bench, Reading, Run, drive};
use super::gauge::Gauges;
use super::judgement::Judgement;
use super::material::Material;
use super::piece::Piece;
use super::platens::{Pair, balance, between_platens};
use super::record::{TestRecord, Watcher};
use super::rig::settle;
use super::settings::{Loading, TestError};
use super::validity::{Check, Reason};
use crate::measure::Mode;
use crate::space::Tuple;
use crate::{Engine, Space, Vector};
use std::collections::BTreeSet;

/// Half width of the band about the loaded diameter, over the diameter.
const BAND: f64 = 0.1;
/// Half length of the part of the loaded diameter that a path of cracks must cover, over the diameter.
const SPAN: f64 = 0.4;
/// Edge of the cells that a path is counted in, over the mean diameter.
const CELL: f64 = 2.0;
/// Share of those cells that makes a path.
const PATH: f64 = 0.75;
/// Share of the peak below which a path ends the test.
const PAST_PEAK: f64 = 0.9;
/// Least share of cracks in the band, and least share of tensile ones among them.
const LEAST_SHARE: f64 = 0.5;
/// Largest rotation up to the peak, one degree (rad).
const LARGEST_ROTATION: f64 = std::f64::consts::PI / 180.0;
/// Largest difference of the platen forces at the peak, over their mean.
const LARGEST_ASYMMETRY: f64 = 0.2;
/// Unbalanced ratio before loading, and steps to reach it.
pub(super) const AT_REST: (f64, u64) = (1e-3, 100_000);

pub(super) fn run<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
    watch: Watcher<'_>,
) -> Result<TestRecord<S>, TestError> {
    let [diameter, _, thickness] = piece.outline.extents();
    let (mut mounted, platens) = between_platens(test, piece, material, seed)?;
    let engine = &mut mounted.engine;
    let schedule = test.schedule(&mounted.scales, &piece.outline, engine.time_step())?;
    let rest = settle(engine, AT_REST, || watch(&super::curve::Sample::default()));
    platens.approach(engine, schedule.speed)?;
    let gauges = Gauges::new::<S>(0.4 * diameter, &piece.centres, &piece.radii);
    let path = Path::new(diameter, thickness, piece.mean_radius(), S::DIMENSION);
    let mut bench = Disc { platens, gauges, diameter, thickness, path };
    let mut run = drive(engine, &schedule, &test.rule, &mut bench, watch);
    let settled = match rest {
        Ok(settled) => settled.ratio,
        Err(failure) => {
            run.failure = run.failure.or(Some(failure.into()));
            f64::NAN
        }
    };
    let all = evaluate(&run.samples);
    let values = Macro {
        strength: all.strength,
        peak_strain: all.peak_strain,
        crack_initiation: all.crack_initiation,
        ..Macro::unknown()
    };
    let counts = (mounted.bonds, bench.gauges.count());
    let judgement = Judgement::of(engine, &run, piece, (&mounted.scales, &schedule), counts, values.strength);
    let mut checks = checks(&run, &piece.centres, &mut bench, diameter);
    checks.push(Check::at_most(Reason::NotAtRest, settled, AT_REST.0));
    Ok(TestRecord::new(run, values, judgement, checks))
}

/// A disc between platens.
struct Disc {
    platens: Pair,
    gauges: Gauges,
    diameter: f64,
    thickness: f64,
    path: Path,
}

impl<S: Space> Bench<S> for Disc {
    fn read(&self, engine: &Engine<S>) -> Reading {
        let [force, asymmetry] = balance(self.platens.forces(engine));
        Reading {
            axial: self.platens.approached(engine) / self.diameter,
            lateral: self.gauges.strain::<S>(|i| engine.position(i)),
            stress: 2.0 * force / (std::f64::consts::PI * self.diameter * self.thickness),
            confinement: 0.0,
            asymmetry,
        }
    }

    fn done(&mut self, cracks: &[CrackEvent<S>], share: f64) -> bool {
        share <= PAST_PEAK && self.path.share(cracks) >= PATH
    }
}

/// Which cells of the loaded diameter (a plane in the solid) hold a crack.
struct Path {
    /// Cells along y and z.
    counts: [usize; 2],
    /// Extents that they cover (m).
    extents: [f64; 2],
    band: f64,
    cracked: BTreeSet<[usize; 2]>,
    /// Cracks looked at so far.
    seen: usize,
}

impl Path {
    fn new(diameter: f64, thickness: f64, mean_radius: f64, dimension: usize) -> Self {
        let extents = [2.0 * SPAN * diameter, thickness];
        let cells = |extent: f64| ((extent / (2.0 * mean_radius * CELL)) as usize).max(1);
        let counts = [cells(extents[0]), if dimension == 2 { 1 } else { cells(extents[1]) }];
        Self { counts, extents, band: BAND * diameter, cracked: BTreeSet::new(), seen: 0 }
    }

    /// Share of the cells that hold a crack.
    fn share<S: Space>(&mut self, cracks: &[CrackEvent<S>]) -> f64 {
        for crack in cracks.get(self.seen..).unwrap_or_default() {
            let x = crack.position;
            let cell = |k: usize, x: f64| {
                let share = x / self.extents[k] + 0.5;
                (0.0..1.0).contains(&share).then(|| (share * self.counts[k] as f64) as usize)
            };
            let across = if S::DIMENSION == 2 { Some(0) } else { cell(1, x.at(2)) };
            if let (true, Some(along), Some(across)) = (x.at(0).abs() <= self.band, cell(0, x.at(1)), across) {
                self.cracked.insert([along, across]);
            }
        }
        self.seen = cracks.len();
        self.cracked.len() as f64 / (self.counts[0] * self.counts[1]) as f64
    }
}

fn checks<S: Space>(run: &Run<S>, start: &[Vector<S>], bench: &mut Disc, diameter: f64) -> Vec<Check> {
    let strain = run.at_peak.axial;
    let early = || run.cracks.iter().filter(|crack| crack.strain <= strain);
    let near = |crack: &&CrackEvent<S>| crack.position.at(0).abs() <= BAND * diameter;
    let central = early().filter(near).count();
    let tensile = early().filter(near).filter(|crack| crack.mode == Mode::Tension).count();
    let share = |part: usize, whole: usize| if whole == 0 { 1.0 } else { part as f64 / whole as f64 };
    let at_peak = run.snapshots.iter().max_by(|a, b| a.stress.total_cmp(&b.stress));
    let turned = at_peak.map_or(0.0, |kept| rotation::<S>(start, &kept.state.centres).abs());
    vec![
        Check::at_least(Reason::OffDiameter, share(central, early().count()), LEAST_SHARE),
        Check::at_least(Reason::ShearOnDiameter, share(tensile, central), LEAST_SHARE),
        Check::at_least(Reason::CrackPath, bench.path.share(&run.cracks), PATH),
        Check::at_most(Reason::Rotation, turned, LARGEST_ROTATION),
        Check::at_most(Reason::Asymmetry, run.at_peak.asymmetry, LARGEST_ASYMMETRY),
    ]
}

/// Least-squares rotation about the z axis through the origin (rad): Σ r × u / Σ r².
fn rotation<S: Space>(start: &[Vector<S>], now: &[Vector<S>]) -> f64 {
    let (mut moment, mut square) = (0.0, 0.0);
    for (a, b) in start.iter().zip(now) {
        moment += a.at(0) * (b.at(1) - a.at(1)) - a.at(1) * (b.at(0) - a.at(0));
        square += a.at(0) * a.at(0) + a.at(1) * a.at(1);
    }
    moment / square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{D2, D3};

    fn crack<S: Space>(at: [f64; 3]) -> CrackEvent<S> {
        let (position, normal) = (Vector::<S>::build(|k| at[k]), Vector::<S>::zero());
        let (mode, groups, balls) = (Mode::Tension, [0; 2], [0, 1]);
        let (element, elements, size) = (0, 1, 1e-3);
        CrackEvent { strain: 0.0, mode, groups, balls, position, contact: position, normal, element, elements, size }
    }

    /// D = 0.1 m, r̄ = 1 mm: 80 mm in 20 cells of 4 mm.
    #[test]
    fn a_path_is_counted_in_cells_along_the_diameter() {
        let mut path = Path::new(0.1, 1.0, 1e-3, 2);
        assert_eq!(path.counts, [20, 1]);
        let along: Vec<CrackEvent<D2>> = (0..20).map(|k| crack([0.0, -0.038 + 4e-3 * f64::from(k), 0.0])).collect();
        assert_eq!(path.share(&along[..10]), 0.5);
        assert_eq!(path.share(&along), 1.0);
        let mut off = Path::new(0.1, 1.0, 1e-3, 2);
        let aside: Vec<CrackEvent<D2>> = vec![crack([0.02, 0.0, 0.0]), crack([0.0, 0.045, 0.0])];
        assert_eq!(off.share(&aside), 0.0);
    }

    /// Cracks on one face of a cylinder are no path through it.
    #[test]
    fn in_the_solid_the_whole_plane_counts() {
        let mut path = Path::new(0.1, 0.04, 1e-3, 3);
        assert_eq!(path.counts, [20, 10]);
        let face: Vec<CrackEvent<D3>> = (0..20).map(|k| crack([0.0, -0.038 + 4e-3 * f64::from(k), 0.019])).collect();
        assert_eq!(path.share(&face), 0.1);
    }

    #[test]
    fn a_rigid_rotation_is_read_as_its_angle() {
        let start = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let angle = 1e-3;
        let now = start.map(|[x, y]: [f64; 2]| [x - angle * y, y + angle * x]);
        assert!((rotation::<D2>(&start, &now) - angle).abs() < 1e-15);
    }
}
