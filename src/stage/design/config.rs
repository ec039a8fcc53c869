//! The table of a `design` stage: `method`, the options of every method, and their combinations.

use super::valid::InvalidRows;
use crate::stage::{Complaint, Context, Named};
use design::box_behnken::BoxBehnken;
use design::central_composite::{Alpha, CentralComposite, Corners, Extent};
use design::factorial::FullFactorial;
use design::fractional::FractionalFactorial;
use design::given::Given;
use design::latin_hypercube::{Criterion, LatinHypercube, Position};
use design::orthogonal::Orthogonal;
use design::plackett_burman::PlackettBurman;
use design::report::power::Question;
use design::sobol::Sobol;
use design::{Domain, Factor, Layout, Method, Order};
use math::scale::Scale;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Name {
    /// Every combination of levels.
    FullFactorial,
    /// A regular fraction of the two-level factorial.
    FractionalFactorial,
    /// An orthogonal table.
    Orthogonal,
    /// Two-level screening.
    PlackettBurman,
    /// Cube, axial and centre points.
    CentralComposite,
    /// Edge midpoints and centre points.
    BoxBehnken,
    /// A stratified sample.
    LatinHypercube,
    /// A low-discrepancy sample.
    Sobol,
    /// Rows of the workflow or of a file.
    Given,
}

/// Settings of a `design` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Which design.
    pub method: Name,
    /// The factors it varies, in column order.
    pub factors: Vec<String>,
    /// Order of the runs: `standard`, or `random` from the workflow's seed.
    #[serde(default)]
    pub order: Order,
    /// Number of times that the whole design is run, each time on its own packing.
    #[serde(default = "once")]
    pub replicates: usize,
    /// Rules that every row must obey, with units: "Ec/sigma_c <= 830", "kn_ks >= 1", "mu in 0.2..1".
    #[serde(default)]
    pub valid: Vec<String>,
    /// What to do with rows that break a rule.
    #[serde(default)]
    pub invalid_rows: InvalidRows,
    /// The effect, noise and level for which the report computes the power.
    #[serde(default)]
    pub power: Question,
    /// Orthogonal: the table, such as `L64(4^21)`; by default the smallest that fits.
    pub table: Option<String>,
    /// Orthogonal: the column of each factor, from 1.
    pub columns: Option<Vec<usize>>,
    /// Orthogonal, where a factor has fewer levels than its column: the level that occurs most often, from 1.
    pub doubled: Option<usize>,
    /// Orthogonal: strength 2 or 3.
    pub strength: Option<usize>,
    /// Fractional factorial: the generators, such as `E=ABCD` or `mu=Ec*kn_ks`.
    pub generators: Option<Vec<String>>,
    /// Fractional factorial: the least resolution.
    pub resolution: Option<usize>,
    /// Number of runs (fractional factorial, Plackett–Burman) or of points (samples).
    pub runs: Option<usize>,
    /// Plackett–Burman: add the mirror image of every run.
    pub fold: Option<bool>,
    /// Number of centre points; by default none for factorial and screening designs, the published number for surface
    /// designs.
    pub centre_points: Option<usize>,
    /// Central composite: `rotatable`, `orthogonal`, `spherical`, `face` or a number.
    pub alpha: Option<Alpha>,
    /// Central composite: whether the ends of ranges are the `cube` or the `axial` points.
    pub extent: Option<Extent>,
    /// Central composite: `fraction` (from five factors on) or `full`.
    pub corners: Option<Corners>,
    /// Latin hypercube: `maximin` or `random`.
    pub criterion: Option<Criterion>,
    /// Latin hypercube: points at the `centre` of their strata or at `random`.
    pub position: Option<Position>,
    /// Sobol: whether to scramble it with the workflow's seed.
    pub scramble: Option<bool>,
    /// Sobol: number of points to skip at the start.
    pub skip: Option<usize>,
    /// Given: the rows, one value a factor, in the factors' units.
    pub rows: Option<Vec<Vec<f64>>>,
    /// Given: a CSV file beside the workflow with a column for every factor.
    pub file: Option<String>,
    /// Given: whether the rows hold the numbers of levels, from 1, as published tables do, instead of values.
    pub by_level: Option<bool>,
}

fn once() -> usize {
    1
}

/// The options of each method.
const OPTIONS: &[(&str, &[Name])] = &[
    ("table", &[Name::Orthogonal]),
    ("columns", &[Name::Orthogonal]),
    ("doubled", &[Name::Orthogonal]),
    ("strength", &[Name::Orthogonal]),
    ("generators", &[Name::FractionalFactorial]),
    ("resolution", &[Name::FractionalFactorial]),
    ("runs", &[Name::FractionalFactorial, Name::PlackettBurman, Name::LatinHypercube, Name::Sobol]),
    ("fold", &[Name::PlackettBurman]),
    (
        "centre_points",
        &[
            Name::FullFactorial,
            Name::FractionalFactorial,
            Name::PlackettBurman,
            Name::CentralComposite,
            Name::BoxBehnken,
        ],
    ),
    ("alpha", &[Name::CentralComposite]),
    ("extent", &[Name::CentralComposite]),
    ("corners", &[Name::CentralComposite]),
    ("criterion", &[Name::LatinHypercube]),
    ("position", &[Name::LatinHypercube]),
    ("scramble", &[Name::Sobol]),
    ("skip", &[Name::Sobol]),
    ("rows", &[Name::Given]),
    ("file", &[Name::Given]),
    ("by_level", &[Name::Given]),
];

impl Design {
    /// Whether each option is set, in the order of [`OPTIONS`].
    fn said(&self) -> [bool; 19] {
        [
            self.table.is_some(),
            self.columns.is_some(),
            self.doubled.is_some(),
            self.strength.is_some(),
            self.generators.is_some(),
            self.resolution.is_some(),
            self.runs.is_some(),
            self.fold.is_some(),
            self.centre_points.is_some(),
            self.alpha.is_some(),
            self.extent.is_some(),
            self.corners.is_some(),
            self.criterion.is_some(),
            self.position.is_some(),
            self.scramble.is_some(),
            self.skip.is_some(),
            self.rows.is_some(),
            self.file.is_some(),
            self.by_level.is_some(),
        ]
    }

    fn word(&self) -> String {
        serde_json::to_value(self.method).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
    }

    /// Options that have no effect with this method, and settings that no method can use.
    pub(super) fn option_complaints(&self) -> Vec<Complaint> {
        let method = self.word();
        let mut known: Vec<&str> = Vec::new();
        known.extend(OPTIONS.iter().filter(|(_, names)| names.contains(&self.method)).map(|(option, _)| *option));
        let stray = OPTIONS.iter().zip(self.said()).filter(|((_, names), said)| *said && !names.contains(&self.method));
        let mut found: Vec<Complaint> = stray
            .map(|((option, _), _)| {
                Complaint::new(option, format!("`{option}` has no effect with the method `{method}`"))
                    .hint(format!("its options are {}", known.join(", ")))
            })
            .collect();
        if self.replicates == 0 {
            found.push(Complaint::new("replicates", "the design would be run 0 times").hint("give 1 or more"));
        }
        let Question { effect, noise, alpha } = self.power;
        for (key, value) in [("effect", effect), ("noise", noise)] {
            if !(value > 0.0 && value.is_finite()) {
                let complaint = Complaint::new(&format!("power.{key}"), format!("the {key} is {value}"));
                found.push(complaint.hint("give a number above 0, in the unit of the response"));
            }
        }
        if !(alpha > 0.0 && alpha < 1.0) {
            let complaint = Complaint::new("power.alpha", format!("the level of significance is {alpha}"));
            found.push(complaint.hint("give a number between 0 and 1, such as 0.05"));
        }
        found
    }

    /// Names that are no factors of the workflow.
    pub(super) fn factor_complaints(&self, context: &Context) -> Vec<Complaint> {
        let unknown = self.factors.iter().filter(|name| !context.factors.contains_key(*name));
        let known: Vec<&str> = context.factors.keys().map(String::as_str).collect();
        let hint = match known.is_empty() {
            true => "it has none: add [factor.NAME] with levels or a range".to_owned(),
            false => format!("its factors are {}", known.join(", ")),
        };
        let complaint = |name| Complaint::new("factors", format!("`{name}` is not a factor of this workflow"));
        unknown.map(|name| complaint(name).missing(Named::Factor, name).hint(&hint)).collect()
    }

    /// Replicates and order of the runs.
    pub(super) fn layout(&self) -> Layout {
        Layout { replicates: self.replicates, order: self.order }
    }

    /// The design with its options.
    pub(super) fn method(&self) -> Result<Method, Complaint> {
        let centre_points = self.centre_points.unwrap_or(0);
        let points = || {
            let complaint = Complaint::new("runs", "the number of points is missing");
            self.runs.ok_or_else(|| complaint.hint("say `runs = 64`, or any other number"))
        };
        Ok(match self.method {
            Name::FullFactorial => Method::FullFactorial(FullFactorial { centre_points }),
            Name::FractionalFactorial => Method::FractionalFactorial(FractionalFactorial {
                generators: self.generators.clone().unwrap_or_default(),
                resolution: self.resolution,
                runs: self.runs,
                centre_points,
            }),
            Name::Orthogonal => Method::Orthogonal(Orthogonal {
                table: self.table.clone(),
                columns: self.columns.clone(),
                doubled: self.doubled,
                strength: self.strength,
            }),
            Name::PlackettBurman => Method::PlackettBurman(PlackettBurman {
                runs: self.runs,
                fold: self.fold.unwrap_or(false),
                centre_points,
            }),
            Name::CentralComposite => Method::CentralComposite(CentralComposite {
                alpha: self.alpha.unwrap_or_default(),
                centre_points: self.centre_points,
                extent: self.extent.unwrap_or_default(),
                corners: self.corners.unwrap_or_default(),
            }),
            Name::BoxBehnken => Method::BoxBehnken(BoxBehnken { centre_points: self.centre_points }),
            Name::LatinHypercube => Method::LatinHypercube(LatinHypercube {
                runs: points()?,
                criterion: self.criterion.unwrap_or_default(),
                position: self.position.unwrap_or_default(),
            }),
            Name::Sobol => Method::Sobol(Sobol {
                runs: points()?,
                scramble: self.scramble.unwrap_or(true),
                skip: self.skip.unwrap_or(0),
            }),
            Name::Given => {
                let rows = match (&self.rows, &self.file) {
                    (Some(rows), None) => rows.clone(),
                    // they are read when the task runs
                    (None, Some(_)) => Vec::new(),
                    _ => {
                        let complaint = Complaint::new("method", "given rows need `rows` or `file`, one of them");
                        return Err(complaint.hint("say `file = \"rows.csv\"`, or `rows = [[10, 2.5], [20, 1]]`"));
                    }
                };
                let by_level = self.by_level.unwrap_or(false);
                Method::Given(Given { rows, by_level, source: String::new() })
            }
        })
    }

    /// The factors of the workflow as this design sets them; unknown ones are left out.
    pub(super) fn factors(&self, context: &Context) -> Vec<Factor> {
        let found = self.factors.iter().filter_map(|name| context.factors.get(name).map(|f| (name, f)));
        found
            .map(|(name, factor)| {
                let levels = || Domain::Levels(factor.levels.clone());
                let range = factor.range.map(|[low, high]| Domain::Range { low, high });
                let ends = || {
                    let ends =
                        Factor { name: name.clone(), unit: String::new(), domain: levels(), scale: Scale::Linear };
                    // a single level is not a range; the design reports that
                    if factor.levels.len() < 2 {
                        levels()
                    } else {
                        Domain::Range { low: ends.low(), high: ends.high() }
                    }
                };
                let domain = match self.method {
                    Name::FullFactorial | Name::Orthogonal => {
                        if factor.levels.is_empty() {
                            range.unwrap_or_else(levels)
                        } else {
                            levels()
                        }
                    }
                    Name::CentralComposite | Name::BoxBehnken if factor.levels.len() <= 3 => {
                        range.unwrap_or_else(levels)
                    }
                    Name::Given if self.by_level == Some(true) => levels(),
                    Name::Given => range.unwrap_or_else(levels),
                    _ => range.unwrap_or_else(ends),
                };
                Factor { name: name.clone(), unit: factor.unit.clone(), domain, scale: factor.scale }
            })
            .collect()
    }
}
