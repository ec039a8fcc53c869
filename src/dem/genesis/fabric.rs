//! What a heap of discs at rest looks like: contacts, overlaps, stress.
//!
//! ```text
//! coordination = 2 C / N,  C contacts between N balls (walls not counted)
//! σ_ij = (1/A) Σ f_i l_j,  f = kn U n and l from centre to centre (or to the wall), per E* t      compression positive
//! ```

use super::region::Point;
use super::relax::{Heap, Touch};
use serde::{Deserialize, Serialize};

/// Contacts below which a ball floats.
pub const HELD: u32 = 3;

/// Contacts, overlaps and stress of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// 2 × contacts between balls / balls.
    pub coordination: f64,
    /// Balls with fewer than 3 contacts, walls counted.
    pub floaters: usize,
    /// Mean overlap between balls over the smaller radius.
    pub mean_overlap: f64,
    /// Largest overlap over the smaller radius.
    pub largest_overlap: f64,
    /// Mean stress over the modulus of the packing contacts.
    pub mean_stress: f64,
    /// (σ_xx − σ_yy) / (σ_xx + σ_yy).
    pub anisotropy: f64,
}

impl Fabric {
    /// Reads the heap; a heap without contacts has zeros.
    pub fn of(heap: &Heap) -> Self {
        let (mut contacts, mut overlaps, mut largest) = (0_usize, 0.0, 0.0_f64);
        let mut stress: Point = [0.0; 2];
        heap.touches(&heap.pairs(0.0), |touch| {
            let relative = touch.overlap / smaller_radius(heap, &touch);
            largest = largest.max(relative);
            if touch.second.is_some() {
                contacts += 1;
                overlaps += relative;
            }
            let share = touch.stiffness * touch.overlap * branch(heap, &touch);
            stress[0] += share * touch.normal[0] * touch.normal[0];
            stress[1] += share * touch.normal[1] * touch.normal[1];
        });
        let sum = stress[0] + stress[1];
        Self {
            coordination: 2.0 * contacts as f64 / heap.radii.len() as f64,
            floaters: contact_counts(heap).iter().filter(|&&n| n < HELD).count(),
            mean_overlap: if contacts > 0 { overlaps / contacts as f64 } else { 0.0 },
            largest_overlap: largest,
            mean_stress: 0.5 * sum / heap.region.area(),
            anisotropy: if sum > 0.0 { (stress[0] - stress[1]) / sum } else { 0.0 },
        }
    }
}

/// Contacts of every ball, those with walls included.
pub fn contact_counts(heap: &Heap) -> Vec<u32> {
    let mut counts = vec![0; heap.radii.len()];
    heap.touches(&heap.pairs(0.0), |touch| {
        counts[touch.first] += 1;
        if let Some(second) = touch.second {
            counts[second] += 1;
        }
    });
    counts
}

fn smaller_radius(heap: &Heap, touch: &Touch) -> f64 {
    heap.radii[touch.first].min(touch.second.map_or(f64::INFINITY, |j| heap.radii[j]))
}

/// Distance from centre to centre, or from the centre to the wall (m).
fn branch(heap: &Heap, touch: &Touch) -> f64 {
    heap.radii[touch.first] + touch.second.map_or(0.0, |j| heap.radii[j]) - touch.overlap
}

#[cfg(test)]
mod tests {
    use super::super::region::Region;
    use super::*;

    /// Square lattice of unit discs compressed by strain e in a box that just holds it: every row carries
    /// kn U = 2 R e per 2 R, so both stresses are e per unit modulus.
    #[test]
    fn a_square_lattice_carries_its_strain() {
        let (n, e) = (6, 0.01);
        let side = 2.0 * f64::from(n) * (1.0 - e);
        let step = side / f64::from(n);
        let place = |k: i32| (f64::from(k) + 0.5) * step - 0.5 * side;
        let centres = (0..n * n).map(|k| [place(k % n), place(k / n)]).collect();
        let heap = Heap { region: Region::Rectangle { width: side, height: side }, centres, radii: vec![1.0; 36] };
        let fabric = Fabric::of(&heap);
        assert!((fabric.coordination - 2.0 * 60.0 / 36.0).abs() < 1e-12);
        assert_eq!(fabric.floaters, 0);
        assert!((fabric.mean_overlap - 2.0 * e).abs() < 1e-12 && (fabric.largest_overlap - 2.0 * e).abs() < 1e-12);
        // Σ f l over n rows of n−1 contacts (f = 2e, l = step) and 2 walls (f = 2 · e, l = 1 − e) over side².
        assert!((fabric.mean_stress - 2.0 * e / step).abs() < 1e-12, "{}", fabric.mean_stress);
        assert!(fabric.anisotropy.abs() < 1e-12);
    }
}
