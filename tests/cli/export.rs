//! What `flow export` writes, counted here and read by another program.

use crate::space::{Space, told};
use std::process::Command;

const CAMPAIGN: &str = include_str!("small.toml");

/// A folder with the small campaign up to its trial, exported for ParaView and as lists.
fn exported() -> Space {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&["trial", "verify", "sizes", "chains", "flow"]);
    for (what, form) in
        [("specimen", "vtu"), ("trial", "vtu"), ("trial", "particles"), ("trial", "csv"), ("verify[2]", "particles")]
    {
        space.stdout(&["export", "w.toml", what, "--to", form, "--folder", "out"]);
    }
    space
}

/// The columns of a CSV file by name; the unit behind the name is left out.
fn read(space: &Space, name: &str) -> impl Fn(&str) -> Vec<String> + use<> {
    let mut reader = csv::Reader::from_path(space.path(&format!("out/{name}"))).unwrap();
    let heads: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    move |column: &str| {
        let at = heads.iter().position(|head| head.split(" [").next() == Some(column));
        let at = at.unwrap_or_else(|| panic!("no column {column} in {heads:?}"));
        rows.iter().map(|row| row[at].to_owned()).collect()
    }
}

/// A value of a table of names and values, as `flow show` prints it.
fn quantity(space: &Space, stage: &str, table: &str, name: &str) -> f64 {
    let text = space.stdout(&["show", "w.toml", stage, "--table", table, "--csv"]);
    let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no {name} in {text}"));
    line.split(',').nth(1).unwrap().parse().unwrap()
}

#[test]
fn specimens_and_runs_are_read_by_another_program() {
    let space = exported();
    lists_agree_with_what_the_campaign_counted(&space);
    a_run_is_listed_with_its_own_microparameters(&space);
    let required = std::env::var("FLOW_TEST_READERS").is_ok();
    let python = Command::new("python3").args(["-c", "import meshio"]).output();
    if required || python.is_ok_and(|output| output.status.success()) {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/read_with_meshio.py");
        let output = Command::new("python3").arg(script).arg(space.path("out")).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
    }
    what_cannot_be_exported_is_said(&space);
}

fn lists_agree_with_what_the_campaign_counted(space: &Space) {
    let (particles, contacts) = (read(space, "trial.particles.csv"), read(space, "trial.contacts.csv"));
    let discs = particles("id").len();
    assert_eq!(discs as f64, quantity(space, "specimen", "quality", "discs"));
    let groups = contacts("group");
    let of = |group: &str| groups.iter().filter(|own| *own == group).count() as f64;
    for (group, name) in
        [("mortar", "mortar-mortar"), ("interface", "mortar-aggregate"), ("aggregate", "aggregate-aggregate")]
    {
        assert_eq!(of(group), quantity(space, "specimen", "quality", &format!("contacts {name}")), "{group}");
    }
    // The engine counted its bonds when it had put them: 2 bonds / disc.
    let bonds = contacts("bonded").iter().filter(|bonded| *bonded == "1").count();
    let counted = quantity(space, "trial", "judgement", "coordination") * discs as f64 / 2.0;
    assert!((bonds as f64 - counted).abs() < 1e-6, "{bonds} bonds, the engine had {counted}");
    let pebbles: usize = read(space, "trial.clumps.csv")("pebbles").iter().map(|n| n.parse::<usize>().unwrap()).sum();
    assert_eq!(pebbles, particles("clump").iter().filter(|clump| *clump != "-1").count());
    let sizes = space.stdout(&["show", "w.toml", "sizes", "--table", "table", "--csv"]);
    let listed: f64 = sizes.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap()).sum();
    assert_eq!(listed, quantity(space, "specimen", "quality", "polygons"));
}

fn a_run_is_listed_with_its_own_microparameters(space: &Space) {
    let (base, own) = (read(space, "trial.groups.csv"), read(space, "verify.2.groups.csv"));
    assert_eq!(base("group"), ["aggregate", "interface", "mortar"]);
    assert_eq!(base("Ec"), ["30000000000", "10000000000", "20000000000"]);
    assert_eq!(base("sigma_c"), ["", "15000000", "20000000"]);
    assert_eq!(base("bond"), ["none", "parallel", "parallel"]);
    let solution = space.stdout(&["show", "w.toml", "calibrate", "--table", "solution", "--csv"]);
    let cells = |line: usize| solution.lines().nth(line).unwrap().split(',').collect::<Vec<_>>();
    let at = cells(0).iter().position(|head| *head == "sigma_c [MPa]").unwrap();
    let calibrated: f64 = cells(1)[at].parse().unwrap();
    let listed: f64 = own("sigma_c")[2].parse().unwrap();
    assert!((listed / 1e6 - calibrated).abs() < 1e-9 * calibrated, "{listed} {calibrated}");
    assert_eq!(own("tau_c"), base("tau_c"));
    // Another specimen, and every column is explained.
    assert_ne!(read(space, "verify.2.particles.csv")("x"), read(space, "trial.particles.csv")("x"));
    let columns = read(space, "trial.columns.csv");
    let units = columns("column").into_iter().zip(columns("unit")).collect::<Vec<_>>();
    assert!(units.contains(&("density".into(), "kg/m^3".into())) && columns("meaning").iter().all(|m| !m.is_empty()));
}

fn what_cannot_be_exported_is_said(space: &Space) {
    let said = |arguments: &[&str]| {
        let output = space.flow(arguments);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(said(&["export", "w.toml", "orthogonal", "--to", "vtu"]).contains("named as in orthogonal[12]"));
    assert!(said(&["export", "w.toml", "trial[0]"]).contains("rows are counted from 1"));
}

/// A rock of about two hundred spheres, crushed.
const SOLID: &str = r#"
[workflow]
title = "Spheres"
seed = 1
[material.rock]
rock = { Ec = "60 GPa", kn_ks = 2.5, mu = 0.5, sigma_c = "40 MPa", tau_c = "40 MPa" }
[stage.cylinder]
kind = "specimen"
diameter = "10 mm"
height = "20 mm"
packing = { stress = "30 MPa" }
mean_radius = "1 mm"
radius_ratio = 1.66
density = "2600 kg/m^3"
[stage.crush]
kind = "simulate"
specimen = "cylinder"
material = "rock"
test = "uniaxial"
platen_speed = { transits = 10 }
masses = "equal-step"
"#;

#[test]
fn spheres_are_exported_as_discs_are() {
    let space = Space::new();
    space.write("w.toml", SOLID);
    space.run(&[]);
    for form in ["vtu", "particles"] {
        space.stdout(&["export", "w.toml", "cylinder", "crush", "--to", form, "--folder", "out"]);
    }
    let particles = read(&space, "cylinder.particles.csv");
    let numbers = |texts: Vec<String>| texts.iter().map(|text| text.parse::<f64>().unwrap()).collect::<Vec<f64>>();
    let [x, y, z, radius] = ["x", "y", "z", "radius"].map(|name| numbers(particles(name)));
    assert_eq!(x.len() as f64, quantity(&space, "cylinder", "quality", "spheres"));
    // They stand in their cylinder, whose axis is y.
    for i in 0..x.len() {
        let from_axis = (x[i] * x[i] + z[i] * z[i]).sqrt();
        assert!(from_axis + radius[i] < 5.2e-3 && y[i].abs() + radius[i] < 10.2e-3);
    }
    let last = |folder: std::fs::ReadDir| {
        let names = folder.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.starts_with("crush.cracks")).max()
    };
    let cracks = last(std::fs::read_dir(space.path("out")).unwrap()).expect("the states have cracks");
    let text = std::fs::read_to_string(space.path(&format!("out/{cracks}"))).unwrap();
    // Each crack is a disc of twelve corners, as VTK's polygon 7.
    let types = text.split("Name=\"types\"").nth(1).and_then(|rest| rest.split(['>', '<']).nth(1)).unwrap();
    let count = types.split_whitespace().inspect(|kind| assert_eq!(*kind, "7")).count();
    assert!(text.contains(&format!("NumberOfPoints=\"{}\" NumberOfCells=\"{count}\"", 12 * count)), "{cracks}");
}
