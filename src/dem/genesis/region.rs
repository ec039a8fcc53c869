//! The outline of a specimen, seen from its centre, and the walls of the vessel it is packed in.
//!
//! The origin is the centre, x across, y along the axis of loading. Lengths in metres.

use serde::{Deserialize, Serialize};

/// A point or vector in the plane (m).
pub type Point = [f64; 2];

/// Outline of a plane specimen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Region {
    /// |x| ≤ width / 2, |y| ≤ height / 2.
    Rectangle {
        /// Extent across the axis of loading (m).
        width: f64,
        /// Extent along the axis of loading (m).
        height: f64,
    },
    /// x² + y² ≤ diameter² / 4.
    Disc {
        /// Diameter (m).
        diameter: f64,
    },
}

/// A body that reaches beyond a wall of the vessel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallTouch {
    /// Distance from the wall to the body's centre (m).
    pub distance: f64,
    /// Unit vector from the wall into the region.
    pub normal: Point,
}

impl Region {
    /// Area (m²).
    pub fn area(&self) -> f64 {
        match *self {
            Self::Rectangle { width, height } => width * height,
            Self::Disc { diameter } => std::f64::consts::FRAC_PI_4 * diameter * diameter,
        }
    }

    /// Extents across and along the axis (m).
    pub fn extent(&self) -> Point {
        match *self {
            Self::Rectangle { width, height } => [width, height],
            Self::Disc { diameter } => [diameter, diameter],
        }
    }

    /// The smaller extent (m).
    pub fn narrowest(&self) -> f64 {
        let [x, y] = self.extent();
        x.min(y)
    }

    /// Distance from `point` to the nearest wall (m); negative outside.
    pub fn depth(&self, point: Point) -> f64 {
        match *self {
            Self::Rectangle { width, height } => (0.5 * width - point[0].abs()).min(0.5 * height - point[1].abs()),
            Self::Disc { diameter } => 0.5 * diameter - norm(point),
        }
    }

    /// Calls `touch` for every wall nearer to `point` than `reach` (m), always in the same order.
    pub fn walls_within(&self, point: Point, reach: f64, mut touch: impl FnMut(WallTouch)) {
        match *self {
            Self::Rectangle { width, height } => {
                let [x, y] = point;
                let sides = [
                    (0.5 * width + x, [1.0, 0.0]),
                    (0.5 * width - x, [-1.0, 0.0]),
                    (0.5 * height + y, [0.0, 1.0]),
                    (0.5 * height - y, [0.0, -1.0]),
                ];
                for (distance, normal) in sides {
                    if distance < reach {
                        touch(WallTouch { distance, normal });
                    }
                }
            }
            Self::Disc { diameter } => {
                let from_centre = norm(point);
                let distance = 0.5 * diameter - from_centre;
                if distance < reach && from_centre > 0.0 {
                    touch(WallTouch { distance, normal: [-point[0] / from_centre, -point[1] / from_centre] });
                }
            }
        }
    }
}

/// Length of a vector.
pub fn norm(v: Point) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_touches_two_walls_and_a_disc_one() {
        let mut seen = Vec::new();
        let rectangle = Region::Rectangle { width: 2.0, height: 4.0 };
        rectangle.walls_within([0.9, -1.8], 0.3, |touch| seen.push(touch));
        assert_eq!(seen.iter().map(|t| t.normal).collect::<Vec<_>>(), [[-1.0, 0.0], [0.0, 1.0]]);
        assert!((seen[0].distance - 0.1).abs() < 1e-15 && (seen[1].distance - 0.2).abs() < 1e-15);
        seen.clear();
        Region::Disc { diameter: 2.0 }.walls_within([0.6, 0.8 - 1e-9], 0.3, |touch| seen.push(touch));
        assert_eq!(seen.len(), 1);
        assert!((seen[0].normal[0] + 0.6).abs() < 1e-8 && (seen[0].normal[1] + 0.8).abs() < 1e-8);
    }

    #[test]
    fn depth_is_the_distance_to_the_nearest_wall() {
        let rectangle = Region::Rectangle { width: 2.0, height: 4.0 };
        assert_eq!(rectangle.depth([0.5, 0.0]), 0.5);
        assert_eq!(rectangle.depth([0.0, 2.5]), -0.5);
        assert_eq!(Region::Disc { diameter: 10.0 }.depth([3.0, 4.0]), 0.0);
    }
}
