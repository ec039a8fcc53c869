//! A block of spheres in a face-centred cubic lattice with contact bonds between two platens: stress, strain and cracks.
//!
//! `cargo run --release -p flow-dem --example compression_space`
//!
//! The modulus is set beside the closed form of the infinite lattice along an edge of its cube,
//! E = (√2 / l) 2 k_n (k_n + 3 k_s) / (3 k_n + k_s) with l = 2 R: a contact bond makes the
//! spring pull as it presses. The strain is taken between two inner layers, because the contacts with the platens are softer than the lattice; what is left of the
//! difference is the rim of the block.

use dem::*;

const RADIUS: f64 = 2e-3; // m
const MODULUS: f64 = 20e9; // Pa, of the contacts
const RATIO: f64 = 2.0; // k_n / k_s
const GRAIN: Group = Group(0);
const PLATEN: Group = Group(1);

/// Cubes of edge 2√2 R with a sphere on every corner and on the middle of every face.
fn block(cubes: [usize; 3]) -> Vec<Particle<D3>> {
    let half = 2.0_f64.sqrt() * RADIUS;
    let [x, y, z] = cubes.map(|count| 2 * count + 1);
    let sites = (0..x).flat_map(move |i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k])));
    let occupied = sites.filter(|[i, j, k]| (i + j + k).is_multiple_of(2));
    let centre = |[i, j, k]: [usize; 3]| [half * i as f64, half * j as f64, RADIUS + half * k as f64];
    occupied.map(|site| Particle::ball(centre(site), RADIUS, 2500.0, GRAIN)).collect()
}

/// Mean height of the spheres of a layer, m.
fn level(engine: &Engine<D3>, layer: &[usize]) -> f64 {
    layer.iter().map(|&i| engine.position(i)[2]).sum::<f64>() / layer.len() as f64
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cubes = [10, 10, 10];
    let particles = block(cubes);
    let edge = 2.0 * 2.0_f64.sqrt() * RADIUS;
    let area = (edge * cubes[0] as f64 + 2.0 * RADIUS) * (edge * cubes[1] as f64 + 2.0 * RADIUS);
    let height = edge * cubes[2] as f64 + 2.0 * RADIUS;

    let layer = |number: f64| {
        let z = RADIUS + number * edge / 2.0;
        (0..particles.len()).filter(|&i| (particles[i].position[2] - z).abs() < 0.1 * RADIUS).collect::<Vec<usize>>()
    };
    let (low, high) = (layer(5.0), layer(15.0));
    let gauge = 5.0 * edge;

    let spring = Linear::modulus(MODULUS, RATIO, 0.5);
    let bond = ContactBond::new(20e6, 30e6);
    let kn = spring.stiffness.normal::<D3>([RADIUS, RADIUS]);
    let ks = kn * spring.stiffness.shear_share();
    let speed = 0.05; // m/s, of each platen
    let platen = |z: f64, up: f64| Wall {
        point: [0.0, 0.0, z],
        normal: [0.0, 0.0, up],
        motion: Motion::Velocity([0.0, 0.0, up * speed]),
        group: PLATEN,
    };
    let mut engine = Engine::new(&Model {
        particles,
        clumps: vec![],
        walls: vec![platen(0.0, 1.0), platen(height, -1.0)],
        contacts: ContactTable::new()
            .with(GRAIN, GRAIN, Interaction { linear: spring, bond: Bond::Contact(bond) })
            .with(GRAIN, PLATEN, Interaction::unbonded(Linear::modulus(MODULUS, RATIO, 0.0))),
        settings: Settings::default(),
    })?;
    engine.install_bonds(1e-6 * RADIUS, 1)?;

    println!("strain, %   stress, MPa   cracks");
    let (mut peak, mut whole) = (0.0_f64, None);
    let every = (1e-5 * height / (2.0 * speed * engine.time_step())).max(1.0) as u64;
    engine.run(2000 * every, every, |engine| {
        let strain = 2.0 * speed * engine.time() / height;
        let stress = 0.5 * (engine.wall_force(1)[2] - engine.wall_force(0)[2]) / area;
        if ((strain * 1e5).round() as u64).is_multiple_of(25) {
            println!("{:9.3} {:13.3} {:8}", strain * 100.0, stress / 1e6, engine.cracks().len());
        }
        whole = whole.or((engine.cracks().is_empty() && strain > 2e-4)
            .then(|| stress / (1.0 - (level(engine, &high) - level(engine, &low)) / gauge)));
        peak = peak.max(stress);
        if stress < 0.7 * peak && strain > 2e-4 { Watch::Stop } else { Watch::Continue }
    })?;

    let lattice = 2.0_f64.sqrt() / (2.0 * RADIUS) * 2.0 * kn * (kn + 3.0 * ks) / (3.0 * kn + ks);
    println!("strength {:.2} MPa with {} cracks", peak / 1e6, engine.cracks().len());
    println!("modulus {:.2} GPa; infinite lattice {:.2} GPa", whole.unwrap_or(f64::NAN) / 1e9, lattice / 1e9);
    Ok(())
}
