//! Formulas of specimen genesis: how many balls, how far they grow, how many particles of aggregate, how large.
//!
//! Balls: N = ⌊A (1 − n)/(π R̄²)⌋, growth m = √((1 − n)/(1 − n₀)); radii uniform in ratio ρ have E[R²]/R̄² = 1 +
//! (ρ − 1)²/3(ρ + 1)², so N of them fill the area at a factor that is the root of its inverse. Aggregate: the counts that
//! Su et al. (2021) print in their Table 2, and what a Fuller curve gives. Polygons of n vertices on a circle of radius R:
//! area n/2 R² sin(2π/n) if even; random ones have gaps of density (n − 1)(1 − g/2π)^(n−2)/2π and a mean area of n/2 E[sin g]
//! R²: 3/π for n = 4, 10/2π − 60/(2π)³ for 5, 15/2π − 180/(2π)³ for 6. Means of draws are off by three standard errors.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::genesis::cloud::{scale_to_porosity, scatter};
use dem::genesis::gradation::Gradation;
use dem::genesis::heap::ball_volume;
use dem::genesis::packing::Packing;
use dem::genesis::polygon::{AngleLaw, PolygonRecipe, SizeRule};
use dem::genesis::region::Region;
use dem::genesis::sizes::Sizes;
use dem::*;
use math::elementary::{cos, sin};
use math::random::Stream;
use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Su et al. 2021 = doi:10.3390/ma14071627: 100 × 200 mm, porosity 0.12, mean radius 0.5 mm, largest over smallest radius \
        2.5; Walraven's curve, content 0.75, largest size 15 mm, classes of 5, 7, 9, 11, 13, 15 mm. The packing: 50 × 100 mm, \
        mean radius 2 mm. 4000 random polygons.";
    Family { title: "Specimen genesis", about, cases: &CASES }
}

#[test]
fn genesis_follows_its_formulas() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    balls(&mut cases);
    packing(&mut cases);
    aggregate(&mut cases);
    regular_polygons(&mut cases);
    random_polygons(&mut cases);
    cases
}

fn balls(cases: &mut Vec<Case>) {
    let (area, porosity, mean, ratio) = (0.02, 0.12, 0.5e-3, 2.5_f64);
    let sizes = Sizes::uniform(mean, ratio);
    let count = sizes.count::<D2>(area, porosity) as usize;
    cases.push(Case::new("number of balls", "⌊A (1 − n)/(π R̄²)⌋, eq. (4)", 22_409.0, count as f64, Near::Exact));
    let mut radii = sizes.draw::<D2>(count, &mut Stream::new(1, "radii", 0));
    let n = count as f64;
    let own_mean = radii.iter().sum::<f64>() / n;
    // Standard deviation of the uniform law over its mean: (ρ − 1)/(√3 (ρ + 1)).
    let spread = (ratio - 1.0) / (3.0_f64.sqrt() * (ratio + 1.0));
    let near = Near::Relative(3.0 * spread / n.sqrt());
    cases.push(Case::new("mean of the drawn radii, m", "R̄", mean, own_mean, near));
    let factor = scale_to_porosity::<D2>(&mut radii, area, porosity);
    let second = 1.0 + spread * spread;
    let near = Near::Relative(5e-3);
    cases.push(Case::new("factor on the radii", "1/√(1 + (ρ−1)²/3(ρ+1)²)", 1.0 / second.sqrt(), factor, near));
    let left = 1.0 - ball_volume::<D2>(&radii) / area;
    cases.push(Case::new("porosity at full size", "n", porosity, left, Near::Relative(1e-12)));
    let small = &radii[..2000];
    let part = Region::Rectangle { width: 0.1, height: 0.2 * 2000.0 / n };
    let centres = scatter::<D2>(small, &part, &mut Stream::new(1, "places", 0));
    let halves: Vec<f64> = small.iter().map(|r| 0.5 * r).collect();
    let porosity_of = |radii: &[f64]| 1.0 - ball_volume::<D2>(radii) / part.volume();
    let growth = ((1.0 - porosity_of(small)) / (1.0 - porosity_of(&halves))).sqrt();
    let grown = grown(&centres, &halves, growth);
    let label = "porosity after growth from the cloud";
    cases.push(Case::new(
        label,
        "m = √((1 − n)/(1 − n₀))",
        porosity_of(small),
        porosity_of(&grown),
        Near::Relative(1e-12),
    ));
    let overlap = |i: usize, j: usize| {
        let apart = [0, 1].map(|k| centres[i][k] - centres[j][k]);
        halves[i] + halves[j] - (apart[0] * apart[0] + apart[1] * apart[1]).sqrt()
    };
    let deepest =
        (0..2000).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| overlap(i, j)).fold(f64::MIN, f64::max);
    cases.push(Case::new("largest overlap in the cloud, m", "none", 0.0, deepest, Near::Below));
    let outside = small.iter().zip(&centres).map(|(r, &x)| 0.5 * r - part.depth::<D2>(x)).fold(f64::MIN, f64::max);
    cases.push(Case::new("farthest reach out of the vessel, m", "none", 0.0, outside, Near::Below));
}

/// Radii that the engine has after those of the cloud were multiplied.
fn grown(centres: &[[f64; 2]], radii: &[f64], factor: f64) -> Vec<f64> {
    let balls = centres.iter().zip(radii).map(|(&x, &r)| Particle::ball(x, r, 2000.0, GRAIN)).collect();
    let law = Interaction::unbonded(Linear::modulus(1e9, 1.0, 0.0));
    let mut engine = Engine::new(&model::<D2>(balls, vec![], law, Settings::default())).unwrap();
    let factors: Vec<(usize, f64)> = (0..radii.len()).map(|p| (p, factor)).collect();
    engine.scale_radii(&factors).unwrap();
    (0..radii.len()).map(|p| engine.radius(p)).collect()
}

fn packing(cases: &mut Vec<Case>) {
    let region = Region::Rectangle { width: 0.05, height: 0.1 };
    let recipe = Packing::uniform(0.12, 2e-3, 2.5);
    let packed = recipe.pack::<D2>(&region, &mut Stream::new(1, "packing", 0), &|| Watch::Continue).unwrap();
    let left = 1.0 - ball_volume::<D2>(&packed.heap.radii) / region.volume();
    cases.push(Case::new("packing: porosity after floaters were enlarged", "n", 0.12, left, Near::Relative(1e-12)));
    cases.push(Case::new("packing: unbalanced over contact force", "at rest", 1e-3, packed.unbalanced, Near::Below));
    let fabric = dem::genesis::fabric::Fabric::of(&packed.heap);
    cases.push(Case::new(
        "packing: contacts a ball",
        "rigid frictionless packing: 4",
        4.0,
        fabric.coordination,
        Near::Above,
    ));
    cases.push(Case::new(
        "packing: balls with fewer than 3 contacts",
        "none",
        0.0,
        fabric.floaters as f64,
        Near::Exact,
    ));
}

fn aggregate(cases: &mut Vec<Case>) {
    let bounds = [0.005, 0.007, 0.009, 0.011, 0.013, 0.015];
    let area = 0.02;
    let walraven = Gradation::Walraven { content: 0.75, max_size: 0.015 };
    let classes = walraven.classes(&bounds, area).unwrap();
    let printed = [59.0, 28.0, 15.0, 8.0, 4.0];
    let mut whole = 0.0;
    for (class, count) in classes.iter().zip(printed) {
        let label = format!("Walraven: particles of {} to {} mm", 1e3 * class.low, 1e3 * class.high);
        cases.push(Case::new(label, "Table 2, Su et al. 2021", count, class.count as f64, Near::Exact));
        whole += class.count as f64 * FRAC_PI_4 * class.middle() * class.middle();
    }
    cases.push(Case::new(
        "their area over the section's",
        "Σ n π d²/4 of the printed counts",
        5774.25e-6 / area,
        whole / area,
        Near::Relative(1e-6),
    ));
    cases.push(Case::new(
        "Walraven: passing at the largest size",
        "P_k Σ of the coefficients",
        0.75 * 0.998,
        walraven.passing(0.015),
        Near::Relative(1e-12),
    ));
    let fuller = Gradation::Fuller { content: 0.75, max_size: 0.015, exponent: 0.5 };
    cases.push(Case::new(
        "Fuller: passing at a quarter of the largest size",
        "P_k √x",
        0.375,
        fuller.passing(0.015 / 4.0),
        Near::Relative(1e-12),
    ));
    let count = fuller.classes(&[0.005, 0.007], area).unwrap()[0].count as f64;
    let share = 0.75 * ((7.0_f64 / 15.0).sqrt() - (5.0_f64 / 15.0).sqrt());
    let exact = share * area / (FRAC_PI_4 * 0.006 * 0.006);
    cases.push(Case::new(
        "Fuller: particles of 5 to 7 mm",
        "ΔP A/(π d²/4), eq. (10)",
        exact.round(),
        count,
        Near::Exact,
    ));
}

/// Polygons of n vertices, for a size of 2 m.
fn recipe(n: [usize; 2], size: SizeRule, angles: AngleLaw) -> PolygonRecipe {
    PolygonRecipe { min_vertices: n[0], max_vertices: n[1], size, angles, least_fill: 0.0 }
}

fn regular_polygons(cases: &mut Vec<Case>) {
    let near = Near::Relative(1e-12);
    for n in [3, 4, 6] {
        let mut stream = Stream::new(3, "even", n as u64);
        let found = recipe([n, n], SizeRule::Inscribed, AngleLaw::Even).draw(2.0, &mut stream).moments();
        let step = TAU / n as f64;
        let area = 0.5 * n as f64 * sin(step);
        cases.push(Case::new(format!("even polygon of {n}: area, m²"), "n/2 R² sin(2π/n)", area, found.area, near));
        let polar = area * (2.0 + cos(step)) / 6.0;
        cases.push(Case::new(
            format!("even polygon of {n}: polar moment, m⁴"),
            "A R² (2 + cos(2π/n))/6",
            polar,
            found.polar,
            near,
        ));
    }
    let equal = recipe([4, 6], SizeRule::EqualArea, AngleLaw::Random).draw(2.0, &mut Stream::new(3, "equal", 0));
    cases.push(Case::new("polygon of the area of its circle, m²", "π d²/4", PI, equal.moments().area, near));
}

fn random_polygons(cases: &mut Vec<Case>) {
    let draws = 4000;
    let mean_of = |n: usize| match n {
        4 => 3.0 / PI,
        5 => 10.0 / TAU - 60.0 / TAU.powi(3),
        _ => 15.0 / TAU - 180.0 / TAU.powi(3),
    };
    for n in [4, 5, 6] {
        let law = recipe([n, n], SizeRule::Inscribed, AngleLaw::Random);
        let mut stream = Stream::new(1, "mean area", n as u64);
        let areas: Vec<f64> = (0..draws).map(|_| law.draw(2.0, &mut stream).moments().area).collect();
        let mean = areas.iter().sum::<f64>() / f64::from(draws);
        let square = areas.iter().map(|a| (a - mean) * (a - mean)).sum::<f64>() / f64::from(draws - 1);
        let near = Near::Absolute(3.0 * (square / f64::from(draws)).sqrt());
        cases.push(Case::new(format!("{n} random vertices: mean area, m²"), "n/2 E[sin g] R²", mean_of(n), mean, near));
    }
    let law = recipe([4, 6], SizeRule::Inscribed, AngleLaw::Even);
    let mut stream = Stream::new(5, "vertices", 0);
    let mut seen = [0; 7];
    for _ in 0..draws {
        seen[law.draw(2.0, &mut stream).vertices.len()] += 1;
    }
    for (n, share) in [(4, 0.25), (5, 0.5), (6, 0.25_f64)] {
        let near = Near::Absolute(3.0 * (share * (1.0 - share) / f64::from(draws)).sqrt());
        let got = f64::from(seen[n]) / f64::from(draws);
        cases.push(Case::new(
            format!("share of polygons of {n} vertices out of 4 to 6"),
            "round(4 + 2u), eq. (7)",
            share,
            got,
            near,
        ));
    }
}
