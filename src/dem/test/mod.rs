//! Loading tests.
pub mod curve;
pub mod gauge;
