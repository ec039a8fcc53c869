//! Reads typed values from the tree, and finds every fault on the way.
//!
//! serde stops at the first fault. Here a fault knows the path to the value it is about, so that value is replaced by a
//! *hole*, which reads as whatever is wanted, and the reading begins again: the next fault appears, until none is left. A
//! missing key becomes a hole in the same way, an unknown key is taken out.
//!
//! Types with `flatten`, `tag` or `untagged` make serde copy a table before it looks inside, and the path ends there.
//! Then the value is looked for by taking out one after the other: the one without which the fault is another is the one
//! ([`narrow`]). The copy also lets unknown keys pass; a key is unknown when its value may be of a type that does not
//! exist ([`unread_key`]).

use super::fault::Fault;
use super::node::{Entry, Node, Sources, Step, Value, shortened};
use super::reader::{Cause, Reader, Unread};
use crate::unit::{Dimension, Unit, UnitError, split_any};
use std::slice;

/// Most faults that are reported of one table.
const MOST_FAULTS: usize = 20;

/// Tables and lists with more values are not searched.
const MOST_SEARCHED: usize = 64;

/// Reads `node` with `read`; every fault goes to `faults`, and the value is given only when there is none. `known` gives
/// the keys of the table for a message, when the type itself does not give them.
pub(super) fn read<T>(
    node: &mut Node,
    sources: &Sources,
    faults: &mut Vec<Fault>,
    known: impl Fn() -> Vec<String>,
    read: impl Fn(Reader<'_>) -> Result<T, Unread>,
) -> Option<T> {
    let before = faults.len();
    let whole = faults.is_empty() || !node.has_hole();
    let value = loop {
        let error = match read(Reader(node)) {
            Ok(value) => break value,
            Err(error) => error,
        };
        let reported = tell(node, &error, sources, &read);
        let stop = reported.is_none() || faults.len() - before >= MOST_FAULTS;
        faults.extend(reported);
        if stop {
            // The fault of a hole was reported when the hole was made.
            assert!(!faults.is_empty(), "BUG: a table cannot be read, and no fault says why");
            return None;
        }
    };
    while let Some(mut path) = unread_key(node, &mut Vec::new(), &|node| read(Reader(node)).is_ok()) {
        let Some(Step::Key(name)) = path.pop() else { break };
        let names = if path.is_empty() { known() } else { Vec::new() };
        faults.extend(unknown(node, &path, &name, &names, sources));
    }
    (whole && faults.len() == before).then_some(value)
}

/// The fault with its location; the tree is changed so that the next reading gets past it. `None` when the error is a
/// consequence of faults that were reported.
fn tell<T>(
    node: &mut Node,
    error: &Unread,
    sources: &Sources,
    read: &impl Fn(Reader<'_>) -> Result<T, Unread>,
) -> Option<Fault> {
    let path = error.path();
    match &error.cause {
        Cause::Missing(name) => missing(node, &path, name, sources),
        Cause::Unknown(name, known) => {
            let known: Vec<String> = known.iter().map(|&name| name.to_owned()).collect();
            unknown(node, &path, name, &known, sources)
        }
        Cause::Word(word, known) => {
            let path = narrow(node, path, error, read);
            let fault = Fault::new(format!("`{}` is not one of the known words", shortened(word)));
            wrong(node, &path, sources, |_| fault.known(word, "words", known.iter().copied()))
        }
        Cause::Wanted(wanted) => {
            let path = narrow(node, path, error, read);
            wrong(node, &path, sources, |found| {
                let fault = Fault::new(format!("wanted {wanted}, found {}", found.describe()));
                match as_number(wanted, found) {
                    Some(hint) => fault.hint(hint),
                    None => fault,
                }
            })
        }
        Cause::Other(message) => {
            let path = narrow(node, path, error, read);
            wrong(node, &path, sources, |_| Fault::new(message))
        }
    }
}

/// How a number is written that stands as a text.
fn as_number(wanted: &str, found: &Node) -> Option<String> {
    let Value::Text(text) = &found.value else { return None };
    if !wanted.ends_with("number") {
        return None;
    }
    let text = match split_any(text) {
        Err(UnitError::Comma(_, meant)) => meant,
        _ => text.clone(),
    };
    let (value, unit) = split_any(&text).ok()?;
    let is_share = Unit::parse(unit).is_ok_and(|unit| unit.dimension == Dimension::NONE);
    Some(match unit {
        "" => format!("write it without quotes: {value}"),
        // The quotient is the nearest number; a product with 0.01 is not.
        "%" => format!("write the share: {}", value / 100.0),
        "‰" => format!("write the share: {}", value / 1000.0),
        _ if is_share => format!("write the number alone: {value}"),
        unit => format!("write the number alone: {value}; where it counts in `{unit}`, the unit is a key of its own"),
    })
}

/// The path to the value that the error is about. Below the path that the error itself knows, only values that were
/// copied first can be meant; it is followed as long as there is just one without which the error is another. The word
/// that says how to read the others (a tag) is meant only when the error is about a word.
fn narrow<T>(
    node: &Node,
    mut path: Vec<Step>,
    error: &Unread,
    read: &impl Fn(Reader<'_>) -> Result<T, Unread>,
) -> Vec<Step> {
    loop {
        let steps = node.nearest(&path).steps();
        if steps.len() > MOST_SEARCHED {
            return path;
        }
        let after = |change: &dyn Fn(&mut Node)| {
            let mut changed = node.clone();
            changed.find_mut(&path).map(change);
            read(Reader(&changed)).err()
        };
        let copied = |step: &Step| {
            let probed = after(&|found| found.find_mut(slice::from_ref(step)).into_iter().for_each(Node::make_probe));
            probed.filter(|probed| probed.path().get(path.len()) != Some(step))
        };
        let decides = |step: &&Step| {
            let about_it = |probed: Unread| !probed.is_about_a_word() || error.is_about_a_word();
            copied(step).is_some_and(about_it) && after(&|found| found.remove(step)).as_ref() != Some(error)
        };
        let mut deciding = steps.iter().filter(decides);
        match (deciding.next(), deciding.next()) {
            (Some(step), None) => path.push(step.clone()),
            _ => return path,
        }
    }
}

/// The path of a key that nothing reads, below `path`.
fn unread_key(root: &mut Node, path: &mut Vec<Step>, reads: &impl Fn(&Node) -> bool) -> Option<Vec<Step>> {
    let steps = root.nearest(path).steps();
    if steps.len() > MOST_SEARCHED {
        return None;
    }
    for step in steps {
        let named = matches!(step, Step::Key(_));
        path.push(step);
        let value = std::mem::replace(&mut root.find_mut(path)?.value, Value::Probe);
        let unread = named && reads(root);
        root.find_mut(path)?.value = value;
        if unread {
            return Some(path.clone());
        }
        let inner = unread_key(root, path, reads);
        if inner.is_some() {
            return inner;
        }
        path.pop();
    }
    None
}

/// Reports the missing key and puts a hole there; `None` when one was there already.
fn missing(node: &mut Node, path: &[Step], name: &str, sources: &Sources) -> Option<Fault> {
    let location = sources.location(node.nearest(path).span);
    let found = node.find_mut(path)?;
    let span = found.span;
    let Value::Table(table) = &mut found.value else { return None };
    if table.0.contains_key(name) {
        return None;
    }
    table.0.insert(name.to_owned(), Entry { key: span, node: Node { span, value: Value::Hole } });
    Some(Fault::new(format!("missing key `{name}`")).at(location).label(format!("`{name}` is needed here")))
}

/// Reports the unknown key and takes it out.
fn unknown(node: &mut Node, path: &[Step], name: &str, known: &[String], sources: &Sources) -> Option<Fault> {
    let Some(Value::Table(table)) = node.find_mut(path).map(|found| &mut found.value) else { return None };
    let entry = table.0.remove(name)?;
    let fault = Fault::new(format!("unknown key `{}`", shortened(name))).at(sources.location(entry.key));
    Some(if known.is_empty() { fault } else { fault.known(name, "keys", known.iter().map(String::as_str)) })
}

/// Reports what is wrong with a value and puts a hole there; `None` when it is one already.
fn wrong(node: &mut Node, path: &[Step], sources: &Sources, tell: impl FnOnce(&Node) -> Fault) -> Option<Fault> {
    let found = node.find_mut(path)?;
    if matches!(found.value, Value::Hole) {
        return None;
    }
    let fault = tell(found).at(sources.location(found.span));
    found.value = Value::Hole;
    Some(fault)
}

#[cfg(test)]
mod tests;
