//! `kind = "effort"`: the cost of calibrations, side by side.
//!
//! `of` names calibrations, which may have several target sets and `seeds`. The artifact `effort` holds
//! * `effort`: a row per search: stage, method, set, seed, and the evaluations until all responses lay within 10, 5 and
//!   2 % of their targets, by a run and by the prediction at the recommended point; empty where they never did;
//! * `distribution`: the part of the searches of a stage that reached a level within a number of evaluations: the empirical
//!   distribution of effort, a row per step. It ends below 1 for a stage whose searches did not all reach the level
//!   (Hansen et al. 2021, doi:10.1080/10556788.2020.1808977).

use super::figure::Names;
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, Artifact, ArtifactKind, Group, Node, Table};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Settings of an `effort` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effort {
    /// The calibrations.
    pub of: Names,
}

/// What calibrations cost.
pub const EFFORT: ArtifactKind = ArtifactKind::new("effort", 1).main("effort");

#[derive(Serialize, Deserialize)]
struct Params {
    /// Names of the calibrations, as the table shows them.
    stages: Vec<String>,
}

impl Stage for Effort {
    fn inputs(&self) -> Vec<Port> {
        let accepts = Accepts::Only(&[ArtifactKind::SOLUTION]);
        vec![Port { key: "of", stages: self.of.list(), accepts }]
    }

    fn gives(&self) -> ArtifactKind {
        EFFORT
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        let none = Complaint::new("of", "no calibration is named").hint("name stages of kind calibrate");
        if self.of.is_empty() { vec![none] } else { Vec::new() }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut task = Task::new(Self::WORKS[0].name, json!(Params { stages: self.of.list() }));
        for input in known.port("of") {
            task = task.input("of", input.content);
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Effort {
    const NAME: &'static str = "effort";
    const ABOUT: &'static str = "evaluations that calibrations needed, side by side";
    const GIVES: &'static [ArtifactKind] = &[EFFORT];
    const CLASS: Class = Class::Calibration;
    const WORKS: &'static [Work] = &[Work { name: "effort", version: 1, run: gather }];
}

/// How a solution names the columns of its effort: what is counted, and the deviation in percent.
const COUNTS: [(&str, [u32; 3]); 2] = [("to", [10, 5, 2]), ("expected", [10, 5, 2])];

/// One search.
struct Search {
    stage: String,
    method: String,
    set: i64,
    seed: f64,
    evaluations: f64,
    coarse: f64,
    /// Evaluations by count and level, NaN where the search never reached the level.
    counts: Vec<f64>,
}

fn gather(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let mut searches = Vec::new();
    for (stage, (_, solution)) in params.stages.iter().zip(job.inputs) {
        searches.extend(of_solution(stage, solution)?);
    }
    let root = Group::new()
        .with("effort", Node::Table(effort(&searches)))
        .with("distribution", Node::Table(distribution(&params.stages, &searches)));
    Ok(Artifact::of(EFFORT, root))
}

/// Names of the columns of counts.
fn columns() -> impl Iterator<Item = (&'static str, u32, String)> {
    COUNTS
        .iter()
        .flat_map(|(what, levels)| levels.iter().map(move |level| (*what, *level, format!("{what}_{level}_percent"))))
}

fn of_solution(stage: &str, solution: &Artifact) -> Result<Vec<Search>, StageError> {
    let missing = || StageError::new(format!("the solution of `{stage}` holds no table `effort`"));
    let table = solution.table("effort").ok_or_else(missing)?;
    let (sets, methods) = (table.ints("set")?, table.texts("method")?);
    let numbers = |name: &str| table.numbers(name, "");
    let (evaluations, coarse) = (numbers("evaluations")?, numbers("coarse")?);
    let seeds = numbers("seed").unwrap_or_else(|_| vec![f64::NAN; sets.len()]);
    let counts = columns().map(|(.., name)| numbers(&name)).collect::<Result<Vec<_>, _>>()?;
    let search = |i: usize| Search {
        stage: stage.to_owned(),
        method: methods[i].clone(),
        set: sets[i],
        seed: seeds[i],
        evaluations: evaluations[i],
        coarse: coarse[i],
        counts: counts.iter().map(|column| column[i]).collect(),
    };
    Ok((0..sets.len()).map(search).collect())
}

fn effort(searches: &[Search]) -> Table {
    let reals = |pick: &dyn Fn(&Search) -> f64| searches.iter().map(pick).collect::<Vec<_>>();
    let about = "evaluations until all responses lay near their targets, search by search";
    let mut table = Table { about: about.to_owned(), columns: Vec::new() }
        .texts_column("stage", "", searches.iter().map(|search| search.stage.clone()).collect())
        .texts_column("method", "", searches.iter().map(|search| search.method.clone()).collect())
        .ints_column("set", "target set, from 1", searches.iter().map(|search| search.set).collect())
        .reals_column("seed", "", "of the optimiser, where it is not the workflow's", reals(&|search| search.seed))
        .reals_column("evaluations", "", "in all", reals(&|search| search.evaluations))
        .reals_column("coarse", "", "before them, on coarse twins", reals(&|search| search.coarse));
    for (k, (what, _, name)) in columns().enumerate() {
        let about = if what == "to" { "until a run showed it" } else { "until the recommended point was expected to" };
        table = table.reals_column(&name, "", about, reals(&|search| search.counts[k]));
    }
    table
}

/// One step of an empirical distribution.
struct Rise<'a> {
    stage: &'a str,
    count: &'static str,
    level: u32,
    evaluations: f64,
    share: f64,
}

fn distribution(stages: &[String], searches: &[Search]) -> Table {
    let mut steps = Vec::new();
    for stage in stages {
        let own: Vec<&Search> = searches.iter().filter(|search| search.stage == *stage).collect();
        for (k, (count, level, _)) in columns().enumerate() {
            let mut done: Vec<f64> = own.iter().map(|search| search.counts[k]).filter(|n| n.is_finite()).collect();
            done.sort_by(f64::total_cmp);
            for (i, &evaluations) in done.iter().enumerate() {
                // Searches with the same number of evaluations are one step.
                if done.get(i + 1) != Some(&evaluations) {
                    let share = (i + 1) as f64 / own.len() as f64;
                    steps.push(Rise { stage, count, level, evaluations, share });
                }
            }
        }
    }
    let words = |step: &Rise| if step.count == "to" { "shown by a run" } else { "expected" }.to_owned();
    Table { about: "part of the searches that was done after so many evaluations".to_owned(), columns: Vec::new() }
        .texts_column("stage", "", steps.iter().map(|step| step.stage.to_owned()).collect())
        .texts_column("by", "what was counted", steps.iter().map(words).collect())
        .ints_column("percent", "greatest deviation from a target", steps.iter().map(|s| i64::from(s.level)).collect())
        .reals_column("evaluations", "", "", steps.iter().map(|step| step.evaluations).collect())
        .reals_column("share", "", "of the stage's searches", steps.iter().map(|step| step.share).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four searches: two done after 20 evaluations, one after 35, one never.
    #[test]
    fn the_distribution_rises_at_every_search_that_was_done() {
        let search = |to: f64| Search {
            stage: "a".into(),
            method: "surrogate".into(),
            set: 1,
            seed: 1.0,
            evaluations: 60.0,
            coarse: 0.0,
            counts: vec![to, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN],
        };
        let searches = [20.0, f64::NAN, 35.0, 20.0].map(search);
        let table = distribution(&["a".to_owned()], &searches);
        assert_eq!(table.numbers("evaluations", "").unwrap(), [20.0, 35.0]);
        assert_eq!(table.numbers("share", "").unwrap(), [0.5, 0.75]);
        assert_eq!(table.ints("percent").unwrap(), [10, 10]);
    }
}
