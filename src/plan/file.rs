//! The tables of a workflow file that are not stages.

use crate::stage::{Factor, Parameter, Response};
use crate::unit::{Dimension, parse_any};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, de};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

/// `[workflow]`: what the whole campaign shares.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    /// Title of the campaign, for reports.
    #[serde(default)]
    pub(super) title: String,
    /// What the campaign is about, where its numbers come from.
    #[serde(default)]
    pub(super) about: String,
    /// The one seed of all randomness: the same seed gives the same results.
    #[schemars(range(max = 9_223_372_036_854_775_807_u64))]
    pub(super) seed: u64,
}

/// `[factor.NAME]`: what a design varies. Needs `levels` or `range`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("anyOf" = [{ "required": ["levels"] }, { "required": ["range"] }]))]
pub(super) struct FactorTable {
    /// Path of the parameter that it sets, such as "mortar.Ec"; a factor without one is a dummy column.
    #[serde(default)]
    pub(super) sets: String,
    /// Unit of levels and range, such as "GPa"; none for a pure number.
    #[serde(default)]
    pub(super) unit: String,
    /// Symbol for tables and figures, such as "\\bar\\sigma_c"; without one the name stands as it is.
    pub(super) symbol: Option<String>,
    /// Levels in the unit, such as [10, 20, 30].
    #[serde(default)]
    #[schemars(extend("uniqueItems" = true))]
    pub(super) levels: Vec<f64>,
    /// Low and high end in the unit, such as [10, 30]; those of the levels when not given.
    pub(super) range: Option<[f64; 2]>,
}

/// `[response.NAME]`: how a response is shown.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ResponseTable {
    /// Unit in tables and figures, such as "MPa"; none for a pure number.
    #[serde(default)]
    pub(super) unit: String,
    /// Symbol for tables and figures, such as "\\sigma_u"; without one the name stands as it is.
    pub(super) symbol: Option<String>,
}

/// `[material.NAME]`: microparameters by contact group, such as `mortar = { Ec = "20 GPa", mu = 0.5 }`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(super) struct MaterialTable(BTreeMap<String, BTreeMap<String, ParameterValue>>);

impl MaterialTable {
    /// Values by path, such as `mortar.Ec`.
    pub(super) fn material(self) -> BTreeMap<String, Parameter> {
        let path = |group: &str, name: String| format!("{group}.{name}");
        let groups = self.0.into_iter();
        groups.flat_map(|(g, all)| all.into_iter().map(move |(name, value)| (path(&g, name), value.0))).collect()
    }
}

/// A quantity of any kind; what it stands for decides later which kind is right.
#[derive(Debug)]
struct ParameterValue(Parameter);

impl<'de> Deserialize<'de> for ParameterValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Parameter;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a quantity with its unit such as \"16 GPa\"")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Parameter, E> {
                let (value, dimension) = parse_any(text).map_err(E::custom)?;
                Ok(Parameter { value, dimension })
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Parameter, E> {
                Ok(Parameter { value, dimension: Dimension::NONE })
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Parameter, E> {
                self.visit_f64(value as f64)
            }
            /// The place of a value whose fault was told already.
            fn visit_unit<E: de::Error>(self) -> Result<Parameter, E> {
                self.visit_f64(1.0)
            }
        }
        deserializer.deserialize_any(Visitor).map(Self)
    }
}

impl JsonSchema for ParameterValue {
    fn schema_name() -> Cow<'static, str> {
        "parameter".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["string", "number"],
            "description": "A number, or a quantity with its unit such as \"16 GPa\".",
        })
    }
}

/// A name of one letter is a variable; any other stands in words, where `kn_ks` has no subscript.
fn one_letter(name: &str) -> String {
    if name.chars().count() == 1 { name.to_owned() } else { String::new() }
}

impl FactorTable {
    /// The factor as stages see it.
    pub(super) fn factor(self, name: &str) -> Factor {
        let Self { sets, unit, symbol, levels, range } = self;
        let ends = |levels: &[f64]| {
            let low = levels.iter().copied().reduce(f64::min)?;
            Some([low, levels.iter().copied().reduce(f64::max)?])
        };
        let range = range.or_else(|| ends(&levels));
        Factor { sets, unit, symbol: symbol.unwrap_or_else(|| one_letter(name)), levels, range }
    }
}

impl ResponseTable {
    /// The response as stages see it.
    pub(super) fn response(self, name: &str) -> Response {
        Response { unit: self.unit, symbol: self.symbol.unwrap_or_else(|| one_letter(name)) }
    }
}
