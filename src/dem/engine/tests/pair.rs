//! Two balls: rebound, and bonds that break at their closed-form strength.

use super::*;

fn pair(bond: Bond, linear: Linear) -> Engine<D2> {
    let particles =
        vec![Particle::ball([0.0, 0.0], 0.5, 2000.0, GRAIN), Particle::ball([1.0, 0.0], 0.5, 2000.0, GRAIN)];
    let contacts = ContactTable::new().with(GRAIN, GRAIN, Interaction { linear, bond });
    let settings = Settings { damping: 0.0, safety: 0.02, ..Settings::default() };
    let model = Model { particles, clumps: vec![], walls: vec![], contacts, settings };
    Engine::new(&model).unwrap()
}

fn parallel() -> ParallelBond {
    ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::PerArea { kn: 1e9, ks: 5e8 },
        tensile_strength: 1e6,
        cohesion: 2e6,
        friction_angle: 0.0,
        moment_factor: 1.0,
        deviation: 0.0,
    }
}

/// Pulls the second ball of a bonded pair at constant motion until the bond breaks; the strain measure at the break.
fn pull(velocity: [f64; 2], spin: f64) -> (f64, measure::Mode) {
    let mut engine = pair(Bond::Parallel(parallel()), Linear::direct(1.0, 1.0, 0.0));
    assert_eq!(engine.install_bonds(0.0, 1), 1);
    for p in 0..2 {
        engine.fix(p, true, true);
    }
    engine.set_motion(1, velocity, [spin]);
    for _ in 0..100_000 {
        engine.advance(1).unwrap();
        if let Some(crack) = engine.cracks().first() {
            return (crack.time, crack.mode);
        }
    }
    panic!("no break");
}

#[test]
fn a_bond_breaks_at_its_closed_form_strength() {
    // A = 1, R̄ = 0.5: tension at u = σ_c/k̄_n, shear at τ_c/k̄_s, bending at θ = σ_c/(β k̄_n R̄).
    let rate = 1e-2;
    for (velocity, spin, expected, mode) in [
        ([rate, 0.0], 0.0, 1e-3, measure::Mode::Tension),
        ([0.0, rate], 0.0, 4e-3, measure::Mode::Shear),
        ([0.0, 0.0], rate, 2e-3, measure::Mode::Tension),
    ] {
        let (time, found) = pull(velocity, spin);
        let reached = time * rate;
        assert_eq!(found, mode);
        assert!((reached / expected - 1.0).abs() < 0.01, "{velocity:?} {spin}: {reached} against {expected}");
    }
}

#[test]
fn a_rebound_keeps_its_speed() {
    let mut engine = pair(Bond::None, Linear::direct(1e6, 1e6, 0.0));
    engine.set_motion(0, [0.01, 0.0], [0.0]);
    engine.set_motion(1, [-0.01, 0.0], [0.0]);
    engine.advance(2000).unwrap();
    assert!((engine.velocity(0)[0] + 0.01).abs() < 1e-5, "{:?}", engine.velocity(0));
    assert!((engine.velocity(1)[0] - 0.01).abs() < 1e-5);
}
