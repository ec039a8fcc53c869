//! Bad input is refused by name, and runs that fail say why.

use crate::block::*;
use dem::*;

/// Faults of a small block after a change.
fn faults(change: impl FnOnce(&mut Model<D2>)) -> Vec<Fault> {
    let mut model = block::<D2>(6, 6, 1.0);
    change(&mut model);
    match Engine::new(&model) {
        Ok(_) => Vec::new(),
        Err(Faults(faults)) => faults,
    }
}

#[test]
fn every_fault_is_named() {
    assert_eq!(faults(|_| ()), []);
    let found = faults(|m| {
        m.particles[3].radius = -1.0;
        m.particles[5].mass = 0.0;
        m.particles[7].position[1] = f64::NAN;
        m.clumps[0].mass = f64::INFINITY;
        m.walls[1].normal = [0.0, 0.0];
        m.settings.safety = 2.0;
        m.settings.fixed_step = Some(0.0);
    });
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    let expected = [
        "clump 0: mass is inf kg, wanted a number above 0",
        "particle 3: radius is -1 m, wanted a number above 0",
        "particle 5: mass is 0 kg, wanted a number above 0",
        "particle 7: position is NaN m, wanted a finite number",
        "wall 1: length of the normal is 0, wanted a number above 0",
        "safety factor of the time step is 2, wanted in (0, 1]",
        "time step is 0 s, wanted a number above 0",
    ];
    assert_eq!(text, expected);
}

#[test]
fn bad_laws_and_missing_ones_are_named() {
    let mut law = bonded();
    if let Bond::Parallel(bond) = &mut law.bond {
        bond.tensile_strength = 0.0;
        bond.stiffness = BondStiffness::Modulus { modulus: -1.0, ratio: 2.5 };
    }
    let found = faults(|m| m.contacts.set(GRAIN, GRAIN, law));
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(
        text,
        [
            "contact of groups 0 and 0: bond modulus is -1 Pa, wanted a number above 0",
            "contact of groups 0 and 0: tensile strength is 0 Pa, wanted a number above 0",
        ]
    );
    let found = faults(|m| m.contacts = ContactTable::new().with(GRAIN, GRAIN, bonded()));
    // The stones of the one clump cannot meet each other; all else can.
    let pairs = [(GRAIN, STONE), (GRAIN, PLATEN), (STONE, PLATEN)];
    assert_eq!(found, pairs.map(|(a, b)| Fault::NoInteraction { a, b }));
}

#[test]
fn overlapping_starts_and_double_pebbles_are_named() {
    let found = faults(|m| m.particles[1].position = m.particles[0].position);
    assert!(matches!(found[..], [Fault::Overlap { a: 0, b: 1, .. }]), "{found:?}");
    let found = faults(|m| m.clumps[0].pebbles.push(10_000));
    assert!(matches!(found[0], Fault::Pebble { clump: 0, pebble: 10_000, .. }), "{found:?}");
}

/// Each bad number alone: what the fault says of it.
#[test]
fn each_bad_number_is_named_alone() {
    type Change = fn(&mut Model<D2>);
    let cases: &[(Change, &str)] = &[
        (|m| m.particles[2].radius = 0.0, "particle 2: radius is 0 m,"),
        (|m| m.particles[2].radius = f64::NAN, "particle 2: radius is NaN m,"),
        (|m| m.particles[2].mass = -1.0, "particle 2: mass is -1 kg,"),
        (|m| m.particles[2].inertia = 0.0, "particle 2: inertia is 0 kg*m^2,"),
        (|m| m.particles[2].velocity[0] = f64::INFINITY, "particle 2: velocity is inf m/s,"),
        (|m| m.particles[2].spin[0] = f64::NAN, "particle 2: spin is NaN rad/s,"),
        (|m| m.clumps[0].inertia = [[0.0; 3]; 3], "clump 0: inertia is 0 kg*m^2,"),
        (|m| m.clumps[0].pebbles.clear(), "clump 0: number of pebbles is 0,"),
        (|m| m.clumps[0].centre[0] = f64::NAN, "clump 0: position, velocity or spin is NaN,"),
        (|m| m.walls[0].point[1] = f64::NAN, "wall 0: point is NaN m,"),
        (|m| m.walls[0].motion = Motion::Velocity([f64::NAN, 0.0]), "wall 0: velocity is NaN m/s,"),
        (|m| m.settings.damping = 1.0, "damping is 1,"),
        (|m| m.settings.damping = f64::NAN, "damping is NaN,"),
        (|m| m.settings.gravity[1] = f64::NAN, "gravity is NaN m/s^2,"),
        (|m| m.settings.safety = 0.0, "safety factor of the time step is 0,"),
        (|m| m.settings.fixed_step = Some(-1e-6), "time step is -1 µs,"),
        (|m| m.settings.bounds = Some([[0.0, f64::NAN], [1.0, 1.0]]), "lower bound is NaN m,"),
        (|m| m.settings.bounds = Some([[0.0, 2.0], [1.0, 1.0]]), "lower bound is 2 m, wanted a number below the upper"),
        (|m| m.settings.bounds = Some([[0.0, 0.0], [1.0, f64::NAN]]), "upper bound is NaN m,"),
        (|m| m.settings.overlap_limit = f64::NAN, "overlap limit is NaN,"),
        (|m| m.walls[0].point[1] += 1e-3, "particle 0 starts with an overlap of 2.0"),
        (
            |m| {
                m.walls[1].motion =
                    Motion::Servo(Servo { pressure: 1.0, area: -1.0, relaxation: 0.5, speed_limit: 1.0 })
            },
            "wall 1: servo area is -1 m^2,",
        ),
        (|m| m.particles.clear(), "clump 0: pebble"),
        (|m| m.contacts.set(GRAIN, GRAIN, with(Linear::direct(0.0, 1.0, 0.5))), "groups 0 and 0: kn is 0 N/m,"),
        (|m| m.contacts.set(GRAIN, GRAIN, with(Linear::direct(1.0, -1.0, 0.5))), "groups 0 and 0: ks is -1 N/m,"),
        (|m| m.contacts.set(GRAIN, GRAIN, with(Linear::modulus(-1.0, 1.0, 0.5))), "groups 0 and 0: modulus is -1 Pa,"),
        (|m| m.contacts.set(GRAIN, GRAIN, with(Linear::modulus(1.0, 0.0, 0.5))), "groups 0 and 0: kn/ks is 0,"),
        (|m| m.contacts.set(GRAIN, GRAIN, with(Linear::modulus(1.0, 1.0, -0.5))), "groups 0 and 0: friction is -0.5,"),
        (|m| m.contacts.set(GRAIN, STONE, point(-1.0, 1.0)), "groups 0 and 1: tensile strength is -1 Pa,"),
        (|m| m.contacts.set(GRAIN, STONE, point(1.0, f64::NAN)), "groups 0 and 1: shear strength is NaN Pa,"),
        (|m| m.contacts = ContactTable::new().with(GRAIN, GRAIN, bonded()), "groups 0 and 2 can meet"),
        (|m| m.settings.cell = Some(cell(0.1, 0.0)), "number of walls in a periodic cell is 2,"),
        (|m| m.settings.cell = Some(cell(1e-3, 0.0)), "edge of the cell is 1 mm,"),
        (|m| m.settings.cell = Some(cell(0.1, f64::NAN)), "rate of the cell is NaN 1/s,"),
    ];
    let mut wrong = String::new();
    for (change, expected) in cases {
        let found: Vec<String> = faults(change).iter().map(ToString::to_string).collect();
        if !found.iter().any(|fault| fault.contains(expected)) {
            wrong += &format!("\n{expected} {found:?}");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

fn with(linear: Linear) -> Interaction {
    Interaction { linear, ..bonded() }
}

fn point(tensile_strength: f64, shear_strength: f64) -> Interaction {
    let bond =
        ContactBond { tensile_strength, shear_strength, scatter: Scatter::default(), shear_break: ShearBreak::Keep };
    Interaction { bond: Bond::Contact(bond), ..bonded() }
}

fn cell(edge: f64, rate: f64) -> Cell<D2> {
    Cell { low: [-0.05; 2], edges: [edge; 2], rate: [[rate, 0.0, 0.0], [0.0; 3], [0.0; 3]] }
}

#[test]
fn an_overlap_across_the_faces_of_a_cell_is_named() {
    let found = faults(|m| {
        m.walls.clear();
        m.clumps.clear();
        m.particles.truncate(2);
        m.particles[0].position = [1e-4, 5e-3];
        m.particles[1].position = [9.9e-3, 5e-3];
        m.settings.cell = Some(Cell { low: [0.0; 2], edges: [1e-2; 2], rate: [[0.0; 3]; 3] });
    });
    assert!(matches!(found[..], [Fault::Overlap { a: 0, b: 1, .. }]), "{found:?}");
}

#[test]
fn a_ball_may_cover_a_small_pebble_and_not_another_ball() {
    let ball = |x: f64, radius: f64| Particle::<D2>::ball([x, 0.0], radius, 2000.0, GRAIN);
    let mut model = model::<D2>(vec![ball(0.0, 1.0), ball(1.0, 0.1)], vec![], bonded(), Settings::default());
    assert!(matches!(Engine::new(&model).unwrap_err().0[..], [Fault::Overlap { a: 0, b: 1, .. }]));
    let clump = Clump {
        pebbles: vec![1],
        centre: [1.0, 0.0],
        velocity: [0.0; 2],
        spin: [0.0],
        mass: 1.0,
        inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    model.clumps.push(clump);
    Engine::new(&model).unwrap();
    model.particles[1].position = [0.5, 0.0];
    model.particles[1].radius = 0.3;
    assert!(matches!(Engine::new(&model).unwrap_err().0[..], [Fault::Overlap { a: 0, b: 1, .. }]));
}

#[test]
fn a_cell_is_strained_only_where_there_is_one() {
    let mut engine = Engine::new(&block::<D2>(6, 6, 1.0)).unwrap();
    assert!(engine.strain_cell([[0.0; 3]; 3]).is_err());
    assert!(engine.cell_volume().is_none() && measure::cell_stress(&engine).is_none());
}

#[test]
fn runs_that_fail_say_why() {
    let mut model = block::<D2>(6, 6, 1.0);
    model.settings.bounds = Some([[-0.1, -0.1], [0.1, 0.1]]);
    let mut engine = Engine::new(&model).unwrap();
    engine.set_motion(0, [-100.0, 0.0], [0.0]).unwrap();
    let failure = engine.advance(100_000).unwrap_err();
    assert!(matches!(failure, Failure::Escape { particle: 0, .. }), "{failure}");
    let mut model = block::<D2>(6, 6, 1.0);
    model.settings.fixed_step = Some(1e-4);
    let mut engine = Engine::new(&model).unwrap();
    let failure = engine.advance(100_000).unwrap_err();
    assert!(matches!(failure, Failure::Instability { .. } | Failure::NotFinite { .. }), "{failure}");
}
