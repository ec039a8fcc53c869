//! Flat walls and how they move.

mod wall;

pub use wall::{Motion, Servo, Wall};
