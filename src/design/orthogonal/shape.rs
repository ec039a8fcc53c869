//! Names of tables: `L18(2^1 3^7)`, `L64(4^21)`, or `L64` alone.

use std::collections::BTreeMap;

/// Number of columns by number of levels.
pub(super) type Counts = BTreeMap<usize, usize>;

/// Counts equal entries.
pub(super) fn count(levels: &[usize]) -> Counts {
    let mut counts = Counts::new();
    for &n in levels {
        *counts.entry(n).or_insert(0) += 1;
    }
    counts
}

/// The name of a table.
pub(super) fn name(runs: usize, counts: &Counts) -> String {
    let parts: Vec<String> =
        counts.iter().filter(|(_, n)| **n > 0).map(|(levels, n)| format!("{levels}^{n}")).collect();
    format!("L{runs}({})", parts.join(" "))
}

/// Runs, and the columns if it states them, of a name; `None` if it cannot be read.
pub(super) fn parse(name: &str) -> Option<(usize, Option<Counts>)> {
    let rest = name.trim().strip_prefix(['L', 'l'])?;
    let (runs, columns) = match rest.split_once('(') {
        Some((runs, columns)) => (runs, Some(columns.trim().strip_suffix(')')?)),
        None => (rest, None),
    };
    let runs = runs.trim().trim_start_matches('_').parse().ok()?;
    let Some(columns) = columns else { return Some((runs, None)) };
    let mut counts = Counts::new();
    for part in columns.split([' ', ',', '*', '×', '·']).filter(|part| !part.is_empty()) {
        let (levels, n) = part.split_once('^').unwrap_or((part, "1"));
        let (levels, n) = (levels.parse().ok().filter(|&s: &usize| (2..=64).contains(&s))?, n.parse::<usize>().ok()?);
        *counts.entry(levels).or_insert(0) += n.min(1 << 20);
    }
    Some((runs, Some(counts)))
}
