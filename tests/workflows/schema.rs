//! The schema accepts every shipped and every good file and refuses every bad one. The judge is a small validator of our own
//! ([`super::validator`]); `tests/reference/schema.py` lets an independent one judge the same files.

use super::corpus::files;
use super::validator::faults;
use flow::plan::schema::schema;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A TOML file as JSON; a number that JSON does not have becomes null. `None` when it is not TOML.
fn as_json(path: &Path) -> Option<Value> {
    fn convert(value: toml::Value) -> Value {
        match value {
            toml::Value::String(text) => json!(text),
            toml::Value::Integer(whole) => json!(whole),
            toml::Value::Float(real) => json!(real),
            toml::Value::Boolean(flag) => json!(flag),
            toml::Value::Datetime(date) => json!({ "date": date.to_string() }),
            toml::Value::Array(list) => list.into_iter().map(convert).collect(),
            toml::Value::Table(table) => table.into_iter().map(|(name, value)| (name, convert(value))).collect(),
        }
    }
    let table: toml::Table = toml::from_str(&fs::read_to_string(path).unwrap()).ok()?;
    Some(convert(toml::Value::Table(table)))
}

#[test]
fn good_files_are_accepted() {
    let schema = schema();
    for path in [files("workflows"), files("tests/good"), files("tests/bad/beyond-schema")].concat() {
        let found = faults(&schema, &as_json(&path).unwrap());
        assert!(found.is_empty(), "{}:\n{}", path.display(), found.join("\n"));
    }
}

#[test]
fn bad_files_are_refused() {
    let schema = schema();
    for path in files("tests/bad") {
        let refused = as_json(&path).is_none_or(|value| !faults(&schema, &value).is_empty());
        assert!(refused, "{} is accepted: is its fault beyond a schema?", path.display());
    }
}

/// Every stage offers its own keys only, so that an editor completes them.
#[test]
fn every_kind_is_an_alternative_of_its_own() {
    let schema = schema();
    let kinds = schema["properties"]["stage"]["additionalProperties"]["oneOf"].as_array().unwrap();
    let names: Vec<&str> = kinds.iter().map(|kind| kind["properties"]["kind"]["const"].as_str().unwrap()).collect();
    assert_eq!(names, flow::stage::KINDS.iter().map(|kind| kind.name).collect::<Vec<_>>());
    for kind in kinds {
        let closed = |key: &str| kind[key] == json!(false);
        assert!(
            closed("additionalProperties") || closed("unevaluatedProperties"),
            "{} lets any key pass",
            kind["title"]
        );
    }
}
