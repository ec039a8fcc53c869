//! Regular lattices in a periodic cell: elastic constants, first crack, and the stress ratio at which unbonded ones slip.
//!
//! In a homogeneous strain neighbours do not turn against each other. With l = 2R and whole stiffnesses k_n, k_s of a
//! contact (thickness 1 in the plane), C₁₁, C₁₂ and the shear modulus G are
//!
//! | lattice | C₁₁ | C₁₂ | G |
//! |---|---|---|---|
//! | hexagonal | √3/4 (3k_n + k_s) | √3/4 (k_n − k_s) | √3/4 (k_n + k_s) |
//! | square | k_n | 0 | k_s/2 |
//! | simple cubic | k_n/l | 0 | k_s/(2l) |
//! | BCC | (k_n + 2k_s)/(√3 l) | (k_n − k_s)/(√3 l) | (2k_n + k_s)/(2√3 l) |
//! | FCC | √2 (k_n + k_s)/l | √2 (k_n − k_s)/(2l) | √2 (k_n + k_s)/(2l) |
//!
//! E = C₁₁ − C₁₂²/C₁₁, ν = C₁₂/C₁₁ in the plane; E = C₁₁ − 2C₁₂²/(C₁₁ + C₁₂), ν = C₁₂/(C₁₁ + C₁₂) along an edge of a cube.
//!
//! First crack of the bonded hexagon (bond area l): tension across the rows σ_c 2√3 (k_n + k_s)/(2k_n + k_s) or shear
//! 2τ_c (k_n + k_s)/k_s; tension along the rows σ_c 2√3 (k_n + k_s)/(3k_n + k_s); compression across the rows
//! σ_c 2√3 (k_n + k_s)/(k_n − k_s) by the bonds of the rows, or 2τ_c (k_n + k_s)/k_s by shear of the inclined ones.
//!
//! Unbonded, nearly rigid contacts slip at σ₁/σ₃ = tan 60° tan(60° + φ) = √3 (√3 + μ)/(1 − √3 μ) (hexagonal, across the rows)
//! and 2(1 + μ)/(1 − μ) (FCC along an edge). The cell is strained along the path on which the inclined contacts keep
//! their overlap, so that the others open.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::sync::LazyLock;

pub(crate) const KN: f64 = 1e6;
pub(crate) const KS: f64 = 4e5;
const STEPS: u64 = 500;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Periodic cells of 16 discs, 64 (simple cubic), 54 (BCC) and 108 (FCC) spheres of radius 0.5 m, k_n 1e6, k_s \
        4e5 N/m; strain 1e-6 for the constants, 1e-4 to the first crack. Derived in bonded-particle theory by affine \
        deformation; E and ν from the measured C₁₁ and C₁₂.";
    Family { title: "Lattices", about, cases: &CASES }
}

#[test]
fn lattices_have_their_closed_forms() {
    family().check();
}

/// A lattice of balls of radius 0.5 at distance l: places in one repeat and the repeat's edges, over l.
pub(crate) struct Lattice {
    pub(crate) name: &'static str,
    pub(crate) basis: Vec<[f64; 3]>,
    pub(crate) repeat: [f64; 3],
    count: [usize; 3],
    /// C₁₁, C₁₂, G over 1 N/m and l = 1 m.
    pub(crate) constants: [f64; 3],
}

pub(crate) fn lattices() -> Vec<Lattice> {
    let (r2, r3) = (2.0_f64.sqrt(), 3.0_f64.sqrt());
    let (a, b) = (2.0 / r3, r2);
    let square = Lattice {
        name: "2D square",
        basis: vec![[0.0; 3]],
        repeat: [1.0, 1.0, 0.0],
        count: [4, 4, 1],
        constants: [KN, 0.0, KS / 2.0],
    };
    let cubic = Lattice {
        name: "3D simple cubic",
        basis: vec![[0.0; 3]],
        repeat: [1.0; 3],
        count: [4; 3],
        constants: [KN, 0.0, KS / 2.0],
    };
    let body = Lattice {
        name: "3D BCC",
        basis: vec![[0.0; 3], [a / 2.0; 3]],
        repeat: [a; 3],
        count: [3; 3],
        constants: [(KN + 2.0 * KS) / r3, (KN - KS) / r3, (2.0 * KN + KS) / (2.0 * r3)],
    };
    let h = b / 2.0;
    let face = Lattice {
        name: "3D FCC",
        basis: vec![[0.0; 3], [0.0, h, h], [h, 0.0, h], [h, h, 0.0]],
        repeat: [b; 3],
        count: [3; 3],
        constants: [r2 * (KN + KS), r2 * (KN - KS) / 2.0, r2 * (KN + KS) / 2.0],
    };
    vec![hexagon(), square, cubic, body, face]
}

/// E and ν in the plane by C₁₁ and C₁₂.
pub(crate) fn of_sheet(c11: f64, c12: f64) -> [f64; 2] {
    [c11 - c12 * c12 / c11, c12 / c11]
}

/// E and ν along an edge of a cube by C₁₁ and C₁₂.
pub(crate) fn along_edge(c11: f64, c12: f64) -> [f64; 2] {
    [c11 - 2.0 * c12 * c12 / (c11 + c12), c12 / (c11 + c12)]
}

pub(crate) fn hexagon() -> Lattice {
    let r3 = 3.0_f64.sqrt();
    let c = r3 / 4.0;
    Lattice {
        name: "2D hexagonal",
        basis: vec![[0.0; 3], [0.5, r3 / 2.0, 0.0]],
        repeat: [1.0, r3, 0.0],
        count: [4, 2, 1],
        constants: [c * (3.0 * KN + KS), c * (KN - KS), c * (KN + KS)],
    }
}

/// The lattice at distance `l` of the centres, with one law, undamped.
pub(crate) fn crystal<S: Space>(lattice: &Lattice, l: f64, law: Interaction) -> Engine<S> {
    let mut balls = Vec::new();
    let [nx, ny, nz] = lattice.count;
    for cell in 0..nx * ny * nz {
        let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
        for place in &lattice.basis {
            // A little off the corner, so that rounding puts nobody outside.
            let x = |k: usize| l * (place[k] + lattice.repeat[k] * (at[k] as f64 + 0.1));
            balls.push(Particle::<S>::ball(Vector::<S>::build(x), 0.5, 2000.0, GRAIN));
        }
    }
    let edges = Vector::<S>::build(|k| l * lattice.repeat[k] * lattice.count[k] as f64);
    let cell = Cell { low: Vector::<S>::zero(), edges, rate: [[0.0; 3]; 3] };
    let settings = Settings { damping: 0.0, cell: Some(cell), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    engine.install_bonds(1e-6, 1).unwrap();
    engine
}

/// A rate that gives `strain` in `STEPS` steps.
fn rate<S: Space>(engine: &Engine<S>, strain: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    strain.map(|row| row.map(|e| e / (STEPS as f64 * engine.time_step())))
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for lattice in lattices() {
        if lattice.name.starts_with("2D") {
            elastic::<D2>(&lattice, &mut cases);
        } else {
            elastic::<D3>(&lattice, &mut cases);
        }
    }
    first_cracks(&mut cases);
    slipping(&mut cases);
    cases
}

fn elastic<S: Space>(lattice: &Lattice, cases: &mut Vec<Case>) {
    let strong = ContactBond {
        tensile_strength: f64::INFINITY,
        shear_strength: f64::INFINITY,
        scatter: Scatter::default(),
        shear_break: ShearBreak::Keep,
    };
    let law = Interaction { linear: Linear::direct(KN, KS, 0.0), bond: Bond::Contact(strong) };
    let strained = |strain: [[f64; 3]; 3]| {
        let mut engine = crystal::<S>(lattice, 1.0, law);
        engine.strain_cell(rate(&engine, strain)).unwrap();
        engine.advance(STEPS).unwrap();
        measure::cell_stress(&engine).unwrap().map(|row| row.map(|s| -s / 1e-6))
    };
    let pulled = strained([[1e-6, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    let sheared = strained([[0.0, 5e-7, 0.0], [5e-7, 0.0, 0.0], [0.0; 3]]);
    let [c11, c12, g] = lattice.constants;
    let modulus = if S::DIMENSION == 2 { of_sheet } else { along_edge };
    let got = [pulled[0][0], pulled[1][1], sheared[0][1]];
    let [wanted, found] = [modulus(c11, c12), modulus(got[0], got[1])];
    let rows = [
        ("C₁₁, Pa", c11, got[0]),
        ("C₁₂, Pa", c12, got[1]),
        ("G, Pa", g, got[2]),
        ("E, Pa", wanted[0], found[0]),
        ("ν", wanted[1], found[1]),
    ];
    for (what, expected, got) in rows {
        let near = if expected == 0.0 { Near::Absolute(1e-5 * KN) } else { Near::Relative(1e-5) };
        let near = if what == "ν" && expected == 0.0 { Near::Absolute(1e-5) } else { near };
        cases.push(Case::new(format!("{}: {what}", lattice.name), "affine, exact", expected, got, near));
    }
}

/// Axial stress of the bonded hexagon before its first crack, under a strain that is uniaxial stress along `axis`.
fn strength(axis: usize, sign: f64, tensile: f64, cohesion: f64, at: f64) -> (f64, measure::Mode) {
    let cement = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::PerArea { kn: KN, ks: KS },
        tensile_strength: tensile,
        cohesion,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    let law = Interaction { linear: Linear::direct(1e-6, 1e-6, 0.0), bond: Bond::Parallel(cement) };
    let mut engine = crystal::<D2>(&hexagon(), 1.0, law);
    let young = 2.0 * 3.0_f64.sqrt() * KN * (KN + KS) / (3.0 * KN + KS);
    let poisson = (KN - KS) / (3.0 * KN + KS);
    let axial = sign * at / young;
    let mut strain = [[0.0; 3]; 3];
    strain[axis][axis] = axial;
    strain[1 - axis][1 - axis] = -poisson * axial;
    // Four times the steps, so that one is 1/2000 of the way.
    engine.strain_cell(rate(&engine, strain).map(|row| row.map(|e| e / 4.0))).unwrap();
    let mut last = 0.0;
    for _ in 0..6 * STEPS {
        engine.advance(1).unwrap();
        if let Some(crack) = engine.cracks().first() {
            return (last, crack.mode);
        }
        last = measure::cell_stress(&engine).unwrap()[axis][axis].abs();
    }
    panic!("no crack");
}

fn first_cracks(cases: &mut Vec<Case>) {
    let (strong, weak, root) = (1e9, 100.0, 2.0 * 3.0_f64.sqrt());
    let sum = KN + KS;
    let runs = [
        (
            "tension across the rows, by tension",
            1,
            1.0,
            weak,
            strong,
            weak * root * sum / (2.0 * KN + KS),
            "σ_c 2√3(k_n+k_s)/(2k_n+k_s)",
        ),
        ("tension across the rows, by shear", 1, 1.0, strong, weak, 2.0 * weak * sum / KS, "2τ_c(k_n+k_s)/k_s"),
        (
            "tension along the rows",
            0,
            1.0,
            weak,
            strong,
            weak * root * sum / (3.0 * KN + KS),
            "σ_c 2√3(k_n+k_s)/(3k_n+k_s)",
        ),
        (
            "compression across the rows, by tension",
            1,
            -1.0,
            weak,
            strong,
            weak * root * sum / (KN - KS),
            "σ_c 2√3(k_n+k_s)/(k_n−k_s)",
        ),
        ("compression across the rows, by shear", 1, -1.0, strong, weak, 2.0 * weak * sum / KS, "2τ_c(k_n+k_s)/k_s"),
    ];
    for (what, axis, sign, tensile, cohesion, expected, source) in runs {
        let (got, mode) = strength(axis, sign, tensile, cohesion, expected);
        assert_eq!(mode == measure::Mode::Tension, tensile == weak, "{what}");
        cases.push(Case::new(
            format!("2D hexagonal: first crack, {what}, Pa"),
            source,
            expected,
            got,
            Near::Relative(2e-3),
        ));
    }
}

/// Largest σ along `axis` over σ along the first axis. A lattice that slips everywhere does not stay regular for long:
/// rounding grows, so the peak is taken.
fn ratio<S: Space>(lattice: &Lattice, mu: f64, strain: [[f64; 3]; 3], axis: usize) -> f64 {
    let law = Interaction::unbonded(Linear::direct(KN, KS, mu));
    let mut engine = crystal::<S>(lattice, 1.0 - 1e-5, law);
    engine.strain_cell(rate(&engine, strain)).unwrap();
    let mut peak: f64 = 0.0;
    for _ in 0..STEPS {
        engine.advance(1).unwrap();
        let stress = measure::cell_stress(&engine).unwrap();
        peak = peak.max(stress[axis][axis] / stress[0][0]);
    }
    peak
}

fn slipping(cases: &mut Vec<Case>) {
    let (mu, e, r3) = (0.3, 2.5e-5, 3.0_f64.sqrt());
    let found = ratio::<D2>(&hexagon(), mu, [[3.0 * e, 0.0, 0.0], [0.0, -e, 0.0], [0.0; 3]], 1);
    let expected = r3 * (r3 + mu) / (1.0 - r3 * mu);
    let near = Near::Relative(5e-3);
    cases.push(Case::new("2D hexagonal, μ = 0.3: σ₁/σ₃ at slip", "tan 60° tan(60°+φ)", expected, found, near));
    let face = lattices().remove(4);
    let found = ratio::<D3>(&face, mu, [[e, 0.0, 0.0], [0.0, e, 0.0], [0.0, 0.0, -e]], 2);
    let expected = 2.0 * (1.0 + mu) / (1.0 - mu);
    cases.push(Case::new("3D FCC, μ = 0.3: σ₁/σ₃ at slip", "2(1+μ)/(1−μ)", expected, found, near));
}

#[test]
fn a_strained_cell_has_the_same_bits_on_every_thread() {
    let law = bonded();
    let run = |threads| {
        let mut engine = crystal::<D3>(&lattices()[4], 1.0, law);
        engine.set_threads(threads);
        engine.strain_cell(rate(&engine, [[4e-3, 8e-4, 0.0], [0.0, -2e-3, 0.0], [0.0; 3]])).unwrap();
        engine.advance(STEPS).unwrap();
        (engine.position(17), measure::cell_stress(&engine), engine.cracks().len(), engine.cell_volume())
    };
    let alone = run(1);
    assert!(alone.2 > 10, "{} cracks", alone.2);
    assert_eq!(run(2), alone);
}
