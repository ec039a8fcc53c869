//! `kind = "figure"`: a picture of the results of other stages, as SVG, PDF and PNG, with its numbers as a table.
//!
//! `show` names the figure, `of` the stages whose results it shows, and `compare` the stages with values to compare
//! (usually published ones). What each figure reads:
//!
//! | `show` | `of` | tables read |
//! |---|---|---|
//! | `stress-strain` | runs | `curve`, `cracks` |
//! | `cracks`, `crack-rose`, `force-chains` | one run (`compare`: its specimen) | `cracks`, `curve`, `fissures`; `forces`, `snapshots` |
//! | `damage` | one run with flat joints (`compare`: its specimen) | `cracks`, `interfaces`, `curve`, `fissures` |
//! | `snapshots` | one run and (`compare`) its specimen | `states`, `state_centres`, `cracks`, `curve`; in space `cracks` |
//! | `specimen` | a specimen | its arrays; one in space is shaded, and cut open where it holds clumps |
//! | `stones`, `zingg` | shapes | their arrays; `shapes` |
//! | `main-effects`, `range` | a range analysis (`compare`: another) | `range`, `levels` |
//! | `points` | a design or results | `design` or `runs`: two or three factors |
//! | `agreement` | results (`compare`: as many results) | `runs`; rows are matched by their factors |
//! | `contour`, `surface` | surfaces (`compare`: a design or results, whose points are marked) | `coefficients`, `domain` |
//! | `residuals`, `observed-predicted` | anova, screening, surfaces | `residuals` |
//! | `pareto` | a screening, or an anova | `effects` and `limits`, or `anova` |
//! | `half-normal` | a screening, or an anova | `effects`, `limits`, or `anova` and `fit` |
//! | `envelope` | an envelope | `parameters`, `tests`, `curves` |
//! | `convergence`, `solutions` | solutions | `history`; `solution`, `solution_set` |
//! | `verification` | a verification | `summary`, `runs` |
//! | `xy`, `histogram`, `box`, `heat-map` | any result | the columns named by `x`, `y`, `by`, `value` of the table `table` |
//! | `curves` | runs, or the results of a simulator on a design | `curve` of every run |
//! | `dag` | the last stages to be shown | nothing: it shows the workflow |
//!
//! A picture depends only on the numbers that it draws, on its labels (symbols and units of its factors and responses)
//! and on its style, so it is drawn anew if and only if one of these changed.

mod config;
mod curves;
mod cut;
mod damage;
mod design;
mod flow;
mod lost;
mod model;
mod named;
mod own;
mod parts;
mod plot;
mod run;
mod solution;
mod source;
mod space;
mod states;
mod validity;

use super::beside::Beside;
use super::given::check_given;
use super::invalid::Invalid;
use super::reads::Reads;
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Named, Outline, Port, Progress, Stage, StageError, Step,
    Task, Work,
};
use crate::artifact::presentation::Picture as Stored;
use crate::artifact::{Accepts, Artifact, ArtifactKind, Table};
use figure::palette::Map;
use figure::{self, Figure as Picture, Style, column, text};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;

pub use config::{Figure, Names, Show, Width};
pub use cut::Across;
pub use plot::{Bars, Direction, Fit};
use plot::{Labels, Plot};

/// The label of a factor or response.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Label {
    key: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    symbol: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    unit: String,
    /// Its group: the first part of the path that it sets.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    group: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    range: Option<[f64; 2]>,
}

impl Label {
    fn quantity(&self) -> figure::Quantity {
        // The name of a column is escaped; a name from the workflow's `names` may hold markup.
        let key = text::plain_text(&self.key);
        let name = if self.name.is_empty() && self.symbol.is_empty() { &key } else { &self.name };
        let is_as_written = !plot::is_ours(name);
        figure::Quantity { is_as_written, ..figure::Quantity::new(name, &self.symbol, &self.unit).keyed(&self.key) }
    }
}

/// Parameters of the task: everything that decides a picture besides the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Params {
    show: Show,
    /// Millimetres.
    width: f64,
    points: f64,
    colors: Map,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    responses: Vec<Label>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    factors: Vec<Label>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    at: BTreeMap<String, f64>,
    /// Names of the inputs in the legend, when there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    series: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    band: Option<f64>,
    /// Where a specimen in space is cut open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cut: Option<cut::Cut>,
    /// The columns of a plot of the user's own columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plot: Option<Plot>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    labels: Labels,
    /// The group of each curve: its number and name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    groups: Vec<(usize, String)>,
    /// The stages of a graph.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    outline: Vec<Outline>,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    invalid: Invalid,
    /// Sentences on the runs whose curves are drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    /// Symbols of the responses that sentences below the picture may name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    symbols: BTreeMap<String, String>,
}

impl Stage for Figure {
    fn inputs(&self) -> Vec<Port> {
        let needs = self.show.needs();
        let mut ports = vec![Port { key: "of", stages: self.of.list(), accepts: needs.from }];
        if !self.compare.list().is_empty() {
            ports.push(Port { key: "compare", stages: self.compare.list(), accepts: needs.compare });
        }
        ports
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::PICTURE
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = self.check_counts();
        for name in self.response.list().iter().filter(|name| !context.responses.contains_key(*name)) {
            let known: Vec<&str> = context.responses.keys().map(String::as_str).collect();
            let message = format!("there is no [response.{name}]");
            found.push(
                Complaint::new("response", message)
                    .missing(Named::Response, name)
                    .among(context.responses.keys())
                    .hint(format!("known: {}", known.join(", "))),
            );
        }
        let of = self.of.list();
        found.extend(check_given(context, "response", &of.iter().collect::<Vec<_>>(), &self.response.list()));
        let factors = self.factors.iter().map(|f| ("factors", f)).chain(self.at.keys().map(|f| ("at", f)));
        for (key, name) in factors.filter(|(_, name)| !context.factors.contains_key(*name)) {
            let known: Vec<&str> = context.factors.keys().map(String::as_str).collect();
            let message = format!("there is no [factor.{name}]");
            found.push(
                Complaint::new(key, message)
                    .missing(Named::Factor, name)
                    .among(context.factors.keys())
                    .hint(format!("known: {}", known.join(", "))),
            );
        }
        found.extend(self.names.keys().filter_map(|key| self.check_named(key, context)));
        for label in self.names.values().chain(&self.caption) {
            if let Err(fault) = text::check(label) {
                found.push(Complaint::new("", fault.to_string()));
            }
        }
        let (width, points) = (self.width.millimetres(), self.points.unwrap_or(8.0));
        if !(40.0..=1000.0).contains(&width) {
            found.push(Complaint::new("width", format!("{width} mm is no width of a figure")).hint("40 mm to 1000 mm"));
        }
        if !(4.0..=30.0).contains(&points) {
            found.push(Complaint::new("points", format!("{points} points is no size of text")).hint("4 to 30"));
        }
        found.extend(Plot::of(self).check(self.show, &|key| self.without_effect(key)));
        if self.invalid == Some(Invalid::LeaveOut) && !self.show.needs().runs {
            found.push(self.without_effect("invalid"));
        }
        if self.show == Show::Specimen {
            found.extend(cut::Cut::check(self.cut, self.cut_at, &of, context));
        } else {
            let keys = [("cut", self.cut.is_some()), ("cut_at", self.cut_at.is_some())];
            found.extend(keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| self.without_effect(key)));
        }
        if self.band.is_some() && self.show != Show::Agreement && self.show != Show::ObservedPredicted {
            found.push(self.without_effect("band"));
        }
        found
    }

    fn reads(&self) -> Vec<Reads> {
        let main = self.table.as_deref().is_none_or(|name| Some(name) == ArtifactKind::RESULTS.main_table());
        let read = |path: &str, columns: Vec<&String>| Reads {
            path: path.to_owned(),
            stages: self.of.list(),
            columns: columns.into_iter().cloned().collect(),
        };
        let mut all = vec![read("factors", self.factors.iter().collect())];
        if main && self.show.needs().is_plot() {
            // Curves have columns of their own along and up the page.
            let along = (self.show != Show::Curves).then_some([("x", &self.x), ("y", &self.y), ("value", &self.value)]);
            all.extend(along.into_iter().flatten().map(|(key, column)| read(key, column.iter().collect())));
            all.extend([read("by", self.by.iter().collect()), read("where", self.only.keys().collect())]);
        }
        all
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        if let Some(path) = &self.overlay {
            found.file("overlay", path);
        }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let plot = self.show.needs().is_plot().then(|| Plot::of(self));
        let labels = plot.as_ref().map(|plot| plot.labels(self.show, known.context, &self.names)).unwrap_or_default();
        let runs = if self.show == Show::Curves { curves::runs(self, known)? } else { curves::Runs::default() };
        let params = Params {
            cut: cut::Cut::of(self.cut, self.cut_at),
            plot,
            labels,
            groups: runs.groups,
            notes: runs.notes,
            symbols: if self.show.needs().of_analyses() { symbols(known.context) } else { BTreeMap::new() },
            invalid: if self.show == Show::Dag { Invalid::default() } else { self.choice() },
            show: self.show,
            width: self.width.millimetres(),
            points: self.points.unwrap_or(8.0),
            colors: self.colors,
            responses: self.response_labels(known.context),
            factors: self.factor_labels(known)?,
            at: self.at.clone(),
            series: self.series(),
            band: self.band,
            outline: if self.show == Show::Dag { flow::outline(&self.of.list(), known.context) } else { Vec::new() },
        };
        if self.show == Show::Dag {
            return Ok(Step::Finish(Task::new(Self::WORKS[0].name, json!(params))));
        }
        let mut task = Task::new(Self::WORKS[0].name, json!(params));
        if let Some(path) = &self.overlay {
            task.files.push(known.library.file("overlay", path)?);
        }
        if self.show == Show::Curves {
            task.inputs = runs.inputs;
            return Ok(Step::Finish(task));
        }
        for port in ["of", "compare"] {
            for input in known.port(port) {
                task = task.input(port, input.content);
            }
        }
        Ok(Step::Finish(task))
    }
}

/// Symbols of the responses.
fn symbols(context: &Context) -> BTreeMap<String, String> {
    context.symbols().into_iter().filter(|(name, _)| context.responses.contains_key(name)).collect()
}

impl Figure {
    fn without_effect(&self, key: &str) -> Complaint {
        Complaint::new(key, format!("`{key}` has no effect on a figure that shows `{}`", self.show.name()))
            .hint(format!("leave out `{key}`"))
    }

    /// Settings without effect, and too few or too many names.
    fn check_counts(&self) -> Vec<Complaint> {
        let needs = self.show.needs();
        let mut found = Vec::new();
        if self.of.list().is_empty() {
            found.push(Complaint::new("of", "no stage is named"));
        }
        if needs.compare == Accepts::Only(&[]) && !self.compare.list().is_empty() {
            found.push(self.without_effect("compare"));
        }
        let (from, compare) = (self.of.list().len(), self.compare.list().len());
        if self.show == Show::Snapshots && compare != 1 {
            let message = format!("`compare` names {compare} stages; snapshots are drawn on one specimen");
            found.push(Complaint::new("compare", message).hint("name the specimen of the run"));
        }
        if self.show == Show::Agreement && from != compare {
            let message = format!("`of` names {from} stages and `compare` {compare}; they are compared in pairs");
            found.push(Complaint::new("compare", message));
        }
        if !self.at.is_empty() && !matches!(self.show, Show::Contour | Show::Surface) {
            found.push(self.without_effect("at"));
        }
        for (key, count, [least, most]) in
            [("response", self.response.list().len(), needs.responses), ("factors", self.factors.len(), needs.factors)]
        {
            if most == 0 && count > 0 {
                found.push(self.without_effect(key));
            } else if count < least || count > most {
                let wanted = if least == most { format!("{least}") } else { format!("at least {least}") };
                let message = format!("`{key}` names {count}, but `{}` shows {wanted}", self.show.name());
                found.push(Complaint::new(key, message));
            }
        }
        found
    }
}

impl Kind for Figure {
    const NAME: &'static str = "figure";
    const ABOUT: &'static str = "a picture of the results of other stages";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::PICTURE];
    const CLASS: Class = Class::Presentation;
    /// 2: numbers at points of designs stand on a ground of paper; "1 crack"; force chains are those above the mean.
    /// 3: surfaces say where their axes lie. 4: empty columns in the legend of contributions; normal plots.
    /// 5: several targets of a solution set one below the other; circles of PNG files without the system's cosines.
    /// 6: descriptions in plain letters, without stray blanks. 7: a stage named after its kind says it once; force
    /// chains say when. 8: one arithmetic of conversion: last digits of stresses, lengths and forces; values in other
    /// units than their factors and responses are converted and no longer taken as they stand. 9: standardised effects
    /// where a screening has an error to test against; discs in a round outline. 10: the numbers of curves stand below
    /// one another. 11: runs that are not valid are left out or marked, which is stated below the picture. 12: titles of
    /// axes stay on the page; lines of a contour are labelled in the words of its bar. 13: names
    /// in what is stated below the picture keep their letters. 14: pictures in space name their axes as specimens do: the
    /// load acts along y. 15: cylinders and thick discs in space have a round frame; cells of a matrix say where they are.
    /// 16: the scatter of a single run in a verification is unknown, not zero. 17: titles, descriptions and the sentences
    /// below a picture use the declared symbols.
    /// 18: overlays keep their own units; lines are straight on logarithmic axes; the mean of curves ends where the first does;
    /// bands and bars are named; powers are raised in plain words.
    /// 19: boxes say how many values they hold and what their whiskers are; names of columns keep their letters in titles; points
    /// on an axis are drawn whole.
    const WORKS: &'static [Work] = &[Work { name: "figure", version: 19, run: draw }];
}

fn draw(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let sources = source::Sources::new(job);
    let picture: Box<dyn Picture> = match params.show {
        Show::StressStrain => Box::new(run::stress_strain(&params, &sources)?),
        Show::Cracks => run::cracks(&sources)?,
        Show::Damage => damage::damage(&sources)?,
        Show::CrackRose => Box::new(run::rose(&sources)?),
        Show::ForceChains => Box::new(run::chains(&sources)?),
        Show::Snapshots => states::snapshots(&sources)?,
        Show::Specimen => run::specimen(&params, &sources)?,
        Show::MainEffects => Box::new(design::main_effects(&params, &sources)?),
        Show::Range => Box::new(design::range(&params, &sources)?),
        Show::Points => Box::new(design::points(&params, &sources)?),
        Show::Agreement => Box::new(design::agreement(&params, &sources)?),
        Show::Contour => Box::new(model::contour(&params, &sources)?),
        Show::Surface => Box::new(model::surface(&params, &sources)?),
        Show::Residuals => Box::new(model::residuals(&params, &sources)?),
        Show::ObservedPredicted => Box::new(model::observed(&params, &sources)?),
        Show::Pareto => Box::new(model::pareto(&params, &sources)?),
        Show::HalfNormal => Box::new(model::half_normal(&params, &sources)?),
        Show::Normal => Box::new(model::normal(&params, &sources)?),
        Show::Convergence => Box::new(solution::convergence(&params, &sources)?),
        Show::Solutions => Box::new(solution::solutions(&params, &sources)?),
        Show::Verification => Box::new(solution::verification(&params, &sources)?),
        Show::Xy => Box::new(own::xy(&params, &sources, job)?),
        Show::Curves => Box::new(own::curves(&params, &sources, job)?),
        Show::Histogram => Box::new(own::histogram(&params, &sources)?),
        Show::Box => Box::new(own::boxes(&params, &sources)?),
        Show::HeatMap => Box::new(own::heat_map(&params, &sources)?),
        Show::Envelope => Box::new(model::envelope(&sources)?),
        Show::Stones => Box::new(space::stones(&sources)?),
        Show::Zingg => Box::new(space::zingg(&sources)?),
        Show::Dag => Box::new(flow::dag(&params.outline)),
    };
    let style = Style { points: params.points, map: params.colors, ..Style::wide(params.width) };
    picture_artifact(&*picture, &style, &validity::sentences(&params, &sources)?, job.say)
}

/// Resolution of the PNG in dots per inch.
const DPI: f64 = 300.0;

/// Seconds for each scene of a moving picture.
const PACE: f64 = 0.12;

/// A stored picture: the three files, a description for those who cannot see it, and its numbers.
fn picture_artifact(
    picture: &dyn Picture,
    style: &Style,
    below: &[String],
    say: &dyn Fn(Progress),
) -> Result<Artifact, Failure> {
    let mut scene = picture.scene(style);
    scene.footnotes(below, style);
    let faults = scene.faults();
    if let Some(first) = faults.first() {
        let more =
            if faults.len() > 1 { format!(", and {} more such labels", faults.len() - 1) } else { String::new() };
        let first = first.split(": [").next().unwrap_or(first);
        let words = format!("{first}{more}; make the figure wider, or give shorter `names` or symbols");
        say(Progress::warning(&words));
    }
    let frames = picture.frames(style);
    let png = figure::png::png(&scene, DPI).map_err(|e| StageError::new(e.to_string()))?;
    let stored = Stored {
        svg: figure::svg::svg(&scene),
        pdf: figure::pdf::pdf(&scene),
        png,
        moving: figure::film::film(&frames, PACE),
        data: stored(picture.data()),
        title: scene.title,
        description: scene.description,
    };
    Ok(stored.to_artifact())
}

/// Columns of a figure as a table of the store; a second column of the same name gets a number.
pub(super) fn stored(columns: Vec<column::Column>) -> Table {
    let rows = columns.iter().map(column::Column::len).max().unwrap_or(0);
    let mut table = Table::default();
    for c in columns {
        let mut name = c.key.clone();
        let mut number = 2;
        while name.is_empty() || table.column(&name).is_some() {
            name = format!("{}_{number}", c.key);
            number += 1;
        }
        table = match c.values {
            column::Values::Reals(mut values) => {
                values.resize(rows, f64::NAN);
                table.reals_column(&name, &c.unit, "", values)
            }
            column::Values::Whole(values) => {
                let mut values: Vec<f64> = values.into_iter().map(|v| v as f64).collect();
                values.resize(rows, f64::NAN);
                table.reals_column(&name, &c.unit, "", values)
            }
            column::Values::Words(mut values) => {
                values.resize(rows, String::new());
                table.texts_column(&name, "", values)
            }
        };
    }
    table
}

#[cfg(test)]
mod tests;
