//! Measurements: functions of the state that change nothing.

mod balance;
mod cracks;
mod energy;
mod fabric;
mod strain;
mod stress;

pub use balance::unbalanced_ratio;
pub use cracks::{Crack, Mode};
pub use energy::{Energy, energy};
pub(crate) use energy::{kinetic, stored};
pub use fabric::{Coordination, Link, coordination, fabric, links};
pub(crate) use fabric::{Dyads, mean_dyad};
pub use strain::{displacement_gradient, velocity_gradient};
pub use stress::{Region, cell_stress, stress};
