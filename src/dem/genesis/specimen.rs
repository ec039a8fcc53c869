//! A specimen: packing and aggregate put together, with the report on its quality.
//!
//! The aggregate is placed first, the whole region is packed with mortar balls regardless of it, and the balls whose
//! centres lie in a polygon become the pebbles of its clump. So the grain of the aggregate's surface is that of the
//! mortar, and no ball is squeezed against a smooth face. N of eq. (4) counts balls before clumps.
//!
//! The specimen is **stress-free**: whatever is built on it takes the gaps of the packing as reference gaps, so that
//! the overlaps of the packing (their mean stress is in the report) carry no load. No load is locked in, and nothing
//! has to relax when the vessel is taken away.
//!
//! Seeds: aggregate and packing have streams of their own, so another polygon recipe keeps the packing.

use super::cloud::ball_area;
use super::clump::{Clump, ClumpMass, cut};
use super::fabric::Fabric;
use super::gradation::{Gradation, GradationError};
use super::packing::{Packed, Packing, PackingError};
use super::placement::{DoesNotFit, Placement, place};
use super::polygon::{Polygon, PolygonError, PolygonRecipe};
use super::region::{Point, Region};
use super::relax::Heap;
use crate::Watch;
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// Aggregate of a specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aggregate {
    /// Sizes.
    pub gradation: Gradation,
    /// Bounds of the size classes (m), increasing.
    pub classes: Vec<f64>,
    /// Shapes.
    pub polygons: PolygonRecipe,
    /// Places.
    pub placement: Placement,
    /// Density (kg/m³).
    pub density: f64,
    /// What mass and inertia are computed from.
    pub mass: ClumpMass,
}

/// All that decides a specimen besides its seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Outline.
    pub region: Region,
    /// Packing of the mortar balls.
    pub packing: Packing,
    /// Density of the mortar balls (kg/m³).
    pub density: f64,
    /// Aggregate, if any.
    pub aggregate: Option<Aggregate>,
}

/// A plane specimen, stress-free as it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// Outline; the origin is its centre.
    pub region: Region,
    /// Centres of the balls (m).
    pub centres: Vec<Point>,
    /// Radii (m).
    pub radii: Vec<f64>,
    /// Density of the mortar balls (kg/m³).
    pub density: f64,
    /// Outlines of the aggregate, largest first.
    pub polygons: Vec<Polygon>,
    /// Rigid clumps.
    pub clumps: Vec<Clump>,
}

/// The numbers by which a specimen is judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Balls, pebbles included.
    pub balls: usize,
    /// Mean radius (m).
    pub mean_radius: f64,
    /// Smallest and largest radius (m).
    pub radius_range: [f64; 2],
    /// Mean radius over the one asked for, which gives way to N and the porosity.
    pub radius_factor: f64,
    /// 1 − Σ π R² / area, overlaps counted twice.
    pub porosity: f64,
    /// Contacts, overlaps, stress of the packing.
    pub fabric: Fabric,
    /// Rounds of enlarging floaters.
    pub floater_rounds: usize,
    /// Largest factor on a floater's radius.
    pub floater_growth: f64,
    /// Mean unbalanced force over mean contact force of the packing.
    pub unbalanced: f64,
    /// Narrowest extent over the mean diameter.
    pub particles_across: f64,
    /// Contacts between mortar balls, between mortar and clumps, between clumps.
    pub contacts: [usize; 3],
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
    /// Floaters left.
    #[error("{floaters} balls have fewer than 3 contacts after {rounds} rounds of enlarging them")]
    Floaters {
        /// Balls left floating.
        floaters: usize,
        /// Rounds spent.
        rounds: usize,
    },
}

/// Why a specimen cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecimenError {
    /// Packing.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Gradation.
    #[error(transparent)]
    Gradation(#[from] GradationError),
    /// Polygons.
    #[error(transparent)]
    Polygon(#[from] PolygonError),
    /// Placement.
    #[error(transparent)]
    Placement(#[from] DoesNotFit),
    /// A number outside its range.
    #[error("specimen: {name} is {found}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: f64,
        /// What it must be.
        expected: &'static str,
    },
}

impl Recipe {
    /// All that can be found wrong without making the specimen.
    pub fn faults(&self) -> Vec<SpecimenError> {
        let mut faults: Vec<SpecimenError> = self.packing.faults(&self.region).into_iter().map(Into::into).collect();
        let mut need = |ok: bool, name, found, expected| {
            if !ok {
                faults.push(SpecimenError::Value { name, found, expected });
            }
        };
        need(self.density > 0.0, "density", self.density, "positive");
        if let Some(aggregate) = &self.aggregate {
            let placement = &aggregate.placement;
            need(aggregate.density > 0.0, "aggregate density", aggregate.density, "positive");
            need(placement.gap >= 0.0, "aggregate gap", placement.gap, "a length of at least 0");
            need(placement.wall_gap >= 0.0, "aggregate wall gap", placement.wall_gap, "a length of at least 0");
            need(placement.attempts > 0, "attempts", 0.0, "at least 1");
            faults.extend(aggregate.polygons.faults().into_iter().map(SpecimenError::from));
            if let Err(bad) = aggregate.gradation.classes(&aggregate.classes, self.region.area()) {
                faults.extend(bad.into_iter().map(SpecimenError::from));
            }
        }
        faults
    }

    /// Makes the specimen, with the report on it; another seed gives another packing and another aggregate. The packing
    /// asks `watch` again and again whether to go on.
    ///
    /// # Errors
    /// All faults of the recipe, or the one reason why aggregate or packing came to nothing.
    pub fn make(&self, seed: u64, watch: &dyn Fn() -> Watch) -> Result<(Specimen, Quality), Vec<SpecimenError>> {
        let faults = self.faults();
        if !faults.is_empty() {
            return Err(faults);
        }
        let (polygons, circles) = self.place_aggregate(seed)?;
        let packed = self
            .packing
            .pack(&self.region, &mut Stream::new(seed, "packing", 0), watch)
            .map_err(|error| vec![error.into()])?;
        let clumps = self.aggregate.as_ref().map_or_else(Vec::new, |aggregate| {
            cut(&polygons, &packed.heap.centres, &packed.heap.radii, aggregate.density, aggregate.mass)
        });
        let quality = Quality::of(&packed, &polygons, &clumps, circles);
        let Heap { region, centres, radii } = packed.heap;
        Ok((Specimen { region, centres, radii, density: self.density, polygons, clumps }, quality))
    }

    /// The polygons and the total area of their size circles (m²).
    fn place_aggregate(&self, seed: u64) -> Result<(Vec<Polygon>, f64), Vec<SpecimenError>> {
        let Some(aggregate) = &self.aggregate else { return Ok((Vec::new(), 0.0)) };
        let as_list = |faults: Vec<GradationError>| faults.into_iter().map(SpecimenError::from).collect::<Vec<_>>();
        let classes = aggregate.gradation.classes(&aggregate.classes, self.region.area()).map_err(as_list)?;
        let stream = &mut Stream::new(seed, "aggregate", 0);
        let polygons = place(&classes, &aggregate.polygons, &aggregate.placement, &self.region, stream)
            .map_err(|error| vec![error.into()])?;
        let circle = |d: f64| std::f64::consts::FRAC_PI_4 * d * d;
        let circles = classes.iter().map(|class| class.count as f64 * circle(class.middle())).sum();
        Ok((polygons, circles))
    }
}

impl Specimen {
    /// The clump of every ball, none for mortar.
    pub fn clump_of_balls(&self) -> Vec<Option<usize>> {
        clump_of_balls(self.radii.len(), &self.clumps)
    }

    /// Mean radius (m).
    pub fn mean_radius(&self) -> f64 {
        self.radii.iter().sum::<f64>() / self.radii.len() as f64
    }
}

impl Quality {
    fn of(packed: &Packed, polygons: &[Polygon], clumps: &[Clump], circles: f64) -> Self {
        let Heap { region, radii, .. } = &packed.heap;
        let (area, all) = (region.area(), ball_area(radii));
        let mean_radius = radii.iter().sum::<f64>() / radii.len() as f64;
        let bounds = |(low, high): (f64, f64), &r: &f64| (low.min(r), high.max(r));
        let (smallest, largest) = radii.iter().fold((f64::INFINITY, 0.0), bounds);
        let pebbles: Vec<f64> = clumps.iter().flat_map(|clump| &clump.pebbles).map(|&i| radii[i]).collect();
        Self {
            balls: radii.len(),
            mean_radius,
            radius_range: [smallest, largest],
            radius_factor: packed.radius_factor,
            porosity: 1.0 - all / area,
            fabric: Fabric::of(&packed.heap),
            floater_rounds: packed.floater_rounds,
            floater_growth: packed.floater_growth,
            unbalanced: packed.unbalanced,
            particles_across: region.narrowest() / (2.0 * mean_radius),
            contacts: contacts_by_kind(&packed.heap, clumps),
            circle_fraction: circles / area,
            polygon_fraction: polygons.iter().fold(0.0, |sum, p| sum + p.moments().area) / area,
            pebble_fraction: ball_area(&pebbles) / all,
            polygons: polygons.len(),
            empty_polygons: polygons.len() - clumps.len(),
        }
    }

    /// What should be known before results on the specimen are believed.
    pub fn warnings(&self) -> Vec<SpecimenWarning> {
        let mut warnings = Vec::new();
        if self.particles_across < 10.0 {
            warnings.push(SpecimenWarning::FewAcross(self.particles_across));
        }
        if self.balls < 2000 {
            warnings.push(SpecimenWarning::FewBalls(self.balls));
        }
        if self.empty_polygons > 0 {
            warnings.push(SpecimenWarning::EmptyPolygons { empty: self.empty_polygons, polygons: self.polygons });
        }
        if self.fabric.floaters > 0 {
            let (floaters, rounds) = (self.fabric.floaters, self.floater_rounds);
            warnings.push(SpecimenWarning::Floaters { floaters, rounds });
        }
        warnings
    }
}

fn clump_of_balls(balls: usize, clumps: &[Clump]) -> Vec<Option<usize>> {
    let mut of = vec![None; balls];
    for (index, clump) in clumps.iter().enumerate() {
        for &pebble in &clump.pebbles {
            of[pebble] = Some(index);
        }
    }
    of
}

/// Contacts mortar–mortar, mortar–clump, clump–clump; those inside a clump are none.
fn contacts_by_kind(heap: &Heap, clumps: &[Clump]) -> [usize; 3] {
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

#[cfg(test)]
mod tests {
    use super::super::placement::ClassSize;
    use super::super::polygon::{AngleLaw, SizeRule};
    use super::*;

    fn recipe() -> Recipe {
        Recipe {
            region: Region::Rectangle { width: 0.1, height: 0.2 },
            packing: Packing { porosity: 0.12, mean_radius: 1.6e-3, ratio: 2.5, floaters: 0.0 },
            density: 2000.0,
            aggregate: Some(Aggregate {
                gradation: Gradation::Walraven { content: 0.75, max_size: 0.015 },
                classes: vec![0.005, 0.007, 0.009, 0.011, 0.013, 0.015],
                polygons: PolygonRecipe {
                    min_vertices: 4,
                    max_vertices: 6,
                    size: SizeRule::EqualArea,
                    angles: AngleLaw::Jittered,
                    least_fill: 0.05,
                },
                placement: Placement { gap: 0.5e-3, wall_gap: 1e-3, attempts: 10_000, class_size: ClassSize::Middle },
                density: 2650.0,
                mass: ClumpMass::Union,
            }),
        }
    }

    #[test]
    fn a_specimen_reports_its_own_numbers() {
        let (specimen, quality) = recipe().make(1, &|| Watch::Continue).unwrap();
        assert_eq!(quality.balls, 2188);
        assert!((quality.porosity - 0.12).abs() < 1e-12);
        assert!((quality.circle_fraction - 0.2887).abs() < 1e-4, "{}", quality.circle_fraction);
        assert!((quality.polygon_fraction - 0.2887).abs() < 1e-4);
        assert!((quality.pebble_fraction - 0.2887).abs() < 0.03, "{}", quality.pebble_fraction);
        let pairs: usize = quality.contacts.iter().sum();
        assert!(quality.contacts.iter().all(|&n| n > 0) && 2 * pairs < (quality.fabric.coordination * 2188.0) as usize);
        let mass: f64 = specimen.clumps.iter().map(|clump| clump.mass).sum();
        assert!(mass > 0.8 * 0.2887 * 0.02 * 2650.0 && mass < 0.2887 * 0.02 * 2650.0 * 1.05, "{mass}");
        assert!(quality.warnings().iter().all(|w| matches!(w, SpecimenWarning::EmptyPolygons { .. })));
    }

    #[test]
    fn the_aggregate_does_not_change_the_packing() {
        let plain = Recipe { aggregate: None, ..recipe() };
        let ((with, _), (without, quality)) =
            (recipe().make(3, &|| Watch::Continue).unwrap(), plain.make(3, &|| Watch::Continue).unwrap());
        assert_eq!(with.centres, without.centres);
        assert!(without.clumps.is_empty() && quality.polygon_fraction == 0.0 && quality.pebble_fraction == 0.0);
        assert_eq!(quality.contacts[1..], [0, 0]);
    }

    #[test]
    fn faults_of_all_parts_come_together() {
        let mut bad = recipe();
        bad.density = -1.0;
        bad.packing.porosity = 2.0;
        if let Some(aggregate) = &mut bad.aggregate {
            aggregate.polygons.min_vertices = 1;
            aggregate.gradation = Gradation::Walraven { content: 2.0, max_size: 0.015 };
        }
        assert_eq!(bad.make(1, &|| Watch::Continue).unwrap_err().len(), 4);
    }
}
