//! A workflow as a tree of values with their locations.

use super::fault::{Location, Source};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A stretch of one of the [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Span {
    /// Which source: 0 is the file, the `--set` options follow.
    pub(super) source: u32,
    /// First byte.
    pub(super) start: u32,
    /// Byte after the last.
    pub(super) end: u32,
}

/// The texts that spans point into.
pub(super) struct Sources(pub(super) Vec<Arc<Source>>);

impl Sources {
    /// Adds a text; gives the span of all of it.
    pub(super) fn add(&mut self, name: &str, text: &str) -> Span {
        self.0.push(Arc::new(Source { name: name.to_owned(), text: text.to_owned() }));
        Span { source: self.0.len() as u32 - 1, start: 0, end: text.len() as u32 }
    }

    /// The location of a span.
    pub(super) fn location(&self, span: Span) -> Location {
        let source = Arc::clone(&self.0[span.source as usize]);
        Location { source, span: span.start as usize..span.end as usize }
    }
}

/// One value of the tree.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Its location.
    pub(super) span: Span,
    /// What it is.
    pub(super) value: Value,
}

/// What a value can be.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Int(i64),
    Real(f64),
    Flag(bool),
    /// A date or time. No workflow value is one, so only its text is stored, for messages.
    Date(String),
    List(Vec<Node>),
    Table(Table),
    /// A value whose fault is reported already: it reads as whatever is wanted.
    Hole,
    /// A value of a type that no setting has: it is a fault wherever it is read.
    Probe,
}

/// Named values; names are unique.
#[derive(Clone, Debug, Default)]
pub(super) struct Table(pub(super) BTreeMap<String, Entry>);

/// A value in a table, with the location of its name.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Location of its name.
    pub(super) key: Span,
    /// The value.
    pub(super) node: Node,
}

/// One step from a value to a value inside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

impl Table {
    /// Names in the order of the file.
    pub(super) fn in_order(&self) -> Vec<(&str, &Entry)> {
        let mut entries: Vec<_> = self.0.iter().map(|(name, entry)| (name.as_str(), entry)).collect();
        entries.sort_by_key(|(_, entry)| entry.key);
        entries
    }

    /// The value called `name`.
    pub(super) fn get(&self, name: &str) -> Option<&Node> {
        self.0.get(name).map(|entry| &entry.node)
    }
}

impl Node {
    /// As a table.
    pub(super) fn table(&self) -> Option<&Table> {
        match &self.value {
            Value::Table(table) => Some(table),
            Value::Text(_)
            | Value::Int(_)
            | Value::Real(_)
            | Value::Flag(_)
            | Value::Date(_)
            | Value::List(_)
            | Value::Hole
            | Value::Probe => None,
        }
    }

    /// As JSON: what a table says, without its locations.
    pub(super) fn json(&self) -> serde_json::Value {
        use serde_json::Value as Json;
        match &self.value {
            Value::Text(text) | Value::Date(text) => Json::String(text.clone()),
            Value::Int(number) => Json::from(*number),
            Value::Real(number) => Json::from(*number),
            Value::Flag(flag) => Json::Bool(*flag),
            Value::List(list) => Json::Array(list.iter().map(Self::json).collect()),
            Value::Table(table) => {
                Json::Object(table.0.iter().map(|(name, entry)| (name.clone(), entry.node.json())).collect())
            }
            Value::Hole | Value::Probe => Json::Null,
        }
    }

    /// The value at the end of `path`.
    pub(super) fn find_mut(&mut self, path: &[Step]) -> Option<&mut Self> {
        path.iter().try_fold(self, |node, step| match (&mut node.value, step) {
            (Value::Table(table), Step::Key(key)) => table.0.get_mut(key).map(|entry| &mut entry.node),
            (Value::List(list), Step::Index(i)) => list.get_mut(*i),
            _ => None,
        })
    }

    /// The value at the end of `path`, or the last one on the way there.
    pub(super) fn nearest(&self, path: &[Step]) -> &Self {
        let mut node = self;
        for step in path {
            let next = match (&node.value, step) {
                (Value::Table(table), Step::Key(key)) => table.get(key),
                (Value::List(list), Step::Index(i)) => list.get(*i),
                (Value::List(list), Step::Key(key)) => key.parse().ok().and_then(|i: usize| list.get(i)),
                _ => None,
            };
            match next {
                Some(next) => node = next,
                None => break,
            }
        }
        node
    }

    /// The steps to the values inside it.
    pub(super) fn steps(&self) -> Vec<Step> {
        match &self.value {
            Value::Table(table) => table.0.keys().cloned().map(Step::Key).collect(),
            Value::List(list) => (0..list.len()).map(Step::Index).collect(),
            Value::Text(_)
            | Value::Int(_)
            | Value::Real(_)
            | Value::Flag(_)
            | Value::Date(_)
            | Value::Hole
            | Value::Probe => Vec::new(),
        }
    }

    /// Whether it, or a value inside it, was faulty.
    pub(super) fn has_hole(&self) -> bool {
        match &self.value {
            Value::Hole => true,
            Value::List(list) => list.iter().any(Self::has_hole),
            Value::Table(table) => table.0.values().any(|entry| entry.node.has_hole()),
            Value::Text(_) | Value::Int(_) | Value::Real(_) | Value::Flag(_) | Value::Date(_) | Value::Probe => false,
        }
    }

    /// Puts a value of no known type here.
    pub(super) fn make_probe(&mut self) {
        self.value = Value::Probe;
    }

    /// Takes out the value at one step.
    pub(super) fn remove(&mut self, step: &Step) {
        match (&mut self.value, step) {
            (Value::Table(table), Step::Key(key)) => drop(table.0.remove(key)),
            (Value::List(list), Step::Index(i)) if *i < list.len() => drop(list.remove(*i)),
            _ => {}
        }
    }

    /// What it is, in a person's words.
    pub(super) fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("the text {}", shortened(&format!("{text:?}"))),
            Value::Int(value) => format!("the number {value}"),
            // With its point: 1.0 is no whole number.
            Value::Real(value) => format!("the number {value:?}"),
            Value::Flag(value) => format!("{value}"),
            Value::Date(text) => format!("the date {text}"),
            Value::List(list) => format!("a list of {} value{}", list.len(), if list.len() == 1 { "" } else { "s" }),
            Value::Table(_) => "a table".to_owned(),
            Value::Hole | Value::Probe => "nothing".to_owned(),
        }
    }
}

/// A long text cut for a message.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    text.chars().take(MOST - 1).chain(['…']).collect()
}
