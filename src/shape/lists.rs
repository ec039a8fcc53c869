//! Clumps in the formats of PFC, LAMMPS and YADE. SI units; the origin is the clump's centre of mass.

use super::clump::Clump;
use super::vector::minus;
use std::fmt::Write as _;

/// A PFC command that creates a template: radius and position of every pebble, volume and inertia of unit density.
pub fn pfc(name: &str, clump: &Clump) -> String {
    let mut text = format!("clump template create name '{name}' ...\n  pebbles {} ...\n", clump.balls.len());
    for (radius, [x, y, z]) in local(clump) {
        let _ = writeln!(text, "    {radius:e} ({x:e},{y:e},{z:e}) ...");
    }
    let i = clump.moments.inertia;
    let _ = writeln!(
        text,
        "  volume {:e} ...\n  inertia {:e} {:e} {:e} {:e} {:e} {:e}",
        clump.moments.volume, i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]
    );
    text
}

/// A LAMMPS molecule file for rigid bodies of spheres. The mass of an atom is its share by volume of that of the union,
/// so that they sum to the mass of the body.
pub fn lammps(name: &str, clump: &Clump, density: f64) -> String {
    let mass = density * clump.moments.volume;
    let i = clump.moments.inertia.map(|row| row.map(|x| density * x));
    let mut text = format!("# {name}\n\n{} atoms\n{mass:e} mass\n0 0 0 com\n", clump.balls.len());
    let _ =
        writeln!(text, "{:e} {:e} {:e} {:e} {:e} {:e} inertia", i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]);
    let cubes: f64 = clump.balls.iter().map(|b| b.radius.powi(3)).sum();
    let mut section = |title: &str, line: &dyn Fn(f64, [f64; 3]) -> String| {
        let _ = writeln!(text, "\n{title}\n");
        for (k, (radius, place)) in local(clump).enumerate() {
            let _ = writeln!(text, "{} {}", k + 1, line(radius, place));
        }
    };
    section("Coords", &|_, [x, y, z]| format!("{x:e} {y:e} {z:e}"));
    section("Types", &|_, _| "1".to_owned());
    section("Diameters", &|radius, _| format!("{:e}", 2.0 * radius));
    section("Masses", &|radius, _| format!("{:e}", mass * radius.powi(3) / cubes));
    text
}

/// Lines `x y z radius clump` of several clumps, as YADE's `ymport.textClumps` reads them, each at the origin of its own.
pub fn yade(clumps: &[&Clump]) -> String {
    let mut text = "#x_y_z_r_clumpId\n".to_owned();
    for (id, clump) in clumps.iter().enumerate() {
        for (radius, [x, y, z]) in local(clump) {
            let _ = writeln!(text, "{x:e}\t{y:e}\t{z:e}\t{radius:e}\t{id}");
        }
    }
    text
}

/// Radius and position of the pebbles about the centre of mass.
fn local(clump: &Clump) -> impl Iterator<Item = (f64, [f64; 3])> + '_ {
    clump.balls.iter().map(|ball| (ball.radius, minus(ball.centre, clump.moments.centre)))
}

#[cfg(test)]
mod tests {
    use super::super::Ball;
    use super::super::clump::Errors;
    use super::super::union;
    use super::*;

    fn two() -> Clump {
        let balls: Vec<Ball> = [1.0, 3.0].map(|x| Ball { centre: [x, 5.0, 5.0], radius: 1.0 }).into();
        let moments = union::moments(&balls, 128).unwrap();
        Clump { balls, moments, surface: 0.0, errors: Errors::default(), growth: 0.0, met: true }
    }

    #[test]
    fn lists_have_every_pebble_about_the_centre() {
        let clump = two();
        let pfc = pfc("stone", &clump);
        assert!(pfc.starts_with("clump template create name 'stone' ...\n  pebbles 2 ...\n"));
        assert_eq!(pfc.lines().count(), 6);
        let lammps = lammps("stone", &clump, 2.0);
        let numbers = |title: &str| -> Vec<Vec<f64>> {
            let rows = lammps.split(&format!("\n{title}\n\n")).nth(1).unwrap().lines().take(2);
            rows.map(|row| row.split(' ').map(|x| x.parse().unwrap()).collect()).collect()
        };
        assert!((numbers("Coords")[0][1] + 1.0).abs() < 1e-9 && (numbers("Coords")[1][1] - 1.0).abs() < 1e-9);
        let masses = numbers("Masses");
        assert!((masses[0][1] + masses[1][1] - 2.0 * clump.moments.volume).abs() < 1e-9);
        assert_eq!(numbers("Diameters")[1], [2.0, 2.0]);
        let yade = yade(&[&clump, &clump]);
        assert_eq!(yade.lines().count(), 5);
        assert!(yade.ends_with("\t1\n"));
    }
}
