//! Time of a bonded contact and step in a whole uniaxial test: walls, contact search, measurement and cracks included.
//!
//! `cargo bench --bench engine -- [2d|3d] [PARTICLES] [energy] [full] [joints]`: makes a dense random packing with the engine itself, bonds
//! it, and compresses it between two platens. Every figure is the best and the median of several stretches of the test,
//! because other work on the machine only ever adds time. `full` runs one test past its peak instead; `energy` tracks the
//! energy balance, as the stages do. `joints` times the same specimen with flat joints (two elements in the plane, six in
//! space) beside the parallel bonds. `once` times one thread at the widest width only; `write=FILE` writes the packing, and
//! `tests/bench/peers.py` gives it to other codes.
//!
//! Specimens of all sizes go through the same strains: the platens' speed follows the height, and no stretch has more steps
//! than that of the usual size. Otherwise a small one would be past its peak, with more contacts than bonds.

use dem::simd::Width;
use dem::space::Tuple;
use dem::*;
use math::elementary::pow;
use math::random::Stream;
use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;

const MORTAR: Group = Group(0);
const PLATEN: Group = Group(1);

/// The usual sizes.
const PLANE: usize = 22_000;
const SOLID: usize = 70_000;

/// Which bonds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    Parallel,
    Flat,
}

/// Linear contacts, bonds between balls, smooth platens.
fn table<S: Space>(friction: f64, law: Law) -> ContactTable {
    let linear = Linear::modulus(20e9, 2.5, friction);
    let bond = ParallelBond {
        radius_multiplier: 1.0,
        stiffness: BondStiffness::Modulus { modulus: 20e9, ratio: 2.5 },
        tensile_strength: 20e6,
        cohesion: 20e6,
        friction_angle: 0.0,
        moment_factor: 1.0,
        scatter: Scatter::default(),
    };
    let sectors = if S::DIMENSION == 2 { 2 } else { 6 };
    let joint = FlatJoint { division: Division { rings: 1, sectors }, ..FlatJoint::new(20e9, 2.5, 20e6, 20e6) };
    let bond = match law {
        Law::Parallel => Bond::Parallel(bond),
        Law::Flat => Bond::Flat(joint),
    };
    let platen = Interaction::unbonded(Linear::modulus(20e9, 2.5, 0.0));
    ContactTable::new().with(MORTAR, MORTAR, Interaction { linear, bond }).with(MORTAR, PLATEN, platen)
}

/// A box twice as high as wide, filled with balls of mean radius 0.5 mm (largest over smallest 2.5 or 1.66).
fn cloud<S: Space>(count: usize, porosity: f64, spread: f64) -> (Model<S>, Vector<S>) {
    let mut stream = Stream::new(1, "cloud", 0);
    let radii: Vec<f64> =
        (0..count).map(|_| 0.5e-3 * stream.uniform_in(2.0 / (1.0 + spread), 2.0 * spread / (1.0 + spread))).collect();
    let solid: f64 = radii.iter().map(|&r| S::volume(r)).sum();
    let edge = pow(solid / (1.0 - porosity) / 2.0, 1.0 / S::DIMENSION as f64);
    let size = Vector::<S>::build(|k| if k == 1 { 2.0 * edge } else { edge });
    let per = pow(count as f64 / 2.0, 1.0 / S::DIMENSION as f64).ceil();
    let cells: Vec<usize> = (0..S::DIMENSION).map(|k| if k == 1 { 2 * per as usize } else { per as usize }).collect();
    let total: usize = cells.iter().product();
    let mut homes: Vec<usize> = (0..total).collect();
    stream.shuffle(&mut homes);
    let particles = radii.iter().zip(homes).map(|(&r, home)| {
        let mut rest = home;
        let x = Vector::<S>::build(|k| {
            let cell = (rest % cells[k]) as f64 + 0.5 + stream.uniform_in(-0.3, 0.3);
            rest /= cells[k];
            cell * size.at(k) / cells[k] as f64
        });
        Particle::ball(x, r, 2000.0, MORTAR)
    });
    let particles = particles.collect();
    let mut walls = Vec::new();
    for k in 0..S::DIMENSION {
        let axis = |v: f64| Vector::<S>::build(|a| if a == k { v } else { 0.0 });
        let still = Motion::Velocity(axis(0.0));
        walls.push(Wall { point: axis(0.0), normal: axis(1.0), motion: still, group: PLATEN });
        walls.push(Wall { point: axis(size.at(k)), normal: axis(-1.0), motion: still, group: PLATEN });
    }
    let settings = Settings { overlap_limit: f64::INFINITY, ..Settings::default() };
    (Model { particles, clumps: vec![], walls, contacts: table::<S>(0.0, Law::Parallel), settings }, size)
}

/// A bonded specimen between two platens that close at `speed` each.
fn specimen<S: Space>(count: usize, speed: f64, law: Law) -> (Engine<S>, Vector<S>) {
    let (porosity, spread) = if S::DIMENSION == 2 { (0.12, 2.5) } else { (0.36, 1.66) };
    let (model, size) = cloud::<S>(count, porosity, spread);
    let mut engine = Engine::new(&model).expect("a sound model");
    drop(model);
    for _ in 0..60 {
        engine.advance(5).expect("calm");
        engine.calm();
    }
    let mut ratio = f64::INFINITY;
    for _ in 0..60 {
        engine.advance(100).expect("settling");
        ratio = measure::unbalanced_ratio(&engine);
        if ratio < 1e-3 {
            break;
        }
    }
    engine.calm();
    engine.set_contacts(&table::<S>(0.5, law)).expect("a sound table");
    engine.absorb_overlaps();
    engine.install_bonds(1e-9, 1).expect("a small gap");
    for k in (0..S::DIMENSION).filter(|&k| k != 1) {
        engine.remove_wall(2 * k).expect("a wall");
        engine.remove_wall(2 * k + 1).expect("a wall");
    }
    for (wall, up) in [(2, 1.0), (3, -1.0)] {
        let closing = Vector::<S>::build(|k| if k == 1 { up * speed } else { 0.0 });
        engine.move_wall(wall, Motion::Velocity(closing)).expect("a finite speed");
    }
    let around = measure::coordination(&engine);
    println!(
        "{} {law:?} {count} balls, {} bonds, {:.2} contacts a ball, unbalanced {ratio:.1e}, step {:.2e} s, {} listed",
        S::NAME,
        engine.bond_count(),
        around.contacts,
        engine.time_step(),
        engine.contacts().count(),
    );
    (engine, size)
}

/// Time of the wall, or of this thread alone: other work on the machine does not count then.
struct Clock {
    wall: Instant,
    own: f64,
}

impl Clock {
    fn now() -> Self {
        Self { wall: Instant::now(), own: Self::own() }
    }

    /// Seconds that this thread ran.
    fn own() -> f64 {
        let time = clock_gettime(ClockId::ThreadCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }

    fn elapsed(&self, alone: bool) -> f64 {
        if alone { Self::own() - self.own } else { self.wall.elapsed().as_secs_f64() }
    }
}

/// Best and median nanoseconds per bond and step over stretches of the test.
fn rate<S: Space>(engine: &mut Engine<S>, stretches: usize, steps: u64) -> [f64; 2] {
    let bonds = engine.bond_count() as f64;
    let mut sum = 0.0;
    let mut times: Vec<f64> = (0..stretches)
        .map(|_| {
            let start = Clock::now();
            let watch = |e: &Engine<S>| {
                sum += e.wall_force(2).at(1) - e.wall_force(3).at(1) + e.position(0).at(0);
                Watch::Continue
            };
            engine.run(steps, 50, watch).expect("a stable run");
            start.elapsed(engine.threads() == 1) * 1e9 / steps as f64 / bonds
        })
        .collect();
    std::hint::black_box(sum);
    times.sort_by(f64::total_cmp);
    [times[0], times[times.len() / 2]]
}

/// Largest memory of the process so far, bytes.
fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|l| l.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

/// What is timed, and how.
#[derive(Clone, Copy)]
struct Order<'a> {
    count: usize,
    energy: bool,
    once: bool,
    file: Option<&'a str>,
}

/// Writes a packing: a line `# dimension number edges`, then centre and radius of each ball, in metres.
fn write<S: Space>(engine: &Engine<S>, size: Vector<S>, path: &str) {
    let line = |v: Vector<S>| {
        (0..3).map(|k| if k < S::DIMENSION { v.at(k) } else { 0.0 }.to_string()).collect::<Vec<_>>().join(" ")
    };
    let mut text = format!("# {} {} {}\n", S::DIMENSION, engine.particle_count(), line(size));
    for k in 0..engine.particle_count() {
        text += &format!("{} {}\n", line(engine.position(k)), engine.radius(k));
    }
    std::fs::write(path, text).expect("a file that can be written");
}

fn rates<S: Space>(order: Order, usual: usize, law: Law) {
    let speed = 0.02 * pow(order.count as f64 / usual as f64, 1.0 / S::DIMENSION as f64);
    let (mut engine, size) = specimen::<S>(order.count, speed, law);
    if let Some(path) = order.file {
        write(&engine, size, path);
    }
    if order.energy {
        engine.track_energy();
    }
    let steps = (20_000_000 / engine.bond_count().max(1)).clamp(50, 400) as u64;
    let (all_threads, widths) = ([1, 2], [Width::One, Width::Four, Width::Eight]);
    let widest = [Width::detect()];
    let (all_threads, widths) =
        if order.once { (&all_threads[..1], &widest[..]) } else { (&all_threads[..], &widths[..]) };
    for &threads in all_threads {
        engine.set_threads(threads);
        for &width in widths.iter().filter(|w| w.available()) {
            engine.set_width(width);
            let [best, median] = rate(&mut engine, 9, steps);
            let listed = engine.contacts().count();
            println!(
                "{threads} thread(s), {width:?}, {listed} listed: best {best:.2}, median {median:.2} ns per bond and step"
            );
        }
    }
    if let Some(bytes) = memory() {
        println!("{:.0} bytes a bond at most, particles and program included", bytes / engine.bond_count() as f64);
    }
}

/// One test past its peak at the converged speed.
fn full<S: Space>(count: usize, threads: usize, masses: Masses) {
    let (mut engine, size) = specimen::<S>(count, 0.02, Law::Parallel);
    engine.set_masses(masses);
    engine.set_threads(threads);
    let area: f64 = (0..S::DIMENSION).filter(|&k| k != 1).map(|k| size.at(k)).product();
    let (mut peak, mut strain_at_peak) = (0.0, 0.0);
    let start = Instant::now();
    let watch = |e: &Engine<S>| {
        let stress = 0.5 * (e.wall_force(3).at(1) - e.wall_force(2).at(1)) / area;
        let strain = (size.at(1) - e.wall_point(3).at(1) + e.wall_point(2).at(1)) / size.at(1);
        if stress > peak {
            (peak, strain_at_peak) = (stress, strain);
        }
        if stress < 0.75 * peak && strain > 2e-4 { Watch::Stop } else { Watch::Continue }
    };
    let bonds = engine.bond_count() as f64;
    let end = engine.run(100_000_000, 50, watch);
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{end:?}: {masses:?}, {threads} thread(s), {} steps, {seconds:.1} s, {:.2} ns per bond and step; peak {:.2} MPa at {:.3} %, {} cracks",
        engine.steps(),
        seconds * 1e9 / engine.steps() as f64 / bonds,
        peak / 1e6,
        strain_at_peak * 100.0,
        engine.cracks().len(),
    );
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let solid = words.iter().any(|w| w == "3d");
    let number = words.iter().find_map(|w| w.parse().ok());
    let whole = words.iter().any(|w| w == "full");
    let (energy, once) = (words.iter().any(|w| w == "energy"), words.iter().any(|w| w == "once"));
    let file = words.iter().find_map(|w| w.strip_prefix("write="));
    let order = |usual: usize| Order { count: number.unwrap_or(usual), energy, once, file };
    let threads = if words.iter().any(|w| w == "one") { 1 } else { 2 };
    let masses = if words.iter().any(|w| w == "equal") { Masses::EqualStep } else { Masses::Real };
    let joints = words.iter().any(|w| w == "joints");
    let laws = if joints { &[Law::Parallel, Law::Flat][..] } else { &[Law::Parallel] };
    match (solid, whole) {
        (false, false) => laws.iter().for_each(|&law| rates::<D2>(order(PLANE), PLANE, law)),
        (true, false) => laws.iter().for_each(|&law| rates::<D3>(order(SOLID), SOLID, law)),
        (false, true) => full::<D2>(number.unwrap_or(PLANE), threads, masses),
        (true, true) => full::<D3>(number.unwrap_or(SOLID), threads, masses),
    }
}
