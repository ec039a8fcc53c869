//! What a figure calls its quantities: names of `names`, symbols and units of the workflow.

use super::super::{Complaint, Context, Known, Named, StageError};
use super::config::{Figure, Show};
use super::{Label, source};

impl Figure {
    /// A complaint about a key of `names` that names nothing in the figure.
    pub(super) fn check_named(&self, key: &String, context: &Context) -> Option<Complaint> {
        let stages = [self.of.list(), self.compare.list()].concat();
        let columns = [&self.x, &self.y, &self.value, &self.by].into_iter().flatten();
        if key == "overlay" && self.overlay.is_some() {
            return None;
        }
        let known: Vec<&String> =
            context.responses.keys().chain(context.factors.keys()).chain(columns).chain(&stages).collect();
        let message = format!("`{key}` is no response, factor, column or stage of this figure");
        (!known.contains(&key)).then(|| {
            Complaint::new(&format!("names.{key}"), message).missing(Named::Column, key).among(known).hint(
                "`names` goes from the name in the workflow to the words in the figure: `{ UCS = \"Peak strength\" }`",
            )
        })
    }

    pub(super) fn response_labels(&self, context: &Context) -> Vec<Label> {
        let label = |key: &String| {
            let response = context.responses.get(key).cloned().unwrap_or_default();
            let name = self.names.get(key).cloned().unwrap_or_default();
            Label { key: key.clone(), name, symbol: response.symbol, unit: response.unit, ..Label::default() }
        };
        let named = self.response.list();
        let all = named.is_empty() && self.show.needs().responses[1] > 0;
        if all { context.responses.keys().map(label).collect() } else { named.iter().map(label).collect() }
    }

    /// The factors that are named, or all that the first input holds.
    pub(super) fn factor_labels(&self, known: &Known) -> Result<Vec<Label>, StageError> {
        if self.show.needs().factors[1] == 0 {
            return Ok(Vec::new());
        }
        let mut keys = self.factors.clone();
        // A surface is drawn over two factors, and its note states the others; any other figure shows the named ones, or all.
        if keys.is_empty() || matches!(self.show, Show::Contour | Show::Surface) {
            let artifact = known.load(known.one("of")?)?;
            let found = source::words(&artifact, self.response.list().first().map(String::as_str));
            for name in found.into_iter().filter(|name| known.context.factors.contains_key(name)) {
                if !keys.contains(&name) {
                    keys.push(name);
                }
            }
        }
        if self.show == Show::Agreement {
            // Rows are matched by the factors; their labels are not drawn.
            let unit = |key: &String| known.context.factors.get(key).map_or(String::new(), |own| own.unit.clone());
            return Ok(keys.into_iter().map(|key| Label { unit: unit(&key), key, ..Label::default() }).collect());
        }
        let label = |key: &String| {
            let factor = known.context.factors.get(key).cloned().unwrap_or_default();
            let (low, high) = figure::axis::extent(factor.levels.iter().copied());
            let range = factor.range.or((!factor.levels.is_empty()).then_some([low, high]));
            let group = factor
                .sets
                .first()
                .and_then(|path| path.split_once('.'))
                .map(|(group, _)| group.to_owned())
                .unwrap_or_default();
            let name = self.names.get(key).cloned().unwrap_or_default();
            Label { key: key.clone(), name, symbol: factor.symbol, unit: factor.unit, group, range }
        };
        Ok(keys.iter().map(label).collect())
    }

    /// Names in the legend where several stages are drawn together: those of `names`, else those of the stages.
    pub(super) fn series(&self) -> Vec<String> {
        let stages = self.of.list();
        if stages.len() < 2 {
            return Vec::new();
        }
        stages.iter().map(|stage| self.names.get(stage).cloned().unwrap_or(stage.replace('_', " "))).collect()
    }
}
