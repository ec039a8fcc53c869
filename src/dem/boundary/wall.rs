//! A flat, infinite, rigid wall (a line in the plane) that touches balls on one side.
//!
//! Servo: wall velocity = G (σ − σ_target) along the outward normal, G = α A / (Σ k_n dt), capped; σ = F / A with F the
//! force of the balls on the wall along its outward normal (compression positive). α = 0.5 is usual.

use crate::particle::Group;
use crate::space::{Space, Vector};

/// How a wall moves.
#[derive(Clone, Copy, Debug)]
pub enum Motion<S: Space> {
    /// Constant velocity, m/s.
    Velocity(Vector<S>),
    /// Holds a pressure.
    Servo(Servo),
}

/// A wall that holds a pressure by moving along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Target pressure, Pa, compression positive.
    pub pressure: f64,
    /// Area on which it acts, m² (length in the plane).
    pub area: f64,
    /// α: relaxation of the gain, 0 … 1.
    pub relaxation: f64,
    /// Largest speed, m/s.
    pub speed_limit: f64,
}

/// A flat wall.
#[derive(Clone, Debug)]
pub struct Wall<S: Space> {
    /// A point on it, m.
    pub point: Vector<S>,
    /// Unit normal into the specimen.
    pub normal: Vector<S>,
    /// How it moves.
    pub motion: Motion<S>,
    /// Contact group.
    pub group: Group,
}
