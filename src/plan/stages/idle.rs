//! Materials, and groups and pairs of them, that no stage uses: a warning, or a fault where a name is surely a slip.
//!
//! A pair under a name that is no pair is the worst of them: its contacts then follow the rule `pairs`, and nobody sees it.

use super::super::fault::nearest;
use super::{Check, Configured, Context, Fault, Looked, Node, steps};
use crate::stage::material::{Entry, Material, Value};
use std::collections::BTreeSet;

/// Who uses a material, and for which groups.
struct Use<'a> {
    material: &'a Material,
    /// Groups of the specimens of the stages that use it.
    groups: BTreeSet<&'a str>,
    /// Whether all groups that can be asked for are known: no external program uses it, whose templates name what they like.
    known: bool,
    /// Whether any stage uses it.
    used: bool,
}

impl<'a> Use<'a> {
    fn of(name: &str, material: &'a Material, stages: &'a [Configured], context: &'a Context) -> Self {
        let mut found = Self { material, groups: BTreeSet::new(), known: true, used: false };
        for stage in stages.iter().filter(|stage| stage.stage.sketch().material.as_deref() == Some(name)) {
            found.used = true;
            let specimens = stage.ports.iter().filter(|port| port.key == "specimen").flat_map(|port| &port.stages);
            let mut groups = specimens.filter_map(|stage| context.sketches.get(stage)).flat_map(|made| &made.groups);
            let first = groups.next();
            found.known &= first.is_some();
            found.groups.extend(first.into_iter().chain(groups).map(String::as_str));
        }
        let own: Vec<&str> = found.own().collect();
        // The only group of a specimen takes the only group of a material, whatever they are called.
        if let ([only], 1) = (&own[..], found.groups.len()) {
            found.groups.insert(only);
        }
        found
    }

    /// The groups of the material.
    fn own(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let material = self.material;
        let single = move |name: &&String| material.groups_of(name).len() == 1;
        material.entries.keys().filter(single).map(String::as_str)
    }

    fn uses(&self, name: &str) -> bool {
        self.material.groups_of(name).iter().all(|group| self.groups.contains(group)) || self.is_named(name)
    }

    /// Whether a formula of another entry takes a value of this one.
    fn is_named(&self, name: &str) -> bool {
        let start = format!("{}_", name.replace('-', "_"));
        let names = |value: &Value| match value {
            Value::Formula(formula) => formula.names().iter().any(|own| own.starts_with(&start)),
            Value::Given(_) => false,
        };
        let others = self.material.entries.iter().filter(|(other, _)| *other != name);
        others.flat_map(|(_, entry)| entry.values.values()).any(names)
    }

    /// A group that an entry names and that is none.
    fn slip(&self, name: &'a str, entry: &'a Entry) -> Option<&'a str> {
        let own: Vec<&str> = self.own().filter(|group| !group.contains('-')).collect();
        let is = |group: &str| own.contains(&group) || self.groups.contains(group);
        if let Some(between) = &entry.between {
            return between.iter().map(String::as_str).find(|group| !is(group));
        }
        let (a, b) = name.split_once('-').filter(|_| !self.uses(name))?;
        match (is(a), is(b)) {
            (true, false) => Some(b),
            (false, true) => Some(a),
            _ => None,
        }
    }
}

/// Complains about what no stage uses.
pub(super) fn tell(
    check: &mut Check<'_>,
    materials: Option<&Node>,
    stages: &[Configured],
    context: &Context,
    looked: &mut Looked<'_>,
) {
    let Some(node) = materials else { return };
    for (name, material) in &context.materials {
        let found = Use::of(name, material, stages, context);
        let warn = |check: &Check<'_>, path: &[&str], message: String, hint: String| {
            let at = node.nearest(&steps(path.iter().copied())).span;
            Fault::new(message).at(check.sources.location(at)).hint(hint)
        };
        if !found.used {
            let hint = format!("say `material = \"{name}\"` in a stage, or leave it out");
            looked.warnings.push(warn(check, &[name], format!("no stage uses [material.{name}]"), hint));
            continue;
        }
        if !found.known {
            continue;
        }
        for (entry, content) in &material.entries {
            if let Some(wrong) = found.slip(entry, content) {
                let groups: Vec<&str> = found.own().filter(|group| *group != entry).collect();
                let mean = nearest(wrong, groups.iter().copied()).map(|near| format!("did you mean `{near}`? "));
                let message = format!("`{entry}` of [material.{name}] is a pair with `{wrong}`, which is no group");
                let hint = format!("{}the groups are {}", mean.unwrap_or_default(), groups.join(", "));
                check.complain(node, &steps([name.as_str(), entry.as_str()]), Fault::new(message).hint(hint));
            } else if !found.uses(entry) {
                let message = format!("no stage uses `{entry}` of [material.{name}]: no specimen has such contacts");
                let groups = found.groups.iter().copied().collect::<Vec<_>>().join(", ");
                let hint = format!("leave it out, or check its name; the specimens have {groups}");
                looked.warnings.push(warn(check, &[name, entry], message, hint));
            }
        }
    }
}
