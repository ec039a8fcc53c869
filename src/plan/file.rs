//! The tables of a workflow file that are not stages.

use crate::stage::{Factor, Response};
use math::scale::Scale;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, de};
use std::borrow::Cow;
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
    /// What it sets: a microparameter ("rock.sigma_c": group and key of the material), or a number of a stage ("disc.radius_ratio":
    /// stage and key), or a list of such paths. A factor without one sets nothing by itself: formulas may name it.
    #[serde(default)]
    pub(super) sets: Paths,
    /// Unit of levels and range, such as "GPa"; none for a pure number.
    #[serde(default)]
    pub(super) unit: String,
    /// How the range is divided: `log` by equal ratios, for ranges over decades; designs, surfaces and searches honour it.
    #[serde(default)]
    pub(super) scale: Scale,
    /// Symbol for tables and figures, such as "\\bar\\sigma_c"; without one the name stands as it is.
    pub(super) symbol: Option<String>,
    /// Levels in the unit, such as [10, 20, 30], or names, such as ["OPC", "slag"].
    #[serde(default)]
    #[schemars(extend("uniqueItems" = true))]
    pub(super) levels: Vec<Level>,
    /// Low and high end in the unit, such as [10, 30]; those of the levels when not given.
    pub(super) range: Option<[f64; 2]>,
}

/// One level of a factor.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Level {
    /// A value in the unit of the factor.
    Number(f64),
    /// A name, of a factor that is a category.
    Name(String),
}

impl<'de> Deserialize<'de> for Level {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Level;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a name in quotes")
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Level, E> {
                Ok(Level::Number(value))
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Level, E> {
                Ok(Level::Number(value as f64))
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Level, E> {
                Ok(Level::Number(value as f64))
            }
            fn visit_str<E: de::Error>(self, value: &str) -> Result<Level, E> {
                Ok(Level::Name(value.to_owned()))
            }
            // a hole, where a fault was found already
            fn visit_unit<E: de::Error>(self) -> Result<Level, E> {
                Ok(Level::Number(1.0))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl JsonSchema for Level {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Level".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "string"], "minLength": 1 })
    }
}

impl FactorTable {
    /// The levels that are numbers.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let number = |level: &Level| match level {
            Level::Number(value) => Some(*value),
            Level::Name(_) => None,
        };
        self.levels.iter().filter_map(number).collect()
    }

    /// The levels that are names.
    pub(super) fn names(&self) -> Vec<String> {
        let name = |level: &Level| match level {
            Level::Number(_) => None,
            Level::Name(name) => Some(name.clone()),
        };
        self.levels.iter().filter_map(name).collect()
    }
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

/// One path or several.
#[derive(Debug, Default)]
pub(super) struct Paths(pub(super) Vec<String>);

impl<'de> Deserialize<'de> for Paths {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> de::Visitor<'de> for Visitor {
            type Value = Vec<String>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a path such as \"rock.sigma_c\", or a list of paths")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Vec<String>, E> {
                Ok(if text.is_empty() { Vec::new() } else { vec![text.to_owned()] })
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, mut list: A) -> Result<Vec<String>, A::Error> {
                let mut paths = Vec::new();
                while let Some(path) = list.next_element()? {
                    paths.push(path);
                }
                Ok(paths)
            }
            /// A hole: its fault is reported already.
            fn visit_unit<E: de::Error>(self) -> Result<Vec<String>, E> {
                Ok(Vec::new())
            }
        }
        deserializer.deserialize_any(Visitor).map(Self)
    }
}

impl JsonSchema for Paths {
    fn schema_name() -> Cow<'static, str> {
        "paths".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A path such as \"rock.sigma_c\" or \"disc.radius_ratio\", or a list of paths.",
            "anyOf": [{ "type": "string" }, { "type": "array", "items": { "type": "string" } }],
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
        let (numbers, names) = (self.numbers(), self.names());
        let Self { sets, unit, scale, symbol, range, .. } = self;
        let levels = if names.is_empty() { numbers } else { (0..names.len()).map(|i| i as f64).collect() };
        let ends = |levels: &[f64]| {
            let low = levels.iter().copied().reduce(f64::min)?;
            Some([low, levels.iter().copied().reduce(f64::max)?])
        };
        let range = range.or_else(|| ends(&levels)).filter(|_| names.is_empty());
        let sets = sets.0;
        Factor { sets, unit, scale, symbol: symbol.unwrap_or_else(|| one_letter(name)), levels, names, range }
    }
}

impl ResponseTable {
    /// The response as stages see it.
    pub(super) fn response(self, name: &str) -> Response {
        Response { unit: self.unit, symbol: self.symbol.unwrap_or_else(|| one_letter(name)) }
    }
}
