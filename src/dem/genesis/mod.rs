//! Specimen genesis, in the plane and in the solid: from sizes and radii to a stress-free specimen.
//!
//! * [`region`]: the outline of the specimen and the walls of its vessel
//! * [`sizes`]: radii and their number; [`cloud`]: the loose start; [`heap`]: what touches; [`relax`]: rest state
//!   (`vicinity`: who may touch whom; `repulsion`: their forces)
//! * [`packing`]: to a porosity, to a stress ([`compress`]) or as a [`lattice`]; [`fabric`]: its contacts and stress
//! * [`groups`]: minerals by their share
//! * [`gradation`]: how many particles of aggregate of each size; [`polygon`]: random convex outlines; [`placement`]: their
//!   positions without overlap; [`clump`]: balls inside a polygon as pebbles of a rigid body (plane only)
//! * [`stones`]: clumps of given shapes placed in a solid; [`mix`]: mortar of balls packed around them (`mortar`)
//! * [`network`]: fractures by their statistics
//! * [`specimen`]: all of it put together; [`quality`]: the report on it

pub mod cloud;
pub mod clump;
pub mod compress;
pub mod fabric;
pub mod gradation;
pub mod groups;
pub mod heap;
pub mod lattice;
pub mod mix;
mod mortar;
pub mod network;
pub mod packing;
pub mod placement;
pub mod polygon;
pub mod quality;
pub mod region;
pub mod relax;
mod repulsion;
pub mod sizes;
pub mod specimen;
pub mod stones;
mod vicinity;
