//! As much of JSON Schema 2020-12 as the schema of workflows uses; a keyword that is not known here is a fault of the test.

use regex_lite::Regex;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Every fault of `value` under `root`, with its pointer.
pub(crate) fn faults(root: &Value, value: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    check(root, root, value, "", &mut faults);
    faults
}

/// Checks, and gives the names of the properties that were looked at.
fn check(root: &Value, schema: &Value, value: &Value, at: &str, faults: &mut Vec<String>) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let schema = match schema {
        Value::Bool(true) => return seen,
        Value::Bool(false) => {
            faults.push(format!("{at}: nothing may stand here"));
            return seen;
        }
        Value::Object(schema) => schema,
        other => panic!("{other} is no schema"),
    };
    for (keyword, rule) in schema {
        let passes = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "examples" | "format" | "deprecated" => true,
            "additionalProperties" | "unevaluatedProperties" => true, // after the others
            "type" => types(rule).contains(&type_of(value)) || types(rule).contains(&"number") && value.is_number(),
            "const" => value == rule,
            "enum" => items(rule).contains(value),
            "minimum" => value.as_f64().is_none_or(|v| v >= number(rule)),
            "maximum" => value.as_f64().is_none_or(|v| v <= number(rule)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|v| v > number(rule)),
            "exclusiveMaximum" => value.as_f64().is_none_or(|v| v < number(rule)),
            "minLength" => value.as_str().is_none_or(|v| v.chars().count() as f64 >= number(rule)),
            "pattern" => value.as_str().is_none_or(|v| pattern(rule).is_match(v)),
            "minItems" => value.as_array().is_none_or(|v| v.len() as f64 >= number(rule)),
            "maxItems" => value.as_array().is_none_or(|v| v.len() as f64 <= number(rule)),
            "uniqueItems" => value
                .as_array()
                .is_none_or(|list| !(1..list.len()).any(|i| list[..i].iter().any(|v| same(v, &list[i])))),
            "minProperties" => value.as_object().is_none_or(|v| v.len() as f64 >= number(rule)),
            "required" => {
                value.as_object().is_none_or(|v| items(rule).iter().all(|name| v.contains_key(name.as_str().unwrap())))
            }
            "propertyNames" => {
                value.as_object().is_none_or(|v| v.keys().all(|name| passes(root, rule, &Value::String(name.clone()))))
            }
            "items" => {
                let prefix = schema.get("prefixItems").map_or(0, |prefix| items(prefix).len());
                for (i, item) in value.as_array().into_iter().flatten().enumerate().skip(prefix) {
                    check(root, rule, item, &format!("{at}/{i}"), faults);
                }
                true
            }
            "prefixItems" => {
                for (i, (item, rule)) in value.as_array().into_iter().flatten().zip(items(rule)).enumerate() {
                    check(root, rule, item, &format!("{at}/{i}"), faults);
                }
                true
            }
            "properties" => {
                for (name, rule) in rule.as_object().unwrap() {
                    if let Some(inner) = value.get(name) {
                        check(root, rule, inner, &format!("{at}/{name}"), faults);
                        seen.insert(name.clone());
                    }
                }
                true
            }
            "$ref" => {
                let pointer = rule.as_str().and_then(|path| path.strip_prefix('#')).unwrap();
                let target = root.pointer(pointer).unwrap_or_else(|| panic!("{pointer} is not in the schema"));
                seen.extend(check(root, target, value, at, faults));
                true
            }
            "allOf" => {
                items(rule).iter().for_each(|rule| seen.extend(check(root, rule, value, at, faults)));
                true
            }
            "anyOf" | "oneOf" => {
                let fits: Vec<&Value> = items(rule).iter().filter(|rule| passes(root, rule, value)).collect();
                fits.iter().for_each(|rule| seen.extend(check(root, rule, value, at, &mut Vec::new())));
                fits.len() == 1 || keyword == "anyOf" && !fits.is_empty()
            }
            unknown => panic!("the validator does not know `{unknown}`"),
        };
        if !passes {
            faults.push(format!("{at}: `{keyword}`"));
        }
    }
    others(root, schema, value, at, &mut seen, faults);
    seen
}

/// Properties that nothing else has looked at.
fn others(
    root: &Value,
    schema: &Map<String, Value>,
    value: &Value,
    at: &str,
    seen: &mut BTreeSet<String>,
    faults: &mut Vec<String>,
) {
    let own = schema.get("properties").and_then(Value::as_object);
    for (keyword, looked_at) in [("additionalProperties", false), ("unevaluatedProperties", true)] {
        let Some(rule) = schema.get(keyword) else { continue };
        for (name, inner) in value.as_object().into_iter().flatten() {
            let known = if looked_at { seen.contains(name) } else { own.is_some_and(|own| own.contains_key(name)) };
            if !known {
                check(root, rule, inner, &format!("{at}/{name}"), faults);
                seen.insert(name.clone());
            }
        }
    }
}

fn passes(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut faults = Vec::new();
    check(root, schema, value, "", &mut faults);
    faults.is_empty()
}

/// Equality of JSON Schema: `1` and `1.0` are one number.
fn same(a: &Value, b: &Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => a == b,
        _ => a == b,
    }
}

fn type_of(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.as_f64().is_some_and(|real| real.fract() == 0.0) => "integer",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

fn types(rule: &Value) -> Vec<&str> {
    rule.as_array()
        .map_or_else(|| vec![rule.as_str().unwrap()], |list| list.iter().map(|t| t.as_str().unwrap()).collect())
}

fn items(rule: &Value) -> &Vec<Value> {
    rule.as_array().unwrap()
}

fn number(rule: &Value) -> f64 {
    rule.as_f64().unwrap()
}

fn pattern(rule: &Value) -> Regex {
    Regex::new(rule.as_str().unwrap()).unwrap()
}

#[test]
fn it_refuses_what_each_keyword_refuses() {
    let refused = |schema: &str, value: &str| {
        let read = |text: &str| serde_json::from_str::<Value>(text).unwrap();
        !passes(&read(schema), &read(schema), &read(value))
    };
    assert!(refused(r#"{"type": "integer"}"#, "1.5") && !refused(r#"{"type": "integer"}"#, "1.0"));
    assert!(refused(r#"{"type": ["string", "null"]}"#, "1") && !refused(r#"{"type": "number"}"#, "1"));
    assert!(refused(r#"{"oneOf": [{"type": "number"}, {"const": 1}]}"#, "1"));
    assert!(refused(r#"{"anyOf": [{"type": "string"}, {"const": 1}]}"#, "2"));
    assert!(refused(r##"{"$ref": "#/$defs/a", "$defs": {"a": {"maximum": 3}}}"##, "4"));
    assert!(refused(r#"{"properties": {"a": true}, "additionalProperties": false}"#, r#"{"b": 1}"#));
    let parts = r#"{"allOf": [{"properties": {"a": true}}], "unevaluatedProperties": false}"#;
    assert!(refused(parts, r#"{"b": 1}"#) && !refused(parts, r#"{"a": 1}"#));
    assert!(refused(r#"{"uniqueItems": true}"#, "[1, 2, 1.0]") && refused(r#"{"items": {"minimum": 0}}"#, "[1, -1]"));
    assert!(
        refused(r#"{"propertyNames": {"pattern": "^a"}}"#, r#"{"b": 1}"#) && refused(r#"{"required": ["a"]}"#, "{}")
    );
}
