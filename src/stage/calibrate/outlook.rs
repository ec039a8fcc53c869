//! Predicted responses and parameters of a solution with their intervals: the tables `prediction`, `parameters`, `notes`.

use super::params::{FactorParam, Params, TargetParam};
use super::solved::{Line, Solved, numbered};
use crate::artifact::calibration::{Answer, Determination, OUT_OF_REACH, Parameters, Prediction};
use crate::artifact::notes::NoteTable;
use crate::artifact::validity::Tally;
use crate::stage::notes::{Notes, short};
use optim::Interval;
use optim::constraint::Factor;

/// One row per set and target.
struct Predicted<'a> {
    set: usize,
    target: &'a TargetParam,
    expected: Interval,
    observed: f64,
    scatter: f64,
    deviation: f64,
    reach: [f64; 2],
    met: Answer,
}

fn predicted<'a>(params: &'a Params, solved: &[Solved]) -> Vec<Predicted<'a>> {
    let mut rows = Vec::new();
    for (set, s) in solved.iter().enumerate() {
        let means: Vec<f64> = s.expected.iter().map(|y| y.mean).collect();
        let deviations = s.problem.misfit.deviations(&means);
        for (k, target) in params.sets[set].targets.iter().enumerate() {
            let reach = s.set.as_ref().map(|set| &set.reach[k]);
            let mean = s.expected[k].mean;
            let met = match target.target().holds([mean, mean], params.tolerance) {
                _ if mean.is_nan() => Answer::Unknown,
                true => Answer::Yes,
                false => Answer::No,
            };
            rows.push(Predicted {
                set,
                target,
                expected: s.expected[k],
                observed: s.observed.as_ref().map_or(f64::NAN, |y| y[k]),
                scatter: s.scatter[k],
                deviation: 100.0 * deviations[k],
                reach: reach.map_or([f64::NAN; 2], |r| [r.low, r.high]),
                met,
            });
        }
    }
    rows
}

/// Whether all targets of a set are met.
pub(super) fn met(params: &Params, solved: &[Solved], set: usize) -> Answer {
    let rows = predicted(params, solved);
    let own = || rows.iter().filter(|row| row.set == set);
    if own().any(|row| row.met == Answer::No) {
        Answer::No
    } else if own().any(|row| row.met == Answer::Unknown) {
        Answer::Unknown
    } else {
        Answer::Yes
    }
}

impl Predicted<'_> {
    /// Whether the target can be reached by itself; if not, the nearest value that can.
    fn reach(&self) -> String {
        let [low, high] = self.reach;
        let target = self.target.target();
        if low.is_nan() {
            "unknown".to_owned()
        } else if low > target.high {
            format!("{OUT_OF_REACH}, at least {low:.4}")
        } else if high < target.low {
            format!("{OUT_OF_REACH}, at most {high:.4}")
        } else {
            "within reach".to_owned()
        }
    }

    fn out_of_reach(&self) -> bool {
        self.reach().starts_with(OUT_OF_REACH)
    }
}

pub(super) fn prediction(params: &Params, solved: &[Solved]) -> Prediction {
    let rows = predicted(params, solved);
    let reals = |pick: fn(&Predicted) -> f64| rows.iter().map(pick).collect::<Vec<_>>();
    let texts = |pick: fn(&Predicted) -> String| rows.iter().map(pick).collect();
    let band = rows.iter().any(|row| row.target.low != row.target.high);
    let observed = rows.iter().any(|row| !row.observed.is_nan());
    Prediction {
        set: numbered(rows.iter().map(|row| row.set)),
        response: texts(|row| row.target.response.clone()),
        unit: texts(|row| row.target.unit.clone()),
        target: reals(|row| row.target.target().value()),
        at_least: band.then(|| reals(|row| row.target.low.unwrap_or(f64::NAN))),
        at_most: band.then(|| reals(|row| row.target.high.unwrap_or(f64::NAN))),
        expected: reals(|row| row.expected.mean),
        low: reals(|row| row.expected.low),
        high: reals(|row| row.expected.high),
        deviation_percent: reals(|row| row.deviation),
        observed: observed.then(|| reals(|row| row.observed)),
        scatter: reals(|row| row.scatter),
        reach_low: reals(|row| row.reach[0]),
        reach_high: reals(|row| row.reach[1]),
        reach: texts(|row| row.reach()),
        met: rows.iter().map(|row| row.met).collect(),
    }
}

/// Parts of the range: the largest for a determined parameter, and the smallest for a free one.
pub(super) const DETERMINED: f64 = 0.25;
pub(super) const FREE: f64 = 0.9;

/// How far the targets determine one parameter.
struct Determined<'a> {
    set: usize,
    factor: &'a FactorParam,
    value: f64,
    ends: [f64; 2],
    /// Part of the range, on the factor's scale.
    part: f64,
    known: Determination,
}

fn determined<'a>(params: &'a Params, solved: &[Solved]) -> Vec<Determined<'a>> {
    let mut rows = Vec::new();
    for (set, s) in solved.iter().enumerate() {
        let model = s.expected.iter().any(|y| y.high - y.low > 0.0);
        for (k, factor) in params.factors.iter().enumerate() {
            let domain: &Factor = &s.problem.domain.factors()[k];
            let [low, high] = s.extents.as_ref().map_or([f64::NAN; 2], |ends| ends[k]);
            let part = domain.unit(high) - domain.unit(low);
            // A parameter that the responses fix is known as well as they are.
            let (ends, known) = match part {
                part if part >= FREE => ([low, high], Determination::Free),
                _ if part.is_nan() || !model => ([f64::NAN; 2], Determination::Unknown),
                part if part <= DETERMINED => ([low, high], Determination::Determined),
                _ => ([low, high], Determination::Partly),
            };
            let part = if known == Determination::Unknown { f64::NAN } else { part };
            rows.push(Determined { set, factor, value: s.point[k], ends, part, known });
        }
    }
    rows
}

pub(super) fn parameters(params: &Params, solved: &[Solved]) -> Parameters {
    let rows = determined(params, solved);
    let reals = |pick: fn(&Determined) -> f64| rows.iter().map(pick).collect();
    Parameters {
        set: numbered(rows.iter().map(|row| row.set)),
        factor: rows.iter().map(|row| row.factor.name.clone()).collect(),
        unit: rows.iter().map(|row| row.factor.unit.clone()).collect(),
        value: reals(|row| row.value),
        low: reals(|row| row.ends[0]),
        high: reals(|row| row.ends[1]),
        range_low: reals(|row| row.factor.low),
        range_high: reals(|row| row.factor.high),
        part_percent: reals(|row| 100.0 * row.part),
        known: rows.iter().map(|row| row.known).collect(),
    }
}

/// The notes on a solution; `learned` are the sentences on the runs that the search learned from.
pub(super) fn notes(params: &Params, solved: &[Solved], learned: &[String]) -> NoteTable {
    let mut notes = Notes::default();
    learned.iter().for_each(|said| notes.add("", format!("learned from: {said}")));
    let several = solved.len() > 1;
    let whose = |set: usize| if several { format!("set {}: ", set + 1) } else { String::new() };
    let rows = predicted(params, solved);
    for row in &rows {
        let (set, unit) = (whose(row.set), if row.target.unit.is_empty() { "" } else { row.target.unit.as_str() });
        let expected = format!("{} {unit}", short(row.expected.mean));
        let expected = expected.trim_end();
        if row.out_of_reach() {
            let note = format!("{set}the target is {}; {expected} is expected", row.reach());
            notes.add(&row.target.response, note);
        } else if row.met == Answer::No {
            let note = format!("{set}not met: {expected} is expected, off by {} %", short(row.deviation));
            notes.add(&row.target.response, note);
        }
    }
    for (set, s) in solved.iter().enumerate() {
        let mut own = rows.iter().filter(|row| row.set == set);
        if own.clone().any(|row| row.met == Answer::No) && own.all(|row| row.reach() == "within reach") {
            notes.add("", format!("{}each target can be met by itself, all together were not", whose(set)));
        }
        let of = |pick: fn(&Line) -> &str| Tally::of(s.history.len(), s.history.iter().map(pick));
        let failed = of(|line| &line.failure).of_evaluations("gave no result");
        let kept = of(|line| &line.validity).of_evaluations("rest on runs that are not valid and were kept");
        failed.into_iter().chain(kept).for_each(|said| notes.add("", format!("{}{said}", whose(set))));
        if !s.unknown.is_empty() {
            notes.add("", format!("{}intervals are unknown: {}", whose(set), s.unknown));
        }
    }
    notes.table()
}
