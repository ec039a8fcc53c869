//! What a heap of balls at rest looks like: contacts, overlaps, stress.
//!
//! ```text
//! coordination = 2 C / N,  C contacts between N balls (walls not counted; a contact with a stone counts once)
//! σ_ij = (1/Ω) Σ f_i l_j,  f = k_n U n and l from centre to centre (or to the wall), for a modulus of 1 Pa;  compression positive
//! F_ij = mean of n_i n_j over the contacts between balls
//! a = √(8 F'·F') in the plane, (15/2) √(3/2 F'·F') in the solid,  F' the deviator of F
//! ```
//!
//! a is the amplitude of the density of contact normals, 1 + a cos 2(θ − θ₀) in the plane: Rothenburg & Bathurst 1989,
//! Géotechnique 39, 601, doi:10.1680/geot.1989.39.4.601; in the solid that of Guo & Zhao 2013, Comput. Geotech. 47, 1.

use super::heap::{Heap, Overlap};
use crate::measure::{Dyads, mean_dyad};
use crate::space::{Space, Tuple, Vector};
use serde::{Deserialize, Serialize};

/// Contacts, overlaps and stress of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// Contacts with balls and stones per ball.
    pub coordination: f64,
    /// Balls with fewer contacts than hold a ball ([`held`]), walls counted.
    pub floaters: usize,
    /// Mean overlap between balls over the smaller radius.
    pub mean_overlap: f64,
    /// Largest overlap over the smaller radius.
    pub largest_overlap: f64,
    /// Mean stress over the modulus of the packing contacts.
    pub mean_stress: f64,
    /// (σ_across − σ_along) / (σ_across + σ_along), the mean of both where there are two axes across.
    pub anisotropy: f64,
    /// Amplitude a of the density of contact normals.
    pub normals: f64,
    /// Contacts between balls.
    pub contacts: usize,
}

/// Contacts that hold a frictionless ball in place: 3 in the plane, 4 in the solid.
pub fn held<S: Space>() -> u32 {
    S::DIMENSION as u32 + 1
}

/// Mean stress of a heap, and its change when all radii are multiplied by 1 + a and nothing moves, dσ/da; both for a
/// modulus of 1 Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressure {
    /// Mean stress.
    pub stress: f64,
    /// dσ/da.
    pub slope: f64,
}

impl Pressure {
    /// Reads the heap. dσ/da = Σ l k_n Φ / (d Ω), Φ the sum of a contact's radii (the radius at a wall): Potyondy & Cundall
    /// 2004, doi:10.1016/j.ijrmms.2004.09.011, eq. (12), to first order in the overlaps.
    pub fn of<S: Space>(heap: &Heap<S>) -> Self {
        let (mut stress, mut slope) = (0.0, 0.0);
        heap.overlaps(|overlap| {
            let length = branch(heap, &overlap);
            stress += overlap.stiffness * overlap.depth * length;
            slope += overlap.stiffness * length * (length + overlap.depth);
        });
        let share = 1.0 / (S::DIMENSION as f64 * heap.room());
        Self { stress: stress * share, slope: slope * share }
    }
}

impl Fabric {
    /// Reads the heap; a heap without contacts has zeros.
    pub fn of<S: Space>(heap: &Heap<S>) -> Self {
        let still = heap.still.pebbles;
        let (mut overlaps, mut largest, mut ends) = (0.0, 0.0_f64, 0);
        let mut stress = Dyads::<S>::default();
        let mut normals: Vec<Vector<S>> = Vec::new();
        heap.overlaps(|overlap| {
            let relative = heap.relative(&overlap);
            largest = largest.max(relative);
            if let Some(second) = overlap.second {
                ends += usize::from(overlap.first >= still) + usize::from(second >= still);
                overlaps += relative;
                normals.push(overlap.normal);
            }
            let force = overlap.stiffness * overlap.depth * branch(heap, &overlap);
            stress.add(overlap.normal.times(force), overlap.normal);
        });
        let (contacts, dimension) = (normals.len(), S::DIMENSION);
        let [x, y, z] = std::array::from_fn(|k| stress.sum[k][k]);
        let across = if dimension == 2 { x } else { 0.5 * (x + z) };
        let sum = across + y;
        let counts = &heap.contact_counts()[still..];
        Self {
            coordination: ends as f64 / counts.len() as f64,
            floaters: counts.iter().filter(|&&n| n < held::<S>()).count(),
            mean_overlap: if contacts > 0 { overlaps / contacts as f64 } else { 0.0 },
            largest_overlap: largest,
            mean_stress: (x + y + z) / dimension as f64 / heap.room(),
            anisotropy: if sum > 0.0 { (across - y) / sum } else { 0.0 },
            normals: amplitude(&mean_dyad::<S>(normals.into_iter()), dimension),
            contacts,
        }
    }
}

/// Distance from centre to centre, or from the centre to the wall or stone (m): stresses are those of the room between them.
fn branch<S: Space>(heap: &Heap<S>, overlap: &Overlap<S>) -> f64 {
    let [first, second] = heap.ends(overlap);
    if overlap.first < heap.still.pebbles {
        return second - overlap.depth;
    }
    first + if second.is_finite() { second } else { 0.0 } - overlap.depth
}

/// a of a fabric tensor; 0 where there are no contacts.
fn amplitude(fabric: &[[f64; 3]; 3], dimension: usize) -> f64 {
    let trace: f64 = (0..dimension).map(|k| fabric[k][k]).sum();
    let deviator = |a: usize, b: usize| fabric[a][b] - if a == b { trace / dimension as f64 } else { 0.0 };
    let square: f64 =
        (0..dimension).flat_map(|a| (0..dimension).map(move |b| (a, b))).map(|(a, b)| deviator(a, b).powi(2)).sum();
    if dimension == 2 { (8.0 * square).sqrt() } else { 7.5 * (1.5 * square).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::super::heap::Still;
    use super::super::region::Region;
    use super::*;
    use crate::{D2, D3};

    /// Square lattice of unit discs compressed by strain e in a box that just holds it: every row carries
    /// kn U = 2 R e per 2 R, so both stresses are e per unit modulus.
    #[test]
    fn a_square_lattice_carries_its_strain() {
        let (n, e) = (6, 0.01);
        let side = 2.0 * f64::from(n) * (1.0 - e);
        let step = side / f64::from(n);
        let at = |k: i32| (f64::from(k) + 0.5) * step - 0.5 * side;
        let centres = (0..n * n).map(|k| [at(k % n), at(k / n)]).collect();
        let heap = Heap::<D2> {
            region: Region::Rectangle { width: side, height: side },
            centres,
            radii: vec![1.0; 36],
            still: Still::default(),
        };
        let fabric = Fabric::of(&heap);
        assert!((fabric.coordination - 2.0 * 60.0 / 36.0).abs() < 1e-12);
        assert_eq!(fabric.floaters, 0);
        assert!((fabric.mean_overlap - 2.0 * e).abs() < 1e-12 && (fabric.largest_overlap - 2.0 * e).abs() < 1e-12);
        // Σ f l over n rows of n−1 contacts (f = 2e, l = step) and 2 walls (f = 2 · e, l = 1 − e) over side².
        assert!((fabric.mean_stress - 2.0 * e / step).abs() < 1e-12, "{}", fabric.mean_stress);
        assert!(fabric.anisotropy.abs() < 1e-12 && fabric.normals.abs() < 1e-12);
    }

    /// A cube of unit spheres: k_n = π/2 between them and π at a wall, so every row of n carries π e over (2 (1 − e))²; four
    /// of six contacts of a sphere inside lie across the load. The slope is the difference of two states.
    #[test]
    fn a_cubic_lattice_carries_its_strain() {
        let (n, e) = (4, 0.01);
        let side = 2.0 * f64::from(n) * (1.0 - e);
        let step = side / f64::from(n);
        let at = |k: i32| (f64::from(k) + 0.5) * step - 0.5 * side;
        let centres = (0..n * n * n).map(|k| [at(k % n), at(k / n % n), at(k / n / n)]).collect();
        let region = Region::Box { width: side, height: side, depth: side };
        let heap = Heap::<D3> { region, centres, radii: vec![1.0; 64], still: Still::default() };
        let fabric = Fabric::of(&heap);
        assert!((fabric.coordination - 2.0 * 144.0 / 64.0).abs() < 1e-12);
        let stress = std::f64::consts::PI * e / (step * step);
        assert!((fabric.mean_stress / stress - 1.0).abs() < 1e-12, "{}", fabric.mean_stress);
        assert!(fabric.anisotropy.abs() < 1e-12 && fabric.normals.abs() < 1e-12);
        let pressure = |a: f64| Pressure::of(&Heap::<D3> { radii: vec![1.0 + a; 64], ..heap.clone() });
        let slope = (pressure(1e-6).stress / (1.0 + 1e-6) - pressure(-1e-6).stress / (1.0 - 1e-6)) / 2e-6;
        assert!((pressure(0.0).stress / stress - 1.0).abs() < 1e-12);
        assert!((pressure(0.0).slope / slope - 1.0).abs() < 1e-5, "{} {slope}", pressure(0.0).slope);
    }

    /// Density 1 + a cos 2θ has the fabric F₁₁ − F₂₂ = a/2; density 1 + a P₂(cos θ) about an axis F₃₃ − F₁₁ = a/5 with
    /// a_ij n_i n_j = a P₂ and so √(3/2 a_ij a_ij) = 3a/2.
    #[test]
    fn the_amplitude_is_that_of_the_density() {
        let a = 0.3;
        let plane = [[0.5 + a / 4.0, 0.0, 0.0], [0.0, 0.5 - a / 4.0, 0.0], [0.0; 3]];
        assert!((amplitude(&plane, 2) - a).abs() < 1e-15);
        let third = 1.0 / 3.0;
        let solid = [[third - a / 15.0, 0.0, 0.0], [0.0, third - a / 15.0, 0.0], [0.0, 0.0, third + 2.0 * a / 15.0]];
        assert!((amplitude(&solid, 3) - 1.5 * a).abs() < 1e-15);
    }
}
