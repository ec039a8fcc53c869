//! Figures of designs and their results: main effects, ranges, points, agreement with other results.

use super::super::StageError;
use super::source::{Rows, Source, Sources, rows_of};
use super::{Label, Params};
use crate::artifact::design::DesignRows;
use crate::artifact::range::Range as Stored;
use figure::agreement::{Agreement, Cloud, Pair};
use figure::axis::fixed;
use figure::bars::{Bar, RankedBars};
use figure::effects::{FactorMeans, MainEffects};
use figure::points::DesignPoints;
use stats::agreement::{agreement as agreement_of, pair_rows};

fn one_response(params: &Params) -> Result<&Label, StageError> {
    params.responses.first().ok_or_else(|| StageError::new("no response is named"))
}

/// Range analysis of one factor for one response.
struct Range {
    factor: String,
    /// `None` where levels are names.
    levels: Option<Vec<f64>>,
    means: Vec<f64>,
    range: f64,
}

/// The analysis of one response for the factors that are drawn, in their order.
fn ranges(source: Source, params: &Params, response: &Label) -> Result<Vec<Range>, StageError> {
    let Stored { range, levels, .. } = Stored::from_artifact(source.0)?;
    let mine = rows_of(&range.response, &response.key)?;
    let mut found = Vec::new();
    for label in &params.factors {
        let row = mine.iter().copied().find(|&row| range.factor[row] == label.key);
        let own = levels.factor.iter().position(|factor| *factor == label.key);
        if let (Some(row), Some(own)) = (row, own) {
            let (levels, means) = (levels.level.numbers(own), range.level.row(row));
            found.push(Range { factor: label.key.clone(), levels, means, range: range.range[row] });
        }
    }
    Ok(found)
}

/// The range in the analysis to compare with, if there is one.
fn compared(params: &Params, sources: &Sources, response: &Label) -> Result<Vec<Range>, StageError> {
    sources.compare.first().map_or(Ok(Vec::new()), |source| ranges(*source, params, response))
}

fn label_of<'a>(params: &'a Params, range: &Range) -> Result<&'a Label, StageError> {
    let found = params.factors.iter().find(|label| label.key == range.factor);
    found.ok_or_else(|| StageError::new(format!("`{}` is not a factor", range.factor)))
}

pub(super) fn main_effects(params: &Params, sources: &Sources) -> Result<MainEffects, StageError> {
    let response = one_response(params)?;
    let computed = ranges(sources.first()?, params, response)?;
    let published = compared(params, sources, response)?;
    let some_set = params.factors.iter().any(|label| !label.group.is_empty());
    let all: Vec<f64> = computed.iter().flat_map(|r| r.means.iter().copied()).collect();
    let mut factors = Vec::new();
    for range in computed {
        let label = label_of(params, &range)?;
        let named =
            || StageError::new(format!("the levels of `{}` are names, which have no place on an axis", label.key));
        factors.push(FactorMeans {
            factor: label.quantity(),
            group: if some_set && label.group.is_empty() { "empty column".into() } else { label.group.clone() },
            published: published.iter().find(|r| r.factor == label.key).map(|r| r.means.clone()).unwrap_or_default(),
            levels: range.levels.ok_or_else(|| named().hint("show = \"range\" compares its means"))?,
            means: range.means,
            half_width: Vec::new(),
        });
    }
    let grand_mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
    Ok(MainEffects { response: response.quantity(), grand_mean, factors })
}

pub(super) fn range(params: &Params, sources: &Sources) -> Result<RankedBars, StageError> {
    let response = one_response(params)?;
    let computed = ranges(sources.first()?, params, response)?;
    let published = compared(params, sources, response)?;
    let (mut bars, mut references) = (Vec::new(), Vec::new());
    let some_set = params.factors.iter().any(|label| !label.group.is_empty());
    for range in &computed {
        let label = label_of(params, range)?;
        // Beside factors that set parameters, a column that sets none shows the effect of chance alone.
        if some_set && label.group.is_empty() {
            references.push(("empty column".to_owned(), range.range));
            continue;
        }
        let published = published.iter().find(|r| r.factor == label.key).map(|r| r.range);
        bars.push(Bar { factor: label.quantity(), group: label.group.clone(), value: range.range, published });
    }
    let quantity = response.quantity();
    Ok(RankedBars {
        title: format!("Ranges of {}", quantity.words()),
        quantity: quantity.worded("Range of"),
        bars,
        references,
    })
}

pub(super) fn points(params: &Params, sources: &Sources) -> Result<DesignPoints, StageError> {
    let rows = sources.first()?.main()?;
    if !(2..=3).contains(&params.factors.len()) {
        let message = format!("points are drawn in two or three factors, not in {}", params.factors.len());
        return Err(StageError::new(message).hint("name them with `factors`"));
    }
    let columns = params.factors.iter().map(|f| rows.reals(&f.key, &f.unit)).collect::<Result<Vec<_>, _>>()?;
    let points: Vec<Vec<f64>> = (0..rows.len()).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    let kinds = match DesignRows::from_table(rows.table) {
        Ok(rows) => rows.point_type,
        Err(_) => vec!["run".to_owned(); rows.len()],
    };
    let side = |(label, column): (&Label, &Vec<f64>)| {
        let (low, high) = figure::axis::extent(column.iter().copied());
        let cube: Vec<f64> =
            column.iter().zip(&kinds).filter(|(_, k)| !k.starts_with("axial")).map(|(v, _)| *v).collect();
        let (inner_low, inner_high) = figure::axis::extent(cube);
        let within = label.range.filter(|[a, b]| low <= *a && *b <= high && a < b);
        within.unwrap_or(if inner_high > inner_low { [inner_low, inner_high] } else { [low, high] })
    };
    let sides = params.factors.iter().zip(&columns).map(side).collect();
    let factors = params.factors.iter().map(Label::quantity).collect();
    Ok(DesignPoints { title: "design".into(), factors, sides, points, kinds })
}

pub(super) fn agreement(params: &Params, sources: &Sources) -> Result<Agreement, StageError> {
    let mut pairs: Vec<Pair> = Vec::new();
    for response in &params.responses {
        let mut clouds = Vec::new();
        for (i, (ours, theirs)) in sources.of.iter().zip(&sources.compare).enumerate() {
            let (ours, theirs) = (ours.main()?, theirs.main()?);
            if !ours.has(&response.key) || !theirs.has(&response.key) {
                continue;
            }
            let (x, y, rows) = matched(ours, theirs, response, params)?;
            if !x.is_empty() {
                let name = params.series.get(i).cloned().unwrap_or_default();
                clouds.push(Cloud { name, x, y, rows });
            }
        }
        if !clouds.is_empty() {
            let note = note_of(&clouds);
            pairs.push(Pair { quantity: response.quantity(), clouds, note });
        }
    }
    if pairs.is_empty() {
        let hint = "rows are matched by the factors that both tables hold";
        return Err(StageError::new("no row with a response is in both tables").hint(hint));
    }
    Ok(Agreement { x_word: "Published".into(), y_word: "Computed".into(), pairs, band: params.band.or(Some(0.1)) })
}

/// "median −4.4 %, quartiles −7.6, −1.6 %" of the relative deviations, which one misprint does not change.
fn note_of(clouds: &[Cloud]) -> String {
    let all = |pick: fn(&Cloud) -> &Vec<f64>| clouds.iter().flat_map(pick).copied().collect::<Vec<_>>();
    let Some(found) = agreement_of(&all(|c| &c.x), &all(|c| &c.y)) else { return String::new() };
    let [lower, median, upper] = found.quartiles.map(|ratio| {
        let percent = fixed(100.0 * (ratio - 1.0), 1);
        if ratio > 1.0 && percent != "0.0" { format!("+{percent}") } else { percent }
    });
    format!("median {median} %, quartiles {lower}, {upper} %")
}

type Matched = (Vec<f64>, Vec<f64>, Vec<String>);

/// Pairs of values (theirs, ours) of rows with equal factors, replicate by replicate, and the row number in theirs.
/// Levels count as equal within a thousandth, because published ones are rounded.
fn matched(ours: Rows<'_>, theirs: Rows<'_>, response: &Label, params: &Params) -> Result<Matched, StageError> {
    let (judged, other) = (params.invalid.judge(ours.table)?, params.invalid.judge(theirs.table)?);
    let shared = params.factors.iter().filter(|label| ours.has(&label.key) && theirs.has(&label.key));
    let factors: Vec<&Label> = shared.collect();
    if factors.is_empty() {
        return Err(StageError::new("the two tables share no factor by which rows could be matched"));
    }
    let read = |rows: Rows<'_>| factors.iter().map(|f| rows.reals(&f.key, &f.unit)).collect::<Result<Vec<_>, _>>();
    let (y, x) = (ours.reals(&response.key, &response.unit)?, theirs.reals(&response.key, &response.unit)?);
    let mut out: Matched = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in pair_rows(&read(ours)?, &read(theirs)?, 1e-3) {
        let counts = !judged.leaves_out(i) && !other.leaves_out(j);
        if counts && x[j].is_finite() && y[i].is_finite() {
            out.0.push(x[j]);
            out.1.push(y[i]);
            out.2.push((j + 1).to_string());
        }
    }
    Ok(out)
}
