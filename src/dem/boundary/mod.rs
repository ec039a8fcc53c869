//! Flat walls and how they move; the periodic cell.

mod cell;
mod wall;

pub use cell::Cell;
pub(crate) use cell::{Image, MovingCell};
pub use wall::{Motion, Servo, Wall};
