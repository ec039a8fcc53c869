//! From moduli to the stiffness of a contact in both conventions, and the bilinear contact of spring and cement.
//!
//! Present convention: k_n = E* A/L with A = 2 r t or π r², r = min(R₁, R₂), L = R₁ + R₂, at a wall L = R. That of 2004:
//! E* t in the plane, 4 E* R₁R₂/(R₁ + R₂) in the solid. Cement: k̄_n A = (Ē/L) A(λ r), moments by I(λ r). In tension the
//! cement acts alone; in compression the spring beside it, where a gap was bonded only from the touch of the surfaces on.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::space::Tuple;
use dem::*;
use std::f64::consts::PI;
use std::sync::LazyLock;

const RADII: [f64; 2] = [0.5, 0.4];
const NEAR: Near = Near::Relative(1e-9);

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Radii 0.5 and 0.4 m (the first at the wall), E* 1 GPa, κ 2.5; Ē 2 GPa. The pair is moved by hand, u = 1e-5 m; a \
        bonded gap is 5e-6 m.";
    Family { title: "Moduli, stiffnesses, and the bilinear contact", about, cases: &CASES }
}

#[test]
fn contacts_have_the_stiffness_of_their_modulus() {
    family().check();
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let present = "E* A/L, PFC";
    let old = "E* t (wall 2 E* t), PC04";
    moduli::<D2>(Convention::Present, present, [1e9 * 0.8 / 0.9, 2e9], &mut cases);
    moduli::<D2>(Convention::Pc2004, old, [1e9, 2e9], &mut cases);
    moduli::<D3>(Convention::Present, present, [1e9 * PI * 0.16 / 0.9, 1e9 * PI * 0.5], &mut cases);
    let old = "4 E* R₁R₂/(R₁+R₂) (wall 4 E* R), PC04";
    moduli::<D3>(Convention::Pc2004, old, [4e9 * 0.2 / 0.9, 2e9], &mut cases);
    let square = |convention| pair::<D3>(spring(convention), 0.5, 0.0).contacts().next().unwrap().stiffness[0];
    let ratio = square(Convention::Pc2004) / square(Convention::Present);
    cases.push(Case::new("3D, equal radii: k_n of 2004 over the present one", "4/π", 4.0 / PI, ratio, NEAR));
    cement::<D2>(0.8 / 0.9, [1.0 / 2.0, 1.0 / 8.0], &mut cases);
    cement::<D3>(PI * 0.16 / 0.9, [1.0 / 4.0, 1.0 / 16.0], &mut cases);
    cases
}

fn spring(convention: Convention) -> Interaction {
    let stiffness = Stiffness::Modulus { modulus: 1e9, ratio: 2.5, convention };
    Interaction::unbonded(Linear { stiffness, ..Linear::direct(1.0, 1.0, 0.5) })
}

/// Two balls along the first axis, the second of radius `second`, `gap` apart; the first rests on the floor.
fn pair<S: Space>(law: Interaction, second: f64, gap: f64) -> Engine<S> {
    let centre = |x: f64| along::<S>(0, x).plus(along::<S>(1, RADII[0]));
    let balls = vec![
        Particle::ball(centre(0.0), RADII[0], 2000.0, GRAIN),
        Particle::ball(centre(RADII[0] + second + gap), second, 2000.0, GRAIN),
    ];
    Engine::new(&model::<S>(balls, vec![floor()], law, Settings { damping: 0.0, ..Settings::default() })).unwrap()
}

fn moduli<S: Space>(convention: Convention, source: &'static str, expected: [f64; 2], cases: &mut Vec<Case>) {
    let engine = pair::<S>(spring(convention), RADII[1], 0.0);
    let label = |what: &str| format!("{}, {convention:?}: {what}, N/m", S::NAME);
    for contact in engine.contacts() {
        let [kn, ks] = contact.stiffness;
        match contact.other {
            Other::Particle(_) => {
                cases.push(Case::new(label("k_n of two balls"), source, expected[0], kn, NEAR));
                cases.push(Case::new(label("k_s of two balls"), "k_n/κ, PFC", expected[0] / 2.5, ks, NEAR));
            }
            Other::Wall(_) => cases.push(Case::new(label("k_n at a wall"), source, expected[1], kn, NEAR)),
        }
    }
}

fn cemented(multiplier: f64) -> Interaction {
    let bond = ParallelBond {
        radius_multiplier: multiplier,
        stiffness: BondStiffness::Modulus { modulus: 2e9, ratio: 2.5 },
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    Interaction { bond: Bond::Parallel(bond), ..spring(Convention::Present) }
}

/// Tension of a bonded pair (N) whose second ball came `way` nearer, and the bond's moment after a turn of the second by
/// the same angle (N·m).
fn moved<S: Space>(multiplier: f64, gap: f64, way: f64) -> [f64; 2] {
    let mut engine = pair::<S>(cemented(multiplier), RADII[1], gap);
    engine.install_bonds(1e-4, 0).unwrap();
    engine.fix(&[0, 1], true, true).unwrap();
    let steps = 1000;
    let rate = way / (steps as f64 * engine.time_step());
    engine.set_motion(1, along::<S>(0, -rate), about::<S>(rate)).unwrap();
    // The forces of a step are those of the positions at its start, after the displacement that led there.
    engine.advance(steps + 1).unwrap();
    let contact = engine.contacts().find(|c| matches!(c.other, Other::Particle(_))).unwrap();
    [contact.force().dot(contact.normal), contact.moment.norm()]
}

fn cement<S: Space>(shape: f64, powers: [f64; 2], cases: &mut Vec<Case>) {
    let (kn, bond, u) = (1e9 * shape, 2e9 * shape, 1e-5);
    let near = Near::Relative(2e-3);
    let [pulled, bent] = moved::<S>(1.0, 0.0, -u);
    let mut add = |what: &str, source, expected, got| {
        cases.push(Case::new(format!("{}: {what}", S::NAME), source, expected, got, near));
    };
    add("pulled by u, N", "k̄_n A u: cement alone", bond * u, pulled);
    add("pushed by u, N", "(k̄_n A + k_n) u: bilinear", (bond + kn) * u, -moved::<S>(1.0, 0.0, u)[0]);
    let gap = 0.5 * u;
    add(
        "bonded across a gap, pushed by u, N",
        "k̄_n A u + k_n (u − gap)",
        bond * u + kn * gap,
        -moved::<S>(1.0, gap, u)[0],
    );
    let [thin, thin_bent] = moved::<S>(0.5, 0.0, -u);
    add("force at λ = 1/2 over that at 1", "λ^(d−1)", powers[0], thin / pulled);
    add("moment at λ = 1/2 over that at 1", "I ~ λ³ (2D), λ⁴ (3D)", powers[1], thin_bent / bent);
}
