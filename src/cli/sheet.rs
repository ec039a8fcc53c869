//! A table as text for people: aligned columns, in parts where the terminal is narrower than they are.

use super::output::{steers, width};
use crate::artifact::{Column, Table, Values};
use crate::export::{cells, head};
use math::elementary::log10;

/// Numbers for a reader: seven digits, small and large ones with an exponent.
fn short(values: &Values) -> Vec<String> {
    let one = |v: &f64| match v.abs() {
        _ if v.is_nan() => String::new(),
        0.0 => "0".to_owned(),
        size if !(1e-4..1e7).contains(&size) => format!("{v:.5e}"),
        size => {
            let decimals = (6 - log10(size).floor() as i32).max(0) as usize;
            let text = format!("{v:.decimals$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
    };
    match values {
        Values::Reals(values) => values.iter().map(one).collect(),
        Values::Ints(_) | Values::Texts(_) => cells(values),
    }
}

/// Most rows of a table that are shown; `--csv` and `--json` give all.
const MOST_ROWS: usize = 100;

/// Most columns shown at once.
const MOST_COLUMNS: usize = 200;

/// A cell: what would steer the terminal, which a log or a file may hold, is shown as a sign.
fn in_cell(cell: &str) -> String {
    cell.chars().map(|c| if steers(c) { '\u{fffd}' } else { c }).collect()
}

/// A column as it is shown: its lines, the head first, all of one width.
fn lines_of(column: &Column) -> Vec<String> {
    let cells = short(&column.values).into_iter().take(MOST_ROWS).map(|cell| in_cell(&cell));
    let cells: Vec<String> = std::iter::once(in_cell(&head(column))).chain(cells).collect();
    let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
    match &column.values {
        Values::Reals(_) | Values::Ints(_) => cells.iter().map(|cell| format!("{cell:>width$}")).collect(),
        Values::Texts(_) => cells.iter().map(|cell| format!("{cell:width$}")).collect(),
    }
}

/// Columns that number rows.
const COUNTED: [&str; 5] = ["row", "run", "set", "replicate", "evaluation"];

/// Most columns that begin every part.
const MOST_LEADING: usize = 2;

/// Blanks between two columns.
const GAP: usize = 2;

/// Columns that stand together, as many as fit `width`; the leading ones, which say what a row is, begin every part.
fn parts_of(columns: &[Vec<String>], leading: usize, width: Option<usize>) -> Vec<Vec<usize>> {
    // A blank stands before the first column.
    let width = width.map(|width| width.saturating_sub(1));
    let wide = |column: usize| columns[column].first().map_or(0, |head| head.chars().count()) + GAP;
    let first: Vec<usize> = (0..leading.min(columns.len())).collect();
    let start: usize = first.iter().map(|&column| wide(column)).sum();
    let mut parts = vec![(first.clone(), start)];
    for column in first.len()..columns.len() {
        let Some((part, used)) = parts.last_mut() else { break };
        let full = width.is_some_and(|width| *used + wide(column) > width + GAP);
        if full && part.len() > first.len() {
            parts.push(([first.as_slice(), &[column]].concat(), start + wide(column)));
        } else {
            part.push(column);
            *used += wide(column);
        }
    }
    parts.into_iter().map(|(part, _)| part).collect()
}

/// A table as text, in parts one below the other where the terminal is narrower than it.
pub(super) fn text(table: &Table) -> String {
    folded(table, width(&std::io::stdout()))
}

fn folded(table: &Table, width: Option<usize>) -> String {
    let seen = &table.columns[..table.columns.len().min(MOST_COLUMNS)];
    let columns: Vec<Vec<String>> = seen.iter().map(lines_of).collect();
    // The leading columns identify a row: texts and row numbers.
    let tells = |column: &&Column| matches!(column.values, Values::Texts(_)) || COUNTED.contains(&column.name.as_str());
    let leading = seen.iter().take_while(tells).count().min(MOST_LEADING).max(usize::from(!seen.is_empty()));
    let gap = " ".repeat(GAP);
    let part = |part: Vec<usize>| {
        let line = |row: usize| {
            let cells: Vec<&str> = part.iter().map(|&column| columns[column][row].as_str()).collect();
            format!(" {}", cells.join(&gap)).trim_end().to_owned()
        };
        (0..=table.rows().min(MOST_ROWS)).map(line).collect::<Vec<_>>().join("\n")
    };
    let shown: Vec<String> = parts_of(&columns, leading, width).into_iter().map(part).collect();
    let more = table.rows().saturating_sub(MOST_ROWS);
    let hidden = table.columns.len() - seen.len();
    let rest = match (more, hidden) {
        (0, 0) => String::new(),
        (rows, 0) => format!("\n… and {rows} more rows; --csv shows all"),
        (0, columns) => format!("\n… and {columns} more columns; --csv shows all"),
        (rows, columns) => format!("\n… and {rows} more rows and {columns} more columns; --csv shows all"),
    };
    format!("{}{rest}", shown.join("\n\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_table_is_shown_in_parts_that_begin_alike() {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        let table = Table::default()
            .texts_column("response", "", words(&["UCS", "nu"]))
            .texts_column("term", "", words(&["sigma_c", "mu"]))
            .reals_column("estimate", "MPa", "", vec![1.5, -0.25])
            .reals_column("std_error", "", "", vec![0.125, f64::NAN]);
        let whole = " response  term     estimate [MPa]  std_error\n UCS       sigma_c             1.5      0.125\n \
                     nu        mu                -0.25";
        assert_eq!(folded(&table, None), whole);
        assert_eq!(folded(&table, Some(45)), whole);
        assert_eq!(
            folded(&table, Some(44)),
            " response  term     estimate [MPa]\n UCS       sigma_c             1.5\n nu        mu                -0.25\n\n \
             response  term     std_error\n UCS       sigma_c      0.125\n nu        mu"
        );
        // Every part holds a column of its own, however narrow the terminal is.
        assert_eq!(folded(&table, Some(5)), folded(&table, Some(44)));
    }
}
