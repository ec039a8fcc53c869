use super::*;
use crate::stage::{FileInput, Library, Outcome};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

struct NoLibrary(Option<FileInput>);

impl Library for NoLibrary {
    fn load(&self, _: &crate::artifact::ContentHash) -> Result<Arc<Artifact>, StageError> {
        Err(StageError::new("nothing is stored"))
    }
    fn outcome(&self, _: &Task) -> Option<Outcome> {
        None
    }
    fn file(&self, _: &str, _: &str) -> Result<FileInput, StageError> {
        self.0.clone().ok_or_else(|| StageError::new("no file"))
    }
}

fn context() -> Context {
    let mut context = Context { seed: 7, ..Default::default() };
    let factor = |unit: &str, levels: &[f64], range| crate::stage::Factor {
        unit: unit.into(),
        levels: levels.to_vec(),
        range,
        ..Default::default()
    };
    for (name, f) in [
        ("Ec", factor("GPa", &[10.0, 20.0, 30.0], None)),
        ("kn_ks", factor("", &[1.0, 2.5, 4.0], None)),
        ("mu", factor("", &[0.1, 1.0, 1.5], None)),
        ("sigma_c", factor("MPa", &[], Some([10.0, 30.0]))),
        ("tau_c", factor("MPa", &[10.0, 20.0, 30.0], Some([5.0, 35.0]))),
    ] {
        context.factors.insert(name.into(), f);
    }
    context
}

fn stage(text: &str) -> Design {
    toml::from_str(text).unwrap_or_else(|e| panic!("{e}"))
}

fn task(text: &str) -> Task {
    let context = context();
    let known = Known { name: "design", context: &context, inputs: vec![], library: &NoLibrary(None) };
    match stage(text).next(&known).unwrap() {
        Step::Finish(task) => task,
        Step::Ask(..) => panic!("a design asks for nothing"),
    }
}

fn ran(text: &str) -> Artifact {
    let task = task(text);
    let job = Job { params: &task.params.value(), seed: task.seed, inputs: &[], files: &[], ..blank() };
    run(&job).unwrap_or_else(|_| panic!("the design failed"))
}

/// A job without anything.
fn blank() -> Job<'static> {
    static STOP: AtomicBool = AtomicBool::new(false);
    static NOTHING: Value = Value::Null;
    Job {
        params: &NOTHING,
        seed: None,
        inputs: &[],
        files: &[],
        threads: &|| 1,
        time_limit: None,
        say: &|_| {},
        stop: &STOP,
    }
}

fn complaints(text: &str) -> Vec<String> {
    let hint = |c: Complaint| format!("{}: {} | {}", c.path.join("."), c.message, c.hint.unwrap_or_default());
    stage(text).check(&context()).into_iter().map(hint).collect()
}

#[test]
fn the_tables_hold_factors_in_their_units_and_the_report() {
    let made = ran("method = \"central-composite\"\nfactors = [\"sigma_c\", \"kn_ks\"]\ncentre_points = 3");
    let design = made.table("design").unwrap();
    assert_eq!((design.rows(), design.column("sigma_c").unwrap().unit.as_str()), (11, "MPa"));
    assert_eq!(design.shown("kn_ks").unwrap().0[..4], [1.0, 1.0, 4.0, 4.0]);
    assert_eq!(design.shown("sigma_c").unwrap().0[4], 5.85786437627);
    assert_eq!(design.shown("replicate").unwrap().0[8..], [1.0, 2.0, 3.0]);
    assert_eq!(made.table("coded").unwrap().shown("kn_ks").unwrap().0[7], 2.0_f64.sqrt());
    let report = made.table("report").unwrap();
    assert!(report.column("text").is_some() && report.rows() > 10);
}

/// The golden hash: a change of it means that results of this stage changed.
#[test]
fn results_are_pinned() {
    let made = ran("method = \"orthogonal\"\nfactors = [\"Ec\", \"kn_ks\", \"mu\"]");
    let sample = ran("method = \"latin-hypercube\"\nfactors = [\"Ec\", \"kn_ks\"]\nruns = 6\norder = \"random\"");
    let hashes = [made, sample].map(|a| a.content_hash().to_string()[..16].to_owned());
    assert_eq!(hashes, ["ec93a2a57eda8531", "6b75d1de830d62ab"]);
}

#[test]
fn only_what_decides_the_table_is_in_the_task() {
    let plain = "method = \"orthogonal\"\nfactors = [\"Ec\", \"kn_ks\"]";
    assert_eq!(task(plain).seed, None);
    assert_eq!(task(&format!("{plain}\norder = \"random\"")).seed, Some(7));
    assert_eq!(task("method = \"sobol\"\nruns = 8\nfactors = [\"Ec\"]").seed, Some(7));
    assert_eq!(task("method = \"sobol\"\nruns = 8\nscramble = false\nfactors = [\"Ec\"]").seed, None);
    let factor = |name: &str, unit: &str, levels: [f64; 3]| json!({ "name": name, "unit": unit, "domain": { "levels": levels } });
    let factors = json!([factor("Ec", "GPa", [10.0, 20.0, 30.0]), factor("kn_ks", "", [1.0, 2.5, 4.0])]);
    assert_eq!(task(plain).params.value(), json!({ "design": { "method": "orthogonal" }, "factors": factors }));
    let alpha = |text: &str| {
        task(&format!("method = \"central-composite\"\nalpha = {text}\nfactors = [\"Ec\", \"kn_ks\"]")).params.value()["design"]
            .clone()
    };
    assert_eq!(alpha("\"rotatable\""), json!({ "method": "central-composite" }));
    assert_eq!(alpha("\"face\"")["alpha"], json!("face"));
    assert_eq!(alpha("1.25")["alpha"], json!(1.25));
}

#[test]
fn each_method_takes_levels_or_the_range() {
    let domain = |method: &str, factor: &str| {
        let design = stage(&format!("method = \"{method}\"\nruns = 8\nfactors = [\"{factor}\"]"));
        design.factors(&context())[0].domain.clone()
    };
    use design::Domain::{Levels, Range};
    assert_eq!(domain("orthogonal", "tau_c"), Levels(vec![10.0, 20.0, 30.0]));
    assert_eq!(domain("orthogonal", "sigma_c"), Range { low: 10.0, high: 30.0 });
    assert_eq!(domain("plackett-burman", "Ec"), Range { low: 10.0, high: 30.0 });
    assert_eq!(domain("sobol", "tau_c"), Range { low: 5.0, high: 35.0 });
    assert_eq!(domain("box-behnken", "Ec"), Levels(vec![10.0, 20.0, 30.0]));
    assert_eq!(domain("box-behnken", "tau_c"), Range { low: 5.0, high: 35.0 });
}

#[test]
fn faults_stand_at_their_key_with_the_remedy() {
    let has = |text: &str, parts: &[&str]| {
        let found = complaints(text);
        for part in parts {
            assert!(found.iter().any(|c| c.contains(part)), "{part} not in {found:#?}");
        }
    };
    has(
        "method = \"box-behnken\"\nfactors = [\"Ec\", \"kn_ks\", \"xi\"]\ntable = \"L9\"",
        &[
            "table: `table` has no effect with the method `box-behnken` | its options are centre_points",
            "factors: `xi` is not",
        ],
    );
    has(
        "method = \"box-behnken\"\nfactors = [\"Ec\", \"kn_ks\", \"mu\"]",
        &["factors: factor `mu` has the middle level 1"],
    );
    has(
        "method = \"box-behnken\"\nfactors = [\"Ec\", \"kn_ks\"]",
        &["2 factors; blocks are published for 3 to 7 factors | use a central"],
    );
    has("method = \"orthogonal\"\nfactors = [\"Ec\", \"Ec\"]", &["factors: factor `Ec` is named twice"]);
    has("method = \"orthogonal\"\ntable = \"nine\"\nfactors = [\"Ec\"]", &["table: `table` is \"nine\" | write it as"]);
    has("method = \"sobol\"\nfactors = [\"Ec\"]", &["runs: the number of points is missing"]);
    has("method = \"given\"\nfactors = [\"Ec\"]", &["method: given rows need `rows` or `file`"]);
    has("method = \"given\"\nfactors = [\"Ec\"]\nrows = [[15]]", &["rows: row 1: `Ec` is 15"]);
    has(
        "method = \"full-factorial\"\nfactors = []\nreplicates = 0\npower = { noise = 0.0, alpha = 1.0 }",
        &["replicates: ", "power.noise: the noise is 0", "power.alpha: "],
    );
    has("method = \"full-factorial\"\nfactors = []", &["factors: the design has no factors"]);
}

#[test]
fn axial_points_below_zero_are_refused_before_anything_runs() {
    let mut context = context();
    let ranged = |range, sets: &[&str]| crate::stage::Factor {
        unit: "GPa".into(),
        range: Some(range),
        sets: sets.iter().map(|&path| path.to_owned()).collect(),
        ..Default::default()
    };
    context.factors.insert("E".into(), ranged([1.0, 30.0], &["mortar.Ec"]));
    context.factors.insert("T".into(), ranged([1.0, 30.0], &[]));
    let found = |text: &str| stage(&format!("method = \"central-composite\"\n{text}")).check(&context);
    let [fault] = &found("factors = [\"E\", \"sigma_c\"]")[..] else { panic!("one fault") };
    assert_eq!(fault.message, "row 5: the axial point puts `E` to −5.01 GPa, beyond its range and below zero");
    assert!(fault.hint.as_ref().unwrap().contains("extent = \"axial\""));
    // a temperature may be below zero, and an inscribed design stays within the range
    assert!(found("factors = [\"T\", \"sigma_c\"]").is_empty());
    assert!(found("extent = \"axial\"\nfactors = [\"E\", \"sigma_c\"]").is_empty());
}

#[test]
fn unknown_keys_and_methods_are_refused_by_the_reader() {
    let error = |text: &str| toml::from_str::<Design>(text).unwrap_err().to_string();
    assert!(error("method = \"taguchi\"\nfactors = []").contains("expected one of `full-factorial`"));
    assert!(error("method = \"sobol\"\nfactors = []\nrunes = 8").contains("unknown field `runes`"));
}

#[test]
fn rows_of_a_file_are_converted_to_the_factors_units() {
    let table = data::parse(b"note,Ec [MPa],kn_ks\na,10000,2.5\nb,20000,1\n").unwrap();
    let design = stage("method = \"given\"\nfile = \"rows.csv\"\nfactors = [\"Ec\", \"kn_ks\"]");
    let factors = design.factors(&context());
    assert_eq!(rows(&table, &factors, false).unwrap(), [[10.0, 2.5], [20.0, 1.0]]);
    let message = |text: &[u8]| rows(&data::parse(text).unwrap(), &factors, false).unwrap_err().message;
    assert!(message(b"Ec [mm],kn_ks\n1,2\n").contains("is in `mm` and cannot be read in `GPa`"));
    assert!(message(b"Ec [GPa]\n1\n").contains("no column `kn_ks`"));
    assert!(message(b"Ec [GPa],kn_ks\n1,x\n").contains("row 1: `kn_ks` is `x`, which is not a finite number"));
    let numbers = data::parse(b"Ec,kn_ks\n1,3\n").unwrap();
    assert_eq!(rows(&numbers, &factors, true).unwrap(), [[1.0, 3.0]]);
}

#[test]
fn rows_by_level_are_checked_and_set() {
    let design = |rows: &str| {
        format!("method = \"given\"\nby_level = true\nrows = {rows}\nfactors = [\"Ec\", \"kn_ks\", \"tau_c\"]")
    };
    let made = ran(&design("[[1, 3, 2]]"));
    let table = made.table("design").unwrap();
    assert_eq!(["Ec", "kn_ks", "tau_c"].map(|f| table.shown(f).unwrap().0[0]), [10.0, 4.0, 20.0]);
    assert!(complaints(&design("[[1, 3, 2]]")).is_empty());
    assert!(
        complaints(&design("[[1, 4, 2]]"))[0].contains("rows: row 1: `kn_ks` is 4 | its levels are numbered 1 to 3")
    );
}
