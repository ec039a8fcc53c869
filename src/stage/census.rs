//! `kind = "census"`: how many runs of a table ended in which way.
//!
//! A kind that only the tests of this crate know: the proof that a kind is one file, its `mod` and one line in the list
//! of the parent module, a new artifact included. `cli::tests` takes it through every command.

use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::results::Results;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;

/// Settings of a `census` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Census {
    /// The stage whose runs are counted.
    pub table: String,
}

const CENSUS: ArtifactKind = ArtifactKind::new("census", 1).main("endings");

crate::artifact! {
    /// How runs ended.
    pub struct Counted = CENSUS {
        /// how runs ended
        pub endings: Endings, "";
    }
}

crate::table! {
    /// how runs ended
    pub struct Endings {
        /// the reason of a failure, or `done`
        pub ending: Vec<String>, "";
        /// runs that ended so
        pub runs: Vec<usize>, "";
    }
}

impl Stage for Census {
    fn inputs(&self) -> Vec<Port> {
        let accepts = Accepts::Only(&[ArtifactKind::RESULTS]);
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts }]
    }

    fn gives(&self) -> ArtifactKind {
        CENSUS
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        Vec::new()
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let table = known.one("table")?;
        Ok(Step::Finish(Task::new("census", json!({})).input("table", table.content)))
    }
}

impl Kind for Census {
    const NAME: &'static str = "census";
    const ABOUT: &'static str = "how many runs of a table ended in which way";
    const GIVES: &'static [ArtifactKind] = &[CENSUS];
    const CLASS: Class = Class::Statistics;
    const WORKS: &'static [Work] = &[Work { name: "census", version: 1, run: count }];
}

fn count(job: &Job) -> Result<Artifact, Failure> {
    let table = job.input("table")?;
    let runs = Results::table(table).map_err(StageError::from)?;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for failure in Results::failures(runs) {
        *counts.entry(if failure.is_empty() { "done" } else { failure }).or_default() += 1;
    }
    let (ending, runs) = counts.into_iter().map(|(ending, runs)| (ending.to_owned(), runs)).unzip();
    Ok(Counted { endings: Endings { ending, runs } }.to_artifact())
}
