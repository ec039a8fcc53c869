//! Materials from the result of a stage: microparameters by formula, or a calibrated set.
//!
//! * A run (of a `formula` or `command` stage) gives values by name: `sigma_c` for every group, `rock_sigma_c` for one. They
//!   replace those of the stage's own `material`, if it has one.
//! * A solution gives factors; they are applied to the material of the calibration, or that of its simulator.

use super::{Entry, Material, Microparameter, PairRule, Value};
use crate::artifact::calibration::Solution;
use crate::artifact::run::{Responses, Run};
use crate::artifact::{Artifact, ArtifactKind};
use crate::stage::{Context, Parameter, Point, StageError};
use crate::unit::Unit;

/// A material and a point of the factor space.
pub struct GivenMaterial {
    /// The values.
    pub material: Material,
    /// Values of factors, in their units.
    pub point: Point,
}

/// The material in the result of stage `name`; `set` counts the sets of a solution from 1, `groups` are those of the specimen.
///
/// # Errors
/// The artifact holds no microparameters, or not this set.
pub fn given(
    name: &str,
    artifact: &Artifact,
    set: usize,
    groups: &[String],
    context: &Context,
) -> Result<GivenMaterial, StageError> {
    let base = base(name, context);
    if !artifact.is(ArtifactKind::SOLUTION) {
        let run = Run::from_artifact(artifact)?;
        if !run.failure.is_empty() {
            return Err(StageError::new(format!("stage `{name}` gives no material: {}", run.failure)));
        }
        let material = overlaid(base.unwrap_or_default(), &run.responses, groups)?;
        return Ok(GivenMaterial { material, point: Point::new() });
    }
    let Some(material) = base else {
        let message = format!("stage `{name}` gives factors, and there is no material to put them into");
        return Err(StageError::new(message).hint("give the calibration its `material`"));
    };
    let solution = Solution::from_artifact(artifact)?.solution;
    let mut point = Point::new();
    for column in &solution.point.columns {
        if let Some(factor) = context.factors.get(&column.name) {
            let values = column.numbers(&factor.unit)?;
            let value = values.get(set.wrapping_sub(1)).copied().filter(|value| value.is_finite());
            let value = value.ok_or_else(|| {
                let message = format!("stage `{name}` gives {} sets, and set {set} is asked for", values.len());
                StageError::new(message).hint("say `set = 1` for the first")
            })?;
            point.insert(column.name.clone(), value);
        }
    }
    Ok(GivenMaterial { material, point })
}

/// The material of a stage: its own, or that of its simulator.
fn base(name: &str, context: &Context) -> Option<Material> {
    let mut name = name;
    // A calibration names a simulator; a simulator names a material, or a stage whose result is one.
    for _ in 0..context.sketches.len() {
        let sketch = context.sketches.get(name)?;
        match (&sketch.material, &sketch.simulator) {
            (Some(material), _) if context.materials.contains_key(material) => {
                return context.materials.get(material).cloned();
            }
            (Some(other), _) | (None, Some(other)) => name = other,
            (None, None) => return None,
        }
    }
    None
}

/// The material with the responses of a run in place of its values.
fn overlaid(mut material: Material, responses: &Responses, groups: &[String]) -> Result<Material, StageError> {
    if material.entries.is_empty() {
        material.pairs = Some(PairRule::Weaker);
        material.entries = groups.iter().map(|name| (name.clone(), Entry::default())).collect();
    }
    let names: Vec<String> = material.entries.keys().cloned().collect();
    for ((response, value), unit) in responses.response.iter().zip(&responses.value).zip(&responses.unit) {
        let unit = Unit::parse(unit).map_err(|e| StageError::new(format!("`{response}`: {e}")))?;
        let found = Value::Given(Parameter { value: value * unit.factor, dimension: unit.dimension });
        let of_one = |name: &String| {
            let key = response.strip_prefix(&name.replace('-', "_"))?.strip_prefix('_')?;
            Microparameter::from_key(key).map(|parameter| (name.clone(), parameter))
        };
        let places: Vec<(String, Microparameter)> = match Microparameter::from_key(response) {
            Some(parameter) => {
                let groups = names.iter().filter(|name| material.groups_of(name).len() == 1);
                groups.map(|name| (name.clone(), parameter)).collect()
            }
            None => names.iter().filter_map(of_one).collect(),
        };
        if places.is_empty() {
            let message = format!("`{response}` is no microparameter of a group");
            let hint = format!("name it as `sigma_c`, or as `GROUP_sigma_c` with a group out of {}", names.join(", "));
            return Err(StageError::new(message).hint(hint));
        }
        for (name, parameter) in places {
            material.entries.entry(name).or_default().values.insert(parameter.key().to_owned(), found.clone());
        }
    }
    Ok(material)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn responses(all: &[(&str, f64, &str)]) -> Responses {
        Responses {
            response: all.iter().map(|one| one.0.to_owned()).collect(),
            value: all.iter().map(|one| one.1).collect(),
            unit: all.iter().map(|one| one.2.to_owned()).collect(),
        }
    }

    #[test]
    fn values_of_a_run_stand_for_all_groups_or_for_one() {
        let groups = ["mortar".to_owned(), "stone".to_owned()];
        let run = responses(&[("kn", 17.0, "MN/m"), ("stone_kn", 5.0, "MN/m"), ("mu", 0.5, "")]);
        let made = overlaid(Material::default(), &run, &groups).unwrap().resolve_alone();
        assert_eq!(made["mortar.kn"].value, 17e6);
        assert_eq!(made["stone.kn"].value, 5e6);
        assert_eq!(made["stone.mu"].value, 0.5);
        let error = overlaid(Material::default(), &responses(&[("UCS", 1.0, "Pa")]), &groups).unwrap_err();
        assert_eq!(error.message, "`UCS` is no microparameter of a group");
    }
}
