//! How much of each interface is broken at a moment of a run, from its record of cracks.

use super::run::Run;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

/// An interface of which something is broken.
#[derive(Clone, Debug, PartialEq)]
pub struct Damaged {
    /// Its two bodies, from 0.
    pub bodies: [usize; 2],
    /// Elements of it that broke so far.
    pub cracks: usize,
    /// Share of its area that is broken, above 0.
    pub share: f64,
    /// Broken area: m² per metre of thickness in the plane, m² in space.
    pub area: f64,
    /// Width of the whole interface in the plane, its diameter in space (m).
    pub width: f64,
    /// Row of its last crack in the table of cracks.
    pub row: usize,
}

impl Run {
    /// The damaged interfaces up to an axial strain, in the order of their bodies; `None` for a run whose record does not name
    /// them.
    pub fn damaged(&self, until: f64) -> Option<Vec<Damaged>> {
        let (cracks, interfaces) = self.cracks.as_ref().zip(self.interfaces.as_ref())?;
        let plane = cracks.position.ncols() == 2;
        let mut found: BTreeMap<[usize; 2], Damaged> = BTreeMap::new();
        for row in (0..interfaces.damage.len()).filter(|&row| cracks.axial_strain[row] <= until) {
            let bodies = [interfaces.first[row], interfaces.second[row]];
            let (size, elements) = (cracks.size[row], interfaces.elements[row] as f64);
            let element = if plane { size } else { FRAC_PI_4 * size * size };
            let width = if plane { size * elements } else { size * elements.sqrt() };
            let fresh = Damaged { bodies, cracks: 0, share: 0.0, area: 0.0, width, row };
            let one = found.entry(bodies).or_insert(fresh);
            one.cracks += 1;
            one.area += element;
            (one.share, one.row) = (interfaces.damage[row], row);
        }
        Some(found.into_values().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::run::{CrackMode, Cracks, Interfaces, Responses};
    use ndarray::Array2;

    /// Cracks 1 and 3 are elements of one interface of four, crack 2 is the only one of an interface of one.
    fn run(axes: usize) -> Run {
        let cracks = Cracks {
            axial_strain: vec![1e-4, 2e-4, 3e-4],
            mode: vec![CrackMode::Tension; 3],
            group: vec![String::new(); 3],
            position: Array2::zeros((3, axes)),
            normal: Array2::zeros((3, axes)),
            size: vec![0.5e-3, 2e-3, 0.5e-3],
        };
        let interfaces = Interfaces {
            first: vec![4, 1, 4],
            second: vec![7, 2, 7],
            element: vec![3, 0, 1],
            elements: vec![4, 1, 4],
            contact: Array2::zeros((3, axes)),
            damage: vec![0.25, 1.0, 0.5],
        };
        Run { cracks: Some(cracks), interfaces: Some(interfaces), ..Run::plain("", Responses::default()) }
    }

    #[test]
    fn broken_elements_of_an_interface_add_up() {
        let one = |until: f64| run(2).damaged(until).unwrap();
        assert_eq!(one(0.5e-4), []);
        let first = Damaged { bodies: [4, 7], cracks: 1, share: 0.25, area: 0.5e-3, width: 2e-3, row: 0 };
        assert_eq!(one(1.5e-4), std::slice::from_ref(&first));
        let whole = Damaged { bodies: [1, 2], cracks: 1, share: 1.0, area: 2e-3, width: 2e-3, row: 1 };
        assert_eq!(one(1.0), [whole, Damaged { cracks: 2, share: 0.5, area: 1e-3, row: 2, ..first }]);
    }

    #[test]
    fn in_space_elements_are_discs_of_their_area() {
        let all = run(3).damaged(1.0).unwrap();
        // Four elements of diameter 0.5 mm have the area of a disc of 1 mm.
        assert!((all[1].width - 1e-3).abs() < 1e-18);
        assert!((all[1].area - 0.5 * FRAC_PI_4 * 1e-6).abs() < 1e-20);
    }

    #[test]
    fn a_run_of_other_bonds_has_no_interfaces() {
        assert_eq!(Run { interfaces: None, ..run(2) }.damaged(1.0), None);
    }
}
