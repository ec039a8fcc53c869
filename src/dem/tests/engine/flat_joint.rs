//! One interface between two held balls: pulled, sheared, bent, twisted, closed and opened.
//!
//! Interface of radius R = λ min(R₁, R₂), area A, I and J; N elements. Tension: all break at F = σ_b A. Shear under a
//! compression P: c_b A + P tan φ_b, then μ P. Bending: M = k_n I θ for every N; first break of an element at r from the
//! axis at θ = σ_b/(k_n r). Without opening the outer elements go one after the other; as N grows the moment becomes that of the
//! elastic–brittle section, k_n θ (R³ + x³)/3 with x = σ_b/(k_n θ) (plane, exact). Slit under P: M = k_n I θ until its rim
//! opens at M = P R/3 (plane), and beyond ∫ r k_n min(g, 0) dr. Gapped: no force until g₀ is closed. Torsion: M = k_s J θ,
//! all elements of one ring break at c_b A R/√2. N = 1 with a bond in the plane is a parallel bond without spring and with
//! β = 0. The balls move by 1/4000 of the way in a step: that is the tolerance, unless another is stated.

use crate::block::*;
use crate::case::{Case, Family, Near};
use dem::measure::Mode;
use dem::space::Tuple;
use dem::*;
use math::elementary::atan;
use math::random::Stream;
use std::sync::LazyLock;

const RADII: [f64; 2] = [0.5, 0.4];
const LAMBDA: f64 = 0.9;
const KN: f64 = 1e9;
const KS: f64 = 5e8;
const SIGMA: f64 = 1e5;
const TAU: f64 = 1.5e5;
const SLOPE: f64 = 0.5;
const MU: f64 = 0.3;
const R: f64 = LAMBDA * 0.4;
const STEPS: f64 = 4000.0;
const NEAR: Near = Near::Relative(1e-3);
const TIGHT: Near = Near::Relative(1e-6);

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Radii 0.5 and 0.4 m, λ = 0.9, k_n 1e9 and k_s 5e8 Pa/m, σ_b 0.1 and c_b 0.15 MPa, tan φ_b 0.5, μ 0.3; N elements \
        (space: rings × sectors). Forces at a break are those of the last step before it.";
    Family { title: "One flat joint", about, cases: &CASES }
}

#[test]
fn flat_joints_have_their_closed_forms() {
    family().check();
}

/// The joint in `rings` × `sectors` elements; segments in the plane.
pub(crate) fn joint(rings: u32, sectors: u32) -> FlatJoint {
    FlatJoint {
        radius_multiplier: LAMBDA,
        division: Division { rings, sectors },
        stiffness: BondStiffness::PerArea { kn: KN, ks: KS },
        tensile_strength: SIGMA,
        cohesion: TAU,
        friction_angle: atan(SLOPE),
        shares: Shares::default(),
        scatter: Scatter::default(),
    }
}

fn slit(rings: u32, sectors: u32) -> FlatJoint {
    FlatJoint { shares: Shares { slit: 1.0, ..Shares::default() }, ..joint(rings, sectors) }
}

fn pair<S: Space>(bond: Bond) -> Engine<S> {
    let at = [along::<S>(0, 0.0), along::<S>(0, RADII[0] + RADII[1])];
    let balls = at.iter().zip(RADII).map(|(&x, r)| Particle::ball(x, r, 2000.0, GRAIN)).collect();
    let settings = Settings { damping: 0.0, fixed_step: Some(1.0), ..Settings::default() };
    let law = Interaction { linear: Linear::direct(1e-9, 1e-9, MU), bond };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    assert_eq!(engine.install_bonds(1e-12, 1).unwrap(), 1);
    engine.fix(&[0, 1], true, true).unwrap();
    engine
}

/// Pull (tension positive), shear, bending and twist of the one contact.
fn carried<S: Space>(engine: &Engine<S>) -> [f64; 4] {
    let contact = engine.contacts().next().unwrap();
    let pull = contact.force().dot(contact.normal);
    let shear = contact.force().minus(contact.normal.times(pull)).norm();
    let bend = (contact.moment.dot(contact.moment) - contact.twist * contact.twist).max(0.0).sqrt();
    [pull, shear, bend, contact.twist.abs()]
}

/// Moves the second ball by `way` and turns both against each other by `angle` about the contact, in `steps` steps.
fn moved<S: Space>(engine: &mut Engine<S>, way: Vector<S>, angle: f64, steps: u32) {
    let n = f64::from(steps);
    let share = RADII[1] / (RADII[0] + RADII[1]);
    engine.set_motion(0, Vector::<S>::zero(), about::<S>(-share * angle / n)).unwrap();
    engine.set_motion(1, way.times(1.0 / n), about::<S>((1.0 - share) * angle / n)).unwrap();
    engine.advance(u64::from(steps)).unwrap();
    // The forces of a step are those of the place where it begins.
    engine.set_motion(0, Vector::<S>::zero(), Spin::<S>::zero()).unwrap();
    engine.set_motion(1, Vector::<S>::zero(), Spin::<S>::zero()).unwrap();
    engine.advance(1).unwrap();
}

/// Moves on by 1/4000 of the way a step until something breaks: what was carried before, and the steps.
fn until_broken<S: Space>(engine: &mut Engine<S>, way: Vector<S>, angle: f64, twist: Spin<S>) -> ([f64; 4], f64) {
    let share = RADII[1] / (RADII[0] + RADII[1]);
    let (start, before) = (engine.steps(), engine.cracks().len());
    let turn = about::<S>(angle / STEPS);
    engine.set_motion(0, Vector::<S>::zero(), turn.times(-share)).unwrap();
    engine.set_motion(1, way.times(1.0 / STEPS), turn.times(1.0 - share).plus(twist.times(1.0 / STEPS))).unwrap();
    let mut last = [0.0; 4];
    for _ in 0..20_000 {
        engine.advance(1).unwrap();
        if let Some(crack) = engine.cracks().get(before) {
            return (last, (crack.step - start) as f64);
        }
        last = carried(engine);
    }
    panic!("no break");
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for n in [1, 2, 4, 8] {
        strengths::<D2>((1, n), &mut cases);
    }
    strengths::<D3>((1, 4), &mut cases);
    strengths::<D3>((2, 6), &mut cases);
    bent::<D2>(&[(1, 1), (1, 2), (1, 4), (1, 8)], &mut cases);
    bent::<D3>(&[(1, 3), (1, 4), (1, 6), (2, 4), (4, 8)], &mut cases);
    progressive(&mut cases);
    rocked(&mut cases);
    gapped::<D2>(&mut cases);
    gapped::<D3>(&mut cases);
    twisted(&mut cases);
    like_a_bond(&mut cases);
    cracked(&mut cases);
    cases
}

fn label<S: Space>((rings, sectors): (u32, u32), what: &str) -> String {
    if S::DIMENSION == 2 {
        format!("2D, N = {}: {what}", rings * sectors)
    } else {
        format!("3D, {rings} × {sectors}: {what}")
    }
}

/// Tension and shear.
fn strengths<S: Space>(division: (u32, u32), cases: &mut Vec<Case>) {
    let area = S::section(R);
    let count = f64::from(division.0 * division.1);
    let make = || pair::<S>(Bond::Flat(joint(division.0, division.1)));
    let none = Spin::<S>::zero();
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(label::<S>(division, what), source, expected, got, near));
    };
    let way = SIGMA / KN;
    let mut engine = make();
    let (last, steps) = until_broken(&mut engine, along::<S>(0, way), 0.0, none);
    push("tension, force, N", "σ_b A", SIGMA * area, last[0], NEAR);
    push("tension, opening, m", "σ_b/k_n", way, steps * way / STEPS, NEAR);
    assert!(engine.cracks().iter().all(|crack| crack.mode == Mode::Tension));
    push("cracks of that step", "N", count, engine.cracks().len() as f64, Near::Exact);
    push("bonds left", "0", 0.0, engine.bond_count() as f64, Near::Exact);
    let mut engine = make();
    let press = 0.4 * TAU;
    moved(&mut engine, along::<S>(0, -press / KN), 0.0, 10);
    let peak = TAU + SLOPE * press;
    let (last, _) = until_broken(&mut engine, along::<S>(1, peak / KS), 0.0, none);
    assert!(engine.cracks().iter().all(|crack| crack.mode == Mode::Shear));
    push("shear under pressure p, N", "(c_b + p tan φ_b) A", peak * area, last[1], NEAR);
    push("left after it, N", "μ P", -MU * carried(&engine)[0], carried(&engine)[1], TIGHT);
    engine.advance(500).unwrap();
    push("500 steps on, N", "μ P", -MU * carried(&engine)[0], carried(&engine)[1], TIGHT);
}

/// Bending of a bonded interface up to its first break.
fn bent<S: Space>(divisions: &[(u32, u32)], cases: &mut Vec<Case>) {
    let inertia = S::GYRATION * S::section(R) * R * R;
    for &division in divisions {
        let (rings, sectors) = division;
        let make = || pair::<S>(Bond::Flat(joint(rings, sectors)));
        let angle = 0.5 * SIGMA / (KN * R);
        let mut engine = make();
        moved(&mut engine, Vector::<S>::zero(), angle, 10);
        let name = label::<S>(division, "bending stiffness, N·m");
        cases.push(Case::new(name, "k_n I", KN * inertia, carried(&engine)[2] / angle, TIGHT));
        // The slope falls along t₁, which is y.
        let outer = if S::DIMENSION == 2 {
            1.0 - 1.0 / f64::from(sectors)
        } else {
            let ring = ((2.0 * f64::from(rings) - 1.0) / (2.0 * f64::from(rings))).sqrt();
            let cosine =
                |s: u32| math::elementary::cos(std::f64::consts::TAU * (f64::from(s) + 0.5) / f64::from(sectors));
            ring * (0..sectors).map(|s| -cosine(s)).fold(0.0, f64::max)
        };
        if outer > 0.0 {
            let angle = SIGMA / (KN * R * outer);
            let mut engine = make();
            let (last, steps) = until_broken(&mut engine, Vector::<S>::zero(), angle, Spin::<S>::zero());
            let name = label::<S>(division, "moment at the first break, N·m");
            cases.push(Case::new(name, "σ_b I/r", SIGMA * inertia / (R * outer), last[2], NEAR));
            let name = label::<S>(division, "its angle, rad");
            cases.push(Case::new(name, "σ_b/(k_n r)", angle, steps * angle / STEPS, NEAR));
        }
    }
}

/// Bending without opening beyond the first break, finer and finer.
fn progressive(cases: &mut Vec<Case>) {
    let angle = 1.5 * SIGMA / (KN * R);
    let x = SIGMA / (KN * angle);
    let limit = KN * angle * (R * R * R + x * x * x) / 3.0;
    for n in [2, 4, 8, 16, 32] {
        let strong = FlatJoint { cohesion: f64::INFINITY, ..joint(1, n) };
        let mut engine = pair::<D2>(Bond::Flat(strong));
        moved(&mut engine, [0.0; 2], angle, 4000);
        let name = label::<D2>((1, n), "moment at 1.5 times the angle of the rim, N·m");
        let near = Near::Relative(1.2 / f64::from(n));
        cases.push(Case::new(name, "N → ∞: k_n θ (R³ + x³)/3", limit, carried(&engine)[2], near));
    }
}

/// A slit that is pressed and rocked.
fn rocked(cases: &mut Vec<Case>) {
    let depth = 1e-4;
    let force = KN * 2.0 * R * depth;
    for n in [1, 2, 4, 8] {
        let mut push = |what: &str, source, expected, got| {
            cases.push(Case::new(label::<D2>((1, n), what), source, expected, got, TIGHT));
        };
        let mut engine = pair::<D2>(Bond::Flat(slit(1, n)));
        moved(&mut engine, along::<D2>(0, -depth), 0.0, 10);
        moved(&mut engine, [0.0; 2], depth / R, 10);
        let [pull, _, bend, _] = carried(&engine);
        push("slit, force while closed, N", "k_n A u", -force, pull);
        push("slit, moment when its rim opens, N·m", "P R/3", force * R / 3.0, bend);
        moved(&mut engine, [0.0; 2], depth / R, 10);
        // Twice that angle: closed from −R to R/2.
        let (theta, a) = (2.0 * depth / R, 0.5 * R);
        let [pull, _, bend, _] = carried(&engine);
        let moment = theta * (a * a * a + R * R * R) / 3.0 - 0.5 * depth * (a * a - R * R);
        let normal = 0.5 * theta * (a * a - R * R) - depth * (a + R);
        push("slit, twice the angle, force, N", "∫ k_n min(g, 0) dr", KN * normal, pull);
        push("slit, twice the angle, moment, N·m", "∫ r k_n min(g, 0) dr", KN * moment, bend);
        let energy = KN * (a + R) * (a + R) * (a + R) * theta * theta / 6.0;
        push("slit, twice the angle, energy, J", "∫ k_n min(g, 0)²/2 dr", energy, measure::energy(&engine).bond);
    }
    for division in [(1, 6), (2, 8), (4, 8)] {
        let mut engine = pair::<D3>(Bond::Flat(slit(division.0, division.1)));
        moved(&mut engine, along::<D3>(0, -depth), 0.0, 10);
        moved(&mut engine, [0.0; 3], depth / R, 10);
        let [pull, _, bend, _] = carried(&engine);
        let force = KN * D3::section(R) * depth;
        cases.push(Case::new(label::<D3>(division, "slit, force while closed, N"), "k_n A u", -force, pull, TIGHT));
        let name = label::<D3>(division, "slit, moment when its rim opens, N·m");
        cases.push(Case::new(name, "P R/4", force * R / 4.0, bend, TIGHT));
    }
}

fn gapped<S: Space>(cases: &mut Vec<Case>) {
    let gap = 1e-4;
    let shares = Shares { gapped: 1.0, slit: 0.0, gap };
    let mut engine = pair::<S>(Bond::Flat(FlatJoint { shares, ..joint(1, 4) }));
    let mut push = |what: &str, source, expected, got, near| {
        cases.push(Case::new(label::<S>((1, 4), what), source, expected, got, near));
    };
    moved(&mut engine, along::<S>(0, -0.999 * gap), 0.0, 10);
    push("gapped, before it closes, N", "0", 0.0, carried(&engine)[0], Near::Absolute(0.0));
    moved(&mut engine, along::<S>(0, -0.501 * gap), 0.0, 10);
    let source = "k_n A (u − g₀)";
    push("gapped, at 1.5 g₀, N", source, -KN * S::section(R) * 0.5 * gap, carried(&engine)[0], TIGHT);
}

fn twisted(cases: &mut Vec<Case>) {
    let area = D3::section(R);
    let polar = 2.0 * D3::GYRATION * area * R * R;
    for division in [(1, 3), (1, 6), (2, 6)] {
        let mut engine = pair::<D3>(Bond::Flat(joint(division.0, division.1)));
        let angle = 0.1 * TAU / (KS * R);
        engine.set_motion(1, [0.0; 3], [angle / 10.0, 0.0, 0.0]).unwrap();
        engine.advance(10).unwrap();
        let name = label::<D3>(division, "torsional stiffness, N·m");
        cases.push(Case::new(name, "k_s J", KS * polar, carried(&engine)[3] / angle, TIGHT));
    }
    let mut engine = pair::<D3>(Bond::Flat(joint(1, 6)));
    let angle = TAU * 2.0_f64.sqrt() / (KS * R);
    let (last, _) = until_broken(&mut engine, [0.0; 3], 0.0, [angle, 0.0, 0.0]);
    let name = label::<D3>((1, 6), "torque at the break, N·m");
    cases.push(Case::new(name, "c_b A R/√2", TAU * area * R / 2.0_f64.sqrt(), last[3], NEAR));
}

/// One element against a parallel bond without moment in its stress, on the same way.
fn like_a_bond(cases: &mut Vec<Case>) {
    let strong = FlatJoint { tensile_strength: f64::INFINITY, cohesion: f64::INFINITY, ..joint(1, 1) };
    let cement = ParallelBond {
        radius_multiplier: LAMBDA,
        stiffness: strong.stiffness,
        tensile_strength: f64::INFINITY,
        cohesion: f64::INFINITY,
        friction_angle: 0.0,
        moment_factor: 0.0,
        scatter: Scatter::default(),
    };
    let walked = |bond| {
        let (mut engine, mut stream) = (pair::<D2>(bond), Stream::new(4, "walk", 0));
        for _ in 0..40 {
            let way = [1e-6 * (1.0 + stream.normal()), 1e-6 * (1.0 + stream.normal())];
            moved(&mut engine, way, 1e-6 * (1.0 + stream.normal()), 5);
        }
        carried(&engine)
    };
    let (joint, bond) = (walked(Bond::Flat(strong)), walked(Bond::Parallel(cement)));
    for (k, what) in ["normal force", "shear force", "moment"].into_iter().enumerate() {
        let name = label::<D2>((1, 1), &format!("{what} of a random walk"));
        cases.push(Case::new(name, "parallel bond, β = 0", bond[k], joint[k], NEAR));
    }
}

/// Where the crack of the outer element is, and how large.
fn cracked(cases: &mut Vec<Case>) {
    let mut engine = pair::<D2>(Bond::Flat(joint(1, 4)));
    until_broken(&mut engine, [0.0; 2], SIGMA / (KN * R), Spin::<D2>::zero());
    let crack = &engine.cracks()[0];
    let mut push = |what, source, expected: f64, got| {
        let near = if expected == 0.0 { Near::Absolute(1e-12) } else { NEAR };
        cases.push(Case::new(what, source, expected, got, near));
    };
    // The second ball turns to the left against the first, so the interface opens below, at −y.
    push("2D, N = 4: place of the first crack, m", "−R (1 − 1/N)", -0.75 * R, crack.position[1]);
    push("2D, N = 4: its length, m", "2R/N", 0.5 * R, crack.size);
    push("2D, N = 4: middle of the interface, m", "0", 0.0, crack.contact[1]);
    push("2D, N = 4: its element", "0, the lowest", 0.0, f64::from(crack.element));
    push("2D, N = 4: elements", "4", 4.0, f64::from(crack.elements));
    let read = engine.contacts().next().unwrap().interface.unwrap();
    push("2D, N = 4: elements left", "3", 3.0, f64::from(read.intact));
    let mut engine = pair::<D3>(Bond::Flat(joint(1, 4)));
    until_broken(&mut engine, [0.0; 3], SIGMA / (KN * R), Spin::<D3>::zero());
    push("3D, 1 × 4: place of the first crack, m", "−R/2", -0.5 * R, engine.cracks()[0].position[1]);
    push("3D, 1 × 4: diameter of its disc, m", "R", R, engine.cracks()[0].size);
}

/// A free pair of an interface that opens, closes and rocks keeps its energy: forces and moments are the slopes of it.
#[test]
fn a_free_interface_keeps_its_energy() {
    keeps::<D2>(slit(1, 4));
    keeps::<D2>(joint(1, 2));
    keeps::<D3>(slit(2, 4));
    keeps::<D3>(joint(1, 6));
}

fn keeps<S: Space>(joint: FlatJoint) {
    // Without friction and unbreakable, so that nothing is spent.
    let strong = FlatJoint { tensile_strength: f64::INFINITY, cohesion: f64::INFINITY, ..joint };
    let at = [along::<S>(0, 0.0), along::<S>(0, RADII[0] + RADII[1])];
    let balls = at.iter().zip(RADII).map(|(&x, r)| Particle::ball(x, r, 2000.0, GRAIN)).collect();
    let settings = Settings { damping: 0.0, safety: 0.01, ..Settings::default() };
    let law = Interaction { linear: Linear::direct(1e6, 1e6, 0.0), bond: Bond::Flat(strong) };
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, settings)).unwrap();
    engine.install_bonds(1e-12, 1).unwrap();
    engine.set_motion(1, along::<S>(0, -0.02), about::<S>(0.05)).unwrap();
    engine.track_energy();
    let start = measure::energy(&engine).initial;
    let mut stored: f64 = 0.0;
    for _ in 0..60 {
        engine.advance(100).unwrap();
        let now = measure::energy(&engine);
        stored = stored.max(now.bond);
        let sum = now.kinetic + now.bond + now.slip;
        assert!((sum / start - 1.0).abs() < 0.01, "{} {sum} {start}", S::NAME);
        assert!(now.slip.abs() < 1e-6 * start, "{now:?}");
    }
    assert!(stored > 0.3 * start, "the interface never stored anything: {stored} of {start}");
}

/// A broken interface is remembered while the grains are near, and a contact that comes back from afar is a linear one.
#[test]
fn a_broken_interface_outlives_its_opening() {
    let mut engine = pair::<D2>(Bond::Flat(joint(1, 2)));
    moved(&mut engine, along::<D2>(0, 0.1), 0.0, 100);
    assert_eq!((engine.bond_count(), engine.cracks().len()), (0, 2));
    moved(&mut engine, along::<D2>(0, -0.1 - 1e-4), 0.0, 100);
    let [pull, ..] = carried(&engine);
    assert!((pull / (-KN * 2.0 * R * 1e-4) - 1.0).abs() < 1e-6, "{pull}");
    moved(&mut engine, along::<D2>(0, 0.9), 0.0, 1000);
    moved(&mut engine, along::<D2>(0, -0.9), 0.0, 1000);
    let contact = engine.contacts().next().unwrap();
    assert!(contact.interface.is_none() && contact.stiffness[0] > 0.0, "{contact:?}");
}

#[test]
fn shares_are_those_asked_for() {
    let shares = Shares { gapped: 0.3, slit: 0.2, gap: 1e-6 };
    let law =
        Interaction { linear: Linear::direct(1e6, 1e6, 0.0), bond: Bond::Flat(FlatJoint { shares, ..joint(1, 2) }) };
    let balls = (0..6400).map(|p| [f64::from(p % 80), f64::from(p / 80)]);
    let balls = balls.map(|x| Particle::ball(x, 0.5, 2000.0, GRAIN)).collect();
    let mut engine = Engine::new(&model::<D2>(balls, vec![], law, Settings::default())).unwrap();
    let all = engine.install_bonds(1e-6, 3).unwrap() as f64;
    let bonded = engine.bond_count() as f64;
    // Three standard errors of a share.
    assert!((bonded / all - 0.5).abs() < 3.0 * (0.25 / all).sqrt(), "{bonded} of {all}");
    engine.advance(1).unwrap();
    assert_eq!(engine.contacts().filter(|c| c.interface.is_some()).count() as f64, all);
}

#[test]
fn what_an_interface_cannot_have_is_refused() {
    let refused = |bond: FlatJoint| {
        let law = Interaction { linear: Linear::direct(1e6, 1e6, 0.0), bond: Bond::Flat(bond) };
        let ball = Particle::ball([0.0; 3], 0.5, 2000.0, GRAIN);
        Engine::<D3>::new(&model::<D3>(vec![ball], vec![], law, Settings::default())).unwrap_err().to_string()
    };
    let has = |text: &str, wanted: &str| assert!(text.contains(wanted), "{text}");
    has(&refused(joint(1, 2)), "sectors");
    has(&refused(joint(8, 8)), "elements");
    has(&refused(joint(0, 4)), "rings");
    has(
        &refused(FlatJoint { shares: Shares { gapped: 0.6, slit: 0.6, gap: 0.0 }, ..joint(1, 4) }),
        "gapped and slit share",
    );
    has(&refused(FlatJoint { tensile_strength: -1.0, ..joint(1, 4) }), "tensile strength");
}
