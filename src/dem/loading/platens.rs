//! A piece between two platens that approach each other along y: flat ones, or curved jaws that hold a disc on an arc.
//!
//! A platen is a rigid wall; its contacts have the material's modulus and stiffness ratio (or the modulus that is set) and
//! the platens' own friction, 0 by default. A curved jaw is the envelope of planes that touch the outline along its arc,
//! about two to a mean diameter: a disc bears on each near its own point of touch.

use super::material::{Material, PLATEN};
use super::piece::{Outline, Piece};
use super::rig::{Mounted, mount};
use super::settings::Loading;
use crate::space::Tuple;
use crate::{Engine, Faults, Motion, Space, Vector, Wall};
use math::elementary::sin_cos;
use std::ops::Range;

/// The walls of the two platens, by their indices in the engine, and their distance at the start (m).
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    bottom: Range<usize>,
    top: Range<usize>,
    height: f64,
}

/// Mounts the piece between platens at rest.
///
/// # Errors
/// All faults that the engine finds.
pub fn between_platens<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
) -> Result<(Mounted<S>, Pair), Faults> {
    let angles = arc(test, piece);
    let platen = |side: f64| {
        let wall = move |&angle: &f64| plane(&piece.outline, side, angle);
        angles.iter().map(wall).collect::<Vec<_>>()
    };
    let walls: Vec<Wall<S>> = platen(-1.0).into_iter().chain(platen(1.0)).collect();
    let (n, height) = (angles.len(), piece.outline.height());
    let pair = Pair { bottom: 0..n, top: n..2 * n, height };
    let mounted = mount(piece, material, walls, Vec::new(), (&test.platens, &test.machine), seed)?;
    Ok((mounted, pair))
}

/// Angles against the axis of loading at which a platen touches the outline (rad): 0 alone when it is flat.
fn arc<S: Space>(test: &Loading, piece: &Piece<S>) -> Vec<f64> {
    let (Some(angle), Outline::Disc { diameter, .. }) = (test.particulars.jaw_angle, piece.outline) else {
        return vec![0.0];
    };
    // An odd number, so that the crown has its plane.
    let count = 2 * (0.5 * diameter * angle / (2.0 * piece.mean_radius())).ceil() as usize + 1;
    (0..count).map(|k| angle * (k as f64 / (count - 1) as f64 - 0.5)).collect()
}

/// The plane that touches the outline on the `side` of y (±1), `angle` off the axis.
fn plane<S: Space>(outline: &Outline, side: f64, angle: f64) -> Wall<S> {
    let (sin, cos) = if angle == 0.0 { (0.0, 1.0) } else { sin_cos(angle) };
    let outward = [sin, side * cos, 0.0];
    let reach = 0.5 * outline.height();
    Wall {
        point: Vector::<S>::build(|k| reach * outward[k]),
        normal: Vector::<S>::build(|k| -outward[k]),
        motion: Motion::Velocity(Vector::<S>::zero()),
        group: PLATEN,
    }
}

impl Pair {
    /// Moves the platens towards each other, each at `speed` (m/s).
    ///
    /// # Errors
    /// A speed that is not finite.
    pub fn approach<S: Space>(&self, engine: &mut Engine<S>, speed: f64) -> Result<(), Faults> {
        for (side, walls) in [(-1.0, &self.bottom), (1.0, &self.top)] {
            let velocity = Vector::<S>::build(|k| if k == 1 { -side * speed } else { 0.0 });
            for wall in walls.clone() {
                engine.move_wall(wall, Motion::Velocity(velocity))?;
            }
        }
        Ok(())
    }

    /// How far the platens came towards each other (m).
    pub fn approached<S: Space>(&self, engine: &Engine<S>) -> f64 {
        let crown = |walls: &Range<usize>| engine.wall_point((walls.start + walls.end) / 2).at(1);
        self.height - (crown(&self.top) - crown(&self.bottom))
    }

    /// Forces on the bottom and the top platen along y (N, per metre of thickness in the plane), compression positive.
    pub fn forces<S: Space>(&self, engine: &Engine<S>) -> [f64; 2] {
        let sum = |walls: &Range<usize>| {
            let mut walls = walls.clone().map(|wall| engine.wall_force(wall).at(1));
            let first = walls.next().unwrap_or(0.0);
            walls.fold(first, |sum, force| sum + force).abs()
        };
        [sum(&self.bottom), sum(&self.top)]
    }
}

/// Mean of two platen forces, and their difference over it.
pub fn balance([bottom, top]: [f64; 2]) -> [f64; 2] {
    let mean = 0.5 * (bottom + top);
    [mean, if mean > 0.0 { (top - bottom).abs() / mean } else { 0.0 }]
}
