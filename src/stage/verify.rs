//! `kind = "verify"`: runs of the calibrated parameters on new specimens.
//!
//! Every set of a `solution` is run on n specimens that no design or calibration has used. Per set and response, with
//! the mean m and the standard deviation s (divisor n − 1) of the runs that gave a value and the target t:
//! * `cv_percent` = 100 s / m, `relative_error_percent` = 100 |m − t| / t, and `error_of_mean_percent` = 100 |m − t| / m;
//! * `low`, `high`: the 95 % interval of the mean, m ± t₀.₉₇₅(n − 1) s / √n, and whether the target lies in it.
//!
//! The artifact `verification` holds the tables `summary` and `runs`.

use super::calibrate::{Judgement, Unmet, judgement, read_response};
use super::forecast::{Ahead, Forecast, TaskForecast};
use super::given::check_given;
use super::invalid::{Invalid, refused};
use super::notes::short;
use super::{
    Class, Complaint, Context, Demands, Failure, Input, Job, Kind, Known, Point, Port, Stage, StageError, Step, Task,
    Work,
};
use crate::artifact::calibration::{Answer, Prediction, Solution, Summary, Verification, VerifiedRuns};
use crate::artifact::results::{Results, Verdicts};
use crate::artifact::validity::NotValid;
use crate::artifact::{Accepts, Artifact, ArtifactKind, Table};
use math::sample::Moments;
use optim::misfit::Target;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Settings of a `verify` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verify {
    /// The calibration to verify.
    pub solution: String,
    /// The stage whose simulation is run: its specimen, material and test.
    pub simulator: Option<String>,
    /// Several such stages, as in the calibration.
    #[serde(default)]
    pub simulators: Vec<String>,
    /// The simulator that gives a response, when several do; by default the first that does.
    #[serde(default)]
    pub from: BTreeMap<String, String>,
    /// New specimens per set.
    #[serde(default = "five")]
    pub replicates: u64,
    /// What `flow run` does when a target lies outside the interval of the mean.
    #[serde(default)]
    pub unmet: Unmet,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
}

fn five() -> u64 {
    5
}

/// Most specimens of one set: 10,000 give a standard deviation to 0.7 %, and more are a typing error.
const MOST_SPECIMENS: u64 = 10_000;

/// First replicate of a verification, above all that designs and calibrations use.
const FRESH: u64 = 1_000_001;

/// Parameters of the work `verify`.
#[derive(Serialize, Deserialize)]
struct Params {
    factors: Vec<String>,
    replicates: usize,
    /// The simulators, in the order of their runs at one specimen.
    simulators: Vec<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    from: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    invalid: Invalid,
}

impl Stage for Verify {
    fn inputs(&self) -> Vec<Port> {
        let simulators = Accepts::Only(&[ArtifactKind::RESULTS, ArtifactKind::RUN]);
        vec![
            Port {
                key: "solution",
                stages: vec![self.solution.clone()],
                accepts: Accepts::Only(&[ArtifactKind::SOLUTION]),
            },
            Port { key: "simulator", stages: self.simulator.iter().cloned().collect(), accepts: simulators },
            Port { key: "simulators", stages: self.simulators.clone(), accepts: simulators },
        ]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::VERIFICATION
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        let sets = (ahead.behind)("solution").first().and_then(|solution| solution.rows);
        let replicates = usize::try_from(self.replicates).unwrap_or(usize::MAX);
        let simulators = || ["simulator", "simulators"].into_iter().flat_map(|port| (ahead.behind)(port));
        // The sets share the specimens, and the simulators may.
        let specimens: usize = simulators().map(|simulator| simulator.per_run - 1).sum();
        let tasks = |sets: usize| {
            let runs = replicates.saturating_mul(sets.saturating_mul(simulators().count()).saturating_add(specimens));
            if specimens > 1 { TaskForecast::AtMost(runs) } else { TaskForecast::Exactly(runs) }.and(1)
        };
        let seconds = sets.and_then(|sets| Forecast::seconds_of(simulators(), replicates.saturating_mul(sets)));
        Forecast { rows: sets, tasks: sets.map(tasks), seconds, ..Forecast::ONE }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        if !(2..=MOST_SPECIMENS).contains(&self.replicates) {
            let message = match self.replicates {
                0..2 => "a standard deviation needs at least two specimens".to_owned(),
                many => format!("{many} specimens of every set would be made and tested; at most {MOST_SPECIMENS} are"),
            };
            found.push(Complaint::new("replicates", message).hint("replicates = 5"));
        }
        let simulators: Vec<&String> = self.simulator.iter().chain(&self.simulators).collect();
        if simulators.is_empty() {
            found.push(Complaint::new("simulator", "no simulator is named").hint("name that of the calibration"));
        }
        let targets = context.sketches.get(&self.solution).and_then(|sketch| sketch.responses.as_ref());
        found.extend(check_given(context, "simulator", &simulators, targets.into_iter().flatten()));
        for name in self.from.values().filter(|name| !simulators.contains(name)) {
            found.push(Complaint::new("from", format!("`{name}` is none of the simulators")));
        }
        found
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("solution")?;
        let table = Solution::from_artifact(&*known.load(input)?)?.solution.point;
        let factors: Vec<String> =
            table.columns.iter().map(|c| c.name.clone()).filter(|n| known.context.factors.contains_key(n)).collect();
        let simulators: Vec<&Input<'_>> = known.port("simulator").chain(known.port("simulators")).collect();
        let params = Params {
            factors: factors.clone(),
            replicates: self.replicates as usize,
            simulators: simulators.iter().map(|simulator| simulator.stage.to_owned()).collect(),
            from: self.from.clone(),
            invalid: self.invalid,
        };
        let mut task = Task::new("verify", json!(params)).input("solution", input.content);
        for set in 0..table.rows() {
            let unit = |name: &String| known.context.factors.get(name).map_or("", |factor| factor.unit.as_str());
            let value = |name: &String| Ok((name.clone(), table.numbers(name, unit(name))?[set]));
            let mut point = factors.iter().map(value).collect::<Result<Point, StageError>>()?;
            // Factors that other sets hold and this one does not.
            point.retain(|_, value| value.is_finite());
            for replicate in 0..self.replicates {
                let index = set * self.replicates as usize + replicate as usize;
                for (k, simulator) in simulators.iter().enumerate() {
                    let run = (simulator.sample)(&point, FRESH + replicate)?.row(index * simulators.len() + k);
                    task = task.after("run", Arc::new(run));
                }
            }
        }
        Ok(Step::Finish(task))
    }

    fn demands(&self) -> Option<&dyn Demands> {
        Some(self)
    }
}

impl Demands for Verify {
    fn unmet(&self, result: &Artifact) -> Option<String> {
        if self.unmet != Unmet::Fail {
            return None;
        }
        let found = Verification::from_artifact(result).ok()?.summary;
        let missed = |i: usize| match found.mean[i].is_nan() {
            true => format!("set {}: no run gave a value of `{}`", found.set[i], found.response[i]),
            false => format!("set {}: the mean of `{}` is {}", found.set[i], found.response[i], short(found.mean[i])),
        };
        let missed: Vec<String> =
            (0..found.set.len()).filter(|&i| found.target_inside[i] != Answer::Yes).map(missed).collect();
        (!missed.is_empty()).then(|| format!("{}, and the target is not in its interval", missed.join("; ")))
    }
}

impl Kind for Verify {
    const NAME: &'static str = "verify";
    const ABOUT: &'static str = "calibrated parameters on fresh specimens";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::VERIFICATION];
    const CLASS: Class = Class::Calibration;
    // 4: runs that are not valid are counted among those of all sets. 3: no deviation without two values. 2: runs that are not valid are left out
    const WORKS: &'static [Work] = &[Work { name: "verify", version: 4, run: verify }];
}

/// One target and the values of its runs; NaN where a run failed.
struct Verified {
    set: i64,
    response: String,
    unit: String,
    target: Target,
    values: Vec<f64>,
}

impl Verified {
    /// Deviation of a value from its target.
    fn off(&self, value: f64) -> f64 {
        (value - self.target.nearest(value)).abs()
    }

    /// The reference of a deviation: the target, or the nearest end of its band.
    fn wanted(&self, value: f64) -> f64 {
        let nearest = self.target.nearest(value);
        if nearest == value { self.target.value() } else { nearest }
    }
}

fn verify(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let Solution { solution, prediction, .. } =
        Solution::from_artifact(job.input("solution")?).map_err(StageError::from)?;
    let runs: Vec<&Artifact> = job.inputs.iter().filter(|(name, _)| name == "run").map(|(_, run)| &**run).collect();
    let mut verified = targets(&prediction);
    let (mut verdicts, mut reasons, mut any) = (Verdicts::default(), Vec::new(), false);
    for (i, runs) in runs.chunks(params.simulators.len()).enumerate() {
        let set = (i / params.replicates) as i64 + 1;
        let runs: Vec<(&str, &Artifact)> =
            params.simulators.iter().map(String::as_str).zip(runs.iter().copied()).collect();
        let Judgement { mut failure, validity, checked } = judgement(&runs)?;
        if params.invalid == Invalid::Refuse && !validity.is_empty() {
            return Err(refused(&format!(
                "set {set}, specimen {}: the run is not valid: {validity}",
                i % params.replicates + 1
            ))
            .into());
        }
        for one in verified.iter_mut().filter(|one| one.set == set) {
            // The table of runs shows the values of a run that is left out too.
            one.values.push(match read_response(&runs, &params.from, (&one.response, &one.unit), Invalid::Keep)? {
                Ok(value) => value,
                Err(reason) => {
                    failure = reason;
                    f64::NAN
                }
            });
        }
        verdicts.failures.push(failure);
        reasons.push(validity);
        any |= checked;
    }
    let without = vec![String::new(); reasons.len()];
    verdicts.checked = any.then_some((reasons, without));
    let table = run_table(&params, &solution.point, &verified)?;
    let runs = Results::of(table, verdicts).runs;
    let not_valid = leave_out(&runs, &params, &mut verified)?.some();
    let rows = 0..runs.rows();
    let runs = VerifiedRuns {
        set: rows.clone().map(|row| (row / params.replicates) as i64 + 1).collect(),
        specimen: rows.map(|row| row % params.replicates + 1).collect(),
        runs,
    };
    Ok(Verification { summary: summary(&verified), runs, not_valid }.to_artifact())
}

/// Lists the runs that are not valid, and removes the values of those that are left out.
fn leave_out(runs: &Table, params: &Params, verified: &mut [Verified]) -> Result<NotValid, StageError> {
    let judged = params.invalid.judge(runs)?;
    let mut list = NotValid::default();
    let of = |response: &str| verified.iter().filter(|one| one.response == response).count() * params.replicates;
    let counts: Vec<usize> = verified.iter().map(|one| of(&one.response)).collect();
    for (one, count) in verified.iter_mut().zip(counts) {
        let first = (one.set as usize - 1) * params.replicates;
        let place = |index: usize| first + index;
        let mut values = vec![f64::NAN; first];
        values.extend(&one.values);
        let mut own = judged.listed(&one.response, &values);
        // They are counted among the runs of all sets that have this target.
        own.runs.fill(count as i64);
        list.append(own);
        let kept = |(index, value): (usize, &f64)| if judged.leaves_out(place(index)) { f64::NAN } else { *value };
        one.values = one.values.iter().enumerate().map(kept).collect();
    }
    Ok(list)
}

/// The targets of all sets.
fn targets(prediction: &Prediction) -> Vec<Verified> {
    let one = |(row, ends): (usize, [f64; 2])| Verified {
        set: prediction.set[row],
        response: prediction.response[row].clone(),
        unit: prediction.unit[row].clone(),
        target: Target::band(&prediction.response[row], ends, 1.0),
        values: Vec::new(),
    };
    prediction.bands().into_iter().enumerate().map(one).collect()
}

/// Mean, standard deviation, half the 95 % interval of the mean, and number of the values that are not missing.
fn moments(values: &[f64]) -> (f64, f64, f64, usize) {
    let there: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let moments = Moments::of(&there);
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    (moments.mean, known(moments.deviation), known(moments.half_interval()), moments.count)
}

fn summary(verified: &[Verified]) -> Summary {
    let moments: Vec<_> = verified.iter().map(|one| moments(&one.values)).collect();
    let all: Vec<_> = verified.iter().zip(&moments).collect();
    type Row<'a> = (&'a Verified, &'a (f64, f64, f64, usize));
    let reals = |pick: fn(&Row) -> f64| all.iter().map(pick).collect();
    let inside = |(one, (mean, _, half, _)): &Row| match one.off(*mean) <= *half {
        _ if half.is_nan() => Answer::Unknown,
        true => Answer::Yes,
        false => Answer::No,
    };
    Summary {
        set: verified.iter().map(|one| one.set).collect(),
        response: verified.iter().map(|one| one.response.clone()).collect(),
        unit: verified.iter().map(|one| one.unit.clone()).collect(),
        target: reals(|(one, _)| one.target.value()),
        mean: reals(|(_, m)| m.0),
        std: reals(|(_, m)| m.1),
        cv_percent: reals(|(_, m)| 100.0 * m.1 / m.0.abs()),
        relative_error_percent: reals(|(one, m)| 100.0 * one.off(m.0) / one.wanted(m.0).abs()),
        error_of_mean_percent: reals(|(one, m)| 100.0 * one.off(m.0) / m.0.abs()),
        low: reals(|(_, m)| m.0 - m.2),
        high: reals(|(_, m)| m.0 + m.2),
        target_inside: all.iter().map(inside).collect(),
        n: moments.iter().map(|m| m.3).collect(),
    }
}

/// The columns of factors and responses, a row for every set and specimen.
fn run_table(params: &Params, source: &Table, verified: &[Verified]) -> Result<Table, StageError> {
    let n = params.replicates;
    let rows = 0..n * verified.iter().map(|one| one.set as usize).max().unwrap_or(0);
    let mut table = Table::default();
    for name in &params.factors {
        let (values, unit) = source.shown(name)?;
        table = table.reals_column(name, unit, "", rows.clone().map(|i| values[i / n]).collect());
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
        table = table.reals_column(response, unit, "", rows.clone().map(value).collect());
    }
    Ok(table)
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

    /// What is not known is no zero.
    #[test]
    fn fewer_than_two_values_have_no_deviation() {
        for values in [&[][..], &[f64::NAN], &[3.0], &[3.0, f64::NAN]] {
            let (_, deviation, half, n) = moments(values);
            assert!(deviation.is_nan() && half.is_nan() && n < 2, "{values:?}");
        }
    }

    #[test]
    fn runs_that_are_not_valid_are_counted_among_those_of_all_sets() {
        let texts = |texts: [&str; 4]| texts.map(String::from).to_vec();
        let runs = Table::default()
            .reals_column("y", "MPa", "", vec![1.0, 2.0, 3.0, 4.0])
            .texts_column("failure", "", texts([""; 4]))
            .texts_column("validity", "", texts(["rotation", "rotation", "", "rotation"]));
        let params = Params {
            factors: Vec::new(),
            replicates: 2,
            simulators: vec!["runs".into()],
            from: BTreeMap::new(),
            invalid: Invalid::LeaveOut,
        };
        let verified = |set: i64, values: [f64; 2]| Verified {
            set,
            response: "y".into(),
            unit: "MPa".into(),
            target: Target::band("y", [2.0, 2.0], 1.0),
            values: values.to_vec(),
        };
        let mut verified = [verified(1, [1.0, 2.0]), verified(2, [3.0, 4.0])];
        let list = leave_out(&runs, &params, &mut verified).unwrap();
        assert_eq!(list.grouped_sentences(), ["y: 3 of 4 runs are not valid and were left out: rotation (3)"]);
        assert!(verified[0].values.iter().all(|value| value.is_nan()));
        assert_eq!((verified[1].values[0], verified[1].values[1].is_nan()), (3.0, true));
    }
}
