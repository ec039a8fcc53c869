//! The examples with other people's engines: the real ones where they are installed, and stand-ins that hold the command
//! files to the manuals.

use crate::space::{Space, told};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// A copy of an example in a folder of its own.
fn example(name: &str) -> Space {
    let space = Space::new();
    let folder = Path::new(ROOT).join("workflows/engines").join(name);
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, space.path(&path.file_name().unwrap().to_string_lossy())).unwrap();
    }
    space
}

/// Whether a program is there; the nightly run demands it.
fn is_there(program: &str) -> bool {
    let found =
        Command::new(program).arg("--version").output().is_ok() || Command::new(program).arg("-h").output().is_ok();
    assert!(found || std::env::var("FLOW_TEST_ENGINES").is_err(), "`{program}` is not installed: .ci/install");
    if !found {
        eprintln!("not run: `{program}` is not installed");
    }
    found
}

/// The rows of a stage's runs as numbers by the names of their columns, without units.
fn runs(space: &Space, stage: &str) -> Vec<Vec<(String, f64)>> {
    let table = space.stdout(&["show", "rock.toml", stage, "--csv", "--table", "runs"]);
    let mut lines = table.lines();
    let heads: Vec<String> =
        lines.next().unwrap().split(',').map(|head| head.split(' ').next().unwrap().to_owned()).collect();
    let numbers = |line: &str| {
        let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
        heads.iter().cloned().zip(cells).collect()
    };
    lines.map(numbers).collect()
}

fn of(row: &[(String, f64)], name: &str) -> f64 {
    row.iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("no column {name}")).1
}

#[test]
fn every_example_is_a_workflow_without_a_fault() {
    for name in ["yade", "lammps", "pfc"] {
        let checked = example(name).flow(&["check", "rock.toml"]);
        assert!(checked.status.success() && told(&checked).contains("no fault"), "{name}: {}", told(&checked));
    }
}

/// Runs a stage of the example with the stand-in under the names of PFC's console programs.
fn pfc(space: &Space, stages: &[&str], more: &[&str]) -> Output {
    let bin = space.path("bin");
    std::fs::create_dir_all(&bin).unwrap();
    let engine = Path::new(ROOT).join("tests/reference/engines/pfc.py");
    for name in ["pfc2d600_console.exe", "pfc2d500_console.exe", "pfc3d600_console.exe"] {
        let path = bin.join(name);
        std::fs::write(&path, format!("#!/bin/sh\nexec python3 '{}' \"$@\"\n", engine.display())).unwrap();
        std::fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    }
    let paths = std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect::<Vec<PathBuf>>();
    let path = std::env::join_paths([bin].into_iter().chain(paths)).unwrap();
    let arguments = [&["run", "rock.toml", "--quiet"][..], stages, more].concat();
    space.command(&arguments).env("PATH", path).output().unwrap()
}

#[test]
fn the_command_files_for_pfc_hold_to_its_manuals_and_carry_every_parameter() {
    let space = example("pfc");
    let ran = pfc(&space, &["pfc2d", "pfc2d_5", "pfc3d"], &[]);
    assert!(ran.status.success(), "{}", told(&ran));
    for (stage, stiffer) in [("pfc2d", 1.0), ("pfc2d_5", 1.0), ("pfc3d", 1.2)] {
        let rows = runs(&space, stage);
        assert_eq!(rows.len(), 6);
        for row in &rows {
            let (ratio, kappa) = (of(row, "ratio"), of(row, "kn_ks"));
            // The stand-in's formulas, from the factors of the row.
            let bend = 2.0 * (kappa - 1.0) / (kappa + 1.0);
            let close = |name: &str, wanted: f64| {
                let found = of(row, name);
                assert!((found / wanted - 1.0).abs() < 1e-9, "{stage}: {name} {found}, wanted {wanted}");
            };
            close("UCS", 1.2 * of(row, "sigma_c") * ratio / 1.66);
            close("E", stiffer * of(row, "Ec") * (0.79 - 0.169 * bend));
            close("nu", 0.147 + 0.167 * bend);
        }
    }
}

#[test]
fn a_calibration_by_pfc_ends_at_parameters_that_meet_its_targets() {
    let space = example("pfc");
    let ran = pfc(&space, &["calibrate"], &[]);
    assert!(ran.status.success(), "{}", told(&ran));
    let table = space.stdout(&["show", "rock.toml", "calibrate", "--csv", "--table", "solution"]);
    assert!(table.lines().nth(1).is_some_and(|line| line.contains(",yes,")), "{table}");
}

/// The stand-in is no rubber stamp: what no manual knows is refused, and the row says why.
#[test]
fn a_command_file_with_a_slip_is_refused_by_the_stand_in() {
    for (wrong, right) in [
        ("contact method bonds gap", "contact method bond gap"),
        ("model solve ratio-averge 1e-5", "model solve ratio-average 1e-5"),
        ("wall.contact.force(", "wall.force.contact("),
        ("", "program quit"),
    ] {
        let space = example("pfc");
        let text = std::fs::read_to_string(space.path("compression2d.dat")).unwrap();
        assert!(text.contains(right), "{right}");
        space.write("compression2d.dat", &text.replace(right, wrong));
        let ran = pfc(&space, &["pfc2d"], &["--set", "stage.pfc2d.on_failure=stop"]);
        assert_eq!(ran.status.code(), Some(1), "{wrong}: {}", told(&ran));
        assert!(told(&ran).contains("***"), "{wrong}: {}", told(&ran));
    }
}

/// The table of an example's runs, as text and as numbers, after a run with some settings.
fn ran(space: &Space, stage: &str, set: &[&str]) -> (String, Vec<Vec<f64>>) {
    let output = space.flow(&[&["run", "rock.toml", stage][..], set].concat());
    assert!(output.status.success(), "{}", told(&output));
    let table = space.stdout(&[&["show", "rock.toml", stage, "--csv", "--table", "runs"][..], set].concat());
    let numbers = |line: &str| line.split(',').filter_map(|cell| cell.parse().ok()).collect();
    let rows = table.lines().skip(1).map(numbers).collect();
    (table, rows)
}

/// Columns: σ_c, E, UCS; E_c is 20 GPa. The modulus is the packing's and does not know the strength, which rises with σ_c.
#[test]
fn yade_compresses_a_specimen_of_flow() {
    if !is_there("yade") {
        return;
    }
    let set = ["--set", "stage.points.factors=[\"sigma_c\"]", "--set", "factor.sigma_c.range=[10, 40]"];
    let (table, rows) = ran(&example("yade"), "yade", &set);
    let (weak, strong) = (&rows[0], &rows[1]);
    assert!((strong[1] / weak[1] - 1.0).abs() < 0.1 && (4.0..16.0).contains(&weak[1]), "{table}");
    assert!((2.5..6.0).contains(&(strong[2] / weak[2])) && (8.0..40.0).contains(&weak[2]), "{table}");
}

/// Columns: E_c, E, UCS. Stiffnesses are proportional to E_c, and so is the modulus of the packing.
#[test]
fn lammps_compresses_a_specimen_of_flow() {
    if !is_there("lmp") {
        return;
    }
    let set = ["--set", "stage.points.factors=[\"Ec\"]", "--set", "factor.Ec.range=[10, 20]"];
    let (table, rows) = ran(&example("lammps"), "lammps", &set);
    assert!((1.9..2.1).contains(&(rows[1][1] / rows[0][1])) && (0.3..1.2).contains(&(rows[0][1] / 10.0)), "{table}");
    assert!(rows.iter().all(|row| row[2] > 20.0), "{table}");
}
