//! What figures in the plane and in space share: lengths in millimetres, crack modes and groups in their order.

use crate::artifact::run::{CrackMode, Cracks};
use crate::artifact::specimen::Specimen;

/// Metres to millimetres.
pub(super) const MM: f64 = 1e3;

/// The modes that occur, in the order in which they are drawn, and the index of each crack's mode among them.
pub(super) fn modes(cracks: &Cracks) -> (Vec<CrackMode>, Vec<usize>) {
    let found: Vec<CrackMode> = CrackMode::ALL.into_iter().filter(|mode| cracks.mode.contains(mode)).collect();
    let index = cracks.mode.iter().map(|own| found.iter().position(|mode| mode == own).unwrap_or(0)).collect();
    (found, index)
}

/// The group of each ball among those that occur, and their names, in the order of their numbers.
pub(super) fn groups(stored: &Specimen) -> (Vec<usize>, Vec<String>) {
    let used: Vec<i64> = (0..stored.groups.len() as i64).filter(|number| stored.group_of.contains(number)).collect();
    let group = stored.group_of.iter().map(|own| used.iter().position(|number| number == own).unwrap_or(0)).collect();
    (group, used.iter().map(|&number| stored.groups[number as usize].clone()).collect())
}
