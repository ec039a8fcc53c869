//! Profiles and `--set`: values laid over those of the file, by path. Tables merge, everything else is replaced.
//!
//! An override of a stage, factor or response must name one that exists. Unknown keys are found when the merged table is
//! read, and the fault then points at the profile or the option.

use super::collect::MOST_FAULTS;
use super::fault::Fault;
use super::node::{Entry, Node, Sources, Span, Table, Value};
use super::syntax;

/// Tables of named things: their names must exist.
const NAMED: [(&str, &str); 4] =
    [("stage", "stages"), ("factor", "factors"), ("response", "responses"), ("material", "materials")];

/// Names of the file's profiles.
pub(super) fn names(root: &Table) -> Vec<String> {
    match root.0.get("profile").map(|entry| &entry.node.value) {
        Some(Value::Table(table)) => table.in_order().into_iter().map(|(name, _)| name.to_owned()).collect(),
        Some(_) | None => Vec::new(),
    }
}

/// Takes `[profile]` out of the root, checks every profile's paths, and lays the named one over it.
pub(super) fn profile(root: &mut Table, name: Option<&str>, sources: &mut Sources, faults: &mut Vec<Fault>) {
    let profiles = root.0.remove("profile").map(|entry| entry.node);
    let none = Table::default();
    let table = match &profiles {
        None => &none,
        Some(node) => node.table().unwrap_or_else(|| {
            let message = format!("wanted tables such as [profile.quick.stage.NAME], found {}", node.describe());
            faults.push(Fault::new(message).at(sources.location(node.span)));
            &none
        }),
    };
    for (name, entry) in table.in_order() {
        match entry.node.table() {
            Some(table) => check_paths(root, table, &format!("profile `{name}`"), sources, faults),
            None => faults
                .push(Fault::new(format!("profile `{name}` is not a table")).at(sources.location(entry.node.span))),
        }
    }
    let Some(name) = name else { return };
    match table.get(name).map(Node::table) {
        Some(Some(profile)) => lay_over(root, profile),
        Some(None) => {}
        None => {
            let whole = sources.add("--profile", name);
            let fault = Fault::new(format!("there is no profile `{name}`")).at(sources.location(whole));
            faults.push(fault.known(name, "profiles", table.in_order().into_iter().map(|(name, _)| name)));
        }
    }
}

/// Lays the options `path=value` over the root. Two that give one value are a fault: nobody would see which of them counts.
pub(super) fn sets(root: &mut Table, sets: &[String], sources: &mut Sources, faults: &mut Vec<Fault>) {
    let mut earlier = Table::default();
    for set in sets {
        let whole = sources.add("--set", set);
        match option(set, sources, whole) {
            Ok(table) => {
                let before = faults.len();
                check_paths(root, &table, "the option", sources, faults);
                if let Some((first, second)) = clash(&earlier, &table) {
                    let fault = Fault::new(format!("`{set}` gives what an option before it gives"));
                    let fault = fault.at(sources.location(second)).hint("leave one of them out");
                    faults.push(fault.also(sources.location(first), "the other one"));
                }
                if faults.len() == before {
                    lay_over(root, &table);
                    lay_over(&mut earlier, &table);
                }
            }
            Err(mut new) => faults.append(&mut new),
        }
    }
}

/// The keys of a value that both tables give, whole or a part of it.
fn clash(earlier: &Table, later: &Table) -> Option<(Span, Span)> {
    later.in_order().into_iter().find_map(|(name, own)| {
        let other = earlier.0.get(name)?;
        match (other.node.table(), own.node.table()) {
            (Some(earlier), Some(later)) => clash(earlier, later),
            _ => Some((other.key, own.key)),
        }
    })
}

/// The tables that `path=value` stands for.
fn option(set: &str, sources: &Sources, whole: Span) -> Result<Table, Vec<Fault>> {
    let form = "write --set stage.NAME.key=value";
    let refused = |message: String| vec![Fault::new(message).at(sources.location(whole)).hint(form)];
    let (path, text) = set.split_once('=').ok_or_else(|| refused(format!("`{set}` has no `=`")))?;
    let steps = path_steps(path).ok_or_else(|| refused(format!("`{}` is not a path of keys", path.trim())))?;
    let offset = set.len() - text.trim_start().len();
    let span = Span { start: offset as u32, ..whole };
    let text_node = |text: &str| Node { span, value: Value::Text(text.trim().to_owned()) };
    let node = syntax::value(sources, whole.source, offset).unwrap_or_else(|_| text_node(text));
    let key = Span { end: path.len() as u32, ..whole };
    let nested = steps.into_iter().rev().fold(node, |node, step| {
        let table = Table([(step, Entry { key, node })].into());
        Node { span: key, value: Value::Table(table) }
    });
    match nested.value {
        Value::Table(table) => Ok(table),
        _ => Err(refused("the path is empty".to_owned())),
    }
}

/// The keys of a dotted path as TOML writes them.
fn path_steps(path: &str) -> Option<Vec<String>> {
    if path.contains(['\n', '\r', '#', '=', '{', '[']) {
        return None;
    }
    let document: toml::Table = toml::from_str(&format!("{path} = 0")).ok()?;
    let mut steps = Vec::new();
    let mut table = &document;
    loop {
        let (name, value) = table.iter().next()?;
        steps.push(name.clone());
        match value {
            toml::Value::Table(inner) => table = inner,
            _ => return Some(steps),
        }
    }
}

/// What the overlay names must be there.
fn check_paths(root: &Table, over: &Table, whose: &str, sources: &Sources, faults: &mut Vec<Fault>) {
    for (name, entry) in over.in_order() {
        let location = sources.location(entry.key);
        let Some((_, things)) = NAMED.iter().find(|(key, _)| *key == name) else {
            if name != "workflow" {
                let fault = Fault::new(format!("{whose} cannot set `{name}`")).at(location);
                faults.push(fault.known(name, "keys", ["workflow", "factor", "response", "material", "stage"]));
            }
            continue;
        };
        let Some(table) = entry.node.table() else {
            let message = format!("{whose} must name one of the {things} below `{name}`");
            faults.push(Fault::new(message).at(location));
            continue;
        };
        let known = root.get(name).and_then(Node::table);
        for (inner, entry) in table.in_order() {
            if faults.len() > MOST_FAULTS {
                return;
            }
            if known.is_some_and(|known| known.0.contains_key(inner)) {
                continue;
            }
            let fault = Fault::new(format!("{whose} sets `{name}.{inner}`, which does not exist"));
            let names = known.map(Table::in_order).unwrap_or_default();
            faults.push(fault.at(sources.location(entry.key)).known(
                inner,
                things,
                names.into_iter().map(|(name, _)| name),
            ));
        }
    }
}

fn lay_over(base: &mut Table, over: &Table) {
    for (name, entry) in &over.0 {
        match (base.0.get_mut(name), &entry.node.value) {
            (Some(Entry { node: Node { value: Value::Table(base), .. }, .. }), Value::Table(over)) => {
                lay_over(base, over)
            }
            (Some(found), _) => *found = Entry { key: found.key.min(entry.key), node: entry.node.clone() },
            (None, _) => {
                base.0.insert(name.clone(), entry.clone());
            }
        }
    }
}
