//! `flow calibrate`: other targets from a finished campaign, and calibrations that cannot be.

use crate::space::{Space, told};
use serde_json::Value;

const CAMPAIGN: &str = include_str!("campaign.toml");

/// The folder with the campaign, its stages run as named.
fn space(stages: &[&str]) -> Space {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    if !stages.is_empty() {
        space.run(stages);
    }
    space
}

fn answer(space: &Space, more: &[&str]) -> Value {
    let text = space.stdout(&[&["calibrate", "w.toml", "--json"], more].concat());
    serde_json::from_str(&text).expect("a JSON document")
}

/// y = 3a + b²/100 + 7 with 1 % scatter: a known truth.
fn truth(solution: &Value) -> f64 {
    let at = |name: &str| solution[name].as_f64().expect("a number");
    3.0 * at("a") + at("b") * at("b") / 100.0 + 7.0
}

#[test]
fn other_targets_are_answered_from_the_surfaces_and_the_second_time_from_the_store() {
    let space = space(&["surfaces"]);
    let objects = space.objects().len();
    let found = answer(&space, &["--target", "y=18.5 MPa"]);
    assert!((truth(&found["solution"]) / 18.5 - 1.0).abs() < 0.02, "{found}");
    assert_eq!(space.objects().len(), objects + 1, "one solution and nothing else");
    assert_eq!(found, answer(&space, &["--target", "y=18.5e6 Pa"]));
    assert_eq!(space.objects().len(), objects + 1);
    let expected = &found["prediction"][0];
    let at = |name: &str| expected[name].as_f64().expect("a number");
    assert!(at("low") < at("expected") && at("expected") < at("high"), "{expected}");
    assert!((at("expected") - 18.5).abs() < 1e-3, "{expected}");
    // Two parameters and one target: a line of solutions.
    assert_eq!(found["solution"]["free"], 1.0);
    assert!(found["solution_set"].as_array().expect("rows").len() > 10);
    let text = space.stdout(&["calibrate", "w.toml", "--target", "y=18.5 MPa"]);
    assert!(text.contains("the targets leave 1 direction free"), "{text}");
    let csv = space.stdout(&["calibrate", "w.toml", "--target", "y=18.5 MPa", "--csv"]);
    assert!(csv.starts_with("set,a,b,y [MPa],misfit,"), "{csv}");
    // The campaign's own calibration is as it was.
    space.run(&["surfaces"]).expect(&[]);
}

#[test]
fn a_verification_runs_its_own_specimens_and_nothing_else() {
    let space = space(&["surfaces"]);
    let before = space.objects().len();
    let found = answer(&space, &["--target", "y=18.5 MPa", "--verify", "--quiet"]);
    let summary = &found["verification"][0][0];
    assert_eq!((summary["response"].as_str(), summary["n"].as_i64()), (Some("y"), Some(3)));
    assert!(summary["relative_error_percent"].as_f64().expect("a number") < 3.0, "{summary}");
    assert_eq!(space.objects().len(), before + 1 + 3 + 1, "solution, three runs, verification");
    let csv = space.stdout(&["calibrate", "w.toml", "--target", "y=18.5 MPa", "--verify", "--csv", "--quiet"]);
    assert!(csv.starts_with("set,response,unit,target,mean"), "{csv}");
}

#[test]
fn a_target_out_of_reach_is_named_with_the_nearest_value() {
    let space = space(&["surfaces"]);
    let text = space.stdout(&["calibrate", "w.toml", "--target", "y=40 MPa"]);
    assert!(text.contains("the target of `y` is out of reach, at most 2"), "{text}");
}

#[test]
fn an_unfinished_campaign_says_what_to_run_first_and_runs_nothing() {
    let space = space(&["grid"]);
    let before = space.objects().len();
    let target = ["calibrate", "w.toml", "--target", "y=18.5 MPa"];
    let output = space.flow(&target);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("run first: flow run w.toml surfaces\n"), "{}", told(&output));
    assert!(
        told(&output).contains("faces, ccd, surfaces of what `calibrate` rests on are missing"),
        "{}",
        told(&output)
    );
    assert_eq!(space.objects().len(), before);
    // Its verification may not run the simulator's design either.
    space.run(&["surfaces"]);
    space.write("w.toml", &CAMPAIGN.replace("simulator = \"ccd\"", "simulator = \"table\""));
    let output = space.flow(&[&target[..], &["--verify", "--set", "workflow.title=mine"]].concat());
    let first = "run first: flow run w.toml table --set workflow.title=mine\n";
    assert!(told(&output).contains(first), "{}", told(&output));
    assert!(space.flow(&target).status.success());
}

#[test]
fn every_fault_of_the_command_line_is_told() {
    let space = space(&[]);
    for (options, message) in [
        (&["--target", "z=3"][..], "unknown response `z`"),
        (&["--target", "Y=16 MPa"], "did you mean `y`?"),
        (&["--target", "y"], "there is no `=`"),
        (&["--target", "y=16"], "16 is not a value in `MPa`; write for example \"30 MPa\""),
        (&["--target", "y=16 GP"], "--target y=16 GP: "),
        (&["--target", "y=16 GPa", "--target", "y=1 MPa"], "`y` is given twice"),
        (&["--target", "y=0 MPa"], "the target of `y` is 0"),
        (&["--target", "y=\"0 MPa\""], "the target of `y` is 0"),
        (&["--target", "y=16 MPa", "--stage", "verify"], "`verify` is of kind verify, not calibrate"),
        (&["--target", "y=16 MPa", "--stage", "calibrat"], "did you mean `calibrate`?"),
        (&["--target", "y=16 MPa", "--set", "stage.calibrate.simulator=ccd"], "searches on surfaces alone: calibrate"),
    ] {
        let output = space.flow(&[&["calibrate", "w.toml"], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}: {}", told(&output));
        assert!(told(&output).contains(message), "{options:?}: wanted `{message}` in {}", told(&output));
    }
    let alone = CAMPAIGN.replace(
        "[stage.verify]\nkind = \"verify\"\nsolution = \"calibrate\"",
        "[stage.verify]\nkind = \"verify\"\nsolution = \"other\"",
    );
    space.write("w.toml", &format!("{alone}\n[stage.other]\nkind = \"calibrate\"\nsurfaces = \"surfaces\"\nfactors = [\"a\", \"b\"]\ntargets = [{{ y = \"16 MPa\" }}]\n"));
    let output = space.flow(&["calibrate", "w.toml", "--target", "y=16 MPa"]);
    assert!(told(&output).contains("name one with --stage: calibrate, other"), "{}", told(&output));
    let output = space.flow(&["calibrate", "w.toml", "--target", "y=16 MPa", "--stage", "calibrate", "--verify"]);
    assert!(told(&output).contains("no stage verifies `calibrate`"), "{}", told(&output));
}

#[test]
fn calibrations_that_cannot_be_are_refused_with_the_place_and_a_remedy() {
    let space = space(&["surfaces"]);
    for (set, messages) in [
        ("factors=[\"a\", \"c\"]", &["unknown factor `c`", "known are a, b", "--set:1:"][..]),
        ("targets=[{ z = 3 }]", &["unknown response `z`", "known are y", "--set:1:"]),
        ("ranges={ a = [3, 2] }", &["the range of `a` is empty: from 3 to 2", "--set:1:"]),
        ("targets=[{ y = \"0 MPa\" }]", &["the target of `y` is 0", "use the denominator `largest`", "--set:1:"]),
        (
            "constraints=[{ terms = { a = 1 }, at_most = 1.2 }, { terms = { a = -1 }, at_most = -2 }]",
            &["no point of the box meets `a ≤ 1.2`, `−a ≤ -2` together", "--set:1:"],
        ),
        ("weights={ y = -1 }", &["the weight of `y` is -1; weights must be positive", "--set:1:"]),
        ("preference={ a = 7 }", &["`a` = 7 is not within 1 … 3", "--set:1:"]),
    ] {
        let output = space.flow(&["run", "w.toml", "calibrate", "--set", &format!("stage.calibrate.{set}")]);
        assert_eq!(output.status.code(), Some(2), "{set}: {}", told(&output));
        for message in messages {
            assert!(told(&output).contains(message), "{set}: wanted `{message}` in {}", told(&output));
        }
    }
    let output = space.flow(&["run", "w.toml", "calibrate", "--set", "stage.calibrate.ranges={ a = [0, 4] }"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let message = "the range 0 … 4 of `a` leaves the domain 1 … 3 of the surface of `y` (narrow it";
    assert!(told(&output).contains(message), "{}", told(&output));
}

const LABORATORY: &str = r#"
[workflow]
seed = 1
[factor]
a = { sets = "mortar.a", levels = [1, 3] }
[response]
y = { unit = "MPa" }
[material.base]
mortar = { a = 1 }
[stage.lab]
kind = "command"
run = ["sh", "-c", "echo no peak >&2; exit 3"]
material = "base"
read.y = { file = "stdout", pattern = 'y = (\S+)', unit = "MPa" }
on_failure = "record"
[stage.calibrate]
kind = "calibrate"
simulator = "lab"
factors = ["a"]
targets = [{ y = "2 MPa" }]
"#;

#[test]
fn a_calibration_whose_every_simulation_fails_ends_early_and_says_why() {
    let space = Space::new();
    space.write("w.toml", LABORATORY);
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains("all 30 simulations failed; the first: "), "{}", told(&output));
    assert!(told(&output).contains("exit status: 3 (look at the ranges of the factors"), "{}", told(&output));
    let at_once = space.flow(&["calibrate", "w.toml", "--target", "y=2 MPa", "--stage", "calibrate"]);
    assert_eq!(at_once.status.code(), Some(2));
    assert!(told(&at_once).contains("`calibrate` calibrates by simulations"), "{}", told(&at_once));
}

const CURVE: &str = r#"
[workflow]
seed = 3
[factor]
Ec = { sets = "mortar.Ec", unit = "GPa", range = [10, 30] }
sigma_c = { sets = "mortar.sigma_c", unit = "MPa", range = [10, 30] }
[material.base]
mortar = { Ec = "20 GPa", kn_ks = 2.5, sigma_c = "20 MPa", tau_c = "20 MPa", mu = 0.5 }
aggregate = { Ec = "30 GPa", kn_ks = 2, mu = 0.5, bond = "none" }
interface = { between = ["mortar", "aggregate"], Ec = "10 GPa", kn_ks = 2.5, sigma_c = "15 MPa", tau_c = "15 MPa", mu = 0.5 }
[stage.specimen]
kind = "specimen"
width = "20 mm"
height = "40 mm"
porosity = 0.16
mean_radius = "1 mm"
radius_ratio = 1.66
density = "2000 kg/m^3"
[stage.test]
kind = "simulate"
specimen = "specimen"
material = "base"
test = "uniaxial"
platen_speed = "0.05 m/s"
masses = "equal-step"
[stage.calibrate]
kind = "calibrate"
simulator = "test"
factors = ["Ec", "sigma_c"]
curve = { strain = [0.0003, 0.0006, 0.0009], stress = ["6 MPa", "12 MPa", "18 MPa"] }
constraints = [{ terms = { sigma_c = 1, Ec = -1 }, at_most = 5 }]
evaluations = 12
"#;

/// A line of 20 GPa as the wanted curve, in every form of the misfit, with a constraint, on the engine itself.
#[test]
fn a_stress_strain_curve_is_followed_by_simulations() {
    let space = Space::new();
    space.write("w.toml", CURVE);
    for settings in [
        &["misfit=\"squares\"", "denominator=\"largest\""][..],
        &["misfit=\"sum\""],
        &["misfit=\"maximum\"", "denominator=\"computed\""],
    ] {
        let sets: Vec<String> = settings.iter().map(|set| format!("stage.calibrate.{set}")).collect();
        let options: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        space.run(&options);
        let show = ["show", "w.toml", "calibrate", "--json", "--table"];
        let table = |name: &str| -> Value {
            let text = space.stdout(&[&show[..], &[name], &options].concat());
            serde_json::from_str(&text).expect("a JSON document")
        };
        let column = |table: &Value, name: &str| -> Vec<f64> {
            let columns = table["columns"].as_array().expect("columns");
            let found = columns.iter().find(|column| column["name"] == name).expect(name);
            found["values"].as_array().expect("values").iter().filter_map(Value::as_f64).collect()
        };
        let expected = column(&table("prediction"), "expected");
        for (expected, wanted) in expected.iter().zip([6.0, 12.0, 18.0]) {
            assert!((expected / wanted - 1.0).abs() < 0.03, "{settings:?}: {expected} for {wanted}");
        }
        let history = table("history");
        let points = column(&history, "sigma_c").into_iter().zip(column(&history, "Ec"));
        assert!(
            points.clone().count() == 12 && points.into_iter().all(|(sigma, modulus)| sigma - modulus <= 5.0 + 1e-6)
        );
    }
}

const ROCK: &str = r#"
[workflow]
seed = 3
[factor]
sigma_c = { range = [1, 1000], unit = "MPa", scale = "log" }
Ec = { range = [1, 100], unit = "GPa", scale = "log" }
[response]
UCS = { unit = "MPa" }
E = { unit = "GPa" }
sigma_t = { unit = "MPa" }
[stage.points]
kind = "design"
method = "full-factorial"
factors = ["sigma_c", "Ec"]
[stage.compression]
kind = "formula"
design = "points"
responses.UCS = { value = "2*sigma_c", unit = "MPa", scatter = 0.04 }
responses.E = { value = "1.4*Ec", unit = "GPa", scatter = 0.03 }
[stage.splitting]
kind = "formula"
design = "points"
responses.sigma_t = { value = "0.3*sigma_c", unit = "MPa", scatter = 0.05 }
[stage.calibrate]
kind = "calibrate"
simulators = ["compression", "splitting"]
factors = ["sigma_c", "Ec"]
targets = [{ UCS = "80 MPa", E = "40 GPa", sigma_t = { at_least = "5 MPa" } }]
evaluations = 32
unmet = "fail"
[stage.verify]
kind = "verify"
solution = "calibrate"
simulators = ["compression", "splitting"]
"#;

/// Two tests over three orders of magnitude; a strength ratio that the law cannot have ends the run with 1, each time it
/// is asked, and its evaluations can be looked at.
#[test]
fn unmet_targets_end_a_run_with_one_and_say_what_can_be_had() {
    let space = Space::new();
    space.write("w.toml", ROCK);
    space.run(&[]);
    let rows: Value = serde_json::from_str(&space.stdout(&["show", "w.toml", "verify", "--json"])).expect("JSON");
    assert!(rows.to_string().contains("sigma_t"), "{rows}");
    let run = space.stdout(&["show", "w.toml", "calibrate[2]"]);
    assert!(run.contains("sigma_t"), "the splitting test of the first evaluation: {run}");
    let targets = "stage.calibrate.targets=[{ UCS = \"80 MPa\", E = \"40 GPa\", sigma_t = \"30 MPa\" }]";
    let brittle = ["run", "w.toml", "calibrate", "--json", "--set", targets];
    for _ in 0..2 {
        let ended = space.flow(&brittle);
        assert_eq!(ended.status.code(), Some(1), "{}", told(&ended));
        let document: Value = serde_json::from_slice(&ended.stdout).expect("JSON");
        let stages = document["stages"].as_array().expect("stages");
        let unmet = stages.iter().find(|stage| stage["name"] == "calibrate").map(|stage| stage["unmet"].to_string());
        assert!(unmet.as_ref().is_some_and(|why| why.contains("sigma_t is expected")), "{unmet:?}");
        assert!(told(&ended).contains("unmet: calibrate: "), "{}", told(&ended));
    }
}
