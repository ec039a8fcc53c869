//! `kind = "command"`: an external program as simulator, wherever a `simulate` stage can stand.
//!
//! For every row of the design (or once, without a design) the program runs in a folder of its own: files are copied
//! there, templates are filled with the row's parameters, the command is started without a shell (unless asked for),
//! with no standard input, with `PATH`, the declared environment, `FLOW_RUN_FOLDER` (its folder) and nothing else; then the
//! responses are read from its files (CSV, JSON, or a pattern on a text file). Command, templates, files and parameters are
//! in the key, the time limit is not.
//!
//! A template names values in double braces: `{{mortar.Ec}}` (parameter, SI), `{{Ec}}` (factor, in its unit),
//! `{{seed}}`, `{{replicate}}`. The seed differs from row to row and from replicate to replicate and follows from the
//! workflow's; the number of the replicate is the same in all rows, for programs that make the specimen themselves and
//! shall compare rows on the same one.
//!
//! Numbers are read as C and Fortran write them. A value that the program itself calls `NaN` (or `null` in JSON) is a
//! missing response, which a warning of the run names; a run that leaves no value at all has failed.
//!
//! A program that ends with another code than 0, does not write a file or writes an unreadable one has failed. Its task is
//! not stored and runs again next time; with `on_failure = "record"` it is a result with a reason, like a simulation without
//! a peak. `validity` and `cautions` name the texts in which the program says that a run is not valid, or needs caution.
//! Text files may have any encoding: one with the mark of UTF-16 is read as UTF-16, and in others a byte that is not UTF-8
//! is shown as `\\xE9`. A run that exceeds its time limit or is stopped is never recorded, because that does not depend on
//! the model alone.

mod folder;
mod json;
pub mod leftover;
mod lineage;
mod number;
mod read;
mod template;
mod verdict;

use super::beside::{Beside, read};
use super::forecast::{Ahead, Forecast, TaskForecast};
use super::rows::{self, GATHER};
use super::{
    AtOnce, Class, Complaint, Context, Failure, Job, Kind, Known, Point, Port, Progress, Sketch, Stage, StageError,
    Step, Task, Work,
};
use crate::artifact::run::{Responses, Run};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use crate::unit;
use math::random::Stream;
use read::Read;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use verdict::ReadText;

/// Settings of a `command` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Command {
    /// Program and arguments, such as `["python3", "engine.py", "input.json"]`; with `shell` one text for `sh -c`.
    pub run: Vec<String>,
    /// Whether a shell runs the one text of `run`.
    #[serde(default)]
    pub shell: bool,
    /// The design whose rows are run; without it there is one run.
    pub design: Option<String>,
    /// The `[material.NAME]` whose parameters rows vary and templates may name.
    pub material: Option<String>,
    /// Files that are copied into the folder: name in the folder = file beside the workflow.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
    /// Templates filled with the row's values: name in the folder = file beside the workflow.
    #[serde(default)]
    pub templates: BTreeMap<String, String>,
    /// Environment variables besides `PATH`.
    #[serde(default)]
    pub environment: BTreeMap<String, String>,
    /// Longest time of a run; a run that takes longer is ended and has failed.
    pub time_limit: Option<unit::Time>,
    /// Most runs of the program at once, such as the number of its licences; by default as many as `--jobs` allows.
    /// Stages that run the same program share the number, and such runs stay on this machine.
    pub at_once: Option<usize>,
    /// Whether a failed run stops the campaign or is recorded with its reason.
    #[serde(default)]
    pub on_failure: OnFailure,
    /// How to read each response, by its name.
    pub read: BTreeMap<String, Read>,
    /// Where the program says why a run is not valid; such a run is treated like a test of `simulate` that does not meet its
    /// checks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validity: Option<ReadText>,
    /// Where the program says why the numbers of a run need caution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cautions: Option<ReadText>,
}

/// What to do with a run that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OnFailure {
    /// The task failed; it runs again next time.
    #[default]
    Stop,
    /// The run is a result without responses, with the reason.
    Record,
}

#[derive(Serialize, Deserialize)]
struct Params {
    run: Vec<String>,
    #[serde(default, skip_serializing_if = "is_false")]
    shell: bool,
    environment: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "stops")]
    on_failure: OnFailure,
    read: BTreeMap<String, Read>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    validity: Option<ReadText>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cautions: Option<ReadText>,
    /// Parameters and factors by the name that templates use.
    values: BTreeMap<String, f64>,
    replicate: u64,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

fn stops(on_failure: &OnFailure) -> bool {
    *on_failure == OnFailure::Stop
}

impl Stage for Command {
    fn inputs(&self) -> Vec<Port> {
        let design = Port {
            key: "design",
            stages: self.design.iter().cloned().collect(),
            accepts: Accepts::Only(&[ArtifactKind::DESIGN]),
        };
        if self.design.is_some() { vec![design] } else { Vec::new() }
    }

    fn gives(&self) -> ArtifactKind {
        if self.design.is_some() { ArtifactKind::RESULTS } else { ArtifactKind::RUN }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = rows::check_units(context);
        if self.run.is_empty() || self.run[0].trim().is_empty() {
            found.push(Complaint::new("run", "no program is named").hint("run = [\"program\", \"argument\"]"));
        }
        if self.shell && self.run.len() > 1 {
            found.push(Complaint::new("run", "with `shell` the command is one text").hint("run = [\"a | b\"]"));
        }
        if let Some(limit) = self.time_limit.filter(|limit| !(limit.get() > 0.0)) {
            let message = format!("a run cannot be ended after {} s", limit.get());
            found.push(Complaint::new("time_limit", message).hint("give a time above 0, such as \"30 min\""));
        }
        if self.at_once == Some(0) {
            let message = "no run could ever start";
            found.push(Complaint::new("at_once", message).hint("give the number of licences: at_once = 1"));
        }
        let nul = |text: &String| text.contains('\0');
        if self.run.iter().chain(self.environment.values()).any(nul) {
            found.push(Complaint::new("run", "no program takes an argument or a variable with a zero byte"));
        }
        for name in self.environment.keys().filter(|name| name.is_empty() || name.contains(['=', '\0'])) {
            found.push(Complaint::new("environment", format!("`{name}` cannot be the name of a variable")));
        }
        if self.environment.contains_key(leftover::VARIABLE) {
            let message = format!("`{}` is set by flow: it names the folder of the run", leftover::VARIABLE);
            found.push(Complaint::new("environment", message).hint("leave it out"));
        }
        let values = self.values(context);
        if let Some(name) = self.run.iter().find_map(|argument| placeholder(argument, &values)) {
            let message = format!("`{{{{{name}}}}}` is filled in templates, not in `run`");
            let hint = "put the value into a file of `templates` that the program reads";
            found.push(Complaint::new("run", message).hint(hint));
        }
        found.extend(rows::check_material(self.material.as_ref(), context));
        found.extend(self.check_names());
        if self.read.is_empty() {
            found.push(Complaint::new("read", "no response is read").hint("add [stage.NAME.read.RESPONSE]"));
        }
        found.extend(self.read.iter().flat_map(|(name, read)| read.check(name, context)));
        let verdicts = [("validity", &self.validity), ("cautions", &self.cautions)];
        found.extend(verdicts.into_iter().flat_map(|(key, read)| read.iter().flat_map(move |read| read.check(key))));
        found
    }

    fn beside(&self, context: &Context, found: &mut Beside) {
        for (key, files) in [("files", &self.files), ("templates", &self.templates)] {
            for (name, path) in files {
                let Some(full) = found.file(&format!("{key}.{name}"), path) else { continue };
                // A template that is not text is reported when it is filled.
                let text = (key == "templates")
                    .then(|| read(&full).ok().and_then(|bytes| String::from_utf8(bytes).ok()))
                    .flatten();
                if let Some(fault) = text.and_then(|text| template::fault(&text, || self.values(context))) {
                    let complaint = Complaint::new(key, format!("{path}, {}", fault.message));
                    found.faults.push(Complaint { hint: fault.hint, ..complaint });
                }
            }
        }
        self.outside(found);
    }

    fn sketch(&self) -> Sketch {
        let responses = Some(self.read.keys().cloned().collect());
        Sketch { material: self.material.clone(), responses, varies: true, ..Sketch::default() }
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        let rows = Forecast::of_design(ahead, |_, _| TaskForecast::Exactly(0));
        Forecast { seconds: None, run_seconds: None, ..rows }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        rows::fan_out(self, known)
    }

    fn sample(&self, known: &Known, point: &Point, number: u64) -> Result<Task, StageError> {
        let mut values = rows::values(self.material.as_ref(), point, known.context)?;
        // A template may name a factor that sets nothing of a material.
        values.extend(point.iter().map(|(name, value)| (name.clone(), *value)));
        let seed = row_seed(known.context.seed, &values, number);
        let params = Params {
            run: self.run.clone(),
            shell: self.shell,
            environment: self.environment.clone(),
            on_failure: self.on_failure,
            read: self.read.clone(),
            validity: self.validity.clone(),
            cautions: self.cautions.clone(),
            values,
            replicate: number,
        };
        let mut task = Task::new("command", json!(params)).seed(seed);
        for (kind, files) in [("file", &self.files), ("template", &self.templates)] {
            for (name, path) in files {
                task.files.push(known.library.file(&format!("{kind}:{name}"), path)?);
            }
        }
        task.time_limit = self.time_limit.map(unit::Quantity::get);
        task.at_once = self.at_once.map(|most| Arc::new(AtOnce { program: self.run[0].clone(), most }));
        Ok(task)
    }
}

impl Kind for Command {
    const NAME: &'static str = "command";
    const ABOUT: &'static str = "an external program, once or per design row";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS, ArtifactKind::RUN];
    const CLASS: Class = Class::Simulation;
    // Version 2: Fortran's numbers and missing values are read; the seed is the row's own.
    const WORKS: &'static [Work] = &[Work { name: "command", version: 2, run: execute }, GATHER];
    const FAR: Option<&'static str> = Some("command");
}

impl Command {
    /// Faults of the names of files in the folder of a run.
    fn check_names(&self) -> Vec<Complaint> {
        let mut found = Vec::new();
        let names = || self.files.keys().chain(self.templates.keys());
        for name in self.files.keys().filter(|name| self.templates.contains_key(*name)) {
            found.push(Complaint::new("templates", format!("`{name}` stands in `files` and in `templates`")));
        }
        for name in names().filter(|name| OUTPUT.contains(&name.split('/').next().unwrap_or(name))) {
            let message = format!("`{name}` is where the run's own output goes");
            found.push(Complaint::new("", message).hint("give the file another name"));
        }
        for name in names().filter(|name| !folder::is_plain(name)) {
            let message = format!("`{}` must be a plain name inside the run's folder", name.escape_debug());
            found.push(Complaint::new("", message).hint("leave out `..` and a leading `/`, and take a short name"));
        }
        for name in names() {
            if let Some(below) = names().find(|other| Path::new(other).parent().is_some_and(|p| p.starts_with(name))) {
                let message = format!("`{name}` is a file, and the folder in which `{below}` lies");
                found.push(Complaint::new("", message).hint("give one of them another name"));
            }
        }
        found
    }

    /// Every name that a template may use.
    fn values(&self, context: &Context) -> Vec<String> {
        let material = self.material.iter().filter_map(|name| context.materials.get(name));
        let names = context.factors.keys().cloned().chain(["seed", "replicate"].map(str::to_owned));
        material.flat_map(|material| material.paths()).chain(names).collect()
    }

    /// Warnings about words of the command that name files beside the workflow, or by their whole path: they are in no key, so
    /// that a result stays as it was when they change.
    fn outside(&self, found: &mut Beside) {
        let words: Vec<&str> = match self.shell {
            true => self
                .run
                .iter()
                .flat_map(|text| text.split(|c: char| c.is_whitespace() || "'\"();|&<>=".contains(c)))
                .collect(),
            false => self.run.iter().map(String::as_str).collect(),
        };
        let mut told = BTreeSet::new();
        for word in words {
            let known = self.files.contains_key(word) || self.templates.contains_key(word);
            // Systems' own programs and devices are many, and change with the system.
            let system = ["/bin/", "/usr/", "/dev/", "/proc/"].iter().any(|folder| word.starts_with(folder));
            if known || system || !told.insert(word) || found.named(word).is_none() {
                continue;
            }
            let message = match Path::new(word).is_absolute() {
                true => {
                    format!("`{word}` is a file outside the key of this stage: its results stay when the file changes")
                }
                false => {
                    format!("`{word}` lies beside the workflow, but a run has a folder of its own, where it is not")
                }
            };
            let name = Path::new(word).file_name().map_or(word.into(), |name| name.to_string_lossy());
            let hint = format!(
                "copy it with `files = {{ \"{name}\" = \"{word}\" }}`, or say `flow run … --again STAGE` after a change"
            );
            found.warnings.push(Complaint::new("run", message).hint(hint));
        }
    }
}

/// Files of a run with the output of the program.
const OUTPUT: [&str; 2] = ["stdout", "stderr"];

/// The first `{{name}}` in the text that names a value; other braces belong to the program.
fn placeholder<'a>(text: &'a str, values: &[String]) -> Option<&'a str> {
    let mut within = text.split("{{").skip(1).filter_map(|rest| Some(rest.split_once("}}")?.0));
    within.find(|name| values.iter().any(|value| value == name.trim()))
}

/// Largest seed: the generators of some engines take no larger one (LAMMPS: 900,000,000), and none takes 0.
const LARGEST_SEED: usize = 900_000_000;

/// The seed that templates of a run may name, from 1 on: it follows from the workflow's, the values and the replicate.
fn row_seed(seed: u64, values: &BTreeMap<String, f64>, replicate: u64) -> u64 {
    let mut stream = Stream::new(seed, &format!("command {}", json!(values)), replicate);
    1 + stream.below(LARGEST_SEED) as u64
}

fn execute(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let folder = folder::Folder::fill(job, &params)?;
    let outcome = match folder.run(job, &params)? {
        Ok(()) => given(&params, &folder),
        Err(reason) => Err(reason),
    };
    let run = match (outcome, params.on_failure) {
        (Ok(run), _) => run,
        (Err(reason), OnFailure::Record) => Run::plain(&reason, Responses::default()),
        (Err(reason), OnFailure::Stop) => return Err(StageError::new(reason).hint(folder.last_words()).into()),
    };
    run.warnings.iter().flatten().for_each(|words| (job.say)(Progress::warning(words)));
    Ok(run.to_artifact())
}

/// The responses of the program, and its texts on their validity.
fn given(params: &Params, folder: &folder::Folder) -> Result<Run, String> {
    let (responses, missing) = responses(&params.read, folder)?;
    let said = |read: &Option<ReadText>| read.as_ref().map(|read| read.reason(folder)).transpose();
    let (validity, cautions) = (said(&params.validity)?, said(&params.cautions)?);
    // With one of the two settings every run has a validity.
    let validity = validity.or_else(|| cautions.is_some().then(String::new));
    let warnings = (!missing.is_empty()).then_some(missing);
    Ok(Run { validity, cautions, warnings, ..Run::plain("", responses) })
}

/// Reads the files of a program: the responses, and a sentence on each response without a value.
fn responses(read: &BTreeMap<String, Read>, folder: &folder::Folder) -> Result<(Responses, Vec<String>), String> {
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for (name, read) in read {
        let value = read.value(folder)?.unwrap_or_else(|why| {
            missing.push(format!("`{name}` is missing: {why}"));
            f64::NAN
        });
        found.push((name.as_str(), value, read.unit()));
    }
    if missing.len() == found.len() { Err(missing.join("; ")) } else { Ok((Responses::of(&found), missing)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seed_of_a_run_is_its_own_and_every_engine_takes_it() {
        let values = |ec: f64| BTreeMap::from([("rock.Ec".to_owned(), ec)]);
        let all = [(7, 1.0, 1), (7, 2.0, 1), (7, 1.0, 2), (8, 1.0, 1)];
        let seeds: BTreeSet<u64> = all.into_iter().map(|(seed, ec, run)| row_seed(seed, &values(ec), run)).collect();
        assert_eq!(seeds.len(), all.len());
        assert!(seeds.iter().all(|seed| (1..=900_000_000).contains(seed)), "{seeds:?}");
        assert_eq!(row_seed(7, &values(1.0), 1), row_seed(7, &values(1.0), 1));
    }
}
