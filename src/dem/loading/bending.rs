//! Three-point bending of a beam, plain or notched; plane.
//!
//! The beam lies along x on two supports at ±L/2 and is loaded from above at the middle by a third roller, which moves
//! down at the speed of the test ([`super::rollers`]). L is the distance of the supports as they stand. The notch of depth a is cut
//! into the lower side at the middle: its balls are left out.
//!
//! ```text
//! δ      = settlement of the middle against the supports, read at mid-height, so that what the rollers dent does not count
//! stress = 3 F L / (2 b (h − a)²)                       (outermost fibre of an elastic beam; b = 1 m)
//! strain = 6 h δ / L²                                   (the same fibre)
//! lateral = opening of the lower side at the middle over h (crack mouth opening)
//! E      = stress over strain = F L³/(4 b h³ δ); none for a notched beam
//! G_F    = ∫ F dδ / (b (h − a)) up to the end of the test: all of it only with a small `stop_fraction`
//! ```
//!
//! The beam starts with the velocities of an elastic beam that settles at the speed of the test, so that no shock runs
//! through it.
//!
//! The axis of an elastic beam settles by F L³/(4 E b h³) (1 + (2.4 + 1.5 ν)(h/L)² − 0.84 (h/L)³) (Seewald 1927; Timoshenko &
//! Goodier, Theory of Elasticity, § 41): E is that much below the material's. With different moduli in tension and compression E is
//! 4 E_t E_c/(√E_t + √E_c)².

use super::curve::{Macro, Sample, evaluate};
use super::drive::{Bench, Reading, drive};
use super::judgement::Judgement;
use super::material::Material;
use super::piece::Piece;
use super::record::{TestRecord, Watcher};
use super::rig::{mount, set_velocities};
use super::rollers::Rollers;
use super::settings::{Loading, Notch, TestError};
use crate::space::Tuple;
use crate::{Amount, Clump, Engine, Fault, Faults, Space, Vector};

/// Distance of the supports over the length of the beam, when it is not given.
const SPAN: f64 = 0.9;
/// Radius within which balls mark a point of the beam, over the mean diameter.
const MARK: f64 = 1.5;

/// Distance of the supports of a beam of this length (m).
pub(super) fn span(test: &Loading, width: f64) -> f64 {
    test.particulars.span.unwrap_or(SPAN * width)
}

pub(super) fn run<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
    watch: Watcher<'_>,
) -> Result<TestRecord<S>, TestError> {
    let [width, height, _] = piece.outline.extents();
    let span = span(test, width);
    if !(span > height && span < width) {
        let wanted = "more than the height of the beam and less than its length";
        let value = Amount(span, "m");
        return Err(Faults(vec![Fault::Setting { quantity: "span", value, wanted }]).into());
    }
    let notch = test.particulars.notch;
    let (cut, remaining) = cut(piece, notch);
    let wanted = [(-0.5 * span, -1.0), (0.5 * span, -1.0), (0.0, 1.0)];
    let mut rollers = Rollers::under(&cut, wanted);
    let beam = Beam { supports: rollers.supports(), height, notch };
    let mut mounted = mount(&cut, material, Vec::new(), rollers.bodies(&cut), (&test.platens, &test.machine), seed)?;
    let engine = &mut mounted.engine;
    let schedule = test.schedule(&mounted.scales, &piece.outline, engine.time_step())?;
    set_velocities(engine, |x| beam.settling::<S>(x, schedule.speed))?;
    rollers.start(engine, schedule.speed)?;
    let marks = Marks::new(&cut, &beam);
    let start = marks.read(engine);
    let mut bent = Bent { beam, marks, start, rollers };
    let mut run = drive(engine, &schedule, &test.rule, &mut bent, watch);
    for snapshot in &mut run.snapshots {
        snapshot.state.centres = restored::<S>(&snapshot.state.centres, &remaining, &piece.centres);
        for link in &mut snapshot.state.forces {
            link.ends = link.ends.map(|end| remaining.get(end).copied().unwrap_or(usize::MAX));
        }
        snapshot.state.forces.retain(|link| link.ends[1] != usize::MAX);
    }
    let values = bent.beam.values(&run.samples);
    let counts = (mounted.bonds, 0);
    let judgement = Judgement::of(engine, &run, piece, (&mounted.scales, &schedule), counts, values.strength);
    Ok(TestRecord::new(run, values, judgement, Vec::new()))
}

/// Centres of all balls of the whole piece: the `kept` ones where they are now, the notch's where they were.
fn restored<S: Space>(now: &[Vector<S>], remaining: &[usize], start: &[Vector<S>]) -> Vec<Vector<S>> {
    let mut centres = start.to_vec();
    remaining.iter().zip(now).for_each(|(&ball, &centre)| centres[ball] = centre);
    centres
}

/// A beam that is bent.
struct Bent {
    beam: Beam,
    marks: Marks,
    /// What the marks read at the start (m).
    start: [f64; 2],
    rollers: Rollers,
}

impl<S: Space> Bench<S> for Bent {
    fn follow(&mut self, engine: &mut Engine<S>) {
        self.rollers.follow(engine);
    }

    fn read(&self, engine: &Engine<S>) -> Reading {
        let (span, height) = (self.beam.span(), self.beam.height);
        let forces = self.rollers.forces(engine);
        let [sag, mouth] = self.marks.read(engine);
        let supports = 0.5 * (forces[0] + forces[1]);
        Reading {
            axial: 6.0 * height * (self.start[0] - sag) / (span * span),
            lateral: (mouth - self.start[1]) / height,
            stress: -forces[2] * self.beam.stress_per_force(),
            confinement: 0.0,
            asymmetry: if supports > 0.0 { (forces[0] - forces[1]).abs() / supports } else { 0.0 },
        }
    }
}

/// A beam on its supports.
struct Beam {
    /// Where the supports stand along x (m).
    supports: [f64; 2],
    height: f64,
    notch: Option<Notch>,
}

impl Beam {
    /// Distance of the supports (m).
    fn span(&self) -> f64 {
        self.supports[1] - self.supports[0]
    }

    /// Velocity at a point of an elastic beam whose middle settles at `speed` (m/s): with ξ = 2|x|/L the deflection is
    /// 1 − (3ξ² − ξ³)/2 of that of the middle between the supports and a straight line outside, and sections stay plane.
    fn settling<S: Space>(&self, x: Vector<S>, speed: f64) -> Vector<S> {
        let off = x.at(0) - 0.5 * (self.supports[0] + self.supports[1]);
        let xi = 2.0 * off.abs() / self.span();
        let (share, slope) = if xi <= 1.0 {
            (1.0 - 0.5 * (3.0 * xi * xi - xi * xi * xi), -0.5 * (6.0 * xi - 3.0 * xi * xi))
        } else {
            (1.5 * (1.0 - xi), -1.5)
        };
        let slope = slope * 2.0 / self.span() * if off < 0.0 { -1.0 } else { 1.0 };
        Vector::<S>::build(|k| [speed * slope * x.at(1), -speed * share, 0.0][k])
    }

    /// Height above the notch (m).
    fn ligament(&self) -> f64 {
        self.height * (1.0 - self.notch.map_or(0.0, |notch| notch.depth))
    }

    /// 3 L / (2 b (h − a)²), 1/m².
    fn stress_per_force(&self) -> f64 {
        let ligament = self.ligament();
        1.5 * self.span() / (ligament * ligament)
    }

    /// Results of the beam from the record.
    fn values(&self, samples: &[Sample]) -> Macro {
        let all = evaluate(samples);
        let nan = f64::NAN;
        let [tangent, secant] = if self.notch.is_some() { [nan; 2] } else { [all.modulus_tangent, all.modulus_secant] };
        let force = |sample: &Sample| sample.stress / self.stress_per_force();
        let sag = |sample: &Sample| sample.axial * self.span() * self.span() / (6.0 * self.height);
        let work = |pair: &[Sample]| 0.5 * (force(&pair[0]) + force(&pair[1])) * (sag(&pair[1]) - sag(&pair[0]));
        Macro {
            strength: all.strength,
            peak_strain: all.peak_strain,
            modulus_tangent: tangent,
            modulus_secant: secant,
            crack_initiation: all.crack_initiation,
            fracture_energy: samples.windows(2).map(work).sum::<f64>() / self.ligament(),
            ..Macro::unknown()
        }
    }
}

/// The piece without the balls of the notch, and the indices of those that stay. A clump whose pebbles lie in the
/// notch loses them and stays rigid as it was.
fn cut<S: Space>(piece: &Piece<S>, notch: Option<Notch>) -> (Piece<S>, Vec<usize>) {
    let height = piece.outline.height();
    let Some(Notch { depth, width }) = notch else { return (piece.clone(), (0..piece.radii.len()).collect()) };
    let tip = (depth - 0.5) * height;
    let within = |x: Vector<S>| x.at(0).abs() < 0.5 * width * height && x.at(1) < tip;
    let remaining: Vec<usize> = (0..piece.radii.len()).filter(|&i| !within(piece.centres[i])).collect();
    let mut index = vec![None; piece.radii.len()];
    remaining.iter().enumerate().for_each(|(new, &old)| index[old] = Some(new));
    let clump = |clump: &Clump<S>| {
        let pebbles: Vec<usize> = clump.pebbles.iter().filter_map(|&pebble| index[pebble]).collect();
        (!pebbles.is_empty()).then(|| Clump { pebbles, ..clump.clone() })
    };
    let cut = Piece {
        outline: piece.outline,
        centres: remaining.iter().map(|&i| piece.centres[i]).collect(),
        radii: remaining.iter().map(|&i| piece.radii[i]).collect(),
        groups: remaining.iter().map(|&i| piece.groups[i]).collect(),
        density: piece.density,
        clumps: piece.clumps.iter().filter_map(clump).collect(),
    };
    (cut, remaining)
}

/// Balls that mark points of the beam: at mid-height over the supports and at the middle, and at the mouth.
struct Marks {
    supports: [Vec<usize>; 2],
    middle: Vec<usize>,
    mouth: [Vec<usize>; 2],
}

impl Marks {
    fn new<S: Space>(piece: &Piece<S>, beam: &Beam) -> Self {
        let diameter = 2.0 * piece.mean_radius();
        let near = |x: f64, y: f64, side: f64| {
            let off = |i: usize| {
                let [dx, dy] = [piece.centres[i].at(0) - x, piece.centres[i].at(1) - y];
                (dx * dx + dy * dy).sqrt()
            };
            let own = |i: usize| side == 0.0 || side * (piece.centres[i].at(0)) > 0.0;
            let within: Vec<usize> = (0..piece.radii.len()).filter(|&i| own(i) && off(i) <= MARK * diameter).collect();
            if !within.is_empty() {
                return within;
            }
            (0..piece.radii.len()).filter(|&i| own(i)).min_by(|&a, &b| off(a).total_cmp(&off(b))).into_iter().collect()
        };
        let edge = 0.5 * beam.height * beam.notch.map_or(0.0, |notch| notch.width);
        let low = -0.5 * beam.height;
        Self {
            supports: [near(beam.supports[0], 0.0, 0.0), near(beam.supports[1], 0.0, 0.0)],
            middle: near(0.0, 0.0, 0.0),
            mouth: [near(-edge, low, -1.0), near(edge, low, 1.0)],
        }
    }

    /// Height of the middle over the supports, and width of the mouth (m).
    fn read<S: Space>(&self, engine: &Engine<S>) -> [f64; 2] {
        let mean = |balls: &[usize], axis: usize| {
            balls.iter().map(|&i| engine.position(i).at(axis)).sum::<f64>() / balls.len() as f64
        };
        let [left, right] = [0, 1].map(|k| mean(&self.supports[k], 1));
        let [near, far] = [0, 1].map(|k| mean(&self.mouth[k], 0));
        [mean(&self.middle, 1) - 0.5 * (left + right), far - near]
    }
}
