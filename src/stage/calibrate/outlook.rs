//! Predicted responses and parameters of a solution with their intervals: the tables `prediction`, `parameters`, `notes`.

use super::params::{FactorParam, Params, TargetParam};
use super::record::{named, numbered};
use super::solve::{Line, Solved};
use crate::artifact::Table;
use crate::artifact::validity::Tally;
use crate::stage::notes::{Notes, short};
use optim::Interval;
use optim::constraint::Factor;

/// Whether a target is met, by the prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Met {
    Yes,
    No,
    Unknown,
}

impl Met {
    /// The word in tables.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::Unknown => "unknown",
        }
    }
}

/// One row per set and target.
struct Predicted<'a> {
    set: usize,
    target: &'a TargetParam,
    expected: Interval,
    observed: f64,
    scatter: f64,
    deviation: f64,
    reach: [f64; 2],
    met: Met,
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
                _ if mean.is_nan() => Met::Unknown,
                true => Met::Yes,
                false => Met::No,
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
pub(super) fn met(params: &Params, solved: &[Solved], set: usize) -> Met {
    let rows = predicted(params, solved);
    let own = || rows.iter().filter(|row| row.set == set);
    if own().any(|row| row.met == Met::No) {
        Met::No
    } else if own().any(|row| row.met == Met::Unknown) {
        Met::Unknown
    } else {
        Met::Yes
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
            format!("out of reach, at least {low:.4}")
        } else if high < target.low {
            format!("out of reach, at most {high:.4}")
        } else {
            "within reach".to_owned()
        }
    }

    fn out_of_reach(&self) -> bool {
        self.reach().starts_with("out of reach")
    }
}

pub(super) fn prediction(params: &Params, solved: &[Solved]) -> Table {
    let rows = predicted(params, solved);
    let reals = |pick: fn(&Predicted) -> f64| rows.iter().map(pick).collect::<Vec<_>>();
    let end = |end: Option<f64>| end.unwrap_or(f64::NAN);
    let texts = |pick: fn(&Predicted) -> String| rows.iter().map(pick).collect::<Vec<_>>();
    let mut table = named("targets, what is expected, and what can be had over the ranges")
        .ints_column("set", "target set, from 1", numbered(rows.iter().map(|row| row.set)))
        .texts_column("response", "", texts(|row| row.target.response.clone()))
        .texts_column("unit", "of the numbers beside it", texts(|row| row.target.unit.clone()))
        .reals_column("target", "", "wanted; the lower end of a band", reals(|row| row.target.target().value()));
    if rows.iter().any(|row| row.target.low != row.target.high) {
        let ends = |pick: fn(&TargetParam) -> Option<f64>| rows.iter().map(|row| end(pick(row.target))).collect();
        table = table
            .reals_column("at_least", "", "lower end of what is wanted", ends(|target| target.low))
            .reals_column("at_most", "", "upper end", ends(|target| target.high));
    }
    table = table
        .reals_column("expected", "", "at the solution", reals(|row| row.expected.mean))
        .reals_column(
            "low",
            "",
            "lower end of the 95 % interval of the mean; missing where one run is all that is known",
            reals(|row| row.expected.low),
        )
        .reals_column("high", "", "upper end", reals(|row| row.expected.high))
        .reals_column("deviation_percent", "", "as in the misfit", reals(|row| row.deviation));
    if rows.iter().any(|row| !row.observed.is_nan()) {
        let about = "by the run at the solution, which is the luckiest of many";
        table = table.reals_column("observed", "", about, reals(|row| row.observed));
    }
    let scatter = reals(|row| row.scatter);
    table
        .reals_column("scatter", "", "standard deviation of a single run, from packing to packing", scatter)
        .reals_column("reach_low", "", "least over the ranges", reals(|row| row.reach[0]))
        .reals_column("reach_high", "", "greatest over the ranges", reals(|row| row.reach[1]))
        .texts_column("reach", "whether the target can be had by itself", texts(|row| row.reach()))
        .texts_column("met", "whether the expected value lies within the tolerance", texts(|row| row.met.word().into()))
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
    word: &'static str,
}

fn determined<'a>(params: &'a Params, solved: &[Solved]) -> Vec<Determined<'a>> {
    let mut rows = Vec::new();
    for (set, s) in solved.iter().enumerate() {
        let known = s.expected.iter().any(|y| y.high - y.low > 0.0);
        for (k, factor) in params.factors.iter().enumerate() {
            let domain: &Factor = &s.problem.domain.factors()[k];
            let [low, high] = s.extents.as_ref().map_or([f64::NAN; 2], |ends| ends[k]);
            let part = domain.unit(high) - domain.unit(low);
            // A parameter that the responses fix is known as well as they are.
            let (ends, word) = match part {
                part if part >= FREE => ([low, high], "free"),
                _ if part.is_nan() || !known => ([f64::NAN; 2], "unknown"),
                part if part <= DETERMINED => ([low, high], "determined"),
                _ => ([low, high], "partly determined"),
            };
            let part = if word == "unknown" { f64::NAN } else { part };
            rows.push(Determined { set, factor, value: s.point[k], ends, part, word });
        }
    }
    rows
}

pub(super) fn parameters(params: &Params, solved: &[Solved]) -> Table {
    let rows = determined(params, solved);
    let reals = |pick: fn(&Determined) -> f64| rows.iter().map(pick).collect::<Vec<_>>();
    let texts = |pick: fn(&Determined) -> String| rows.iter().map(pick).collect::<Vec<_>>();
    named("calibrated parameters, and what each can be while no response differs by more than its 95 % interval")
        .ints_column("set", "target set, from 1", numbered(rows.iter().map(|row| row.set)))
        .texts_column("factor", "", texts(|row| row.factor.name.clone()))
        .texts_column("unit", "of the numbers beside it", texts(|row| row.factor.unit.clone()))
        .reals_column("value", "", "of the solution", reals(|row| row.value))
        .reals_column("low", "", "least over all equally good solutions", reals(|row| row.ends[0]))
        .reals_column("high", "", "greatest", reals(|row| row.ends[1]))
        .reals_column("range_low", "", "lower end of its range", reals(|row| row.factor.low))
        .reals_column("range_high", "", "upper end", reals(|row| row.factor.high))
        .reals_column("part_percent", "", "of the range that is as good", reals(|row| 100.0 * row.part))
        .texts_column("known", "what the targets say of it", texts(|row| row.word.to_owned()))
}

/// The notes on a solution; `learned` are the sentences on the runs that the search learned from.
pub(super) fn notes(params: &Params, solved: &[Solved], learned: &[String]) -> Table {
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
        } else if row.met == Met::No {
            let note = format!("{set}not met: {expected} is expected, off by {} %", short(row.deviation));
            notes.add(&row.target.response, note);
        }
    }
    for (set, s) in solved.iter().enumerate() {
        let mut own = rows.iter().filter(|row| row.set == set);
        if own.clone().any(|row| row.met == Met::No) && own.all(|row| row.reach() == "within reach") {
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
    notes.table().to_table()
}
