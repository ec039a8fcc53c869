//! Plots of a user's own columns from any table of a result.

use super::super::invalid::Invalid;
use super::super::units::field_unit;
use super::super::{Failure, Job, StageError, data};
use super::plot::{Bars, Direction, Fit, Labels, Plot};
use super::source::{Source, Sources};
use super::{Label, Params};
use crate::artifact::run::Run;
use crate::artifact::{Column, Table, Values};
use crate::unit::Conversion;
use figure::Quantity;
use figure::axis::{Scale, significant};
use figure::boxes::{self, BoxPlot};
use figure::bundle::{self, Bundle};
use figure::heatmap::HeatMap;
use figure::histogram::Histogram;
use figure::marks::Band;
use figure::xy::{Cloud, Xy};
use math::elementary::{log10, pow};
use stats::band::mean_curve;
use stats::groups::{groups, pivot};
use stats::regression::{Regression, Settings, regress};
use stats::sample::{Factor, Response, Sample};
use stats::summary::{self, Summary};
use stats::terms::Term;
use std::collections::HashSet;

/// Beyond this the length of an axis may be infinite.
const LARGEST: f64 = 1e300;

/// A column of the plot: its quantity, its numbers, and names where its cells are words.
pub(super) struct Shown {
    pub quantity: Quantity,
    pub values: Vec<f64>,
    names: Vec<String>,
}

impl Shown {
    /// Refuses words for the key of a plot that needs numbers.
    fn of_numbers(self, key: &str) -> Result<Self, StageError> {
        if self.names.is_empty() {
            return Ok(self);
        }
        let is_word = |name: &&String| name.replacen(',', ".", 1).parse::<f64>().is_err();
        let words: Vec<String> = self.names.iter().filter(is_word).take(3).map(|word| format!("`{word}`")).collect();
        let message = format!(
            "column `{}` holds words ({}), which have no place on an axis",
            self.quantity.id(),
            words.join(", ")
        );
        let hint = "or, where they stand for no value, list them under `missing` of the `data` stage";
        Err(StageError::new(message).hint(format!("name a column of numbers for `{key}`, {hint}")))
    }

    /// The chosen rows of a column in the unit of its label, or in the field's unit.
    fn of(table: &Table, label: &Label, rows: &[usize]) -> Result<Self, StageError> {
        let column = table.column(&label.key).ok_or_else(|| {
            let there = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
            StageError::new(format!("the table has no column `{}`", label.key)).hint(format!("it has {there}"))
        })?;
        let (all, names) = numbers(column);
        let values: Vec<f64> = rows.iter().map(|&row| all[row]).collect();
        let largest = values.iter().copied().filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()));
        let unit = match label.unit.as_str() {
            "" if names.is_empty() => field_unit(&column.unit, largest),
            own => own.to_owned(),
        };
        let to = Conversion::between(&column.unit, &unit);
        let words = |unit: &str| if unit.is_empty() { "no unit".to_owned() } else { format!("`{unit}`") };
        let to = to.map_err(|e| {
            let (name, own, wanted) = (&column.name, words(&column.unit), words(&unit));
            StageError::new(format!("column `{name}` is in {own} and is drawn in {wanted}: {e}"))
                .hint("give the column's unit in its head, as in `Ec [GPa]`")
        })?;
        let values = to.of_all(values);
        if let Some(value) = values.iter().find(|value| value.abs() > LARGEST) {
            let message = format!("column `{}` has values of the size {value:e}, which no axis can show", column.name);
            return Err(StageError::new(message).hint("take another unit, or leave the row out with `where`"));
        }
        Ok(Self { quantity: Quantity { unit, ..label.quantity() }, values, names })
    }

    /// The text of a value of the column in a legend or below a box.
    pub(super) fn text(&self, value: f64) -> String {
        self.names.get(value as usize).cloned().unwrap_or_else(|| short(value))
    }

    /// The values of the groups, in ascending order of numbers or names.
    pub(super) fn distinct(&self) -> Vec<f64> {
        groups(&[&self.values]).into_iter().map(|group| group.key[0]).collect()
    }
}

/// The shortest text of a number.
fn short(value: f64) -> String {
    let text = significant(value, 6);
    let plain = text.contains('.') && !text.contains('×');
    if plain { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The numbers of a column; of words their alphabetical indices.
fn numbers(column: &Column) -> (Vec<f64>, Vec<String>) {
    match &column.values {
        Values::Reals(values) => (values.clone(), Vec::new()),
        Values::Ints(values) => (values.iter().map(|&v| v as f64).collect(), Vec::new()),
        Values::Texts(texts) => {
            let mut names = texts.clone();
            names.sort();
            names.dedup();
            let place = |text: &String| names.iter().position(|n| n == text).map_or(f64::NAN, |i| i as f64);
            (texts.iter().map(place).collect(), names)
        }
    }
}

/// The rows of a table in which the given columns have the given values.
fn chosen_rows(table: &Table, plot: &Plot, invalid: Invalid) -> Result<Vec<usize>, StageError> {
    let judged = invalid.judge(table)?;
    let mut rows: Vec<usize> = (0..table.rows()).collect();
    for (name, wanted) in &plot.only {
        let column = table.column(name).ok_or_else(|| StageError::new(format!("the table has no column `{name}`")))?;
        let number = wanted.parse::<f64>().ok();
        rows.retain(|&i| match &column.values {
            Values::Texts(texts) => texts[i] == *wanted,
            Values::Ints(values) => number == Some(values[i] as f64),
            Values::Reals(values) => number == Some(values[i]),
        });
    }
    if rows.is_empty() {
        let asked: Vec<String> = plot.only.iter().map(|(name, wanted)| format!("{name} = {wanted}")).collect();
        let there = plot.only.keys().filter_map(|name| Some((name, table.column(name)?)));
        let there: Vec<String> = there.map(|(name, column)| format!("`{name}` has {}", values_of(column))).collect();
        let message = format!("no row has the values that `where` asks for: {}", asked.join(", "));
        return Err(StageError::new(message).hint(there.join("; ")));
    }
    rows.retain(|&row| !judged.leaves_out(row));
    if let (true, Some(sentence)) = (rows.is_empty(), judged.sentence()) {
        return Err(
            StageError::new(format!("no run is left to draw: {sentence}")).hint("invalid = \"keep\" draws them")
        );
    }
    Ok(rows)
}

/// The different values of a column, as many as a person reads.
fn values_of(column: &Column) -> String {
    const MOST: usize = 12;
    let texts = match &column.values {
        Values::Texts(texts) => texts.clone(),
        Values::Ints(values) => values.iter().map(ToString::to_string).collect(),
        Values::Reals(values) => values.iter().map(|value| short(*value)).collect(),
    };
    let mut seen = HashSet::new();
    let different: Vec<String> = texts.into_iter().filter(|text| seen.insert(text.clone())).collect();
    let more = if different.len() > MOST { format!(", … ({} in all)", different.len()) } else { String::new() };
    format!("{}{more}", different[..different.len().min(MOST)].join(", "))
}

/// The plot, its labels, and the table that it draws.
pub(super) struct Drawn<'a> {
    pub plot: &'a Plot,
    labels: &'a Labels,
    pub table: &'a Table,
    pub rows: Vec<usize>,
}

impl<'a> Drawn<'a> {
    pub(super) fn of(params: &'a Params, sources: &Sources<'a>) -> Result<Self, StageError> {
        let plot = params.plot.as_ref().ok_or_else(|| StageError::new("the figure names no column"))?;
        let Source(artifact) = sources.first()?;
        let main = || super::super::artifact_kind(artifact).and_then(|kind| kind.main_table());
        let name = plot.table.as_deref().or_else(main).unwrap_or("runs");
        let table = artifact.table(name).ok_or_else(|| {
            let there: Vec<String> = artifact.tables().into_iter().map(|(name, _)| name).collect();
            StageError::new(format!("the artifact `{}` holds no table `{name}`", artifact.kind))
                .hint(format!("it holds {}", there.join(", ")))
        })?;
        Ok(Self { plot, labels: &params.labels, table, rows: chosen_rows(table, plot, params.invalid)? })
    }

    fn label(&self, key: &str) -> Result<&'a Label, StageError> {
        self.labels.get(key).ok_or_else(|| StageError::new(format!("the figure names no column `{key}`")))
    }

    pub(super) fn column(&self, key: &str) -> Result<Shown, StageError> {
        Shown::of(self.table, self.label(key)?, &self.rows)
    }

    pub(super) fn by(&self) -> Result<Option<Shown>, StageError> {
        self.labels.get("by").map(|label| Shown::of(self.table, label, &self.rows)).transpose()
    }
}

pub(super) fn xy(params: &Params, sources: &Sources, job: &Job) -> Result<Xy, Failure> {
    let drawn = Drawn::of(params, sources)?;
    let (x, y, by) = (drawn.column("x")?.of_numbers("x")?, drawn.column("y")?.of_numbers("y")?, drawn.by()?);
    for (shown, direction, key) in [(&x, Direction::X, "x"), (&y, Direction::Y, "y")] {
        if drawn.plot.log.contains(&direction) && !shown.values.iter().any(|v| *v > 0.0) {
            let message = format!("column `{}` has no value above zero for a logarithmic axis", shown.quantity.id());
            return Err(StageError::new(message).hint(format!("leave `{key}` out of `log`")).into());
        }
    }
    let rows_of = |key: Option<f64>| -> Vec<usize> {
        let mine = |i: &usize| key.is_none_or(|key| by.as_ref().is_some_and(|b| b.values[*i] == key));
        (0..x.values.len()).filter(mine).filter(|&i| x.values[i].is_finite() && y.values[i].is_finite()).collect()
    };
    let keys: Vec<Option<f64>> = by.as_ref().map_or(vec![None], |b| b.distinct().into_iter().map(Some).collect());
    let cloud = |key: &Option<f64>| {
        let rows = rows_of(*key);
        let pick = |values: &[f64]| rows.iter().map(|&i| values[i]).collect::<Vec<f64>>();
        let name = key.map_or_else(String::new, |k| by.as_ref().map_or_else(String::new, |b| b.text(k)));
        cloud(drawn.plot, name, pick(&x.values), pick(&y.values))
    };
    let clouds: Vec<Cloud> = keys.iter().map(cloud).filter(|c| !c.x.is_empty()).collect();
    if clouds.is_empty() {
        let message = format!("no row has numbers in both `{}` and `{}`", x.quantity.id(), y.quantity.id());
        return Err(StageError::new(message).into());
    }
    let measured = overlay(job, params, [&x.quantity, &y.quantity])?;
    let measured = measured.map(|line| Cloud { name: line.name, x: line.x, y: line.y, ..Cloud::default() });
    Ok(Xy {
        x_scale: drawn.plot.scale(Direction::X),
        y_scale: drawn.plot.scale(Direction::Y),
        by: by.map(|b| b.quantity).unwrap_or_default(),
        clouds,
        joined: drawn.plot.joined,
        limits: [drawn.plot.x_limits, drawn.plot.y_limits],
        measured: measured.into_iter().collect(),
        band: drawn.plot.fit.map_or_else(String::new, |_| format!("{} confidence of the line", drawn.plot.percent())),
        bars: drawn.plot.bars.map_or_else(String::new, |bars| drawn.plot.bars_in_words(bars)),
        x: x.quantity,
        y: y.quantity,
    })
}

/// The points of one group, with the requested line through all of them.
fn cloud(plot: &Plot, name: String, x: Vec<f64>, y: Vec<f64>) -> Cloud {
    let (line, note) = match plot.fit.and_then(|fit| fitted(plot, fit, &x, &y)) {
        Some(found) => (Some(band(plot, &found, &x)), told(plot, &found)),
        None => (None, String::new()),
    };
    let Some(bars) = plot.bars else {
        return Cloud { name, x, y, line, note, ..Cloud::default() };
    };
    let mut cloud = Cloud { name, line, note, ..Cloud::default() };
    for group in groups(&[&x]) {
        let values: Vec<f64> = group.rows.iter().map(|&i| y[i]).collect();
        let Some(summary) = Summary::of(&values) else { continue };
        let half = match bars {
            Bars::Deviation => summary.deviation,
            Bars::Interval => summary.half_interval(plot.coverage()),
        };
        cloud.x.push(group.key[0]);
        cloud.y.push(summary.mean);
        cloud.y_error.push(half.unwrap_or(f64::NAN));
    }
    cloud
}

/// A straight line on the axes of a plot: the values of a logarithmic axis are fitted by their logarithms.
pub(super) struct Fitted {
    fit: Fit,
    found: Regression,
}

/// Least squares of one column on the other, as straight on the page as the axes are; `None` where the points do not
/// determine the line. Points that a logarithmic axis cannot show are not in it.
pub(super) fn fitted(plot: &Plot, fit: Fit, x: &[f64], y: &[f64]) -> Option<Fitted> {
    let (along, up) = (plot.scale(Direction::X), plot.scale(Direction::Y));
    let placed = x.iter().zip(y).map(|(&x, &y)| (on_axis(along, x), on_axis(up, y)));
    let (x, y): (Vec<f64>, Vec<f64>) = placed.filter(|(x, y)| x.is_finite() && y.is_finite()).unzip();
    let sample = Sample { factors: vec![Factor::new("x", x)], responses: vec![Response::new("y", y)], weights: None };
    let slope = Term::power("x", 1);
    let terms = match fit {
        Fit::Line => vec![Term::constant(), slope],
        Fit::ThroughOrigin => vec![slope],
    };
    let found = regress(&sample, "y", &terms, &Settings::default()).ok()?;
    Some(Fitted { fit, found })
}

/// A value where it stands on an axis; not finite for a value that the axis cannot show.
fn on_axis(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log => log10(value),
    }
}

/// The value at a place on an axis.
fn off_axis(scale: Scale, place: f64) -> f64 {
    match scale {
        Scale::Linear => place,
        Scale::Log => pow(10.0, place),
    }
}

/// Points along a drawn line.
const ALONG: usize = 61;

fn band(plot: &Plot, Fitted { fit, found }: &Fitted, x: &[f64]) -> Band {
    let (along, up) = (plot.scale(Direction::X), plot.scale(Direction::Y));
    let (low, high) = figure::axis::extent(x.iter().map(|&x| on_axis(along, x)).filter(|x| x.is_finite()));
    let (low, high) = if *fit == Fit::ThroughOrigin { (low.min(0.0), high.max(0.0)) } else { (low, high) };
    let at = |i: usize| low + (high - low) * i as f64 / (ALONG - 1) as f64;
    let mut line = Band::default();
    for place in (0..ALONG).map(at) {
        let said = found.model.predict(&[place], plot.coverage());
        let (below, above) = said.confidence.unwrap_or((f64::NAN, f64::NAN));
        line.x.push(off_axis(along, place));
        line.y.push(off_axis(up, said.value));
        line.low.push(off_axis(up, below));
        line.high.push(off_axis(up, above));
    }
    line
}

/// Slope with its standard error and R², in label markup.
fn told(plot: &Plot, Fitted { fit, found }: &Fitted) -> String {
    let Some(slope) = found.natural.last() else { return String::new() };
    let error = slope.std_error.map_or_else(String::new, |e| format!(" (std. error {})", significant(e, 2)));
    let kind = if *fit == Fit::ThroughOrigin { " about zero" } else { "" };
    let what = match (plot.scale(Direction::X), plot.scale(Direction::Y)) {
        (Scale::Linear, Scale::Linear) => "slope",
        (Scale::Log, Scale::Log) => "exponent",
        (Scale::Linear, Scale::Log) => "decades per unit",
        (Scale::Log, Scale::Linear) => "rise per decade",
    };
    format!("{what} {}{error}, $R^2${kind} {}", significant(slope.estimate, 4), figure::axis::fixed(found.fit.r2, 4))
}

/// The user's own columns `x` and `y`, in the units of the plot; in the legend with the name of its file, or that of `names`.
fn overlay(job: &Job, params: &Params, [x, y]: [&Quantity; 2]) -> Result<Option<bundle::Line>, Failure> {
    let Some(file) = job.files.iter().find(|file| file.name == "overlay") else { return Ok(None) };
    let table = data::parse(&job.file("overlay")?)?;
    let named = |q: &Quantity| table.column(q.id());
    let numeric: Vec<&Column> = table.columns.iter().filter(|c| !matches!(c.values, Values::Texts(_))).collect();
    let (first, second) = match (named(x), named(y), numeric.as_slice()) {
        (Some(first), Some(second), _) => (first, second),
        (None, None, [first, second]) => (*first, *second),
        _ => {
            let there = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
            let message = format!("the overlay has no columns `{}` and `{}`; it has {there}", x.id(), y.id());
            let hint = "name its columns like those of the plot, or leave exactly two columns of numbers in it";
            return Err(StageError::new(message).hint(hint).into());
        }
    };
    let read = |column: &Column, q: &Quantity| {
        let to = Conversion::between(&column.unit, &q.unit);
        let to = to.map_err(|e| {
            let (name, unit) = (&column.name, &q.unit);
            StageError::new(format!("overlay, column `{name}`: {e}"))
                .hint(format!("give its unit in the head: `{name} [{unit}]`"))
        })?;
        Ok::<Vec<f64>, StageError>(to.of_all(numbers(column).0))
    };
    let stem = file.path.file_stem().map(|stem| stem.to_string_lossy().replace('_', " ")).unwrap_or_default();
    let name = params.labels.get("overlay").map_or(stem, |label| label.name.clone());
    Ok(Some(bundle::Line { name, x: read(first, x)?, y: read(second, y)? }))
}

/// Number of abscissae at which a mean curve is computed.
const MEAN_PLACES: usize = 201;

pub(super) fn curves(params: &Params, sources: &Sources, job: &Job) -> Result<Bundle, Failure> {
    let label = |key: &str| params.labels.get(key).ok_or_else(|| StageError::new(format!("no column `{key}`")));
    let mut all: Vec<(bundle::Line, usize)> = Vec::new();
    let mut quantities: Option<[Quantity; 2]> = None;
    for (k, source) in sources.of.iter().enumerate() {
        // a run whose specimen failed has no curve
        let Some(table) = Run::curve_of(source.0) else { continue };
        let every: Vec<usize> = (0..table.rows()).collect();
        // all curves in the units of the first
        let fixed = |key: &str, i: usize| -> Result<Label, StageError> {
            let label = label(key)?;
            let unit = quantities.as_ref().map_or_else(|| curve_unit(label), |q| q[i].unit.clone());
            Ok(Label { unit, ..label.clone() })
        };
        let (x, y) = (fixed("x", 0)?, fixed("y", 1)?);
        let (x, y) = (Shown::of(table, &x, &every)?, Shown::of(table, &y, &every)?);
        all.push((bundle::Line { name: format!("run {}", k + 1), x: x.values, y: y.values }, group_of(params, k)));
        quantities.get_or_insert([x.quantity, y.quantity]);
    }
    let [x, y] = quantities.ok_or_else(|| StageError::new("no run has a curve").hint("of = a stage of simulate"))?;
    let names: Vec<String> = if params.groups.is_empty() { vec![String::new()] } else { params.group_names() };
    let group = |(i, name): (usize, String)| {
        let curves: Vec<bundle::Line> = all.iter().filter(|(_, g)| *g == i).map(|(line, _)| line.clone()).collect();
        let pairs: Vec<(&[f64], &[f64])> = curves.iter().map(|c| (c.x.as_slice(), c.y.as_slice())).collect();
        let mean = (curves.len() > 1).then(|| {
            let m = mean_curve(&pairs, MEAN_PLACES);
            let shift = |s: f64| m.mean.iter().zip(&m.deviation).map(|(mean, d)| mean + s * d).collect();
            Band { low: shift(-1.0), high: shift(1.0), x: m.x, y: m.mean }
        });
        bundle::Group { name, curves, mean }
    };
    let groups = names.into_iter().enumerate().map(group).filter(|g| !g.curves.is_empty()).collect();
    let measured = overlay(job, params, [&x, &y])?.into_iter().collect();
    let limits = params.plot.as_ref().map_or([None; 2], |plot| [plot.x_limits, plot.y_limits]);
    Ok(Bundle { x, y, groups, band: "one standard deviation".into(), measured, limits })
}

/// Per cent for a strain, else the declared unit; `None` for the unit of the field.
fn curve_unit(label: &Label) -> String {
    if label.key.ends_with("strain") { "%".to_owned() } else { label.unit.clone() }
}

fn group_of(params: &Params, input: usize) -> usize {
    params.groups.get(input).map_or(0, |(group, _)| *group)
}

pub(super) fn histogram(params: &Params, sources: &Sources) -> Result<Histogram, StageError> {
    let shown = Drawn::of(params, sources)?.column("x")?.of_numbers("x")?;
    let bins = summary::histogram(&shown.values, params.plot.as_ref().and_then(|p| p.bins));
    let summary = Summary::of(&shown.values)
        .ok_or_else(|| StageError::new(format!("column `{}` has no number", shown.quantity.id())))?;
    Ok(Histogram {
        quantity: shown.quantity,
        edges: bins.edges,
        counts: bins.counts,
        mean: summary.mean,
        deviation: summary.deviation.unwrap_or(f64::NAN),
    })
}

pub(super) fn boxes(params: &Params, sources: &Sources) -> Result<BoxPlot, StageError> {
    let drawn = Drawn::of(params, sources)?;
    let (y, by) = (drawn.column("y")?.of_numbers("y")?, drawn.by()?);
    let keys: Vec<Option<f64>> = by.as_ref().map_or(vec![None], |b| b.distinct().into_iter().map(Some).collect());
    let group = |key: &Option<f64>| {
        let mine = |i: &usize| key.is_none_or(|key| by.as_ref().is_some_and(|b| b.values[*i] == key));
        let values: Vec<f64> =
            (0..y.values.len()).filter(mine).map(|i| y.values[i]).filter(|v| v.is_finite()).collect();
        let s = Summary::of(&values)?;
        let name = key.map_or_else(String::new, |k| by.as_ref().map_or_else(String::new, |b| b.text(k)));
        Some(boxes::Group { name, five: [s.low, s.first, s.median, s.third, s.high], mean: s.mean, values })
    };
    let found: Vec<boxes::Group> = keys.iter().filter_map(group).collect();
    if found.is_empty() {
        return Err(StageError::new(format!("column `{}` has no number", y.quantity.id())));
    }
    let scale = drawn.plot.scale(Direction::Y);
    Ok(BoxPlot {
        by: by.map(|b| b.quantity).unwrap_or_default(),
        y: y.quantity,
        scale,
        groups: found,
        limits: drawn.plot.y_limits,
    })
}

pub(super) fn heat_map(params: &Params, sources: &Sources) -> Result<HeatMap, StageError> {
    let drawn = Drawn::of(params, sources)?;
    let (across, down) = (drawn.column("x")?, drawn.column("y")?);
    let value = drawn.column("value")?.of_numbers("value")?;
    let found = pivot(&down.values, &across.values, &value.values);
    let several = found.cells.iter().flatten().any(|cell| cell.n > 1);
    let scatter = |cell: &Option<stats::groups::Cell>| cell.and_then(|c| c.deviation).unwrap_or(f64::NAN);
    Ok(HeatMap {
        rows: found.rows.iter().map(|&v| down.text(v)).collect(),
        columns: found.columns.iter().map(|&v| across.text(v)).collect(),
        cells: found.cells.iter().map(|cell| cell.map_or(f64::NAN, |c| c.mean)).collect(),
        scatter: if several { found.cells.iter().map(scatter).collect() } else { Vec::new() },
        down: down.quantity,
        across: across.quantity,
        value: value.quantity,
    })
}
