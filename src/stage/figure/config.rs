//! Settings of a `figure` stage, and those that each figure accepts.

use super::cut::Across;
use super::plot::{Bars, Direction, Fit};
use crate::artifact::{Accepts, ArtifactKind as Of};
use crate::stage::invalid::Invalid;
use crate::unit::Length;
use figure::palette::Map;
use figure::{DOUBLE, SINGLE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::json;
use std::collections::BTreeMap;

/// Settings of a `figure` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The figure to draw.
    pub show: Show,
    /// The stages whose results it shows.
    pub of: Names,
    /// Stages with values to compare.
    #[serde(default)]
    pub compare: Names,
    /// The response to draw; a figure with a panel per response takes several, by default all.
    #[serde(default)]
    pub response: Names,
    /// The factors to draw; all by default.
    #[serde(default)]
    pub factors: Vec<String>,
    /// Values of the factors that are held constant, in their units; by default the middle of the range.
    #[serde(default)]
    pub at: BTreeMap<String, f64>,
    /// Names of quantities: `{ UCS = "Peak strength" }`; for series, names in the legend by stage.
    #[serde(default)]
    pub names: BTreeMap<String, String>,
    /// What the report says below the figure, in place of its own sentence on what is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub caption: Option<String>,
    /// Half width of the band around the line of equality, as a fraction of the value.
    pub band: Option<f64>,
    /// Column along the page (`xy`, `curves`, `heat-map`), or the quantity of a `histogram`.
    pub x: Option<String>,
    /// Column up the page (`xy`, `curves`, `box`), or down a `heat-map`.
    pub y: Option<String>,
    /// Column in the cells of a `heat-map`.
    pub value: Option<String>,
    /// Column whose values group points, curves or boxes.
    pub by: Option<String>,
    /// Table of the result with the columns; by default its main table.
    pub table: Option<String>,
    /// Draws only rows in which these columns have these values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, String>,
    /// Line through the points of each group of an `xy`, with its confidence band.
    pub fit: Option<Fit>,
    /// Draws the mean with bars in place of the points of an `xy` with equal `x`.
    pub bars: Option<Bars>,
    /// Coverage of bands and bars, 0.95 by default.
    pub confidence: Option<f64>,
    /// Logarithmic axes: `["x"]`, `["y"]` or both.
    #[serde(default)]
    pub log: Vec<Direction>,
    /// Ends of the axis along the page in its unit: `[0, 60]` (`xy`, `curves`). What lies outside is not drawn, and counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_limits: Option<[f64; 2]>,
    /// Ends of the axis up the page (`xy`, `curves`, `box`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_limits: Option<[f64; 2]>,
    /// Joins the points of each group of an `xy` by lines.
    #[serde(default)]
    pub joined: bool,
    /// CSV or workbook, beside the workflow, whose columns `x` and `y` are drawn over the others (`xy`, `curves`).
    pub overlay: Option<String>,
    /// Axis across which a `specimen` in space is cut open: `x`, `y` (along the load), `z` (to the eye), or `none`; by default
    /// one with clumps is cut across z.
    pub cut: Option<Across>,
    /// Distance of the cut from the middle of the specimen: `"5 mm"`; 0 by default.
    pub cut_at: Option<Length>,
    /// Number of bins of a `histogram`; by default from the scatter.
    pub bins: Option<usize>,
    /// What to do with runs that are not valid: by default a figure of a table of runs leaves them out, and a figure of a
    /// single run draws it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub invalid: Option<Invalid>,
    /// `single` (90 mm), `double` (190 mm) or a length.
    #[serde(default)]
    pub width: Width,
    /// Size of the text in points; 8 by default.
    pub points: Option<f64>,
    /// Colours of surfaces.
    #[serde(default)]
    pub colors: Map,
}

/// One name or several.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Names {
    /// None.
    #[default]
    #[serde(skip)]
    None,
    /// One.
    One(String),
    /// Several.
    Many(Vec<String>),
}

/// The list of names.
impl Serialize for Names {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.list().serialize(serializer)
    }
}

impl Names {
    /// Whether there is no name.
    pub(in crate::stage) fn is_empty(&self) -> bool {
        match self {
            Names::None => true,
            Names::One(_) => false,
            Names::Many(names) => names.is_empty(),
        }
    }

    pub(in crate::stage) fn list(&self) -> Vec<String> {
        match self {
            Names::None => Vec::new(),
            Names::One(name) => vec![name.clone()],
            Names::Many(names) => names.clone(),
        }
    }
}

/// Width of a picture in mm: `single` (one column of a journal, 90 mm), `double` (190 mm) or a length.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "String")]
#[schemars(with = "String")]
pub struct Width(f64);

/// A width as millimetres.
impl Serialize for Width {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

impl TryFrom<String> for Width {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.as_str() {
            "single" => Ok(Self(SINGLE)),
            "double" => Ok(Self(DOUBLE)),
            _ => Length::parse(&text)
                .map(|length| Self((length.get() * 1e9).round() / 1e6))
                .map_err(|e| format!("wanted \"single\", \"double\" or a length: {e}")),
        }
    }
}

impl Default for Width {
    fn default() -> Self {
        Self(SINGLE)
    }
}

impl Width {
    pub(super) fn millimetres(self) -> f64 {
        self.0
    }
}

/// The figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Show {
    /// Stress–strain curves with crack counts.
    StressStrain,
    /// Crack patterns by mode at several moments.
    Cracks,
    /// Interfaces by how much of each is broken, at several moments: flat joints.
    Damage,
    /// Orientation of the cracks.
    CrackRose,
    /// Force chains.
    ForceChains,
    /// The specimen at the stored states of a run, and as a moving picture.
    Snapshots,
    /// Particles by group, with the aggregate.
    Specimen,
    /// Mean response per level of each factor.
    MainEffects,
    /// Ranked ranges of a range analysis.
    Range,
    /// Points of a design in two or three factors.
    Points,
    /// Computed against compared values, matched by their factors.
    Agreement,
    /// A response surface as filled contours.
    Contour,
    /// A response surface in space.
    Surface,
    /// Four views of the residuals of a model.
    Residuals,
    /// Observed values against those of the model.
    ObservedPredicted,
    /// Ranked standardized effects.
    Pareto,
    /// Half-normal plot of effects.
    HalfNormal,
    /// Normal plot of effects, with their signs.
    Normal,
    /// Misfit against effort of a calibration.
    Convergence,
    /// Parameter sets over parallel axes.
    Solutions,
    /// Targets against verified values.
    Verification,
    /// Two columns against each other, by groups.
    Xy,
    /// Curves of many runs with their mean.
    Curves,
    /// Histogram of a column.
    Histogram,
    /// Median, quartiles and single values of a column, by groups.
    Box,
    /// A column over two others as a matrix of colours and numbers.
    HeatMap,
    /// Strength over confining stress: tests, Mohr–Coulomb, Hoek–Brown.
    Envelope,
    /// Stones with their clumps.
    Stones,
    /// Zingg's diagram of stones.
    Zingg,
    /// The graph of stages up to the named ones.
    Dag,
}

/// The settings that one kind of figure accepts.
pub(super) struct Needs {
    pub(super) from: Accepts,
    pub(super) compare: Accepts,
    /// Least and greatest number of responses.
    pub(super) responses: [usize; 2],
    /// Least and greatest number of named factors; the figure draws factors when the second is not 0.
    pub(super) factors: [usize; 2],
    /// Keys of a plot of the user's own columns that must be set, and those that may be; the first are columns of numbers.
    pub(super) keys: [&'static [&'static str]; 2],
    /// Whether the figure draws the single runs of a table, so that some can be left out.
    pub(super) runs: bool,
}

impl Needs {
    /// Whether it draws columns of the user's choice.
    pub(super) fn is_plot(&self) -> bool {
        self.keys.iter().any(|keys| !keys.is_empty())
    }

    /// Whether it draws results of analyses, whose responses are made from runs that may have been left out.
    pub(super) fn of_analyses(&self) -> bool {
        const OTHERS: [Of; 5] = [Of::RUN, Of::SPECIMEN, Of::SHAPES, Of::DESIGN, Of::RESULTS];
        match self.from {
            Accepts::Only(kinds) => kinds.iter().any(|kind| !OTHERS.contains(kind)),
            Accepts::All | Accepts::Tables => self.is_plot(),
        }
    }
}

const MANY: usize = usize::MAX;

impl Show {
    pub(super) fn needs(self) -> Needs {
        let needs = |from, compare, responses, factors| Needs {
            from: Accepts::Only(from),
            compare: Accepts::Only(compare),
            responses,
            factors,
            keys: [&[], &[]],
            runs: false,
        };
        let plot = |required: &'static [&'static str], optional: &'static [&'static str]| Needs {
            from: Accepts::All,
            keys: [required, optional],
            runs: true,
            ..needs(&[], &[], [0, 0], [0, 0])
        };
        const RESULTS: &[Of] = &[Of::RESULTS];
        const MODELS: &[Of] = &[Of::ANOVA, Of::SCREENING, Of::SURFACES];
        const POINTS: &[Of] = &[Of::DESIGN, Of::RESULTS];
        match self {
            Show::StressStrain => needs(&[Of::RUN], &[], [0, 0], [0, 0]),
            Show::Cracks | Show::Damage | Show::ForceChains | Show::CrackRose | Show::Snapshots => {
                needs(&[Of::RUN], &[Of::SPECIMEN], [0, 0], [0, 0])
            }
            Show::Specimen => needs(&[Of::SPECIMEN], &[], [0, 0], [0, 0]),
            Show::Envelope => needs(&[Of::ENVELOPE], &[], [0, 0], [0, 0]),
            Show::Stones | Show::Zingg => needs(&[Of::SHAPES], &[], [0, 0], [0, 0]),
            Show::MainEffects | Show::Range => needs(&[Of::RANGE], &[Of::RANGE], [1, 1], [0, MANY]),
            Show::Points => needs(POINTS, &[], [0, 0], [0, 3]),
            Show::Agreement => Needs { runs: true, ..needs(RESULTS, RESULTS, [0, MANY], [0, MANY]) },
            Show::Contour | Show::Surface => needs(&[Of::SURFACES], POINTS, [1, 1], [2, 2]),
            Show::Residuals => needs(MODELS, &[], [1, 1], [0, 0]),
            Show::ObservedPredicted => needs(MODELS, &[], [0, MANY], [0, 0]),
            Show::Pareto => needs(&[Of::SCREENING, Of::ANOVA], &[], [1, 1], [0, MANY]),
            Show::HalfNormal => needs(&[Of::SCREENING, Of::ANOVA], &[], [1, 1], [0, MANY]),
            Show::Normal => needs(&[Of::SCREENING], &[], [1, 1], [0, MANY]),
            Show::Convergence => needs(&[Of::SOLUTION], &[], [0, 0], [0, 0]),
            Show::Solutions => needs(&[Of::SOLUTION], &[], [0, 0], [0, MANY]),
            Show::Verification => needs(&[Of::VERIFICATION], &[], [0, MANY], [0, 0]),
            Show::Curves => Needs {
                from: Accepts::Only(&[Of::RUN, Of::RESULTS]),
                ..plot(&[], &["x", "y", "by", "overlay", "x_limits", "y_limits"])
            },
            Show::Xy => {
                const OPTIONAL: &[&str] = &[
                    "by",
                    "table",
                    "where",
                    "fit",
                    "bars",
                    "confidence",
                    "log",
                    "joined",
                    "overlay",
                    "x_limits",
                    "y_limits",
                ];
                plot(&["x", "y"], OPTIONAL)
            }
            Show::Histogram => plot(&["x"], &["table", "where", "bins"]),
            Show::Box => plot(&["y"], &["by", "table", "where", "log", "y_limits"]),
            Show::HeatMap => plot(&["x", "y", "value"], &["table", "where"]),
            Show::Dag => Needs { from: Accepts::All, ..needs(&[], &[], [0, 0], [0, 0]) },
        }
    }

    pub(super) fn name(self) -> String {
        json!(self).as_str().unwrap_or_default().to_owned()
    }
}
