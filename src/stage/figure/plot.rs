//! Settings of plots of a user's own columns: `xy`, `curves`, `histogram`, `box`, `heat-map`.

use super::super::{Complaint, Context};
use super::{Figure, Label, Show};
use figure::axis::Scale;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A line through the points of a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Fit {
    /// Least squares with a constant.
    Line,
    /// Least squares through the origin.
    ThroughOrigin,
}

/// The bars of a plot, over the rows with equal `x` and `by`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bars {
    /// One standard deviation to both sides of the mean.
    Deviation,
    /// The confidence interval of the mean.
    Interval,
}

/// The columns of a plot, and how they are drawn. Every key is for certain figures, and is refused for others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Plot {
    /// Column along the page (`xy`, `curves`, `heat-map`), or the quantity of a `histogram`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<String>,
    /// Column up the page (`xy`, `curves`, `box`), or down a `heat-map`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<String>,
    /// Column in the cells of a `heat-map`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// Column whose values group points, curves or boxes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// Table of the result with the columns; by default its main table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// Draws only rows in which these columns have these values.
    #[serde(rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    pub only: BTreeMap<String, String>,
    /// Line through the points of each group of an `xy`, with its confidence band.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fit>,
    /// Draws the mean with bars in place of the points of an `xy` with equal `x`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bars: Option<Bars>,
    /// Coverage of bands and bars, 0.95 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Logarithmic axes: `["x"]`, `["y"]` or both.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub log: Vec<Direction>,
    /// Ends of the axis along the page in its unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x_limits: Option<[f64; 2]>,
    /// Ends of the axis up the page in its unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_limits: Option<[f64; 2]>,
    /// Joins the points of each group of an `xy` by lines.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub joined: bool,
    /// CSV or workbook, beside the workflow, whose columns `x` and `y` are drawn over the others (`xy`, `curves`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlay: Option<String>,
    /// Number of bins of a `histogram`; by default from the scatter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bins: Option<usize>,
}

/// One of the two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Along the page.
    X,
    /// Up the page.
    Y,
}

/// Labels of the columns by their key in [`Plot`].
pub(super) type Labels = BTreeMap<String, Label>;

impl Plot {
    /// The keys of a stage that describe a plot.
    pub(super) fn of(figure: &Figure) -> Self {
        Self {
            x: figure.x.clone(),
            y: figure.y.clone(),
            value: figure.value.clone(),
            by: figure.by.clone(),
            table: figure.table.clone(),
            only: figure.only.clone(),
            fit: figure.fit,
            bars: figure.bars,
            confidence: figure.confidence,
            log: figure.log.clone(),
            x_limits: figure.x_limits,
            y_limits: figure.y_limits,
            joined: figure.joined,
            overlay: figure.overlay.clone(),
            bins: figure.bins,
        }
    }

    /// Names and values of the keys that are set.
    fn given(&self) -> Vec<&'static str> {
        let keys = [
            ("x", self.x.is_some()),
            ("y", self.y.is_some()),
            ("value", self.value.is_some()),
            ("by", self.by.is_some()),
            ("table", self.table.is_some()),
            ("where", !self.only.is_empty()),
            ("fit", self.fit.is_some()),
            ("bars", self.bars.is_some()),
            ("confidence", self.confidence.is_some()),
            ("log", !self.log.is_empty()),
            ("x_limits", self.x_limits.is_some()),
            ("y_limits", self.y_limits.is_some()),
            ("joined", self.joined),
            ("overlay", self.overlay.is_some()),
            ("bins", self.bins.is_some()),
        ];
        keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    /// Complaints about keys without effect, and keys that are missing.
    pub(super) fn check(&self, show: Show, idle: &dyn Fn(&str) -> Complaint) -> Vec<Complaint> {
        let [needs, takes] = show.needs().keys;
        let given = self.given();
        let without = given.iter().filter(|key| !needs.contains(key) && !takes.contains(key)).map(|key| idle(key));
        let missing = needs.iter().filter(|key| !given.contains(key)).map(|key| {
            Complaint::new("show", format!("`{}` needs `{key}`, the name of a column", show.name()))
                .hint(format!("{key} = \"UCS\""))
        });
        let mut found: Vec<Complaint> = without.chain(missing).collect();
        if self.confidence.is_some() && self.fit.is_none() && self.bars != Some(Bars::Interval) {
            let message = "`confidence` has no effect without `fit` or `bars = \"interval\"`";
            found.push(Complaint::new("confidence", message).hint("leave out `confidence`"));
        }
        if self.fit == Some(Fit::ThroughOrigin) && !self.log.is_empty() {
            let message = "a logarithmic axis has no origin for `fit = \"through-origin\"`";
            found.push(Complaint::new("fit", message).hint("fit = \"line\", or leave out `log`"));
        }
        let axes = [("x_limits", Direction::X), ("y_limits", Direction::Y)];
        found.extend(axes.into_iter().filter_map(|(key, direction)| self.check_limits(key, direction)));
        found.extend(self.confidence.and_then(|c| super::super::columns::check_probability("confidence", c)));
        found.extend(
            self.bins
                .filter(|bins| !(1..=200).contains(bins))
                .map(|bins| Complaint::new("bins", format!("{bins} bins cannot be drawn")).hint("1 to 200")),
        );
        found
    }

    /// A complaint about ends that no axis can have.
    fn check_limits(&self, key: &str, direction: Direction) -> Option<Complaint> {
        let [low, high] = self.limits(direction)?;
        if !(low < high && low.is_finite() && high.is_finite()) {
            let message = format!("the limits must rise: {low} is not below {high}");
            return Some(Complaint::new(key, message).hint(format!("{key} = [0, 60]")));
        }
        let message = || format!("a logarithmic axis has no {low}");
        (self.scale(direction) == Scale::Log && low <= 0.0)
            .then(|| Complaint::new(key, message()).hint("begin above zero"))
    }

    /// The ends of an axis, where some are asked for.
    pub(super) fn limits(&self, direction: Direction) -> Option<[f64; 2]> {
        match direction {
            Direction::X => self.x_limits,
            Direction::Y => self.y_limits,
        }
    }

    pub(super) fn scale(&self, direction: Direction) -> Scale {
        if self.log.contains(&direction) { Scale::Log } else { Scale::Linear }
    }

    pub(super) fn coverage(&self) -> f64 {
        self.confidence.unwrap_or(0.95)
    }

    /// The coverage as text: "95 %".
    pub(super) fn percent(&self) -> String {
        format!("{} %", figure::axis::significant(100.0 * self.coverage(), 3).trim_end_matches(".0"))
    }

    /// What the bars are.
    pub(super) fn bars_in_words(&self, bars: Bars) -> String {
        match bars {
            Bars::Deviation => "one standard deviation".to_owned(),
            Bars::Interval => format!("{} interval of the mean", self.percent()),
        }
    }

    /// Labels of the columns that are drawn.
    pub(super) fn labels(&self, show: Show, context: &Context, names: &BTreeMap<String, String>) -> Labels {
        let curve = |key: &str| match (show, key) {
            (Show::Curves, "x") => Some("axial_strain".to_owned()),
            (Show::Curves, "y") => Some("stress".to_owned()),
            _ => None,
        };
        let columns = [("x", &self.x), ("y", &self.y), ("value", &self.value), ("by", &self.by)];
        let label = |(key, column): (&str, &Option<String>)| {
            let column = column.clone().or_else(|| curve(key))?;
            Some((key.to_owned(), label(&column, context, names)))
        };
        let overlaid = names.get("overlay").filter(|_| self.overlay.is_some());
        let overlaid = overlaid.map(|name| ("overlay".to_owned(), Label { name: name.clone(), ..Label::default() }));
        columns.into_iter().filter_map(label).chain(overlaid).collect()
    }
}

/// Words for columns that runs always have.
const KNOWN: [(&str, &str, &str); 4] = [
    ("axial_strain", "Axial strain", r"\varepsilon_1"),
    ("lateral_strain", "Lateral strain", r"\varepsilon_3"),
    ("volumetric_strain", "Volumetric strain", r"\varepsilon_v"),
    ("stress", "Axial stress", r"\sigma"),
];

/// Whether a name is one of ours, and not of the workflow or a file.
pub(super) fn is_ours(name: &str) -> bool {
    KNOWN.iter().any(|(_, words, _)| *words == name)
}

/// The label of a column: a factor or response has its symbol and unit, any other column its name.
fn label(column: &str, context: &Context, names: &BTreeMap<String, String>) -> Label {
    let factor = context.factors.get(column).map(|f| (f.symbol.clone(), f.unit.clone()));
    let response = context.responses.get(column).map(|r| (r.symbol.clone(), r.unit.clone()));
    let known = KNOWN.iter().find(|(name, ..)| *name == column);
    let declared = factor.or(response);
    let words = known.filter(|_| declared.is_none()).map(|(_, words, symbol)| (*words, *symbol));
    let (symbol, unit) = declared.unwrap_or_else(|| (words.map_or("", |w| w.1).to_owned(), String::new()));
    let name = names.get(column).cloned().or_else(|| words.map(|w| w.0.to_owned())).unwrap_or_default();
    Label { key: column.to_owned(), name, symbol, unit, ..Label::default() }
}
