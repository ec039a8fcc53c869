//! What an adaptive speed changes, test by test: `cargo bench -p flow-dem --bench pace [-- PACKINGS] [WORDS]`.
//!
//! Every packing is tested at the fixed speed, at that speed as the slow one of an adaptive test, and at half of it. Printed
//! are geometric means of the ratios to the fixed speed, each with its standard error over packings and strengths; what half
//! the speed changes is what the fixed speed itself does not know. Words choose tests by their names.
#![allow(clippy::unwrap_used)]

use dem::genesis::compress::{Floaters, StressTarget};
use dem::genesis::groups::Share;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::sizes::Sizes;
use dem::genesis::specimen::{Recipe, Specimen};
use dem::loading::kind::TestKind;
use dem::loading::material::{BondKind, Contact, Material};
use dem::loading::pace::Pace;
use dem::loading::piece::Piece;
use dem::loading::record::TestRecord;
use dem::loading::settings::{Loading, Rule};
use dem::loading::speed::Speed;
use dem::{D2, D3, Masses, Space, Watch};

/// A test, the piece for it, and the wave transits of its fixed speed.
struct Case {
    name: &'static str,
    kind: TestKind,
    region: Region,
    mean_radius: f64,
    bond: BondKind,
    transits: f64,
}

const fn case(name: &'static str, kind: TestKind, region: Region, mean_radius: f64, transits: f64) -> Case {
    Case { name, kind, region, mean_radius, bond: BondKind::Parallel, transits }
}

/// Some 4,000 discs or 2,700 spheres each.
const CASES: [Case; 6] = [
    case("plane compression", TestKind::Uniaxial, Region::Rectangle { width: 0.05, height: 0.1 }, 0.6e-3, 80.0),
    case("plane tension", TestKind::Tension, Region::Rectangle { width: 0.05, height: 0.1 }, 0.6e-3, 100.0),
    Case {
        bond: BondKind::Contact,
        ..case("plane splitting", TestKind::Brazilian, Region::Disc { diameter: 0.05 }, 0.35e-3, 100.0)
    },
    case("solid compression", TestKind::Uniaxial, Region::Cylinder { diameter: 0.025, height: 0.05 }, 1.1e-3, 60.0),
    case("solid tension", TestKind::Tension, Region::Cylinder { diameter: 0.025, height: 0.05 }, 1.1e-3, 100.0),
    case("solid splitting", TestKind::Brazilian, Region::ThickDisc { diameter: 0.025, depth: 0.012 }, 0.8e-3, 100.0),
];

/// Bond strengths, Pa.
const STRENGTHS: [f64; 2] = [15e6, 30e6];

fn specimen<S: Space>(case: &Case, seed: u64) -> Specimen<S> {
    let plane = S::DIMENSION == 2;
    let target = StressTarget {
        stress: 1e-3,
        modulus: 1.0,
        tolerance: 0.01,
        cloud_porosity: if plane { 0.16 } else { 0.36 },
        equilibrium: 8e-3,
        floaters: Floaters::Enlarge,
        floater_share: 0.01,
    };
    let packing = Packing::Stress { sizes: Sizes::uniform(case.mean_radius, 1.66), target };
    let groups = vec![Share { name: "rock".to_owned(), share: 1.0 }];
    let recipe = Recipe { region: case.region, packing, density: 2600.0, groups, aggregate: None };
    recipe.make(seed, &|| Watch::Continue).unwrap().0
}

fn test<S: Space>(case: &Case, piece: &Piece<S>, strength: f64, seed: u64, speed: f64, pace: Pace) -> TestRecord<S> {
    let contact = Contact { bond: case.bond, ..Contact::bonded("rock", 18e9, 2.0, [strength, 2.0 * strength], 0.5) };
    let material =
        Material { gap: if case.bond == BondKind::Contact { 0.3 } else { 0.0 }, ..Material::of_one(contact) };
    let mut loading = Loading { speed: Speed::Transits(case.transits / speed), pace, ..Loading::new(case.kind) };
    loading.machine.masses = Masses::EqualStep;
    if case.kind == TestKind::Brazilian {
        loading.rule = Rule { lasting: 1.0, ..loading.rule };
    }
    loading.run(piece, &material, seed, &mut |_| Watch::Continue).unwrap()
}

/// What is compared: name and value of a record.
type Quantity<S> = (&'static str, fn(&TestRecord<S>) -> f64);

fn quantities<S: Space>() -> [Quantity<S>; 6] {
    [
        ("steps", |record| record.run.steps as f64),
        ("strength", |record| record.values.strength),
        ("tangent E", |record| record.values.modulus_tangent),
        ("secant E", |record| record.values.modulus_secant),
        ("nu", |record| record.values.poisson_secant),
        ("cracks at the peak", |record| {
            let stress = |k: usize| record.run.samples[k].stress;
            let peak = (0..record.run.samples.len()).fold(0, |best, k| if stress(k) > stress(best) { k } else { best });
            record.run.samples[peak].cracks as f64
        }),
    ]
}

fn compare<S: Space>(case: &Case, packings: u64) {
    let mut ratios = vec![[Vec::new(), Vec::new()]; quantities::<S>().len()];
    for seed in 1..=packings {
        let specimen = specimen::<S>(case, seed);
        let piece = Piece::from(&specimen);
        for strength in STRENGTHS {
            let run = |speed, pace| test(case, &piece, strength, seed, speed, pace);
            let fixed = run(1.0, Pace::Fixed);
            for (which, other) in [run(1.0, Pace::Adaptive), run(0.5, Pace::Fixed)].iter().enumerate() {
                for (ratios, (_, read)) in ratios.iter_mut().zip(quantities::<S>()) {
                    let ratio = read(other) / read(&fixed);
                    if ratio.is_finite() && ratio > 0.0 {
                        ratios[which].push(math::elementary::ln(ratio));
                    }
                }
            }
        }
    }
    for (which, name) in ["adaptive", "half the speed"].into_iter().enumerate() {
        print!("{}, {name} over fixed, {} pairs:", case.name, 2 * packings);
        for (ratios, (name, _)) in ratios.iter().zip(quantities::<S>()) {
            let (n, logs) = (ratios[which].len() as f64, &ratios[which]);
            let mean = logs.iter().sum::<f64>() / n;
            let error = (logs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0) / n).sqrt();
            if n > 1.0 {
                print!(" {name} {:.4} ± {error:.4};", math::elementary::exp(mean));
            }
        }
        println!();
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let packings = words.iter().find_map(|word| word.parse().ok()).unwrap_or(8);
    let wanted =
        |case: &&Case| words.iter().all(|word| word.parse::<u64>().is_ok() || case.name.contains(word.as_str()));
    for case in CASES.iter().filter(wanted) {
        match case.region.dimension() {
            2 => compare::<D2>(case, packings),
            _ => compare::<D3>(case, packings),
        }
    }
}
