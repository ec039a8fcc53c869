//! What the calls that change a model refuse, that a refused call changes nothing, and what radii that grow bring along.

use crate::bits::digest;
use crate::block::*;
use dem::*;

/// A bonded block in motion: 6 × 6 balls of which some make up a clump, two platens.
fn moving() -> Engine<D2> {
    let mut engine = Engine::new(&block::<D2>(6, 6, 1.0)).unwrap();
    engine.install_bonds(1e-5, 7).unwrap();
    engine.absorb_overlaps();
    engine.advance(50).unwrap();
    engine
}

/// A pebble of the clump.
fn pebble(engine: &Engine<D2>) -> usize {
    engine.clump(0).pebbles[0]
}

type Call = fn(&mut Engine<D2>) -> Result<(), Faults>;

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn wall(point: [f64; 2], normal: [f64; 2], motion: Motion<D2>) -> Wall<D2> {
    Wall { point, normal, motion, group: PLATEN }
}

fn servo(pressure: f64, area: f64, relaxation: f64, speed_limit: f64) -> Motion<D2> {
    Motion::Servo(Servo { pressure, area, relaxation, speed_limit })
}

const CALLS: &[(Call, &str)] = &[
    (|e| e.set_motion(36, [0.0; 2], [0.0]), "particle 36 does not exist: there are 36, counted from 0"),
    (
        |e| e.set_motion(3, [NAN, INF], [0.0]),
        "particle 3: velocity is NaN m/s, wanted a finite number; particle 3: velocity is inf m/s, wanted a finite number",
    ),
    (|e| e.set_motion(3, [0.0; 2], [-INF]), "particle 3: spin is -inf rad/s, wanted a finite number"),
    (|e| e.set_motion(pebble(e), [0.0; 2], [NAN]), "spin is NaN rad/s, wanted a finite number"),
    (|e| e.apply(usize::MAX, [0.0; 2], [0.0]), "does not exist: there are 36, counted from 0"),
    (|e| e.apply(0, [0.0, INF], [0.0]), "particle 0: force is inf N, wanted a finite number"),
    (|e| e.apply(0, [0.0; 2], [NAN]), "particle 0: moment is NaN N*m, wanted a finite number"),
    (
        |e| e.fix(&[0, 40, 1, 36], true, true),
        "particle 40 does not exist: there are 36, counted from 0; particle 36 does not",
    ),
    (|e| e.fix(&[pebble(e)], true, false), "cannot be fixed: it moves with its clump"),
    (|e| e.scale_radii(&[(0, 1.1), (36, 1.1)]), "particle 36 does not exist"),
    (
        |e| e.scale_radii(&[(0, 1.1), (1, 0.0), (2, -1.0), (3, NAN)]),
        "particle 1: factor of its radius is 0, wanted a number above 0; particle 2: factor of its radius is -1, wanted a number above 0; particle 3: factor of its radius is NaN,",
    ),
    (|e| e.scale_radii(&[(0, INF)]), "particle 0: factor of its radius is inf, wanted a number above 0"),
    (|e| e.scale_radii(&[(0, 1e300)]), "particle 0: mass is inf kg, wanted a number above 0"),
    (|e| e.scale_radii(&[(0, 1e-200), (0, 1e-200)]), "particle 0: radius is 0 m, wanted a number above 0"),
    (|e| e.scale_radii(&[(pebble(e), 1.1)]), "cannot be scaled: the mass of its clump would not follow"),
    (|e| e.install_bonds(NAN, 1).map(drop), "installation gap is NaN m, wanted a number up to the largest radius"),
    (|e| e.install_bonds(INF, 1).map(drop), "installation gap is inf m,"),
    (|e| e.install_bonds(-INF, 1).map(drop), "installation gap is -inf m,"),
    (|e| e.install_bonds(0.5, 1).map(drop), "installation gap is 500 mm, wanted a number up to the largest radius"),
    (|e| e.move_wall(2, Motion::Velocity([0.0; 2])), "wall 2 does not exist: there are 2, counted from 0"),
    (|e| e.move_wall(1, Motion::Velocity([NAN, 0.0])), "wall 1: velocity is NaN m/s, wanted a finite number"),
    (
        |e| e.move_wall(1, servo(INF, 0.0, 2.0, -1.0)),
        "wall 1: servo pressure is inf Pa, wanted a finite number; wall 1: servo area is 0 m^2, wanted a number above 0; wall 1: servo relaxation is 2, wanted in (0, 1]; wall 1: servo speed limit is -1 m/s, wanted a number above 0",
    ),
    (|e| e.remove_wall(2), "wall 2 does not exist: there are 2, counted from 0"),
    (
        |e| e.add_wall(&wall([NAN, 0.0], [0.0, 0.0], Motion::Velocity([0.0; 2]))).map(drop),
        "wall 2: point is NaN m, wanted a finite number; wall 2: length of the normal is 0, wanted a number above 0",
    ),
    (
        |e| e.add_wall(&wall([0.0, 1e-3], [0.0, 1.0], Motion::Velocity([0.0; 2]))).map(drop),
        "particle 0 starts with an overlap of ",
    ),
    (
        |e| {
            e.add_wall(&Wall { group: Group(9), ..wall([-1.0, 0.0], [1.0, 0.0], Motion::Velocity([0.0; 2])) }).map(drop)
        },
        "groups 0 and 9 can meet and the contact table has no entry for them",
    ),
    (|e| e.set_damping(1.0), "damping is 1, wanted in [0, 1)"),
    (|e| e.set_damping(-0.1), "damping is -0.1, wanted in [0, 1)"),
    (|e| e.set_damping(NAN), "damping is NaN, wanted in [0, 1)"),
    (|e| e.set_contacts(&ContactTable::new()), "groups 0 and 0 can meet and the contact table has no entry for them"),
    (|e| e.strain_cell([[0.0; 3]; 3]), "periodic cell is 0, wanted one"),
];

#[test]
fn a_refused_change_says_why_and_changes_nothing() {
    let state =
        |engine: &Engine<D2>| (digest(engine), engine.time_step(), engine.bond_count(), engine.settings().damping);
    let mut expected = moving();
    let before = state(&expected);
    expected.advance(60).unwrap();
    let mut wrong = String::new();
    for (call, message) in CALLS {
        let mut engine = moving();
        let text = call(&mut engine).unwrap_err().to_string();
        if !text.contains(message) {
            wrong += &format!("\n{message}: {text}");
        }
        assert_eq!(state(&engine), before, "{message}");
        engine.advance(60).unwrap();
        assert_eq!(state(&engine), state(&expected), "{message}");
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn a_wall_that_was_taken_away_is_gone() {
    let mut engine = moving();
    engine.remove_wall(0).unwrap();
    for refused in [engine.clone().remove_wall(0), engine.clone().move_wall(0, Motion::Velocity([0.0; 2]))] {
        assert_eq!(refused, Err(Faults(vec![Fault::Removed { wall: 0 }])));
    }
    engine.remove_wall(1).unwrap();
    engine.advance(10).unwrap();
}

#[test]
fn a_cell_refuses_radii_that_would_meet_twice() {
    let balls = vec![Particle::ball([0.5, 0.5], 0.2, 2000.0, GRAIN), Particle::ball([1.0, 0.9], 0.2, 2000.0, GRAIN)];
    let cell = Cell { low: [0.0; 2], edges: [1.5; 2], rate: [[0.0; 3]; 3] };
    let law = Interaction::unbonded(Linear::direct(1e6, 5e5, 0.5));
    let settings = Settings { cell: Some(cell), ..Settings::default() };
    let mut engine = Engine::new(&model::<D2>(balls, vec![], law, settings)).unwrap();
    let text = engine.scale_radii(&[(1, 1.3)]).unwrap_err().to_string();
    assert!(text.contains("edge of the cell is 1.5 m, wanted at least six times the largest radius"), "{text}");
    assert_eq!(engine.radius(1), 0.2);
    let text = engine.strain_cell([[NAN; 3]; 3]).unwrap_err().to_string();
    assert!(text.contains("rate of the cell is NaN"), "{text}");
    engine.scale_radii(&[(1, 1.2)]).unwrap();
}

/// Two balls that touch, the second times f: mass f^d, inertia f^(d+2), k_n = E* A(min R)/(R₁ + R₂), and the time step
/// of that mass and stiffness. The other ball stays as it is.
fn grown<S: Space>() {
    use dem::space::Tuple;
    let (modulus, factor, r) = (1e9, 1.25_f64, 0.5);
    let balls = vec![
        Particle::<S>::ball(along::<S>(0, 0.0), r, 2000.0, GRAIN),
        Particle::<S>::ball(along::<S>(0, 1.0), r, 2000.0, GRAIN),
    ];
    let before = balls[1].clone();
    let law = Interaction::unbonded(Linear::modulus(modulus, 2.0, 0.0));
    let mut engine = Engine::new(&model::<S>(balls, vec![], law, Settings::default())).unwrap();
    engine.scale_radii(&[(1, factor)]).unwrap();
    let (after, other) = (engine.particle(1), engine.particle(0));
    let near = |got: f64, expected: f64| assert!((got / expected - 1.0).abs() < 1e-14, "{got} {expected}");
    near(after.radius, factor * r);
    near(after.mass, before.mass * factor.powi(S::DIMENSION as i32));
    near(after.inertia, before.inertia * factor.powi(S::DIMENSION as i32 + 2));
    assert_eq!((other.radius, other.mass, other.inertia), (r, before.mass, before.inertia));
    assert_eq!(engine.moving_mass(1), [after.mass, after.inertia]);
    let contact = engine.contacts().next().unwrap();
    near(contact.stiffness[0], modulus * S::section(r) / (r + after.radius));
    near(contact.force().norm(), contact.stiffness[0] * (r + after.radius - 1.0));
}

#[test]
fn radii_that_grow_take_mass_and_stiffness_along() {
    grown::<D2>();
    grown::<D3>();
}

/// Equal-step masses keep their total and stay in proportion to the new stiffnesses.
#[test]
fn radii_that_grow_keep_masses_of_one_step() {
    let mut model = block::<D2>(6, 6, 0.0);
    model.settings.masses = Masses::EqualStep;
    let mut engine = Engine::new(&model).unwrap();
    engine.scale_radii(&[(0, 1.05), (1, 0.97)]).unwrap();
    let singles: Vec<usize> = (0..36).filter(|&p| engine.clump_of(p).is_none()).collect();
    let total = |mass: &dyn Fn(usize) -> f64| singles.iter().map(|&p| mass(p)).sum::<f64>();
    let (moving, own) = (total(&|p| engine.moving_mass(p)[0]), total(&|p| engine.mass(p)));
    assert!((moving / own - 1.0).abs() < 1e-12, "{moving} {own}");
    assert!(singles.iter().any(|&p| (engine.moving_mass(p)[0] / engine.mass(p) - 1.0).abs() > 0.1));
}

/// Endless steps are made until something ends them: they do not overflow the count.
#[test]
fn a_run_of_endless_steps_ends_where_the_watcher_says() {
    let mut engine = moving();
    let ended = engine.run(u64::MAX, 0, |e| if e.steps() >= 60 { Watch::Stop } else { Watch::Continue }).unwrap();
    assert_eq!((ended, engine.steps()), (Ended::Stopped, 60));
    let mut model = block::<D2>(6, 6, 1.0);
    model.settings.bounds = Some([[-1.0, -1.0], [1.0, 1.0]]);
    model.settings.fixed_step = Some(1e-4);
    let mut engine = Engine::new(&model).unwrap();
    engine.advance(1).unwrap_or(());
    assert!(engine.advance(u64::MAX).is_err());
}
