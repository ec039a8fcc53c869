//! Measurements: functions of the state that change nothing.

mod cracks;

pub use cracks::{Crack, Mode};
