//! Flat and smooth joints from the workflow to the files: sets of fissures, the record of cracks, damage, exports, faults.

use crate::space::Space;
use std::collections::BTreeMap;

/// About 250 grains with a set of fissures from a table and a set by its statistics.
const PLANE: &str = r#"
[workflow]
title = "Joints"
seed = 3
[material.rock]
rock = { bond = "flat-joint", Ec = "60 GPa", kn_ks = 2.4, sigma_c = "20 MPa", tau_c = "60 MPa", mu = 0.5, friction_angle = "10 deg", fj_slit = 0.1, fj_gapped = 0.1, fj_gap = "1 um", sigma_c_deviation = "20 %" }
[stage.plate]
kind = "specimen"
width = "30 mm"
height = "60 mm"
porosity = 0.12
mean_radius = "1.4 mm"
radius_ratio = 1.66
density = "2650 kg/m^3"
group = "rock"
[stage.crush]
kind = "simulate"
specimen = "plate"
material = "rock"
test = "uniaxial"
platen_speed = "0.4 m/s"
strain_limit = 0.02
masses = "equal-step"
forces = true
fissures = [
    { friction = 0.3, file = "traces.csv" },
    { friction = 0.6, tensile_strength = "2 MPa", cohesion = "5 MPa", network = { intensity = "40 1/m", sizes = ["5 mm", "15 mm"], exponent = 2, dip = "60 deg", concentration = 20 } },
]
[stage.damage]
kind = "figure"
show = "damage"
of = "crush"
compare = "plate"
"#;

/// A long fissure of 45°, one outside the specimen.
const TRACES: &str = "x1 [mm],y1 [mm],x2 [mm],y2 [mm]\n-7,7,7,-7\n100,0,110,0\n";

fn table(space: &Space, stage: &str, table: &str) -> BTreeMap<String, Vec<String>> {
    let text = space.stdout(&["show", "w.toml", stage, "--table", table, "--csv"]);
    columns(text.as_bytes())
}

/// Columns by their names without units.
fn columns(bytes: &[u8]) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_reader(bytes);
    let heads: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let name = |head: &String| head.split(" [").next().unwrap_or(head).to_owned();
    heads
        .iter()
        .enumerate()
        .map(|(at, head)| (name(head), rows.iter().map(|row| row[at].to_owned()).collect()))
        .collect()
}

fn numbers(texts: &[String]) -> Vec<f64> {
    texts.iter().map(|text| text.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn joints_are_recorded_drawn_and_exported() {
    let space = Space::new();
    space.write("w.toml", PLANE);
    space.write("traces.csv", TRACES);
    space.run(&[]);
    let fissures = the_fissures_are_recorded(&space);
    let share = the_cracks_name_their_interfaces(&space);
    let said = space.flow(&["export", "w.toml", "crush", "--to", "particles", "--folder", "out"]);
    let said = String::from_utf8(said.stderr).unwrap();
    assert!(said.contains("flat joints: PFC has them") && said.contains("LAMMPS has none"), "{said}");
    the_lists_have_the_state_of_every_joint(&space, fissures);
    space.stdout(&["export", "w.toml", "crush", "--to", "vtu", "--folder", "out"]);
    let last =
        (0..9).rev().find_map(|k| std::fs::read_to_string(space.path(&format!("out/crush.damage.{k}.vtu"))).ok());
    let last = last.expect("a state with damage");
    let values = last.split("Name=\"damage\"").nth(1).and_then(|rest| rest.split(['>', '<']).nth(1)).unwrap();
    let largest = values.split_whitespace().map(|text| text.parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert_eq!(largest, share);
    // Another trace in the file is another run; the same file is none.
    space.write("traces.csv", &TRACES.replace("-7,7,7,-7", "-8,8,8,-8"));
    assert!(space.run(&[]).ran.iter().any(|(stage, _)| stage == "crush"));
    assert!(space.run(&[]).ran.is_empty());
}

/// Both sets with what they cut of the specimen; how many fissures there are.
fn the_fissures_are_recorded(space: &Space) -> usize {
    let all = table(space, "crush", "fissures");
    let (set, inside, contacts) = (&all["set"], numbers(&all["inside"]), numbers(&all["contacts"]));
    assert_eq!((set[0].as_str(), set[1].as_str(), set[2].as_str()), ("1", "1", "2"));
    // 14 √2 mm, and nothing of the fissure outside.
    assert!((inside[0] - 0.014 * std::f64::consts::SQRT_2).abs() < 1e-9 && inside[1] == 0.0, "{inside:?}");
    assert!(contacts[0] >= 5.0 && contacts[1] == 0.0, "{contacts:?}");
    let judged = table(space, "crush", "judgement");
    let at = judged["quantity"].iter().position(|name| name.contains("P21")).unwrap();
    let reached: f64 = judged["value"][at].parse().unwrap();
    assert!((reached - inside.iter().sum::<f64>() / (0.03 * 0.06)).abs() < 1e-6 * reached, "{reached}");
    // The network alone was asked for 40/m.
    let own = inside[2..].iter().sum::<f64>() / (0.03 * 0.06);
    assert!((20.0..60.0).contains(&own), "{own}");
    let warned = space.stdout(&["show", "w.toml", "crush", "--table", "fissures"]);
    assert!(!warned.is_empty());
    set.len()
}

/// Several cracks on one interface, each with its element; the largest share of an interface that is broken.
fn the_cracks_name_their_interfaces(space: &Space) -> f64 {
    let (cracks, own) = (table(space, "crush", "cracks"), table(space, "crush", "interfaces"));
    assert_eq!(cracks["size"].len(), own["first"].len());
    let (damage, elements) = (numbers(&own["damage"]), numbers(&own["elements"]));
    let mut of: BTreeMap<(String, String), Vec<String>> = BTreeMap::new();
    for row in 0..damage.len() {
        let broken = of.entry((own["first"][row].clone(), own["second"][row].clone())).or_default();
        assert!(!broken.contains(&own["element"][row]), "element {} broke twice", own["element"][row]);
        broken.push(own["element"][row].clone());
        assert_eq!(damage[row], broken.len() as f64 / elements[row]);
    }
    assert!(of.values().any(|broken| broken.len() > 1));
    damage.into_iter().fold(0.0, f64::max)
}

fn the_lists_have_the_state_of_every_joint(space: &Space, fissures: usize) {
    let read = |name: &str| columns(&std::fs::read(space.path(&format!("out/crush.{name}.csv"))).unwrap());
    let contacts = read("contacts");
    let count = |column: &str, value: &str| contacts[column].iter().filter(|own| *own == value).count();
    let judged = table(space, "crush", "judgement");
    let value = |name: &str| {
        let at = judged["quantity"].iter().position(|own| own == name).unwrap();
        judged["value"][at].parse::<f64>().unwrap()
    };
    // The engine counted its bonds when it had put them: 2 bonds / disc.
    let bonds = value("coordination (2 bonds / disc)") * read("particles")["id"].len() as f64 / 2.0;
    assert!((count("bonded", "1") as f64 - bonds).abs() < 1e-6, "{bonds}");
    assert_eq!(count("joint", "smooth") as f64, value("contacts on fissures"));
    let flat = count("joint", "flat") as f64;
    for state in ["slit", "gapped"] {
        let mine =
            contacts["state"].iter().zip(&contacts["joint"]).filter(|(own, joint)| *own == state && *joint == "flat");
        let share = mine.count() as f64 / flat;
        assert!((0.04..0.17).contains(&share), "{state} {share}");
    }
    let open = contacts["opening"].iter().zip(&contacts["state"]).filter(|(_, state)| *state == "gapped");
    open.for_each(|(opening, _)| assert!((opening.parse::<f64>().unwrap() - 1e-6).abs() < 1e-15, "{opening}"));
    let strengths: Vec<f64> = numbers(&contacts["tensile_strength"]).into_iter().filter(|s| s.is_finite()).collect();
    let flat: Vec<f64> = strengths.iter().copied().filter(|&s| s > 3e6).collect();
    let mean = flat.iter().sum::<f64>() / flat.len() as f64;
    assert!((mean / 20e6 - 1.0).abs() < 0.1 && strengths.iter().any(|&s| (s - 2e6).abs() < 1.0), "{mean}");
    assert_eq!(read("fissures")["set"].len(), fissures);
    let pfc = read("pfc");
    let words: Vec<(&str, &str)> =
        pfc["keyword"].iter().map(String::as_str).zip(pfc["value"].iter().map(String::as_str)).collect();
    for row in
        [("fj_nr", "4"), ("fj_ten", "20000000"), ("fj_coh", "60000000"), ("sj_fric", "0.3"), ("sj_ten", "2000000")]
    {
        assert!(words.contains(&row), "{row:?} {words:?}");
    }
}

#[test]
fn faults_of_fissures_name_the_set_and_the_key() {
    let space = Space::new();
    let faults = |workflow: &str, traces: &str| {
        space.write("w.toml", workflow);
        space.write("traces.csv", traces);
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let found = faults(&PLANE.replace("file = \"traces.csv\"", "dilation = \"100 deg\""), TRACES);
    assert!(found.contains("there is no fissure") && found.contains("`dilation`"), "{found}");
    let found = faults(&PLANE.replace("dip = \"60 deg\"", "dip = \"60 deg\", direction = \"10 deg\""), TRACES);
    assert!(found.contains("`direction` has no effect in the plane"), "{found}");
    let found = faults(PLANE, "x [mm],y [mm],dip [deg],length [mm]\n1,2,3,-4\n");
    assert!(found.contains("traces.csv: row 1: the length") && found.contains("file = \"traces.csv\""), "{found}");
    let found = faults(&PLANE.replace("traces.csv", "lost.csv"), TRACES);
    assert!(found.contains("there is no such file"), "{found}");
}

#[test]
fn damage_is_drawn_of_flat_joints_alone() {
    let space = Space::new();
    let parallel = "rock = { Ec = \"30 GPa\", kn_ks = 2.4, sigma_c = \"20 MPa\", tau_c = \"30 MPa\", mu = 0.5 }";
    let line = PLANE.lines().find(|line| line.starts_with("rock = ")).unwrap();
    space.write("w.toml", &PLANE.replace(line, parallel));
    space.write("traces.csv", TRACES);
    let output = space.flow(&["run", "w.toml", "--quiet"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("does not say how much of its interfaces is broken"), "{said}");
}
