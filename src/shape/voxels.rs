//! The cells of a regular grid whose centres lie in a solid.
//!
//! A ray through each column of the grid intersects the surface; the cells between an entry and the next exit are inside. The
//! side of an edge is computed from its vertices in one order, so two facets that share it never both miss or both take
//! a ray; columns are offset from the middle by an irrational fraction, so that none passes through a vertex of a regular surface.

use super::mesh::Mesh;
use super::vector::minus;

/// Cells of a solid.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// Middle of the first cell.
    pub low: [f64; 3],
    /// Edge of a cell.
    pub side: f64,
    /// Cells along each axis.
    pub count: [usize; 3],
    /// Whether each is inside, x fastest.
    pub inside: Vec<bool>,
}

/// Position of the column within its cell.
const OFF: [f64; 2] = [0.5 + 1.414_213_562_373_095e-4, 0.5 - 1.732_050_807_568_877e-4];

impl Voxels {
    /// The cells of a solid, with `along` cells along its longest extent and one layer around it.
    ///
    /// # Panics
    /// `along` is 0.
    pub fn of(mesh: &Mesh, along: usize) -> Self {
        assert!(along > 0, "BUG: a grid without cells");
        let (low, high) = mesh.extent();
        let size = minus(high, low);
        let side = size.iter().copied().fold(0.0, f64::max) / along as f64;
        let count = size.map(|length| (length / side).ceil().max(1.0) as usize + 2);
        let low: [f64; 3] = std::array::from_fn(|k| low[k] - side + [OFF[0], OFF[1], 0.5][k] * side);
        let mut voxels = Self { low, side, count, inside: vec![false; count.iter().product()] };
        for (column, mut heights) in voxels.crossings(mesh).into_iter().enumerate() {
            heights.sort_by(f64::total_cmp);
            for pair in heights.chunks_exact(2) {
                let layer = |z: f64| ((z - voxels.low[2]) / side).ceil().max(0.0) as usize;
                for z in layer(pair[0])..layer(pair[1]).min(count[2]) {
                    voxels.inside[z * count[0] * count[1] + column] = true;
                }
            }
        }
        voxels
    }

    /// Heights at which each column meets the surface.
    fn crossings(&self, mesh: &Mesh) -> Vec<Vec<f64>> {
        let [nx, ny, _] = self.count;
        let mut columns = vec![Vec::new(); nx * ny];
        for facet in mesh.facets() {
            let corners = facet.map(|v| mesh.vertices()[v as usize]);
            let bound = |axis: usize, most: usize| {
                let at = corners.map(|c| (c[axis] - self.low[axis]) / self.side);
                let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
                low.ceil().max(0.0) as usize..((high.floor() + 1.0).max(0.0) as usize).min(most)
            };
            for j in bound(1, ny) {
                for i in bound(0, nx) {
                    let p = [self.low[0] + i as f64 * self.side, self.low[1] + j as f64 * self.side];
                    let sides: [f64; 3] = std::array::from_fn(|k| {
                        let (a, b) = (facet[(k + 1) % 3], facet[(k + 2) % 3]);
                        let value =
                            |a: u32, b: u32| side_of(mesh.vertices()[a as usize], mesh.vertices()[b as usize], p);
                        if a < b { value(a, b) } else { -value(b, a) }
                    });
                    if sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0) {
                        let whole: f64 = sides.iter().sum();
                        let height = (0..3).map(|k| sides[k] / whole * corners[k][2]).sum();
                        columns[j * nx + i].push(height);
                    }
                }
            }
        }
        columns
    }

    /// Middle of a cell.
    pub fn middle(&self, cell: usize) -> [f64; 3] {
        let [nx, ny, _] = self.count;
        let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
        std::array::from_fn(|k| self.low[k] + at[k] as f64 * self.side)
    }

    /// Volume of the cells inside.
    pub fn volume(&self) -> f64 {
        self.inside.iter().filter(|&&inside| inside).count() as f64 * self.side.powi(3)
    }
}

/// Twice the signed area of a, b, p in the plane.
fn side_of(a: [f64; 3], b: [f64; 3], p: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::super::moments::Moments;
    use super::*;

    #[test]
    fn cells_fill_the_volume_and_lie_inside() {
        let half = [1.0, 0.6, 1.5];
        let mesh = ellipsoid(half, 60);
        let voxels = Voxels::of(&mesh, 60);
        assert!((voxels.volume() / Moments::of(&mesh).volume - 1.0).abs() < 3e-3, "{}", voxels.volume());
        for cell in (0..voxels.inside.len()).filter(|&cell| voxels.inside[cell]) {
            let p = voxels.middle(cell);
            assert!((0..3).map(|k| (p[k] / half[k]).powi(2)).sum::<f64>() < 1.0 + 1e-9);
        }
        let boxed = Voxels::of(&cuboid([1.0, 2.0, 4.0]), 40);
        assert!((boxed.volume() / 8.0 - 1.0).abs() < 1e-9, "{}", boxed.volume());
    }
}
