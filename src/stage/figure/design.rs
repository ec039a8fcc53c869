//! Figures of designs and their results: main effects, ranges, points, agreement with other results.

use super::super::StageError;
use super::source::{Rows, Sources};
use super::{Label, Params};
use crate::figure::agreement::{Agreement, Cloud, Pair};
use crate::figure::axis::significant;
use crate::figure::bars::{Bar, RankedBars};
use crate::figure::effects::{FactorMeans, MainEffects};
use crate::figure::points::DesignPoints;
use crate::stats::range::{Range, range_analysis};
use crate::stats::sample::{Factor, Response, Sample};

fn one_response(params: &Params) -> Result<&Label, StageError> {
    params.responses.first().ok_or_else(|| StageError::new("no response is named"))
}

/// Range analysis of one response for the factors that are drawn.
fn ranges(rows: Rows<'_>, params: &Params, response: &Label) -> Result<Vec<Range>, StageError> {
    let mut sample = Sample::default();
    for factor in &params.factors {
        sample.factors.push(Factor::new(&factor.key, rows.reals(&factor.key)?));
    }
    let values = rows.reals(&response.key)?.into_iter().map(|v| v.is_finite().then_some(v)).collect();
    sample.responses.push(Response { name: response.key.clone(), values });
    range_analysis(&sample).map_err(|e| StageError::new(e.to_string()))
}

/// The same from the table to compare with, when there is one.
fn compared(params: &Params, sources: &Sources, response: &Label) -> Result<Vec<Range>, StageError> {
    match sources.compare.first() {
        Some(source) => ranges(source.rows(&["runs"])?, params, response),
        None => Ok(Vec::new()),
    }
}

pub(super) fn main_effects(params: &Params, sources: &Sources) -> Result<MainEffects, StageError> {
    let response = one_response(params)?;
    let rows = sources.first()?.rows(&["runs"])?;
    let computed = ranges(rows, params, response)?;
    let published = compared(params, sources, response)?;
    let of = |list: &[Range], key: &str| list.iter().find(|r| r.factor == key).map(|r| r.means.clone());
    let factor = |(label, range): (&Label, Range)| FactorMeans {
        factor: named(label),
        group: label.group.clone(),
        levels: range.levels,
        means: range.means,
        half_width: Vec::new(),
        published: of(&published, &label.key).unwrap_or_default(),
    };
    let values: Vec<f64> = rows.reals(&response.key)?.into_iter().filter(|v| v.is_finite()).collect();
    Ok(MainEffects {
        response: response.quantity(),
        grand_mean: values.iter().sum::<f64>() / values.len().max(1) as f64,
        factors: params.factors.iter().zip(computed).map(factor).collect(),
    })
}

/// A factor with its key as name, so that data tables and descriptions can tell it.
fn named(label: &Label) -> crate::figure::Quantity {
    let name = if label.name.is_empty() { &label.key } else { &label.name };
    crate::figure::Quantity::new(name, &label.symbol, &label.unit)
}

pub(super) fn range(params: &Params, sources: &Sources) -> Result<RankedBars, StageError> {
    let response = one_response(params)?;
    let computed = ranges(sources.first()?.rows(&["runs"])?, params, response)?;
    let published = compared(params, sources, response)?;
    let (mut bars, mut references) = (Vec::new(), Vec::new());
    for (label, range) in params.factors.iter().zip(&computed) {
        // A column that sets nothing shows what chance alone does.
        if label.group.is_empty() {
            references.push(("empty column".to_owned(), range.range));
            continue;
        }
        let published = published.iter().find(|r| r.factor == label.key).map(|r| r.range);
        bars.push(Bar { factor: named(label), group: label.group.clone(), value: range.range, published });
    }
    let quantity = response.quantity();
    Ok(RankedBars {
        title: format!("Ranges of {}", if quantity.name.is_empty() { &response.key } else { &quantity.name }),
        quantity: crate::figure::Quantity { name: "Range of".into(), ..quantity },
        bars,
        references,
    })
}

pub(super) fn points(params: &Params, sources: &Sources) -> Result<DesignPoints, StageError> {
    let rows = sources.first()?.rows(&["design", "runs"])?;
    let columns = params.factors.iter().map(|f| rows.reals(&f.key)).collect::<Result<Vec<_>, _>>()?;
    let points: Vec<Vec<f64>> = (0..rows.len()).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    let kinds = if rows.has("point_type") { rows.texts("point_type")? } else { vec!["run".to_owned(); rows.len()] };
    let side = |(label, column): (&Label, &Vec<f64>)| {
        let (low, high) = crate::figure::axis::extent(column.iter().copied());
        let cube: Vec<f64> =
            column.iter().zip(&kinds).filter(|(_, k)| !k.starts_with("axial")).map(|(v, _)| *v).collect();
        let (inner_low, inner_high) = crate::figure::axis::extent(cube);
        let within = label.range.filter(|[a, b]| low <= *a && *b <= high && a < b);
        within.unwrap_or(if inner_high > inner_low { [inner_low, inner_high] } else { [low, high] })
    };
    let sides = params.factors.iter().zip(&columns).map(side).collect();
    let factors = params.factors.iter().map(named_plain).collect();
    Ok(DesignPoints { title: "design".into(), factors, sides, points, kinds })
}

/// Symbol and unit only; the key when there is no symbol.
fn named_plain(label: &Label) -> crate::figure::Quantity {
    label.quantity()
}

pub(super) fn agreement(params: &Params, sources: &Sources) -> Result<Agreement, StageError> {
    let mut pairs: Vec<Pair> = Vec::new();
    for response in &params.responses {
        let mut clouds = Vec::new();
        for (i, (ours, theirs)) in sources.from.iter().zip(&sources.compare).enumerate() {
            let (ours, theirs) = (ours.rows(&["runs"])?, theirs.rows(&["runs"])?);
            if !ours.has(&response.key) || !theirs.has(&response.key) {
                continue;
            }
            let (x, y, rows) = matched(ours, theirs, &response.key, &params.factors)?;
            if !x.is_empty() {
                let name = params.series.get(i).cloned().unwrap_or_default();
                clouds.push(Cloud { name, x, y, rows });
            }
        }
        if clouds.is_empty() {
            let message = format!("no row with `{}` is in both tables", response.key);
            return Err(StageError::new(message).hint("rows are matched by the factors that both tables hold"));
        }
        let note = note_of(&clouds);
        pairs.push(Pair { quantity: response.quantity(), clouds, note });
    }
    Ok(Agreement { x_word: "Published".into(), y_word: "Computed".into(), pairs, band: params.band.or(Some(0.1)) })
}

/// "n = 150, mean +1.2 %, s = 4.0 %" of the relative deviations.
fn note_of(clouds: &[Cloud]) -> String {
    let deviations: Vec<f64> = clouds
        .iter()
        .flat_map(|c| c.x.iter().zip(&c.y))
        .filter(|(x, _)| **x != 0.0)
        .map(|(x, y)| y / x - 1.0)
        .collect();
    let n = deviations.len() as f64;
    let mean = deviations.iter().sum::<f64>() / n;
    let variance = deviations.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    let sign = if mean > 0.0 { "+" } else { "" };
    format!("mean {sign}{} %, $s$ = {} %", significant(100.0 * mean, 2), significant(100.0 * variance.sqrt(), 2))
}

type Matched = (Vec<f64>, Vec<f64>, Vec<String>);

/// Pairs of values (theirs, ours) of rows with equal factors, replicate by replicate, and the row number in theirs.
/// Levels count as equal within a thousandth, because published ones are rounded.
fn matched(ours: Rows<'_>, theirs: Rows<'_>, response: &str, keys: &[Label]) -> Result<Matched, StageError> {
    let shared = keys.iter().map(|label| label.key.as_str()).filter(|key| ours.has(key) && theirs.has(key));
    let factors: Vec<&str> = shared.collect();
    if factors.is_empty() {
        return Err(StageError::new("the two tables share no factor by which rows could be matched"));
    }
    let read = |rows: Rows<'_>| factors.iter().map(|f| rows.reals(f)).collect::<Result<Vec<_>, _>>();
    let (a, b) = (read(ours)?, read(theirs)?);
    let (y, x) = (ours.reals(response)?, theirs.reals(response)?);
    let near = |p: f64, q: f64| (p - q).abs() <= 1e-3 * p.abs().max(q.abs()).max(1e-12);
    let mut used = vec![false; y.len()];
    let mut out: Matched = (Vec::new(), Vec::new(), Vec::new());
    for (j, &value) in x.iter().enumerate() {
        let hit = (0..y.len()).find(|&i| !used[i] && a.iter().zip(&b).all(|(p, q)| near(p[i], q[j])));
        if let Some(i) = hit {
            used[i] = true;
            if value.is_finite() && y[i].is_finite() {
                out.0.push(value);
                out.1.push(y[i]);
                out.2.push((j + 1).to_string());
            }
        }
    }
    Ok(out)
}
