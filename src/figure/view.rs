//! Parallel projection of a box onto the page, and the frame of a 3D plot.

use math::elementary::sin_cos;

/// Direction from which a box of edge coordinates −1 … 1 is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    right: [f64; 3],
    up: [f64; 3],
    toward: [f64; 3],
}

impl View {
    /// From azimuth (around z, from the x axis) and elevation in degrees.
    pub fn new(azimuth: f64, elevation: f64) -> Self {
        let (sa, ca) = sin_cos(azimuth.to_radians());
        let (se, ce) = sin_cos(elevation.to_radians());
        Self { right: [-sa, ca, 0.0], up: [-se * ca, -se * sa, ce], toward: [ce * ca, ce * sa, se] }
    }

    /// Right and up on the picture.
    pub fn project(&self, p: [f64; 3]) -> [f64; 2] {
        [dot(self.right, p), dot(self.up, p)]
    }

    /// Nearness to the eye; larger is nearer.
    pub fn depth(&self, p: [f64; 3]) -> f64 {
        dot(self.toward, p)
    }

    /// The far side of the box along each axis: −1 or 1.
    pub fn back(&self) -> [f64; 3] {
        self.toward.map(|d| if d > 0.0 { -1.0 } else { 1.0 })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_a_view_are_orthonormal() {
        let v = View::new(-60.0, 25.0);
        for (a, b, want) in [
            (v.right, v.right, 1.0),
            (v.up, v.up, 1.0),
            (v.toward, v.toward, 1.0),
            (v.right, v.up, 0.0),
            (v.up, v.toward, 0.0),
            (v.right, v.toward, 0.0),
        ] {
            assert!((dot(a, b) - want).abs() < 1e-12);
        }
        assert!(v.project([0.0, 0.0, 1.0])[1] > 0.0 && v.project([1.0, 0.0, 0.0])[0] > 0.0);
        assert_eq!(v.back(), [-1.0, 1.0, -1.0]);
    }
}
