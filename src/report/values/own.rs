//! Values of the figures that draw any table: points, curves, histograms, boxes.

use super::{Point, points, quantity, texts};
use crate::artifact::{Column, Table};
use crate::report::symbol;
use crate::stage::Context;
use figure::axis::significant;
use serde_json::Value;

/// Most points of a curve that are told; more are thinned evenly.
const ALONG: usize = 200;

/// Points and curves: the columns `series`, `kind`, the two quantities, and the ends of an error bar or a band.
pub(super) fn series(data: &Table, context: &Context) -> Option<Value> {
    let [_, _, x, y, ..] = data.columns.as_slice() else { return None };
    let (names, kinds) = (texts(data, "series")?, texts(data, "kind")?);
    let (xs, ys) = (data.shown(&x.name).ok()?.0, data.shown(&y.name).ok()?.0);
    let (low, high) = (data.shown("low").ok()?.0, data.shown("high").ok()?.0);
    let of = |column: &Column, value: f64| format!("{} = {}", name_of(context, column), quantity(value, &column.unit));
    let words = |i: usize| {
        let series =
            [names[i].as_str(), kinds[i].as_str()].into_iter().filter(|word| !word.is_empty() && *word != "point");
        let ends = (low[i].is_finite() && high[i].is_finite())
            .then(|| format!(" ({} to {})", significant(low[i], 4), significant(high[i], 4)));
        let both = [of(x, xs[i]), of(y, ys[i]) + &ends.unwrap_or_default()];
        series.map(str::to_owned).chain(both).collect::<Vec<_>>().join(", ")
    };
    let all: Vec<usize> = (0..xs.len()).collect();
    let runs = all.chunk_by(|&a, &b| names[a] == names[b] && kinds[a] == kinds[b] && is_line(&kinds[a]));
    let shown = runs.flat_map(|run| run.iter().copied().step_by(run.len().div_ceil(ALONG)));
    points(vec![shown.map(|i| (xs[i], ys[i], words(i))).collect::<Vec<Point>>()])
}

/// Whether rows of this kind follow one line, so that some of them may stand for all.
fn is_line(kind: &str) -> bool {
    matches!(kind, "curve" | "line" | "measured")
}

fn name_of(context: &Context, column: &Column) -> String {
    let key = column.name.strip_prefix("x_").or_else(|| column.name.strip_prefix("y_")).unwrap_or(&column.name);
    symbol::raw(context, key).map_or_else(|| key.replace('_', " "), |_| super::name_of(context, key))
}

/// Bins: the columns `…_from`, `…_to` and `count`.
pub(super) fn bins(data: &Table, context: &Context) -> Option<Value> {
    let [from, to, _] = data.columns.as_slice() else { return None };
    let (starts, ends) = (data.shown(&from.name).ok()?.0, data.shown(&to.name).ok()?.0);
    let counts = data.ints("count").ok()?;
    let key = from.name.strip_suffix("_from").unwrap_or(&from.name);
    let words = |i: usize| {
        let runs = if counts[i] == 1 { "run" } else { "runs" };
        let ends = format!("{} to {}", significant(starts[i], 4), quantity(ends[i], &from.unit));
        format!("{} {ends}: {} {runs}", super::name_of(context, key), counts[i])
    };
    let bin = |i: usize| ((starts[i] + ends[i]) / 2.0, counts[i] as f64, words(i));
    points(vec![(0..counts.len()).map(bin).collect()])
}

/// Groups side by side: their five numbers.
pub(super) fn boxes(data: &Table) -> Option<Value> {
    let (groups, counts) = (texts(data, "group")?, data.ints("n").ok()?);
    let number = |name: &str| Some(data.shown(name).ok()?.0);
    let unit = &data.column("median")?.unit;
    let (median, mean) = (number("median")?, number("mean")?);
    let (low, first, third, high) =
        (number("low")?, number("first_quartile")?, number("third_quartile")?, number("high")?);
    let words = |i: usize| {
        let name = if groups[i].is_empty() { String::new() } else { format!("{}: ", groups[i]) };
        let short = |v: f64| significant(v, 4);
        format!(
            "{name}{} values, median {}, mean {}, quartiles {} and {}, whiskers {} and {}",
            counts[i],
            quantity(median[i], unit),
            short(mean[i]),
            short(first[i]),
            short(third[i]),
            short(low[i]),
            short(high[i])
        )
    };
    points(vec![(0..counts.len()).map(|i| (i as f64, median[i], words(i))).collect()])
}

/// The cells of a matrix: the heads of row and column, the value, and the scatter where cells hold several rows.
pub(super) fn cells(data: &Table, context: &Context) -> Option<Value> {
    let [down, across, value, ..] = data.columns.as_slice() else { return None };
    let (rows, columns) = (heads(data, down)?, heads(data, across)?);
    let values = data.shown(&value.name).ok()?.0;
    let scatter = data.column("scatter").and_then(|column| Some(data.shown(&column.name).ok()?.0));
    // Cells go along a row first; the first row stands at the top.
    let width = rows.iter().take_while(|head| Some(*head) == rows.first()).count();
    let height = rows.len().checked_div(width)?;
    let head = |column: &Column, text: &str| {
        format!("{} = {text} {}", super::name_of(context, &column.name), column.unit).trim_end().to_owned()
    };
    let words = |i: usize| {
        let own = match values[i].is_finite() {
            true => format!("{} = {}", super::name_of(context, &value.name), quantity(values[i], &value.unit)),
            false => "no value".to_owned(),
        };
        let scatter = scatter.as_ref().map(|all| all[i]).filter(|s| s.is_finite());
        let scatter = scatter.map_or_else(String::new, |s| format!(" ± {}", significant(s, 2)));
        format!("{}, {}: {own}{scatter}", head(down, &rows[i]), head(across, &columns[i]))
    };
    let cell = |i: usize| ((i % width) as f64, (height - 1 - i / width) as f64, words(i));
    let mut found = points(vec![(0..rows.len()).map(cell).collect()])?;
    found["cells"] = true.into();
    Some(found)
}

/// The heads in a column, which are numbers or words.
fn heads(data: &Table, column: &Column) -> Option<Vec<String>> {
    match texts(data, &column.name) {
        Some(words) => Some(words.to_vec()),
        None => Some(data.shown(&column.name).ok()?.0.into_iter().map(|v| quantity(v, "")).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_point_names_its_group_and_its_error_bar() {
        let word = |word: &str| vec![word.to_owned(), word.to_owned()];
        let data = Table::default()
            .texts_column("series", "", word("dry"))
            .texts_column("kind", "", vec!["point".to_owned(), "line".to_owned()])
            .reals_column("age", "d", "", vec![7.0, 28.0])
            .reals_column("y_UCS", "MPa", "", vec![20.0, 30.0])
            .reals_column("low", "MPa", "", vec![18.0, f64::NAN])
            .reals_column("high", "MPa", "", vec![22.0, f64::NAN]);
        let found = series(&data, &Context::default()).unwrap();
        let words = &found["panels"][0]["words"];
        assert_eq!(words[0], "dry, age = 7.000 d, σ_u = 20.00 MPa (18.00 to 22.00)");
        assert_eq!(words[1], "dry, line, age = 28.00 d, σ_u = 30.00 MPa");
    }

    #[test]
    fn a_long_curve_is_thinned_and_points_are_not() {
        let rows = 1000;
        let data = |kind: &str| {
            Table::default()
                .texts_column("series", "", vec![String::new(); rows])
                .texts_column("kind", "", vec![kind.to_owned(); rows])
                .reals_column("x", "", "", (0..rows).map(|i| i as f64).collect())
                .reals_column("y", "", "", vec![1.0; rows])
                .reals_column("low", "", "", vec![f64::NAN; rows])
                .reals_column("high", "", "", vec![f64::NAN; rows])
        };
        let count = |kind: &str| {
            let value = series(&data(kind), &Context::default()).unwrap();
            value["panels"][0]["x"].as_array().unwrap().len()
        };
        assert_eq!([count("curve"), count("point")], [200, 1000]);
    }

    #[test]
    fn a_cell_names_its_row_and_its_column() {
        let words = |words: [&str; 4]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<String>>();
        let data = Table::default()
            .texts_column("rock", "", words(["granite", "granite", "gneiss", "gneiss"]))
            .reals_column("depth", "m", "", vec![10.0, 20.0, 10.0, 20.0])
            .reals_column("q", "MPa", "", vec![82.0, 121.0, f64::NAN, 98.0])
            .reals_column("scatter", "MPa", "", vec![1.5, f64::NAN, f64::NAN, 3.0]);
        let found = cells(&data, &Context::default()).unwrap();
        let panel = &found["panels"][0];
        // The first row is the upper one; a cell without a value is named as well.
        assert_eq!((&panel["x"], &panel["y"]), (&json!([0.0, 1.0, 0.0, 1.0]), &json!([1.0, 1.0, 0.0, 0.0])));
        assert_eq!(panel["words"][0], "rock = granite, depth = 10.00 m: q = 82.00 MPa ± 1.5");
        assert_eq!(panel["words"][2], "rock = gneiss, depth = 10.00 m: no value");
        assert_eq!(found["cells"], true);
    }

    #[test]
    fn bins_and_boxes_stand_where_they_are_drawn() {
        let data = Table::default()
            .reals_column("UCS_from", "MPa", "", vec![10.0, 20.0])
            .reals_column("UCS_to", "MPa", "", vec![20.0, 30.0])
            .ints_column("count", "", vec![1, 4]);
        let found = bins(&data, &Context::default()).unwrap();
        assert_eq!(found["panels"][0]["x"], json!([15.0, 25.0]));
        assert_eq!(found["panels"][0]["words"][1], "σ_u 20.00 to 30.00 MPa: 4 runs");
        let five = ["low", "first_quartile", "median", "third_quartile", "high", "mean"];
        let data = Table::default().texts_column("group", "", vec!["a".to_owned()]).ints_column("n", "", vec![5]);
        let data = five.iter().zip(1..).fold(data, |t, (name, v)| t.reals_column(name, "MPa", "", vec![f64::from(v)]));
        let found = boxes(&data).unwrap();
        assert_eq!((&found["panels"][0]["x"], &found["panels"][0]["y"]), (&json!([0.0]), &json!([3.0])));
    }
}
