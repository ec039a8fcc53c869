//! Random packings of cemented discs in a periodic cell: how E over the cement's modulus and ν follow k̄_n/k̄_s.
//!
//! There is no closed form. Published trends (Potyondy & Cundall 2004): ν rises with k̄_n/k̄_s and depends on little else, E
//! falls with it. The hexagonal lattice of six bonds a disc is stiffer: E/Ē = 2√3 (1 + κ⁻¹)/(3 + κ⁻¹).

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::*;
use math::random::Stream;
use std::sync::LazyLock;

const MODULUS: f64 = 1e9;
const COUNT: usize = 400;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "400 discs, radii uniform from 0.75 to 1.25 m, in a periodic cell, settled without friction, overlaps taken as the \
        state of rest, cemented where they touch (bond gap 0) or are nearer than 0.05 m (bond gap 0.05 of the mean radius), cement \
        alone (no spring), λ = 1. One packing, its porosity n, bonds a disc z and bond gap with every number; scatter between \
        packings is 1–4 % in E and 2–10 % in ν.";
    Family { title: "Random packing of cemented discs", about, cases: &CASES }
}

#[test]
fn a_random_packing_shows_the_published_trends() {
    family().check();
}

fn law(ratio: f64) -> Interaction {
    let cement = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::Modulus { modulus: MODULUS, ratio },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    Interaction { linear: Linear::direct(1e-6, 1e-6, 0.0), bond: Bond::Parallel(cement) }
}

/// Places and radii of a settled packing, and the edge of its cell.
fn packed() -> (Vec<Particle<D2>>, f64) {
    let mut stream = Stream::new(4, "cell", 0);
    let radii: Vec<f64> = (0..COUNT).map(|_| stream.uniform_in(0.75, 1.25)).collect();
    let solid: f64 = radii.iter().map(|&r| D2::volume(r)).sum();
    let edge = (solid / 0.86_f64).sqrt();
    let step = edge / 20.0;
    let place = |k: usize, s: &mut Stream| {
        let cell = [k % 20, k / 20].map(|c| (c as f64 + 0.5 + s.uniform_in(-0.3, 0.3)) * step);
        [cell[0], cell[1]]
    };
    let balls =
        radii.iter().enumerate().map(|(k, &r)| Particle::ball(place(k, &mut stream), r, 2000.0, GRAIN)).collect();
    let smooth = Interaction::unbonded(Linear::modulus(MODULUS, 1.0, 0.0));
    let mut engine = Engine::new(&model::<D2>(balls, vec![], smooth, settings(edge, f64::INFINITY))).unwrap();
    for _ in 0..100 {
        engine.advance(10).unwrap();
        engine.calm();
    }
    engine.advance(10_000).unwrap();
    let settled = (0..COUNT).map(|p| Particle { velocity: [0.0; 2], spin: [0.0], ..engine.particle(p) });
    let inside = settled.map(|p| Particle { position: p.position.map(|x| x - (x / edge).floor() * edge), ..p });
    (inside.collect(), edge)
}

fn settings(edge: f64, overlap_limit: f64) -> Settings<D2> {
    let cell = Cell { low: [0.0; 2], edges: [edge; 2], rate: [[0.0; 3]; 3] };
    Settings { cell: Some(cell), overlap_limit, ..Settings::default() }
}

/// E and ν of the cemented packing, and its bonds.
fn elastic(balls: &[Particle<D2>], edge: f64, ratio: f64, gap: f64) -> ([f64; 2], usize) {
    let strained = |axis: usize| {
        let model = model::<D2>(balls.to_vec(), vec![], law(ratio), settings(edge, 1.0));
        let mut engine = Engine::new(&model).unwrap();
        let bonds = engine.install_bonds(gap, 1).unwrap();
        let mut rate = [[0.0; 3]; 3];
        rate[axis][axis] = 1e-6 / (2000.0 * engine.time_step());
        engine.strain_cell(rate).unwrap();
        engine.advance(2000).unwrap();
        engine.strain_cell([[0.0; 3]; 3]).unwrap();
        engine.advance(6000).unwrap();
        let stress = measure::cell_stress(&engine).unwrap();
        ([-stress[axis][axis] / 1e-6, -stress[1 - axis][1 - axis] / 1e-6], bonds)
    };
    let [(a, bonds), (b, _)] = [0, 1].map(strained);
    let c = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
    ([c[0] - c[1] * c[1] / c[0], c[1] / c[0]], bonds)
}

/// Installation gaps over the mean radius, and ratios k̄_n/k̄_s.
const GAPS: [f64; 2] = [0.0, 0.05];
const RATIOS: [f64; 3] = [1.0, 2.5, 4.0];

fn cases() -> Vec<Case> {
    let (balls, edge) = packed();
    let solid: f64 = balls.iter().map(|p| D2::volume(p.radius)).sum();
    let porosity = 1.0 - solid / (edge * edge);
    let near = Near::Relative(1e-6);
    let mut cases = vec![Case::new("porosity n (overlaps counted twice)", "as made", 0.14, porosity, near)];
    let found = GAPS.map(|gap| RATIOS.map(|ratio| elastic(&balls, edge, ratio, gap)));
    let around = found.map(|of_gap| 2.0 * of_gap[0].1 as f64 / COUNT as f64);
    let rigid = "rigid frictionless packing: 4";
    cases.push(Case::new("bonds a disc z, bond gap 0", rigid, 4.0, around[0], Near::Relative(0.1)));
    cases.push(Case::new("bonds a disc z, bond gap 0.05", "more than at 0", around[0], around[1], Near::Above));
    for ((gap, around), of_gap) in GAPS.iter().zip(around).zip(&found) {
        let state = format!("n {porosity:.2}, z {around:.2}, gap {gap}");
        for (ratio, ([e, _], _)) in RATIOS.iter().zip(of_gap) {
            let label = format!("{state}: E/Ē at k̄_n/k̄_s = {ratio}");
            cases.push(Case::new(label, "below the hexagonal lattice", lattice(*ratio)[0], e / MODULUS, Near::Below));
        }
        for k in 1..RATIOS.len() {
            let ([before, own], trend) = ([of_gap[k - 1].0, of_gap[k].0], "trend, PC04");
            let way = format!("from k̄_n/k̄_s {} to {}", RATIOS[k - 1], RATIOS[k]);
            let (e, nu) = (format!("{state}: E/Ē falls {way}"), format!("{state}: ν rises {way}"));
            cases.push(Case::new(e, trend, before[0] / MODULUS, own[0] / MODULUS, Near::Below));
            cases.push(Case::new(nu, trend, before[1], own[1], Near::Above));
        }
    }
    for (k, ratio) in RATIOS.iter().enumerate() {
        let [narrow, wide] = found.map(|of_gap| of_gap[k].0[0] / MODULUS);
        let label = format!("E/Ē rises from bond gap 0 to 0.05 at k̄_n/k̄_s = {ratio}");
        cases.push(Case::new(label, "trend: more bonds", narrow, wide, Near::Above));
    }
    cases
}

/// E over the modulus, and ν, of the hexagonal lattice.
fn lattice(ratio: f64) -> [f64; 2] {
    let ks = 1.0 / ratio;
    [2.0 * 3.0_f64.sqrt() * (1.0 + ks) / (3.0 + ks), (1.0 - ks) / (3.0 + ks)]
}
