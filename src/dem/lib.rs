//! The engine: bonded-particle discrete elements in the plane ([`D2`], discs of unit thickness) and the solid ([`D3`],
//! spheres), from one source over [`Space`]. Pure: values in, values out, the same bits every time. SI units.
//!
//! # How to use it
//! 1. Describe a [`Model`]: `particles` (position, radius, velocity, spin, mass, inertia, [`Group`];
//!    [`Particle::ball`] fills them in from a density), `clumps` (pebbles are particles too, named by their index;
//!    [`Clump::of`] gives them mass and inertia of the union), `walls` (infinite planes; normal into the specimen;
//!    [`Motion::Velocity`] or [`Motion::Servo`]), `contacts` (a [`ContactTable`] with one [`Interaction`] for each pair of
//!    groups that can meet; walls have groups too), `settings` ([`Settings`]: damping 0.7, gravity, safety 0.8, masses).
//! 2. [`Engine::new`] checks it and reports all [`Faults`] at once. Bodies are renumbered along a Morton curve inside;
//!    **the caller's indices (of particles, clumps, walls) name things everywhere in the interface**.
//! 3. Move it: [`Engine::advance`]`(steps)`, or [`Engine::run`]`(steps, every, |engine| Watch::Continue)` to look at it every
//!    `every` steps. A [`Failure`] (escape, instability, not finite) is data. [`Engine::calm`] zeroes velocities,
//!    [`Engine::scale_radii`] grows balls at constant density (stiffnesses follow), [`Engine::set_contacts`] exchanges the
//!    table (say, friction 0 while packing), [`Engine::add_wall`], [`Engine::remove_wall`], [`Engine::move_wall`] change
//!    the vessel, [`Engine::set_motion`] and [`Engine::fix`] prescribe velocities (grips), [`Engine::set_damping`]. Each
//!    checks what it is given; what it refuses, by the same [`Faults`], changes nothing.
//! 4. Bond it: [`Engine::absorb_overlaps`] makes every overlap (walls too) the state of rest,
//!    [`Engine::install_bonds`]`(gap, seed)` bonds what is near enough. Then load it by walls or grips.
//! 5. Read it: `position`, `velocity`, `spin`, `radius`, `group`, `clump`, `wall_point`, `wall_force`, `steps`, `time`,
//!    `time_step`, `cracks`, `contacts()` (each [`Contact`]: ends, normal, point, branch, gap, forces, moment), and the
//!    functions of [`measure`].
//!
//! A `watch` that reads walls and a few gauges every 10–100 steps costs nothing that can be measured; `contacts()` walks
//! the whole list.
//!
//! A bonded block in compression, until it breaks (`examples/` has it in the plane and in space, with its closed forms):
//!
//! ```
//! use dem::*;
//! let (grain, platen, radius, modulus) = (Group(0), Group(1), 0.01, 20e9);
//! let pitch = 3_f64.sqrt() * radius; // of the rows of a hexagonal lattice
//! let centre = |k: usize| [radius * (2 * (k % 8) + (k / 8) % 2) as f64, radius + pitch * (k / 8) as f64];
//! let height = 2.0 * radius + 15.0 * pitch;
//! let wall = |y, up: f64| Wall {
//!     point: [0.0, y],
//!     normal: [0.0, up],
//!     motion: Motion::Velocity([0.0, 0.05 * up]), // m/s
//!     group: platen,
//! };
//! let bond = Bond::Parallel(ParallelBond::new(modulus, 2.0, 20e6, 30e6));
//! let mut engine = Engine::new(&Model {
//!     particles: (0..8 * 16).map(|k| Particle::<D2>::ball(centre(k), radius, 2500.0, grain)).collect(),
//!     clumps: vec![],
//!     walls: vec![wall(0.0, 1.0), wall(height, -1.0)],
//!     contacts: ContactTable::new()
//!         .with(grain, grain, Interaction { linear: Linear::modulus(modulus, 2.0, 0.5), bond })
//!         .with(grain, platen, Interaction::unbonded(Linear::modulus(modulus, 2.0, 0.0))),
//!     settings: Settings::default(),
//! })?;
//! engine.install_bonds(1e-6 * radius, 1)?; // bonds what touches; the seed matters when strengths scatter
//! let mut peak = 0.0_f64;
//! let end = engine.run(100_000, 20, |engine| {
//!     let stress = engine.wall_force(1)[1] / (16.0 * radius); // Pa; compression pushes the upper platen up
//!     peak = peak.max(stress);
//!     if stress < 0.7 * peak && engine.cracks().len() > 10 { Watch::Stop } else { Watch::Continue }
//! })?;
//! assert_eq!(end, Ended::Stopped);
//! assert!(peak > 20e6 && engine.cracks().iter().any(|crack| crack.mode == measure::Mode::Shear));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Theory
//! Explicit leapfrog: positions at t, velocities at t ± dt/2. In a step: contact forces at x(t) with the displacements
//! v(t − dt/2) dt; local damping F − α |F| sign v ([`Settings::damping`], gravity included); velocities, then positions;
//! walls. Laws: linear, contact bond, parallel bond; see [`interaction`] for the moduli.
//!
//! Masses: real, or of one critical step ([`Masses::EqualStep`]). Uniform density scaling is not offered, because it is the
//! same thing as a higher speed: with the density times c² and the speed over c the steps are c times longer and every
//! force is the same.
//!
//! Contacts are listed when nearer than a margin; a reference gap belongs to the pair and stays while the pair is nearer
//! than the smallest radius, so it outlives a loss of contact, at platens too. The time step is derived from the closed
//! and bonded contacts whenever the list is renewed.
//!
//! # Signs
//! The normal of a contact points from its first end outwards; forces of a [`Contact`] act on the first end; a wall's force
//! is what the balls do to it; stress and pressure of walls are positive in compression; gaps are positive when open.

// Loops over axes and tensor components read better with their index.
#![allow(clippy::needless_range_loop)]

mod body;
pub mod boundary;
mod contact;
mod damping;
mod engine;
mod error;
pub mod genesis;
pub mod interaction;
mod law;
pub mod loading;
pub mod measure;
mod neighbour;
pub mod parameter;
mod particle;
pub mod simd;
pub mod space;
pub mod strength;

mod union;

pub use boundary::{Cell, Motion, Servo, Wall};
pub use contact::{Contact, Other};
pub use engine::{Ended, Engine, Fracture, Masses, Model, Settings, Watch};
pub use error::{Failure, Fault, Faults};
pub use interaction::{
    Bond, BondStiffness, ContactBond, ContactTable, Convention, Dashpot, Division, FlatJoint, Interaction, JointBond,
    Linear, NormalForce, ParallelBond, Shares, ShearBreak, SmoothJoint, Stiffness,
};
pub use law::Interface;
pub use math::text::Amount;
pub use particle::{Clump, Group, Particle};
pub use space::{D2, D3, Space, Spin, Vector};
pub use strength::{Distribution, Scatter};
