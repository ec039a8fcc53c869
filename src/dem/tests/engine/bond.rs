//! Two bonded balls of different radius, pulled, sheared, bent and twisted until the bond breaks.
//!
//! Parallel bond of radius R̄ = λ min(R₁, R₂), section A, I, J: tension F = σ_c A at u = σ_c/k̄_n; shear F = τ_c A at
//! u = τ_c/k̄_s; bending M = σ_c I/(β R̄) at θ = σ_c/(β k̄_n R̄); torsion M = τ_c J/(β R̄) at θ = τ_c/(β k̄_s R̄); pull and
//! bending together N/A + β M R̄/I = σ_c; shear under pressure τ_c = c + p tan φ. Contact bond: T = σ_t A at T/k_n,
//! S = τ_s A at S/k_s, A of min(R₁, R₂). The balls move by 1/4000 of the way to the break in a step: that is the
//! tolerance.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::measure::Mode;
use dem::space::Tuple;
use dem::*;
use math::elementary::atan;
use std::sync::LazyLock;

const RADII: [f64; 2] = [0.5, 0.4];
const LAMBDA: f64 = 0.9;
const BETA: f64 = 0.6;
const KN: f64 = 1e9;
const KS: f64 = 5e8;
const SIGMA: f64 = 1e5;
const TAU: f64 = 1.5e5;
/// Radius of the cement.
const R: f64 = LAMBDA * 0.4;
const STEPS: f64 = 4000.0;
const NEAR: Near = Near::Relative(1e-3);

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Radii 0.5 and 0.4 m, λ = 0.9, β = 0.6, k̄_n 1e9 and k̄_s 5e8 Pa/m, σ_c 0.1 and c 0.15 MPa, no spring. Forces \
        are those of the last step before the break.";
    Family { title: "Two bonded balls to failure", about, cases: &CASES }
}

#[test]
fn bonds_break_at_their_closed_forms() {
    family().check();
}

fn cement(slope: f64) -> Bond {
    Bond::Parallel(ParallelBond {
        radius_multiplier: LAMBDA,
        stiffness: BondStiffness::PerArea { kn: KN, ks: KS },
        tensile_strength: SIGMA,
        cohesion: TAU,
        friction_angle: atan(slope),
        moment_factor: BETA,
        scatter: Scatter::default(),
    })
}

/// A bonded pair, held, at rest.
fn pair<S: Space>(linear: Linear, bond: Bond) -> Engine<S> {
    let at = [along::<S>(0, 0.0), along::<S>(0, RADII[0] + RADII[1])];
    let balls = at.iter().zip(RADII).map(|(&x, r)| Particle::ball(x, r, 2000.0, GRAIN)).collect();
    let settings = Settings { damping: 0.0, fixed_step: Some(1.0), ..Settings::default() };
    let mut engine = Engine::new(&model::<S>(balls, vec![], Interaction { linear, bond }, settings)).unwrap();
    assert_eq!(engine.install_bonds(1e-12, 1).unwrap(), 1);
    engine.fix(&[0, 1], true, true).unwrap();
    engine
}

/// What a bond carried before it broke, and after how many steps it did.
struct Broke {
    steps: f64,
    mode: Mode,
    normal: f64,
    shear: f64,
    bend: f64,
    twist: f64,
}

/// Moves the second ball on, with the spin about the bond's axis or across it, until the bond breaks.
fn until_broken<S: Space>(engine: &mut Engine<S>, velocity: Vector<S>, spin: Spin<S>) -> Broke {
    engine.set_motion(1, velocity, spin).unwrap();
    let mut last = Broke { steps: 0.0, mode: Mode::Tension, normal: 0.0, shear: 0.0, bend: 0.0, twist: 0.0 };
    let start = engine.steps();
    for _ in 0..20_000 {
        engine.advance(1).unwrap();
        if let Some(crack) = engine.cracks().first() {
            // The forces of the first step know its velocity, so n + 1 steps make n + 1 increments.
            return Broke { steps: (crack.step - start + 1) as f64, mode: crack.mode, ..last };
        }
        let contact = engine.contacts().next().unwrap();
        let force = contact.force();
        let normal = force.dot(contact.normal);
        let shear = force.minus(contact.normal.times(normal)).norm();
        let bend = (contact.moment.dot(contact.moment) - contact.twist * contact.twist).max(0.0).sqrt();
        last = Broke { normal, shear, bend, twist: contact.twist.abs(), ..last };
    }
    panic!("no break");
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cemented::<D2>(&mut cases);
    cemented::<D3>(&mut cases);
    twisted(&mut cases);
    point::<D2>(&mut cases);
    point::<D3>(&mut cases);
    cases
}

fn soft() -> Linear {
    Linear::direct(1e-9, 1e-9, 0.0)
}

fn cemented<S: Space>(cases: &mut Vec<Case>) {
    let name = S::NAME;
    let area = S::section(R);
    let inertia = S::GYRATION * area * R * R;
    let still = Spin::<S>::zero();
    let mut push = |what: &str, source, expected, got| {
        cases.push(Case::new(format!("{name}: {what}"), source, expected, got, NEAR));
    };
    let way = SIGMA / KN;
    let broke = until_broken(&mut pair::<S>(soft(), cement(0.0)), along::<S>(0, way / STEPS), still);
    assert_eq!(broke.mode, Mode::Tension);
    push("tension, force, N", "σ_c A, PC04", SIGMA * area, broke.normal);
    push("tension, opening, m", "σ_c/k̄_n", way, broke.steps * way / STEPS);
    let way = TAU / KS;
    let broke = until_broken(&mut pair::<S>(soft(), cement(0.0)), along::<S>(1, way / STEPS), still);
    assert_eq!(broke.mode, Mode::Shear);
    push("shear, force, N", "τ_c A, PC04", TAU * area, broke.shear);
    push("shear, slide, m", "τ_c/k̄_s", way, broke.steps * way / STEPS);
    let angle = SIGMA / (BETA * KN * R);
    // Bending turns both balls against each other, or the bond would shear.
    let mut engine = pair::<S>(soft(), cement(0.0));
    let share = RADII[1] / (RADII[0] + RADII[1]);
    engine.set_motion(0, Vector::<S>::zero(), about::<S>(-share * angle / STEPS)).unwrap();
    let broke = until_broken(&mut engine, Vector::<S>::zero(), about::<S>((1.0 - share) * angle / STEPS));
    assert_eq!(broke.mode, Mode::Tension);
    push("bending, moment, N·m", "σ_c I/(β R̄), PC04", SIGMA * inertia / (BETA * R), broke.bend);
    push("bending, angle, rad", "σ_c/(β k̄_n R̄)", angle, broke.steps * angle / STEPS);
    let mut engine = pair::<S>(soft(), cement(0.0));
    engine.set_motion(0, Vector::<S>::zero(), about::<S>(-share * angle / STEPS)).unwrap();
    let opening = 0.5 * SIGMA / KN;
    let broke = until_broken(&mut engine, along::<S>(0, opening / STEPS), about::<S>((1.0 - share) * angle / STEPS));
    push(
        "tension and bending, stress, Pa",
        "N/A + β M R̄/I = σ_c",
        SIGMA,
        broke.normal / area + BETA * broke.bend * R / inertia,
    );
    push("tension and bending, share of the way", "1/(1/2 + 1)", 2.0 / 3.0, broke.steps / STEPS);
    let mut engine = pair::<S>(soft(), cement(0.5));
    let pressure = 0.4 * TAU;
    engine.set_motion(1, along::<S>(0, -pressure / KN / 100.0), still).unwrap();
    engine.advance(100).unwrap();
    let way = (TAU + 0.5 * pressure) / KS;
    let broke = until_broken(&mut engine, along::<S>(1, way / STEPS), still);
    push("shear under pressure p, force, N", "(c + p tan φ) A, PFC", (TAU + 0.5 * pressure) * area, broke.shear);
}

fn twisted(cases: &mut Vec<Case>) {
    let area = D3::section(R);
    let polar = 2.0 * D3::GYRATION * area * R * R;
    let angle = TAU / (BETA * KS * R);
    let spin = [angle / STEPS, 0.0, 0.0];
    let broke = until_broken(&mut pair::<D3>(soft(), cement(0.0)), [0.0; 3], spin);
    assert_eq!(broke.mode, Mode::Shear);
    cases.push(Case::new("3D: torsion, moment, N·m", "τ_c J/(β R̄), PC04", TAU * polar / (BETA * R), broke.twist, NEAR));
    cases.push(Case::new("3D: torsion, angle, rad", "τ_c/(β k̄_s R̄)", angle, broke.steps * angle / STEPS, NEAR));
    let mut engine = pair::<D3>(soft(), cement(0.0));
    let broke = until_broken(&mut engine, [0.0, 0.5 * TAU / KS / STEPS, 0.0], spin);
    let stress = broke.shear / area + BETA * broke.twist * R / polar;
    cases.push(Case::new("3D: shear and torsion, stress, Pa", "F_s/A + β M_t R̄/J = τ_c", TAU, stress, NEAR));
}

fn point<S: Space>(cases: &mut Vec<Case>) {
    let bond = ContactBond {
        tensile_strength: SIGMA,
        shear_strength: TAU,
        scatter: Scatter::default(),
        shear_break: ShearBreak::Keep,
    };
    let make = || pair::<S>(Linear::direct(KN, KS, 0.5), Bond::Contact(bond));
    let (name, area) = (S::NAME, S::section(0.4));
    let (pull, drag) = (SIGMA * area, TAU * area);
    let broke = until_broken(&mut make(), along::<S>(0, pull / KN / STEPS), Spin::<S>::zero());
    assert_eq!(broke.mode, Mode::Tension);
    cases.push(Case::new(format!("{name}: contact bond in tension, N"), "σ_t A, PFC", pull, broke.normal, NEAR));
    let broke = until_broken(&mut make(), along::<S>(1, drag / KS / STEPS), Spin::<S>::zero());
    assert_eq!(broke.mode, Mode::Shear);
    cases.push(Case::new(format!("{name}: contact bond in shear, N"), "τ_s A, PFC", drag, broke.shear, NEAR));
    for (shear_break, what) in [(ShearBreak::Keep, "kept"), (ShearBreak::Zero, "zeroed")] {
        let bond = ContactBond { shear_break, ..bond };
        let made = pair::<S>(Linear::direct(KN, KS, 0.5), Bond::Contact(bond));
        after_shear_break(made, drag, &format!("{name}, shear force {what}"), shear_break, cases);
    }
}

/// Normal (compression positive) and shear force of the one contact.
fn carried<S: Space>(engine: &Engine<S>) -> [f64; 2] {
    let contact = engine.contacts().next().unwrap();
    let normal = contact.force().dot(contact.normal);
    [-normal, contact.force().minus(contact.normal.times(normal)).norm()]
}

/// A pressed pair sheared until its contact bond breaks, and beyond; one that is pulled and sheared.
fn after_shear_break<S: Space>(
    mut engine: Engine<S>,
    drag: f64,
    label: &str,
    shear_break: ShearBreak,
    cases: &mut Vec<Case>,
) {
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(format!("{label}: {what}"), source, expected, got, near));
    };
    let (still, slide) = (Spin::<S>::zero(), along::<S>(1, drag / KS / STEPS));
    let mut pulled = engine.clone();
    engine.track_energy();
    engine.set_motion(1, along::<S>(0, -0.2 * drag / KN / 100.0), still).unwrap();
    engine.advance(100).unwrap();
    let broke = until_broken(&mut engine, slide, still);
    assert_eq!(broke.mode, Mode::Shear);
    let [press, kept] = carried(&engine);
    let (left, source) = match shear_break {
        ShearBreak::Keep => (0.5 * press, "μ F_n, PFC 3"),
        ShearBreak::Zero => (0.0, "0, PFC"),
    };
    push("after the break, N", source, left, kept, if left > 0.0 { NEAR } else { Near::Absolute(1e-6) });
    push("dropped by it, N", "τ_s A less what is left", drag - left, broke.shear - kept, NEAR);
    let spent = 0.5 * (drag * drag - left * left) / KS;
    push("energy of the break, J", "(F² − F′²)/2k_s", spent, measure::energy(&engine).broken, Near::Relative(2e-3));
    engine.advance(200).unwrap();
    let [press, sheared] = carried(&engine);
    let slid = left + 200.0 / STEPS * drag;
    push("200 steps on, N", "min(F′ + k_s u, μ F_n)", slid.min(0.5 * press), sheared, NEAR);
    engine.advance(2000).unwrap();
    let [press, sheared] = carried(&engine);
    push("2200 steps on, N", "μ F_n", 0.5 * press, sheared, NEAR);
    pulled.set_motion(1, along::<S>(0, 0.2 * drag / KN / 100.0), still).unwrap();
    pulled.advance(100).unwrap();
    assert_eq!(until_broken(&mut pulled, slide, still).mode, Mode::Shear);
    let [press, sheared] = carried(&pulled);
    push("under tension, after the break, N", "0", 0.0, press.abs() + sheared, Near::Absolute(1e-6));
}
