//! `kind = "agreement"`: computed results beside values of the same points from elsewhere.
//!
//! `of` and `compare` name tables of results in pairs. Rows are paired by the factors that both hold; equal points are
//! paired in their order. The result has the tables
//! * `summary` (`response,table,n,median,lower,upper,least,greatest,mean,std,spearman`): the ratio computed/reference
//!   per pair of tables, and over all of them where there are several;
//! * `trends` (`response,table,factor,effect,std_error,t,p`): the regression of 100 ln ratio on the factors of a table,
//!   each effect over the factor's span, in per cent;
//! * `pairs` (`response,table,row,computed,reference,ratio`): every pair, `row` in the reference.

use super::columns::{Columns, Rows, Wanted, check_names, runs};
use super::reads::Reads;
use super::{Class, Complaint, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use super::{Context, figure::Names, given::check_given, invalid::Invalid};
use crate::artifact::agreement::{Agreement as Stored, Pairs, Ratios, Trends};
use crate::artifact::notes::NoteTable;
use crate::artifact::validity::NotValid;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::agreement::{Agreement as Found, agreement, pair_rows};
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;

/// Settings of an `agreement` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Agreement {
    /// The stages with the computed results.
    pub of: Names,
    /// The stages with the values to compare with, one for each of `of`, in the same order.
    pub compare: Names,
    /// Responses to compare; by default all that both tables have.
    #[serde(default)]
    pub responses: Vec<String>,
    /// Largest relative difference between levels that count as equal, because published levels are rounded.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
}

fn tolerance() -> f64 {
    1e-3
}

#[derive(Serialize, Deserialize)]
struct Params {
    tables: Vec<Pair>,
    tolerance: f64,
}

#[derive(Serialize, Deserialize)]
struct Pair {
    name: String,
    ours: Columns,
    theirs: Columns,
}

impl Stage for Agreement {
    fn inputs(&self) -> Vec<Port> {
        let port =
            |key, names: &Names| Port { key, stages: names.list(), accepts: Accepts::Only(&[ArtifactKind::RESULTS]) };
        vec![port("of", &self.of), port("compare", &self.compare)]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::AGREEMENT
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = check_names(context, &[], &self.responses);
        for stages in [self.of.list(), self.compare.list()] {
            let all: Vec<&String> = stages.iter().collect();
            found.extend(check_given(context, "responses", &all, &self.responses));
        }
        let (ours, theirs) = (self.of.list().len(), self.compare.list().len());
        if ours != theirs {
            let message = format!("`of` names {ours} stages and `compare` {theirs}; they are compared in pairs");
            found.push(Complaint::new("compare", message).hint("name one table for each stage of `of`"));
        }
        if !(self.tolerance >= 0.0 && self.tolerance < 0.5) {
            let message = format!("`tolerance` is {}; it must lie between 0 and 0.5", self.tolerance);
            found.push(Complaint::new("tolerance", message).hint("0.001 allows for levels printed with three digits"));
        }
        found
    }

    fn reads(&self) -> Vec<Reads> {
        let of = |stages: &Names| Reads {
            path: "responses".to_owned(),
            stages: stages.list(),
            columns: self.responses.clone(),
        };
        vec![of(&self.of), of(&self.compare)]
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut tables = Vec::new();
        for ((name, ours), theirs) in self.of.list().into_iter().zip(known.port("of")).zip(known.port("compare")) {
            let (a, b) = (known.load(ours)?, known.load(theirs)?);
            let (a, b) = (runs(&a)?, runs(&b)?);
            let all = Wanted { invalid: self.invalid, ..Wanted::default() };
            let (first, second) = (Columns::of(a, known.context, all)?, Columns::of(b, known.context, all)?);
            let shared = |own: Vec<String>, other: Vec<String>| -> Vec<String> {
                own.into_iter().filter(|name| other.contains(name)).collect()
            };
            let factors = shared(first.factor_names(), second.factor_names());
            let mut responses = shared(first.response_names(), second.response_names());
            responses.retain(|name| self.responses.is_empty() || self.responses.contains(name));
            if factors.is_empty() || responses.is_empty() {
                let message = format!("`{name}` and its reference share no factor, or no response");
                return Err(StageError::new(message).hint("rows are paired by the factors that both tables hold"));
            }
            let wanted = Wanted { factors: &factors, responses: &responses, ..all };
            let (ours, theirs) = (Columns::of(a, known.context, wanted)?, Columns::of(b, known.context, wanted)?);
            tables.push(Pair { name, ours, theirs });
        }
        let params = Params { tables, tolerance: self.tolerance };
        let mut task = Task::new(Self::WORKS[0].name, json!(params));
        for port in ["of", "compare"] {
            for input in known.port(port) {
                task = task.input(port, input.content);
            }
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Agreement {
    const NAME: &'static str = "agreement";
    const ABOUT: &'static str = "computed results beside values from elsewhere: ratios, ranks, trends";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::AGREEMENT];
    const CLASS: Class = Class::Statistics;
    // 2: runs that are not valid are left out. 3: notes on rows without a partner and pairs without a ratio
    const WORKS: &'static [Work] = &[Work { name: "agreement", version: 3, run: compare }];
}

/// A pair of values of one point.
struct Point {
    response: String,
    table: String,
    row: usize,
    computed: f64,
    reference: f64,
}

struct Summary {
    response: String,
    table: String,
    found: Found,
}

struct Trend {
    response: String,
    table: String,
    factor: String,
    effect: f64,
    std_error: Option<f64>,
    t: Option<f64>,
    p: Option<f64>,
}

fn compare(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let of = |port: &'static str| job.inputs.iter().filter(move |(name, _)| name == port).map(|(_, artifact)| artifact);
    let (mut points, mut trends, mut not_valid) = (Vec::new(), Vec::new(), NotValid::default());
    let mut notes = NoteTable::default();
    for ((pair, ours), theirs) in params.tables.iter().zip(of("of")).zip(of("compare")) {
        let (ours, theirs) = (runs(ours)?, runs(theirs)?);
        not_valid.append(pair.ours.not_valid(ours)?);
        not_valid.append(pair.theirs.not_valid(theirs)?);
        let (ours, theirs) = (pair.ours.sample(ours)?, pair.theirs.sample(theirs)?);
        let rows = pair_rows(&levels(&ours), &levels_like(&theirs, &ours), params.tolerance);
        for sentence in alone(&pair.name, [ours.rows(), theirs.rows()], rows.len()) {
            notes.response.push(String::new());
            notes.note.push(sentence);
        }
        for response in &ours.responses {
            let Some(other) = theirs.responses.iter().find(|r| r.name == response.name) else { continue };
            let value = |(i, j): &(usize, usize)| Some((*i, *j, response.values[*i]?, other.values[*j]?));
            let paired: Vec<(usize, usize, f64, f64)> = rows.iter().filter_map(value).collect();
            if let Some(sentence) = without_ratio(&pair.name, &paired) {
                notes.response.push(response.name.clone());
                notes.note.push(sentence);
            }
            trends.extend(trend(&ours, &response.name, &pair.name, &paired));
            points.extend(paired.into_iter().map(|(_, j, computed, reference)| Point {
                response: response.name.clone(),
                table: pair.name.clone(),
                row: j + 1,
                computed,
                reference,
            }));
        }
    }
    if points.is_empty() {
        let hint = "rows are paired by the factors that both tables hold";
        return Err(StageError::new("no point with a response is in both tables").hint(hint).into());
    }
    let stored = Stored {
        summary: summary_table(&summaries(&points)),
        trends: trend_table(&trends),
        pairs: pair_table(&points),
        not_valid: not_valid.some(),
        notes: (!notes.note.is_empty()).then_some(notes),
    };
    Ok(stored.to_artifact())
}

/// Rows of a table and of its reference that have no partner in the other.
fn alone(table: &str, rows: [usize; 2], paired: usize) -> Vec<String> {
    let sentence = |(rows, whose): (usize, String)| {
        let alone = rows - paired;
        let have = if alone == 1 { "has" } else { "have" };
        (alone > 0).then(|| format!("{alone} of {rows} rows of {whose} {have} no partner in the other table"))
    };
    let both = rows.into_iter().zip([format!("`{table}`"), format!("the reference of `{table}`")]);
    both.filter_map(sentence).collect()
}

/// Pairs whose reference is zero.
fn without_ratio(table: &str, paired: &[(usize, usize, f64, f64)]) -> Option<String> {
    let zero = paired.iter().filter(|pair| pair.3 == 0.0).count();
    let have = if zero == 1 { "has" } else { "have" };
    let all = paired.len();
    (zero > 0).then(|| format!("{zero} of {all} pairs of `{table}` {have} a reference of 0, and so no ratio"))
}

fn levels(sample: &Sample) -> Vec<&[f64]> {
    sample.factors.iter().map(|f| f.values.as_slice()).collect()
}

/// The levels of `sample` in the order of the other's factors.
fn levels_like<'a>(sample: &'a Sample, other: &Sample) -> Vec<&'a [f64]> {
    let own = |name: &str| sample.factors.iter().find(|f| f.name == name);
    other.factors.iter().filter_map(|f| own(&f.name)).map(|f| f.values.as_slice()).collect()
}

/// Effects on 100 ln(computed/reference) of the factors that vary; `None` where the pairs cannot separate them.
fn trend(ours: &Sample, response: &str, table: &str, paired: &[(usize, usize, f64, f64)]) -> Vec<Trend> {
    let usable: Vec<&(usize, usize, f64, f64)> = paired.iter().filter(|(_, _, y, x)| y / x > 0.0).collect();
    let column = |f: &Factor| Factor::new(&f.name, usable.iter().map(|p| f.values[p.0]).collect());
    let mut factors: Vec<Factor> = ours.factors.iter().map(column).collect();
    factors.retain(|f| f.values.iter().any(|v| *v != f.values[0]));
    let ratio = |p: &&(usize, usize, f64, f64)| 100.0 * math::elementary::ln(p.2 / p.3);
    let names: Vec<String> = factors.iter().map(|f| f.name.clone()).collect();
    let sample =
        Sample { factors, responses: vec![Response::new(response, usable.iter().map(ratio).collect())], weights: None };
    let terms = Term::first_order(&names);
    let Ok(fitted) = regress(&sample, response, &terms, &regression::Settings::default()) else { return Vec::new() };
    let of_factor = |c: &regression::Coefficient| {
        let factor = names.iter().find(|name| **name == c.term)?;
        // A coded unit is half the span.
        Some(Trend {
            response: response.to_owned(),
            table: table.to_owned(),
            factor: factor.clone(),
            effect: 2.0 * c.estimate,
            std_error: c.std_error.map(|s| 2.0 * s),
            t: c.t,
            p: c.p,
        })
    };
    fitted.coded.iter().filter_map(of_factor).collect()
}

fn summaries(points: &[Point]) -> Vec<Summary> {
    let mut keys: Vec<(&str, &str)> = Vec::new();
    for point in points {
        let key = (point.response.as_str(), point.table.as_str());
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys.sort_by_key(|(response, _)| points.iter().position(|p| p.response == *response));
    let mut found = Vec::new();
    let mut add = |response: &str, table: Option<&str>| {
        let mine = |p: &&Point| p.response == response && table.is_none_or(|table| p.table == table);
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().filter(mine).map(|p| (p.reference, p.computed)).unzip();
        let table = table.unwrap_or("all").to_owned();
        found.extend(agreement(&x, &y).map(|found| Summary { response: response.to_owned(), table, found }));
    };
    for (i, (response, table)) in keys.iter().enumerate() {
        add(response, Some(table));
        let last = keys.get(i + 1).is_none_or(|(next, _)| next != response);
        if last && i > 0 && keys[i - 1].0 == *response {
            add(response, None);
        }
    }
    found
}

fn summary_table(lines: &[Summary]) -> Ratios {
    let rows = Rows(lines);
    let ratio = |pick: fn(&Found) -> f64| rows.reals(|l| Some(pick(&l.found)));
    Ratios {
        response: rows.texts(|l| l.response.as_str()),
        table: rows.texts(|l| l.table.as_str()),
        n: rows.ints(|l| l.found.n),
        median: ratio(|f| f.quartiles[1]),
        lower: ratio(|f| f.quartiles[0]),
        upper: ratio(|f| f.quartiles[2]),
        least: ratio(|f| f.extremes[0]),
        greatest: ratio(|f| f.extremes[1]),
        mean: ratio(|f| f.mean),
        std: rows.reals(|l| l.found.deviation),
        spearman: rows.reals(|l| l.found.spearman),
    }
}

fn trend_table(lines: &[Trend]) -> Trends {
    let rows = Rows(lines);
    Trends {
        response: rows.texts(|l| l.response.as_str()),
        table: rows.texts(|l| l.table.as_str()),
        factor: rows.texts(|l| l.factor.as_str()),
        effect: rows.reals(|l| Some(l.effect)),
        std_error: rows.reals(|l| l.std_error),
        t: rows.reals(|l| l.t),
        p: rows.reals(|l| l.p),
    }
}

fn pair_table(points: &[Point]) -> Pairs {
    let rows = Rows(points);
    Pairs {
        response: rows.texts(|p| p.response.as_str()),
        table: rows.texts(|p| p.table.as_str()),
        row: rows.ints(|p| p.row),
        computed: rows.reals(|p| Some(p.computed)),
        reference: rows.reals(|p| Some(p.reference)),
        ratio: rows.reals(|p| Some(p.computed / p.reference)),
    }
}
