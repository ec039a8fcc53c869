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
use crate::artifact::calibration::{self, Percents, Solution};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
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

/// The effort of calibrations.
pub const EFFORT: ArtifactKind = ArtifactKind::new("effort", 1).main("effort");

crate::artifact! {
    /// The effort of several calibrations.
    pub struct Efforts = EFFORT {
        /// the searches
        pub effort: Searches, "";
        /// the empirical distribution of the evaluations
        pub distribution: Distribution, "";
    }
}

crate::table! {
    /// evaluations until all responses were near their targets, search by search
    pub struct Searches {
        /// the calibration
        pub stage: Vec<String>, "";
        /// the method of the search
        pub method: Vec<String>, "";
        /// target set, from 1
        pub set: Vec<i64>, "";
        /// of the optimiser, where it is not the workflow's
        pub seed: Vec<f64>, "";
        /// in all
        pub evaluations: Vec<f64>, "";
        /// before them, on coarse twins
        pub coarse: Vec<f64>, "";
        /// until a run showed it
        pub to: Percents, "";
        /// until the recommended point was expected to
        pub expected: Percents, "";
    }
}

crate::table! {
    /// part of the searches that reached a deviation within a number of evaluations
    pub struct Distribution {
        /// the calibration
        pub stage: Vec<String>, "";
        /// the criterion
        pub by: Vec<Criterion>, "";
        /// greatest deviation from a target
        pub percent: Vec<i64>, "";
        /// number of evaluations
        pub evaluations: Vec<f64>, "";
        /// of the stage's searches
        pub share: Vec<f64>, "";
    }
}

crate::words! {
    /// What counts as having reached a target.
    pub enum Criterion {
        /// The responses of a run.
        Shown = "shown by a run",
        /// The expected responses of the recommended point.
        Expected = "expected",
    }
}

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

fn gather(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let mut effort = Searches::default();
    for (stage, (_, solution)) in params.stages.iter().zip(job.inputs) {
        effort.append(stage, Solution::from_artifact(solution).map_err(StageError::from)?.effort);
    }
    let distribution = distribution(&params.stages, &effort);
    Ok(Efforts { effort, distribution }.to_artifact())
}

impl Searches {
    /// Adds the searches of a calibration.
    fn append(&mut self, stage: &str, own: calibration::Effort) {
        let count = own.set.len();
        let reals = |counts: Vec<usize>| counts.into_iter().map(|count| count as f64);
        self.stage.extend(std::iter::repeat_n(stage.to_owned(), count));
        self.method.extend(own.method);
        self.set.extend(own.set);
        match own.seed {
            Some(seeds) => self.seed.extend(seeds.into_iter().map(|seed| seed as f64)),
            None => self.seed.extend(std::iter::repeat_n(f64::NAN, count)),
        }
        self.evaluations.extend(reals(own.evaluations));
        self.coarse.extend(reals(own.coarse));
        for (all, own) in [(&mut self.to, own.to), (&mut self.expected, own.expected)] {
            all.0.iter_mut().zip(own.0).for_each(|(all, own)| all.extend(own));
        }
    }
}

fn distribution(stages: &[String], searches: &Searches) -> Distribution {
    let mut steps = Distribution::default();
    for stage in stages {
        let own: Vec<usize> = (0..searches.set.len()).filter(|&row| searches.stage[row] == *stage).collect();
        for (by, counts) in [(Criterion::Shown, &searches.to), (Criterion::Expected, &searches.expected)] {
            for (level, counts) in Percents::LEVELS.into_iter().zip(&counts.0) {
                let mut done: Vec<f64> = own.iter().map(|&row| counts[row]).filter(|n| n.is_finite()).collect();
                done.sort_by(f64::total_cmp);
                for (i, &evaluations) in done.iter().enumerate() {
                    // Searches with the same number of evaluations are one step.
                    if done.get(i + 1) != Some(&evaluations) {
                        steps.stage.push(stage.clone());
                        steps.by.push(by);
                        steps.percent.push(i64::from(level));
                        steps.evaluations.push(evaluations);
                        steps.share.push((i + 1) as f64 / own.len() as f64);
                    }
                }
            }
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four searches: two done after 20 evaluations, one after 35, one never.
    #[test]
    fn the_distribution_rises_at_every_search_that_was_done() {
        let none = || vec![f64::NAN; 4];
        let own = calibration::Effort {
            set: vec![1, 2, 3, 4],
            seed: None,
            method: vec!["surrogate".to_owned(); 4],
            evaluations: vec![60; 4],
            coarse: vec![0; 4],
            to: Percents([vec![20.0, f64::NAN, 35.0, 20.0], none(), none()]),
            expected: Percents([none(), none(), none()]),
        };
        let mut searches = Searches::default();
        searches.append("a", own);
        let steps = distribution(&["a".to_owned()], &searches);
        assert_eq!(steps.evaluations, [20.0, 35.0]);
        assert_eq!(steps.share, [0.5, 0.75]);
        assert_eq!(steps.percent, [10, 10]);
        assert_eq!(steps.by, [Criterion::Shown; 2]);
    }
}
