//! Rows that share their values in some columns, and pivot tables over two columns.

use std::cmp::Ordering;

/// Rows with equal values in the columns that a table is grouped by.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouped {
    /// The value in each of these columns.
    pub key: Vec<f64>,
    /// Row numbers from 0, ascending.
    pub rows: Vec<usize>,
}

/// The groups of a table by equal values of `columns` (all of one length), in ascending order of the first column, then of
/// the second and so on. Rows in which one of them is no number belong to no group.
pub fn groups(columns: &[&[f64]]) -> Vec<Grouped> {
    let key = |row: usize| columns.iter().map(|c| c[row] + 0.0).collect::<Vec<f64>>();
    let count = columns.first().map_or(0, |c| c.len());
    let mut keyed: Vec<(Vec<f64>, usize)> = (0..count).map(|row| (key(row), row)).collect();
    keyed.retain(|(key, _)| key.iter().all(|v| !v.is_nan()));
    keyed.sort_by(|a, b| compare(&a.0, &b.0).then(a.1.cmp(&b.1)));
    let same = |a: &(Vec<f64>, usize), b: &(Vec<f64>, usize)| a.0 == b.0;
    let group = |rows: &[(Vec<f64>, usize)]| Grouped {
        key: rows[0].0.clone(),
        rows: rows.iter().map(|(_, row)| *row).collect(),
    };
    keyed.chunk_by(same).map(group).collect()
}

fn compare(a: &[f64], b: &[f64]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
}

/// What a pivot table shows of the values that meet in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// How many there are.
    pub n: usize,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation; `None` with fewer than two.
    pub deviation: Option<f64>,
}

/// Values over two columns: one row per value of the first, one column per value of the second.
#[derive(Clone, Debug, PartialEq)]
pub struct Pivot {
    /// Values of the first column, ascending.
    pub rows: Vec<f64>,
    /// Values of the second column, ascending.
    pub columns: Vec<f64>,
    /// Row by row; `None` where no value was seen.
    pub cells: Vec<Option<Cell>>,
}

/// The pivot table of `values` (NaN is missing) over the columns `down` and `across`.
pub fn pivot(down: &[f64], across: &[f64], values: &[f64]) -> Pivot {
    let distinct = |column: &[f64]| groups(&[column]).into_iter().map(|g| g.key[0]).collect::<Vec<f64>>();
    let (rows, columns) = (distinct(down), distinct(across));
    let mut cells = vec![None; rows.len() * columns.len()];
    for group in groups(&[down, across]) {
        let index = |known: &[f64], value: f64| known.iter().position(|k| *k == value);
        let (Some(row), Some(column)) = (index(&rows, group.key[0]), index(&columns, group.key[1])) else { continue };
        let seen: Vec<f64> = group.rows.iter().map(|&i| values[i]).filter(|v| !v.is_nan()).collect();
        cells[row * columns.len() + column] = cell(&seen);
    }
    Pivot { rows, columns, cells }
}

fn cell(values: &[f64]) -> Option<Cell> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    let deviation = (n > 1).then(|| (squares / (n - 1) as f64).sqrt());
    (n > 0).then_some(Cell { n, mean, deviation })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_equal_values_in_ascending_order() {
        let (a, b) = ([2.0, 1.0, 2.0, 1.0, f64::NAN], [5.0, 5.0, 4.0, 5.0, 5.0]);
        let found: Vec<_> = groups(&[&a, &b]).into_iter().map(|g| (g.key, g.rows)).collect();
        assert_eq!(found, [(vec![1.0, 5.0], vec![1, 3]), (vec![2.0, 4.0], vec![2]), (vec![2.0, 5.0], vec![0])]);
        // −0 and 0 are one value
        assert_eq!(groups(&[&[0.0, -0.0]]).len(), 1);
    }

    #[test]
    fn a_pivot_table_has_means_deviations_and_gaps() {
        let (down, across) = ([1.0, 1.0, 2.0, 1.0], [10.0, 10.0, 20.0, 20.0]);
        let found = pivot(&down, &across, &[3.0, 5.0, 7.0, f64::NAN]);
        assert_eq!((found.rows, found.columns), (vec![1.0, 2.0], vec![10.0, 20.0]));
        let both = Cell { n: 2, mean: 4.0, deviation: Some(2.0_f64.sqrt()) };
        assert_eq!(found.cells, [Some(both), None, None, Some(Cell { n: 1, mean: 7.0, deviation: None })]);
    }
}
