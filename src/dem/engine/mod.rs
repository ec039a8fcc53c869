//! The engine: bodies, contacts and the clock, and what a caller may ask of them.

mod access;
mod bonding;
mod build;
mod change;
mod domain;
mod energy;
mod joints;
mod list;
mod march;
mod refuse;
mod run;
mod timestep;
mod validate;

pub use joints::Fracture;

use super::body::Rigid;
use super::boundary::{Cell, Motion, MovingCell, Wall};
use super::contact::{Face, LawKind};
use super::interaction::ContactTable;
use super::law::{Constants, ENERGIES};
use super::particle::{Clump, Group, Particle};
use super::simd::{Quad, Table, Width};
use super::space::{Space, Spin, Vector};
use crate::measure::Crack;
use domain::Domain;
use std::collections::BTreeMap;

/// Numbers of a run that belong to no body.
#[derive(Clone, Debug)]
pub struct Settings<S: Space> {
    /// Local damping α, 0 … 1.
    pub damping: f64,
    /// Gravity, m/s².
    pub gravity: Vector<S>,
    /// Share of the critical time step.
    pub safety: f64,
    /// A time step to use instead of the derived one, s.
    pub fixed_step: Option<f64>,
    /// Which masses move the bodies.
    pub masses: Masses,
    /// Corners of the box that no particle's centre may leave, m.
    pub bounds: Option<[Vector<S>; 2]>,
    /// A periodic cell, instead of walls. Velocities of the model come on top of the cell's own motion.
    pub cell: Option<Cell<S>>,
    /// Overlap over the smaller radius, or over the ball's at a pebble of a clump, above which a start is refused; infinite while a
    /// packing is being made.
    pub overlap_limit: f64,
}

impl<S: Space> Default for Settings<S> {
    fn default() -> Self {
        use super::space::Tuple;
        Self {
            damping: 0.7,
            gravity: Vector::<S>::zero(),
            safety: 0.8,
            fixed_step: None,
            masses: Masses::Real,
            bounds: None,
            cell: None,
            overlap_limit: 0.5,
        }
    }
}

/// Which masses move the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Masses {
    /// Their own.
    #[default]
    Real,
    /// Mass proportional to stiffness at the same total, so that every body has one critical step: fewer steps to the
    /// same strain in a quasi-static run. Weight stays that of the real mass.
    EqualStep,
}

/// Everything that makes an engine.
#[derive(Clone, Debug)]
pub struct Model<S: Space> {
    /// Balls, pebbles of clumps among them.
    pub particles: Vec<Particle<S>>,
    /// Rigid clumps.
    pub clumps: Vec<Clump<S>>,
    /// Flat walls.
    pub walls: Vec<Wall<S>>,
    /// Laws between groups.
    pub contacts: ContactTable,
    /// The rest.
    pub settings: Settings<S>,
}

/// A class of contacts in the form in which the loop uses it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Class {
    pub(crate) law: LawKind,
    pub(crate) constants: Constants,
}

/// A wall in motion.
#[derive(Clone, Debug)]
pub(crate) struct MovingWall<S: Space> {
    pub(crate) face: Face<S>,
    pub(crate) motion: Motion<S>,
    pub(crate) group: Group,
    pub(crate) present: bool,
    /// Where its point was when the contacts were listed, m.
    pub(crate) origin: Vector<S>,
    /// Sum of the normal stiffnesses of its listed contacts, N/m.
    pub(crate) stiffness: f64,
}

/// A model in motion. See the head of [`crate`] for how it is used.
#[derive(Clone, Debug)]
pub struct Engine<S: Space> {
    settings: Settings<S>,
    table: ContactTable,
    classes: Vec<Class>,
    /// Particles are in the engine's own order: `caller[p]` is the caller's index of particle p, and `index` the reverse.
    caller: Vec<u32>,
    index: Vec<u32>,
    groups: Vec<Group>,
    /// Body of each particle: clumps first, then single balls.
    bodies: Vec<u32>,
    radii: Vec<f64>,
    masses: Vec<f64>,
    inertias: Vec<f64>,
    /// Mass and inertia that move each ball: its own, or those of [`Masses::EqualStep`].
    moving: Vec<[f64; 2]>,
    fixed: Vec<[bool; 2]>,
    /// Constant loads on bodies, by their first particle.
    applied: BTreeMap<usize, (Vector<S>, Spin<S>)>,
    records: Table,
    spare: Table,
    inverse: Table,
    inverse_mass: Vec<f64>,
    weights: Vec<Quad>,
    /// Clumps are in the order of their pebbles; `clump_index` leads from the caller's index to theirs,
    /// `clump_caller` back.
    clumps: Vec<Rigid<S>>,
    clump_index: Vec<u32>,
    clump_caller: Vec<u32>,
    walls: Vec<MovingWall<S>>,
    cell: Option<MovingCell<S>>,
    joints: joints::Joints<S>,
    domains: Vec<Domain>,
    threads: usize,
    width: Width,
    cracks: Vec<Crack<S>>,
    /// Contacts nearer than this are listed; `travelled` bounds how far any body came since, from `origins`.
    margin: f64,
    smallest_radius: f64,
    travelled: f64,
    origins: Vec<Vector<S>>,
    listed_at: u64,
    checked_at: u64,
    stale: bool,
    dt: f64,
    step: u64,
    /// Time at the step from which `dt` holds, s, and that step.
    epoch: (f64, u64),
    /// Energy spent up to the last renewal of the list, and the total at the start, if a run tracks its energy.
    energy_sums: Option<EnergySums>,
}

/// The energy balance, J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EnergySums {
    /// Rows of the contacts' accounts.
    pub(crate) contacts: [f64; ENERGIES],
    /// Local damping, prescribed motion.
    pub(crate) bodies: [f64; 2],
    /// Kinetic, strain and potential energy when the books were opened.
    pub(crate) initial: f64,
}

/// What a watcher of a run wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Go on.
    Continue,
    /// Continue, with up to this many threads from now on.
    Threads(usize),
    /// End the run here.
    Stop,
}

/// How a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All steps were made.
    Finished,
    /// The watcher stopped it.
    Stopped,
}
