//! The tables of a workflow file that are not stages.

use crate::stage::{Factor, Response};
use schemars::JsonSchema;
use serde::Deserialize;

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
pub(super) struct FactorTable {
    /// Path of the parameter that it sets, such as "mortar.Ec"; a factor without one is a dummy column.
    #[serde(default)]
    pub(super) sets: String,
    /// Unit of levels and range, such as "GPa"; none for a pure number.
    #[serde(default)]
    pub(super) unit: String,
    /// Symbol for tables and figures, such as "\\bar\\sigma_c"; the factor's name when not given.
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
    /// Symbol for tables and figures, such as "\\sigma_u"; the response's name when not given.
    pub(super) symbol: Option<String>,
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
        Factor { sets, unit, symbol: symbol.unwrap_or_else(|| name.to_owned()), levels, range }
    }
}

impl ResponseTable {
    /// The response as stages see it.
    pub(super) fn response(self, name: &str) -> Response {
        Response { unit: self.unit, symbol: self.symbol.unwrap_or_else(|| name.to_owned()) }
    }
}
