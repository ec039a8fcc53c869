//! Measurements: functions of the state that change nothing.

mod balance;
mod cracks;
mod fabric;
mod stress;

pub use balance::unbalanced_ratio;
pub use cracks::{Crack, Mode};
pub use fabric::{Chain, Coordination, coordination, fabric, force_chains};
pub use stress::{Region, stress};
