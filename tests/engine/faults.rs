//! Bad input is refused by name, and runs that fail say why.

use crate::block::*;
use flow::dem::*;

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
        "clump 0: mass is inf, wanted a number above 0",
        "particle 3: radius is -1, wanted a number above 0",
        "particle 5: mass is 0, wanted a number above 0",
        "particle 7: position is NaN, wanted a finite number",
        "wall 1: length of the normal is 0, wanted a number above 0",
        "safety factor of the time step is 2, wanted in (0, 1]",
        "time step is 0, wanted a number above 0",
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
            "contact of groups 0 and 0: bond modulus is -1, wanted a number above 0",
            "contact of groups 0 and 0: tensile strength is 0, wanted a number above 0",
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

#[test]
fn runs_that_fail_say_why() {
    let mut model = block::<D2>(6, 6, 1.0);
    model.settings.bounds = Some([[-0.1, -0.1], [0.1, 0.1]]);
    let mut engine = Engine::new(&model).unwrap();
    engine.set_motion(0, [-100.0, 0.0], [0.0]);
    let failure = engine.advance(100_000).unwrap_err();
    assert!(matches!(failure, Failure::Escape { particle: 0, .. }), "{failure}");
    let mut model = block::<D2>(6, 6, 1.0);
    model.settings.fixed_step = Some(1e-4);
    let mut engine = Engine::new(&model).unwrap();
    let failure = engine.advance(100_000).unwrap_err();
    assert!(matches!(failure, Failure::Instability { .. } | Failure::NotFinite { .. }), "{failure}");
}
