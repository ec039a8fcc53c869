//! What the page shows, as plain data.

use crate::artifact::run::Run;
use crate::artifact::{Artifact, ArtifactKind, ContentHash};
use crate::stage::{Class, Context};
use crate::store::{Campaign, Origin};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A campaign as the page shows it.
#[derive(Clone, Debug)]
pub struct Paper {
    /// Title of the workflow, or its file's name.
    pub title: String,
    /// What it is about; may be empty.
    pub about: String,
    /// The workflow file as it was named.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The profile whose overrides apply.
    pub profile: Option<String>,
    /// Overrides as they were typed.
    pub sets: Vec<String>,
    /// The store as it was named; empty for the default.
    pub store: String,
    /// Seed, factors and responses.
    pub context: Context,
    /// Its stages in the order of the workflow.
    pub parts: Vec<Part>,
    /// Recorded runs of this workflow with these overrides, the last one last.
    pub runs: Vec<Campaign>,
}

/// A stage.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Its title, where the workflow gives one.
    pub title: Option<String>,
    /// Its kind.
    pub kind: String,
    /// Class of the kind.
    pub class: Class,
    /// One line on the kind.
    pub about: String,
    /// Its inputs: port, and which stage.
    pub inputs: Vec<(String, usize)>,
    /// Its settings in canonical form.
    pub settings: Value,
    /// Its status.
    pub state: State,
    /// What it cost.
    pub cost: Cost,
    /// What its runs came to.
    pub outcome: Outcome,
}

/// What the runs and other tasks of a stage came to; a task that several stages rest on counts for the first of them.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Runs of a simulator, a program or a formula that ended, whatever asked for them: a design, a calibration, a verification.
    pub runs: usize,
    /// Those without a result.
    pub failed: usize,
    /// Those with a result that is not valid.
    pub invalid: usize,
    /// Valid ones that are to be read with caution.
    pub cautions: usize,
    /// Specimens that could not be made: the runs that rest on them never began.
    pub unmade: usize,
    /// Warnings of its tasks, each with the number of tasks that have it.
    pub warnings: Vec<(String, usize)>,
}

impl Outcome {
    /// Counts the result of a task.
    pub(super) fn add(&mut self, artifact: &Artifact) {
        if artifact.is(ArtifactKind::SPECIMEN) && artifact.root.get("failure").is_some() {
            self.unmade += 1;
        }
        let Some(outcome) = Some(artifact).filter(|a| a.is(Run::KIND)).and_then(|a| Run::outcome(a).ok()) else {
            return;
        };
        self.runs += 1;
        if !outcome.failure.is_empty() {
            self.failed += 1;
        } else if outcome.validity.is_some_and(|why| !why.is_empty()) {
            self.invalid += 1;
        } else if !outcome.cautions.is_empty() {
            self.cautions += 1;
        }
    }

    /// Several of them together, without their warnings.
    pub(super) fn sum<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        all.fold(Self::default(), |mut sum, own| {
            sum.runs += own.runs;
            sum.failed += own.failed;
            sum.invalid += own.invalid;
            sum.cautions += own.cautions;
            sum.unmade += own.unmade;
            sum
        })
    }
}

/// Status of a stage.
#[derive(Clone, Debug)]
pub enum State {
    /// Its result.
    Done {
        /// Hash of its values.
        content: ContentHash,
        /// Its values.
        artifact: Arc<Artifact>,
    },
    /// It has not run yet.
    Missing,
    /// It cannot be computed or read, for this reason.
    Broken(String),
}

/// What the tasks of a stage cost; a task that several stages rest on counts for the first of them.
#[derive(Clone, Debug, Default)]
pub struct Cost {
    /// Finished tasks.
    pub tasks: usize,
    /// Their time together, seconds of one worker.
    pub seconds: f64,
    /// Start of the first and end of the last, milliseconds since 1970 UTC.
    pub span: Option<(i64, i64)>,
    /// Where and by what they were computed.
    pub origins: BTreeSet<Origin>,
}

impl Cost {
    /// Adds a finished task.
    pub(super) fn add(&mut self, started: i64, seconds: f64, origin: &Origin) {
        self.tasks += 1;
        if !origin.is_known() {
            return;
        }
        let end = started.saturating_add((1000.0 * seconds) as i64);
        let (first, last) = self.span.unwrap_or((started, end));
        self.span = Some((first.min(started), last.max(end)));
        self.seconds += seconds;
        if !self.origins.contains(origin) {
            self.origins.insert(origin.clone());
        }
    }

    /// The costs of several stages together.
    pub(super) fn sum<'a>(costs: impl Iterator<Item = &'a Self>) -> Self {
        costs.fold(Self::default(), |mut sum, cost| {
            sum.tasks += cost.tasks;
            sum.seconds += cost.seconds;
            sum.span = match (sum.span, cost.span) {
                (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                (a, b) => a.or(b),
            };
            sum.origins.extend(cost.origins.iter().cloned());
            sum
        })
    }
}

impl Part {
    /// Its values, when it is done.
    pub fn artifact(&self) -> Option<&Artifact> {
        match &self.state {
            State::Done { artifact, .. } => Some(artifact),
            State::Missing | State::Broken(_) => None,
        }
    }

    /// Its title, or else its name for people: `figure_5` → `Figure 5`, `ccd_ucs` → `CCD UCS`.
    pub(super) fn words(&self) -> String {
        if let Some(title) = &self.title {
            return title.clone();
        }
        let word = |word: &str| {
            let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
            if ABBREVIATIONS.contains(&letters) { word.to_uppercase() } else { word.to_owned() }
        };
        capital(&self.name.split('_').map(word).collect::<Vec<_>>().join(" "))
    }

    /// Its kind in words of the field.
    pub(super) fn kind_in_words(&self) -> &str {
        let words = KINDS_IN_WORDS.iter().find(|(kind, _)| *kind == self.kind);
        words.map_or(self.kind.as_str(), |(_, words)| words)
    }

    /// Whether it only shows what other stages computed.
    pub(super) fn is_shown_elsewhere(&self) -> bool {
        self.class == Class::Presentation
    }
}

impl Paper {
    /// Names of the stages that have no result.
    pub fn missing(&self) -> Vec<&str> {
        self.parts.iter().filter(|part| part.artifact().is_none()).map(|part| part.name.as_str()).collect()
    }

    /// The stage in whose section a stage is shown: itself, or for a figure or a table the last one of those it shows.
    pub(super) fn home(&self, index: usize) -> usize {
        let part = &self.parts[index];
        let shown = part.inputs.iter().filter(|(port, _)| port == "of").map(|&(_, input)| input);
        match shown.max().filter(|&input| part.is_shown_elsewhere() && input < index) {
            Some(input) => self.home(input),
            None => index,
        }
    }

    /// Options that name this campaign on a command line, with a blank in front.
    pub(super) fn options(&self) -> String {
        let profile = self.profile.iter().map(|name| ["--profile", name]);
        let sets = self.sets.iter().map(|set| ["--set", set]);
        let store = Some(&self.store).filter(|store| !store.is_empty()).map(|store| ["--store", store]);
        profile.chain(sets).chain(store).map(|[option, value]| format!(" {option} {}", quoted(value))).collect()
    }

    /// A command on this campaign: `flow WORD FILE … REST`.
    pub fn command(&self, word: &str, rest: &str) -> String {
        let rest = if rest.is_empty() { String::new() } else { format!(" {rest}") };
        format!("flow {word} {}{}{rest}", quoted(&self.file), self.options())
    }

    /// The last run that computed a part of this stage's result.
    pub(super) fn run_of(&self, part: &Part) -> Option<&Campaign> {
        let State::Done { content, .. } = &part.state else { return None };
        let hash = content.to_string();
        let made = |run: &&Campaign| {
            run.stages.iter().any(|s| s.name == part.name && s.ran > 0 && s.object.as_deref() == Some(&hash))
        };
        self.runs.iter().rev().find(made)
    }
}

/// Kinds whose word in the workflow is not that of the field.
const KINDS_IN_WORDS: [(&str, &str); 11] = [
    ("anova", "analysis of variance"),
    ("calibrate", "calibration"),
    ("command", "external program"),
    ("design", "design of experiments"),
    ("effort", "effort of optimisers"),
    ("envelope", "failure envelope"),
    ("range", "range analysis"),
    ("rsm", "response surfaces"),
    ("screening", "screening of effects"),
    ("simulate", "simulation"),
    ("verify", "verification"),
];

/// Abbreviations of the field that stage names are made of.
const ABBREVIATIONS: [&str; 7] = ["anova", "bbd", "ccd", "lhs", "pb", "rsm", "ucs"];

/// The text with a capital at its beginning.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The text with a capital at its beginning, unless that is a symbol or a name: those keep their letters.
pub(super) fn sentence(text: &str) -> String {
    let word = text.split([' ', ',', '.', ':', '-']).next().unwrap_or_default();
    let is_word = word == "a" || word.len() > 1 && word.chars().all(|letter| letter.is_ascii_lowercase());
    if is_word { capital(text) } else { text.to_owned() }
}

/// A word as a shell takes it.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
