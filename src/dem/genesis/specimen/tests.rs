//! Specimens put together, and recipes that cannot be.

use super::super::placement::ClassSize;
use super::super::polygon::{AngleLaw, SizeRule};
use super::super::quality::SpecimenWarning;
use super::*;
use crate::D3;

fn recipe() -> Recipe {
    Recipe {
        region: Region::Rectangle { width: 0.1, height: 0.2 },
        packing: Packing::uniform(0.12, 1.6e-3, 2.5),
        density: 2000.0,
        groups: vec![Share { name: "mortar".to_owned(), share: 1.0 }],
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
            group: "aggregate".to_owned(),
        }),
    }
}

#[test]
fn a_specimen_reports_its_own_numbers() {
    let (specimen, quality) = recipe().make::<D2>(1, &|| Watch::Continue).unwrap();
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
        (recipe().make::<D2>(3, &|| Watch::Continue).unwrap(), plain.make::<D2>(3, &|| Watch::Continue).unwrap());
    assert_eq!(with.centres, without.centres);
    assert!(without.clumps.is_empty() && quality.polygon_fraction == 0.0 && quality.pebble_fraction == 0.0);
    assert_eq!(quality.contacts[1..], [0, 0]);
}

#[test]
fn faults_of_all_parts_come_together() {
    let mut bad = recipe();
    bad.density = -1.0;
    bad.packing = Packing::uniform(2.0, 1.6e-3, 2.5);
    if let Some(aggregate) = &mut bad.aggregate {
        aggregate.polygons.min_vertices = 1;
        aggregate.gradation = Gradation::Walraven { content: 2.0, max_size: 0.015 };
    }
    assert_eq!(bad.make::<D2>(1, &|| Watch::Continue).unwrap_err().len(), 4);
}

/// Content so low that every class rounds to none, and particles larger than the specimen: refused before anything is made,
/// with the number that it would be.
#[test]
fn aggregate_that_rounds_to_nothing_or_does_not_fit_is_refused() {
    let with = |content: f64, classes: &[f64]| {
        let mut recipe = self::recipe();
        if let Some(aggregate) = &mut recipe.aggregate {
            let max_size = classes.last().copied().unwrap_or_default();
            aggregate.gradation = Gradation::Walraven { content, max_size };
            aggregate.classes = classes.to_vec();
        }
        recipe.faults()
    };
    let none = with(1e-3, &[0.012, 0.015]);
    let [SpecimenError::NoAggregate { fullest }] = none[..] else { panic!("{none:?}") };
    assert!(fullest > 0.0 && fullest < 0.5);
    assert!(matches!(with(0.75, &[0.5, 0.9])[..], [SpecimenError::NoAggregate { .. }]));
    let mut recipe = self::recipe();
    if let Some(aggregate) = &mut recipe.aggregate {
        aggregate.gradation = Gradation::Table { sizes: vec![0.11, 0.12], passing: vec![0.0, 1.0] };
        aggregate.classes = vec![0.11, 0.12];
    }
    let large = recipe.faults();
    assert!(matches!(large[..], [SpecimenError::LargeAggregate { .. }]), "{large:?}");
    let many = with(0.75, &[1e-6, 2e-6, 0.015]);
    assert!(matches!(many[..], [SpecimenError::ManyAggregate(_)]), "{many:?}");
}

#[test]
fn minerals_and_aggregate_have_their_groups() {
    let share = |name: &str, share: f64| Share { name: name.to_owned(), share };
    let minerals = Recipe { groups: vec![share("quartz", 0.3), share("feldspar", 0.7)], ..recipe() };
    let (specimen, _) = minerals.make::<D2>(1, &|| Watch::Continue).unwrap();
    assert_eq!(specimen.group_names, ["quartz", "feldspar", "aggregate"]);
    let of = specimen.clump_of_balls();
    assert!((0..of.len()).all(|i| of[i].is_some() == (specimen.groups[i] == Group(2))));
    let quartz = specimen.groups.iter().filter(|&&group| group == Group(0)).count() as f64;
    let loose = of.iter().filter(|clump| clump.is_none()).count() as f64;
    assert!((quartz / loose - 0.3).abs() < 0.05, "{}", quartz / loose);
}

/// The same recipe in the solid; polygons cannot be in one.
#[test]
fn a_solid_specimen_is_made_by_the_same_code() {
    let region = Region::Box { width: 0.04, height: 0.08, depth: 0.04 };
    let solid = Recipe { region, packing: Packing::uniform(0.34, 2.5e-3, 1.66), aggregate: None, ..recipe() };
    let (specimen, quality) = solid.make::<D3>(1, &|| Watch::Continue).unwrap();
    assert_eq!(specimen.radii.len(), quality.balls);
    assert!((quality.porosity - 0.34).abs() < 1e-12 && quality.fabric.coordination > 5.0, "{quality:?}");
    assert_eq!(quality.held, 4);
    assert_eq!(Recipe { region, ..recipe() }.faults().last(), Some(&SpecimenError::SolidAggregate));
}
