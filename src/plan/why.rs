//! Why a task has another key than the last time: two task texts, compared fact by fact.
//!
//! The texts are those that the keys are hashes of ([`key`](super::key)), so texts with different keys always have a
//! reason, and equal ones never.

use std::collections::BTreeMap;
use std::fmt;

/// One thing that is different.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    /// There is no earlier text.
    New,
    /// The task is done by another function.
    Work {
        /// Its name before.
        old: String,
        /// Its name now.
        new: String,
    },
    /// The function has another version: its results have changed.
    Version {
        /// Name of the function.
        work: String,
        /// Version before.
        old: String,
        /// Version now.
        new: String,
    },
    /// The seed; `None` where the task draws no random numbers.
    Seed {
        /// Before.
        old: Option<String>,
        /// Now.
        new: Option<String>,
    },
    /// A parameter; `None` where it has none, or its default.
    Param {
        /// Its path, such as `mortar.Ec`.
        path: String,
        /// Before.
        old: Option<String>,
        /// Now.
        new: Option<String>,
    },
    /// Files of one name.
    File(Changed),
    /// Inputs of one name.
    Input(Changed),
    /// The same facts in another order or form.
    Form,
}

/// How the files or inputs of one name have changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Changed {
    /// Their name.
    pub name: String,
    /// How many there are now.
    pub of: usize,
    /// How many have another content.
    pub changed: usize,
    /// How many are new.
    pub added: usize,
    /// How many are gone.
    pub removed: usize,
}

/// What is different in the text `new`; `old` is empty when there is no earlier one.
pub fn why(old: &str, new: &str) -> Vec<Reason> {
    if old.is_empty() {
        return vec![Reason::New];
    }
    if old == new {
        return Vec::new();
    }
    let (old, new) = (Facts::read(old), Facts::read(new));
    let mut reasons = Vec::new();
    let owned = |text: &str| text.to_owned();
    if old.work != new.work {
        reasons.push(Reason::Work { old: owned(old.work), new: owned(new.work) });
    } else if old.version != new.version {
        reasons.push(Reason::Version { work: owned(new.work), old: owned(old.version), new: owned(new.version) });
    }
    if old.seed != new.seed {
        reasons.push(Reason::Seed { old: old.seed.map(owned), new: new.seed.map(owned) });
    }
    for (path, old, new) in pairs(&old.params, &new.params).filter(|(_, old, new)| old != new) {
        reasons.push(Reason::Param { path: owned(path), old: old.map(|x| owned(x)), new: new.map(|x| owned(x)) });
    }
    let change = |(name, old, new)| Changed::between(name, old, new);
    reasons.extend(pairs(&old.files, &new.files).filter_map(change).map(Reason::File));
    reasons.extend(pairs(&old.inputs, &new.inputs).filter_map(change).map(Reason::Input));
    if reasons.is_empty() { vec![Reason::Form] } else { reasons }
}

/// The facts of a task text.
#[derive(Default)]
struct Facts<'t> {
    work: &'t str,
    version: &'t str,
    seed: Option<&'t str>,
    params: BTreeMap<&'t str, &'t str>,
    files: BTreeMap<&'t str, Vec<&'t str>>,
    inputs: BTreeMap<&'t str, Vec<&'t str>>,
}

impl<'t> Facts<'t> {
    fn read(text: &'t str) -> Self {
        let mut facts = Self::default();
        for line in text.lines() {
            let (fact, rest) = line.split_once(' ').unwrap_or((line, ""));
            let (name, value) = split_name(rest);
            match fact {
                "work" => (facts.work, facts.version) = (name, value),
                "seed" => facts.seed = Some(rest),
                "param" => drop(facts.params.insert(name, value)),
                "file" => facts.files.entry(name).or_default().push(value),
                "input" => facts.inputs.entry(name).or_default().push(value),
                _ => {}
            }
        }
        facts
    }
}

/// A name, whose quoted parts may hold spaces, and the value behind it.
fn split_name(text: &str) -> (&str, &str) {
    let (mut quoted, mut escaped) = (false, false);
    for (i, byte) in text.bytes().enumerate() {
        match byte {
            b' ' if !quoted => return (&text[..i], &text[i + 1..]),
            b'"' if !escaped => quoted = !quoted,
            _ => {}
        }
        escaped = byte == b'\\' && !escaped;
    }
    (text, "")
}

/// The values that two maps have under each name of either, in the order of the names.
fn pairs<'m, V>(
    old: &'m BTreeMap<&str, V>,
    new: &'m BTreeMap<&str, V>,
) -> impl Iterator<Item = (&'m str, Option<&'m V>, Option<&'m V>)> {
    let mut names: Vec<&str> = old.keys().chain(new.keys()).copied().collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(|name| (name, old.get(name), new.get(name)))
}

impl Changed {
    fn between(name: &str, old: Option<&Vec<&str>>, new: Option<&Vec<&str>>) -> Option<Self> {
        let (old, new) = (old.map_or(&[][..], Vec::as_slice), new.map_or(&[][..], Vec::as_slice));
        let name = name.to_owned();
        if old == new {
            return None;
        }
        if old.len() == new.len() {
            let changed = old.iter().zip(new).filter(|(old, new)| old != new).count();
            return Some(Self { name, of: new.len(), changed, added: 0, removed: 0 });
        }
        let mut counts: BTreeMap<&str, i64> = BTreeMap::new();
        new.iter().for_each(|hash| *counts.entry(hash).or_default() += 1);
        old.iter().for_each(|hash| *counts.entry(hash).or_default() -= 1);
        let more = |sign: i64| counts.values().map(|count| (sign * count).max(0) as usize).sum::<usize>();
        let (added, removed) = (more(1), more(-1));
        let changed = added.min(removed);
        Some(Self { name, of: new.len(), changed, added: added - changed, removed: removed - changed })
    }
}

impl fmt::Display for Changed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.name)?;
        match self {
            Self { of: 1, changed: 1, .. } => return f.write_str(" changed"),
            Self { of: 1, added: 1, .. } => return f.write_str(" is new"),
            Self { of: 0, removed: 1, .. } => return f.write_str(" is gone"),
            _ => {}
        }
        let parts = [(self.changed, "changed"), (self.added, "new"), (self.removed, "gone")];
        let parts: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        write!(f, ": {} of {}", parts.join(", "), self.of)
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: &Option<String>, none: &str| value.as_deref().map_or_else(|| none.to_owned(), shortened);
        match self {
            Self::New => f.write_str("new"),
            Self::Work { old, new } => write!(f, "work {old} → {new}"),
            Self::Version { work, old, new } => write!(f, "{work}: version {old} → {new}"),
            Self::Seed { old, new } => write!(f, "seed {} → {}", shown(old, "none"), shown(new, "none")),
            Self::Param { path, old, new } => {
                write!(f, "`{path}` {} → {}", shown(old, "not set"), shown(new, "not set"))
            }
            Self::File(changed) => write!(f, "file {changed}"),
            Self::Input(changed) => write!(f, "input {changed}"),
            Self::Form => f.write_str("the form of the task text"),
        }
    }
}

/// A value short enough for a line of a report.
fn shortened(value: &str) -> String {
    super::node::shortened(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::ContentHash;
    use crate::plan::key::{key, task_text};
    use crate::stage::Task;
    use proptest::prelude::*;
    use serde_json::{Value, json};

    fn text(params: Value, seed: u64, runs: &[u8]) -> String {
        let contents: Vec<ContentHash> = runs.iter().map(|&run| ContentHash([run; 32])).collect();
        let task = Task::new("data", params).seed(seed);
        let task = contents.iter().fold(task, |task, content| task.input("run", *content));
        task_text(&task, &contents)
    }

    fn reasons(old: &str, new: &str) -> Vec<String> {
        why(old, new).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn every_reason_reads_as_old_and_new() {
        let old = text(json!({"mortar": {"Ec": 2e10}, "a b": "x y"}), 1, &[1, 2, 3]);
        assert_eq!(reasons("", &old), ["new"]);
        let new = text(json!({"mortar": {"Ec": 1.6e10, "mu": 0.5}}), 2, &[1, 9, 3]);
        let expected = [
            "seed 1 → 2",
            "`\"a b\"` \"x y\" → not set",
            "`mortar.Ec` 2e10 → 1.6e10",
            "`mortar.mu` not set → 0.5",
            "input `run`: 1 changed of 3",
        ];
        assert_eq!(reasons(&old, &new), expected);
        let version = crate::stage::work("data").unwrap().version;
        let earlier = new.replace(&format!("work data {version}"), "work data 0");
        assert_eq!(reasons(&earlier, &new), [format!("data: version 0 → {version}")]);
        assert_eq!(reasons(&text(json!({}), 1, &[1, 2]), &text(json!({}), 1, &[2, 1, 5])), ["input `run`: 1 new of 3"]);
        assert_eq!(reasons(&text(json!({}), 1, &[1]), &text(json!({}), 1, &[2])), ["input `run` changed"]);
    }

    /// Any JSON without floats that print alike: names and texts may hold anything.
    fn params() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            (-3_i64..3).prop_map(Value::from),
            (-2.0..2.0_f64).prop_map(Value::from),
            "[a. \"\\\\\n\\[]{0,4}".prop_map(Value::from),
        ];
        leaf.prop_recursive(3, 12, 3, |inner| {
            prop_oneof![
                proptest::collection::vec(inner.clone(), 0..3).prop_map(Value::from),
                proptest::collection::btree_map("[a. \"\\\\\n]{0,3}", inner, 0..3)
                    .prop_map(|map| Value::Object(map.into_iter().collect())),
            ]
        })
    }

    /// What the key regards as one: whole and real numbers, and what is null or empty at the top.
    fn canonical(value: &Value) -> Value {
        match value {
            Value::Number(number) => json!(number.as_f64().map(|real| real + 0.0)),
            Value::Array(list) => list.iter().map(canonical).collect(),
            Value::Object(map) => {
                Value::Object(map.iter().filter(|x| !x.1.is_null()).map(|(k, v)| (k.clone(), canonical(v))).collect())
            }
            Value::Null | Value::Bool(_) | Value::String(_) => value.clone(),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn keys_differ_exactly_when_the_parameters_do(a in params(), b in params()) {
            let (old, new) = (text(json!({"p": [a]}), 1, &[]), text(json!({"p": [b]}), 1, &[]));
            prop_assert_eq!(key(&old) == key(&new), canonical(&a) == canonical(&b), "{} {}", old, new);
            prop_assert_eq!(why(&old, &new).is_empty(), key(&old) == key(&new));
        }
    }
}
