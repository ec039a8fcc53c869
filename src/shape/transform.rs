//! Balls inside a solid by the Euclidean distance transform of its cells.
//!
//! The distance of each cell's middle to the nearest middle outside, exact on the grid by lower envelopes of parabolas along
//! one axis after the other (Felzenszwalb & Huttenlocher 2012, doi:10.4086/toc.2012.v008a019); half a cell less is the radius of
//! a ball inside. A ball that lies in the ball of a neighbouring cell is left out: maximal balls remain.

use super::Ball;
use super::voxels::Voxels;

/// Squared distances (in cells) to the nearest cell outside.
pub fn squared_distances(voxels: &Voxels) -> Vec<f64> {
    let far = voxels.count.iter().map(|&n| (n * n) as f64).sum::<f64>();
    let mut squares: Vec<f64> = voxels.inside.iter().map(|&inside| if inside { far } else { 0.0 }).collect();
    let [nx, ny, nz] = voxels.count;
    for (axis, step) in [1, nx, nx * ny].into_iter().enumerate() {
        let length = voxels.count[axis];
        let starts: Vec<usize> = match axis {
            0 => (0..ny * nz).map(|k| k * nx).collect(),
            1 => (0..nz).flat_map(|z| (0..nx).map(move |x| z * nx * ny + x)).collect(),
            _ => (0..nx * ny).collect(),
        };
        for start in starts {
            let line: Vec<f64> = (0..length).map(|k| squares[start + k * step]).collect();
            for (k, value) in envelope(&line).into_iter().enumerate() {
                squares[start + k * step] = value;
            }
        }
    }
    squares
}

/// min over j of (i − j)² + f(j), for every i.
fn envelope(f: &[f64]) -> Vec<f64> {
    let mut roots: Vec<(usize, f64)> = Vec::with_capacity(f.len()); // parabola, from where it is the lowest
    for (j, &value) in f.iter().enumerate() {
        let meets = |other: usize| {
            let (p, q) = (j as f64, other as f64);
            ((value + p * p) - (f[other] + q * q)) / (2.0 * (p - q))
        };
        while roots.last().is_some_and(|&(other, from)| meets(other) <= from) {
            roots.pop();
        }
        let from = roots.last().map_or(f64::NEG_INFINITY, |&(other, _)| meets(other));
        roots.push((j, from));
    }
    let mut lowest = Vec::with_capacity(f.len());
    let mut k = 0;
    for i in 0..f.len() {
        while roots.get(k + 1).is_some_and(|next| next.1 <= i as f64) {
            k += 1;
        }
        let apart = i as f64 - roots[k].0 as f64;
        lowest.push(apart * apart + f[roots[k].0]);
    }
    lowest
}

/// The maximal balls of the cells.
pub fn balls(voxels: &Voxels) -> Vec<Ball> {
    let radii: Vec<f64> = squared_distances(voxels).iter().map(|d| (d.sqrt() - 0.5) * voxels.side).collect();
    let [nx, ny, nz] = voxels.count;
    let at = |cell: usize| [cell % nx, cell / nx % ny, cell / (nx * ny)];
    let maximal = |&cell: &usize| {
        let here = at(cell);
        let neighbours = (0..27).filter_map(|k| {
            let step = [k % 3, k / 3 % 3, k / 9].map(|s: i64| s - 1);
            let there: [i64; 3] = std::array::from_fn(|axis| here[axis] as i64 + step[axis]);
            let within = (0..3).all(|axis| (0..[nx, ny, nz][axis] as i64).contains(&there[axis]));
            let apart = (step.iter().map(|s| s * s).sum::<i64>() as f64).sqrt() * voxels.side;
            let [x, y, z] = there.map(|x| x as usize);
            (within && apart > 0.0).then(|| (radii[(z * ny + y) * nx + x], apart))
        });
        let covered = |(radius, apart): (f64, f64)| radius >= radii[cell] + apart * (1.0 - 1e-9);
        !neighbours.into_iter().any(covered)
    };
    let inside = (0..radii.len()).filter(|&cell| voxels.inside[cell] && radii[cell] > 0.0).filter(maximal);
    inside.map(|cell| Ball { centre: voxels.middle(cell), radius: radii[cell] }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;

    /// Against the distance to every cell outside.
    #[test]
    fn distances_are_exact_on_the_grid() {
        let voxels = Voxels::of(&ellipsoid([1.0, 0.5, 0.8], 16), 12);
        let found = squared_distances(&voxels);
        let side = voxels.side;
        for cell in 0..voxels.inside.len() {
            let outside = (0..voxels.inside.len()).filter(|&other| !voxels.inside[other]);
            let square = |other| {
                let (a, b) = (voxels.middle(cell), voxels.middle(other));
                (0..3).map(|k| ((a[k] - b[k]) / side).powi(2)).sum::<f64>()
            };
            let expected = outside.map(square).fold(f64::INFINITY, f64::min);
            assert!((found[cell] - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn the_largest_ball_of_a_box_is_its_inscribed_one() {
        let found = balls(&Voxels::of(&cuboid([1.0, 1.0, 3.0]), 61));
        let widest = found.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap();
        assert!((widest.radius - 0.5).abs() < 0.05, "{widest:?}");
        assert!(found.len() > 20);
    }
}
