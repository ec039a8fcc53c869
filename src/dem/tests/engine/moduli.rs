//! Moduli of packings to a stress, ratio of radii 1.66, between frictionless platens, against published laws of bonded discs.
//!
//! E/E_c and ν depend on κ = k_n/k_s and on the packing. At a fixed porosity near jamming the packing itself scatters
//! (coefficient of variation of E 6.7 % over five packings of 3,700 discs at porosity 0.16); at a fixed stress it does
//! not. E is the platens' stress over their approach, ν the slope of the lateral displacement over the middle half of the
//! height against the platens' strain, both at a strain of 5·10⁻⁵ that is reached slowly with unbreakable bonds.
//!
//! Yang, Jiao & Lei 2006 (doi:10.1016/j.ijrmms.2005.09.015), parallel bond, moduli of spring and cement E_c each: E/E_c =
//! 1.652 − 0.395 ln κ, ν = 0.111 + 0.209 ln κ.
//!
//! Contact bonds: independent statics of two periodic packings at a porosity of 0.16 gave E/E_c 0.79, 0.726, 0.677 and ν 0.147, 0.209,
//! 0.257 for κ 1, 1.5, 2. The packing decides. Five packings grown to that porosity with bonds where discs touch (1.98 a disc)
//! have 0.780, 0.712, 0.662 and 0.100, 0.164, 0.212 here, with a coefficient of variation of E of 8 %; up to a gap of 1 % (2.06 a disc)
//! 0.843, 0.770, 0.717; packings to a stress 0.871, 0.796, 0.742. The ratio of E to that of parallel bonds in the same packing
//! is 0.53 to 0.54 in both kinds. ν stays 0.045 below the periodic statics between
//! platens; in a periodic cell of our own it stays within 0.03 ([`crate::periodic`]).

use crate::block::{GRAIN, PLATEN};
use crate::case::{Case, Family, Near};
use dem::genesis::compress::{Floaters, StressTarget};
use dem::genesis::fabric::Fabric;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::sizes::Sizes;
use dem::*;
use math::elementary::ln;
use math::random::Stream;
use std::sync::LazyLock;

const MODULUS: f64 = 20e9;
const WIDTH: f64 = 0.05;
const HEIGHT: f64 = 0.1;

/// Centres, radii and fabric of a packing.
type Packed = (Vec<[f64; 2]>, Vec<f64>, Fabric);

/// A packing of about `count` discs at a stress over the modulus.
fn packing(count: f64, relative: f64, seed: u64) -> Packed {
    let target = StressTarget {
        stress: relative * MODULUS,
        modulus: MODULUS,
        tolerance: 0.01,
        cloud_porosity: 0.16,
        equilibrium: 1e-3,
        floaters: Floaters::Enlarge,
        floater_share: 2e-3,
    };
    packed(&Packing::Stress { sizes: Sizes::uniform(radius(count, 0.84), 1.66), target }, seed)
}

/// A packing of about `count` discs grown to a porosity.
fn grown(count: f64, porosity: f64, seed: u64) -> Packed {
    packed(&Packing::uniform(porosity, radius(count, 1.0 - porosity), 1.66), seed)
}

const REGION: Region = Region::Rectangle { width: WIDTH, height: HEIGHT };

/// Radius of which `count` discs fill this share of the region.
fn radius(count: f64, share: f64) -> f64 {
    (REGION.volume() * share / (std::f64::consts::PI * count)).sqrt()
}

fn packed(packing: &Packing, seed: u64) -> Packed {
    let packed = packing.pack::<D2>(&REGION, &mut Stream::new(seed, "packing", 0), &|| Watch::Continue).unwrap();
    let fabric = Fabric::of(&packed.heap);
    (packed.heap.centres, packed.heap.radii, fabric)
}

/// A bond of the law asked for that does not break.
fn bond(parallel: bool, kappa: f64) -> Bond {
    let endless = f64::INFINITY;
    if parallel {
        return Bond::Parallel(ParallelBond::new(MODULUS, kappa, endless, endless));
    }
    Bond::Contact(ContactBond::new(endless, endless))
}

/// E/E_c, ν and bonds per disc of a packing with bonds up to a gap over the mean radius.
fn moduli(centres: &[[f64; 2]], radii: &[f64], parallel: bool, kappa: f64, gap: f64) -> [f64; 3] {
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let linear = Linear::modulus(MODULUS, kappa, 0.5);
    let speed = 1.0;
    let wall = |side: f64| Wall {
        point: [0.0, 0.5 * side * HEIGHT],
        normal: [0.0, -side],
        motion: Motion::Velocity([0.0, -side * speed]),
        group: PLATEN,
    };
    let contacts = ContactTable::new().with(GRAIN, GRAIN, Interaction { linear, bond: bond(parallel, kappa) }).with(
        GRAIN,
        PLATEN,
        Interaction::unbonded(Linear::modulus(MODULUS, kappa, 0.0)),
    );
    let balls = centres.iter().zip(radii).map(|(&x, &r)| Particle::ball(x, r, 2650.0, GRAIN)).collect();
    let model = Model::<D2> {
        particles: balls,
        clumps: vec![],
        walls: vec![wall(-1.0), wall(1.0)],
        contacts,
        settings: Settings::default(),
    };
    let mut engine = Engine::new(&model).unwrap();
    let bonds = engine.install_bonds(gap * mean, 1).unwrap();
    engine.absorb_overlaps();
    // Slow: the strain takes about 20 transits of a wave of speed √(E_c/ρ).
    let strain = 5e-5;
    let time = 20.0 * HEIGHT / (MODULUS / 2650.0_f64).sqrt();
    let steps = (time / engine.time_step()).ceil();
    let rate = strain / (steps * engine.time_step());
    for (w, side) in [(0, -1.0), (1, 1.0)] {
        engine.move_wall(w, Motion::Velocity([0.0, -side * 0.5 * rate * HEIGHT])).unwrap();
    }
    for i in 0..radii.len() {
        engine.set_motion(i, [0.0, -rate * centres[i][1]], [0.0]).unwrap();
    }
    engine.advance(steps as u64).unwrap();
    let approach = 1.0 - (engine.wall_point(1)[1] - engine.wall_point(0)[1]) / HEIGHT;
    let stress = 0.5 * (engine.wall_force(0)[1].abs() + engine.wall_force(1)[1].abs()) / WIDTH;
    let (mut moment, mut square) = (0.0, 0.0);
    for (i, x) in centres.iter().enumerate().filter(|(_, x)| x[1].abs() < 0.25 * HEIGHT) {
        moment += x[0] * (engine.position(i)[0] - x[0]);
        square += x[0] * x[0];
    }
    [stress / approach / MODULUS, moment / square / approach, bonds as f64 / radii.len() as f64]
}

fn mean_and_cv(values: &[f64]) -> [f64; 2] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (values.len() as f64 - 1.0);
    [mean, square.sqrt() / mean]
}

/// E/E_c and ν of the published law.
fn published(kappa: f64) -> [f64; 2] {
    [1.652 - 0.395 * ln(kappa), 0.111 + 0.209 * ln(kappa)]
}

/// Stress over modulus, and the gap over the mean radius up to which bonds form.
const STRESS: f64 = 1e-3;
const GAP: f64 = 0.01;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
        let packings: Vec<_> = (0..2).map(|seed| packing(1500.0, STRESS, seed)).collect();
        [1.0, 2.5, 4.0].iter().flat_map(|&kappa| rows(&packings, kappa)).collect()
    });
    let about = "Mean of two packings of 1500 discs at a stress of 10⁻³ of the modulus, ratio of radii 1.66, 50 × 100 mm between frictionless \
        platens; parallel bonds up to a gap of 1 % of the mean radius. Yang 2006 = doi:10.1016/j.ijrmms.2005.09.015.";
    Family { title: "Moduli of packings to a stress", about, cases: &CASES }
}

fn rows(packings: &[Packed], kappa: f64) -> [Case; 2] {
    let found: Vec<[f64; 3]> = packings.iter().map(|(x, r, _)| moduli(x, r, true, kappa, GAP)).collect();
    let [e, nu] = [0, 1].map(|k| mean_and_cv(&found.iter().map(|f| f[k]).collect::<Vec<f64>>())[0]);
    let [law_e, law_nu] = published(kappa);
    [
        Case::new(format!("κ = {kappa}: E/E_c"), "1.652 − 0.395 ln κ, Yang 2006", law_e, e, Near::Relative(0.06)),
        Case::new(format!("κ = {kappa}: ν"), "0.111 + 0.209 ln κ, Yang 2006", law_nu, nu, Near::Absolute(0.03)),
    ]
}

#[test]
fn moduli_follow_the_published_laws() {
    family().check();
}

#[test]
#[ignore = "minutes; prints the scatter over ten packings of 3,700 discs and the laws over five"]
fn campaign() {
    let packings: Vec<_> = (0..10).map(|seed| packing(3700.0, STRESS, seed)).collect();
    let coordination: Vec<f64> = packings.iter().map(|(_, _, fabric)| fabric.coordination).collect();
    println!("coordination, mean and coefficient of variation: {:.4?}", mean_and_cv(&coordination));
    let show = |count: usize, parallel: bool, kappa: f64| {
        let of = |(x, r, _): &Packed| moduli(x, r, parallel, kappa, GAP);
        let found: Vec<[f64; 3]> = packings[..count].iter().map(of).collect();
        let column = |k: usize| mean_and_cv(&found.iter().map(|f| f[k]).collect::<Vec<f64>>());
        let (e, nu, bonds) = (column(0), column(1), column(2));
        println!(
            "{count} packings, parallel {parallel}, κ {kappa}: E/E_c {e:.4?} ν {nu:.4?} bonds per disc {bonds:.4?}, law {:.3?}",
            published(kappa)
        );
    };
    show(10, true, 2.5);
    for kappa in [1.0, 1.5, 2.0, 2.5, 4.0] {
        show(5, true, kappa);
        show(5, false, kappa);
    }
}

#[test]
#[ignore = "minutes; prints moduli of contact and parallel bonds in packings grown to a porosity"]
fn campaign_at_a_porosity() {
    let packings: Vec<_> = (0..5).map(|seed| grown(3700.0, 0.16, seed)).collect();
    for kappa in [1.0, 1.5, 2.0, 2.5, 4.0] {
        for gap in [1e-6, 0.003] {
            let found: Vec<[f64; 3]> = packings.iter().map(|(x, r, _)| moduli(x, r, false, kappa, gap)).collect();
            let column = |k: usize| mean_and_cv(&found.iter().map(|f| f[k]).collect::<Vec<f64>>());
            println!(
                "contact bonds to a gap of {gap}, κ {kappa}: E/E_c {:.4?} ν {:.4?} bonds {:.4?}",
                column(0),
                column(1),
                column(2)
            );
        }
    }
}
