//! Calibration through the stage, with a simulator and a library that live in memory.

mod several;

use super::*;
use crate::artifact::run::{Responses, Run};
use crate::artifact::{Artifact, ContentHash};
use crate::stage::{Factor, FileInput, Input, Job, Library, Memory, Outcome, Point, Progress, Response};
use math::random::Stream;
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// Runs tasks on first sight; `patience` tasks, then it says that nothing is known of others.
struct Laboratory {
    objects: RefCell<Vec<Arc<Artifact>>>,
    done: RefCell<Vec<(Task, Outcome)>>,
    patience: usize,
    model: Model,
    /// What the stage that asks is given to remember with, if anything.
    memory: Option<Memory>,
    /// How often an outcome was asked for.
    asked: Cell<usize>,
}

/// What a simulator gives at a point on a specimen: name, value and unit of each response.
type Model = fn(&str, &Point, u64) -> Result<Vec<(&'static str, f64, &'static str)>, String>;

impl Laboratory {
    fn new(patience: usize, model: Model) -> Self {
        Self {
            objects: RefCell::default(),
            done: RefCell::default(),
            patience,
            model,
            memory: None,
            asked: Cell::new(0),
        }
    }

    fn put(&self, artifact: Artifact) -> ContentHash {
        let content = artifact.content_hash();
        self.objects.borrow_mut().push(Arc::new(artifact));
        content
    }

    fn run(&self, task: &Task) -> Outcome {
        let point: Point = serde_json::from_value(task.params.value()["point"].clone()).unwrap();
        let number = task.params.value()["number"].as_u64().unwrap();
        let params = task.params.value();
        let lab = params["lab"].as_str().unwrap();
        let (responses, failure) = match (self.model)(lab, &point, number) {
            Ok(responses) => (responses, String::new()),
            Err(failure) if failure == "crash" => return Outcome::Failed(failure),
            Err(check) if check == "rotation" => {
                let responses = Responses::of(&[("UCS", 1e6, "Pa"), ("E", 1e9, "Pa")]);
                let run = Run { validity: Some(check), ..Run::plain("", responses) };
                return Outcome::Done(self.put(run.to_artifact()));
            }
            Err(failure) => (Vec::new(), failure),
        };
        Outcome::Done(self.put(Run::plain(&failure, Responses::of(&responses)).to_artifact()))
    }

    fn simulations(&self) -> usize {
        self.done.borrow().len()
    }
}

impl Library for Laboratory {
    fn load(&self, content: &ContentHash) -> Result<Arc<Artifact>, StageError> {
        let objects = self.objects.borrow();
        let found = objects.iter().find(|object| object.content_hash() == *content);
        found.cloned().ok_or_else(|| StageError::new("no such object"))
    }

    fn outcome(&self, task: &Task) -> Option<Outcome> {
        self.asked.set(self.asked.get() + 1);
        // The row is for people: equal tasks are one, whichever row asks.
        let task = &Task { row: None, ..task.clone() };
        if let Some((_, outcome)) = self.done.borrow().iter().find(|(known, _)| known == task) {
            return Some(outcome.clone());
        }
        if self.simulations() >= self.patience {
            return None;
        }
        let outcome = self.run(task);
        self.done.borrow_mut().push((task.clone(), outcome.clone()));
        Some(outcome)
    }

    fn memory(&self) -> Option<&Memory> {
        self.memory.as_ref()
    }

    fn file(&self, _name: &str, path: &str) -> Result<FileInput, StageError> {
        Err(StageError::new(path))
    }
}

fn context() -> Context {
    let factor = |unit: &str, low, high| Factor { unit: unit.into(), range: Some([low, high]), ..Factor::default() };
    let response = |unit: &str| Response { unit: unit.into(), ..Response::default() };
    Context {
        seed: 4,
        factors: [
            ("sigma_c", factor("MPa", 10.0, 30.0)),
            ("Ec", factor("GPa", 10.0, 30.0)),
            ("mu", factor("", 0.1, 1.0)),
        ]
        .map(|(name, factor)| (name.to_owned(), factor))
        .into(),
        responses: [("UCS", response("MPa")), ("E", response("GPa"))].map(|(n, r)| (n.to_owned(), r)).into(),
        ..Context::default()
    }
}

fn known<'a>(context: &'a Context, laboratory: &'a Laboratory) -> Known<'a> {
    with_inputs(context, laboratory, &[("simulator", "lab", None)])
}

/// Inputs by key and stage, each with its artifact where it has one.
fn with_inputs<'a>(
    context: &'a Context,
    laboratory: &'a Laboratory,
    inputs: &[(&'static str, &'static str, Option<Artifact>)],
) -> Known<'a> {
    let input = |(key, stage, artifact): &(&'static str, &'static str, Option<Artifact>)| {
        let stage = *stage;
        let sample = move |point: &Point, number: u64| {
            Ok(Task::new("run", json!({ "lab": stage, "point": point, "number": number })))
        };
        Input {
            key,
            stage,
            content: artifact.clone().map_or(ContentHash([0; 32]), |artifact| laboratory.put(artifact)),
            vary: Box::new(|_, _| Ok(None)),
            replicate: Box::new(|_| None),
            sample: Box::new(sample),
        }
    };
    Known { name: "calibrate", context, inputs: inputs.iter().map(input).collect(), library: laboratory }
}

fn stage(text: &str) -> Calibrate {
    toml::from_str(text).unwrap()
}

const COLD: &str = r#"
    simulator = "lab"
    factors = ["sigma_c", "Ec", "mu"]
    targets = [{ UCS = "38 MPa", E = "31 GPa" }, { UCS = "30 MPa" }]
    evaluations = 24
    surrogate = { tolerance = 0.0 }
"#;

/// UCS = 2 σc, E = 1.5 Ec, each with 3 % scatter of its specimen.
fn scattering(_: &str, point: &Point, number: u64) -> Result<Vec<(&'static str, f64, &'static str)>, String> {
    let mut random = Stream::new(number, "lab", (point["mu"] * 1e6) as u64);
    let mut scatter = || 1.0 + 0.03 * random.normal();
    let (strength, modulus) = (2e6 * point["sigma_c"] * scatter(), 1.5e9 * point["Ec"] * scatter());
    Ok(vec![("UCS", strength, "Pa"), ("E", modulus, "Pa")])
}

/// What the work makes of a finishing task.
fn finished(laboratory: &Laboratory, task: &Task) -> Result<Artifact, String> {
    let inputs: Vec<(String, Arc<Artifact>)> = task
        .inputs
        .iter()
        .map(|(name, source)| match source {
            crate::stage::Source::Task(task) => match laboratory.outcome(task) {
                Some(Outcome::Done(content)) => (name.to_string(), laboratory.load(&content).unwrap()),
                other => panic!("{other:?}"),
            },
            crate::stage::Source::Content(content) => (name.to_string(), laboratory.load(content).unwrap()),
            crate::stage::Source::Placed => panic!("no runner took it"),
        })
        .collect();
    let (stop, say) = (std::sync::atomic::AtomicBool::new(false), |_: Progress| ());
    let (params, seed) = (&task.params.value(), task.seed);
    let job =
        Job { params, seed, inputs: &inputs, files: &[], threads: &|| 1, time_limit: None, say: &say, stop: &stop };
    solve::solve(&job).map_err(|failure| failure.to_string())
}

#[test]
fn simulations_in_the_loop_find_the_parameters_and_their_interval() {
    let (context, laboratory) = (context(), Laboratory::new(usize::MAX, scattering));
    let stage = stage(COLD);
    assert_eq!(stage.check(&context), Vec::new());
    let Step::Finish(task) = stage.next(&known(&context, &laboratory)).unwrap() else { panic!("it can go on") };
    // 24 for each set; the first batch of four knows no target yet, so both sets share it.
    assert_eq!(laboratory.simulations(), 2 * 24 - 4);
    let artifact = finished(&laboratory, &task).unwrap();
    let solution = artifact.table("solution").unwrap();
    let first = |name: &str| solution.shown(name).unwrap().0[0];
    assert!((first("sigma_c") / 19.0 - 1.0).abs() < 0.03, "{}", first("sigma_c"));
    assert!((first("Ec") / (31.0 / 1.5) - 1.0).abs() < 0.03, "{}", first("Ec"));
    assert_eq!((first("evaluations"), first("free")), (24.0, 1.0));
    let prediction = artifact.table("prediction").unwrap();
    let at = |name: &str| prediction.shown(name).unwrap().0;
    assert!((0..3).all(|i| at("low")[i] < at("expected")[i] && at("expected")[i] < at("high")[i]));
    let history = artifact.table("history").unwrap();
    assert_eq!(history.rows(), 48);
    let recommended = history.shown("recommended").unwrap().0;
    // One value per batch, and that of the solution at the end of each set.
    assert!(recommended[4] == recommended[7] && recommended[7] != recommended[8], "{recommended:?}");
    assert_eq!([recommended[23], recommended[47]], solution.shown("misfit").unwrap().0[..]);
    assert!(artifact.table("solution_set").unwrap().rows() >= 50);
}

/// Killed after any number of simulations, a calibration asks on as if nothing had happened.
#[test]
fn an_interrupted_calibration_goes_on_where_it_stood() {
    for memory in [None, Some(Memory::default())] {
        goes_on(memory);
    }
}

/// The same steps whether the stage remembers or walks its whole history each time.
fn goes_on(memory: Option<Memory>) {
    let (context, stage) = (context(), stage(COLD));
    let whole = Laboratory::new(usize::MAX, scattering);
    let Step::Finish(end) = stage.next(&known(&context, &whole)).unwrap() else { panic!("it can go on") };
    let mut broken = Laboratory { memory, ..Laboratory::new(0, scattering) };
    loop {
        let step = stage.next(&known(&context, &broken)).unwrap();
        match step {
            Step::Ask(tasks, note) => {
                assert!(!tasks.is_empty());
                let told = broken.simulations();
                assert!(told > 0 || note == "0/0 evaluations, misfit best –/–, recommended –/–", "{note}");
                assert!(tasks.iter().all(|task| {
                    whole.done.borrow().iter().any(|(known, _)| *known == Task { row: None, ..task.clone() })
                }));
                broken.patience += 7;
            }
            Step::Finish(task) => {
                assert_eq!(task, end);
                break;
            }
        }
    }
    assert_eq!(finished(&broken, &end).unwrap(), finished(&whole, &end).unwrap());
}

/// A stage that remembers asks for each outcome a few times, however long its history is; the steps are the same.
#[test]
fn a_long_history_is_walked_once() {
    let text = COLD.replace("surrogate = { tolerance = 0.0 }", "method = \"annealing\"").replace("24", "150");
    let (context, stage) = (context(), stage(&text));
    let walked = |memory: Option<Memory>| {
        let mut laboratory = Laboratory { memory, ..Laboratory::new(0, scattering) };
        loop {
            let step = stage.next(&known(&context, &laboratory)).unwrap();
            match step {
                Step::Ask(tasks, _) => laboratory.patience += tasks.len(),
                Step::Finish(task) => return (task, laboratory.asked.get()),
            }
        }
    };
    let ((plain, all), (remembered, few)) = (walked(None), walked(Some(Memory::default())));
    assert_eq!(plain, remembered);
    assert!(few <= 6 * 2 * 150 && all > 100 * 150, "{few} {all}");
}

#[test]
fn failed_simulations_are_recorded_and_when_all_fail_it_says_so() {
    let some: Model = |lab, point, number| match number % 6 {
        2 => Err("no peak".to_owned()),
        4 => Err("crash".to_owned()),
        _ => scattering(lab, point, number),
    };
    let (context, laboratory) = (context(), Laboratory::new(usize::MAX, some));
    let Step::Finish(task) = stage(COLD).next(&known(&context, &laboratory)).unwrap() else { panic!("it can go on") };
    let artifact = finished(&laboratory, &task).unwrap();
    let failed = artifact.table("solution").unwrap().shown("failed").unwrap().0;
    assert_eq!(failed, [8.0, 8.0]);
    let all = Laboratory::new(usize::MAX, |_, _, _| Err("no peak".to_owned()));
    let Step::Finish(task) = stage(COLD).next(&known(&context, &all)).unwrap() else { panic!("it can go on") };
    assert_eq!(finished(&all, &task).unwrap_err(), "all 24 simulations failed; the first: no peak");
}

/// A run that is not valid is an evaluation: it costs one, and is no value to fit.
#[test]
fn runs_that_are_not_valid_cost_an_evaluation_and_are_said() {
    let turned: Model = |lab, point, number| match number % 6 {
        2 => Err("rotation".to_owned()),
        _ => scattering(lab, point, number),
    };
    let with = |invalid: &str| {
        let (context, laboratory) = (context(), Laboratory::new(usize::MAX, turned));
        let step = stage(&format!("{invalid}\n{COLD}")).next(&known(&context, &laboratory));
        step.map(|step| match step {
            Step::Finish(task) => finished(&laboratory, &task).unwrap(),
            Step::Ask(..) => panic!("it can go on"),
        })
    };
    let column =
        |artifact: &Artifact, table: &str, name: &str| artifact.table(table).unwrap().texts(name).unwrap().to_vec();
    let left = with("").unwrap();
    let solution = left.table("solution").unwrap();
    assert_eq!(solution.shown("failed").unwrap().0, [4.0, 4.0]);
    assert_eq!(solution.shown("evaluations").unwrap().0, [24.0, 24.0]);
    assert!((solution.shown("sigma_c").unwrap().0[0] / 19.0 - 1.0).abs() < 0.05);
    let failures = column(&left, "history", "failure");
    assert_eq!(failures.iter().filter(|why| *why == "not valid: rotation").count(), 8);
    let notes = column(&left, "notes", "note");
    let wanted = "set 1: 4 of 24 evaluations gave no result: not valid: rotation (4)";
    assert!(notes.iter().any(|note| note == wanted), "{notes:?}");

    let kept = with("invalid = 'keep'").unwrap();
    assert_eq!(kept.table("solution").unwrap().shown("failed").unwrap().0, [0.0, 0.0]);
    assert_eq!(column(&kept, "history", "validity").iter().filter(|why| *why == "rotation").count(), 8);
    let notes = column(&kept, "notes", "note");
    assert!(notes.iter().any(|note| note.starts_with("set 1: 4 of 24 evaluations rest on runs")), "{notes:?}");
    assert_eq!(with("invalid = 'refuse'").err().unwrap().message, "a run is not valid: rotation");
}

#[test]
fn every_fault_of_the_settings_is_named() {
    let complaints = |text: &str| -> Vec<String> {
        stage(text).check(&context()).into_iter().map(|complaint| complaint.message).collect()
    };
    let nothing = "factors = [\"Ed\"]\npreference = { mu = 1 }\ngenetic = {}\nmethod = \"annealing\"";
    assert_eq!(
        complaints(nothing),
        [
            "unknown factor `Ed`",
            "unknown calibrated factor `mu`",
            "`genetic` has no effect with method `annealing`",
            "neither `surfaces` nor `simulator` is given",
            "no targets are given",
        ]
    );
    let units = "surfaces = \"s\"\nfactors = [\"Ec\"]\ntargets = [{ UCS = 30, E = \"3 kN\" }]";
    assert_eq!(
        complaints(units),
        ["set 1: target of `E`: \"3 kN\" is not a value in `GPa`; write for example \"30 GPa\""]
    );
    let zero = "surfaces = \"s\"\nfactors = [\"Ec\"]\ntargets = [{ UCS = \"0 MPa\" }]\nranges = { Ec = [3, 2] }";
    let found = complaints(zero);
    assert!(found[0].contains("the range of `Ec` is empty") && found[1].contains("target of `UCS` is 0"), "{found:?}");
    let apart = r#"surfaces = "s"
        factors = ["Ec", "sigma_c"]
        targets = [{ UCS = "30 MPa" }]
        constraints = [{ terms = { Ec = 1.0 }, at_most = 12 }, { terms = { Ec = -1.0, sigma_c = 1.0 }, at_most = -5 }]"#;
    assert!(complaints(apart)[0].contains("no point of the box meets"), "{:?}", complaints(apart));
    let curve = "surfaces = \"s\"\nfactors = [\"Ec\"]\ncurve = { strain = [0.001], stress = [\"5 MPa\"] }";
    assert_eq!(
        complaints(curve),
        ["surfaces give no curve; name a simulator", "surfaces give no curve; leave them out"]
    );
}
