//! Factors that set numbers of a stage: the stage is read again with the value of the point in its table.
//!
//! A factor may set any number of a stage that makes specimens or runs tests (`sets = "disc.radius_ratio"`: stage and
//! key). The value is written into the table in the factor's unit, as a file would have it, and the kind of stage reads the
//! table; so a factor can set every number that the kind can read, with the same units, ranges and faults.

use super::{Context, Factor, Point, Stage, StageError, Task};
use crate::unit::Unit;
use serde_json::{Map, Value};

/// The table of a stage from the file and its overrides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Template {
    /// Kind of the stage.
    pub kind: &'static str,
    /// Its table without `kind`.
    pub table: Value,
}

/// The stage `name` with the values that factors of the point set; `None` when no factor sets one of its values.
///
/// # Errors
/// A factor sets a key that the stage does not have, or a value that it does not accept.
pub fn varied(context: &Context, name: &str, point: &Point) -> Result<Option<Box<dyn Stage>>, StageError> {
    let mut set = Vec::new();
    for (factor, value) in point {
        let known = context.factors.get(factor);
        for path in known.iter().flat_map(|factor| &factor.sets) {
            if let (Some((stage, key)), Some(factor)) = (path.split_once('.'), known)
                && stage == name
            {
                set.push((key, factor, *value));
            }
        }
    }
    if set.is_empty() {
        return Ok(None);
    }
    let template = context.templates.get(name);
    let template = template.ok_or_else(|| StageError::new(format!("there is no stage `{name}` to set values of")))?;
    with_values(template, &set).map(Some)
}

/// The stage of a template with values in its table.
///
/// # Errors
/// As [`varied`].
pub fn with_values(template: &Template, set: &[(&str, &Factor, f64)]) -> Result<Box<dyn Stage>, StageError> {
    let mut table = template.table.clone();
    for (key, factor, value) in set {
        let forms = forms(factor, *value);
        let mut first = None;
        let taken = forms.into_iter().find_map(|form| {
            let mut tried = table.clone();
            put(&mut tried, key, form)?;
            match read(template.kind, &tried) {
                Ok(_) => Some(tried),
                Err(why) => {
                    first.get_or_insert(why);
                    None
                }
            }
        });
        table = taken.ok_or_else(|| {
            let why = first.unwrap_or_else(|| format!("`{key}` lies below a value that is no table"));
            StageError::new(format!("`{key}` cannot be {value} {}: {why}", factor.unit))
        })?;
    }
    read(template.kind, &table).map_err(StageError::new)
}

/// A value of a factor as a file would write it: a quantity, or a number.
fn forms(factor: &Factor, value: f64) -> Vec<Value> {
    let number =
        |value: f64| if value.fract() == 0.0 && value.abs() < 1e15 { (value as i64).into() } else { value.into() };
    if factor.unit.is_empty() {
        return vec![number(value)];
    }
    let factor_of = Unit::parse(&factor.unit).map_or(1.0, |unit| unit.factor);
    vec![Value::String(format!("{value} {}", factor.unit)), number(value * factor_of)]
}

/// Sets the value at a path of keys, and makes tables that are missing.
fn put(table: &mut Value, path: &str, value: Value) -> Option<()> {
    let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
    let table = table.as_object_mut()?;
    match rest {
        None => drop(table.insert(first.to_owned(), value)),
        Some(rest) => put(table.entry(first).or_insert_with(|| Value::Object(Map::new())), rest, value)?,
    }
    Some(())
}

fn read(kind: &str, table: &Value) -> Result<Box<dyn Stage>, String> {
    super::read(kind, table.clone())
        .unwrap_or_else(|| panic!("BUG: kind `{kind}` is in the list"))
        .map_err(|e| e.to_string())
}

/// The task that runs a point on replicate `number` with the simulator `name`, whose own settings the point may set.
///
/// # Errors
/// As [`Stage::sample`] and [`varied`].
pub fn sample(stage: &dyn Stage, known: &super::Known, point: &Point, number: u64) -> Result<Task, StageError> {
    match varied(known.context, known.name, point)? {
        Some(other) => other.sample(known, point, number),
        None => stage.sample(known, point, number),
    }
}

/// The task that makes replicate `number` of a stage with the settings of the point; `None` when the point sets none of
/// them.
///
/// # Errors
/// As [`varied`]; or the stage has no replicates, or refuses its settings.
pub fn replicate(known: &super::Known, point: &Point, number: u64) -> Result<Option<Task>, StageError> {
    let (context, name) = (known.context, known.name);
    let Some(stage) = varied(context, name, point)? else { return Ok(None) };
    let task = stage.replicate(known, number).ok_or_else(|| {
        let faults: Vec<String> = stage.check(context).into_iter().map(|fault| fault.message).collect();
        let why = if faults.is_empty() { "it cannot make replicates".to_owned() } else { faults.join("; ") };
        StageError::new(format!("stage `{name}`: {why}"))
    })?;
    Ok(Some(task))
}
