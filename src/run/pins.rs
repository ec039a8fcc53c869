//! A pinned result of every kind of stage and of every work, on the smallest workflow that has them all.
//!
//! When a pin fails, either the change was a mistake, or the numbers moved on purpose: then raise the version of the work
//! with a line that says what moved, and replace the pins with what the test prints.

use super::{RunSettings, Silent, StageStatus, run};
use crate::plan::{Overrides, load};
use crate::stage::KINDS;
use crate::store::Store;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::sync::atomic::AtomicBool;

const WORKFLOW: &str = r#"
[workflow]
seed = 5

[factor]
a = { sets = "mortar.a", unit = "GPa", levels = [1, 2, 3] }
b = { sets = "mortar.b", levels = [10, 20, 30] }
confining = { unit = "MPa", levels = [0, 5, 10, 20] }

[response]
y = { unit = "MPa" }
sigma_1 = { unit = "MPa" }

[material.plain]
mortar = { a = "1 GPa", b = 10 }

[material.bonded]
mortar = { Ec = "20 GPa", kn_ks = 2.5, sigma_c = "20 MPa", tau_c = "20 MPa", mu = 1 }
aggregate = { Ec = "30 GPa", kn_ks = 2, mu = 1 }
interface = { Ec = "10 GPa", kn_ks = 2.5, sigma_c = "15 MPa", tau_c = "15 MPa", mu = 1 }

[stage.specimen]
kind = "specimen"
width = "20 mm"
height = "40 mm"
porosity = 0.12
mean_radius = "1.5 mm"
radius_ratio = 2
density = "2000 kg/m^3"

[stage.simulate]
kind = "simulate"
specimen = "specimen"
material = "bonded"
test = "uniaxial"
platen_speed = "0.3 m/s"
masses = "equal-step"

[stage.design]
kind = "design"
method = "full-factorial"
factors = ["a", "b"]

[stage.formula]
kind = "formula"
design = "design"
material = "plain"
responses.y = { value = "3*a + b*b/100 + 7", unit = "MPa", scatter = 0.01 }

[stage.command]
kind = "command"
shell = true
run = ["printf '{\"y\": 5}' > out.json"]
read.y = { file = "out.json", pointer = "/y", unit = "MPa" }

[stage.data]
kind = "data"
file = "data.csv"

[stage.shapes]
kind = "shapes"
sections = "sections.csv"
within = { inertia = 0.1 }

[stage.range]
kind = "range"
table = "formula"

[stage.anova]
kind = "anova"
table = "formula"

[stage.screening]
kind = "screening"
table = "data"

[stage.regression]
kind = "regression"
table = "formula"
terms.y = ["a", "b"]

[stage.rsm]
kind = "rsm"
tables = ["formula"]
responses = ["y"]

[stage.calibrate]
kind = "calibrate"
surfaces = "rsm"
factors = ["a", "b"]
targets = [{ y = "16 MPa" }]
evaluations = 200
solutions = 5

[stage.verify]
kind = "verify"
solution = "calibrate"
simulator = "formula"
replicates = 2

[stage.effort]
kind = "effort"
of = "calibrate"

[stage.agreement]
kind = "agreement"
of = "formula"
compare = "data"

[stage.table]
kind = "table"
of = "anova"

[stage.figure]
kind = "figure"
show = "dag"
of = "table"

[stage.confinements]
kind = "design"
method = "full-factorial"
factors = ["confining"]

[stage.strengths]
kind = "formula"
design = "confinements"
responses.sigma_1 = { value = "confining + 150*sqrt(1 + 25*confining/150)", unit = "MPa", scatter = 0.02 }

[stage.envelope]
kind = "envelope"
table = "strengths"
confinement = "confining"
"#;

const DATA: &str = "a [GPa],b,y [MPa]\n1,10,11\n3,10,17\n1,30,19\n3,30,25.5\n";

const SECTIONS: &str = "shape,position [mm],thickness [mm],height [mm]\nslab,0,20,8\nslab,15,24,10\nslab,30,18,8\n";

/// Stage and the first digits of the hash of its result, then work and version.
const PINS: &str = "\
specimen 3dc1aee5970f
simulate 0fef41b28042
design 4707cd1886b9
formula c57272d7c660
command ab7cb869a592
data 76fbb067e6c6
shapes c041015d0836
range c56236dde0d0
anova 2a92fd32596a
screening a2868be9d3d3
regression 5bbcfc4bea7d
rsm 592833ad92f1
calibrate e38b40d330ef
verify 38b0cc910644
effort cf49a99b0418
agreement 7abe77c0ea84
table c2566245f62a
figure e5375085b080
confinements 9c0bb1671473
strengths de63dd9b98f3
envelope 18e99f63e7b2
agreement 3
anova 4
calibrate 7
command 2
data 4
design 3
effort 1
envelope 1
figure 19
fit 4
formula 2
gather 2
groups 5
mix 1
range 3
screening 5
shapes 1
simulate 4
specimen 2
table 9
verify 4
";

/// What the workflow gives, in the form of the pins.
fn found() -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pins.toml");
    std::fs::write(&path, WORKFLOW).unwrap();
    std::fs::write(folder.path().join("data.csv"), DATA).unwrap();
    std::fs::write(folder.path().join("sections.csv"), SECTIONS).unwrap();
    let workflow = load(&path, &Overrides::default());
    let workflow = workflow.unwrap_or_else(|faults| {
        panic!("{}", faults.iter().map(|fault| fault.message.clone()).collect::<Vec<_>>().join("\n"))
    });
    let kinds: BTreeSet<&str> = workflow.stages.iter().map(|stage| stage.kind).collect();
    let store = Store::open(&folder.path().join("store")).unwrap();
    let settings = RunSettings {
        jobs: 2,
        keep_going: true,
        dry: false,
        targets: Vec::new(),
        again: Vec::new(),
        memos: false,
        cluster: None,
    };
    let report = run(&workflow, &store, &settings, &Silent, &AtomicBool::new(false));
    let mut text = String::new();
    for stage in &report.stages {
        let result = match &stage.status {
            StageStatus::Done(content) => content.to_string()[..12].to_owned(),
            other => format!("{other:?}"),
        };
        writeln!(text, "{} {result}", stage.name).unwrap();
    }
    // The kind that only tests know has no results to pin.
    let pinned = || KINDS.iter().filter(|kind| kind.name != "census");
    for kind in pinned() {
        assert!(
            kinds.contains(kind.name),
            "give `{}` a stage in this workflow, so that its result is pinned",
            kind.name
        );
    }
    let works: BTreeSet<String> =
        pinned().flat_map(|kind| kind.works).map(|work| format!("{} {}", work.name, work.version)).collect();
    works.iter().for_each(|work| writeln!(text, "{work}").unwrap());
    text
}

#[test]
fn results_stay_what_they_are_while_versions_do() {
    let found = found();
    assert_eq!(found, PINS, "\nfound:\n{found}");
}
