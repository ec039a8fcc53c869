//! Materials by the user's names, and factors that set numbers of materials, specimens and tests: what runs, and what is told.

use crate::space::{Space, told};

const ROCK: &str = r#"
[workflow]
seed = 1
[factor]
sigma_c = { sets = "rock.sigma_c", unit = "MPa", levels = [10, 30] }
s       = { levels = [0.5, 1] }
R       = { sets = "specimen.mean_radius", unit = "mm", levels = [3, 4] }
v       = { sets = "runs.platen_speed", unit = "m/s", levels = [0.2, 0.4] }
[response]
UCS = { unit = "MPa" }
[material.granite]
rock = { Ec = "20 GPa", kn_ks = 2.5, sigma_c = "20 MPa", tau_c = "sigma_c / s", sigma_c_deviation = "20 %", mu = 0.5 }
stone = { Ec = "30 GPa" }
[stage.specimen]
kind = "specimen"
width = "40 mm"
height = "60 mm"
porosity = 0.12
mean_radius = "3.5 mm"
radius_ratio = 2
density = "2000 kg/m^3"
group = "rock"
[stage.plan]
kind = "design"
method = "full-factorial"
factors = ["sigma_c", "s", "R", "v"]
[stage.runs]
kind = "simulate"
specimen = "specimen"
material = "granite"
design = "plan"
test = "uniaxial"
platen_speed = "0.2 m/s"
"#;

fn space(text: &str) -> Space {
    let space = Space::new();
    space.write("w.toml", text);
    space
}

fn refused(text: &str, options: &[&str]) -> String {
    let output = space(text).flow(&[&["check", "w.toml"], options].concat());
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    told(&output)
}

/// Sixteen rows on two packings, one for each radius; the base packing is the third.
#[test]
fn rows_share_the_packings_of_their_specimen_settings() {
    let space = space(ROCK);
    space.run(&[]).expect(&[("specimen", 1), ("plan", 1), ("runs", 2 + 16 + 1)]);
    space.run(&[]).expect(&[]);
    // What no contact can have reruns nothing.
    space.run(&["--set", "material.granite.stone.Ec=31 GPa"]).expect(&[]);
    // With the radius of a level the base packing is one that a row stands on.
    space.run(&["--set", "stage.specimen.mean_radius=3 mm"]).expect(&[]);
    // One level of the speed: half of the rows, on the packings that are there, and the table of all.
    space.run(&["--set", "factor.v.levels=[0.2, 0.5]"]).expect(&[("plan", 1), ("runs", 8 + 1)]);
    let table = space.stdout(&["show", "w.toml", "runs", "--csv"]);
    assert_eq!(table.lines().count(), 17, "{table}");
}

#[test]
fn rows_that_break_a_rule_are_refused_by_name_or_left_out() {
    let ruled = ROCK.replace("factors = [", "valid = [\"sigma_c/s <= 50 MPa\"]\nfactors = [");
    let words = refused(&ruled, &[]);
    assert!(
        words.contains("breaks `sigma_c/s <= 50 MPa`: sigma_c = 30 MPa, s = 0.5, R = 3 mm, v = 0.2 m/s"),
        "{words}"
    );
    let space = space(&ruled.replace("factors = [", "invalid_rows = \"leave-out\"\nfactors = ["));
    space.run(&["plan"]).expect(&[("plan", 1)]);
    let left = space.stdout(&["show", "w.toml", "plan", "--csv", "--table", "left_out"]);
    assert_eq!(left.lines().count(), 1 + 4, "{left}");
    let words = refused(&ruled.replace("50 MPa", "50"), &[]);
    assert!(words.contains("Pa and a pure number cannot be added or compared"), "{words}");
}

#[test]
fn a_factor_that_sets_what_is_not_there_or_cannot_be_is_told_before_the_run() {
    for (set, message) in [
        ("factor.R.sets='specimen.mean_radiu'", "unknown field `mean_radiu`"),
        ("factor.R.levels=[3, -4]", "mean_radius is -4 mm"),
        ("factor.R.unit='MPa'", "`MPa` is not a unit of length"),
        ("factor.R.sets='plan.runs'", "makes no specimen and runs no test"),
        ("factor.R.sets='sample.mean_radius'", "no material and no stage has `sample.mean_radius`"),
        ("factor.sigma_c.levels=[0, 10]", "sets `rock.sigma_c` to 0 MPa; it must be above 0"),
        ("factor.sigma_c.unit='mm'", "factor `sigma_c` is in mm, and `rock.sigma_c`, which it sets, is not"),
        ("factor.sigma_c.sets=['rock.sigma_c', 'rock.sigmac']", "no material and no stage has `rock.sigmac`"),
        ("stage.plan.factors=['sigma_c', 'R']", "needs `s`, which is not set"),
    ] {
        let words = refused(ROCK, &["--set", set]);
        assert!(words.contains(message), "{set}: {words}");
    }
    let both = ROCK
        .replace("stage.specimen]", "stage.rock]")
        .replace("\"specimen.", "\"rock.")
        .replace("= \"specimen\"\nmaterial", "= \"rock\"\nmaterial");
    assert!(refused(&both, &[]).contains("is ambiguous: `rock` is a stage, and a group of a material"));
}

#[test]
fn a_material_comes_from_formulas_with_the_bond_and_stiffnesses_that_they_name() {
    let text = format!(
        "{ROCK}{}",
        r#"
[stage.initial]
kind = "formula"
[stage.initial.responses]
kn = { value = "20e9", unit = "N/m" }
ks = { value = "10e9", unit = "N/m" }
pb_kn = { value = "12e9/0.006", unit = "Pa/m" }
pb_ks = { value = "5e9/0.006", unit = "Pa/m" }
mu = { value = "0.5" }
sigma_c = { value = "20", unit = "MPa" }
tau_c = { value = "30", unit = "MPa" }
[stage.direct]
kind = "simulate"
specimen = "specimen"
material = "initial"
test = "uniaxial"
platen_speed = "0.2 m/s"
bond = { kind = "parallel", radius_multiplier = 0.8 }
"#
    );
    let space = space(&text);
    space.run(&["direct"]).expect(&[("specimen", 1), ("initial", 1), ("direct", 1)]);
    let cracks = space.stdout(&["show", "w.toml", "direct", "--csv", "--table", "cracks"]);
    assert!(cracks.lines().nth(1).is_some_and(|line| line.contains(",rock,")), "{cracks}");
    let lacking = text.replace("tau_c = { value = \"30\", unit = \"MPa\" }\n", "");
    let output = self::space(&lacking).flow(&["run", "w.toml", "direct"]);
    assert!(!output.status.success() && told(&output).contains("lacks `tau_c`"), "{}", told(&output));
}

#[test]
fn a_calibrated_set_is_the_material_of_a_later_test() {
    let more = r#"
[stage.search]
kind = "calibrate"
simulator = "lab"
method = "surrogate"
evaluations = 6
factors = ["sigma_c"]
targets = [{ UCS = "25 MPa" }]
[stage.lab]
kind = "formula"
material = "plain"
[stage.lab.responses]
UCS = { value = "sigma_c * 1.2", unit = "MPa" }
[stage.later]
kind = "simulate"
specimen = "specimen"
material = "search"
test = "tension"
platen_speed = "0.2 m/s"
[material.plain]
rock = { Ec = "20 GPa", kn_ks = 2.5, sigma_c = "20 MPa", tau_c = "2 * sigma_c", mu = 0.5 }
"#;
    let text = format!("{ROCK}{more}").replace("value = \"sigma_c * 1.2\"", "value = \"rock_sigma_c * 1.2e-6\"");
    let space = space(&text);
    let ran = space.run(&["later"]);
    assert!(ran.ran.iter().any(|(stage, count)| stage == "later" && *count == 1), "{:?}", ran.ran);
    let output = space.flow(&["run", "w.toml", "later", "--set", "stage.later.set=2"]);
    assert!(told(&output).contains("gives 1 sets, and set 2 is asked for"), "{}", told(&output));
    assert!(
        refused(&text, &["--set", "stage.later.material=plain", "--set", "stage.later.set=1"])
            .contains("`set` has no effect")
    );
}
