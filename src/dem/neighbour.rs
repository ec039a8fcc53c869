//! Neighbour search on a uniform grid, and the order of bodies along a space-filling curve.
//!
//! Pairs come out sorted by (i, j) with i < j, for every grid.

use std::ops::Range;

/// Gives `put` the pairs of balls whose surfaces are nearer than `margin`, in order. Balls of the same body are left out.
///
/// `positions` have three coordinates, the third 0 in the plane.
pub(crate) fn pairs(positions: &[[f64; 3]], radii: &[f64], bodies: &[u32], margin: f64, mut put: impl FnMut(u32, u32)) {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let grid = Grid::new(positions, 2.0 * largest + margin);
    // In the order of the cells, so that the search reads memory one after the other.
    let lined: Vec<([f64; 3], f64)> =
        grid.members.iter().map(|&j| (positions[j as usize], radii[j as usize])).collect();
    let mut found = Vec::new();
    for (i, x) in positions.iter().enumerate() {
        grid.visit_around(x, |members| {
            for (&j, (y, radius)) in grid.members[members.clone()].iter().zip(&lined[members]) {
                let reach = radii[i] + radius + margin;
                let [a, b, c] = [y[0] - x[0], y[1] - x[1], y[2] - x[2]];
                let near = a * a + b * b + c * c < reach * reach;
                if near && j as usize > i && bodies[i] != bodies[j as usize] {
                    found.push(j);
                }
            }
        });
        found.sort_unstable();
        found.drain(..).for_each(|j| put(i as u32, j));
    }
}

/// Balls by cell.
struct Grid {
    low: [f64; 3],
    inverse: f64,
    cells: [usize; 3],
    /// First member of each cell in `members`, one more at the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Grid {
    fn new(positions: &[[f64; 3]], reach: f64) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for x in positions {
            for k in 0..3 {
                low[k] = low[k].min(x[k]);
                high[k] = high[k].max(x[k]);
            }
        }
        // A few balls far away must not make the grid larger than the list: widen the cells instead.
        let limit = 8.0 * positions.len() as f64 + 64.0;
        let count = |edge: f64| (0..3).map(|k| ((high[k] - low[k]) / edge).floor() + 1.0).product::<f64>();
        let mut edge = reach;
        while count(edge) > limit {
            edge *= 1.5;
        }
        let cells = std::array::from_fn(|k| ((high[k] - low[k]) / edge).floor().max(0.0) as usize + 1);
        let mut grid = Self { low, inverse: 1.0 / edge, cells, starts: Vec::new(), members: vec![0; positions.len()] };
        let homes: Vec<u32> = positions.iter().map(|x| grid.index(grid.cell(x)) as u32).collect();
        grid.starts = vec![0; cells.iter().product::<usize>() + 1];
        for &home in &homes {
            grid.starts[home as usize + 1] += 1;
        }
        for k in 1..grid.starts.len() {
            grid.starts[k] += grid.starts[k - 1];
        }
        let mut next = grid.starts.clone();
        for (i, &home) in homes.iter().enumerate() {
            grid.members[next[home as usize] as usize] = i as u32;
            next[home as usize] += 1;
        }
        grid
    }

    fn cell(&self, x: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| (((x[k] - self.low[k]) * self.inverse) as usize).min(self.cells[k] - 1))
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.cells[1] + cell[1]) * self.cells[0] + cell[0]
    }

    /// Calls `visit` with stretches of `members`: those in the cell of `x` and in the cells around it.
    fn visit_around(&self, x: &[f64; 3], mut visit: impl FnMut(Range<usize>)) {
        let home = self.cell(x);
        let span = |k: usize| home[k].saturating_sub(1)..=(home[k] + 1).min(self.cells[k] - 1);
        for z in span(2) {
            for y in span(1) {
                // Cells that follow one another along x hold their members one after the other.
                let [a, b] = [*span(0).start(), *span(0).end()].map(|x| self.index([x, y, z]));
                visit(self.starts[a] as usize..self.starts[b + 1] as usize);
            }
        }
    }
}

/// Positions of `points` along a Morton curve through their bounding cube; equal codes keep their order.
pub(crate) fn morton_order(points: &[[f64; 3]], dimension: usize) -> Vec<u32> {
    let mut low = [f64::INFINITY; 3];
    let mut edge: f64 = 0.0;
    for k in 0..dimension {
        low[k] = points.iter().map(|x| x[k]).fold(f64::INFINITY, f64::min);
        edge = edge.max(points.iter().map(|x| x[k] - low[k]).fold(0.0, f64::max));
    }
    let bits = 63 / dimension;
    let scale = if edge > 0.0 { ((1_u64 << bits) - 1) as f64 / edge } else { 0.0 };
    let code = |x: &[f64; 3]| {
        let cells: [u64; 3] = std::array::from_fn(|k| if k < dimension { ((x[k] - low[k]) * scale) as u64 } else { 0 });
        (0..bits).rev().fold(0_u64, |code, bit| (0..dimension).rev().fold(code, |c, k| c << 1 | (cells[k] >> bit & 1)))
    };
    let codes: Vec<u64> = points.iter().map(code).collect();
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_by_key(|&p| codes[p as usize]);
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::random::Stream;

    #[test]
    fn the_grid_finds_what_all_pairs_find() {
        let mut stream = Stream::new(3, "grid", 0);
        let positions: Vec<[f64; 3]> = (0..300).map(|_| std::array::from_fn(|_| stream.uniform())).collect();
        let radii: Vec<f64> = (0..300).map(|_| stream.uniform_in(0.02, 0.09)).collect();
        let bodies: Vec<u32> = (0..300).map(|k| if k < 20 { 0 } else { k }).collect();
        let mut brute = Vec::new();
        for i in 0..300_usize {
            for j in i + 1..300 {
                let d = (0..3).map(|k| (positions[i][k] - positions[j][k]).powi(2)).sum::<f64>().sqrt();
                if bodies[i] != bodies[j] && d < radii[i] + radii[j] + 0.02 {
                    brute.push((i as u32, j as u32));
                }
            }
        }
        assert!(brute.len() > 300);
        let mut found = Vec::new();
        pairs(&positions, &radii, &bodies, 0.02, |i, j| found.push((i, j)));
        assert_eq!(found, brute);
    }

    #[test]
    fn the_curve_visits_quadrant_by_quadrant() {
        let points: Vec<[f64; 3]> = (0..16).map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0]).collect();
        let order = morton_order(&points, 2);
        assert_eq!(order, [0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15]);
    }
}
