//! What factors set: a microparameter of a material, or a number of a stage.

use super::collect::{Check, steps};
use super::fault::Fault;
use super::node::{Node, Table};
use crate::stage::material::{self, Microparameter, Value};
use crate::stage::vary::with_values;
use crate::stage::{Context, Factor};
use crate::unit::{Dimension, Unit};
use math::scale::Scale;
use math::text::typed;
use std::collections::BTreeSet;

/// Levels of a factor that are tried in the settings of a stage.
const MOST_TRIED: usize = 64;

impl Check<'_> {
    /// What factors set must be there, and of the kind that their units say.
    pub(super) fn settings(&mut self, root: &Table, context: &Context) {
        let Some(factors) = root.0.get("factor").map(|entry| &entry.node) else { return };
        let something = !context.materials.is_empty() || !context.templates.is_empty();
        if !something || !self.lost.is_empty() {
            return;
        }
        for (name, factor) in &context.factors {
            for path in &factor.sets {
                let one = One { factors, name, factor, path };
                match path.split_once('.') {
                    Some((stage, key)) if context.sketches.contains_key(stage) => {
                        self.stage_setting(context, &one, stage, key);
                    }
                    _ => self.microparameter(context, &one),
                }
            }
        }
    }

    fn stage_setting(&mut self, context: &Context, one: &One<'_>, stage: &str, key: &str) {
        let One { factors, name, factor, path } = *one;
        let at = steps([name, "sets"]);
        if context.materials.values().any(|material| material.entries.contains_key(stage)) {
            let message = format!("`{path}` is ambiguous: `{stage}` is a stage, and a group of a material");
            self.complain(factors, &at, Fault::new(message).hint("give the stage or the group another name"));
            return;
        }
        let varies = context.sketches.get(stage).is_some_and(|sketch| sketch.varies);
        let Some(template) = context.templates.get(stage).filter(|_| varies) else {
            let message =
                format!("factor `{name}` sets `{path}`, and stage `{stage}` makes no specimen and runs no test");
            let known = context.sketches.iter().filter(|(_, sketch)| sketch.varies).map(|(name, _)| name.as_str());
            self.complain(factors, &at, Fault::new(message).known(stage, "stages with settable numbers", known));
            return;
        };
        let base: Vec<String> = crate::stage::read(template.kind, template.table.clone())
            .and_then(Result::ok)
            .map_or_else(Vec::new, |stage| stage.check(context).into_iter().map(|fault| fault.message).collect());
        for value in factor.levels.iter().chain(factor.range.iter().flatten()).take(MOST_TRIED) {
            let faults = match with_values(template, &[(key, factor, *value)]) {
                Err(error) => vec![error.message],
                Ok(stage) => stage.check(context).into_iter().map(|fault| fault.message).collect(),
            };
            if let Some(fault) = faults.into_iter().find(|fault| !base.contains(fault)) {
                let message = format!("factor `{name}` sets `{path}` to {}: {fault}", with_unit(*value, factor));
                self.complain(factors, &at, Fault::new(message));
                return;
            }
        }
    }

    fn microparameter(&mut self, context: &Context, one: &One<'_>) {
        let One { factors, name, factor, path } = *one;
        let mut takers = context.materials.iter().filter(|(_, material)| material.takes(path)).peekable();
        let parameter = path.split_once('.').and_then(|(_, key)| Microparameter::from_key(key));
        // A material that a stage gives has the groups of the specimens.
        let group = path.split_once('.').map_or("", |(group, _)| group);
        let by_stage =
            parameter.is_some() && context.sketches.values().any(|sketch| sketch.groups.iter().any(|own| own == group));
        if takers.peek().is_none() && !by_stage {
            let paths: BTreeSet<String> = context.materials.values().flat_map(|material| material.paths()).collect();
            let stages = context.sketches.iter().filter(|(_, sketch)| sketch.varies).map(|(name, _)| name.as_str());
            let known: Vec<&str> = paths.iter().map(String::as_str).chain(stages).collect();
            let fault = Fault::new(format!("no material and no stage has `{path}`, which factor `{name}` sets"));
            self.complain(factors, &steps([name, "sets"]), fault.known(path, "parameters and stages", known));
        }
        let Ok(unit) = Unit::parse(&factor.unit) else { return };
        if let Some(parameter) =
            parameter.filter(|one| takers.peek().is_none() && !material::measures(*one, unit.dimension))
        {
            let quantity = parameter.declaration().quantity;
            let message = format!("factor `{name}` is not in a unit of `{path}`, which it sets");
            self.complain(
                factors,
                &steps([name, "unit"]),
                Fault::new(message).hint(format!("`{path}` is written as {}", quantity.example())),
            );
        }
        for (material, values) in takers {
            let other = match values.get(path) {
                // A deviation may be given as a stress and varied as a share of the mean.
                _ if parameter.is_some_and(|parameter| material::measures(parameter, unit.dimension)) => false,
                Some(Value::Given(found)) => found.dimension != unit.dimension,
                Some(Value::Formula(_)) | None => parameter.is_some(),
            };
            if other {
                let unit = if unit.dimension == Dimension::NONE {
                    "a pure number".to_owned()
                } else {
                    format!("in {}", factor.unit)
                };
                let fault = Fault::new(format!("factor `{name}` is {unit}, and `{path}`, which it sets, is not"));
                let hint = format!("give it the unit that `{path}` has in [material.{material}]");
                self.complain(factors, &steps([name, "unit"]), fault.hint(hint));
                return;
            }
        }
        let Some(range) = parameter.map(|parameter| parameter.declaration().range) else { return };
        let all = factor.levels.iter().chain(factor.range.iter().flatten());
        if let Some(value) = all.copied().find(|value| !range.holds(value * unit.factor)) {
            let key = if factor.levels.contains(&value) { "levels" } else { "range" };
            let found = with_unit(value, factor);
            let message = format!("factor `{name}` sets `{path}` to {found}; it must be {}", range.words());
            self.complain(factors, &steps([name, key]), Fault::new(message));
        }
    }

    /// A logarithmic scale needs positive values.
    pub(super) fn scale(&mut self, name: &str, factor: &Factor, node: &Node) {
        let all = factor.levels.iter().chain(factor.range.iter().flatten());
        if let (Scale::Log, Some(value)) = (factor.scale, all.copied().find(|value| *value <= 0.0)) {
            let found = with_unit(value, factor);
            let message = format!("factor `{name}` has a logarithmic scale and the value {found}");
            self.complain(node, &steps(["scale"]), Fault::new(message).hint("equal ratios need values above 0"));
        }
    }
}

/// A value of a factor in its unit.
fn with_unit(value: f64, factor: &Factor) -> String {
    format!("{} {}", typed(value), factor.unit).trim_end().to_owned()
}

/// One path of a factor.
struct One<'a> {
    factors: &'a Node,
    name: &'a str,
    factor: &'a Factor,
    path: &'a str,
}
