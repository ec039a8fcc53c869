//! A mix: stones ([`super::stones`]) and the mortar of balls that fills the room between them.
//!
//! The stones stand still while the mortar is packed to its porosity ([`super::mortar`]).
//!
//! With a bulk density ρ of the whole specimen the density of the mortar's balls follows from what the stones weigh:
//!
//! ```text
//! ρ_ball = (ρ Ω − ρ_stone V_stones) / Σ V(R)
//! ```
//!
//! The **wall effect** is the stones' share of the layer along the walls, a tenth of the narrowest extent thick, over
//! their share of the rest; 1 where stones lie as densely at the walls as inside.

use super::clump::Clump;
use super::groups::assign;
use super::heap::Heap;
use super::mortar::Mortar;
use super::packing::Packing;
use super::quality::{Circles, Quality};
use super::region::Region;
use super::specimen::{Recipe, Specimen, SpecimenError};
use super::stones::{Stone, StoneFault, Stones, Template};
use crate::particle::Group;
use crate::{D3, Watch};
use math::random::Stream;
use math::text::Amount;
use serde::{Deserialize, Serialize};

/// Stones in mortar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mix {
    /// The stones.
    pub stones: Stones,
    /// Number of mortar balls before coarsening; it follows from the porosity when not given.
    pub balls: Option<usize>,
    /// Factor on the mortar's radii.
    pub coarsen: f64,
    /// Density of the whole specimen (kg/m³), from which that of the mortar's balls follows.
    pub bulk_density: Option<f64>,
}

/// What a mix came to.
#[derive(Clone, Debug, PartialEq)]
pub struct MixReport {
    /// Stones of each class: bounds (m), number, volume (m³).
    pub classes: Vec<([f64; 2], usize, f64)>,
    /// Pebbles of all stones.
    pub pebbles: usize,
    /// Mortar balls.
    pub balls: usize,
    /// Volume of the stones over that of the specimen.
    pub stones: f64,
    /// Ball porosity of the mortar in the room between the stones.
    pub mortar_porosity: f64,
    /// 1 − stones − mortar balls, over the whole specimen.
    pub porosity: f64,
    /// Mass over volume of the specimen (kg/m³).
    pub bulk_density: f64,
    /// Density of the mortar's balls (kg/m³).
    pub ball_density: f64,
    /// Stones' share at the walls over that inside.
    pub wall_effect: f64,
}

impl Mix {
    /// What is wrong with it in a recipe.
    pub fn faults(&self, recipe: &Recipe) -> Vec<StoneFault> {
        let mut faults = self.stones.faults(&recipe.region);
        let mut need = |ok: bool, name, found, expected| {
            faults.extend((!ok).then_some(StoneFault::Value { name, found, expected }));
        };
        need(self.coarsen >= 1.0 && self.coarsen <= 20.0, "coarsen", Amount::number(self.coarsen), "from 1 to 20");
        let density = self.bulk_density.unwrap_or(1.0);
        need(density > 0.0 && density.is_finite(), "bulk density", Amount(density, "kg/m^3"), "positive");
        need(self.balls != Some(0), "number of mortar balls", Amount::number(0.0), "at least 1");
        let porosity = matches!(recipe.packing, Packing::Porosity { .. });
        need(
            porosity,
            "packing",
            Amount::number(f64::NAN),
            "to a `porosity`, that of the mortar in the room between the stones",
        );
        faults
    }

    /// Makes the specimen around stones of these shapes; another seed gives another one.
    ///
    /// # Errors
    /// All faults of the recipe, or the one reason why stones or mortar came to nothing.
    pub fn make(
        &self,
        recipe: &Recipe,
        shapes: &[Template],
        seed: u64,
        watch: &dyn Fn() -> Watch,
    ) -> Result<(Specimen<D3>, Quality, MixReport), Vec<SpecimenError>> {
        let mut faults = recipe.faults();
        faults.extend(self.faults(recipe).into_iter().map(SpecimenError::from));
        let Packing::Porosity { sizes, porosity, floaters } = &recipe.packing else { return Err(faults) };
        if !faults.is_empty() {
            return Err(faults);
        }
        let region = recipe.region;
        let stream = &mut Stream::new(seed, "stones", 0);
        let stones = self.stones.place(shapes, &region, stream).map_err(|fault| vec![fault.into()])?;
        let stream = &mut Stream::new(seed, "packing", 0);
        let Self { balls, coarsen, .. } = *self;
        let mortar = Mortar { sizes, porosity: *porosity, floaters: *floaters, balls, coarsen };
        let packed = mortar.pack(&stones, &region, stream, watch).map_err(|fault| vec![fault.into()])?;
        let clumps = self.clumps(&stones);
        let pebbles = packed.heap.still.pebbles;
        let mut groups = vec![Group(recipe.groups.len() as u8); pebbles];
        groups.extend(assign::<D3>(&recipe.groups, &packed.heap.radii[pebbles..], &mut Stream::new(seed, "groups", 0)));
        let report = self.report(recipe, &stones, &packed.heap);
        let quality = Quality::of(&packed, &[], &clumps, &Circles::default());
        let names = recipe.groups.iter().map(|group| &group.name).chain([&self.stones.group]);
        let specimen = Specimen {
            region,
            centres: packed.heap.centres,
            radii: packed.heap.radii,
            groups,
            group_names: names.cloned().collect(),
            density: report.ball_density,
            polygons: Vec::new(),
            clumps,
        };
        Ok((specimen, Quality { porosity: report.porosity, ..quality }, report))
    }

    /// The stones as clumps; their pebbles are the first balls, stone by stone.
    fn clumps(&self, stones: &[Stone]) -> Vec<Clump<D3>> {
        let mut first = 0;
        let clump = |stone: &Stone| {
            let pebbles = (first..first + stone.radii.len()).collect();
            first += stone.radii.len();
            let inertia = stone.inertia.map(|row| row.map(|x| self.stones.density * x));
            let mass = self.stones.density * stone.volume;
            Clump { polygon: stone.shape, pebbles, mass, inertia, centre: stone.centre }
        };
        stones.iter().map(clump).collect()
    }

    fn report(&self, recipe: &Recipe, stones: &[Stone], heap: &Heap<D3>) -> MixReport {
        let volume = recipe.region.volume();
        let (room, filled, mortar) = (heap.room(), heap.still.volume, heap.ball_volume());
        let mass = self.stones.density * filled;
        let ball_density = self.bulk_density.map_or(recipe.density, |bulk| (bulk * volume - mass) / mortar);
        let class = |(index, class): (usize, &super::stones::StoneClass)| {
            let own = stones.iter().filter(|stone| stone.class == index);
            ([class.from, class.to], own.clone().count(), own.map(|stone| stone.volume).sum())
        };
        MixReport {
            classes: self.stones.classes.iter().enumerate().map(class).collect(),
            pebbles: heap.still.pebbles,
            balls: heap.free().len(),
            stones: filled / volume,
            mortar_porosity: 1.0 - mortar / room,
            porosity: 1.0 - (filled + mortar) / volume,
            bulk_density: (mass + ball_density * mortar) / volume,
            ball_density,
            wall_effect: wall_effect(&recipe.region, stones),
        }
    }
}

/// Points along each edge of the grid that finds the wall effect.
const POINTS: usize = 48;

/// The stones' share of the layer along the walls over that of the rest.
fn wall_effect(region: &Region, stones: &[Stone]) -> f64 {
    let edges = region.edges();
    let layer = 0.1 * region.narrowest();
    let (mut hit, mut all) = ([0.0; 2], [0.0; 2]);
    for index in 0..POINTS * POINTS * POINTS {
        let cell = [index % POINTS, index / POINTS % POINTS, index / (POINTS * POINTS)];
        let place: [f64; 3] = std::array::from_fn(|k| edges[k] * ((cell[k] as f64 + 0.5) / POINTS as f64 - 0.5));
        let depth = region.depth::<D3>(place);
        if depth <= 0.0 {
            continue;
        }
        let part = usize::from(depth > layer);
        all[part] += 1.0;
        if !stones.iter().all(|stone| stone.clear_of_ball(place, 0.0)) {
            hit[part] += 1.0;
        }
    }
    hit[0] / all[0] / (hit[1] / all[1])
}

#[cfg(test)]
mod tests {
    use super::super::groups::Share;
    use super::super::stones::{HowMany, StoneClass, tests};
    use super::*;

    fn recipe() -> Recipe {
        Recipe {
            region: Region::Box { width: 30.0, height: 30.0, depth: 30.0 },
            packing: Packing::uniform(0.36, 0.9, 2.0),
            density: 2000.0,
            groups: vec![Share { name: "mortar".into(), share: 1.0 }],
            aggregate: None,
        }
    }

    fn mix(coarsen: f64) -> Mix {
        let classes = vec![StoneClass { from: 4.0, to: 9.0, number: HowMany::Share(0.15) }];
        Mix { stones: tests::stones(classes), balls: None, coarsen, bulk_density: Some(2200.0) }
    }

    /// Stones stay where they were put, the mortar fills the rest at its porosity and touches them, the density is met, and
    /// the coarse twin has the same stones and an eighth of the balls.
    #[test]
    fn mortar_fills_the_room_between_stones() {
        let shapes = [tests::dumbbell()];
        let make = |coarsen| mix(coarsen).make(&recipe(), &shapes, 3, &|| Watch::Continue).unwrap();
        let (made, quality, report) = make(1.0);
        let pebbles = report.pebbles;
        assert_eq!(pebbles, 2 * made.clumps.len());
        assert!(report.balls > 2000 && made.radii.len() == pebbles + report.balls);
        assert!((report.stones - 0.15).abs() < 0.01 && (report.mortar_porosity - 0.36).abs() < 0.01);
        let mass: f64 = made.clumps.iter().map(|clump| clump.mass).sum::<f64>()
            + made.density * super::super::heap::ball_volume::<D3>(&made.radii[pebbles..]);
        assert!((mass / 27_000.0 - 2200.0).abs() < 1e-6 && (report.bulk_density - 2200.0).abs() < 1e-6);
        assert!(quality.contacts[1] > 3 * made.clumps.len() && quality.contacts[2] == 0, "{:?}", quality.contacts);
        assert!(quality.fabric.largest_overlap < 0.5);
        assert!(made.groups[..pebbles].iter().all(|group| group.0 == 1) && made.groups[pebbles].0 == 0);
        let (twin, _, coarse) = make(1.6);
        assert_eq!(twin.centres[..pebbles], made.centres[..pebbles]);
        let fewer = report.balls as f64 / coarse.balls as f64 / 1.6_f64.powi(3);
        assert!((fewer - 1.0).abs() < 0.01, "{fewer}");
        assert!(report.wall_effect > 0.05 && report.wall_effect < 0.6, "{}", report.wall_effect);
    }

    /// A cylinder with as many balls as stated and mortar as coarse as the stones: all inside, none in a stone, no overlap deep.
    #[test]
    fn coarse_mortar_in_a_cylinder_stays_outside_the_stones() {
        let region = Region::Cylinder { diameter: 30.0, height: 40.0 };
        let recipe = Recipe { region, ..recipe() };
        let classes = vec![
            StoneClass { from: 2.0, to: 4.0, number: HowMany::Count(60) },
            StoneClass { from: 6.0, to: 10.0, number: HowMany::Count(14) },
        ];
        let coarse = Mix { stones: tests::stones(classes), balls: Some(8000), ..mix(2.0) };
        let (made, quality, report) = coarse.make(&recipe, &[tests::dumbbell()], 5, &|| Watch::Continue).unwrap();
        assert_eq!((made.clumps.len(), report.pebbles, report.balls), (74, 148, 1000));
        let [stones, balls] = [&made.centres[..148], &made.centres[148..]];
        for (ball, r) in balls.iter().zip(&made.radii[148..]) {
            assert!(region.depth::<D3>(*ball) > 0.5 * r);
            for (pebble, own) in stones.iter().zip(&made.radii) {
                let apart: f64 = (0..3).map(|k| (ball[k] - pebble[k]).powi(2)).sum::<f64>().sqrt();
                assert!(r + own - apart < 0.35 * r + 1e-9, "{apart} {r} {own}");
            }
        }
        assert!(quality.fabric.largest_overlap <= 0.35 && quality.fabric.coordination > 4.0, "{:?}", quality.fabric);
        // The balance of volumes is that of the balls themselves.
        let balls = super::super::heap::ball_volume::<D3>(&made.radii[148..]);
        assert!((report.porosity - (1.0 - (report.stones + balls / region.volume()))).abs() < 1e-12);
        assert!((balls / (region.volume() * (1.0 - report.stones)) - (1.0 - report.mortar_porosity)).abs() < 1e-12);
    }

    #[test]
    fn a_mix_needs_a_porosity_and_sound_numbers() {
        let odd = Mix { coarsen: 0.5, balls: Some(0), bulk_density: Some(-1.0), ..mix(1.0) };
        let packing = Packing::Lattice { lattice: super::super::lattice::Lattice::SimpleCubic, radius: 1.0 };
        let found = odd.make(&Recipe { packing, ..recipe() }, &[tests::dumbbell()], 1, &|| Watch::Continue);
        let names: Vec<String> = found.unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(names.iter().filter(|name| name.starts_with("stones: ")).count(), 4, "{names:?}");
    }
}
