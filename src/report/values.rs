//! The numbers of a figure for the script, which shows those under the pointer or the arrow keys.
//!
//! Pictures hold the positions of their axes (`data-x`, `data-y`, `data-space`); this adds what is drawn there, panel by panel
//! in the order of the picture. Three forms, tagged by `form`:
//!
//! * `curve`: per curve axial strain in %, stress, lateral strain in %, and counts of cracks by mode, on one index;
//! * `field`: a response on a regular grid of two factors, thinned; between its nodes the script takes the parabola
//!   through three of them along each side, which is exact for second-order surfaces;
//! * `points`: per panel points with their words; the nearest one is shown, of `cells` however far it is.

mod own;

use crate::artifact::{Table, Values};
use crate::report::symbol;
use crate::stage::Context;
use figure::text::Line;
use figure::{agreement, convergence, curve, effect_plot, effects, residuals};
use serde_json::{Value, json};

/// Nodes along one side of a thinned field.
const NODES: usize = 21;

/// Most points of one figure.
const MOST: usize = 4000;

/// The values of a figure that shows `show`; nothing when the script cannot show them.
pub(super) fn of(show: &str, data: &Table, context: &Context) -> Option<Value> {
    if !matches!(show, "contour" | "surface" | "curves") && data.rows() > MOST {
        return None;
    }
    match show {
        "stress-strain" => curves(data),
        "contour" | "surface" => field(data, context),
        "agreement" | "observed-predicted" => pairs(data, context),
        "main-effects" => effects(data, context),
        "residuals" => residuals(data),
        "convergence" => convergence(data),
        "half-normal" | "normal" => effect_plot(data),
        "xy" | "curves" => own::series(data, context),
        "envelope" => own::series(data, context),
        "pareto" | "range" => bars(data, context),
        "verification" => verification(data, context),
        "histogram" => own::bins(data, context),
        "box" => own::boxes(data),
        "heat-map" => own::cells(data, context),
        _ => None,
    }
}

/// JSON that may stand in a script element: no `<` in it, and nothing that ends a line of a script.
pub(super) fn in_script(value: &Value) -> String {
    let text = value.to_string();
    let escaped = text.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026");
    escaped.replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

/// Numbers with six digits; what is missing is null.
fn short(values: impl IntoIterator<Item = f64>) -> Vec<Value> {
    let round = |v: f64| format!("{v:.5e}").parse::<f64>().unwrap_or(v);
    values.into_iter().map(|v| if v.is_finite() { json!(round(v)) } else { Value::Null }).collect()
}

fn texts<'a>(data: &'a Table, name: &str) -> Option<&'a [String]> {
    match &data.column(name)?.values {
        Values::Texts(values) => Some(values),
        Values::Reals(_) | Values::Ints(_) => None,
    }
}

/// A name for people: the symbol of a factor or response, or the name itself.
fn name_of(context: &Context, key: &str) -> String {
    symbol::raw(context, key).map_or_else(|| key.to_owned(), |s| Line::new(&format!("${s}$"), 1.0).plain)
}

/// The columns of curves that are no counts of cracks.
const CURVE: [&str; 4] = [curve::CURVE, curve::AXIAL_STRAIN, curve::AXIAL_STRESS, curve::LATERAL_STRAIN];

fn curves(data: &Table) -> Option<Value> {
    let numbers = data.ints(CURVE[0]).ok()?;
    let (strain, stress) = (data.numbers(CURVE[1], "").ok()?, data.numbers(CURVE[2], "MPa").ok()?);
    let lateral = data.numbers(CURVE[3], "").ok();
    let modes = data.columns.iter().filter(|column| !CURVE.contains(&column.name.as_str()));
    let modes: Vec<(&str, Vec<f64>)> =
        modes.filter_map(|mode| Some((mode.name.as_str(), mode.numbers("").ok()?))).collect();
    let several = numbers.last().is_some_and(|&last| last > 1);
    let mut curves = Vec::new();
    let mut first = 0;
    for rows in numbers.chunk_by(|a, b| a == b) {
        let own = |values: &[f64]| values[first..first + rows.len()].to_vec();
        let there = |values: &[f64]| Some(own(values)).filter(|own| own.iter().any(|value| value.is_finite()));
        let percent = |values: Vec<f64>| short(values.into_iter().map(|e| 100.0 * e));
        let counted =
            modes.iter().filter_map(|(name, counts)| Some(json!({ "name": name, "values": short(there(counts)?) })));
        curves.push(json!({
            "name": if several { format!("curve {}", rows[0]) } else { String::new() },
            "strain": percent(own(&strain)),
            "stress": short(own(&stress)),
            "lateral": lateral.as_deref().and_then(there).map(percent),
            "cracks": counted.collect::<Vec<_>>(),
        }));
        first += rows.len();
    }
    (!curves.is_empty()).then(|| json!({ "form": "curve", "curves": curves }))
}

fn field(data: &Table, context: &Context) -> Option<Value> {
    let [x, y, z] = data.columns.as_slice() else { return None };
    let (xs, ys, zs) = (data.shown(&x.name).ok()?.0, data.shown(&y.name).ok()?.0, data.shown(&z.name).ok()?.0);
    // Rows go along x first.
    let across = ys.iter().take_while(|v| Some(*v) == ys.first()).count();
    let up = xs.len().checked_div(across)?;
    if across < 3 || up < 3 || across * up != zs.len() {
        return None;
    }
    let thin = |n: usize| {
        let parts = (2..NODES).rev().find(|parts| (n - 1).is_multiple_of(*parts)).unwrap_or(n - 1);
        (0..=parts).map(|k| k * (n - 1) / parts).collect::<Vec<_>>()
    };
    let (columns, rows) = (thin(across), thin(up));
    let nodes = rows.iter().flat_map(|j| columns.iter().map(move |i| j * across + i));
    let axis = |column: &crate::artifact::Column, values: &[f64], count: usize| {
        let ends = short([*values.first()?, *values.last()?]);
        Some(json!({ "name": name_of(context, &column.name), "unit": column.unit, "ends": ends, "count": count }))
    };
    Some(json!({
        "form": "field",
        "x": axis(x, &xs, columns.len())?,
        "y": axis(y, &ys, rows.len())?,
        "z": { "name": name_of(context, &z.name), "unit": z.unit, "values": short(nodes.map(|k| zs[k])) },
    }))
}

/// A point with its words.
type Point = (f64, f64, String);

fn points(panels: Vec<Vec<Point>>) -> Option<Value> {
    let panel = |points: &Vec<Point>| {
        let whole = points.iter().filter(|(x, y, _)| x.is_finite() && y.is_finite());
        let (x, (y, words)): (Vec<f64>, (Vec<f64>, Vec<&String>)) =
            whole.map(|(x, y, words)| (*x, (*y, words))).unzip();
        json!({ "x": short(x), "y": short(y), "words": words })
    };
    let all: Vec<Value> = panels.iter().map(panel).collect();
    (!all.is_empty()).then(|| json!({ "form": "points", "panels": all }))
}

/// Rows that share the word in a column, in the order of first sight.
fn groups(words: &[String]) -> Vec<(&str, Vec<usize>)> {
    let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
    for (i, word) in words.iter().enumerate() {
        match groups.iter_mut().find(|(known, _)| known == word) {
            Some((_, rows)) => rows.push(i),
            None => groups.push((word, vec![i])),
        }
    }
    groups
}

/// A number for people, with its unit.
fn quantity(value: f64, unit: &str) -> String {
    let text = figure::axis::significant(value, 4);
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

fn pairs(data: &Table, context: &Context) -> Option<Value> {
    let [.., a, b] = data.columns.as_slice() else { return None };
    let (xs, ys) = (data.shown(&a.name).ok()?.0, data.shown(&b.name).ok()?.0);
    let (units, origins, rows) =
        (texts(data, agreement::UNIT)?, texts(data, agreement::ORIGIN)?, texts(data, agreement::ROW)?);
    let panel = |(response, members): (&str, Vec<usize>)| {
        let sign = name_of(context, response);
        let words = |i: usize| {
            let origin = if origins[i].is_empty() { String::new() } else { format!("{}, ", origins[i]) };
            let deviation = figure::axis::fixed(100.0 * (ys[i] / xs[i] - 1.0), 1);
            let (x, y) = (quantity(xs[i], &units[i]), quantity(ys[i], &units[i]));
            format!("{origin}run {}: {sign} {} {x}, {} {y} ({deviation} %)", rows[i], a.name, b.name)
        };
        members.into_iter().map(|i| (xs[i], ys[i], words(i))).collect()
    };
    points(groups(texts(data, agreement::RESPONSE)?).into_iter().map(panel).collect())
}

fn effects(data: &Table, context: &Context) -> Option<Value> {
    let (levels, units) = (data.shown(effects::LEVEL).ok()?.0, texts(data, effects::LEVEL_UNIT)?);
    let means = data.column(effects::MEAN)?;
    let (values, unit) = (data.shown(effects::MEAN).ok()?.0, &means.unit);
    let panel = |(factor, rows): (&str, Vec<usize>)| {
        let sign = name_of(context, factor);
        let words =
            |i: usize| format!("{sign} = {}: mean {}", quantity(levels[i], &units[i]), quantity(values[i], unit));
        rows.into_iter().map(|i| (levels[i], values[i], words(i))).collect()
    };
    points(groups(texts(data, effects::FACTOR)?).into_iter().map(panel).collect())
}

fn residuals(data: &Table) -> Option<Value> {
    let runs = texts(data, residuals::RUN)?;
    let numbers = |name: &str| Some(data.shown(name).ok()?.0);
    let ys = numbers(residuals::STUDENTIZED)?;
    let (fitted, quantile) = (numbers(residuals::FITTED)?, numbers(residuals::QUANTILE)?);
    let leverage = numbers(residuals::LEVERAGE)?;
    let order: Vec<f64> = (1..=runs.len()).map(|i| i as f64).collect();
    let panel = |(xs, what): (&Vec<f64>, &str)| {
        let words = |i: usize| {
            format!("run {}: {what} {}, studentized residual {}", runs[i], quantity(xs[i], ""), quantity(ys[i], ""))
        };
        (0..runs.len()).map(|i| (xs[i], ys[i], words(i))).collect()
    };
    let views = [(&quantile, "normal quantile"), (&fitted, "fitted"), (&order, "place"), (&leverage, "leverage")];
    points(views.into_iter().map(panel).collect())
}

fn convergence(data: &Table) -> Option<Value> {
    let [_, effort, ..] = data.columns.as_slice() else { return None };
    let (runs, xs, ys) =
        (texts(data, convergence::RUN)?, data.shown(&effort.name).ok()?.0, data.shown(convergence::BEST).ok()?.0);
    let words =
        |i: usize| format!("{}, {} {}: best misfit {}", runs[i], effort.name, quantity(xs[i], ""), quantity(ys[i], ""));
    points(vec![(0..xs.len()).map(|i| (xs[i], ys[i], words(i))).collect()])
}

fn effect_plot(data: &Table) -> Option<Value> {
    let [_, sizes, ..] = data.columns.as_slice() else { return None };
    let (names, xs, ys) =
        (texts(data, effect_plot::EFFECT)?, data.shown(&sizes.name).ok()?.0, data.shown(effect_plot::QUANTILE).ok()?.0);
    let words = |i: usize| format!("{}: {}", Line::new(&names[i], 1.0).plain, quantity(xs[i], &sizes.unit));
    points(vec![(0..xs.len()).map(|i| (xs[i], ys[i], words(i))).collect()])
}

/// Bars from above: a factor or a term, its value, and the published one.
fn bars(data: &Table, context: &Context) -> Option<Value> {
    let (factors, values) = (texts(data, "factor")?, data.shown("value").ok()?.0);
    let unit = &data.column("value")?.unit;
    let published = data.shown("published").ok().map(|(values, _)| values);
    let words = |i: usize| {
        // A term is a label of its own.
        let name = match symbol::raw(context, &factors[i]) {
            Some(_) => name_of(context, &factors[i]),
            None => Line::new(&factors[i], 1.0).plain,
        };
        let other = published.as_ref().map(|all| all[i]).filter(|value| value.is_finite());
        let other = other.map_or_else(String::new, |value| format!(", published {}", quantity(value, unit)));
        format!("{name}: {}{other}", quantity(values[i], unit))
    };
    let mut found = points(vec![(0..values.len()).map(|i| (values[i], i as f64, words(i))).collect()])?;
    // The bar beside the pointer, however long it is.
    found["cells"] = true.into();
    Some(found)
}

/// Means of the runs of each target set, a panel for each response.
fn verification(data: &Table, context: &Context) -> Option<Value> {
    let (responses, units, sets) = (texts(data, "response")?, texts(data, "unit")?, texts(data, "set")?);
    let (targets, values) = (data.shown("target").ok()?.0, data.shown("value").ok()?.0);
    let panel = |(response, rows): (&str, Vec<usize>)| {
        let own: Vec<String> = rows.iter().map(|&row| sets[row].clone()).collect();
        let set = |(index, (set, members)): (usize, (&str, Vec<usize>))| {
            let runs: Vec<f64> = members.iter().map(|&k| values[rows[k]]).collect();
            let (mean, row) = (runs.iter().sum::<f64>() / runs.len() as f64, rows[members[0]]);
            let said = match runs.len() {
                1 => "the only run gives".to_owned(),
                count => format!("mean of {count} runs"),
            };
            let (name, unit) = (name_of(context, response), &units[row]);
            let (mean_in_words, target) = (quantity(mean, unit), quantity(targets[row], unit));
            (index as f64, mean, format!("set {set}: {name}, {said} {mean_in_words}, target {target}"))
        };
        groups(&own).into_iter().enumerate().map(set).collect()
    };
    points(groups(responses).into_iter().map(panel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_script_cannot_leave_it() {
        let text = in_script(&json!({ "name": "</script><!--<img>&\u{2028}" }));
        assert!(!text.contains(['<', '>', '&', '\u{2028}']), "{text}");
        let back: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back["name"], "</script><!--<img>&\u{2028}");
    }

    #[test]
    fn a_field_is_thinned_to_nodes_of_its_grid() {
        let axis: Vec<f64> = (0..61).map(f64::from).collect();
        let grid = || axis.iter().flat_map(|y| axis.iter().map(move |x| (*x, *y)));
        let data = Table::default()
            .reals_column("a", "GPa", "", grid().map(|p| p.0).collect())
            .reals_column("b", "", "", grid().map(|p| p.1).collect())
            .reals_column("c", "MPa", "", grid().map(|p| p.0 + 100.0 * p.1).collect());
        let value = of("surface", &data, &Context::default()).unwrap();
        assert_eq!((&value["x"]["count"], &value["x"]["ends"]), (&json!(21), &json!([0.0, 60.0])));
        let values = value["z"]["values"].as_array().unwrap();
        assert_eq!(
            (values.len(), &values[1], &values[21], &values[440]),
            (441, &json!(3.0), &json!(300.0), &json!(6060.0))
        );
        assert_eq!(of("surface", &Table::default(), &Context::default()), None);
    }

    #[test]
    fn bars_and_verified_sets_say_what_they_are() {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        let bars = Table::default()
            .texts_column("factor", "", words(&["$E_c$ · $\\mu$", "nu"]))
            .reals_column("value", "%", "", vec![31.25, 2.0])
            .reals_column("published", "%", "", vec![f64::NAN, 3.0]);
        let value = of("pareto", &bars, &Context::default()).unwrap();
        assert_eq!(value["panels"][0]["words"], json!(["E_c · μ: 31.25 %", "ν: 2.000 %, published 3.000 %"]));
        assert_eq!((&value["panels"][0]["y"], &value["cells"]), (&json!([0.0, 1.0]), &json!(true)));
        let runs = Table::default()
            .texts_column("response", "", words(&["E", "E", "E", "nu"]))
            .texts_column("unit", "", words(&["GPa", "GPa", "GPa", ""]))
            .texts_column("set", "", words(&["1", "1", "2", "1"]))
            .reals_column("target", "", "", vec![30.0, 30.0, 20.0, 0.2])
            .reals_column("value", "", "", vec![29.0, 30.0, 21.0, 0.21]);
        let value = of("verification", &runs, &Context::default()).unwrap();
        assert_eq!((&value["panels"][0]["x"], &value["panels"][0]["y"]), (&json!([0.0, 1.0]), &json!([29.5, 21.0])));
        assert_eq!(value["panels"][0]["words"][0], json!("set 1: E, mean of 2 runs 29.50 GPa, target 30.00 GPa"));
        assert_eq!(value["panels"][0]["words"][1], json!("set 2: E, the only run gives 21.00 GPa, target 20.00 GPa"));
        assert_eq!(value["panels"][1]["words"], json!(["set 1: ν, the only run gives 0.2100, target 0.2000"]));
    }

    #[test]
    fn curves_have_their_own_cracks() {
        let data = Table::default()
            .ints_column("curve", "", vec![1, 1, 2, 2])
            .reals_column("axial_strain", "", "", vec![0.0, 0.001, 0.0, f64::NAN])
            .reals_column("axial_stress", "MPa", "", vec![0.0, 10.0, 0.0, 20.0])
            .reals_column("tension", "", "", vec![0.0, 1.0, f64::NAN, f64::NAN]);
        let value = of("stress-strain", &data, &Context::default()).unwrap();
        assert_eq!(value["curves"].as_array().unwrap().len(), 2);
        assert_eq!(value["curves"][0]["cracks"][0], json!({ "name": "tension", "values": [0.0, 1.0] }));
        assert_eq!(value["curves"][1]["strain"], json!([0.0, null]));
        assert_eq!((&value["curves"][0]["strain"][1], &value["curves"][1]["cracks"]), (&json!(0.1), &json!([])));
    }
}
