//! Rows that a plot of columns cannot draw; a footnote states them, so that no row is missing silently.

use super::own::{Drawn, Shown, fitted};
use super::plot::Direction;
use super::source::Sources;
use super::{Params, Show};
use crate::artifact::results::Results;
use crate::stage::StageError;
use figure::text::plain_text;

/// Sentences, as labels, on rows without a number, values that a logarithmic axis cannot show, and groups without the requested
/// line. Other footnotes state runs without a result and runs that are not valid.
pub(super) fn sentences(params: &Params, sources: &Sources) -> Result<Vec<String>, StageError> {
    let [keys, _] = params.show.needs().keys;
    if keys.is_empty() {
        return Ok(Vec::new());
    }
    let drawn = Drawn::of(params, sources)?;
    let columns = keys.iter().map(|key| drawn.column(key)).collect::<Result<Vec<_>, _>>()?;
    let failures = Results::failures(drawn.table);
    let failed = |at: usize| failures.get(drawn.rows[at]).is_some_and(|why| !why.is_empty());
    let numbers = |at: &usize| columns.iter().all(|column| column.values[*at].is_finite());
    let all: Vec<usize> = (0..drawn.rows.len()).filter(|at| !failed(*at)).collect();
    let (whole, lost): (Vec<usize>, Vec<usize>) = all.iter().copied().partition(numbers);
    let mut found = Vec::new();
    if !lost.is_empty() {
        let names: Vec<String> = columns.iter().map(|column| column.quantity.sign()).collect();
        let have = if lost.len() == 1 { "has" } else { "have" };
        let (lost, all) = (lost.len(), all.len());
        found.push(format!("{lost} of {all} rows {have} no number in {}", names.join(" or ")));
    }
    for (column, direction) in columns.iter().zip([Direction::X, Direction::Y]) {
        let direction = if params.show == Show::Box { Direction::Y } else { direction };
        let off = whole.iter().filter(|at| column.values[**at] <= 0.0).count();
        if drawn.plot.log.contains(&direction) && off > 0 {
            let (is, all) = (if off == 1 { "is" } else { "are" }, whole.len());
            let name = column.quantity.sign();
            found.push(format!("{off} of {all} values of {name} {is} not above zero and not on the logarithmic axis"));
        }
        if let Some([low, high]) = drawn.plot.limits(direction).filter(|_| params.show != Show::HeatMap) {
            let outside = whole.iter().filter(|at| !(low..=high).contains(&column.values[**at])).count();
            let (lie, all) = (if outside == 1 { "lies" } else { "lie" }, whole.len());
            if outside > 0 {
                found
                    .push(format!("{outside} of {all} values of {} {lie} outside of the axis", column.quantity.sign()));
            }
        }
    }
    if let (Show::Xy, [x, y]) = (params.show, &columns[..]) {
        found.extend(lines(&drawn, x, y, &whole)?);
    }
    Ok(found)
}

/// Groups whose points do not determine a line.
fn lines(drawn: &Drawn, x: &Shown, y: &Shown, rows: &[usize]) -> Result<Vec<String>, StageError> {
    let Some(fit) = drawn.plot.fit else { return Ok(Vec::new()) };
    let by = drawn.by()?;
    let keys: Vec<Option<f64>> = by.as_ref().map_or(vec![None], |by| by.distinct().into_iter().map(Some).collect());
    let mut found = Vec::new();
    for key in keys {
        let mine = |at: &&usize| key.is_none_or(|key| by.as_ref().is_some_and(|by| by.values[**at] == key));
        let pick = |column: &Shown| rows.iter().filter(mine).map(|at| column.values[*at]).collect::<Vec<f64>>();
        let (x, y) = (pick(x), pick(y));
        if x.is_empty() || fitted(drawn.plot, fit, &x, &y).is_some() {
            continue;
        }
        let whose = match (key, &by) {
            (Some(key), Some(by)) => format!(" of {} = {}", by.quantity.sign(), plain_text(&by.text(key))),
            _ => String::new(),
        };
        found.push(format!("the {} points{whose} support no line: too few, or all at one place", x.len()));
    }
    Ok(found)
}
