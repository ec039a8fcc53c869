//! Scaling identities of a test to failure, by powers of two, so that they hold to the last bit.
//!
//! With E a modulus, ρ a density, ℓ a length, a quasi-static or dynamic run depends on v √(ρ/E) and σ_c/E alone: forces go
//! as E ℓ^(d−1), times as ℓ √(ρ/E). So four times the moduli and strengths at twice the speed give four times the force
//! after the same steps; so do lengths times two, with the force times 2^(d−1); and uniform density scaling by four at
//! half the speed gives the same run as the real density: it is a higher speed under another name. The scatter of the
//! strengths is drawn relative to their mean and scales along.

use crate::block::{GRAIN, PLATEN, STONE, block};
use crate::case::{Case, Family, Near};
use dem::genesis::groups::Share;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::specimen::Recipe;
use dem::loading::curve::Macro;
use dem::loading::kind::TestKind;
use dem::loading::material::{Contact, Material};
use dem::loading::piece::Piece;
use dem::loading::settings::Loading;
use dem::loading::speed::Speed;
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Largest force at a platen of a bonded block with a clump that is crushed past its peak, and its cracks: times what the \
        scaling asks for. The uniaxial test: a random packing of 40 × 80 mm, mean radius 2 mm, at 0.05 m/s.";
    Family { title: "Scaling", about, cases: &CASES }
}

#[test]
fn scaled_runs_are_the_same_runs() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    scaled::<D2>(&mut cases, (14, 16), 1200);
    scaled::<D3>(&mut cases, (5, 7), 500);
    tested(&mut cases);
    cases
}

/// A uniaxial test of a random mortar, as the campaigns run it.
fn uniaxial(factor: f64, speed: f64) -> Macro {
    let region = Region::Rectangle { width: 0.04, height: 0.08 };
    let packing = Packing::uniform(0.12, 2e-3, 2.5);
    let groups = vec![Share { name: "mortar".to_owned(), share: 1.0 }];
    let recipe = Recipe { region, packing, density: 2000.0, groups, aggregate: None };
    let (specimen, _) = recipe.make::<D2>(1, &|| Watch::Continue).unwrap();
    let material = Material::of_one(Contact::bonded("mortar", 20e9 * factor, 2.5, [20e6 * factor; 2], 0.5));
    let test = Loading { speed: Speed::Each(speed), ..Loading::new(TestKind::Uniaxial) };
    test.run(&Piece::from(&specimen), &material, 1, &mut |_| Watch::Continue).unwrap().values
}

/// Strength and E follow strengths and moduli, strains and ν do not; exactly where the speed follows the wave speed, and
/// nearly where it stays, as long as the test is slow.
fn tested(cases: &mut Vec<Case>) {
    let plain = uniaxial(1.0, 0.05);
    let runs = [
        ("moduli and strengths × 4, speed × 2", uniaxial(4.0, 0.1), 4.0, [Near::Exact; 4]),
        (
            "moduli and strengths × 1/2, same speed",
            uniaxial(0.5, 0.05),
            0.5,
            [0.02, 5e-3, 0.02, 0.05].map(Near::Relative),
        ),
    ];
    for (name, own, factor, near) in runs {
        let mut case = |what: &str, source, expected, got, near| {
            cases.push(Case::new(format!("uniaxial test, {name}: {what}"), source, expected, got, near));
        };
        case("strength, Pa", "∝ strengths", factor * plain.strength, own.strength, near[0]);
        case("E, Pa", "∝ moduli", factor * plain.modulus_tangent, own.modulus_tangent, near[1]);
        case("ν", "the same", plain.poisson_secant, own.poisson_secant, near[2]);
        case("strain at the peak", "the same", plain.peak_strain, own.peak_strain, near[3]);
    }
}

/// What is multiplied, and the speed with it.
#[derive(Clone, Copy)]
struct Factors {
    modulus: f64,
    density: f64,
    length: f64,
    speed: f64,
}

const PLAIN: Factors = Factors { modulus: 1.0, density: 1.0, length: 1.0, speed: 1.0 };

fn scaled<S: Space>(cases: &mut Vec<Case>, size: (usize, usize), steps: u64) {
    let area = 2.0_f64.powi(S::DIMENSION as i32 - 1);
    let runs = [
        ("moduli and strengths × 4, speed × 2", Factors { modulus: 4.0, speed: 2.0, ..PLAIN }, 4.0),
        ("lengths × 2", Factors { length: 2.0, ..PLAIN }, area),
        ("density × 4, speed × 1/2", Factors { density: 4.0, speed: 0.5, ..PLAIN }, 1.0),
    ];
    let [force, cracks, step] = crushed::<S>(size, PLAIN, steps);
    assert!(cracks > 10.0, "{cracks}");
    for (name, factors, gain) in runs {
        let [own, own_cracks, own_step] = crushed::<S>(size, factors, steps);
        let time = factors.length * (factors.density / factors.modulus).sqrt();
        let mut case = |what: &str, source, expected, got| {
            cases.push(Case::new(format!("{}, {name}: {what}", S::NAME), source, expected, got, Near::Exact));
        };
        case("largest force, N", "E ℓ^(d−1)", gain * force, own);
        case("cracks", "the same", cracks, own_cracks);
        case("time step, s", "ℓ √(ρ/E)", time * step, own_step);
    }
}

/// Largest force at a platen, cracks and the last time step of a scaled run.
fn crushed<S: Space>((columns, rows): (usize, usize), factors: Factors, steps: u64) -> [f64; 3] {
    let Factors { modulus, density, length, speed } = factors;
    let mut model = block::<S>(columns, rows, 2.0 * speed);
    let volume = length.powi(S::DIMENSION as i32) * density;
    for particle in &mut model.particles {
        particle.position = particle.position.times(length);
        particle.radius *= length;
        particle.mass *= volume;
        particle.inertia *= volume * length * length;
    }
    for clump in &mut model.clumps {
        clump.centre = clump.centre.times(length);
        clump.mass *= volume;
        clump.inertia = clump.inertia.map(|row| row.map(|x| x * volume * length * length));
    }
    for wall in &mut model.walls {
        wall.point = wall.point.times(length);
    }
    let plain = std::mem::take(&mut model.contacts);
    for (a, b) in [(GRAIN, GRAIN), (GRAIN, STONE), (STONE, STONE), (GRAIN, PLATEN), (STONE, PLATEN)] {
        let mut law = *plain.get(a, b).unwrap();
        stiffen(&mut law, modulus);
        model.contacts = std::mem::take(&mut model.contacts).with(a, b, law);
    }
    let mut engine = Engine::new(&model).unwrap();
    engine.install_bonds(1e-5 * length, 7).unwrap();
    engine.absorb_overlaps();
    let mut largest = 0.0_f64;
    let watch = |engine: &Engine<S>| {
        largest = largest.max(engine.wall_force(1).at(1).abs());
        Watch::Continue
    };
    engine.run(steps, 20, watch).unwrap();
    [largest, engine.cracks().len() as f64, engine.time_step()]
}

/// Moduli and strengths times a factor.
fn stiffen(interaction: &mut Interaction, factor: f64) {
    if let Stiffness::Modulus { modulus, .. } = &mut interaction.linear.stiffness {
        *modulus *= factor;
    }
    if let Bond::Parallel(bond) = &mut interaction.bond {
        if let BondStiffness::Modulus { modulus, .. } = &mut bond.stiffness {
            *modulus *= factor;
        }
        bond.tensile_strength *= factor;
        bond.cohesion *= factor;
    }
}
