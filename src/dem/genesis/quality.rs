//! The report on a specimen: the numbers by which it is judged, and what should be known before results are believed.
//!
//! | warned of | threshold | why |
//! |---|---|---|
//! | particles across the narrowest extent | below 10 | strengths scatter and depend on the grain; 30 and more are advised for them (ISRM asks for 10 grains across a specimen) |
//! | balls | below 2000 | the peak of a test is stable from there on |
//! | floaters | above 0.2 % of the balls | a ball that is not held carries nothing and moves freely |
//! | largest overlap | above 0.35 of the smaller radius | contacts are no longer small against the balls |
//! | fabric or stress anisotropy of the packing | above 0.1, beyond the noise 4/√C of C contacts | the material is not isotropic |
//! | radii | off by more than 5 % from those asked for | strength in a solid, and cracking in the plane, go with the radius |

use super::clump::Clump;
use super::fabric::{Fabric, held};
use super::heap::Heap;
use super::packing::Packed;
use super::polygon::Polygon;
use super::specimen::clump_of_balls;
use crate::space::Space;
use serde::{Deserialize, Serialize};

/// The numbers by which a specimen is judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Balls, pebbles included.
    pub balls: usize,
    /// Mean radius (m); this and the numbers per ball are those of the mortar where there are stones.
    pub mean_radius: f64,
    /// Smallest and largest radius (m).
    pub radius_range: [f64; 2],
    /// Factor on all stated radii, which give way to the porosity or stress.
    pub radius_factor: f64,
    /// 1 − Σ V(R) / Ω, overlaps counted twice.
    pub porosity: f64,
    /// Contacts, overlaps, stress of the packing.
    pub fabric: Fabric,
    /// Contacts that hold a ball: fewer, and it floats.
    pub held: u32,
    /// Rounds of treating floaters.
    pub floater_rounds: usize,
    /// Largest factor on a floater's radius.
    pub floater_growth: f64,
    /// Floaters taken out.
    pub deleted: usize,
    /// Mean unbalanced force over mean contact force of the packing.
    pub unbalanced: f64,
    /// Mean stress of the packing (Pa), where its contacts have a modulus.
    pub stress: Option<f64>,
    /// Narrowest extent over the mean diameter.
    pub particles_across: f64,
    /// Contacts between balls of no clump, between those and clumps, between clumps.
    pub contacts: [usize; 3],
    /// Contacts that can be bonded, at no gap, over balls: all but those inside a clump and between clumps.
    pub bonds_per_ball: f64,
    /// Area of the aggregate's size circles over the region's.
    pub circle_fraction: f64,
    /// Area of the polygons over the region's.
    pub polygon_fraction: f64,
    /// Area of the pebbles (overlaps counted twice) over Σ π R².
    pub pebble_fraction: f64,
    /// Polygons placed.
    pub polygons: usize,
    /// Polygons too small to hold a ball centre.
    pub empty_polygons: usize,
    /// Size classes whose count rounds to nothing.
    pub empty_classes: usize,
}

/// Circles of the sizes of the aggregate.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Circles {
    /// Their area (m²).
    pub(super) area: f64,
    /// Classes without any.
    pub(super) empty_classes: usize,
}

/// A specimen that can be made but should be read with care.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpecimenWarning {
    /// Coarse.
    #[error(
        "only {0:.1} particles across the specimen; below 10 results are meaningless, 30 are advised for strengths: reduce the mean radius"
    )]
    FewAcross(f64),
    /// Few balls.
    #[error("only {0} balls; peak stress is stable from about 2000 on: reduce the mean radius")]
    FewBalls(usize),
    /// Aggregate lost.
    #[error(
        "{empty} of {polygons} polygons hold no ball and are left out: reduce the mean radius or drop the smallest class"
    )]
    EmptyPolygons {
        /// Polygons without a ball centre.
        empty: usize,
        /// All polygons.
        polygons: usize,
    },
    /// Classes lost.
    #[error("{0} size classes of the aggregate round to no particle: the curve is not met there")]
    EmptyClasses(usize),
    /// Floaters left.
    #[error("{floaters} balls have fewer than {held} contacts after {rounds} rounds of treating them")]
    Floaters {
        /// Balls left floating.
        floaters: usize,
        /// Contacts that hold a ball.
        held: u32,
        /// Rounds spent.
        rounds: usize,
    },
    /// Deep overlaps.
    #[error(
        "the largest overlap is {0:.2} of a radius; above 0.35 contacts are not small: raise the porosity or lower the stress"
    )]
    Overlap(f64),
    /// Not isotropic.
    #[error(
        "the packing is not isotropic: anisotropy {stress:.2} of the stress, {normals:.2} of the contact normals (0.1 is the limit)"
    )]
    Anisotropy {
        /// (σ_across − σ_along) / (σ_across + σ_along).
        stress: f64,
        /// Amplitude of the density of normals.
        normals: f64,
    },
    /// Radii far from the stated ones.
    #[error("the radii came out at {0:.3} of the stated ones; with `gives_way = \"number\"` they stay as stated")]
    Radii(f64),
}

const FEWEST_ACROSS: f64 = 10.0;
const FEWEST_BALLS: usize = 2000;
const MOST_FLOATING: f64 = 2e-3;
const DEEPEST: f64 = 0.35;
const MOST_ANISOTROPY: f64 = 0.1;
const MOST_CHANGE: f64 = 0.05;

impl Quality {
    pub(super) fn of<S: Space>(
        packed: &Packed<S>,
        polygons: &[Polygon],
        clumps: &[Clump<S>],
        circles: &Circles,
    ) -> Self {
        let Heap { region, radii, .. } = &packed.heap;
        let (volume, all, free) = (region.volume(), packed.heap.ball_volume(), packed.heap.free());
        let mean_radius = free.iter().sum::<f64>() / free.len() as f64;
        let bounds = |(low, high): (f64, f64), &r: &f64| (low.min(r), high.max(r));
        let (smallest, largest) = free.iter().fold((f64::INFINITY, 0.0), bounds);
        let pebbles: Vec<f64> = clumps.iter().flat_map(|clump| &clump.pebbles).map(|&i| radii[i]).collect();
        let (fabric, contacts) = (Fabric::of(&packed.heap), contacts_by_kind(&packed.heap, clumps));
        Self {
            balls: radii.len(),
            mean_radius,
            radius_range: [smallest, largest],
            radius_factor: packed.radius_factor,
            porosity: 1.0 - all / volume,
            fabric,
            held: held::<S>(),
            floater_rounds: packed.floater_rounds,
            floater_growth: packed.floater_growth,
            deleted: packed.deleted,
            unbalanced: packed.unbalanced,
            stress: packed.modulus.map(|modulus| modulus * fabric.mean_stress),
            particles_across: region.narrowest() / (2.0 * mean_radius),
            contacts,
            bonds_per_ball: (contacts[0] + contacts[1]) as f64 / free.len() as f64,
            circle_fraction: circles.area / volume,
            polygon_fraction: polygons.iter().fold(0.0, |sum, p| sum + p.moments().area) / volume,
            pebble_fraction: super::heap::ball_volume::<S>(&pebbles) / all,
            polygons: polygons.len(),
            // Stones are clumps without polygons.
            empty_polygons: polygons.len().saturating_sub(clumps.len()),
            empty_classes: circles.empty_classes,
        }
    }

    /// What should be known before results on the specimen are believed.
    pub fn warnings(&self) -> Vec<SpecimenWarning> {
        let fabric = &self.fabric;
        let noise = 4.0 / (fabric.contacts.max(1) as f64).sqrt();
        let (stress, normals) = (fabric.anisotropy, fabric.normals);
        let (empty, polygons) = (self.empty_polygons, self.polygons);
        let (floaters, held, rounds) = (fabric.floaters, self.held, self.floater_rounds);
        let rules = [
            (self.particles_across < FEWEST_ACROSS, SpecimenWarning::FewAcross(self.particles_across)),
            (self.balls < FEWEST_BALLS, SpecimenWarning::FewBalls(self.balls)),
            (empty > 0, SpecimenWarning::EmptyPolygons { empty, polygons }),
            (self.empty_classes > 0, SpecimenWarning::EmptyClasses(self.empty_classes)),
            (floaters as f64 > MOST_FLOATING * self.balls as f64, SpecimenWarning::Floaters { floaters, held, rounds }),
            (fabric.largest_overlap > DEEPEST, SpecimenWarning::Overlap(fabric.largest_overlap)),
            (stress.abs().max(normals) > MOST_ANISOTROPY + noise, SpecimenWarning::Anisotropy { stress, normals }),
            ((self.radius_factor - 1.0).abs() > MOST_CHANGE, SpecimenWarning::Radii(self.radius_factor)),
        ];
        rules.into_iter().filter(|rule| rule.0).map(|rule| rule.1).collect()
    }
}

/// Contacts ball–ball, ball–clump, clump–clump; those inside a clump are none.
fn contacts_by_kind<S: Space>(heap: &Heap<S>, clumps: &[Clump<S>]) -> [usize; 3] {
    let of = clump_of_balls(heap.radii.len(), clumps);
    let mut counts = [0; 3];
    for (i, j) in heap.pairs(0.0) {
        match (of[i], of[j]) {
            (None, None) => counts[0] += 1,
            (Some(a), Some(b)) if a != b => counts[2] += 1,
            (Some(_), Some(_)) => {}
            _ => counts[1] += 1,
        }
    }
    counts
}
