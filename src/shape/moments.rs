//! Volume, centre and inertia of a solid inside a surface of triangles, exact; principal values.
//!
//! Each triangle a, b, c spans a tetrahedron with a base point, of signed volume V = a · (b × c) / 6, and
//!
//! ```text
//! ∫ x dV = V (a + b + c) / 4        ∫ x ⊗ x dV = V (s ⊗ s + a ⊗ a + b ⊗ b + c ⊗ c) / 20,   s = a + b + c
//! ```
//!
//! The inertia about the centre is I = (tr S) 1 − S with S = ∫ x ⊗ x dV about it. (Tonon 2004, doi:10.3844/jmssp.2005.8.11.)

use super::mesh::Mesh;
use super::vector::{cross, dot, minus, plus};

/// Volume, centre and inertia at unit density.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Moments {
    /// Volume (length³).
    pub volume: f64,
    /// Centre of the volume.
    pub centre: [f64; 3],
    /// Inertia about the centre over the density (length⁵).
    pub inertia: [[f64; 3]; 3],
}

impl Moments {
    /// The moments of the solid inside a surface.
    pub fn of(mesh: &Mesh) -> Self {
        let (low, high) = mesh.extent();
        let base: [f64; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let (mut volume, mut first, mut second) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|corner| minus(corner, base));
            let v = dot(a, cross(b, c)) / 6.0;
            let s = plus(plus(a, b), c);
            volume += v;
            for i in 0..3 {
                first[i] += 0.25 * v * s[i];
                for j in 0..3 {
                    second[i][j] += 0.05 * v * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]);
                }
            }
        }
        Self::about_centre(volume, first, second, base)
    }

    /// The moments from the integrals of 1, x and x ⊗ x about a base point.
    pub(crate) fn about_centre(volume: f64, first: [f64; 3], mut second: [[f64; 3]; 3], base: [f64; 3]) -> Self {
        let centre = first.map(|x| x / volume);
        for i in 0..3 {
            for j in 0..3 {
                second[i][j] -= volume * centre[i] * centre[j];
            }
        }
        let trace = second[0][0] + second[1][1] + second[2][2];
        let inertia = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { trace - second[i][i] } else { -0.5 * (second[i][j] + second[j][i]) })
        });
        Self { volume, centre: plus(centre, base), inertia }
    }

    /// Principal moments of inertia, increasing, with their axes.
    pub fn principal(&self) -> ([f64; 3], [[f64; 3]; 3]) {
        principal(self.inertia)
    }

    /// Radius of the ball of this volume.
    pub fn equal_radius(&self) -> f64 {
        math::elementary::cbrt(0.75 * self.volume / std::f64::consts::PI)
    }
}

/// Eigenvalues of a symmetric matrix, increasing, and unit eigenvectors that are right-handed (Jacobi's rotations; only
/// additions, products and roots, so the bits are the same everywhere).
pub fn principal(mut a: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..50 {
        let off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
        let size = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
        if off <= 1e-32 * size {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut axes, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let mut sorted = order.map(|k| axes[k]);
    sorted[2] = cross(sorted[0], sorted[1]);
    (order.map(|k| a[k][k]), sorted)
}

/// The rotation that makes the element (p, q) zero; `axes` are rows.
fn rotate(a: &mut [[f64; 3]; 3], axes: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..3 {
        (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
    }
    for k in 0..3 {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
        (axes[p][k], axes[q][k]) = (c * axes[p][k] - s * axes[q][k], s * axes[p][k] + c * axes[q][k]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;
    use std::f64::consts::PI;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance * expected.abs().max(1e-12), "{found} against {expected}");
    }

    #[test]
    fn a_box_has_its_volume_centre_and_inertia() {
        let [x, y, z] = [1.0, 2.0, 3.0];
        let found = Moments::of(&cuboid([x, y, z]).mapped(|v| plus(v, [100.0, -50.0, 7.0])));
        close(found.volume, 6.0, 1e-12);
        for (k, expected) in [100.5, -49.0, 8.5].into_iter().enumerate() {
            close(found.centre[k], expected, 1e-13);
        }
        for (k, expected) in [y * y + z * z, x * x + z * z, x * x + y * y].into_iter().enumerate() {
            close(found.inertia[k][k], 6.0 * expected / 12.0, 1e-11);
        }
        assert!(found.inertia[0][1].abs() + found.inertia[0][2].abs() + found.inertia[1][2].abs() < 1e-9);
    }

    /// The tetrahedron of Tonon (2004), section 4, whose inertia is printed with its products.
    #[test]
    fn a_tetrahedron_has_the_published_inertia() {
        let vertices =
            vec![[8.33220, -11.86875, 0.93355], [0.75523, 5.0, 16.37072], [52.61236, 5.0, -5.38580], [2.0, 5.0, 3.0]];
        let mut mesh = Mesh { vertices, facets: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] };
        if Moments::of(&mesh).volume < 0.0 {
            mesh.facets.iter_mut().for_each(|facet| facet.swap(1, 2));
        }
        let found = Moments::of(&mesh);
        for (k, expected) in [15.92492, 0.78281, 3.72962].into_iter().enumerate() {
            close(found.centre[k], expected, 1e-5);
        }
        for (k, expected) in [43520.33257, 194711.28938, 191168.76173].into_iter().enumerate() {
            close(found.inertia[k][k], expected, 1e-6);
        }
        close(found.inertia[1][2].abs(), 4417.66150, 1e-6);
        close(found.inertia[0][2].abs(), 46343.16662, 1e-6);
        close(found.inertia[0][1].abs(), 11996.20119, 1e-6);
    }

    /// 4/3 π a b c and m (b² + c²)/5, as far as a surface of 128 × 256 facets goes.
    #[test]
    fn an_ellipsoid_has_its_closed_form() {
        let [a, b, c] = [1.0, 2.0, 0.7];
        let found = Moments::of(&ellipsoid([a, b, c], 128));
        close(found.volume, 4.0 / 3.0 * PI * a * b * c, 4e-4);
        let (values, axes) = found.principal();
        let mass = found.volume;
        for (k, expected) in [a * a + c * c, b * b + c * c, a * a + b * b].into_iter().enumerate() {
            close(values[k], mass * expected / 5.0, 8e-4);
        }
        close(axes[0][1].abs(), 1.0, 1e-9);
    }

    /// A turned diagonal matrix gives its diagonal back, and the axes are orthonormal.
    #[test]
    fn principal_values_do_not_depend_on_the_frame() {
        let (c, s) = (0.6, 0.8);
        let turn = [[c, -s, 0.0], [s * 0.28, c * 0.28, -0.96], [s * 0.96, c * 0.96, 0.28]];
        let values = [1.0, 5.0, 2.0];
        let a: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| turn[i][k] * values[k] * turn[j][k]).sum()));
        let (found, axes) = principal(a);
        for (value, expected) in found.into_iter().zip([1.0, 2.0, 5.0]) {
            close(value, expected, 1e-12);
        }
        for (value, axis) in found.into_iter().zip(axes) {
            let image: [f64; 3] = std::array::from_fn(|i| dot(a[i], axis));
            (0..3).for_each(|k| assert!((image[k] - value * axis[k]).abs() < 1e-12));
        }
        close(dot(cross(axes[0], axes[1]), axes[2]), 1.0, 1e-12);
    }
}
