//! Marching squares: the region where a gridded field reaches a level, and the lines around it.
//!
//! The grid is treated as surrounded by a ring of minus infinity, so every outline closes. A region is drawn by
//! filling its outlines even–odd; regions of rising levels drawn over one another leave no seams. Between two
//! nodes the field is linear; a saddle is joined when the mean of its four corners reaches the level.
//! Lorensen and Cline (1987), doi:10.1145/37402.37422, in the plane.

use std::collections::BTreeMap;

/// A field on a rectangular grid, in steps of the grid: node (i, j) holds `values[j * columns + i]`.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Nodes in a row.
    pub columns: usize,
    /// Values, row by row. NaN counts as below every level.
    pub values: &'a [f64],
}

/// A corner of an outline: position in grid steps, and whether it lies on the rim of the grid only because the
/// outline closes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Column and row, with fractions.
    pub at: [f64; 2],
    /// The corner follows the rim, not the level.
    pub rim: bool,
}

/// Edge from node (i, j) of the padded grid: `false` along the row, `true` along the column.
type Edge = (usize, usize, bool);

impl Field<'_> {
    fn rows(&self) -> usize {
        self.values.len().checked_div(self.columns).unwrap_or(0)
    }

    /// Value in the padded grid.
    fn padded(&self, i: usize, j: usize) -> f64 {
        if i == 0 || j == 0 || i > self.columns || j > self.rows() {
            return f64::NEG_INFINITY;
        }
        let v = self.values[(j - 1) * self.columns + i - 1];
        if v.is_nan() { f64::NEG_INFINITY } else { v }
    }

    /// Closed outlines of the region where the field is at least `level`.
    pub fn region(&self, level: f64) -> Vec<Vec<Corner>> {
        let mut next: BTreeMap<Edge, Edge> = BTreeMap::new();
        for j in 0..=self.rows() {
            for i in 0..=self.columns {
                self.cell(i, j, level, &mut next);
            }
        }
        let mut loops = Vec::new();
        while let Some((&start, _)) = next.iter().next() {
            let mut outline = Vec::new();
            let mut edge = start;
            while let Some(to) = next.remove(&edge) {
                outline.push(self.crossing(edge, level));
                edge = to;
            }
            loops.push(outline);
        }
        loops
    }

    /// Lines where the field equals `level`, inside the grid. Closed lines repeat their first point.
    pub fn lines(&self, level: f64) -> Vec<Vec<[f64; 2]>> {
        let mut lines = Vec::new();
        for outline in self.region(level) {
            let Some(first) = outline.iter().position(|c| c.rim) else {
                let mut line: Vec<_> = outline.iter().map(|c| c.at).collect();
                line.extend(outline.first().map(|c| c.at));
                lines.push(line);
                continue;
            };
            let mut part = Vec::new();
            for k in 0..=outline.len() {
                let corner = outline[(first + k) % outline.len()];
                if !corner.rim {
                    part.push(corner.at);
                } else if part.len() > 1 {
                    lines.push(std::mem::take(&mut part));
                } else {
                    part.clear();
                }
            }
        }
        lines
    }

    /// Adds the directed pieces of one cell, the region on their left.
    fn cell(&self, i: usize, j: usize, level: f64, next: &mut BTreeMap<Edge, Edge>) {
        let corners = [self.padded(i, j), self.padded(i + 1, j), self.padded(i + 1, j + 1), self.padded(i, j + 1)];
        let inside = corners.map(|v| v >= level);
        let case = inside.iter().enumerate().fold(0, |sum, (bit, &is)| sum | usize::from(is) << bit);
        let [b, r, t, l]: [Edge; 4] = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
        let joined = corners.iter().sum::<f64>() / 4.0 >= level;
        let pieces: &[(Edge, Edge)] = match case {
            1 => &[(b, l)],
            2 => &[(r, b)],
            3 => &[(r, l)],
            4 => &[(t, r)],
            5 if joined => &[(b, r), (t, l)],
            5 => &[(b, l), (t, r)],
            6 => &[(t, b)],
            7 => &[(t, l)],
            8 => &[(l, t)],
            9 => &[(b, t)],
            10 if joined => &[(l, b), (r, t)],
            10 => &[(r, b), (l, t)],
            11 => &[(r, t)],
            12 => &[(l, r)],
            13 => &[(b, r)],
            14 => &[(l, b)],
            _ => &[],
        };
        next.extend(pieces.iter().copied());
    }

    /// Where an edge crosses the level.
    fn crossing(&self, (i, j, upright): Edge, level: f64) -> Corner {
        let (p, q) = (self.padded(i, j), if upright { self.padded(i, j + 1) } else { self.padded(i + 1, j) });
        let (t, rim) = match (p.is_finite(), q.is_finite()) {
            (true, true) => ((level - p) / (q - p), false),
            (true, false) => (0.0, true),
            _ => (1.0, true),
        };
        let (x, y) = (i as f64 - 1.0, j as f64 - 1.0);
        let at = if upright { [x, y + t] } else { [x + t, y] };
        Corner { at, rim }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[Corner]) -> f64 {
        let n = outline.len();
        let cross = |k: usize| {
            let ([x0, y0], [x1, y1]) = (outline[k].at, outline[(k + 1) % n].at);
            x0 * y1 - x1 * y0
        };
        (0..n).map(cross).sum::<f64>() / 2.0
    }

    #[test]
    fn a_plane_is_cut_along_a_straight_line() {
        let values: Vec<f64> = (0..12).map(|k| (k % 4) as f64).collect();
        let field = Field { columns: 4, values: &values };
        let region = field.region(1.25);
        assert_eq!(region.len(), 1);
        assert!((area(&region[0]) - 1.75 * 2.0).abs() < 1e-12);
        let lines = field.lines(1.25);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|p| p[0] == 1.25) && lines[0].len() == 3);
        assert_eq!(field.region(-1.0).len(), 1);
        assert!((area(&field.region(-1.0)[0]) - 6.0).abs() < 1e-12);
        assert!(field.region(3.5).is_empty() && field.lines(-1.0).is_empty());
    }

    #[test]
    fn a_cone_gives_circles() {
        let n = 81;
        let r = |k: usize| {
            let (x, y) = ((k % n) as f64 - 40.0, (k / n) as f64 - 40.0);
            -(x * x + y * y).sqrt()
        };
        let values: Vec<f64> = (0..n * n).map(r).collect();
        let field = Field { columns: n, values: &values };
        let region = field.region(-25.0);
        let circle = std::f64::consts::PI * 625.0;
        assert!((area(&region[0]) / circle - 1.0).abs() < 1e-3, "{}", area(&region[0]) / circle);
        let negative: Vec<f64> = values.iter().map(|v| -v).collect();
        let ring = Field { columns: n, values: &negative }.region(25.0);
        let sum: f64 = ring.iter().map(|l| area(l)).sum();
        assert!((sum / (6400.0 - circle) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn saddles_join_by_their_mean() {
        let high = Field { columns: 2, values: &[1.0, 0.2, 0.2, 1.0] };
        assert_eq!(high.region(0.5).len(), 1);
        assert_eq!(high.region(0.7).len(), 2);
    }
}
