//! `kind = "verify"`: the calibrated parameters on fresh specimens.
//!
//! Every set of a `solution` is run on n specimens that no design or calibration has used. Per set and response, with
//! the mean m and the standard deviation s (divisor n − 1) of the runs that gave a value and the target t:
//! * `cv_percent` = 100 s / m, `relative_error_percent` = 100 |m − t| / t, and `error_of_mean_percent` = 100 |m − t| / m;
//! * `low`, `high`: the 95 % interval of the mean, m ± t₀.₉₇₅(n − 1) s / √n, and whether the target lies in it.
//!
//! The artifact `verification` holds the tables `summary` and `runs`.

use super::calibrate::read_response;
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Point, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::calibration::{Prediction, Solution, Summary, Verification, VerifiedRuns};
use crate::artifact::{Accepts, Artifact, ArtifactKind, Table};
use math::distribution::t_for_coverage;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::Arc;

/// Settings of a `verify` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verify {
    /// The calibration to verify.
    pub solution: String,
    /// The stage whose simulation is run: its specimen, material and test.
    pub simulator: String,
    /// Fresh specimens per set.
    #[serde(default = "five")]
    pub replicates: u64,
}

fn five() -> u64 {
    5
}

/// Replicates of a verification are numbered from here, above all that designs and calibrations use.
const FRESH: u64 = 1_000_001;

/// Parameters of the work `verify`.
#[derive(Serialize, Deserialize)]
struct Params {
    factors: Vec<String>,
    replicates: usize,
}

impl Stage for Verify {
    fn inputs(&self) -> Vec<Port> {
        vec![
            Port {
                key: "solution",
                stages: vec![self.solution.clone()],
                accepts: Accepts::Only(&[ArtifactKind::SOLUTION]),
            },
            Port {
                key: "simulator",
                stages: vec![self.simulator.clone()],
                accepts: Accepts::Only(&[ArtifactKind::RESULTS, ArtifactKind::RUN]),
            },
        ]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::VERIFICATION
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        let few = Complaint::new("replicates", "a standard deviation needs at least two specimens");
        if self.replicates < 2 { vec![few.hint("replicates = 5")] } else { Vec::new() }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("solution")?;
        let artifact = known.load(input)?;
        let table = Solution::from_artifact(&artifact)?.solution;
        let factors: Vec<String> =
            table.columns.iter().map(|c| c.name.clone()).filter(|n| known.context.factors.contains_key(n)).collect();
        let simulator = known.one("simulator")?;
        let mut task =
            Task::new("verify", json!(Params { factors: factors.clone(), replicates: self.replicates as usize }))
                .input("solution", input.content);
        for set in 0..table.rows() {
            let unit = |name: &String| known.context.factors.get(name).map_or("", |factor| factor.unit.as_str());
            let value = |name: &String| Ok((name.clone(), table.numbers(name, unit(name))?[set]));
            let point: Point = factors.iter().map(value).collect::<Result<_, StageError>>()?;
            for replicate in 0..self.replicates {
                task = task.after(
                    "run",
                    Arc::new(
                        (simulator.sample)(&point, FRESH + replicate)?
                            .row(set * self.replicates as usize + replicate as usize),
                    ),
                );
            }
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Verify {
    const NAME: &'static str = "verify";
    const ABOUT: &'static str = "calibrated parameters on fresh specimens";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::VERIFICATION];
    const CLASS: Class = Class::Calibration;
    const WORKS: &'static [Work] = &[Work { name: "verify", version: 1, run: verify }];
}

/// One target and what its runs gave; NaN where a run failed.
struct Verified {
    set: i64,
    response: String,
    unit: String,
    target: f64,
    values: Vec<f64>,
}

fn verify(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let solution = Solution::from_artifact(job.input("solution")?).map_err(StageError::from)?;
    let runs: Vec<&Artifact> = job.inputs.iter().filter(|(name, _)| name == "run").map(|(_, run)| &**run).collect();
    let mut verified = targets(&solution.prediction);
    let mut failures = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        let set = (i / params.replicates) as i64 + 1;
        let mut failure = String::new();
        for one in verified.iter_mut().filter(|one| one.set == set) {
            match read_response(run, &one.response, &one.unit)? {
                Ok(value) => one.values.push(value),
                Err(reason) => {
                    one.values.push(f64::NAN);
                    failure = reason;
                }
            }
        }
        failures.push(failure);
    }
    let runs = run_table(&params, &solution.solution, &verified, failures)?;
    Ok(Verification { summary: summary(&verified), runs }.to_artifact())
}

/// The targets of all sets.
fn targets(prediction: &Prediction) -> Vec<Verified> {
    let one = |i: usize| Verified {
        set: prediction.set[i],
        response: prediction.response[i].clone(),
        unit: prediction.unit[i].clone(),
        target: prediction.target[i],
        values: Vec::new(),
    };
    (0..prediction.set.len()).map(one).collect()
}

/// Mean, standard deviation and half the 95 % interval of the mean of the values there are, and their number.
fn moments(values: &[f64]) -> (f64, f64, f64, usize) {
    let there: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let n = there.len() as f64;
    let mean = there.iter().sum::<f64>() / n;
    let deviation = (there.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt();
    let half = if there.len() > 1 { t_for_coverage(0.95, n - 1.0) * deviation / n.sqrt() } else { f64::NAN };
    (mean, deviation, half, there.len())
}

fn summary(verified: &[Verified]) -> Summary {
    let moments: Vec<_> = verified.iter().map(|one| moments(&one.values)).collect();
    let all: Vec<_> = verified.iter().zip(&moments).collect();
    type Row<'a> = (&'a Verified, &'a (f64, f64, f64, usize));
    let reals = |pick: fn(&Row) -> f64| all.iter().map(pick).collect::<Vec<_>>();
    let inside = |(one, (mean, _, half, _)): &Row| {
        let inside = (one.target - mean).abs() <= *half;
        let known = if inside { "yes" } else { "no" };
        if half.is_nan() { "unknown".to_owned() } else { known.to_owned() }
    };
    Summary {
        set: verified.iter().map(|one| one.set).collect(),
        response: verified.iter().map(|one| one.response.clone()).collect(),
        unit: verified.iter().map(|one| one.unit.clone()).collect(),
        target: reals(|(one, _)| one.target),
        mean: reals(|(_, m)| m.0),
        std: reals(|(_, m)| m.1),
        cv_percent: reals(|(_, m)| 100.0 * m.1 / m.0.abs()),
        relative_error_percent: reals(|(one, m)| 100.0 * (m.0 - one.target).abs() / one.target.abs()),
        error_of_mean_percent: reals(|(one, m)| 100.0 * (m.0 - one.target).abs() / m.0.abs()),
        low: reals(|(_, m)| m.0 - m.2),
        high: reals(|(_, m)| m.0 + m.2),
        target_inside: all.iter().map(inside).collect(),
        n: moments.iter().map(|m| m.3 as i64).collect(),
    }
}

fn run_table(
    params: &Params,
    source: &Table,
    verified: &[Verified],
    failures: Vec<String>,
) -> Result<Table, StageError> {
    let (n, count) = (params.replicates, failures.len());
    let mut table = Table::default();
    for name in &params.factors {
        let (values, unit) = source.shown(name)?;
        table = table.reals_column(name, unit, "", (0..count).map(|i| values[i / n]).collect());
    }
    let mut seen: Vec<&str> = Vec::new();
    for Verified { response, unit, .. } in verified {
        if seen.contains(&response.as_str()) {
            continue;
        }
        seen.push(response);
        let value = |i: usize| {
            let own = verified.iter().find(|one| one.response == *response && one.set == (i / n) as i64 + 1);
            own.and_then(|one| one.values.get(i % n).copied()).unwrap_or(f64::NAN)
        };
        table = table.reals_column(response, unit, "", (0..count).map(value).collect());
    }
    let runs = VerifiedRuns {
        set: (0..count).map(|i| (i / n) as i64 + 1).collect(),
        specimen: (0..count).map(|i| (i % n) as i64 + 1).collect(),
        failure: failures,
    };
    Ok(runs.to_table().with_after("specimen", table))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// numpy 2.4.6 `std(ddof=1)` and scipy 1.17.1 `t.ppf(0.975, 4) * std / 5**0.5` of the same five numbers.
    #[test]
    fn moments_are_those_of_the_textbook() {
        let (mean, deviation, half, n) = moments(&[31.0, 29.5, f64::NAN, 30.2, 28.9, 30.4]);
        assert_eq!(n, 5);
        assert!((mean - 30.0).abs() < 1e-12);
        assert!((deviation - 0.815_475_321_515_004_8).abs() < 1e-12, "{deviation}");
        assert!((half - 1.012_546_348_148_820_8).abs() < 1e-9, "{half}");
    }
}
