//! A block of discs in a hexagonal lattice, bonded, between two platens: stress, strain and the first cracks.
//!
//! `cargo run --release -p flow-dem --example compression_plane`
//!
//! The modulus is set beside that of the infinite lattice. Under compression across the rows the inclined contacts press, so
//! spring and bond act together in them (k_n, k_s); the contacts of a row open, so only the bond acts (k̄_n). By affine
//! deformation, for unit thickness: E = (2/√3) (C_yy − C_xy² / C_xx) with C_xx = k̄_n + (k_n + 3 k_s) / 8,
//! C_yy = (9 k_n + 3 k_s) / 8 and C_xy = 3 (k_n − k_s) / 8. A free block is softer by its rim.

use dem::*;

const RADIUS: f64 = 0.5e-3; // m
const MODULUS: f64 = 20e9; // Pa, of the spring and of the bond
const RATIO: f64 = 2.0; // k_n / k_s of both
const GRAIN: Group = Group(0);
const PLATEN: Group = Group(1);

/// Rows of touching discs, each shifted by whole a disc against the row below.
fn block(columns: usize, rows: usize) -> Vec<Particle<D2>> {
    let pitch = 3.0_f64.sqrt() * RADIUS;
    let centre = |row: usize, column: usize| {
        let shift = if row.is_multiple_of(2) { 0.0 } else { RADIUS };
        [2.0 * RADIUS * column as f64 + shift, RADIUS + pitch * row as f64]
    };
    let sites = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    sites.map(|(row, column)| Particle::ball(centre(row, column), RADIUS, 2500.0, GRAIN)).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (columns, rows) = (40, 80);
    let particles = block(columns, rows);
    let width = 2.0 * RADIUS * columns as f64;
    let height = particles.iter().map(|p| p.position[1]).fold(0.0, f64::max) + RADIUS;

    let spring = Linear::modulus(MODULUS, RATIO, 0.5);
    let bond = Bond::Parallel(ParallelBond::new(MODULUS, RATIO, 20e6, 30e6));
    let speed = 0.02; // m/s, of each platen
    let platen = |y: f64, up: f64| Wall {
        point: [0.0, y],
        normal: [0.0, up],
        motion: Motion::Velocity([0.0, up * speed]),
        group: PLATEN,
    };
    let mut engine = Engine::new(&Model {
        particles,
        clumps: vec![],
        walls: vec![platen(0.0, 1.0), platen(height, -1.0)],
        contacts: ContactTable::new().with(GRAIN, GRAIN, Interaction { linear: spring, bond }).with(
            GRAIN,
            PLATEN,
            Interaction::unbonded(Linear::modulus(MODULUS, RATIO, 0.0)),
        ),
        settings: Settings::default(),
    })?;
    engine.install_bonds(1e-6 * RADIUS, 1)?;

    println!("strain, %   stress, MPa   cracks");
    let (mut peak, mut whole) = (0.0_f64, None);
    let every = (1e-5 * height / (2.0 * speed * engine.time_step())) as u64;
    engine.run(2000 * every, every, |engine| {
        let strain = 2.0 * speed * engine.time() / height;
        let stress = 0.5 * (engine.wall_force(1)[1] - engine.wall_force(0)[1]) / width;
        let step = (strain * 1e5).round() as u64;
        if step.is_multiple_of(25) {
            println!("{:9.3} {:13.3} {:8}", strain * 100.0, stress / 1e6, engine.cracks().len());
        }
        whole = whole.or((engine.cracks().is_empty() && strain > 2e-4).then_some(stress / strain));
        peak = peak.max(stress);
        if stress < 0.7 * peak && strain > 2e-4 { Watch::Stop } else { Watch::Continue }
    })?;

    let (cement, kn, ks) = (MODULUS, 2.0 * MODULUS, 2.0 * MODULUS / RATIO); // N/m for unit thickness
    let [xx, yy, xy] = [cement + (kn + 3.0 * ks) / 8.0, (9.0 * kn + 3.0 * ks) / 8.0, 3.0 * (kn - ks) / 8.0];
    let lattice = 2.0 / 3.0_f64.sqrt() * (yy - xy * xy / xx);
    println!("strength {:.2} MPa with {} cracks", peak / 1e6, engine.cracks().len());
    println!("modulus {:.2} GPa; infinite lattice {:.2} GPa", whole.unwrap_or(f64::NAN) / 1e9, lattice / 1e9);
    Ok(())
}
