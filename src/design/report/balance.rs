//! How often levels occur, alone and together.

use crate::table::{DesignTable, PointType};

/// How often each value of a factor occurs.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorBalance {
    /// The factor.
    pub factor: String,
    /// Each natural value, ascending, and its number of runs.
    pub counts: Vec<(f64, usize)>,
}

/// Balance and orthogonality of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// Values and their numbers of runs.
    pub factors: Vec<FactorBalance>,
    /// Largest absolute correlation of two coded columns; 0 for a single factor.
    pub largest_correlation: f64,
    /// The pair that has it.
    pub worst: Option<(String, String)>,
    /// Number of pairs of factors without proportional frequencies, centre points left aside; none for a sample, where
    /// every value is its own level.
    pub disproportional_pairs: Option<usize>,
    /// The first such pair.
    pub disproportional: Option<(String, String)>,
    /// Any so many factors together show all combinations of their levels equally often, centre points left aside; none
    /// for a sample and where it was too much to count.
    pub strength: Option<usize>,
}

/// A factor with more values than this is no longer seen as one with levels.
pub(super) const MOST_LEVELS: usize = 32;
/// Strength is counted while it takes fewer cells than this.
const MOST_CELLS: u64 = 50_000_000;

/// The level (by ascending value) of a factor in each run, and the values.
type Levels = (Vec<usize>, Vec<f64>);

/// The levels of a factor.
pub(super) fn levels(table: &DesignTable, factor: usize) -> Levels {
    classes(table.natural.iter().map(|r| r[factor]).collect())
}

/// How many levels a factor has.
pub(super) fn level_count(table: &DesignTable, factor: usize) -> usize {
    ascending(table.natural.iter().map(|r| r[factor]).collect()).len()
}

/// The levels of a factor over the runs that are no centre points.
fn without_centre(table: &DesignTable, factor: usize) -> Levels {
    let runs = table.natural.iter().zip(&table.point_type).filter(|(_, p)| **p != PointType::Centre);
    classes(runs.map(|(r, _)| r[factor]).collect())
}

fn classes(cells: Vec<f64>) -> Levels {
    let values = ascending(cells.clone());
    let position = |x: f64| values.partition_point(|v| v.total_cmp(&x).is_lt());
    (cells.into_iter().map(position).collect(), values)
}

fn ascending(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Balance and orthogonality.
pub fn balance(table: &DesignTable) -> Balance {
    let all_runs: Vec<Levels> = (0..table.factors.len()).map(|j| levels(table, j)).collect();
    let with_centre = table.point_type.contains(&PointType::Centre);
    let apart: Option<Vec<Levels>> =
        with_centre.then(|| (0..table.factors.len()).map(|j| without_centre(table, j)).collect());
    let columns = apart.as_ref().unwrap_or(&all_runs);
    let counts = |(cells, values): &Levels| {
        let mut counts: Vec<(f64, usize)> = values.iter().map(|&v| (v, 0)).collect();
        cells.iter().for_each(|&level| counts[level].1 += 1);
        counts
    };
    let name = |j: usize| table.factors[j].name.clone();
    let of_columns: Vec<Vec<(f64, usize)>> = columns.iter().map(counts).collect();
    let (largest_correlation, worst) = correlation(table);
    let sampled = table.point_type.contains(&PointType::Sample);
    let discrete = !sampled && columns.iter().all(|(_, values)| values.len() <= MOST_LEVELS);
    let bad = discrete.then(|| disproportional(columns, &of_columns));
    let first = bad.as_ref().and_then(|b| b.first()).map(|&(a, b)| (name(a), name(b)));
    Balance {
        factors: all_runs
            .iter()
            .enumerate()
            .map(|(j, c)| FactorBalance { factor: name(j), counts: counts(c) })
            .collect(),
        largest_correlation,
        worst: worst.map(|(a, b)| (name(a), name(b))),
        disproportional_pairs: bad.map(|b| b.len()),
        disproportional: first,
        strength: discrete.then(|| strength(columns)).flatten(),
    }
}

/// Largest absolute correlation of two coded columns, and the pair.
fn correlation(table: &DesignTable) -> (f64, Option<(usize, usize)>) {
    let n = table.runs() as f64;
    let unit = |j: usize| {
        let mean = table.coded.iter().map(|r| r[j]).sum::<f64>() / n;
        let centred: Vec<f64> = table.coded.iter().map(|r| r[j] - mean).collect();
        let length = centred.iter().map(|x| x * x).sum::<f64>().sqrt();
        centred.into_iter().map(|x| if length > 0.0 { x / length } else { 0.0 }).collect::<Vec<f64>>()
    };
    let several = table.factors.len() > 1;
    let columns: Vec<Vec<f64>> = (0..table.factors.len()).filter(|_| several).map(unit).collect();
    let mut worst = (0.0, None);
    for b in 1..columns.len() {
        for a in 0..b {
            let r: f64 = columns[a].iter().zip(&columns[b]).map(|(x, y)| x * y).sum();
            // below this it is the rounding of the sum
            if r.abs() > worst.0 && r.abs() > 1e-14 {
                worst = (r.abs(), Some((a, b)));
            }
        }
    }
    worst
}

/// Pairs of factors for which some n_ab N differs from n_a n_b.
fn disproportional(columns: &[Levels], counts: &[Vec<(f64, usize)>]) -> Vec<(usize, usize)> {
    let runs = columns.first().map_or(0, |c| c.0.len());
    let proportional = |a: usize, b: usize| {
        let wide = counts[b].len();
        let mut together = vec![0_usize; counts[a].len() * wide];
        columns[a].0.iter().zip(&columns[b].0).for_each(|(x, y)| together[x * wide + y] += 1);
        together.iter().enumerate().all(|(i, n)| n * runs == counts[a][i / wide].1 * counts[b][i % wide].1)
    };
    let pairs = (1..columns.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    pairs.filter(|&(a, b)| !proportional(a, b)).collect()
}

/// Largest t such that every t factors are a full factorial, equally often. Stops where it would take too long.
fn strength(columns: &[Levels]) -> Option<usize> {
    let runs = columns.first().map_or(0, |c| c.0.len());
    let mut work = runs as u64;
    for t in 1..=columns.len() {
        work = work.saturating_mul((columns.len() + 1 - t) as u64) / t as u64;
        if work > MOST_CELLS {
            return (t > 2).then_some(t - 1);
        }
        if !each_choice(columns.len(), t, &mut |chosen| is_factorial(columns, chosen, runs)) {
            return Some(t - 1);
        }
    }
    Some(columns.len())
}

fn is_factorial(columns: &[Levels], chosen: &[usize], runs: usize) -> bool {
    let cells = chosen.iter().fold(1_usize, |cells, &c| cells.saturating_mul(columns[c].1.len()));
    if cells == 0 || !runs.is_multiple_of(cells) {
        return false;
    }
    let mut counts = vec![0; cells];
    for r in 0..runs {
        counts[chosen.iter().fold(0, |cell, &c| cell * columns[c].1.len() + columns[c].0[r])] += 1;
    }
    counts.iter().all(|&n| n * cells == runs)
}

/// Whether `test` holds for every choice of `size` among `n`.
fn each_choice(n: usize, size: usize, test: &mut impl FnMut(&[usize]) -> bool) -> bool {
    let mut chosen: Vec<usize> = (0..size).collect();
    loop {
        if !test(&chosen) {
            return false;
        }
        let Some(i) = (0..size).rev().find(|&i| chosen[i] < n - size + i) else { return true };
        chosen[i] += 1;
        for j in i + 1..size {
            chosen[j] = chosen[j - 1] + 1;
        }
    }
}
