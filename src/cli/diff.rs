//! `flow diff`: two campaigns side by side: settings that differ, results that differ.
//!
//! Each side is a workflow file (`c30.toml`), a profile of one (`c30.toml@quick`), or a recorded run (`run 3` is `#3`).

use super::Exit;
use super::common::{Campaign, Common, decided, provenance, system};
use crate::artifact::{Artifact, ContentHash, Table, Values};
use crate::report::quoted;
use crate::run::StageStatus;
use crate::stage::Context;
use crate::stage::units::presented;
use crate::store::{self, Store};
use crate::unit::Conversion;
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Compare two campaigns: settings that differ, results that differ.
#[derive(Args)]
pub(super) struct Diff {
    /// A workflow file, `FILE@PROFILE`, or a recorded run `#N`.
    a: String,
    /// The same for the other side.
    b: String,
    #[command(flatten)]
    common: Common,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// A stage of one side.
struct Side {
    settings: BTreeMap<String, String>,
    object: Option<ContentHash>,
}

type Sides = BTreeMap<String, Side>;

impl Diff {
    pub(super) fn go(self) -> Exit {
        self.print().unwrap_or_else(|exit| exit)
    }

    fn print(&self) -> Result<Exit, Exit> {
        let store = self.common.read()?;
        let (a, b) = (self.side(&self.a, &store)?, self.side(&self.b, &store)?);
        let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
        names.sort_unstable();
        names.dedup();
        let mut document = serde_json::Map::new();
        for name in names {
            let settings = settings(a.get(name), b.get(name));
            let results = results(a.get(name), b.get(name), &store)?;
            if settings.is_empty() && results.is_empty() {
                continue;
            }
            if !self.json {
                out!("{name}");
                settings.iter().for_each(|(path, old, new)| out!("  {path}: {old} → {new}"));
                results.iter().for_each(|line| out!("  {line}"));
            }
            let settings: Vec<Value> =
                settings.into_iter().map(|(path, a, b)| json!({ "path": path, "a": a, "b": b })).collect();
            document.insert(name.clone(), json!({ "settings": settings, "results": results }));
        }
        match (self.json, document.is_empty()) {
            (true, _) => out!("{}", Value::from(document)),
            (false, true) => out!("no difference"),
            (false, false) => {}
        }
        Ok(Exit::Done)
    }

    fn side(&self, text: &str, store: &Store) -> Result<Sides, Exit> {
        match text.strip_prefix('#') {
            Some(number) => self.recorded(number, store),
            None if text.parse::<u64>().is_ok() && !Path::new(text).exists() => {
                err!("error: there is no workflow file `{text}`; the recorded run {text} is written '#{text}'");
                Err(Exit::BadInput)
            }
            None => self.planned(text, store),
        }
    }

    fn planned(&self, text: &str, store: &Store) -> Result<Sides, Exit> {
        let (file, profile) = match text.rsplit_once('@') {
            Some((file, profile)) => (file, Some(profile.to_owned())),
            None => (text, None),
        };
        let campaign = Campaign::of(PathBuf::from(file), profile, &self.common);
        let workflow = campaign.load(&[])?;
        let report = decided(&workflow, store, &[], true)?;
        let mut sides = Sides::new();
        for (node, stage) in workflow.stages.iter().zip(&report.stages) {
            let object = match stage.status {
                StageStatus::Done(content) => Some(content),
                StageStatus::Open | StageStatus::Failed(_) | StageStatus::Skipped(_) => None,
            };
            let settings = flat(node.kind, &node.stage.settings());
            sides.insert(node.name.clone(), Side { settings, object });
        }
        Ok(sides)
    }

    fn recorded(&self, number: &str, store: &Store) -> Result<Sides, Exit> {
        let known = store.campaigns().map_err(|e| system(&e))?;
        let found = match number.parse() {
            Ok(number) if known.contains(&number) => store.campaign(number).map_err(|e| system(&e))?,
            Ok(_) | Err(_) => None,
        };
        let Some(campaign) = found else {
            let known: Vec<String> = known.iter().map(|n| format!("#{n}")).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            err!("error: there is no recorded run #{number}; the store `{}` has {known}", store.root().display());
            return Err(Exit::BadInput);
        };
        if !campaign.own {
            let file = quoted(&campaign.workflow);
            err!(
                "error: run #{number} was not recorded by you, or its record was changed since, so what it says of results \
                 cannot be believed; compare the workflow itself: `flow diff {file} …`"
            );
            return Err(Exit::System);
        }
        let store::Campaign { workflow, profile, set, started, seconds, origin, .. } = &campaign;
        let profile = if profile.is_empty() { String::new() } else { format!("@{profile}") };
        let sets: String = set.iter().map(|set| format!(" --set {}", quoted(set))).collect();
        self.common.note(&format!("#{number}: {workflow}{profile}{sets}, {}", provenance(*started, *seconds, origin)));
        let side = |stage: crate::store::StageRun| {
            let object = stage.object.as_deref().and_then(ContentHash::from_hex);
            (stage.name, Side { settings: flat(&stage.kind, &stage.settings), object })
        };
        Ok(campaign.stages.into_iter().map(side).collect())
    }
}

/// Settings by path.
fn flat(kind: &str, settings: &Value) -> BTreeMap<String, String> {
    fn walk(path: &str, value: &Value, found: &mut BTreeMap<String, String>) {
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Object(map) => map.iter().for_each(|(key, value)| walk(&below(key), value, found)),
            Value::Null => {}
            Value::Array(_) | Value::Bool(_) | Value::Number(_) | Value::String(_) => {
                found.insert(path.to_owned(), value.to_string());
            }
        }
    }
    let mut found = BTreeMap::from([("kind".to_owned(), kind.to_owned())]);
    walk("", settings, &mut found);
    found
}

/// Path, value on one side, value on the other, where they differ.
fn settings(a: Option<&Side>, b: Option<&Side>) -> Vec<(String, String, String)> {
    let (Some(a), Some(b)) = (a, b) else {
        let there = |side: Option<&Side>| if side.is_some() { "there" } else { "not there" }.to_owned();
        return vec![("the stage".to_owned(), there(a), there(b))];
    };
    let mut paths: Vec<&String> = a.settings.keys().chain(b.settings.keys()).collect();
    paths.sort_unstable();
    paths.dedup();
    let value = |side: &Side, path: &String| side.settings.get(path).cloned().unwrap_or_else(|| "–".to_owned());
    let differ = paths.into_iter().filter(|path| a.settings.get(*path) != b.settings.get(*path));
    differ.map(|path| (path.clone(), value(a, path), value(b, path))).collect()
}

/// One line per difference of results.
fn results(a: Option<&Side>, b: Option<&Side>, store: &Store) -> Result<Vec<String>, Exit> {
    let (Some(a), Some(b)) = (a, b) else { return Ok(Vec::new()) };
    let (a, b) = match (a.object, b.object) {
        (a, b) if a == b => return Ok(Vec::new()),
        (Some(a), Some(b)) => (a, b),
        (None, _) => return Ok(vec!["no result on the first side".to_owned()]),
        (_, None) => return Ok(vec!["no result on the second side".to_owned()]),
    };
    let load = |content: &ContentHash| store.get(content).map_err(|e| system(&e));
    Ok(compare(&*load(&a)?, &*load(&b)?))
}

fn compare(a: &Artifact, b: &Artifact) -> Vec<String> {
    // A recorded run does not say what its workflow declared, so both sides are in the units of the field.
    let field = Context::default();
    let (a, b) = (&presented(a, &field), &presented(b, &field));
    let mut lines = Vec::new();
    for (name, old) in a.tables() {
        match b.table(&name) {
            None => lines.push(format!("{name}: only on the first side")),
            Some(new) => lines.extend(compare_tables(&name, old, new)),
        }
    }
    if lines.is_empty() {
        lines.push("the results differ outside their tables".to_owned());
    }
    lines
}

fn compare_tables(name: &str, a: &Table, b: &Table) -> Vec<String> {
    if a.rows() != b.rows() {
        return vec![format!("{name}: {} rows → {} rows", a.rows(), b.rows())];
    }
    let mut lines = Vec::new();
    for old in &a.columns {
        let Some(new) = b.column(&old.name) else {
            lines.push(format!("{name}.{}: only on the first side", old.name));
            continue;
        };
        match (&old.values, &new.values) {
            (values, others) if values == others && old.unit == new.unit => {}
            (Values::Reals(x), Values::Reals(y)) => {
                // The same number of kilopascals and of megapascals differs, whatever the digits say.
                let units = [&old.unit, &new.unit].map(String::as_str);
                lines.push(format!("{name}.{}: {}", old.name, largest(x, y, units)));
            }
            (_, _) => lines.push(format!("{name}.{}: other values", old.name)),
        }
    }
    lines
}

/// How many values differ, and the largest relative change, in the units of both sides.
fn largest(a: &[f64], b: &[f64], units: [&str; 2]) -> String {
    let there: Vec<f64> = match Conversion::between(units[1], units[0]) {
        Ok(to) => to.of_all(b.to_vec()),
        Err(_) => return format!("in {} → in {}", units[0], units[1]),
    };
    let b = there.as_slice();
    let differ: Vec<(usize, f64)> = (0..a.len())
        .filter(|&i| a[i].to_bits() != b[i].to_bits())
        .map(|i| (i, ((b[i] - a[i]) / a[i].abs().max(b[i].abs())).abs()))
        .collect();
    let most = differ.iter().max_by(|x, y| x.1.total_cmp(&y.1));
    most.map_or_else(String::new, |&(i, change)| {
        format!(
            "{} of {} values differ, most in row {}: {} ({:.2} %)",
            differ.len(),
            a.len(),
            i + 1,
            format!("{} → {} {}", digits(a[i], b[i]), digits(b[i], a[i]), units[0]).trim_end(),
            100.0 * change
        )
    })
}

/// A value with six significant digits, or with all where six do not tell it from the other.
fn digits(value: f64, other: f64) -> String {
    let short = |value: f64| format!("{value:.5e}").parse::<f64>().unwrap_or(value);
    let shown = if short(value) == short(other) { value } else { short(value) };
    let size = shown.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{shown:e}") } else { shown.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::{ArtifactKind, Group, Node};

    #[test]
    fn values_have_the_digits_that_tell_them_apart() {
        assert_eq!(digits(31.234_567_89, 30.0), "31.2346");
        assert_eq!(digits(0.1 + 0.2, 0.3), "0.30000000000000004");
        assert_eq!([digits(1.5e-9, 1.0), digits(0.0, 1.0), digits(f64::NAN, 1.0)], ["1.5e-9", "0", "NaN"]);
    }

    #[test]
    fn results_that_differ_are_told_in_the_units_of_the_field() {
        let table = |value: f64| Table::default().reals_column("UCS", "Pa", "", vec![1e6, value]);
        let made = |value| Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(table(value))));
        let wanted = "runs.UCS: 1 of 2 values differ, most in row 2: 30.1235 → 31 MPa (2.83 %)";
        assert_eq!(compare(&made(30_123_456.7), &made(31e6)), [wanted]);
    }
}
