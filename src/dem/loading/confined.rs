//! Compression under a confining stress: biaxial in the plane, triaxial in the solid.
//!
//! Rigid, frictionless side walls surround the piece: two to each axis across the load of a rectangle or box, 24
//! around a standing cylinder. First all walls, the platens among them, bring the piece to the isotropic stress σ₃ by servo, until each
//! wall is within 1 % of it and the unbalanced ratio at most 10⁻³. From that state on strains count. Then the platens move at
//! their speed while the side walls hold σ₃.
//!
//! ```text
//! stress       = deviator q = σ₁ − σ₃: mean platen force over the section, less the mean stress of the side walls
//! axial strain = approach of the platens / H         (section and H of the isotropic state)
//! lateral      = mean opening of opposite side walls over their distance, extension positive
//! ```
//!
//! A run whose side walls were more than 5 % off σ₃ at the peak is not valid: the platens are too fast for them.
//!
//! Unbonded spheres in a face-centred cubic lattice fail at σ₁/σ₃ = 2(1 + μ)/(1 − μ) (Thornton 1979,
//! doi:10.1680/geot.1979.29.4.441).

use super::curve::{Macro, Sample, evaluate};
use super::drive::{Reading, TestFailure, drive, slice};
use super::judgement::Judgement;
use super::material::{Material, PLATEN};
use super::piece::{Outline, Piece};
use super::platens::balance;
use super::record::{TestRecord, Watcher};
use super::rig::{Mounted, Scales, mount, set_velocities};
use super::settings::{Loading, TestError};
use super::validity::{Check, Reason};
use crate::measure::unbalanced_ratio;
use crate::space::Tuple;
use crate::{Engine, Faults, Motion, Servo, Space, Vector, Wall, Watch};
use math::elementary::sin_cos;
use std::f64::consts::PI;

/// Largest relative deviation of the confining stress at the peak.
pub(super) const TOLERANCE: f64 = 0.05;
/// The same at the end of the isotropic stage, and the unbalanced ratio there.
const ISOTROPIC: (f64, f64) = (1e-2, 1e-3);
/// Steps of the isotropic stage between two looks at it, and at most.
const LOOK_EVERY: u64 = 100;
const MOST_STEPS: u64 = 500_000;
/// Side walls around a cylinder, even.
const FACETS: usize = 24;
/// Relaxation of the servo, and its largest speed over that of the bodies in a wave of the confining stress. A wall that
/// follows its force with the speed G (F* − F) is stable while G times the impedance √(k m) of the balls on it is below 1,
/// which is about 2.5 times the relaxation, and takes up waves best near a half.
const RELAXATION: f64 = 0.15;
const FASTEST: f64 = 0.1;

/// A side wall: its outward normal, its area (m²), its distance from the axis (m).
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: [f64; 3],
    area: f64,
    distance: f64,
}

/// Side walls around an outline, opposite ones half the list apart.
fn sides(outline: &Outline, dimension: usize) -> Vec<Side> {
    let height = outline.height();
    match *outline {
        Outline::Column { diameter, .. } => {
            let facet = |k: usize| {
                let (sin, cos) = sin_cos(2.0 * PI * k as f64 / FACETS as f64);
                let half = PI / FACETS as f64;
                let (s, c) = sin_cos(half);
                Side { normal: [cos, 0.0, sin], area: diameter * s / c * height, distance: 0.5 * diameter }
            };
            (0..FACETS).map(facet).collect()
        }
        Outline::Block { .. } | Outline::Disc { .. } => {
            let [width, _, depth] = outline.extents();
            let side = |normal: [f64; 3], breadth: f64, across: f64| Side {
                normal,
                area: breadth * height,
                distance: 0.5 * across,
            };
            let x = |sign: f64| side([sign, 0.0, 0.0], depth, width);
            let z = |sign: f64| side([0.0, 0.0, sign], width, depth);
            if dimension == 2 { vec![x(-1.0), x(1.0)] } else { vec![x(-1.0), z(-1.0), x(1.0), z(1.0)] }
        }
    }
}

pub(super) fn run<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
    watch: Watcher<'_>,
) -> Result<TestRecord<S>, TestError> {
    let stress = test.particulars.confinement.unwrap_or_default();
    let mut vessel = Vessel::mount(test, piece, material, stress, seed)?;
    let schedule = {
        let Mounted { engine, scales, .. } = &vessel.mounted;
        test.schedule(scales, &piece.outline, engine.time_step())?
    };
    let ended = vessel.compress(watch)?;
    if ended == Isotropic::Reached {
        vessel.begin(schedule.speed)?;
    }
    let (start, engine) = (vessel.state(&vessel.mounted.engine), &mut vessel.mounted.engine);
    let (walls, sides) = (vessel.sides.clone(), vessel.sides.len());
    let mut measure = |engine: &Engine<S>| read(engine, &walls, &start);
    let mut run = match ended {
        Isotropic::Reached => drive(engine, &schedule, &test.rule, &mut measure, watch),
        Isotropic::Stopped => drive(engine, &schedule, &test.rule, &mut measure, &mut |_| Watch::Stop),
        Isotropic::Failed(_) => drive(engine, &schedule, &test.rule, &mut measure, &mut |_| Watch::Stop),
    };
    if let Isotropic::Failed(failure) = ended {
        (run.failure, run.interrupted) = (Some(failure), false);
    }
    let values = Macro { confinement: run.at_peak.confinement, ..evaluate(&run.samples) };
    let counts = (vessel.mounted.bonds, sides);
    let scales = &vessel.mounted.scales;
    let judgement = Judgement::of(&vessel.mounted.engine, &run, piece, (scales, &schedule), counts, values.strength);
    let off = (values.confinement / stress - 1.0).abs();
    let checks = vec![Check::at_most(Reason::Confinement, off, TOLERANCE)];
    Ok(TestRecord::new(run, values, judgement, checks))
}

/// How the isotropic stage ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Isotropic {
    Reached,
    Stopped,
    Failed(TestFailure),
}

/// A piece between two platens (walls 0 and 1) and side walls (from 2 on).
struct Vessel<S: Space> {
    mounted: Mounted<S>,
    sides: Vec<Side>,
    section: f64,
    stress: f64,
}

/// Positions of the walls.
#[derive(Clone, Debug)]
struct Stand {
    height: f64,
    section: f64,
    /// Distance of each side wall from the axis (m).
    distances: Vec<f64>,
}

impl<S: Space> Vessel<S> {
    fn mount(test: &Loading, piece: &Piece<S>, material: &Material, stress: f64, seed: u64) -> Result<Self, Faults> {
        let (sides, height) = (sides(&piece.outline, S::DIMENSION), piece.outline.height());
        let wall = |normal: [f64; 3], distance: f64| Wall::<S> {
            point: Vector::<S>::build(|k| distance * normal[k]),
            normal: Vector::<S>::build(|k| -normal[k]),
            motion: Motion::Velocity(Vector::<S>::zero()),
            group: PLATEN,
        };
        let ends = [-1.0, 1.0].map(|side| wall([0.0, side, 0.0], 0.5 * height));
        let walls = ends.into_iter().chain(sides.iter().map(|side| wall(side.normal, side.distance))).collect();
        let mut mounted = mount(piece, material, walls, Vec::new(), (&test.platens, &test.machine), seed)?;
        if mounted.bonds == 0 {
            // What holds an unbonded piece together is the confining stress.
            mounted.scales = Scales { strength: stress, ..mounted.scales };
        }
        Ok(Self { mounted, sides, section: piece.outline.section(), stress })
    }

    /// Area of a wall (m²).
    fn area(&self, wall: usize) -> f64 {
        if wall < 2 { self.section } else { self.sides[wall - 2].area }
    }

    /// Brings the piece to the confining stress on all sides.
    fn compress(&mut self, watch: Watcher<'_>) -> Result<Isotropic, Faults> {
        let Scales { modulus, .. } = self.mounted.scales;
        let speed_limit = FASTEST * self.mounted.scales.wave_speed() * self.stress / modulus;
        for wall in 0..self.sides.len() + 2 {
            let servo = Servo { pressure: self.stress, area: self.area(wall), relaxation: RELAXATION, speed_limit };
            self.mounted.engine.move_wall(wall, Motion::Servo(servo))?;
        }
        let steps = LOOK_EVERY.min(slice(&self.mounted.engine));
        loop {
            if let Err(failure) = self.mounted.engine.advance(steps) {
                return Ok(Isotropic::Failed(failure.into()));
            }
            if self.mounted.bonds == 0 {
                // The time step counts closed contacts, and those of an unbonded piece close only now.
                let masses = self.mounted.engine.settings().masses;
                self.mounted.engine.set_masses(masses);
            }
            let (off, ratio) = (self.off(), unbalanced_ratio(&self.mounted.engine));
            if off <= ISOTROPIC.0 && ratio <= ISOTROPIC.1 {
                return Ok(Isotropic::Reached);
            }
            let steps = self.mounted.engine.steps();
            if steps >= MOST_STEPS {
                return Ok(Isotropic::Failed(TestFailure::Confinement { wanted: self.stress, off, ratio, steps }));
            }
            if watch(&Sample::default()) == Watch::Stop {
                return Ok(Isotropic::Stopped);
            }
        }
    }

    /// Largest relative deviation of a wall from the confining stress.
    fn off(&self) -> f64 {
        let stress = |wall: usize| pressure(&self.mounted.engine, wall) / self.area(wall);
        (0..self.sides.len() + 2).map(|wall| (stress(wall) / self.stress - 1.0).abs()).fold(0.0, f64::max)
    }

    /// Begins to move the platens, with the velocities of uniform shortening.
    fn begin(&mut self, speed: f64) -> Result<(), Faults> {
        let engine = &mut self.mounted.engine;
        let half = 0.5 * (engine.wall_point(1).at(1) - engine.wall_point(0).at(1));
        for (wall, side) in [(0, -1.0), (1, 1.0)] {
            let velocity = Vector::<S>::build(|k| if k == 1 { -side * speed } else { 0.0 });
            engine.move_wall(wall, Motion::Velocity(velocity))?;
        }
        set_velocities(engine, |x| Vector::<S>::build(|k| if k == 1 { -speed * x.at(1) / half } else { 0.0 }))
    }

    /// Positions of the walls now; the section shrinks with the distances of the side walls.
    fn state(&self, engine: &Engine<S>) -> Stand {
        let distances: Vec<f64> = (0..self.sides.len()).map(|k| distance(engine, k, &self.sides[k])).collect();
        let ratio = |k: usize| distances[k] / self.sides[k].distance;
        let mean = (0..self.sides.len()).map(ratio).sum::<f64>() / self.sides.len() as f64;
        let section = self.section * if S::DIMENSION == 2 { mean } else { mean * mean };
        Stand { height: engine.wall_point(1).at(1) - engine.wall_point(0).at(1), section, distances }
    }
}

/// Force on a wall along its outward normal (N), compression positive.
fn pressure<S: Space>(engine: &Engine<S>, wall: usize) -> f64 {
    -engine.wall_force(wall).dot(engine.wall_normal(wall))
}

/// Distance of side wall `k` from the axis (m).
fn distance<S: Space>(engine: &Engine<S>, k: usize, side: &Side) -> f64 {
    let point = engine.wall_point(k + 2);
    (0..S::DIMENSION).map(|axis| point.at(axis) * side.normal[axis]).sum()
}

fn read<S: Space>(engine: &Engine<S>, sides: &[Side], start: &Stand) -> Reading {
    let [force, asymmetry] = balance([0, 1].map(|wall| engine.wall_force(wall).at(1).abs()));
    let n = sides.len() as f64;
    let confinement = sides.iter().zip(2..).map(|(side, wall)| pressure(engine, wall) / side.area).sum::<f64>() / n;
    let opening = |(k, side): (usize, &Side)| distance(engine, k, side) / start.distances[k] - 1.0;
    let height = engine.wall_point(1).at(1) - engine.wall_point(0).at(1);
    Reading {
        axial: 1.0 - height / start.height,
        lateral: sides.iter().enumerate().map(opening).sum::<f64>() / n,
        stress: force / start.section - confinement,
        confinement,
        asymmetry,
    }
}
