//! A material of the workflow as the calibrator writes it out.

use crate::stage::Context;
use crate::stage::material::BondKind;
use serde::Serialize;
use std::collections::BTreeMap;

/// A material: the entries with their values.
#[derive(Serialize)]
pub(super) struct Values {
    name: String,
    entries: Vec<Entry>,
}

/// Contacts within a group, or between two.
#[derive(Serialize)]
struct Entry {
    name: String,
    groups: Vec<String>,
    bonded: bool,
    /// Values by key, SI units.
    values: BTreeMap<String, f64>,
}

/// The material of this name; none when a stage gives it.
pub(super) fn values(context: &Context, name: &str) -> Option<Values> {
    let material = context.materials.get(name)?;
    let values = material.resolve_alone();
    let entry = |(own, entry): (&String, &crate::stage::material::Entry)| {
        let prefix = format!("{own}.");
        let of = |(path, value): (&String, &crate::stage::Parameter)| {
            path.strip_prefix(&prefix).map(|key| (key.to_owned(), value.value))
        };
        Entry {
            name: own.clone(),
            groups: material.groups_of(own).into_iter().map(str::to_owned).collect(),
            bonded: entry.bond != Some(BondKind::None),
            values: values.iter().filter_map(of).collect(),
        }
    };
    Some(Values { name: name.to_owned(), entries: material.entries.iter().map(entry).collect() })
}
