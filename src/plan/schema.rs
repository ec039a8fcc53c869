//! The JSON Schema of a workflow file (draft 2020-12), made from the types that read it, so that editors complete and
//! check the file. What only the whole file shows (names of stages, kinds of artifacts, cycles) is beyond a schema.

use super::collect::NAME_PATTERN;
use super::file::{FactorTable, Head, ResponseTable};
use crate::stage::KINDS;
use crate::stage::material::MaterialTable;
use schemars::{Schema, SchemaGenerator, generate::SchemaSettings};
use serde_json::{Map, Value, json};

/// Where `#:schema` lines of shipped workflows point.
pub const FILE_NAME: &str = "flow.schema.json";

/// The schema of the whole file.
pub fn schema() -> Value {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let head = generator.subschema_for::<Head>();
    let named = |description: &str, schema: Schema| {
        json!({
            "type": "object",
            "description": description,
            "propertyNames": { "pattern": NAME_PATTERN },
            "additionalProperties": schema,
        })
    };
    let factor = named("What designs vary, by name.", generator.subschema_for::<FactorTable>());
    let response = named("What runs are measured by, by name.", generator.subschema_for::<ResponseTable>());
    let material = named("Microparameters by contact, by name.", generator.subschema_for::<MaterialTable>());
    let kinds: Vec<Value> = KINDS.iter().map(|kind| stage(kind, &mut generator)).collect();
    let overrides =
        |what: &str| json!({ "type": "object", "additionalProperties": { "type": "object" }, "description": what });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "flow workflow",
        "description": "A campaign of numerical experiments with bonded-particle models.",
        "type": "object",
        "required": ["workflow", "stage"],
        "additionalProperties": false,
        "properties": {
            "workflow": head,
            "factor": factor,
            "response": response,
            "material": material,
            "stage": {
                "type": "object",
                "description": "The steps of the campaign, by name.",
                "minProperties": 1,
                "propertyNames": { "pattern": NAME_PATTERN },
                "additionalProperties": { "oneOf": kinds },
            },
            "profile": {
                "type": "object",
                "description": "Sets of overrides, by name: `--profile NAME` lays one over the file.",
                "additionalProperties": {
                    "type": "object",
                    "additionalProperties": false,
                    "properties": {
                        "workflow": { "type": "object", "description": "Overrides of [workflow]." },
                        "factor": overrides("Overrides of factors."),
                        "response": overrides("Overrides of responses."),
                        "material": overrides("Overrides of materials."),
                        "stage": overrides("Overrides of stages."),
                    },
                },
            },
        },
        "$defs": generator.take_definitions(true),
    })
}

/// The schema of a stage of one kind, with its `kind`.
fn stage(kind: &crate::stage::KindEntry, generator: &mut SchemaGenerator) -> Value {
    let mut schema = (kind.schema)(generator).to_value();
    let Some(object) = schema.as_object_mut() else { return schema };
    object.insert("title".to_owned(), json!(kind.name));
    object.insert("description".to_owned(), json!(kind.about));
    let tag = json!({ "const": kind.name, "description": kind.about });
    let properties = object.entry("properties").or_insert_with(|| Value::Object(Map::new()));
    if let Some(properties) = properties.as_object_mut() {
        properties.insert("kind".to_owned(), tag);
        let about = "Title of the stage in the report and in lists; no result depends on it.";
        properties.insert("title".to_owned(), json!({ "type": "string", "description": about }));
    }
    let required = object.entry("required").or_insert_with(|| json!([]));
    if let Some(required) = required.as_array_mut() {
        required.insert(0, json!("kind"));
    }
    let parts = PARTS.iter().any(|part| object.contains_key(*part));
    object.remove("additionalProperties");
    object.insert(if parts { "unevaluatedProperties" } else { "additionalProperties" }.to_owned(), json!(false));
    schema
}

/// Where a schema has alternatives and parts.
const PARTS: [&str; 3] = ["oneOf", "anyOf", "allOf"];

/// All keys of a stage of this kind, for messages.
pub(super) fn keys(kind: &str) -> Vec<String> {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let mut keys = Vec::new();
    for entry in KINDS.iter().filter(|entry| entry.name == kind) {
        let schema = (entry.schema)(&mut generator).to_value();
        collect_keys(&schema, generator.definitions(), &mut keys);
    }
    keys.push("title".to_owned());
    keys.sort_unstable();
    keys.dedup();
    keys
}

fn collect_keys(schema: &Value, definitions: &Map<String, Value>, keys: &mut Vec<String>) {
    if let Some(properties) = schema.get("properties").and_then(Value::as_object) {
        keys.extend(properties.keys().cloned());
    }
    let parts = PARTS.iter().filter_map(|part| schema.get(part)?.as_array()).flatten();
    let name = schema.get("$ref").and_then(Value::as_str).and_then(|path| path.rsplit('/').next());
    for part in parts.chain(name.and_then(|name| definitions.get(name))) {
        collect_keys(part, definitions, keys);
    }
}
