//! An orthogonal array as columns of level indices.

/// One column: `levels` levels, and the level (from 0) in each run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) levels: usize,
    pub(super) cells: Vec<usize>,
}

/// Columns of equal length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Array {
    pub(super) columns: Vec<Column>,
}

impl Array {
    /// From one function: the level of column `c` in run `r`.
    pub(super) fn from_fn(runs: usize, levels: &[usize], cell: impl Fn(usize, usize) -> usize) -> Self {
        let column = |(c, &levels): (usize, &usize)| Column { levels, cells: (0..runs).map(|r| cell(r, c)).collect() };
        Self { columns: levels.iter().enumerate().map(column).collect() }
    }

    /// Replaces column `at`, of s levels, by the columns of an array of s runs (expansive replacement, Hedayat, Sloane
    /// & Stufken 1999): level i becomes row i. Strength two is preserved.
    pub(super) fn replace(&mut self, at: usize, rows: &Self) {
        let old = self.columns.remove(at);
        let expand = |new: &Column| Column {
            levels: new.levels,
            cells: old.cells.iter().map(|&level| new.cells[level]).collect(),
        };
        self.columns.splice(at..at, rows.columns.iter().map(expand));
    }
}

/// How much three columns of a strength-two array are entangled: s₁s₂s₃ Σn² / N² − 1 over the counts n of their level
/// combinations. It is their share of A₃ in the generalized word-length pattern (Xu & Wu 2001,
/// doi:10.1214/aos/1013699993): 0 when the three are a full factorial, 1 per degree of freedom that a main effect
/// shares with the interaction of the other two.
pub(super) fn entanglement(a: &Column, b: &Column, c: &Column) -> f64 {
    let mut counts = vec![0_u32; a.levels * b.levels * c.levels];
    for ((x, y), z) in a.cells.iter().zip(&b.cells).zip(&c.cells) {
        counts[(x * b.levels + y) * c.levels + z] += 1;
    }
    let squares: f64 = counts.iter().map(|&n| f64::from(n) * f64::from(n)).sum();
    let runs = a.cells.len() as f64;
    squares * counts.len() as f64 / (runs * runs) - 1.0
}
