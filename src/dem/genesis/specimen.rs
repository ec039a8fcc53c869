//! A specimen: packing, groups and aggregate put together.
//!
//! The aggregate (plane only) is placed first, the whole region is packed with balls regardless of it, and the balls whose
//! centres lie in a polygon become the pebbles of its clump. So the grain of the aggregate's surface is that of the mortar,
//! and no ball is squeezed against a smooth face. N of eq. (4) counts balls before clumps.
//!
//! The specimen is **stress-free**: a test on it takes the gaps of the packing as reference gaps, so that
//! the overlaps of the packing (their mean stress is in the report) carry no load. No load is locked in, and nothing
//! has to relax when the vessel is removed.
//!
//! Seeds: aggregate, packing and groups have streams of their own, so another polygon recipe keeps the packing.

use super::clump::{Clump, ClumpMass, cut};
use super::gradation::{Gradation, GradationError, SizeClass};
use super::groups::{GroupError, Share, assign, group_faults};
use super::heap::Heap;
use super::packing::{Packing, PackingError};
use super::placement::{DoesNotFit, Placement, place};
use super::polygon::{Polygon, PolygonError, PolygonRecipe};
use super::quality::{Circles, Quality};
use super::region::Region;
use super::stones::StoneFault;
use crate::Watch;
use crate::particle::Group;
use crate::space::{D2, Space, Vector, flat};
use math::random::Stream;
use math::text::Amount;
use serde::{Deserialize, Serialize};

/// Aggregate of a plane specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aggregate {
    /// Sizes.
    pub gradation: Gradation,
    /// Bounds of the size classes (m), increasing.
    pub classes: Vec<f64>,
    /// Shapes.
    pub polygons: PolygonRecipe,
    /// Positions.
    pub placement: Placement,
    /// Density (kg/m³).
    pub density: f64,
    /// What mass and inertia are computed from.
    pub mass: ClumpMass,
    /// Name of its particles' group.
    pub group: String,
}

/// All that decides a specimen besides its seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Outline; it decides whether the specimen is plane or solid.
    pub region: Region,
    /// Packing of the balls.
    pub packing: Packing,
    /// Density of the balls (kg/m³).
    pub density: f64,
    /// Groups of the balls that are no aggregate, by their share of the volume.
    pub groups: Vec<Share>,
    /// Aggregate, if any.
    pub aggregate: Option<Aggregate>,
}

/// A specimen, free of stress.
#[derive(Clone, Debug)]
pub struct Specimen<S: Space = D2> {
    /// Outline; the origin is its centre.
    pub region: Region,
    /// Centres of the balls (m).
    pub centres: Vec<Vector<S>>,
    /// Radii (m).
    pub radii: Vec<f64>,
    /// Group of every ball, pebbles included.
    pub groups: Vec<Group>,
    /// Names of the groups, by their numbers; that of the aggregate last, where there is any.
    pub group_names: Vec<String>,
    /// Density of the balls that are no pebbles (kg/m³).
    pub density: f64,
    /// Outlines of the aggregate, largest first.
    pub polygons: Vec<Polygon>,
    /// Rigid clumps.
    pub clumps: Vec<Clump<S>>,
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
    /// Groups.
    #[error(transparent)]
    Groups(#[from] GroupError),
    /// A number outside its range.
    #[error("specimen: {name} is {found:#}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// Stones.
    #[error(transparent)]
    Stones(#[from] StoneFault),
    /// Polygons in a solid.
    #[error(
        "specimen: aggregate is made of polygons and needs a plane outline (a rectangle or a disc), not a solid one"
    )]
    SolidAggregate,
    /// Aggregate that rounds to nothing.
    #[error(
        "aggregate: every size class rounds to no particle at all (the fullest would hold {fullest:.2}); raise the content, take \
         smaller sizes or a larger specimen, or leave the aggregate out"
    )]
    NoAggregate {
        /// Largest expected number of particles in a class.
        fullest: f64,
    },
    /// Aggregate larger than the specimen.
    #[error(
        "aggregate: particles of {} with {} to the walls do not fit into a specimen {} across",
        Amount(*.size, "m"), Amount(*.gap, "m"), Amount(*.narrowest, "m")
    )]
    LargeAggregate {
        /// Largest diameter (m).
        size: f64,
        /// Least distance to the walls (m).
        gap: f64,
        /// Smallest extent of the specimen (m).
        narrowest: f64,
    },
    /// More polygons than can be placed.
    #[error("aggregate: {0:.2e} particles are too many; at most {MOST_POLYGONS:e} are placed: take larger sizes")]
    ManyAggregate(f64),
}

impl SpecimenError {
    /// Whether packing or placing came to this, which no look at the settings could foresee: another seed may come to
    /// something else.
    pub fn is_outcome(&self) -> bool {
        match self {
            Self::Packing(packing) => packing.is_outcome(),
            Self::Placement(_) | Self::Stones(StoneFault::NoPlace { .. }) => true,
            Self::Gradation(_)
            | Self::Stones(_)
            | Self::Polygon(_)
            | Self::Groups(_)
            | Self::Value { .. }
            | Self::SolidAggregate
            | Self::NoAggregate { .. }
            | Self::LargeAggregate { .. }
            | Self::ManyAggregate(_) => false,
        }
    }
}

/// Most polygons that are placed.
pub const MOST_POLYGONS: f64 = 1e5;

impl Recipe {
    /// All that can be found wrong without making the specimen.
    pub fn faults(&self) -> Vec<SpecimenError> {
        let packing = match self.region.dimension() {
            2 => self.packing.faults::<D2>(&self.region),
            _ => self.packing.faults::<crate::D3>(&self.region),
        };
        let mut faults: Vec<SpecimenError> = packing.into_iter().map(Into::into).collect();
        if !(self.density > 0.0) {
            let found = Amount(self.density, "kg/m^3");
            faults.push(SpecimenError::Value { name: "density", found, expected: "positive" });
        }
        let aggregate = self.aggregate.as_ref();
        let name = aggregate.map(|aggregate| aggregate.group.as_str());
        faults.extend(group_faults(&self.groups, name).into_iter().map(SpecimenError::from));
        faults.extend(aggregate.into_iter().flat_map(|aggregate| aggregate.faults(&self.region)));
        faults
    }

    /// Makes the specimen, with the report on it; another seed gives another packing and another aggregate. The packing
    /// asks `watch` again and again whether to go on.
    ///
    /// # Errors
    /// All faults of the recipe, or the one reason why aggregate or packing came to nothing.
    pub fn make<S: Space>(
        &self,
        seed: u64,
        watch: &dyn Fn() -> Watch,
    ) -> Result<(Specimen<S>, Quality), Vec<SpecimenError>> {
        let faults = self.faults();
        if !faults.is_empty() {
            return Err(faults);
        }
        let (polygons, circles) = self.place_aggregate(seed)?;
        let stream = &mut Stream::new(seed, "packing", 0);
        let packed = self.packing.pack::<S>(&self.region, stream, watch).map_err(|error| vec![error.into()])?;
        let clumps = self.aggregate.as_ref().map_or_else(Vec::new, |aggregate| {
            let centres: Vec<[f64; 2]> = packed.heap.centres.iter().map(|&x| plane::<S>(x)).collect();
            let clumps = cut(&polygons, &centres, &packed.heap.radii, aggregate.density, aggregate.mass);
            clumps.into_iter().map(solid).collect()
        });
        let mut groups = assign::<S>(&self.groups, &packed.heap.radii, &mut Stream::new(seed, "groups", 0));
        let pebbles = clumps.iter().flat_map(|clump: &Clump<S>| &clump.pebbles);
        pebbles.for_each(|&pebble| groups[pebble] = Group(self.groups.len() as u8));
        let names = self.groups.iter().map(|group| &group.name).chain(self.aggregate.iter().map(|a| &a.group));
        let group_names = names.cloned().collect();
        let quality = Quality::of(&packed, &polygons, &clumps, &circles);
        let Heap { region, centres, radii, .. } = packed.heap;
        let density = self.density;
        Ok((Specimen { region, centres, radii, groups, group_names, density, polygons, clumps }, quality))
    }

    /// The polygons, and the circles of their sizes.
    fn place_aggregate(&self, seed: u64) -> Result<(Vec<Polygon>, Circles), Vec<SpecimenError>> {
        let Some(aggregate) = &self.aggregate else { return Ok((Vec::new(), Circles::default())) };
        let classes = aggregate.size_classes(&self.region)?;
        let stream = &mut Stream::new(seed, "aggregate", 0);
        let polygons = place(&classes, &aggregate.polygons, &aggregate.placement, &self.region, stream)
            .map_err(|error| vec![error.into()])?;
        let circle = |d: f64| std::f64::consts::FRAC_PI_4 * d * d;
        let area = classes.iter().map(|class| class.count as f64 * circle(class.middle())).sum();
        Ok((polygons, Circles { area, empty_classes: classes.iter().filter(|class| class.count == 0).count() }))
    }
}

impl Aggregate {
    fn size_classes(&self, region: &Region) -> Result<Vec<SizeClass>, Vec<SpecimenError>> {
        let classes = self.gradation.classes(&self.classes, region.volume());
        classes.map_err(|faults| faults.into_iter().map(SpecimenError::from).collect())
    }

    fn faults(&self, region: &Region) -> Vec<SpecimenError> {
        if region.dimension() != 2 {
            return vec![SpecimenError::SolidAggregate];
        }
        let mut faults = Vec::new();
        let mut need = |ok: bool, name, found, expected| {
            if !ok {
                faults.push(SpecimenError::Value { name, found, expected });
            }
        };
        let placement = &self.placement;
        need(self.density > 0.0, "aggregate density", Amount(self.density, "kg/m^3"), "positive");
        need(placement.gap >= 0.0, "aggregate gap", Amount(placement.gap, "m"), "a length of at least 0");
        let wall_gap = Amount(placement.wall_gap, "m");
        need(placement.wall_gap >= 0.0, "aggregate wall gap", wall_gap, "a length of at least 0");
        need(placement.attempts > 0, "attempts", Amount::number(0.0), "at least 1");
        faults.extend(self.polygons.faults().into_iter().map(SpecimenError::from));
        match self.size_classes(region) {
            Err(bad) => faults.extend(bad),
            Ok(classes) => faults.extend(self.number_fault(&classes, region)),
        }
        faults
    }

    /// Particles that are none, too many, or too large for the region. Of a class, the middle size is the one that is
    /// placed (the smallest, where sizes are drawn).
    fn number_fault(&self, classes: &[SizeClass], region: &Region) -> Option<SpecimenError> {
        let count: f64 = classes.iter().map(|class| class.count as f64).sum();
        if count == 0.0 {
            let share = |class: &SizeClass| self.gradation.passing(class.high) - self.gradation.passing(class.low);
            let circle = |d: f64| std::f64::consts::FRAC_PI_4 * d * d;
            let expected = classes.iter().map(|class| share(class) * region.volume() / circle(class.middle()));
            return Some(SpecimenError::NoAggregate { fullest: expected.fold(0.0, f64::max) });
        }
        if count > MOST_POLYGONS {
            return Some(SpecimenError::ManyAggregate(count));
        }
        let (gap, narrowest) = (self.placement.wall_gap, region.narrowest());
        let size = classes.iter().filter(|class| class.count > 0).map(SizeClass::middle).fold(0.0, f64::max);
        (size + 2.0 * gap > narrowest).then_some(SpecimenError::LargeAggregate { size, gap, narrowest })
    }
}

/// The first two coordinates.
fn plane<S: Space>(x: Vector<S>) -> [f64; 2] {
    let [x, y, _] = flat::<S>(x);
    [x, y]
}

/// A plane clump in this space.
fn solid<S: Space>(clump: Clump) -> Clump<S> {
    use crate::space::Tuple;
    let Clump { polygon, pebbles, mass, inertia, centre } = clump;
    let centre = Vector::<S>::build(|k| if k < 2 { centre[k] } else { 0.0 });
    Clump { polygon, pebbles, mass, inertia, centre }
}

impl<S: Space> Specimen<S> {
    /// The clump of every ball that is in one.
    pub fn clump_of_balls(&self) -> Vec<Option<usize>> {
        clump_of_balls(self.radii.len(), &self.clumps)
    }

    /// Mean radius (m).
    pub fn mean_radius(&self) -> f64 {
        self.radii.iter().sum::<f64>() / self.radii.len() as f64
    }
}

/// The clump of every one of `balls`.
pub(super) fn clump_of_balls<S: Space>(balls: usize, clumps: &[Clump<S>]) -> Vec<Option<usize>> {
    let mut of = vec![None; balls];
    for (index, clump) in clumps.iter().enumerate() {
        for &pebble in &clump.pebbles {
            of[pebble] = Some(index);
        }
    }
    of
}

#[cfg(test)]
mod tests;
