//! Specimen genesis: from a gradation and radii to a bonded, stress-free specimen.
//!
//! * [`gradation`]: how many particles of aggregate of each size
//! * [`polygon`]: random convex outlines; [`placement`]: their places without overlap
//! * [`region`]: the outline of the specimen and the walls of its vessel
//! * [`cloud`], [`relax`], [`packing`]: radii, rest state, dense packing; [`fabric`]: its contacts and stress
//! * [`clump`]: balls inside a polygon as pebbles of a rigid body
//! * [`specimen`]: all of it put together, with a report

pub mod cloud;
pub mod clump;
pub mod fabric;
pub mod gradation;
pub mod packing;
pub mod placement;
pub mod polygon;
pub mod region;
pub mod relax;
pub mod specimen;
