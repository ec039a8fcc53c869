//! Reads `[material.NAME]`, and its schema for editors.

use super::{Entry, Material, PairRule, Value};
use crate::expression::Expression;
use crate::stage::Parameter;
use crate::unit::{Dimension, parse_any};
use dem::Distribution;
use dem::loading::material::BondKind;
use dem::parameter;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, MapAccess};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::fmt;

/// `[material.NAME]`: microparameters by contact, such as `rock = { Ec = "20 GPa", mu = 0.5 }`.
#[derive(Debug)]
pub struct MaterialTable(pub Material);

impl<'de> Deserialize<'de> for MaterialTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> de::Visitor<'de> for Visitor {
            type Value = MaterialTable;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of groups such as `rock = { Ec = \"20 GPa\", kn_ks = 2.5, mu = 0.5 }`")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<MaterialTable, A::Error> {
                let mut material = Material::default();
                while let Some(key) = map.next_key::<String>()? {
                    if key == "pairs" {
                        material.pairs = Some(map.next_value::<PairRule>()?);
                    } else {
                        material.entries.insert(key, map.next_value::<EntryTable>()?.0);
                    }
                }
                Ok(MaterialTable(material))
            }
            /// A value whose fault is reported already.
            fn visit_unit<E: de::Error>(self) -> Result<MaterialTable, E> {
                Ok(MaterialTable(Material::default()))
            }
        }
        deserializer.deserialize_map(Visitor)
    }
}

struct EntryTable(Entry);

impl<'de> Deserialize<'de> for EntryTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> de::Visitor<'de> for Visitor {
            type Value = EntryTable;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of microparameters such as { Ec = \"20 GPa\", kn_ks = 2.5, mu = 0.5 }")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<EntryTable, A::Error> {
                let mut entry = Entry::default();
                while let Some(key) = map.next_key::<String>()? {
                    match key.as_str() {
                        "between" => entry.between = Some(map.next_value()?),
                        "bond" => entry.bond = Some(map.next_value::<BondKind>()?),
                        "distribution" => entry.distribution = Some(map.next_value::<Distribution>()?),
                        _ => drop(entry.values.insert(key, map.next_value::<ValueText>()?.0)),
                    }
                }
                Ok(EntryTable(entry))
            }
            fn visit_unit<E: de::Error>(self) -> Result<EntryTable, E> {
                Ok(EntryTable(Entry::default()))
            }
        }
        deserializer.deserialize_map(Visitor)
    }
}

/// A quantity of any kind, or a formula; its key decides later which kind is right.
struct ValueText(Value);

impl<'de> Deserialize<'de> for ValueText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Value;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a number, a quantity with its unit such as \"16 GPa\", or a formula such as \"sigma_c / 2\"",
                )
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Value, E> {
                match (parse_any(text), Expression::parse(text)) {
                    (Ok((value, dimension)), _) => Ok(Value::Given(Parameter { value, dimension })),
                    (Err(_), Ok(formula)) if !formula.names().is_empty() => Ok(Value::Formula(formula)),
                    (Err(error), _) => Err(E::custom(error)),
                }
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Value, E> {
                Ok(Value::Given(Parameter { value, dimension: Dimension::NONE }))
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Value, E> {
                self.visit_f64(value as f64)
            }
            /// A value whose fault is reported already.
            fn visit_unit<E: de::Error>(self) -> Result<Value, E> {
                self.visit_f64(1.0)
            }
        }
        deserializer.deserialize_any(Visitor).map(Self)
    }
}

impl JsonSchema for MaterialTable {
    fn schema_name() -> Cow<'static, str> {
        "material".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let entry = generator.subschema_for::<EntryTable>();
        let rule = generator.subschema_for::<PairRule>();
        json_schema!({
            "type": "object",
            "description": "Microparameters by contact: an entry is a group by any name, or a pair of groups.",
            "properties": { "pairs": {
                "allOf": [rule],
                "description": "Values of pairs of groups that have no entry: the smaller (`weaker`) or the mean of each.",
            } },
            "additionalProperties": entry,
        })
    }
}

impl JsonSchema for EntryTable {
    fn schema_name() -> Cow<'static, str> {
        "contact".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (bond, distribution) = (generator.subschema_for::<BondKind>(), generator.subschema_for::<Distribution>());
        let mut properties = serde_json::Map::new();
        let types = serde_json::json!(["string", "number"]);
        for parameter in parameter::Parameter::ALL {
            let about = about(&parameter.declaration());
            properties.insert(parameter.key().to_owned(), serde_json::json!({ "type": types, "description": about }));
        }
        let between = serde_json::json!({
            "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2,
            "description": "The two groups between which these contacts lie; none for the contacts within a group.",
        });
        properties.insert("between".to_owned(), between);
        let about = "Bond of these contacts; that of the stage when not given.";
        properties.insert("bond".to_owned(), serde_json::json!({ "allOf": [bond], "description": about }));
        let about = "Distribution of the strengths from bond to bond.";
        properties
            .insert("distribution".to_owned(), serde_json::json!({ "allOf": [distribution], "description": about }));
        json_schema!({
            "type": "object",
            "description": "Microparameters of the contacts within a group or between two. Others may stand here for external programs.",
            "properties": properties,
            "additionalProperties": { "type": types, "description": "A number, a quantity, or a formula." },
        })
    }
}

/// The text that an editor shows for a microparameter.
fn about(one: &parameter::Declaration) -> String {
    let laws = one.laws.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let default = if one.default.is_nan() { String::new() } else { format!("; {} when not given", one.default) };
    let (range, example) = (one.range.words(), one.quantity.example());
    format!("{}: {}. {range}{default}, such as {example}. Laws: {laws}.", one.symbol, one.meaning)
}
